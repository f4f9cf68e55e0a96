"""How often a leg's page says *Yes* to "Can I trust it?", where it may and where it must not.

Sessions of virtual legs whose truth is hidden (``ankle-legs``): a relaxed movement, held angles and
two movements with effort, as files. The same again with the relaxed trials of another leg, and with
the foot moved by 8° between relaxed and active trials; and legs whose tissue has a toe. Run it as

    .venv/bin/python benchmarks/yes.py [--families va,p] [--seeds 401-410] [--only clean,moved]

Each case prints the answer and what speaks against it; at the end stands a count.
"""

import argparse
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from ankle_legs.make import make
from undrawn import blank_figures

QUESTION = "Can I trust it?"
#: Name of a file, trial of the leg, and what is done in it.
VISIT = (
    ("slow", 1, "passive"),
    ("holds", 2, "curve"),
    ("walk 1", 2, "active"),
    ("walk 2", 3, "active"),
)
RELAXED = ("slow", "holds")
#: Angle by which the foot is moved [deg].
MOVED = 8.0


def folder_of(family: str, seed: int, folder: Path) -> Path:
    """Write a leg's session of four trials."""
    folder.mkdir(parents=True)
    for name, trial, kind in VISIT:
        with tempfile.TemporaryDirectory() as made:
            (path,) = make(family, seed, Path(made), (trial,), kind=kind)
            shutil.move(path, folder / f"{name}.csv")
    return folder


def clean(family: str, seed: int, folder: Path) -> Path:
    """A leg's session as it is."""
    return folder_of(family, seed, folder)


def other(family: str, seed: int, folder: Path) -> Path:
    """With the relaxed trials of another leg."""
    folder_of(family, seed, folder)
    stranger = folder_of(family, seed + 1000, folder.with_name("stranger"))
    for name in RELAXED:
        shutil.copy(stranger / f"{name}.csv", folder)
    return folder


def moved(family: str, seed: int, folder: Path) -> Path:
    """With the foot moved between the relaxed trials and the others."""
    folder_of(family, seed, folder)
    for name in RELAXED:
        path = folder / f"{name}.csv"
        comment, header, *rows = path.read_text(encoding="utf-8").splitlines()
        table = np.array([row.split(",") for row in rows], dtype=float)
        column = next(i for i, c in enumerate(header.split(",")) if c.startswith("angle"))
        in_degrees = header.split(",")[column].endswith("deg")
        table[:, column] += MOVED if in_degrees else np.radians(MOVED)
        np.savetxt(path, table, "%.8g", ",", header=f"{comment}\n{header}", comments="")
    return folder


CASES: dict[str, Callable[[str, int, Path], Path]] = {
    "clean": clean,
    "other": other,
    "moved": moved,
}


def main() -> None:
    """Run the sessions and print what their pages say."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--families", default="va,p")
    parser.add_argument("--seeds", default="401-410")
    parser.add_argument("--only", default=",".join(CASES))
    parser.add_argument("--model", default="auto")
    asked = parser.parse_args()
    first, _, last = asked.seeds.partition("-")
    counts: Counter[tuple[str, str]] = Counter()
    for family in asked.families.split(","):
        for seed in range(int(first), int(last or first) + 1):
            for case in asked.only.split(","):
                begun = time.process_time()
                with tempfile.TemporaryDirectory() as place, blank_figures(made=False):
                    leg = CASES[case](family, seed, Path(place) / "leg")
                    run = surae.session(leg).run(Path(place) / "out", model=asked.model)
                    answer = run.answers()[QUESTION]
                    reasons = run.joint.adequacy.reasons if run.joint else ("no joint fit",)
                said = answer.split(":")[0].split(".")[0].split(",")[0]
                counts[case, said] += 1
                took = time.process_time() - begun
                print(f"{family}-{seed} {case}: {answer}", *reasons, sep="\n    ", flush=True)
                print(f"    {took:.0f} s", flush=True)
    for (case, said), n in sorted(counts.items()):
        print(f"{case}: {said} {n}")


if __name__ == "__main__":
    main()
