"""What is lost when streams and programs end at random moments, and what recording costs: figures
for decision 20.

    python benchmarks/live.py kills 30
    python benchmarks/live.py losses 30
    python benchmarks/live.py soak 60
    python benchmarks/live.py trials 50
    python benchmarks/live.py layouts 60 20

Every sample says when it was taken, so that what is missing can be counted. `soak` records and
makes frames for so many minutes, with a new file each minute; it prints a line for each. `trials`
makes trials of 10 s of the rehearsal, with eight more channels beside it, and says how long each
verdict took: in seconds, and in plain fits of the same trial, since other work makes both late.
`layouts` records for so many minutes while a stream is killed and comes back so many times, each
time with other channels, format, units or rate, beside one that stays; every sample says which
channel it is of.
"""

import json
import os
import random
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import psutil
import pyxdf

from surae_workbench.live.lsl import SESSION, lsl, outlet
from surae_workbench.live.recorder import Recorder
from surae_workbench.live.xdf import mended_xdf

RATE, CHANNELS = 2048.0, 8
#: Nothing is waited for longer [s].
LIMIT = 60.0


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


#: What a stream may come back as: its channels, units, format and rate [Hz].
LAYOUTS = (
    (("angle", "torque", "emg_sol"), "rad Nm V", "double64", 200.0),
    (("torque", "emg_sol", "angle"), "Nm V rad", "double64", 200.0),
    (("torque", "angle"), "Nm rad", "double64", 200.0),
    (("torque", "angle"), "Nm rad", "float32", 200.0),
    (("angle", "torque"), "deg Nm", "float32", 200.0),
    (("angle", "torque"), "deg Nm", "float32", 100.0),
    (("angle", "emg_sol", "torque"), "deg mV Nm", "int32", 100.0),
)
CODES = {"angle": 1, "torque": 2, "emg_sol": 3}


def device(name: str, layout: int) -> None:
    """Stream a layout until killed; a sample is its number, counted from 0, and its channel."""
    labels, units, kind, rate = LAYOUTS[layout]
    pylsl = lsl()
    info = pylsl.StreamInfo(name, "x", len(labels), rate, kind, f"benchmark {name}")
    info.set_channel_labels(list(labels))
    info.set_channel_units(units.split())
    stream = pylsl.StreamOutlet(info)
    codes = np.array([CODES[label] for label in labels])
    begun, sent = pylsl.local_clock(), 0
    while True:
        time.sleep(0.02)
        due = int((pylsl.local_clock() - begun) * rate)
        if due > sent:
            rows = 10 * np.arange(sent, due)[:, None] + codes
            stream.push_chunk(rows.astype(stream.np_dtype), begun + (due - 1) / rate)
            sent = due


def layouts(minutes: float, reconnections: int, seed: int = 1) -> Iterator[dict[str, object]]:
    """Each return of the stream, then what is in the files, trial by trial together."""
    from surae_workbench.live.pages import ServedRoom  # not for what only sends

    choice, seconds = random.Random(seed), 60.0 * minutes / (reconnections + 1)
    told: list[str] = []
    own = psutil.Process()
    with tempfile.TemporaryDirectory() as folder, process("device", "stays", "0"):
        (Path(folder) / "map.toml").write_text('[channels.angle]\ncolumn = "stays: angle"\n')
        served = ServedRoom(Path(folder) / "out", mapping=Path(folder) / "map.toml")
        room, recorder = served.room, served.room.trials.recorder
        served.events.tell = lambda topic, event, data: told.append(event)  # noqa: ARG005
        served.warm()
        begun, used = time.monotonic(), own.cpu_times()
        for index in range(reconnections + 1):
            with process("device", "changes", str(index % len(LAYOUTS))):
                if index % 3 == 0:
                    room.start()
                time.sleep(max(begun + (index + 1) * seconds - time.monotonic(), 1.0))
                json.dumps(served.state(), allow_nan=False)
                streams = {stream.name: stream for stream in recorder.streams.values()}
                if index % 3 == 1:
                    room.stop()
                yield {
                    "minute": round((time.monotonic() - begun) / 60.0, 1),
                    "layout": streams["changes"].layout_text,
                    "received": streams["changes"].received,
                    "frames": told.count("frame"),
                    "layouts_told": told.count("layout"),
                    "memory_MB": round(own.memory_info().rss / 1e6, 1),
                }
            time.sleep(choice.uniform(0.0, 3.0))
        took, spent = time.monotonic() - begun, own.cpu_times()
        used_s = spent.user + spent.system - used.user - used.system
        served.close()
        yield {
            "minutes": round(took / 60.0, 1),
            "percent_of_a_core": round(100.0 * used_s / took, 1),
            "trouble": recorder.trouble,
            **counted(Path(folder) / "out"),
        }


def counted(folder: Path) -> dict[str, int]:
    """Samples in the files of `layouts`; under another channel's label; missing of what stays, and
    within what changes."""
    samples = wrong = gaps = 0
    stays = []
    for path in sorted(folder.glob("*.xdf"), key=lambda path: path.stat().st_mtime):
        loaded, _ = pyxdf.load_xdf(path, synchronize_clocks=False, dejitter_timestamps=False)
        for stream in (s for s in loaded if s["info"]["type"][0] == "x"):
            values = stream["time_series"].astype(np.int64)
            channels = stream["info"]["desc"][0]["channels"][0]["channel"]
            codes = np.array([CODES[channel["label"][0]] for channel in channels])
            samples += len(values)
            wrong += int(np.sum((values % 10 != codes).any(axis=1)))
            if stream["info"]["name"][0] == "stays":
                stays.append(values[:, 0] // 10)
            else:
                gaps += int(np.sum(np.diff(values[:, 0] // 10) != 1))
    gaps_stays = int(np.sum(np.diff(np.concatenate(stays)) != 1))
    return {
        "samples": samples,
        "wrong": wrong,
        "gaps_in_changes": gaps,
        "gaps_in_stays": gaps_stays,
    }


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


def line(process: subprocess.Popen) -> str:
    """The next line that a process says, which must come in time."""
    assert process.stdout is not None
    with selectors.DefaultSelector() as ready:
        ready.register(process.stdout, selectors.EVENT_READ)
        assert ready.select(LIMIT), "the process says nothing"
    return process.stdout.readline()


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
                assert line(recorder) == "recording\n"
                time.sleep(choice.uniform(0.5, 3.0))
                recorder.send_signal(signal.SIGKILL)
                ended = lsl().local_clock()
                recorder.wait()
            mended_xdf(path)
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
                begins.append(int(line(sender)))
                limit = time.monotonic() + LIMIT
                while sum(came) < before + 100:
                    assert time.monotonic() < limit, "the stream is not found"
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


def soak(minutes: int) -> Iterator[dict[str, float]]:
    """Each minute: samples missing on disk so far, frames per second, processor [% of a core],
    memory [MB]."""
    from surae_workbench.live.showing import Showing

    frames: list[dict] = []
    showing = Showing(frames.append)
    roles = ("angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm")
    showing.roles = {f"soak: c{i}": (role, 1.0, 0.0) for i, role in enumerate(roles)}
    own = psutil.Process()
    with tempfile.TemporaryDirectory() as folder, process("send", "soak"):
        recorder = Recorder(
            Path(folder) / "0.xdf",
            show=showing.show,
            tell=lambda *what: None,  # noqa: ARG005
        )
        showing.run(recorder.clock, lambda: np.zeros(5))
        used, last, missing = own.cpu_times(), None, 0
        begun = time.monotonic()
        for minute in range(minutes):
            time.sleep(60.0)
            recorder.turn(Path(folder) / f"{minute + 1}.xdf")
            done = Path(folder) / f"{minute}.xdf"
            counted = subprocess.run(
                [sys.executable, __file__, "count", str(done)],
                stdout=subprocess.PIPE,
                check=True,
                text=True,
                timeout=10 * LIMIT,
            )
            first, newest, within = json.loads(counted.stdout)
            missing += within + (0 if last is None else first - last - 1)
            last = newest
            done.unlink()
            before, used = used, own.cpu_times()
            spent = used.user + used.system - before.user - before.system
            begun, seconds = time.monotonic(), time.monotonic() - begun
            yield {
                "minute": minute + 1,
                "missing": missing,
                "frames_per_s": round(len(frames) / seconds, 1),
                "percent_of_a_core": round(100.0 * spent / seconds, 1),
                "memory_MB": round(own.memory_info().rss / 1e6, 1),
                "load": round(os.getloadavg()[0], 1),
            }
            frames.clear()
        showing.close()
        recorder.close()


def trials(count: int) -> Iterator[dict[str, object]]:
    """For each trial: seconds from its end to its verdict, and seconds of a plain fit after it."""
    import surae
    from surae_workbench.live.room import Room

    with tempfile.TemporaryDirectory() as folder, process("send", "beside"):
        room = Room(folder, leg=1, joint=False)
        try:
            room.load(profile="multiple-holds", task="active", chirp_amplitude=0.1, duration=10.0)
            for _ in range(count):
                room.trials.warm.result(10 * LIMIT)
                number = room.start()
                while number not in room.trials.verdicts:
                    time.sleep(0.05)
                said = room.trials.verdicts[number].result(LIMIT)
                begun = time.monotonic()
                surae.fit(said["recording"], "muscle", starts=3, quality=[])
                yield {
                    "trial": number,
                    "verdict": said["verdict"],
                    "seconds_to_verdict": said["seconds_to_verdict"],
                    "seconds_of_a_fit": round(time.monotonic() - begun, 3),
                    "load": round(os.getloadavg()[0], 1),
                }
        finally:
            room.close()


if __name__ == "__main__":
    what, *rest = sys.argv[1:]
    os.environ.setdefault(SESSION, f"benchmark-{os.getpid()}")
    if what == "send":
        send(*rest)
    elif what == "record":
        record(*rest)
    elif what == "device":
        device(rest[0], int(rest[1]))
    elif what == "layouts":
        for each in layouts(float(rest[0]), int(rest[1])):
            print(json.dumps(each), flush=True)
    elif what == "count":
        numbers = numbers_in(Path(*rest))
        gone = int(numbers[-1] - numbers[0]) + 1 - len(numbers)
        print(json.dumps([int(numbers[0]), int(numbers[-1]), gone]))
    elif what in ("soak", "trials"):
        for each in {"soak": soak, "trials": trials}[what](int(rest[0])):
            print(json.dumps(each), flush=True)
    elif what == "kills":
        seconds = kills(int(rest[0]))
        print(json.dumps({"median_s": float(np.median(seconds)), "worst_s": max(seconds)}))
    else:
        lost, missing, noted = losses(int(rest[0]))
        told = {"median_s": float(np.median(lost)), "worst_s": max(lost)}
        print(json.dumps({**told, "missing_s": missing, "noted_s": noted}))
