"""Virtual patients made from published ratios: what `surae stretches` says of the two groups.

De Gooijer-van de Groep and others (J NeuroEng Rehabil 10:81, 2013) found, in 23 adolescents with
cerebral palsy, a reflexive torque of the calf 5.7 times and a tissue stiffness 2.1 times that of 11
controls. Here controls are legs of `legs/` with a weak reflex, patients the same legs with tissue
and reflex as much larger. Run it as

    .venv/bin/python benchmarks/spastic_ankles.py --legs 8
"""

import argparse
import tempfile
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

import surae
from ankle_legs import stretched
from ankle_legs.leg import generator
from ankle_legs.make import write_csv

#: The paper’s ratios of patients over controls; a control’s reflex in the fastest stretch [Nm].
STIFFER, STRONGER, CONTROL = 2.1, 5.7, 1.5


def legs(seed: int) -> dict[str, stretched.Stretches]:
    """A control and the patient who is the same but for tissue and reflex."""
    drawn = replace(stretched.leg("sa", seed), emg="envelope", files=1)
    control = replace(drawn, answer=replace(drawn.answer, peak=CONTROL))
    tissue = replace(drawn.tissue, at_zero=STIFFER * drawn.tissue.at_zero)
    answer = replace(drawn.answer, peak=STRONGER * CONTROL)
    return {"control": control, "patient": replace(drawn, tissue=tissue, answer=answer)}


def of_fastest(made: stretched.Stretches, seed: int) -> tuple[dict[str, float], dict[str, float]]:
    """Mean torques [Nm] of the leg's fastest stretches: told, and true."""
    recordings, truth = stretched.simulate(made, generator("sa", seed, 1))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "stretches.csv"
        write_csv(path, recordings[0].columns, "# emg: envelope\n")
        table = surae.stretches(path).to_dataframe()
    top = max(s["asked_deg_s"] for s in truth["stretches"])
    own = [s for s in truth["stretches"] if s["asked_deg_s"] > 0.95 * top]
    fast = table[(table["speed_deg_s"] > 0.85 * table["speed_deg_s"].max())]
    fast = fast[fast["direction"] == "dorsiflexion"]
    names = ("elastic_Nm", "viscous_Nm", "neural_Nm")
    told = {name: float(fast[name].astype(float).mean()) for name in names}
    return told, {name: float(np.mean([s[name] for s in own])) for name in names}


def main() -> None:
    """Make legs, take their stretches apart, and compare the groups."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--legs", type=int, default=8)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    groups: dict[str, list[tuple[dict[str, float], dict[str, float]]]] = {}
    for seed in range(901, 901 + given.legs):
        for group, made in legs(seed).items():
            groups.setdefault(group, []).append(of_fastest(made, seed))
    for name in ("elastic_Nm", "viscous_Nm", "neural_Nm"):
        means = {
            (group, k): np.nanmean([pair[k][name] for pair in several])
            for group, several in groups.items()
            for k in (0, 1)
        }
        missing = sum(np.isnan(p[0][name]) for several in groups.values() for p in several)
        told, true = (means["patient", k] / means["control", k] for k in (0, 1))
        print(
            f"{name:11} control {means['control', 0]:5.2f} (true {means['control', 1]:5.2f}), "
            f"patient {means['patient', 0]:5.2f} (true {means['patient', 1]:5.2f}), "
            f"ratio {told:.2f} (true {true:.2f}); {missing} of {2 * given.legs} not told"
        )


if __name__ == "__main__":
    main()
