"""The workbench for minutes under browsers that never rest: times, memory, open files.

Run as ``python benchmarks/soak.py [--minutes 10] [--browsers 10]``; it starts a server of its own.
"""

import argparse
import random
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from contextlib import suppress
from pathlib import Path

from web import Client, made, memory


def main() -> None:
    """Serve, load, and print what was seen every minute and at the end."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--browsers", type=int, default=10)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        trial = made(folder, 125.0)
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "surae", "serve", str(folder / "project"), "--port", "0",
             "--no-open", "--workers", "1"],
            stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        try:
            assert process.stdout is not None
            address = process.stdout.readline().split()[2].rstrip("/")
            client = Client(address)
            recording = client.recording(trial)
            fit = client.fit(recording)
            time.sleep(5.0)
            for what in ("report", "inspect"):
                alone = [timed(client, what, recording, trial) for _ in range(5)]
                print(f"{what} alone: {statistics.median(alone):.2f} s (median of 5)", flush=True)
            soak(address, process.pid, recording, fit, trial, given)
        finally:
            process.terminate()
            process.wait()


def timed(client: Client, what: str, recording: str, trial: Path) -> float:
    """How long a browser waits for one thing [s]."""
    begin = time.perf_counter()
    if what == "report":  # of a new fit: one that was made is kept
        change = {"recordings": [recording], "prepared": True, "starts": 1}
        client.patch("/api/draft", json={"change": change, "label": "choose"})
        new = client.fit(recording)
        begin = time.perf_counter()
        client.get(f"/api/fits/{new}/report.html").raise_for_status()
    elif what == "inspect":
        name = {"name": trial.name}
        upload = client.post("/api/uploads", params=name, content=trial.read_bytes()).json()["id"]
        client.get(f"/api/uploads/{upload}/inspect").raise_for_status()
        client.delete(f"/api/uploads/{upload}")
    elif what == "slider":
        change = {"recordings": [recording], "prepared": True}
        client.patch("/api/draft", json={"change": change, "label": "choose"})
        begin = time.perf_counter()
        body = {"values": {"k_tri": 100.0 + 100.0 * random.random()}, "points": 1000}
        client.post("/api/live", json=body).raise_for_status()
    else:
        client.get(what).raise_for_status()
    return time.perf_counter() - begin


def soak(
    address: str, pid: int, recording: str, fit: str, trial: Path, given: argparse.Namespace
) -> None:
    """All browsers at once."""
    end = time.monotonic() + 60.0 * given.minutes
    times: dict[str, list[float]] = defaultdict(list)
    failures: list[str] = []
    kinds = (["/", "/fit", "/api/recordings", "/api/fits", f"/api/recordings/{recording}/window",
              f"/api/fits/{fit}/traces"] * 4 + ["slider"] * 8 + ["inspect"] * 2
             + [f"/api/fits/{fit}/report.html", "report"])  # fmt: skip

    def browse(seed: int) -> None:
        chance, client = random.Random(seed), Client(address)
        while time.monotonic() < end:
            what = chance.choice(kinds)
            try:
                times[what].append(timed(client, what, recording, trial))
            except Exception as error:
                failures.append(f"{what}: {error}")
            time.sleep(chance.uniform(0.0, 0.5))

    threads = [threading.Thread(target=browse, args=(n,)) for n in range(given.browsers)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
        print(f"{memory(pid):.0f} MB, {descriptors} descriptors", flush=True)
        with suppress(RuntimeError):
            threads[0].join(min(30.0, max(end - time.monotonic(), 1.0)))
        for thread in threads:
            if time.monotonic() > end:
                thread.join()
    for what, seen in sorted(times.items()):
        ordered = sorted(seen)
        late = [ordered[min(int(part * len(ordered)), len(ordered) - 1)] for part in (0.95, 0.99)]
        print(
            f"{what.replace(recording, '…').replace(fit, '…')}: {len(seen)}, median "
            f"{statistics.median(ordered):.3f} s, 95 % {late[0]:.3f} s, 99 % {late[1]:.3f} s, "
            f"worst {ordered[-1]:.3f} s"
        )
    print(f"failed: {len(failures)}", *failures[:5], sep="\n")


if __name__ == "__main__":
    main()
