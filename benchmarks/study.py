"""How fast studies run: the thesis's grid by workers and engine, and the cost of many small fits.

Every figure is of the command as a user runs it, start and planning included.
"""

import argparse
import csv
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil

GRID = """
name = "grid"
model = ["muscle", "muscle-tendon"]
protocol = ["sine", "multiple-holds", "multi-sine", "multi-sine-holds", "scaled-chirp"]
chirp_amplitude = [0.0, 0.1, 0.2, 0.3]
chirp_factor = [{rates}]
task = ["part-passive", "active"]
rate_hz = 125
starts = {starts}
"""
#: The smallest trial that still determines fifteen parameters: 18 s at 25 Hz.
SMALL = """
name = "small"
protocol = "ramp-and-hold"
rate_hz = 25
starts = 1
subjects = {subjects}
"""


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "surae", "study", *arguments]


def measured(study: str, folder: Path, *options: str) -> tuple[float, float, list[float]]:
    """Wall time [s], peak memory of all processes together [MB], seconds of every fit."""
    for old in folder.glob("s.db*"):
        old.unlink()
    (folder / "study.toml").write_text(study, encoding="utf-8")
    begin, peak = time.perf_counter(), 0
    with subprocess.Popen(
        command("run", "study.toml", "--store", "s.db", *options),
        cwd=folder,
        stdout=subprocess.DEVNULL,
    ) as process:
        top = psutil.Process(process.pid)
        while process.poll() is None:
            try:
                tree = [top, *top.children(recursive=True)]
                peak = max(peak, sum(member.memory_info().rss for member in tree))
            except psutil.NoSuchProcess:
                pass
            time.sleep(0.2)
    wall = time.perf_counter() - begin
    if process.returncode:
        sys.exit(process.returncode)
    subprocess.run(
        command("export", "s.db", "--output", "t.csv"),
        cwd=folder,
        check=True,
        stdout=subprocess.DEVNULL,
    )
    with (folder / "t.csv").open(newline="", encoding="utf-8") as handle:
        seconds = [float(row["seconds"]) for row in csv.DictReader(handle)]
    return wall, peak / 2**20, seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rates", type=int, default=23, help="chirp rates of the grid")
    parser.add_argument("--starts", type=int, default=2)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--small", type=int, nargs="*", default=[100, 1000, 5000, 20000])
    given = parser.parse_args()
    print("| study | fits | workers | wall s | fits/s | mean fit s | efficiency | MB |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    rates = ", ".join(f"{0.05 + 0.025 * k:.3f}" for k in range(given.rates))
    grid = GRID.format(rates=rates, starts=given.starts)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if given.rates:
            fits = 2 * 5 * 2 * (1 + 3 * given.rates)
            alone = 0.0
            for workers in given.workers:
                wall, peak, seconds = measured(grid, folder, "--workers", str(workers))
                alone = wall if workers == 1 else alone
                good = f"{alone / (workers * wall):.2f}" if alone else ""
                print(
                    f"| grid | {fits} | {workers} | {wall:.1f} | {fits / wall:.1f} "
                    f"| {statistics.mean(seconds):.3f} | {good} | {peak:.0f} |",
                    flush=True,
                )
        for subjects in given.small:
            wall, peak, seconds = measured(SMALL.format(subjects=subjects), folder)
            print(
                f"| small | {subjects} | processes | all | {wall:.1f} | {subjects / wall:.1f} "
                f"| {statistics.mean(seconds):.4f} | | {peak:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
