"""The workbench under load: first page, sliders, 20 clients that fit at once, memory.

Run as ``python benchmarks/web.py [--clients 20] [--fits 100]``; it starts a server of its own. With
``--minutes 10`` the clients are browsers that never rest: times, memory, open files.
"""

import argparse
import json
import os
import random
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx
import numpy as np

import surae
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES, write_csv
from surae.studies import virtual_subject, virtual_trial


class Client(httpx.Client):
    """One browser."""

    def __init__(self, address: str) -> None:
        super().__init__(base_url=address, timeout=600.0)
        self.headers["X-CSRF-Token"] = self.get("/api/session").json()["csrf"]

    def recording(self, path: Path) -> str:
        data, name = path.read_bytes(), {"name": path.name}
        upload = self.post("/api/uploads", params=name, content=data).json()["id"]
        mapping = self.get(f"/api/uploads/{upload}/inspect").json()["mapping"]
        return self.post("/api/imports", json={"mapping": mapping}).json()["id"]

    def fit(self, recording: str) -> str:
        """Ask for a fit and wait; its id."""
        change = {"recordings": [recording], "prepared": True}
        self.patch("/api/draft", json={"change": change, "label": "choose"})
        job = self.post("/api/fits", json={}).json()
        while job["state"] in ("queued", "running"):
            time.sleep(0.1)
            job = self.get(f"/api/jobs/{job['id']}").json()
        assert job["state"] == "done", job
        return job["result"]


def made(path: Path, rate: float, noise: float = 0.05, **motion: Any) -> Path:
    """A trial of a virtual subject as a CSV."""
    usual = {"profile": "multi-sine-holds", "chirp_amplitude": 0.2, "chirp_rate": 0.3}
    trajectory = generate(Protocol(rate_hz=rate, **{**usual, **motion}))
    trial = virtual_trial(virtual_subject(3), trajectory, noise=noise)
    table = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque}
    # Noise makes some samples of an envelope negative, which is refused as no envelope has any.
    table |= {f"emg_{m}_V": np.maximum(trial.emg[:, i], 0.0) for i, m in enumerate(MUSCLES)}
    write_csv(path, table, ["emg: envelope"])
    return path


@contextmanager
def served(folder: Path, workers: int) -> Iterator[tuple[str, int]]:
    """Address and process of a server of its own."""
    process = subprocess.Popen(
        [
            sys.executable,
            "-P",
            "-m",
            "surae",
            "serve",
            str(folder / "project"),
            "--port",
            "0",
            "--no-open",
            "--workers",
            str(workers),
        ],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        yield process.stdout.readline().split()[2].rstrip("/"), process.pid
    finally:
        process.terminate()
        process.wait()


def memory(pid: int) -> float:
    """Resident memory of a process [MB]."""
    text = Path(f"/proc/{pid}/statm").read_text().split()[1]
    return int(text) * os.sysconf("SC_PAGE_SIZE") / 1e6


def quantiles(name: str, times: list[float]) -> None:
    ordered = sorted(times)
    print(
        f"{name}: median {1e3 * statistics.median(ordered):.1f} ms, 95 % "
        f"{1e3 * ordered[int(0.95 * len(ordered))]:.1f} ms, worst {1e3 * ordered[-1]:.1f} ms"
    )


def sliders_of(client: Client, count: int) -> list[float]:
    """Times of a slider's answers [s]."""
    times = []
    for i in range(count):
        begin = time.perf_counter()
        body = {"values": {"k_tri": 150.0 + i}, "points": 1000}
        client.post("/api/live", json=body).raise_for_status()
        times.append(time.perf_counter() - begin)
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument("--fits", type=int, default=100)
    parser.add_argument("--minutes", type=float, help="browse without a rest for so long")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        trial = made(folder / "trial.csv", 125.0)
        begin = time.perf_counter()
        with served(folder, 1 if asked.minutes else 2) as (address, pid):
            if asked.minutes:
                soak(address, pid, trial, asked)
                return
            page = httpx.get(address)
            print(f"start to first page: {time.perf_counter() - begin:.2f} s ({page.status_code})")
            measure(address, pid, trial, folder, asked)


def measure(address: str, pid: int, trial: Path, folder: Path, asked: argparse.Namespace) -> None:
    client = Client(address)
    recording = client.recording(trial)
    pages = []
    for _ in range(20):
        begin = time.perf_counter()
        client.get("/")
        pages.append(time.perf_counter() - begin)
    quantiles("a page, idle", pages)
    for model in ("muscle", "muscle-tendon"):
        change = {"recordings": [recording], "prepared": True, "model": model}
        client.patch("/api/draft", json={"change": change, "label": "model"})
        sliders_of(client, 3)
        quantiles(f"slider {model}, idle", sliders_of(client, 50))
    client.patch("/api/draft", json={"change": {"model": "muscle"}, "label": "model"})
    client.fit(recording)
    print(f"memory before: {memory(pid):.0f} MB")

    clients = [Client(address) for _ in range(asked.clients)]
    results: list[str] = []
    each = max(asked.fits // asked.clients, 1)

    def work(client: Client) -> None:
        results.extend(client.fit(recording) for _ in range(each))

    begin = time.perf_counter()
    threads = [threading.Thread(target=work, args=(client,)) for client in clients]
    for thread in threads:
        thread.start()
    pages, sliders = [], []
    while any(thread.is_alive() for thread in threads):
        start = time.perf_counter()
        client.get("/")
        pages.append(time.perf_counter() - start)
        sliders += sliders_of(client, 2)
        time.sleep(0.2)
    took = time.perf_counter() - begin
    print(f"{len(results)} fits by {asked.clients} clients at once: {took:.1f} s")
    quantiles("a page meanwhile", pages)
    quantiles("slider muscle meanwhile", sliders)
    print(f"memory after: {memory(pid):.0f} MB")

    surae.fit(trial, "muscle", prepared=True).save(folder / "fit.json")
    ours = json.loads((folder / "fit.json").read_text())["parameters"]
    same = sum(
        client.get(f"/api/fits/{id_}/fit.json").json()["parameters"] == ours for id_ in results
    )
    print(f"the same as surae.fit, to the last bit: {same} of {len(results)}")


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


def soak(address: str, pid: int, trial: Path, given: argparse.Namespace) -> None:
    """All browsers at once: times, memory and open files, every half minute and at the end."""
    client = Client(address)
    recording = client.recording(trial)
    fit = client.fit(recording)
    time.sleep(5.0)
    for what in ("report", "inspect"):
        alone = [timed(client, what, recording, trial) for _ in range(5)]
        print(f"{what} alone: {statistics.median(alone):.2f} s (median of 5)", flush=True)
    end = time.monotonic() + 60.0 * given.minutes
    times: dict[str, list[float]] = defaultdict(list)
    failures: list[str] = []
    kinds = (
        [
            "/",
            "/fit",
            "/api/recordings",
            "/api/fits",
            f"/api/recordings/{recording}/window",
            f"/api/fits/{fit}/traces",
        ]
        * 4
        + ["slider"] * 8
        + ["inspect"] * 2
        + [f"/api/fits/{fit}/report.html", "report"]
    )

    def browse(seed: int) -> None:
        chance, client = random.Random(seed), Client(address)
        while time.monotonic() < end:
            what = chance.choice(kinds)
            try:
                times[what].append(timed(client, what, recording, trial))
            except Exception as error:
                failures.append(f"{what}: {error}")
            time.sleep(chance.uniform(0.0, 0.5))

    threads = [threading.Thread(target=browse, args=(n,)) for n in range(given.clients)]
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
