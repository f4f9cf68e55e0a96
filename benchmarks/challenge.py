"""Three entrants of the open challenge: a plain SciPy fit, surae's muscle model, and its default.

Legs of `legs/`, one active trial of 35 s each, public seeds. Run it as

    .venv/bin/python benchmarks/challenge.py --output ANSWERS [--only plain,muscle,auto]

It writes one table of answers an entrant, as any other tool would, and the scorer counts each. The
plain fit is what a laboratory writes itself: bounded least squares from one start, intervals from
the Jacobian, *identified* where the interval is within 10 % of the value.
"""

import argparse
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

import surae
from trust import answers, numbers, write

from baseline import fit as plain_fit

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make, truth_of
from ankle_legs.score import COLUMNS, measures_of, score, table
from ankle_legs.subject import PARAMETERS

FAMILIES, SEEDS = "a,b,c,d,e,f,g,h,i,j,k,m,n,o,p,r,t,u,v,w", "2001"
HEAD = (*COLUMNS, "grade")


def plain(path: Path) -> list[list[object]]:
    """What a plain fit says of a leg's parameters; nothing where its Jacobian is singular."""
    problem = surae.fit(path, model="muscle", starts=1, quality=()).result.problem
    try:
        minimum, covariance = plain_fit(problem)
    except np.linalg.LinAlgError:
        return []
    rows: list[list[object]] = []
    for name, value, variance in zip(problem.free, minimum.x, covariance.diagonal(), strict=True):
        half = 1.96 * max(float(variance), 0.0) ** 0.5
        verdict = "identified" if 0 < half <= 0.1 * abs(value) else "weak"
        rows.append([name, value, value - half, value + half, verdict, ""])
    return rows


def main() -> None:
    """Make the legs, let each entrant answer, count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default=FAMILIES)
    parser.add_argument("--seeds", type=numbers, default=numbers(SEEDS))
    parser.add_argument("--only", default="plain,muscle,auto", help="entrants")
    parser.add_argument("--output", type=Path, required=True, metavar="DIR")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    given.output.mkdir(parents=True, exist_ok=True)
    legs = [(family, seed) for family in given.families.split(",") for seed in given.seeds]
    for entrant in given.only.split(","):
        said: list[list[object]] = []
        with tempfile.TemporaryDirectory() as temporary:
            for family, seed in legs:
                path = make(family, seed, Path(temporary), (1,))[0]
                if entrant == "plain":
                    rows = plain(path)
                else:
                    measured = truth_of(family, seed, 1)["measures"]
                    fit = surae.fit(path, model=entrant, quality=())
                    rows = [row[:6] for row in answers(fit, measured)]
                said += [[family, seed, 1, *row] for row in rows]
        path = write(given.output / f"{entrant}.csv", HEAD, said)
        print(f"{entrant}: {path}")
        print(table(score(path, PARAMETERS)))
        if measures := measures_of(path):
            print("measures\n" + table(score(path, measures)))


if __name__ == "__main__":
    main()
