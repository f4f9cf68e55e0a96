"""What a fit costs beside the plain fit that a laboratory writes: processor time, in one run.

Single trials of 35 s of virtual legs; one thread on both sides. Run it as

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 .venv/bin/python benchmarks/speed.py [--families a,c,h]

It prints the rows of `docs/methods/speed.md`: the median and the range over the legs.
"""

import argparse
import statistics
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import surae

from baseline import fit as plain_fit

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make

ROWS = {
    "one": "plain fit of a trial of 35 s, against one start of `muscle` with its assessment",
    "eight": "the same, against eight starts",
    "auto": "`auto`, against the plain fit",
}


def seconds(call: Callable[[], object]) -> float:
    """Processor time of a call."""
    begin = time.process_time()
    call()
    return time.process_time() - begin


def ratios(path: Path) -> dict[str, float]:
    """What each costs as a ratio to the plain fit, which is timed before and after."""
    problem = surae.fit(path, model="muscle", starts=1, quality=()).result.problem
    surae.fit(path, quality=())  # kernels are loaded

    def fit(**keywords: object) -> float:
        return seconds(lambda: surae.fit(problem.inputs, quality=(), **keywords))

    before = seconds(lambda: plain_fit(problem))
    one, eight = fit(model="muscle", starts=1), fit(model="muscle", starts=8)
    auto = fit()
    plain = 0.5 * (before + seconds(lambda: plain_fit(problem)))
    return {"one": plain / one, "eight": plain / eight, "auto": auto / plain}


def main() -> None:
    """Make the legs, time all, print the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,c,h,m,t")
    parser.add_argument("--seed", type=int, default=2001)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        found = [
            ratios(make(family, given.seed, Path(folder), (1,))[0])
            for family in given.families.split(",")
        ]
    for name, text in ROWS.items():
        each = [ratio[name] for ratio in found]
        spread = f"{min(each):.1f}–{max(each):.1f}"
        print(f"| {text} | {statistics.median(each):.1f} × ({spread}) | `benchmarks/speed.py` |")


if __name__ == "__main__":
    main()
