"""The workbench under load: first page, sliders, 20 clients that fit at once, memory.

Run as ``python benchmarks/web.py [--clients 20] [--fits 100]``; it starts a server of its own.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import httpx
import numpy as np

import surae
from surae.protocol import Protocol, generate
from surae.recording import write_csv
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


def made(folder: Path, rate: float) -> Path:
    """A trial as a CSV."""
    motion = generate(
        Protocol(profile="multi-sine-holds", chirp_amplitude=0.2, chirp_rate=0.3, rate_hz=rate)
    )
    trial = virtual_trial(virtual_subject(3), motion)
    table = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque}
    table |= {f"emg_{m}_V": trial.emg[:, i] for i, m in enumerate(("ta", "gl", "sol", "gm"))}
    path = folder / f"trial-{rate:g}.csv"
    # Noise makes some samples of an envelope negative, which is refused as no envelope has any.
    table = {k: np.maximum(v, 0.0) if k.startswith("emg") else v for k, v in table.items()}
    write_csv(path, table, ["emg: envelope"])
    return path


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


def timed(client: Client, count: int) -> list[float]:
    """Times of a slider's answers [s]."""
    times = []
    for i in range(count):
        begin = time.perf_counter()
        body = {"values": {"k_tri": 150.0 + i}, "points": 1000}
        client.post("/api/live", json=body).raise_for_status()
        times.append(time.perf_counter() - begin)
    return times


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument("--fits", type=int, default=100)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        trial = made(folder, 125.0)
        begin = time.perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-m", "surae", "serve", str(folder / "project"), "--port", "0",
             "--no-open", "--workers", "2"],
            stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        try:
            address = process.stdout.readline().split()[2].rstrip("/")
            page = httpx.get(address)
            print(f"start to first page: {time.perf_counter() - begin:.2f} s ({page.status_code})")
            measure(address, process.pid, trial, folder, asked)
        finally:
            process.terminate()
            process.wait()


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
        timed(client, 3)
        quantiles(f"slider {model}, idle", timed(client, 50))
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
        sliders += timed(client, 2)
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


if __name__ == "__main__":
    main()
