"""Streams as they are: processes that end at any moment, clocks, a full disk, measured files."""

import errno
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from benchmark_files import load
from surae import fit, read
from surae.live.recorder import Recorder
from surae.live.trials import Trials


@pytest.fixture(scope="module")
def endings(lsl):
    """The benchmark of what is lost."""
    return load("live")


def test_a_killed_recorder_has_lost_less_than_a_second(endings) -> None:
    lost = endings.kills(3)
    assert max(lost) < 1.0


def test_a_stream_that_comes_back_is_taken_up_and_nothing_is_lost_silently(endings) -> None:
    lost, missing, noted = endings.losses(3)
    assert len(missing) == 3
    assert max(lost) < 2.0  # on a busy computer; alone it takes a fifth of a second
    np.testing.assert_allclose(noted, missing, atol=0.01)


def waited(holds, seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_samples_wait_for_room_on_a_full_disk(endings, tmp_path, monkeypatch) -> None:
    told, came = [], []
    with endings.process("send", "disk"):
        recorder = Recorder(
            tmp_path / "a.xdf",
            show=lambda *what: came.append(len(what[1])),
            tell=lambda event, data: told.append((event, dict(data))),
        )
        waited(lambda: came)
        write = os.write

        def full(file: int, data: bytes) -> int:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(os, "write", full)
        waited(lambda: recorder.trouble)
        assert "make room now" in recorder.trouble
        time.sleep(1.0)
        monkeypatch.setattr(os, "write", write)
        waited(lambda: not recorder.trouble)
        time.sleep(0.3)
        recorder.close()
    assert [data["message"] != "" for event, data in told if event == "disk"] == [True, False]
    numbers = endings.numbers_in(tmp_path / "a.xdf")
    assert (np.diff(numbers) == 1).all()
    assert len(numbers) > 1.2 * endings.RATE


DETERMINED = ("identified", "weak")


class Sender:
    """A recording as streams, one for all channels with the same times, faster than measured."""

    def __init__(self, recording) -> None:
        from surae.live.lsl import outlet

        groups: dict[tuple, list] = {}
        for c in recording.channels.values():
            groups.setdefault((len(c.time), c.time[0], c.time[-1]), []).append(c)
        self.groups = list(groups.values())
        self.names = {c.role: f"file {i}" for i, group in enumerate(self.groups) for c in group}
        self.outlets = [
            outlet(
                f"file {i}", "x", [c.role for c in group], [c.unit for c in group],
                group[0].rate_hz, f"file {i}",
            )
            for i, group in enumerate(self.groups)
        ]  # fmt: skip

    def send(self, clock, speed: float = 6.0) -> None:
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


@pytest.mark.parametrize("name", ["dynamometer/PL_50_01", "gait/walk36"])
def test_a_measured_file_gives_the_same_fit_as_if_live(lsl, shared, tmp_path, name) -> None:
    file = read(shared / f"{name}.toml")
    sender = Sender(file)
    mapping = tmp_path / "map.toml"
    lines = [f'emg = "{file.emg}"']
    for table in ("fixed", "prepare"):
        entries = [f"{key} = {json.dumps(value)}" for key, value in getattr(file, table).items()]
        lines += [f"[{table}]", *entries] if entries else []
    for role, channel in file.channels.items():
        lines += [f"[channels.{role}]", f'column = "{sender.names[role]}: {role}"',
                  f'unit = "{channel.unit}"']  # fmt: skip
    mapping.write_text("\n".join(lines), encoding="utf-8")
    trials = Trials(tmp_path / "live", mapping=mapping, joint=False)
    try:
        waited(
            lambda: (
                len(trials.recorder.streams) == len(sender.groups)
                and all(s.offset_s is not None for s in trials.recorder.streams.values())
            ),
            60,
        )
        trials.start()
        sender.send(trials.recorder.clock)
        time.sleep(0.5)
        said = trials.stop().result(300)
    finally:
        trials.close()
    live = read(said["recording"])
    for role, channel in file.channels.items():
        np.testing.assert_array_equal(live.channels[role].values, channel.values)
    expected, got = (fit(each, "muscle", quality=[]) for each in (file, live))
    assert said["vaf"] == pytest.approx(expected.vaf, abs=0.01)
    assert got.vaf == pytest.approx(expected.vaf, abs=0.01)
    determined = {n: p for n, p in expected.parameters.items() if p.verdict in DETERMINED}
    assert len(determined) > 3
    for parameter, estimate in determined.items():
        # The stamps' rate is measured, 1 in 10^6 off: samples fall otherwise on the model's axis.
        near = pytest.approx(estimate.value, rel=1e-3, abs=0.2 * (estimate.sem or 0.0))
        assert got.parameters[parameter].value == near, parameter


def test_a_trial_that_broke_off_is_named_and_judged_at_the_next_start(lsl, tmp_path) -> None:
    command = [sys.executable, "-m", "surae", "live", "--rehearse", "--unattended",
               "--output", str(tmp_path), "--seconds"]  # fmt: skip
    first = subprocess.Popen([*command, "60"], stdout=subprocess.DEVNULL)
    waited((tmp_path / "trial-01.xdf").exists, 240)
    time.sleep(14)
    first.send_signal(signal.SIGKILL)
    first.wait()
    assert not (tmp_path / "trial-01.json").exists()
    second = subprocess.run(
        [*command, "8"], capture_output=True, text=True, check=False, timeout=400
    )
    assert second.returncode == 0, second.stderr
    assert "trial 1 broke off" in second.stderr
    assert json.loads(second.stdout)["trial"] == 2
    kept = json.loads((tmp_path / "trial-01.json").read_text(encoding="utf-8"))
    assert "broke off" in kept["note"]
    assert kept["vaf"] > 90.0
    angle = read(kept["recording"]).channels["angle"]
    assert 12.0 < angle.time[-1] - angle.time[0] < 17.0
