"""What a recording tells by its length: half-widths, time and memory from 35 s to an hour.

The first seconds of one recording of an hour of a virtual leg of `legs/` are fitted by `auto`, each
length in a process of its own. Half-widths are those of the posterior, before moment arms that are
not the leg's own. Run it as

    .venv/bin/python benchmarks/duration.py --family a --seed 5003
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import surae
from two_doors import SHOWN, WELL, intervals

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make, truth_of

SECONDS = (35.0, 150.0, 299.0, 301.0, 600.0, 3600.0)


def one(path: str, seconds: float) -> dict[str, object]:
    """The fit of the first seconds of a file: intervals, processor time [s] and memory [MiB]."""
    recording = surae.read(path).crop(0.0, seconds)
    begin = time.process_time()
    fit = surae.fit(recording)
    spent = time.process_time() - begin
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    identified = [n for n, p in fit.parameters.items() if p.verdict == "identified"]
    measures = [n for n, m in fit.measures().items() if m.verdict == "identified"]
    return {
        "intervals": intervals(fit),
        "identified": len(identified),
        "measures": len(measures),
        "grade": fit.adequacy.grade,
        "seconds": spent,
        "memory": memory,
    }


def main() -> None:
    """Make the recording, fit its parts, show the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--family", default="a")
    parser.add_argument("--seed", type=int, default=5003)
    parser.add_argument("--seconds", type=float, nargs="*", default=SECONDS)
    parser.add_argument("--one", help=argparse.SUPPRESS)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    if given.one:
        print(json.dumps(one(given.one, given.seconds[0])))
        return
    print("seconds  processor s   MiB  identified, measures, apart [half-widths]", *SHOWN)
    with tempfile.TemporaryDirectory() as folder:
        longest = max(given.seconds)
        path = make(given.family, given.seed, Path(folder), kind="active", seconds=longest)[0]
        truth = truth_of(given.family, given.seed, 1, ("active",), longest)["parameters"]
        for seconds in given.seconds:
            command = [sys.executable, __file__, "--one", str(path), "--seconds", str(seconds)]
            said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            told = json.loads(said.splitlines()[-1])
            own = told["intervals"]
            apart = {n: abs(own[n][0] - truth[n]) / own[n][1] for n in own if truth.get(n)}
            worst = max(apart, key=lambda name: apart[name])
            half = [100 * own[n][1] / abs(own[n][0]) if n in own else np.nan for n in SHOWN]
            well = sum(h <= WELL * abs(v) for v, h in own.values())
            print(
                f"{seconds:7.0f} {told['seconds']:10.1f} {told['memory']:7.0f} "
                f"{told['identified']:3d} {told['measures']:3d} {told['grade']} well {well} "
                f"{worst} {apart[worst]:.2f}",
                np.round(half, 1),
                flush=True,
            )


if __name__ == "__main__":
    main()
