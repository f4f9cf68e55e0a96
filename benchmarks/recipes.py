"""What ten minutes of a laboratory make known of a leg, on legs that share no code with surae.

A virtual laboratory of `legs/` measures each leg by a recipe of steps, `surae.session` takes the
folder with its `session.toml`, and the joint fit's claims are held against the leg. Run it as

    .venv/bin/python benchmarks/recipes.py --families a,p --seeds 1-2 [--wrong axis]
"""

import argparse
import sys
import tempfile
import time
import warnings
from pathlib import Path

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs import laboratory
from ankle_legs.measures import MEASURED_AT
from ankle_legs.subject import PARAMETERS

THESIS = PARAMETERS[:15]
#: Steps of a recipe, and its active trials.
RECIPES: dict[str, tuple[tuple[str, ...], int]] = {
    "one": (("active",), 1),
    "passive": (("slow", "fast", "active"), 2),
    "alone": (("alone", "slow", "fast", "active"), 2),
    "geometry": (("geometry", "slow", "fast", "active"), 2),
    "once": (tuple(s for s in laboratory.STEPS if s not in ("excursion", "again")), 2),
    "all": (laboratory.STEPS, 2),
}


def numbers(text: str) -> list[int]:
    """Seeds of a text as 11-14 or 3,5,8."""
    pieces = [part.partition("-") for part in text.split(",")]
    return [n for low, _, high in pieces for n in range(int(low), int(high or low) + 1)]


def count(told: dict[str, object], truth: dict[str, float | None]) -> list[int]:
    """What is identified, true of it, intervals that hold, intervals."""
    found = [0, 0, 0, 0]
    for name, one in told.items():
        value = truth.get(name)
        if value is None or not one.ci95:
            continue
        holds = one.ci95[0] <= value <= one.ci95[1]
        claimed = one.verdict == "identified"
        for i, n in enumerate((claimed, claimed and holds, holds, 1)):
            found[i] += n
    return found


def main() -> None:
    """Measure legs by recipes, and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,p")
    parser.add_argument("--seeds", type=numbers, default=numbers("1"), metavar="1-2")
    parser.add_argument("--recipes", default="one,all", help=f"of {', '.join(RECIPES)}")
    parser.add_argument("--wrong", help=f"what is wrong: {', '.join(laboratory.WRONG)}")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for recipe in given.recipes.split(","):
        steps, active = RECIPES[recipe]
        sums, possible, minutes = [[0] * 4, [0] * 4], 0, 0.0
        for seed in given.seeds:
            for family in given.families.split(","):
                what = {"wrong": given.wrong, "active": active}
                made = laboratory.measure(family, seed, steps, **what)
                begin = time.process_time()
                with tempfile.TemporaryDirectory() as temporary:
                    folder = laboratory.write(made, Path(temporary))
                    fit = surae.session(folder).fit()
                free = {k: v for k, v in fit.parameters.items() if v.free and k in THESIS}
                counts = [
                    count(free, made.truth["parameters"]),
                    count(fit.measures(angles=MEASURED_AT), made.truth["measures"]),
                ]
                sums = [
                    [a + b for a, b in zip(*pair, strict=True)]
                    for pair in zip(sums, counts, strict=True)
                ]
                possible += sum(made.truth["parameters"][k] is not None for k in THESIS)
                minutes += made.minutes
                took = f"{time.process_time() - begin:.0f} s of processor"
                said = f"{recipe}, {family}-{seed}: {counts}, {fit.adequacy.grade}, {took}"
                print(said, file=sys.stderr, flush=True)
                for line in fit.adequacy.reasons:
                    print(f"    {line}", file=sys.stderr)
        legs = len(given.seeds) * len(given.families.split(","))
        for name, (claimed, true, hold, n), of in zip(
            ("parameters", "measures"), sums, (possible, sums[1][3]), strict=True
        ):
            head = f"{recipe:<9} {minutes / legs:4.1f} min  {name:<10}"
            counted = f"identified {claimed} of {of}, true {true}, intervals hold {hold} of {n}"
            print(head, counted, flush=True)


if __name__ == "__main__":
    main()
