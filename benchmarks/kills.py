"""Kill the server, a study and an import again and again at random moments; nothing may be lost.

Run as ``python benchmarks/kills.py [--kills 100] [--seed 0]``. After every kill: no process of ours
is left after 5 s, the next start opens what there was, `surae project check` finds nothing wrong
with it, and everything whose answer had come is there.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import httpx

from surae.base.errors import InputError
from surae.studies.store import Store
from surae_workbench.web import upkeep
from web import made

SURAE = [sys.executable, "-P", "-m", "surae"]
STUDY = (
    'name = "kills"\nprotocol = ["sine", "multi-sine"]\nrate_hz = 20\nstarts = 1\nnoise = 0.05\n'
    "subjects = 2000\n"
)
#: How long a process may live on [s].
PATIENCE = 5.0


def family(mark: str) -> list[int]:
    """Processes that carry a mark in their environment, as children inherit it."""
    carriers = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError):
            if entry.name.isdigit() and mark.encode() in (entry / "environ").read_bytes():
                state = (entry / "stat").read_text().rsplit(")", 1)[1].split()[0]
                if state != "Z" and int(entry.name) != os.getpid():
                    carriers.append(int(entry.name))
    return carriers


def killed(
    command: list[str], folder: Path, during: Callable[[subprocess.Popen[str]], None]
) -> float:
    """Start a command, kill it −9 in the middle of something; how long its last child lived [s]."""
    mark = f"SURAE_KILLS={os.urandom(8).hex()}"
    name, _, value = mark.partition("=")
    process = subprocess.Popen(
        command,
        cwd=folder,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, name: value},
    )
    try:
        during(process)
    finally:
        with suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGKILL)
        process.wait()
        if process.stdout is not None:
            process.stdout.close()
    begin = time.monotonic()
    while left := family(mark):
        lived = time.monotonic() - begin
        if lived > PATIENCE:
            for pid in left:
                os.kill(pid, signal.SIGKILL)
            raise SystemExit(f"{len(left)} processes outlived their server by {lived:.1f} s")
        time.sleep(0.02)
    return time.monotonic() - begin


class Workbench:
    """A project that is served, written to and killed, and what it has promised to keep."""

    def __init__(self, folder: Path, trial: Path, chance: random.Random) -> None:
        self.folder, self.trial, self.chance = folder, trial, chance
        self.kept: dict[str, set[str]] = {"subjects": set(), "recordings": set(), "uploads": set()}
        self.cookies: dict[str, str] = {}

    def once(self) -> float:
        """One life of the server."""
        command = [
            *SURAE,
            "serve",
            str(self.folder / "project"),
            "--port",
            "0",
            "--no-open",
            "--workers",
            "1",
        ]
        lived = killed(command, self.folder, self.work)
        seen = upkeep.check(self.folder / "project")
        if seen.problems:
            raise SystemExit(f"wrong after a kill: {seen.problems}")
        return lived

    def work(self, process: subprocess.Popen[str]) -> None:
        """Look that everything is there, then write until the time has come."""
        assert process.stdout is not None
        address = process.stdout.readline().split()[2].rstrip("/")
        with httpx.Client(base_url=address, cookies=self.cookies, timeout=60.0) as client:
            client.headers["X-CSRF-Token"] = client.get("/api/session").json()["csrf"]
            self.cookies = dict(client.cookies)
            for what, ids in self.kept.items():
                there = {thing["id"] for thing in client.get(f"/api/{what}").json()[what]}
                if not ids <= there:
                    raise SystemExit(f"{what} lost: {ids - there}")
            # In the middle of a request, not between two.
            timer = threading.Timer(self.chance.uniform(0.0, 5.0), process.kill)
            timer.start()
            with suppress(httpx.TransportError):
                while process.poll() is None:
                    self.write(client)
            timer.join()

    def write(self, client: httpx.Client) -> None:
        """One change; once its answer has come it is kept."""
        code = f"S{self.chance.randrange(10**9)}"
        answer = client.post("/api/subjects", json={"code": code})
        if answer.status_code == 201:
            self.kept["subjects"].add(answer.json()["id"])
        if self.chance.random() < 0.3 and len(self.kept["uploads"]) < 60:
            data, name = self.trial.read_bytes(), {"name": "trial.csv"}
            upload = client.post("/api/uploads", params=name, content=data).json()["id"]
            self.kept["uploads"].add(upload)
            inspected = client.get(f"/api/uploads/{upload}/inspect").json()
            imported = client.post("/api/imports", json={"mapping": inspected["mapping"]})
            if imported.status_code == 201:
                recording = imported.json()["id"]
                self.kept["recordings"].add(recording)
                change = {"recordings": [recording], "prepared": True, "starts": 3}
                client.patch("/api/draft", json={"change": change, "label": "choose"})
                client.post("/api/fits", json={})


class Study:
    """A study that is run and killed; the outcomes that it had may only grow."""

    def __init__(self, folder: Path, chance: random.Random) -> None:
        self.folder, self.chance, self.done = folder, chance, 0
        (folder / "study.toml").write_text(STUDY)

    def once(self) -> float:
        """One run."""
        command = [*SURAE, "study", "run", "study.toml", "--store", "study.db", "--workers", "2"]

        def wait(process: subprocess.Popen[str]) -> None:
            end = time.monotonic() + 60.0
            while process.poll() is None and time.monotonic() < end and self.kept() <= self.done:
                time.sleep(0.1)  # until there is something more to lose
            time.sleep(self.chance.uniform(0.0, 3.0))

        lived = killed(command, self.folder, wait)
        done = self.kept()
        if done < self.done:
            raise SystemExit(f"outcomes lost: {self.done} before, {done} now")
        self.done = done
        return lived

    def kept(self) -> int:
        """The outcomes that are there."""
        if not (self.folder / "study.db").exists():
            return 0
        try:
            with Store(self.folder / "study.db") as store:
                return store.status().done
        except InputError:  # before there is a plan
            return 0


def main() -> None:
    """Kill, look, and say how it went."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--only", choices=("workbench", "study"))
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        trial = made(folder / "trial.csv", 32.0)
        bench, study = Workbench(folder, trial, chance), Study(folder, chance)
        lives = []
        for number in range(given.kills):
            turn = given.only or ("study" if number % 3 == 2 else "workbench")
            lives.append(study.once() if turn == "study" else bench.once())
            kept = ", ".join(f"{len(ids)} {what}" for what, ids in bench.kept.items())
            print(
                f"{number + 1} kills: {kept}, {study.done} outcomes kept; the last process lived "
                f"on for {max(lives):.2f} s at most",
                flush=True,
            )


if __name__ == "__main__":
    main()
