"""What cohorts of virtual legs tell: whether weak values borrow, and group differences are true.

Healthy legs and patients in turn; every second pair is measured for a short while only, with little
effort. Each is fitted alone with model 1.0, then all together with `--refit`. Run it as

    .venv/bin/python benchmarks/cohort.py --legs 40 --cohorts 10
    .venv/bin/python benchmarks/cohort.py --legs 2000 --workers 2
"""

import argparse
import csv
import os
import resource
import tempfile
import time
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

import surae
from surae.measures import measures_of_values
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

GROUPS = ("healthy", "patient")
FULL = Protocol(
    profile="multiple-holds", task="part-passive", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=60.0
)
WEAK = Protocol(
    profile="ramp-and-hold", task="active", chirp_amplitude=0.02, chirp_rate=0.1, rate_hz=60.0
)
#: Legs by which a group's own mean is known.
DRAWN = 20_000


def truth(group: str, seed: int) -> dict[str, float]:
    """Parameters and measures of a leg."""
    p = dict(virtual_subject(seed, group).parameters)
    return {**measures_of_values(p, "muscle", angles=[10.0]), **p}


def fit_leg(seed: int, folder: Path) -> tuple[str, int, str]:
    """Measure and fit one leg; its row of the table."""
    group, weak = GROUPS[seed % 2], bool(seed // 2 % 2)
    motion = generate(WEAK if weak else FULL)
    trial = virtual_trial(virtual_subject(seed, group), motion, seed=seed)
    surae.fit(trial, "muscle", starts=2, quality=()).save(folder / f"{seed}.json")
    return f"{seed}.json", seed, group


def cohort_of(folder: Path, first: int, legs: int, workers: int) -> Path:
    """Measure and fit legs one by one; the table of them."""
    with ProcessPoolExecutor(workers) as pool:
        rows = list(pool.map(partial(fit_leg, folder=folder), range(first, first + legs)))
    table = folder / "cohort.csv"
    with table.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("fit", "subject", "group"), *rows])
    return table


def main() -> None:
    """Count errors of weak and strong legs, differences that hold, wall time and memory."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--legs", type=int, default=40)
    parser.add_argument("--cohorts", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    means = {
        group: {name: np.mean([leg[name] for leg in known]) for name in known[0]}
        for group in GROUPS
        if (known := [truth(group, 900_000 + seed) for seed in range(DRAWN)])
    }
    # Squared errors over the truth's size: of single fits, means of fits, and fits together.
    errors: dict[tuple[str, bool], list[tuple[float, float]]] = defaultdict(list)
    held: list[bool] = []
    plain: list[bool] = []
    for number in range(given.cohorts):
        first = given.first + number * given.legs
        with tempfile.TemporaryDirectory() as folder:
            begin = time.perf_counter()
            table = cohort_of(Path(folder), first, given.legs, given.workers)
            alone = time.perf_counter() - begin
            print(f"{given.legs} legs fitted alone in {alone:.0f} s", flush=True)
            begin, before = time.perf_counter(), sum(os.times()[:4])
            told = surae.cohort(table, refit=True, workers=given.workers)
            seconds, work = time.perf_counter() - begin, sum(os.times()[:4]) - before
        memory = [
            resource.getrusage(who).ru_maxrss / 1024
            for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        ]
        print(
            f"together in {seconds:.0f} s, {work:.0f} s of processor, {told.rounds} rounds, "
            f"{given.workers} workers; at most {memory[0]:.0f} MB here and {memory[1]:.0f} MB in "
            "the largest worker",
            flush=True,
        )
        known = {seed: truth(GROUPS[seed % 2], seed) for seed in range(first, first + given.legs)}
        for name, pooled in told.pooled.items():
            if name not in means["healthy"] or name.startswith("torque_per_emg"):
                continue
            for leg in pooled.legs:
                true = known[int(leg.leg)][name]
                weak = bool(int(leg.leg) // 2 % 2)
                errors[name, weak].append((leg.value - true, leg.shrunken - true))
            for contrast in pooled.differences.values():
                true = means["patient"][name] - means["healthy"][name]
                held.append(contrast.ci95[0] <= true <= contrast.ci95[1])
                single = [[e.value for e in pooled.legs if e.group == group] for group in GROUPS]
                apart = np.mean(single[1]) - np.mean(single[0])
                error = np.sqrt(sum(np.var(each, ddof=1) / len(each) for each in single))
                plain.append(abs(apart - true) <= 1.96 * error)
    print(
        f"\ngroup differences within their intervals: {np.mean(held):.1%} of {len(held)}; "
        f"of plain means of fits {np.mean(plain):.1%}"
    )
    print("\n| quantity | weak: alone | together | ratio | strong: alone | together | ratio |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for name in dict.fromkeys(name for name, _ in errors):
        size = abs(means["healthy"][name])
        cells = []
        for weak in (True, False):
            pairs = np.array(errors[name, weak])
            alone, together = np.sqrt(np.mean(pairs**2, axis=0)) / size if len(pairs) else (0, 0)
            cells += [f"{alone:.3f}", f"{together:.3f}", f"{together / max(alone, 1e-12):.2f}"]
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
