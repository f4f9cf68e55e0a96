"""What others may send, leave in the folder, or do to the disk and the clocks."""

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyxdf
from streaming import Quick, described, waited

from surae.base.errors import InputError
from surae.recording import read
from surae_workbench.live.pages import ServedRoom
from surae_workbench.live.recorder import Recorder
from surae_workbench.live.room import Room
from surae_workbench.live.showing import Showing
from surae_workbench.live.stream import Stream
from surae_workbench.live.trials import Trials, silent
from surae_workbench.live.xdf import XdfLog

CODES = {"angle": 1.0, "torque": 2.0, "emg_sol": 3.0}
UNITS = {"angle": "rad", "torque": "Nm", "emg_sol": "V"}
LABELS = ("angle", "torque", "emg_sol")


class Device:
    """A stream each of whose channels sends its own code; `source` is what LSL knows it by.

    It must outlive who records it: LSL may crash who ends a stream while it is sent.
    """

    def __init__(self, lsl, labels=LABELS, units=None, rate=100.0, kind="double64", source="dev"):
        info = lsl.StreamInfo(source, "x", len(labels), rate, kind, source)
        info.set_channel_labels(list(labels))
        info.set_channel_units([(units or UNITS)[label] for label in labels])
        self.clock, self.rate = lsl.local_clock, rate
        self.row = [CODES[label] for label in labels]
        self.outlet = lsl.StreamOutlet(info)

    def send(self, count=10, *, row=None, stamps=None) -> None:
        """Send samples that end now, or with time stamps of their own."""
        rows = np.tile(row or self.row, (count, 1))
        kind = self.outlet.channel_format
        types = {1: np.float32, 4: np.int32, 5: np.int16}
        rows = np.ascontiguousarray(rows, dtype=types.get(kind, np.float64))
        self.outlet.push_chunk(rows, self.clock() if stamps is None else list(stamps))

    def all_arrive(self, recorder, count=200) -> None:
        """Send samples, all of which come; those before them may still be on their way."""
        time.sleep(0.3)
        before = of(recorder).received
        for _ in range(count // 10):
            self.send()
            time.sleep(0.01)
        waited(lambda: of(recorder).received == before + count)

    def until(self, holds) -> None:
        """Send until something holds."""

        def sending() -> object:
            self.send(2)
            return holds()

        waited(sending)


def of(recorder, name="dev") -> Stream | None:
    return next((s for s in recorder.streams.values() if s.name == name), None)


def returned(recorder, device: Device) -> None:
    """Have the stream lost and found again as another device's, which has its source."""
    before = of(recorder)
    time.sleep(0.5)  # it is known by then
    lost = before.uid
    recorder._lose(before)
    device.until(lambda: heard(recorder) and of(recorder).uid != lost)


def heard(recorder, name="dev") -> bool:
    stream = of(recorder, name)
    return stream is not None and stream.state == "good" and stream.received > 0


@contextmanager
def recording(folder, told=None, show=silent):
    tell = silent if told is None else lambda event, data: told.append((event, dict(data)))
    recorder = Recorder(folder / "a.xdf", show=show, tell=tell)
    try:
        yield recorder
    finally:
        recorder.close()


def columns(path) -> dict[str, np.ndarray]:
    """What a file's numbers are, by stream and label."""
    found = {}
    for stream in pyxdf.load_xdf(path, synchronize_clocks=False, dejitter_timestamps=False)[0]:
        if stream["info"]["type"][0] != "x" or not len(stream["time_stamps"]):
            continue
        channels = stream["info"]["desc"][0]["channels"][0]["channel"]
        for place, channel in enumerate(channels):
            name = f"{stream['info']['name'][0]}: {channel['label'][0]}"
            assert name not in found
            found[name] = stream["time_series"][:, place]
    return found


def test_a_stream_that_returns_with_another_layout_is_another_stream(lsl, tmp_path) -> None:
    other = ("torque", "emg_sol", "angle")
    told: list[tuple[str, dict]] = []
    with recording(tmp_path, told) as recorder:
        device = Device(lsl)
        device.until(lambda: heard(recorder))
        again = Device(lsl, other)
        returned(recorder, again)
        assert "came back as another stream" in of(recorder).health(recorder.clock())["remark"]
    found = columns(tmp_path / "a.xdf")
    assert set(found) == {
        *(f"dev: {label}" for label in LABELS),
        *(f"dev (2): {label}" for label in other),
    }
    for name, values in found.items():
        assert (values == CODES[name.partition(": ")[2]]).all(), name
    assert [data["stream"] for event, data in told if event == "layout"] == ["dev"]


def test_a_stream_that_returns_as_it_was_goes_on(lsl, tmp_path) -> None:
    told: list[tuple[str, dict]] = []
    with recording(tmp_path, told) as recorder:
        device = Device(lsl)
        device.until(lambda: heard(recorder))
        again = Device(lsl)
        returned(recorder, again)
    assert set(columns(tmp_path / "a.xdf")) == {f"dev: {label}" for label in LABELS}
    assert "layout" not in [event for event, _ in told]


def test_two_streams_of_one_source_are_both_recorded(lsl, tmp_path) -> None:
    info = lsl.StreamInfo("second", "x", 1, 100.0, "double64", "dev")
    info.set_channel_labels(["angle"])
    second = lsl.StreamOutlet(info)
    with recording(tmp_path) as recorder:
        device = Device(lsl)

        def both() -> bool:
            second.push_chunk(np.ones((2, 1)), lsl.local_clock())
            return heard(recorder) and heard(recorder, "second")

        device.until(both)
    assert {"dev: angle", "second: angle"} <= set(columns(tmp_path / "a.xdf"))


@pytest.fixture
def judged_at_once(lsl, tmp_path, monkeypatch):
    """A folder whose trials are judged without computing."""
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    (tmp_path / "mapping.toml").write_text("[channels]\n")
    return tmp_path


def test_a_trial_in_which_the_layout_changed_is_repeated(lsl, judged_at_once) -> None:
    trials = Trials(judged_at_once, joint=False)
    try:
        first = Device(lsl)
        first.until(lambda: heard(trials.recorder))
        trials.start()
        before = of(trials.recorder).received
        first.until(lambda: of(trials.recorder).received > before)
        device = Device(lsl, ("torque", "angle"))
        returned(trials.recorder, device)
        told = trials.stop().result(20)
        assert (told["verdict"], "came back as another stream" in told["advice"]) == (
            "repeat",
            True,
        )
        trials.start()  # nothing of the old one is in this file
        before = of(trials.recorder).received
        device.until(lambda: of(trials.recorder).received > before)
        assert trials.stop().result(20)["verdict"] == "keep"
    finally:
        trials.close()
    found = columns(judged_at_once / "trial-02.xdf")
    assert {name: values[0] for name, values in found.items()} == {
        "dev: torque": 2.0,
        "dev: angle": 1.0,
    }


def test_words_that_are_no_utf8_starve_nobody(lsl, tmp_path) -> None:
    words = lsl.StreamOutlet(lsl.StreamInfo("a words", "Markers", 1, 0.0, "string", "a words"))
    with recording(tmp_path) as recorder:
        device = Device(lsl)

        def both() -> bool:
            words.push_sample([b"caf\xe9 \xff\xfe"])
            return heard(recorder) and heard(recorder, "a words")

        device.until(both)
        device.all_arrive(recorder)
        assert recorder.trouble == ""
    streams, _ = pyxdf.load_xdf(tmp_path / "a.xdf", dejitter_timestamps=False)
    said = next(s for s in streams if s["info"]["name"][0] == "a words")["time_series"]
    assert said[0] == ["caf\N{REPLACEMENT CHARACTER} " + 2 * "\N{REPLACEMENT CHARACTER}"]


def test_a_stream_that_fails_costs_the_others_nothing(lsl, tmp_path, monkeypatch) -> None:
    written = Stream.mended

    def failing(stream, *what):
        if stream.name == "bad":
            raise ZeroDivisionError
        return written(stream, *what)

    monkeypatch.setattr(Stream, "mended", failing)
    with recording(tmp_path) as recorder:
        bad, device = Device(lsl, source="bad"), Device(lsl)
        bad.until(lambda: of(recorder, "bad"))
        device.until(lambda: heard(recorder))
        for _ in range(20):
            bad.send()
        device.all_arrive(recorder)
        assert "ZeroDivisionError" in recorder.trouble


def test_one_program_writes_to_a_folder(judged_at_once) -> None:
    trials = Trials(judged_at_once, joint=False)
    with pytest.raises(InputError, match="another surae live records here"):
        Trials(judged_at_once, joint=False)
    trials.close()
    Trials(judged_at_once, joint=False).close()


@pytest.mark.parametrize("name", ["trial-01.xdf", "trial-01.h5", "trial-01-target.csv"])
def test_a_number_that_is_taken_is_passed_over_and_nothing_waits(
    judged_at_once, monkeypatch, name
) -> None:
    trials = Trials(judged_at_once, joint=False)
    try:
        (judged_at_once / name).write_bytes(b"somebody's")
        assert trials.start() == 2
        trials.stop().result(20)
        (judged_at_once / "trial-03.xdf").write_bytes(b"somebody's")
        monkeypatch.setattr(Trials, "_free", lambda _: 3)  # it came after it was looked for
        assert trials.start() == 4
        assert trials.recorder.trouble == ""
        assert (judged_at_once / "trial-04.xdf").stat().st_size > 100
        trials.stop().result(20)
    finally:
        trials.close()
    assert (judged_at_once / name).read_bytes() == b"somebody's"
    assert (judged_at_once / "trial-03.xdf").read_bytes() == b"somebody's"


NAMES = (
    "trial-01.xdf",
    "trial-01.h5",
    "trial-01.json",
    "trial-01-target.csv",
    "next-target.csv",
    "joint.json",
    "measure-next.csv",
    "mapping.toml",
    "between-01.xdf",
    "live.lock",
)


@pytest.mark.parametrize("name", NAMES)
def test_a_link_in_the_folder_is_refused_and_what_it_leads_to_untouched(lsl, tmp_path, name):
    (tmp_path / "mine").write_bytes(b"XDF:mine")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).symlink_to(tmp_path / "mine")
    with pytest.raises(InputError, match=name):
        Room(tmp_path / "out")
    assert (tmp_path / "mine").read_bytes() == b"XDF:mine"


@pytest.mark.parametrize("name", ["trial-01.xdf", "trial-01.json", "mapping.toml"])
def test_a_file_that_others_share_and_a_pipe_are_refused(lsl, tmp_path, name) -> None:
    (tmp_path / "mine").write_bytes(b"XDF:mine")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).hardlink_to(tmp_path / "mine")
    with pytest.raises(InputError, match="no file of its own"):
        Trials(tmp_path / "out")
    (tmp_path / "out" / name).unlink()
    os.mkfifo(tmp_path / "out" / name)
    with pytest.raises(InputError, match="no file of its own"):
        Trials(tmp_path / "out")
    assert (tmp_path / "mine").read_bytes() == b"XDF:mine"


@pytest.mark.parametrize("name", ["trial-01.xdf", "joint.json", "measure-next.csv", "mapping.toml"])
def test_a_link_that_is_put_there_meanwhile_is_not_followed(judged_at_once, name) -> None:
    outside = judged_at_once / "outside"
    outside.mkdir()
    (outside / "mine").write_bytes(b"mine")
    room = Room(judged_at_once / "out", mapping=judged_at_once / "mapping.toml")
    try:
        target = judged_at_once / "out" / name
        target.symlink_to(outside / "mine")
        with suppress(InputError):
            room.load(profile="sine", task="active", duration=20.0)
            room.start()
            target.unlink(missing_ok=True)
            target.symlink_to(outside / "mine")
            room.stop().result(20)
        room.trials.session["proposed"] = "x"
        if name == "measure-next.csv":
            with pytest.raises(InputError, match="is a link"):
                room.load_next()
    finally:
        room.close()
    assert [path.name for path in outside.iterdir()] == ["mine"]
    assert (outside / "mine").read_bytes() == b"mine"


def test_finite_samples_are_shown_and_the_others_are_not() -> None:
    showing, frames = Showing(silent), []
    showing._send = frames.append
    showing.roles = {f"D: {role}": (role, 1.0, 0.0) for role in ("angle", "torque", "emg_sol")}
    stream = Stream(2, "D", "x", "here", ["angle", "torque", "emg_sol"], [""] * 3, 100.0, False, "")
    rows = np.array([[1.0, np.nan, 2.0], [np.nan, np.inf, 1e308], [3.0, -np.inf, -1e308]])
    showing.show(stream, np.array([1.0, 1.01, 1.02]), rows)
    showing.show(stream, np.array([1.03]), np.array([[2.0, np.nan, np.nan]]))
    showing.run(lambda: 2.0, lambda: np.zeros(5))
    waited(lambda: frames)
    showing.close()
    assert frames[0]["new"] == {
        "angle": [1.0, 3.0, 2.0],
        "torque": None,
        "emg_sol": [2.0, 2.0, 2.0],
    }
    json.dumps(frames, allow_nan=False)


@pytest.mark.parametrize("stamp", [np.nan, pytest.param(1.7e9, marks=pytest.mark.slow)])
def test_values_and_stamps_that_are_no_numbers_end_nothing(lsl, tmp_path, stamp) -> None:
    (tmp_path / "map.toml").write_text('[channels.angle]\ncolumn = "dev: angle"\n')
    served = ServedRoom(tmp_path / "out", mapping=tmp_path / "map.toml")
    recorder = served.room.trials.recorder
    frames: list[dict] = []
    served.showing._send = frames.append
    served.warm()
    try:
        device = Device(lsl)
        device.until(lambda: heard(recorder))
        now = device.clock()
        device.send(3, row=[np.nan, np.inf, 1.0], stamps=[now, stamp, now + 0.02])
        before = of(recorder).received
        device.until(lambda: of(recorder).received > before + 20)
        state = served.state()
        json.dumps(state, allow_nan=False)
        json.dumps(frames, allow_nan=False)
        (health,) = state["streams"]
        assert health["not_finite"] == 6
        assert health["bad_stamps"] == (0 if np.isfinite(stamp) and abs(stamp) < 1e11 else 1)
        shown = len(frames)
        device.until(lambda: any(f["new"].get("angle") for f in frames[shown:]))
    finally:
        served.close()
    stamps = [
        s["time_stamps"]
        for s in pyxdf.load_xdf(tmp_path / "out" / "between-01.xdf", dejitter_timestamps=False)[0]
    ]
    assert all(np.isfinite(each).all() and (np.abs(each) < 1e11).all() for each in stamps)


@pytest.mark.parametrize("kind", ["int16", "int32"])
def test_integers_are_recorded_as_they_are(lsl, tmp_path, kind) -> None:
    """A converter's counts; their scale is the mapping's matter, as of any file."""
    with recording(tmp_path) as recorder:
        device = Device(lsl, kind=kind)
        device.row = [-120.0, 30000.0, 7.0]
        device.until(lambda: heard(recorder))
        device.all_arrive(recorder)
    found = {name: set(values.tolist()) for name, values in columns(tmp_path / "a.xdf").items()}
    assert found == {"dev: angle": {-120}, "dev: torque": {30000}, "dev: emg_sol": {7}}


def test_whatever_samples_look_like_is_a_layout() -> None:
    one = Stream(2, "D", "x", "here", ["angle"], ["rad"], 100.0, False, "", format=2)
    for other in ({"labels": ["torque"]}, {"units": ["deg"]}, {"rate_hz": 50.0}, {"format": 1}):
        assert replace(one, **other).layout != one.layout
    assert replace(one, uid="another").layout == one.layout


def test_a_stamp_that_is_none_is_where_its_neighbours_say() -> None:
    stream = Stream(2, "D", "x", "here", ["angle"], [""], 100.0, False, "")
    times = 7.0 + np.arange(10) / 100.0
    wrong = times.copy()
    wrong[[0, 4, 5, 9]] = np.inf, np.nan, -np.inf, 1e200
    np.testing.assert_allclose(stream.mended(wrong, 8.0), times)
    np.testing.assert_allclose(stream.mended(np.full(10, np.nan), times[-1]), times)
    stream.stamp = 6.99
    np.testing.assert_allclose(stream.mended(np.full(10, np.nan), 8.0), times)
    assert stream.bad_stamps == 24


def test_the_wall_clock_may_jump(lsl, tmp_path, monkeypatch) -> None:
    told: list[tuple[str, dict]] = []
    wall, jump = time.time, [0.0]
    monkeypatch.setattr(time, "time", lambda: wall() + jump[0])
    with recording(tmp_path, told) as recorder:
        device = Device(lsl)
        device.until(lambda: heard(recorder))
        for jump[0] in (86400.0, -86400.0 * 400):
            device.all_arrive(recorder)
    assert not {event for event, _ in told} & {"lost", "disk"}


def test_without_streams_none_is_named(lsl, tmp_path) -> None:
    served = ServedRoom(tmp_path / "out")
    try:
        waited(lambda: heard(served.room.trials.recorder, "surae target"))
        assert served.health()["streams"] == []
    finally:
        served.close()


DAMAGED = {
    "no table": "[]",
    "cut short": '{"trial": 1, "st',
    "NaN": '{"trial": 1, "state": "judged", "marks": [], "verdict": "keep", "seconds": NaN}',
    "infinite": '{"trial": 1, "state": "judged", "marks": [], "verdict": "keep", "x": 1e999}',
    "half a letter": '{"trial": 1, "state": "judged", "marks": [], "why": "\\ud800"}',
    "half elsewhere": '{"trial": 1, "state": "judged", "marks": [], "x": "\\ud800"}',
    "another's": '{"trial": 2, "state": "judged", "marks": [], "verdict": "keep"}',
    "no verdict": '{"trial": 1, "state": "judged", "marks": [], "verdict": "splendid"}',
    "no state": '{"trial": 1, "marks": [], "verdict": "keep"}',
    "no VAF": '{"trial": 1, "state": "judged", "marks": [], "verdict": "keep", "grade": "good"}',
    "no effort": '{"trial": 1, "state": "judged", "marks": [], "verdict": "keep", "effort": 3}',
    "deep": "[" * 100_000,
    "no text": b"\xff\xfe\x00",
}


@pytest.mark.parametrize("what", DAMAGED)
@pytest.mark.parametrize("source", [True, False])
def test_a_damaged_trial_is_judged_anew_or_named(judged_at_once, what, source) -> None:
    content = DAMAGED[what]
    row = judged_at_once / "trial-01.json"
    row.write_bytes(content.encode() if isinstance(content, str) else content)
    if source:
        (judged_at_once / "trial-01.xdf").write_bytes(b"XDF:")
    served = ServedRoom(judged_at_once)
    try:
        trials = served.room.trials
        if source:
            assert trials.verdicts[1].result(20)["verdict"] == "keep"
            assert "damaged" in trials.broken[0]
        (trial,) = served.state()["trials"]
        json.dumps(served.state(), allow_nan=False, ensure_ascii=False).encode()
        assert trial["verdict"] == ("keep" if source else "repeat")
        assert trials.start() == 2
    finally:
        served.close()
    kept = (judged_at_once / "trial-01.json.damaged-1").read_bytes()
    assert kept == (content.encode() if isinstance(content, str) else content)


def test_nothing_is_dropped_on_a_full_disk(lsl, tmp_path, monkeypatch) -> None:
    """The disk is full while a file and a stream begin."""
    write, full = os.write, [False]

    def writing(file: int, data: bytes) -> int:
        if full[0]:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(file, data)

    monkeypatch.setattr(os, "write", writing)
    with recording(tmp_path) as recorder:
        device = Device(lsl)
        device.until(lambda: heard(recorder))
        full[0] = True
        recorder.turn(tmp_path / "b.xdf")
        before = of(recorder).received
        device.until(lambda: of(recorder).received > before + 10)
        full[0] = False
        device.until(lambda: not recorder.trouble)
        device.all_arrive(recorder)
    for file in ("a.xdf", "b.xdf"):
        assert (columns(tmp_path / file)["dev: torque"] == 2.0).all()


def test_a_target_that_finds_no_room_ends_no_trial(judged_at_once, monkeypatch) -> None:
    room = Room(judged_at_once / "out", joint=False, mapping=judged_at_once / "mapping.toml")
    try:
        room.load(profile="sine", task="active", duration=20.0)

        def full(*what: object) -> None:
            raise InputError("cannot write it: no space left on device")

        monkeypatch.setattr("surae_workbench.live.room.write_protocol_csv", full)
        assert room.start() == 1
        assert room.begin is not None
        told = room.stop().result(20)
        target = room.trials._judge.arguments["target"]
    finally:
        room.close()
    assert (told["verdict"], target) == ("keep", None)


KILLED = """
import sys, time
from types import SimpleNamespace
from surae_workbench.live import trials
trials.Child = lambda **_: SimpleNamespace(call=lambda *_: None, close=lambda: None)
made = trials.Trials(sys.argv[1], joint=False)
while not any(s.received for s in made.recorder.streams.values()):
    time.sleep(0.02)
made.start(effort="maximal")
made.mark("cough")
print("recording", flush=True)
time.sleep(100)
"""


def test_a_program_that_is_killed_within_a_trial_keeps_what_it_was(lsl, judged_at_once) -> None:
    device = Device(lsl)
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(judged_at_once)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    try:
        file = judged_at_once / "trial-01.xdf"
        device.until(file.exists)
        size = file.stat().st_size
        device.until(lambda: file.stat().st_size > size + 2000)
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    again = Trials(judged_at_once, joint=False)
    try:
        told = again.verdicts[1].result(20)
        assert "trial 1 broke off" in again.broken[0]
    finally:
        again.close()
    assert (told["effort_asked"], told["verdict"], told["state"]) == ("maximal", "keep", "judged")
    assert [mark["text"] for mark in told["marks"]] == ["cough"]
    assert (columns(file)["dev: angle"] == 1.0).all()


def test_stamps_that_go_back_refuse_their_own_stream_alone(tmp_path) -> None:
    log = XdfLog(tmp_path / "a.xdf")
    for number, name in enumerate(("good", "bad"), 1):
        log.stream(number, described(name, {"angle": "rad", "torque": "Nm"}, 100.0))
        times = 100.0 + np.arange(1000) / 100.0
        if name == "bad":
            times = times[::-1].copy()
        log.samples(number, times, np.ones((1000, 2)))
    log.close()
    mapping = '[channels.angle]\ncolumn = "{0}: angle"\n[channels.torque]\ncolumn = "{0}: torque"\n'
    (tmp_path / "good.toml").write_text(mapping.format("good") + 'unit = "Nm"\n')
    (tmp_path / "bad.toml").write_text(mapping.format("bad") + 'unit = "Nm"\n')
    assert len(read(tmp_path / "a.xdf", mapping=tmp_path / "good.toml").channels) == 2
    with pytest.raises(InputError, match="don't increase"):
        read(tmp_path / "a.xdf", mapping=tmp_path / "bad.toml")


@pytest.mark.parametrize("step", [-4000.0, 3600.0, -2.0, 2.0, 0.1, 0.0])
def test_a_clock_that_jumps_is_aligned_or_refused(tmp_path, step) -> None:
    """The computer of one of two streams starts again after 30 s, and its clock is another."""
    log = XdfLog(tmp_path / "a.xdf")
    for number, (name, label, unit) in enumerate((("a", "angle", "rad"), ("b", "torque", "Nm")), 1):
        log.stream(number, described(name, {label: unit}, 100.0))
    for i in range(600):
        now = 5000.0 + i / 10
        times = now + np.arange(10) / 100
        offset = 0.0 if i < 300 else -step
        measured = i in (0, 5, 330, 340) or i % 50 == 10
        log.samples(1, times, np.sin(np.pi * times)[:, None])
        if not 300 <= i <= 320:
            log.samples(2, times - offset, np.sin(np.pi * times)[:, None])
            if measured:
                log.clock(2, now, offset + 1e-5)
        if measured:
            log.clock(1, now, 1e-5)
    log.close()
    (tmp_path / "map.toml").write_text(
        '[channels.angle]\ncolumn = "a: angle"\n'
        '[channels.torque]\ncolumn = "b: torque"\nunit = "Nm"\n'
    )
    if 0 < abs(step) < 10:
        with pytest.raises(InputError, match=f"its clock jumped by {abs(step):g} s"):
            read(tmp_path / "a.xdf", mapping=tmp_path / "map.toml")
        return
    angle, torque = read(tmp_path / "a.xdf", mapping=tmp_path / "map.toml").channels.values()
    there = (torque.time < 29.0) | (torque.time > 33.0)
    expected = np.interp(torque.time, angle.time, angle.values)
    np.testing.assert_allclose(torque.values[there], expected[there], atol=1e-3)


def test_an_offset_of_a_clock_that_is_no_number_is_not_taken(lsl, tmp_path) -> None:
    with recording(tmp_path) as recorder:
        device = Device(lsl)
        device.until(lambda: heard(recorder) and of(recorder).offset_s is not None)
        for offset in (np.nan, np.inf, -np.inf):
            recorder._measured(of(recorder), offset)
        assert abs(of(recorder).offset_s) < 1.0
        device.all_arrive(recorder)
    for stream in pyxdf.load_xdf(tmp_path / "a.xdf", dejitter_timestamps=False)[0]:
        assert np.isfinite(stream["time_stamps"]).all()


def test_a_stream_that_is_away_for_an_hour_is_a_gap_and_goes_on(lsl, tmp_path) -> None:
    told: list[tuple[str, dict]] = []
    with recording(tmp_path, told) as recorder:
        device = Device(lsl)
        device.until(lambda: heard(recorder))
        device.all_arrive(recorder)
        later = device.clock() + 3600.0 + np.arange(500) / device.rate
        before = of(recorder).received
        device.send(500, stamps=later)
        waited(lambda: of(recorder).received == before + 500)
        health = of(recorder).health(recorder.clock())
        time.sleep(1.2)  # on disk within a second, and readable while it is recorded
        assert (columns(tmp_path / "a.xdf")["dev: angle"] == 1.0).all()
    assert 3590.0 < health["lost_s"] < 3610.0
    assert [event for event, _ in told if event == "gap"]
    assert len(columns(tmp_path / "a.xdf")["dev: angle"]) >= before + 500


FAKED = """
import select, sys, time
from pathlib import Path
time.sleep = lambda seconds: select.select([], [], [], seconds)  # libfaketime refuses the other
from surae_workbench.live.recorder import Recorder
told = []
made = Recorder(Path(sys.argv[1]), show=lambda *_: None, tell=lambda e, d: told.append(e))
while not any(s.received for s in made.streams.values()):
    time.sleep(0.02)
print("recording", time.time(), flush=True)
sys.stdin.readline()
print(time.time(), flush=True)
time.sleep(1.0)
made.close()
print(sorted(set(told)), flush=True)
"""


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("faketime") is None, reason="libfaketime is not installed")
@pytest.mark.parametrize("jump", ["+1d", "-400d"])
def test_the_systems_clock_may_jump(lsl, tmp_path, jump) -> None:
    """With libfaketime the wall clock of a whole program jumps in the middle of a recording."""
    clock = tmp_path / "clock"
    clock.write_text("+0")
    (library,) = Path("/usr/lib").glob("*/faketime/libfaketime.so.1")
    device = Device(lsl)
    made = subprocess.Popen(
        [sys.executable, "-c", FAKED, str(tmp_path / "a.xdf")],
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(sys.path),
            "LD_PRELOAD": str(library),
            "FAKETIME_TIMESTAMP_FILE": str(clock),
            "FAKETIME_NO_CACHE": "1",
            "FAKETIME_DONT_FAKE_MONOTONIC": "1",
        },
    )
    ended = threading.Event()

    def send() -> None:
        while not ended.wait(0.02):
            device.send(2)

    sender = threading.Thread(target=send)
    sender.start()
    try:
        first = float(made.stdout.readline().split()[1])
        time.sleep(1.0)
        clock.write_text(jump)
        made.stdin.write("\n")
        made.stdin.flush()
        second = float(made.stdout.readline())
        said = made.stdout.readline()
    finally:
        ended.set()
        sender.join()
        made.kill()
        made.communicate()
    assert abs(second - first) > 0.9 * 86400.0  # the clock did jump
    assert "lost" not in said
    assert "disk" not in said
    assert (columns(tmp_path / "a.xdf")["dev: angle"] == 1.0).all()
    (stream,) = [s for s in pyxdf.load_xdf(tmp_path / "a.xdf")[0] if s["info"]["type"][0] == "x"]
    assert np.ptp(stream["time_stamps"]) < 120.0
