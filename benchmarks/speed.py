"""What a fit costs beside the plain fit that a laboratory writes: processor time, in one run.

Two forms of it: `baseline.py`, a torque as a function of the parameters and least squares within
bounds; `lean.py`, with all that no parameter changes computed beforehand. Single trials of 35 s of
virtual legs; one thread on both sides. Run it as

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

import baseline
import lean

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make

CALLS = {
    "one start of `muscle` with its assessment": {"model": "muscle", "starts": 1},
    "eight starts of `muscle`": {"model": "muscle", "starts": 8},
    "`auto`": {},
}
PLAIN = {"`baseline.py`": baseline.fit, "`lean.py`": lean.fit}


def seconds(call: Callable[[], object]) -> float:
    """Processor time of a call."""
    begin = time.process_time()
    call()
    return time.process_time() - begin


def ratios(path: Path) -> dict[tuple[str, str], float]:
    """By form and call: the plain fit, timed before and after, as a ratio to what surae takes."""
    problem = surae.fit(path, model="muscle", starts=1, quality=()).result.problem
    surae.fit(path, quality=())  # kernels are loaded

    def plain() -> dict[str, float]:
        return {name: seconds(lambda fit=fit: fit(problem)) for name, fit in PLAIN.items()}

    before = plain()
    own = {
        name: seconds(lambda asked=asked: surae.fit(problem.inputs, quality=(), **asked))
        for name, asked in CALLS.items()
    }
    after = plain()
    return {
        (form, name): 0.5 * (before[form] + after[form]) / cost
        for form in PLAIN
        for name, cost in own.items()
    }


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
    for form, name in found[0]:
        each = [ratio[form, name] for ratio in found]
        middle, low, high = (f"{f(each):.2g}" for f in (statistics.median, min, max))
        print(f"| plain fit of 35 s, {form}, against {name} | {middle} × ({low}–{high}) |")


if __name__ == "__main__":
    main()
