"""Streams as they are: processes that end at any moment, clocks, a full disk, measured files."""

import errno
import os
import time
import weakref

import numpy as np
import pytest
from streaming import Quick, Sender, waited

from benchmark_files import load
from promises import with_known_arms
from surae import fit, read
from surae.base.errors import InputError
from surae.recording import MUSCLES
from surae_workbench.live.recorder import Recorder
from surae_workbench.live.showing import Showing
from surae_workbench.live.stream import Stream
from surae_workbench.live.target import TargetStream
from surae_workbench.live.trials import Trials, silent


@pytest.fixture(scope="module")
def endings(lsl):
    """The benchmark of what is lost."""
    return load("live")


FEW_AND_MANY = pytest.mark.parametrize("count", [1, pytest.param(5, marks=pytest.mark.slow)])


@FEW_AND_MANY
def test_a_killed_recorder_has_lost_less_than_a_second(endings, count) -> None:
    lost = endings.kills(count)
    assert max(lost) < 1.0


@FEW_AND_MANY
def test_a_stream_that_comes_back_is_taken_up_and_nothing_is_lost_silently(endings, count) -> None:
    lost, missing, noted = endings.losses(count)
    assert len(missing) == count
    assert max(lost) < 2.0  # on a busy computer; alone it takes a fifth of a second
    np.testing.assert_allclose(noted, missing, atol=0.01)


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
        during = len(came)
        waited(lambda: len(came) > during + 10)
        monkeypatch.setattr(os, "write", write)
        waited(lambda: not recorder.trouble)
        recorder.close()
    assert [data["message"] != "" for event, data in told if event == "disk"] == [True, False]
    numbers = endings.numbers_in(tmp_path / "a.xdf")
    assert (np.diff(numbers) == 1).all()
    assert len(numbers) >= sum(came)


def test_a_trial_that_ends_on_a_full_disk_is_whole_and_judged_once_there_is_room(
    endings, tmp_path, monkeypatch
) -> None:
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    (tmp_path / "mapping.toml").write_text("[channels]\n")
    came, write = [], os.write
    with endings.process("send", "disk"):
        trials = Trials(tmp_path, joint=False, show=lambda *what: came.append(len(what[1])))

        def more() -> None:
            before = len(came)
            waited(lambda: len(came) > before + 5)

        def full(file: int, data: bytes) -> int:
            raise OSError(errno.ENOSPC, "No space left on device")

        try:
            more()
            trials.start()
            more()
            monkeypatch.setattr(os, "write", full)
            more()
            verdict = trials.stop()
            more()
            assert not verdict.done()
            with pytest.raises(InputError, match="make room now"):
                trials.start()
            monkeypatch.setattr(os, "write", write)
            assert verdict.result(20)["verdict"] == "keep"
            more()
        finally:
            trials.close()
    files = ("between-01.xdf", "trial-01.xdf", "between-02.xdf")
    parts = [endings.numbers_in(tmp_path / file) for file in files]
    assert min(map(len, parts)) > 100
    assert (np.diff(np.concatenate(parts)) == 1).all()


def test_whoever_looks_on_ends_no_recording(endings, tmp_path) -> None:
    """Showing one stream fails: all are recorded, and the mistake is told."""
    target = TargetStream()

    def show(stream, *what) -> None:
        if stream.name == "surae target":
            raise ZeroDivisionError

    recorder = Recorder(tmp_path / "a.xdf", show=show, tell=silent)
    try:
        waited(lambda: any(s.received for s in recorder.streams.values()))
        with endings.process("send", "b"):
            waited(
                lambda: any(
                    s.received > 500 for s in recorder.streams.values() if s.name != "surae target"
                )
            )
        assert "ZeroDivisionError" in recorder.trouble
    finally:
        recorder.close()
        target.close()
    assert (np.diff(endings.numbers_in(tmp_path / "a.xdf")) == 1).all()


@pytest.mark.parametrize("rate", [0.0, 1000.0])
def test_what_is_irregular_is_shown_as_what_is_regular(rate) -> None:
    showing = Showing(silent)
    showing.roles = {"EMG: emg_sol": ("emg_sol", 1.0, 0.0)}
    stream = Stream(2, "EMG", "EMG", "here", ["emg_sol"], ["V"], rate, False, "")
    rng = np.random.default_rng(1)
    for i in range(100):
        times = 5.0 + (np.arange(20) + 20 * i) / 1000.0
        level = 1e-3 if i > 50 else 1e-5
        showing.show(stream, times, level * rng.standard_normal((20, 1)))
    assert showing.efforts()[2] > 0.8


def test_crosstalk_of_a_muscle_that_has_not_worked_yet_is_no_effort_of_it() -> None:
    showing = Showing(silent)
    showing.roles = {f"EMG: {m}": (f"emg_{m}", 1.0, 0.0) for m in MUSCLES}
    stream = Stream(2, "EMG", "EMG", "here", list(MUSCLES), ["V"] * 4, 1000.0, False, "")
    rng = np.random.default_rng(1)

    def works(levels: dict[str, float]) -> list[float]:
        for i in range(50):
            times = 5.0 + (np.arange(20) + 20 * i) / 1000.0
            scale = np.array([levels.get(m, 2e-6) for m in MUSCLES])
            showing.show(stream, times, scale * rng.standard_normal((20, 4)))
        return showing.efforts()

    assert max(works({})) < 0.3  # an amplifier's noise is none either
    tibialis, *triceps = works({"ta": 4e-5, "gl": 1e-3, "sol": 1e-3, "gm": 8e-4})
    assert tibialis < 0.25
    assert min(triceps) > 0.7
    works({})
    tibialis, *triceps = works({"ta": 6e-4, "gl": 3e-5, "sol": 3e-5, "gm": 3e-5})
    assert tibialis > 0.8
    assert max(triceps) < 0.1


def test_the_network_is_asked_for_once_and_for_all(monkeypatch) -> None:
    import pylsl

    from surae_workbench.live import lsl as module

    told = []
    monkeypatch.setattr(pylsl, "set_config_content", told.append)
    monkeypatch.setattr(module, "_configured", [], raising=False)
    assert module.lsl(network=True) is module.lsl() is pylsl
    assert told == []


def test_a_target_that_is_closed_is_a_stream_no_more(lsl, tmp_path) -> None:
    """Whoever still holds it, an exception's traceback for one, keeps no stream alive."""
    target = TargetStream()
    recorder = Recorder(tmp_path / "a.xdf", show=silent, tell=silent)
    try:
        waited(lambda: [s for s in recorder.streams.values() if s.state == "good" and s.received])
        target.close()
        waited(lambda: all(s.state == "lost" for s in recorder.streams.values()))
    finally:
        recorder.close()


@pytest.mark.parametrize("heard", [0.2, 60.0])
def test_a_target_ends_once_nobody_hears_it_or_after_a_second(lsl, monkeypatch, heard) -> None:
    class Outlet:
        def push_chunk(self, *_: object) -> None:
            pass

        def have_consumers(self) -> bool:
            asked.append(time.monotonic())
            return asked[-1] < asked[0] + heard

    asked: list[float] = []
    made = [Outlet()]
    held = weakref.ref(made[0])
    monkeypatch.setattr("surae_workbench.live.target.outlet", lambda *_: made.pop())
    target = TargetStream()
    target.close()
    assert min(heard, 1.0) - 0.05 < asked[-1] - asked[0] < min(heard, 1.0) + 0.5
    assert held() is None


@pytest.fixture
def streamed(lsl, shared, tmp_path):
    """Send a measured file to whoever records; gives the file, the sender, and a mapping."""

    def made(name: str):
        file = read(shared / f"{name}.toml")
        sender = Sender(file)
        (tmp_path / "map.toml").write_text(sender.mapping, encoding="utf-8")
        senders.append(sender)
        return file, sender, tmp_path / "map.toml"

    senders: list[Sender] = []
    yield made
    for sender in senders:
        sender.outlets.clear()


def test_what_is_sent_is_what_is_recorded(streamed, tmp_path) -> None:
    file, sender, mapping = streamed("dynamometer/PL_50_01")
    recorder = Recorder(tmp_path / "between.xdf", show=silent, tell=silent)
    try:
        waited(lambda: sender.heard(recorder))
        recorder.turn(tmp_path / "trial.xdf")
        sender.send(recorder.clock)
        counts = [len(group[0].time) for group in sender.groups]
        waited(lambda: sender.received(recorder) == dict(zip(sender.sources, counts, strict=True)))
    finally:
        recorder.close()
    live = read(tmp_path / "trial.xdf", mapping=mapping)
    begin = min(channel.time[0] for channel in file.channels.values())
    for role, channel in file.channels.items():
        got = live.channels[role]
        np.testing.assert_array_equal(got.values, channel.values)
        np.testing.assert_allclose(got.time, channel.time - begin, atol=1e-3)


DETERMINED = ("identified", "weak")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dynamometer/PL_50_01", "gait/walk36"])
def test_a_measured_file_gives_the_same_fit_as_if_live(streamed, tmp_path, name) -> None:
    file, sender, mapping = streamed(name)
    trials = Trials(tmp_path / "live", mapping=mapping, joint=False)
    try:
        waited(lambda: sender.heard(trials.recorder))
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
    known = with_known_arms(expected).parameters  # as far as the file itself determines them
    determined = {n: p for n, p in known.items() if p.verdict in DETERMINED}
    assert len(determined) >= 3  # of walking three: l0_tib, f0, beta; else the loop asks nothing
    for parameter, estimate in determined.items():
        # The stamps' rate is measured, 1 in 10^6 off: samples fall otherwise on the model's axis.
        near = pytest.approx(estimate.value, rel=1e-3, abs=0.2 * (estimate.sem or 0.0))
        assert got.parameters[parameter].value == near, parameter
