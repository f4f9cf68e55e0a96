"""`prepared=True` beside the default door: what each tells, and how far they are apart.

Envelopes, angle and torque of each leg of `legs/` go in as they are, at 128 Hz. Half-widths are
those of the posterior, before moment arms that are not the leg's own. Run it as

    .venv/bin/python benchmarks/two_doors.py --families a,c,h --seeds 5001
"""

import argparse
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import surae
from trust import numbers

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make, truth_of

#: Of these the half-widths are shown, as a part of the value [%].
SHOWN = ("k_tri", "tau_rel", "l0_tri", "dlt_tri", "f0")
#: Half-width of a value that counts as told well, as a part of it.
WELL = 0.1


def intervals(fit: surae.Fit) -> dict[str, tuple[float, float]]:
    """Value and half-width by the posterior of each free parameter."""
    names = fit.result.problem.free
    spread = fit.result.solution.spread
    variance = sum((by**2).sum(axis=0) for by in spread.values())
    half = dict(zip(names, 1.96 * np.sqrt(variance), strict=True))
    return {n: (fit.result.values[n], half[n]) for n in names if n in fit.parameters}


def main() -> None:
    """Fit and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,c,h")
    parser.add_argument("--seeds", type=numbers, default=numbers("5001"))
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    counts = {True: np.zeros(3, dtype=int), False: np.zeros(3, dtype=int)}
    logs: dict[bool, list[list[float]]] = {True: [], False: []}
    apart = []
    print("leg         door  seconds [told well, true, hold] half-widths [%] of", *SHOWN)
    for family, seed in [(f, s) for f in given.families.split(",") for s in given.seeds]:
        truth = truth_of(family, seed, 1, ("active",))["parameters"]
        fits = {}
        for prepared in (True, False):
            with tempfile.TemporaryDirectory() as folder:
                path = make(family, seed, Path(folder), (1,), kind="active")[0]
                begin = time.process_time()
                fits[prepared] = own = intervals(surae.fit(path, prepared=prepared, quality=()))
                spent = time.process_time() - begin
            held = {
                n: abs(own[n][0] - truth[n]) <= own[n][1] for n in own if truth.get(n) is not None
            }
            well = [n for n in held if own[n][1] <= WELL * abs(own[n][0])]
            one = np.array([len(well), sum(held[n] for n in well), sum(held.values())])
            counts[prepared] += one
            shown = [100 * own[n][1] / abs(own[n][0]) if n in own else np.nan for n in SHOWN]
            logs[prepared].append([np.log(half) for _, half in own.values()])
            door = "prepared" if prepared else "default"
            print(f"{family}-{seed} {door:>9} {spent:7.1f} {one} {np.round(shown, 1)}", flush=True)
        apart += [
            (fits[True][n][0] - value) / half
            for n, (value, half) in fits[False].items()
            if n in fits[True]
        ]
    for prepared, own in counts.items():
        print("prepared" if prepared else "default ", "told well, true, hold:", own)
        mean = np.exp(np.mean(np.concatenate(logs[prepared])))
        print(f"  geometric mean of all half-widths {mean:.4g}")
    parts = np.percentile(np.abs(apart), [50, 90, 100])
    print("values apart, in half-widths: median, 90 %, most", np.round(parts, 3))


if __name__ == "__main__":
    main()
