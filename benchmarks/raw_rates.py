"""Raw EMG at several rates: what `auto` and `muscle` follow and identify, beside clean envelopes.

One trial of 35 s of each leg of `legs/`, active unless another kind is given, its raw EMG at
1024 Hz thinned to every second to fifth sample. Run it as

    .venv/bin/python benchmarks/raw_rates.py --families a,c,h --seeds 3201
"""

import argparse
import sys
import tempfile
import warnings
from collections import defaultdict
from pathlib import Path

import surae
from trust import numbers

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make, truth_of

#: Every so many samples of 1024 Hz; 0 is the leg's envelopes at 128 Hz.
EVERY = (0, 1, 2, 3, 4, 5)


def thinned(path: Path, every: int) -> Path:
    """The recording with one sample in so many, beside it."""
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    return_to = path.with_name(f"{path.stem}-{every}.csv")
    return_to.write_text("".join([*lines[:2], *lines[2::every]]), encoding="utf-8")
    return return_to


def main() -> None:
    """Fit and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,c,h")
    parser.add_argument("--seeds", type=numbers, default=numbers("3201"))
    parser.add_argument("--kind", default="active", help="the movement, of ankle_legs.movement")
    parser.add_argument(
        "--every", type=numbers, default=EVERY, help="samples of 1024 Hz, 0 is none"
    )
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    counts: dict[int, list[float]] = defaultdict(lambda: [0.0] * 5)
    print("leg        rate   R2 auto  muscle   identified  true  status")
    for family in given.families.split(","):
        for seed in given.seeds:
            truth = truth_of(family, seed, 1, (given.kind,))["parameters"]
            with tempfile.TemporaryDirectory() as folder:
                for every in given.every:
                    path = make(family, seed, Path(folder), (1,), raw=bool(every), kind=given.kind)[
                        0
                    ]
                    path = thinned(path, every) if every else path
                    plain, whole = (surae.fit(path, m, quality=()) for m in ("muscle", "auto"))
                    known = [
                        p
                        for n, p in whole.parameters.items()
                        if p.verdict == "identified" and truth.get(n) is not None
                    ]
                    true = sum(p.ci95[0] <= truth[p.name] <= p.ci95[1] for p in known)
                    r2 = whole.adequacy.r2, plain.adequacy.r2
                    rate = f"{1024 // every} Hz" if every else "envelope"
                    print(
                        f"{family}-{seed:<6} {rate:>9} {r2[0]:8.2f} {r2[1]:7.2f} {len(known):>8}"
                        f" {true:>8}  {whole.status}",
                        flush=True,
                    )
                    row = counts[every]
                    for i, one in enumerate((1, len(known), true, r2[0] < r2[1] - 0.5)):
                        row[i] += one
                    row[4] = max(row[4], r2[1] - r2[0])
    for every, (n, known, true, less, most) in counts.items():
        rate = f"{1024 // every} Hz" if every else "envelope"
        print(
            f"{rate:>9}: {n:.0f} legs, identified {known:.0f}, true {true:.0f}; more than 0.5 "
            f"points below muscle {less:.0f} (at most {most:.2f})"
        )


if __name__ == "__main__":
    main()
