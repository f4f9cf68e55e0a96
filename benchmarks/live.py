"""What is lost when streams and programs end at random moments: figures for decision 20.

    python benchmarks/live.py kills 30
    python benchmarks/live.py losses 30

Every sample says when it was taken, so that what is missing can be counted.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyxdf

from surae.live.lsl import SESSION, lsl, outlet
from surae.live.recorder import Recorder
from surae.live.xdf import mended

RATE, CHANNELS = 2048.0, 8


def send(name: str) -> None:
    """Stream samples that are their own number on LSL's clock, until killed."""
    clock = lsl().local_clock
    labels = [f"c{i}" for i in range(CHANNELS)]
    stream = outlet(name, "x", labels, ["V"] * CHANNELS, RATE, f"benchmark {name}")
    sent = int(clock() * RATE)
    print(sent + 1, flush=True)
    while True:
        time.sleep(0.01)
        due = int(clock() * RATE)
        numbers = np.arange(sent + 1, due + 1, dtype=float)
        if len(numbers):
            stream.push_chunk(np.tile(numbers[:, None], CHANNELS), due / RATE)
        sent = due


def record(path: str) -> None:
    """Record until killed; says when the first samples came."""
    came = []

    def show(*what: object) -> None:  # noqa: ARG001
        if not came:
            came.append(True)
            print("recording", flush=True)

    Recorder(Path(path), show=show, tell=lambda *what: None)  # noqa: ARG005
    time.sleep(3600)


@contextmanager
def process(*arguments: str) -> Iterator[subprocess.Popen]:
    """This file as a process of its own."""
    made = subprocess.Popen(
        [sys.executable, __file__, *arguments], stdout=subprocess.PIPE, text=True
    )
    try:
        yield made
    finally:
        made.kill()
        made.communicate()


def numbers_in(path: Path) -> np.ndarray:
    """The numbers of the samples in a file, checked to be whole samples."""
    streams, _ = pyxdf.load_xdf(path, synchronize_clocks=False, dejitter_timestamps=False)
    values = next(s["time_series"] for s in streams if s["info"]["type"][0] == "x")
    assert (values == values[:, :1]).all()
    return np.round(values[:, 0]).astype(np.int64)


def kills(count: int, seed: int = 1) -> list[float]:
    """Seconds lost at each `kill -9` of the recorder."""
    choice, lost = random.Random(seed), []
    with tempfile.TemporaryDirectory() as folder, process("send", "a"):
        for index in range(count):
            path = Path(folder) / f"{index}.xdf"
            with process("record", str(path)) as recorder:
                assert recorder.stdout is not None
                assert recorder.stdout.readline() == "recording\n"
                time.sleep(choice.uniform(0.5, 3.0))
                recorder.send_signal(signal.SIGKILL)
                ended = lsl().local_clock()
                recorder.wait()
            mended(path)
            numbers = numbers_in(path)
            assert (np.diff(numbers) == 1).all()
            lost.append(ended - numbers[-1] / RATE)
    return lost


def losses(count: int, seed: int = 1) -> tuple[list[float], list[float], list[float]]:
    """At each `kill -9` and return of a stream: seconds lost of what was sent, seconds missing in
    the file, and seconds that the recorder noted as missing."""
    choice = random.Random(seed)
    noted: list[float] = []
    came: list[int] = []
    ends, begins = [], []

    def tell(event, data) -> None:
        if event == "gap":
            noted.append(data["seconds"])

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.xdf"
        recorder = Recorder(path, show=lambda *what: came.append(len(what[1])), tell=tell)
        for _ in range(count + 1):
            before = sum(came)
            with process("send", "a") as sender:
                assert sender.stdout is not None
                begins.append(int(sender.stdout.readline()))
                while sum(came) < before + 100:
                    time.sleep(0.01)
                time.sleep(choice.uniform(0.3, 2.0))
            ends.append(lsl().local_clock() * RATE)
            time.sleep(choice.uniform(0.0, 1.0))
        recorder.close()
        numbers = numbers_in(path)
    gaps = np.flatnonzero(np.diff(numbers) > 1)
    assert len(gaps) == count
    lost = [
        (numbers[gap + 1] - begin + max(end - numbers[gap], 0.0)) / RATE
        for gap, end, begin in zip(gaps, ends, begins[1:], strict=False)
    ]
    missing = [float(numbers[gap + 1] - numbers[gap] - 1) / RATE for gap in gaps]
    return lost, missing, noted


if __name__ == "__main__":
    what, *rest = sys.argv[1:]
    os.environ.setdefault(SESSION, f"benchmark-{os.getpid()}")
    if what == "send":
        send(*rest)
    elif what == "record":
        record(*rest)
    elif what == "kills":
        seconds = kills(int(rest[0]))
        print(json.dumps({"median_s": float(np.median(seconds)), "worst_s": max(seconds)}))
    else:
        lost, missing, noted = losses(int(rest[0]))
        told = {"median_s": float(np.median(lost)), "worst_s": max(lost)}
        print(json.dumps({**told, "missing_s": missing, "noted_s": noted}))
