"""Mutated files to every reader: only our errors come out, within bounded memory and time.

    python benchmarks/fuzz_readers.py [--files 10000] [--reader NAME]… [--seconds 30] [--mib 1536]

Every reader runs in a process of its own with a limit on its memory; one that crashes, runs out of
time or raises anything else is reported with the seed that did it, and the script ends with 1.
"""

import argparse
import multiprocessing
import random
import resource
import sys
import tempfile
import time
import traceback
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "recording"))
from reader_seeds import SEEDS, TEXT, exercise, mutated


def mutation(reader: str, seed: int, originals: list[bytes]) -> bytes:
    rng = random.Random(f"{reader} {seed}")
    return mutated(rng.choice(originals), rng, text=reader in TEXT)


def work(reader: str, mib: int, path: Path, line: Connection) -> None:
    """Exercise the file for each seed that comes; answer with the outcome and the peak memory."""
    originals = [make() for make in SEEDS[reader]]
    for original in originals:
        path.write_bytes(original)
        exercise(path)
    resource.setrlimit(resource.RLIMIT_AS, (mib << 20, mib << 20))
    while (seed := line.recv()) is not None:
        path.write_bytes(mutation(reader, seed, originals))
        try:
            outcome = exercise(path)
        except BaseException:
            outcome = traceback.format_exc()
        line.send((outcome, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024))


def fuzz(reader: str, files: int, seconds: float, mib: int) -> bool:
    """Run one reader; True if nothing but our errors came out."""
    context = multiprocessing.get_context("spawn")
    counts: Counter[str] = Counter()
    slowest, peak, first = (0.0, 0), 0.0, time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "file"

        def start():
            ours, theirs = context.Pipe()
            process = context.Process(target=work, args=(reader, mib, path, theirs), daemon=True)
            process.start()
            theirs.close()
            return process, ours

        process, line = start()
        for seed in range(files):
            began = time.perf_counter()
            line.send(seed)
            try:
                # The first file of a process waits until it has started.
                outcome, used = line.recv() if line.poll(seconds + 60 * (not counts)) else ("", 0)
            except EOFError:
                outcome, used = "crash", 0.0
            if outcome not in ("read", "refused"):
                print(f"{reader}, seed {seed}: {outcome or 'out of time'}", flush=True)
                if outcome in ("", "crash"):
                    process.kill()
                    process, line = start()
                outcome = "WRONG"
            counts[outcome] += 1
            if len(counts) and seed:
                slowest = max(slowest, (time.perf_counter() - began, seed))
            peak = max(peak, used)
        line.send(None)
        process.join()
    took = time.perf_counter() - first
    print(
        f"{reader:10} {files} files: {counts['read']} read, {counts['refused']} refused, "
        f"{counts['WRONG']} wrong; {took:.0f} s, slowest {1e3 * slowest[0]:.0f} ms "
        f"(seed {slowest[1]}), peak {peak:.0f} MiB",
        flush=True,
    )
    return not counts["WRONG"]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", type=int, default=10_000)
    parser.add_argument("--reader", choices=sorted(SEEDS), action="append")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--mib", type=int, default=1536)
    given = parser.parse_args()
    done = [fuzz(r, given.files, given.seconds, given.mib) for r in given.reader or SEEDS]
    return 0 if all(done) else 1


if __name__ == "__main__":
    raise SystemExit(main())
