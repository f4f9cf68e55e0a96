"""What a warm `surae fit` costs beside importing its libraries: the median of paired runs.

With `--first` what the first one after an installation takes, its kernels compiled, and the next.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from web import made

LIBRARIES = [sys.executable, "-c", "import numpy, scipy.optimize, numba"]
#: A warm fit may take this many times what its libraries take to import.
LIMIT = 2.5


def seconds(command: list[str]) -> float:
    begin = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def first(fit: list[str]) -> str:
    """By the clock, the first fit with an empty folder of kernels, and the second."""
    with tempfile.TemporaryDirectory() as empty:
        os.environ["SURAE_CACHE"] = empty
        return f"first surae fit {seconds(fit):.1f} s, second {seconds(fit):.1f} s"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recording", nargs="?", help="a prepared CSV; by default a virtual trial")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--first", action="store_true", help="of the first fit after installation")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        recording = arguments.recording or f"{folder}/trial.csv"
        if arguments.recording is None:
            made(
                Path(recording), 128.0, 0.0, profile="multiple-holds", chirp_rate=0.5, duration=32.0
            )
        fit = [sys.executable, "-m", "surae", "fit", recording, "--prepared"]
        if arguments.first:
            print(first(fit))
            return
        seconds(fit), seconds(LIBRARIES)  # warm
        pairs = [(seconds(fit), seconds(LIBRARIES)) for _ in range(arguments.runs)]
    ratio = statistics.median(ours / theirs for ours, theirs in pairs)
    ours, theirs = (statistics.median(times) for times in zip(*pairs, strict=True))
    print(f"surae fit {ours:.3f} s, libraries alone {theirs:.3f} s, ratio {ratio:.2f}")
    sys.exit(ratio >= LIMIT)


if __name__ == "__main__":
    main()
