"""What tests of live streams share: waiting with a limit, recordings as streams, rehearsals."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from answering import Answering
from surae.processes import End
from surae.recording import Recording
from surae_workbench.live.lsl import SESSION, outlet
from surae_workbench.live.pages import ServedRoom, create_app
from surae_workbench.live.recorder import Recorder
from surae_workbench.live.xdf import XdfLog
from surae_workbench.web.security import Policy

XML = (
    "<info><name>{name}</name><type>x</type><channel_count>{n}</channel_count>"
    "<nominal_srate>{rate}</nominal_srate><channel_format>{kind}</channel_format><desc><channels>"
    "{channels}</channels></desc></info>"
)


def described(name: str, labels: dict[str, str], rate: float, kind: str = "double64") -> str:
    """A stream as XDF describes it, its labels with their units."""
    channels = "".join(
        f"<channel><label>{label}</label><unit>{unit}</unit></channel>"
        for label, unit in labels.items()
    )
    return XML.format(name=name, n=len(labels), rate=rate, kind=kind, channels=channels)


def as_rehearsed(recording: Recording, path: Path) -> None:
    """Write a recording as the rehearsal's two streams would lie on disk."""
    log = XdfLog(path)
    for number, name in enumerate(("manipulator", "EMG"), 1):
        channels = [
            channel
            for role, channel in recording.channels.items()
            if role.startswith("emg_") == (name == "EMG")
        ]
        labels = {channel.role: channel.unit for channel in channels}
        log.stream(number, described(name, labels, channels[0].rate_hz))
        time = channels[0].time
        log.clock(number, float(time[0]), 0.0)
        values = np.column_stack([channel.values for channel in channels])
        for piece in np.array_split(np.arange(len(time)), 50):
            log.samples(number, time[piece], values[piece])
    log.close()


def waited(holds: Callable[[], object], seconds: float = 120.0) -> None:
    """Wait until something holds; the limit is for a busy computer."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, f"it did not come within {seconds} s"
        time.sleep(0.02)


@contextmanager
def serving(served: ServedRoom, policy: Policy, subject: str | None) -> Iterator[str]:
    """The pages on a port of this computer, as others beyond it would reach them or not."""
    answering = Answering(create_app(served, policy, subject), log_level="critical")
    yield answering.address
    answering.close()


class Sender:
    """A recording as streams, one for all channels with the same times, faster than measured."""

    def __init__(self, recording: Recording) -> None:
        groups: dict[tuple, list] = {}
        for c in recording.channels.values():
            groups.setdefault((len(c.time), c.time[0], c.time[-1]), []).append(c)
        self.groups = list(groups.values())
        self.sources = [f"file {i}" for i in range(len(self.groups))]
        self.outlets = [
            outlet(
                source,
                "x",
                [c.role for c in group],
                [c.unit for c in group],
                group[0].rate_hz,
                source,
            )
            for source, group in zip(self.sources, self.groups, strict=True)
        ]
        names = {c.role: s for s, g in zip(self.sources, self.groups, strict=True) for c in g}
        lines = [f'emg = "{recording.emg}"']
        for table in ("fixed", "prepare"):
            entries = getattr(recording, table).items()
            lines += [f"[{table}]", *(f"{k} = {json.dumps(v)}" for k, v in entries)]
        for role, channel in recording.channels.items():
            lines += [
                f"[channels.{role}]",
                f'column = "{names[role]}: {role}"',
                f'unit = "{channel.unit}"',
            ]
        self.mapping = "\n".join(lines)

    def heard(self, recorder: Recorder) -> bool:
        """Whether a recorder has all streams, and knows their clocks; it may have others, too."""
        known = {s.name for s in recorder.streams.values() if s.offset_s is not None}
        return known >= set(self.sources)

    def received(self, recorder: Recorder) -> dict[str, int]:
        """How many samples of each of its streams a recorder has."""
        streams = recorder.streams.values()
        return {s.name: s.received for s in streams if s.name in self.sources}

    def send(self, clock: Callable[[], float], speed: float = 12.0) -> None:
        """Send all of it."""
        begin = clock() + 0.1
        first = min(float(group[0].time[0]) for group in self.groups)
        sent = [0] * len(self.groups)
        while any(n < len(g[0].time) for n, g in zip(sent, self.groups, strict=True)):
            time.sleep(0.02)
            now = first + speed * (clock() - begin)
            for i, group in enumerate(self.groups):
                due = int(np.searchsorted(group[0].time, now))
                if due > sent[i]:
                    stamps = begin + group[0].time[sent[i] : due] - first
                    values = np.column_stack([c.values[sent[i] : due] for c in group])
                    self.outlets[i].push_chunk(values, list(stamps))
                    sent[i] = due


class Quick:
    """A judge that says at once that all is well, and what it was asked."""

    def __init__(self, **_: object) -> None:
        self.arguments: dict = {}

    def call(self, _: str, arguments: dict) -> End:
        self.arguments = arguments
        said = {"findings": [], "verdict": "keep", "advice": "", "use": "fit"}
        return End("done", {**said, "effort": arguments.get("instructed"), **arguments})

    def close(self) -> None:
        pass


@contextmanager
def rehearsing(folder: Path, *arguments: str) -> Iterator[subprocess.Popen]:
    """A rehearsal in a process, and a session of LSL, of its own."""
    made = subprocess.Popen(
        [sys.executable, "-m", "surae", "live", "--rehearse", "--output", str(folder), *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={name: value for name, value in os.environ.items() if name != SESSION},
    )
    try:
        yield made
    finally:
        made.kill()
        made.communicate(timeout=120.0)


def rehearsed(folder: Path, *arguments: str, limit: float = 270.0) -> tuple[list[dict], str]:
    """An unattended rehearsal: what it says of each trial, and of what it began with."""
    with rehearsing(folder, "--unattended", *arguments) as process:
        told, wrong = process.communicate(timeout=limit)
        assert process.returncode == 0, wrong
    return [json.loads(line) for line in told.splitlines()], wrong
