"""How well tissue and nerve are told apart, on legs that share no code with surae.

Perturbed and stretched legs of `legs/`, written as CSV files and estimated as anybody would; its
scorer counts. Run it as

    .venv/bin/python benchmarks/nerve.py --families qa,qb,sa --seeds 1-3 [--output DIR]

Families qa to qj and sa to sh may be looked at while an estimate is made, ql-1 and sl-1 and on not.
"""

import argparse
import sys
import tempfile
import time
import warnings
from pathlib import Path

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make
from ankle_legs.nerve import score


def numbers(text: str) -> list[int]:
    """Seeds of a text as 11-14 or 3,5,8."""
    pieces = [part.partition("-") for part in text.split(",")]
    return [n for low, _, high in pieces for n in range(int(low), int(high or low) + 1)]


def main() -> None:
    """Make legs, estimate them, and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="qa,qb,qc,qd,qe,qf,qg,qh,qi,qj")
    parser.add_argument("--seeds", type=numbers, default=numbers("1-3"), metavar="1-3")
    parser.add_argument("--output", type=Path, metavar="DIR", help="keep the answers")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    spent: list[float] = []
    failed: list[str] = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.output or Path(temporary) / "answers"
        folder.mkdir(parents=True, exist_ok=True)
        for seed in given.seeds:
            for family in given.families.split(","):
                estimate = surae.stretches if family.startswith("s") else surae.impedance
                paths, begin = make(family, seed, Path(temporary)), time.process_time()
                try:
                    estimate(paths).save(folder / f"{family}-{seed}.json")
                except surae.SuraeError as error:
                    failed.append(f"{family}-{seed}: {error}")
                spent.append(time.process_time() - begin)
                print(f"{family}-{seed}: {spent[-1]:.1f} s", file=sys.stderr, flush=True)
                for path in paths:
                    path.unlink()
        print(score(folder))
        for line in failed:
            print(f"no answer: {line}")
        middle, most = sorted(spent)[len(spent) // 2], max(spent)
        print(f"seconds of processor: {middle:.1f} at the median, {most:.1f} at most")


if __name__ == "__main__":
    main()
