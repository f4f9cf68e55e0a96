"""Two streams of one name: each is known for good, or no trial begins and it is said why."""

import os
import random
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from streaming import Quick, waited
from test_live_attacks import Device, columns, heard, of, returned

from surae.base.errors import InputError
from surae.recording import read
from surae_workbench.live.identity import STREAMS, Identities, Identity
from surae_workbench.live.pages import ServedRoom
from surae_workbench.live.trials import Trials

SENDER = """
import sys, time
from surae_workbench.live.lsl import lsl
name, source, kind, labels, units, code = sys.argv[1:]
pylsl = lsl()
labels = labels.split(",")
info = pylsl.StreamInfo(name, kind, len(labels), 100.0, "double64", source)
if labels[0]:
    info.set_channel_labels(labels)
    info.set_channel_units(units.split(","))
outlet = pylsl.StreamOutlet(info)
print("there", flush=True)
while True:
    outlet.push_chunk([[float(code) + i for i in range(len(labels))]] * 2, pylsl.local_clock())
    time.sleep(0.02)
"""
UNITS = {"angle": "rad", "torque": "Nm", "emg_ta": "V", "emg_sol": "V"}


@contextmanager
def device(source, code, *, name="leg", kind="x", labels=("angle", "torque")):
    """A program that sends numbers of its own: its code, the next on the next channel."""
    units = ",".join(UNITS.get(label, "") for label in labels)
    made = subprocess.Popen(
        [sys.executable, "-c", SENDER, name, source, kind, ",".join(labels), units, str(code)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert made.stdout.readline() == "there\n"
    try:
        yield made
    finally:
        made.kill()
        made.communicate()


@pytest.fixture
def opened(lsl, tmp_path, monkeypatch):
    """Open a folder of trials that are judged without computing, as often as is asked."""
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    made = []

    def trials(mapping=None, folder="out"):
        made.append(Trials(tmp_path / folder, mapping=mapping, joint=False))
        return made[-1]

    yield trials
    for each in made:
        if not each._closed:
            each.close()


def sending(trials, count=2):
    """Wait until so many streams are there, and send."""

    def all_there():
        good = [s for s in trials.recorder.streams.values() if s.received and s.state == "good"]
        return len(good) == count

    waited(all_there, 60.0)


def recorded(trials, seconds=0.3):
    """A trial; its number."""
    number = trials.start()
    before = {s.number: s.received for s in trials.recorder.streams.values()}
    waited(
        lambda: all(
            s.received > before.get(s.number, 0) + 100 * seconds
            for s in trials.recorder.streams.values()
            if s.state == "good"
        )
    )
    trials.stop().result(20)
    return number


def maps(path, **columns):
    lines = [
        f'[channels.{role}]\ncolumn = "{column}"\nunit = "{UNITS[role]}"\n'
        for role, column in columns.items()
    ]
    path.write_text("".join(lines))
    return path


@pytest.mark.parametrize("trials", [4, pytest.param(30, marks=pytest.mark.slow)])
def test_each_trial_is_of_its_own_device_whichever_began_first(opened, tmp_path, trials):
    """Twins with equal labels; the recorder and both programs begin again, in any order."""
    choice = random.Random(5)
    mapping = maps(tmp_path / "map.toml", angle="leg (A17): angle", torque="leg (A17): torque")
    done = 0
    while done < trials:
        order = choice.sample([("A17", 1.0), ("B3", 50.0)], 2)
        with device(*order[0]), device(*order[1]):
            for _ in range(2):
                if done >= trials:
                    break
                session = opened(mapping)
                sending(session)
                assert session.doubts == []
                for _ in range(choice.choice((1, 2))):
                    number = recorded(session)
                    done += 1
                    # As it lies there: stamps of a busy computer are another test's matter.
                    found = columns(tmp_path / f"out/trial-{number:02d}.xdf")
                    assert set(found["leg (A17): angle"]) == {1.0}, number
                    assert set(found["leg (A17): torque"]) == {2.0}, number
                    assert set(found["leg (B3): angle"]) == {50.0}, number
                names = {s["name"] for s in session.recorder.health()}
                assert names == {"leg (A17)", "leg (B3)"}
                session.close()
    assert done >= trials


def test_unnamed_channels_of_two_amplifiers_are_not_exchanged(opened, tmp_path):
    """Of two boxes of one name a mapping says which: by its name alone no trial begins."""
    mapping = maps(tmp_path / "map.toml", angle="Amp: channel 1", torque="Amp: channel 2")
    amplifier = {"name": "Amp", "labels": ("",), "kind": "EMG"}
    with device("box 2", 1.0, **amplifier), device("box 1", 5.0, **amplifier):
        session = opened(mapping)
        sending(session)
        with pytest.raises(InputError, match=r"Amp \(box 1\) / Amp \(box 2\)"):
            session.start()
        maps(mapping, angle="Amp (box 1): channel 1", torque="Amp (box 2): channel 1")
        number = recorded(session)
    found = read(tmp_path / f"out/trial-{number:02d}.xdf", mapping=mapping)
    assert (set(found["angle"].values), set(found["torque"].values)) == ({5.0}, {1.0})


def test_two_that_nothing_tells_apart_begin_no_trial(opened, tmp_path):
    with device("same", 1.0):
        session = opened()
        with device("same", 50.0) as twin:
            waited(lambda: session.doubts, 60.0)
            with pytest.raises(InputError, match="nothing tells them apart"):
                session.start()
            twin.kill()
            twin.wait()
            waited(lambda: not session.doubts, 60.0)
        assert recorded(session) == 1


def test_one_program_with_two_streams_of_one_name_is_recorded_whole(opened, tmp_path):
    """The mechanics and the EMG of a robot, both called so, from one source: told by channels."""
    with (
        device("robot", 1.0),
        device("robot", 7.0, labels=("emg_ta", "emg_sol")),
    ):
        session = opened()
        sending(session)
        assert session.doubts == []
        number = recorded(session)
        mapping = session.mapping
        session.close()
        found = read(tmp_path / f"out/trial-{number:02d}.xdf", mapping=mapping)
        values = {role: set(channel.values) for role, channel in found.channels.items()}
        assert values == {"angle": {1.0}, "torque": {2.0}, "emg_ta": {7.0}, "emg_sol": {8.0}}
        again = opened()
        sending(again)
        assert {s["name"] for s in again.recorder.health()} == {
            "leg (2 channels, angle, torque)",
            "leg (2 channels, emg_ta, emg_sol)",
        }


def test_two_devices_that_say_the_same_begin_no_trial_without_a_mapping(lsl, tmp_path, monkeypatch):
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    served = ServedRoom(tmp_path / "out")
    try:
        with device("A", 1.0), device("B", 50.0):
            trials = served.room.trials
            sending(trials, 3)  # with our own target, which is none of them
            shown = served.health()
            (alarm, *_) = [each for each in shown["alarms"] if each["code"] == "streams"]
            assert "angle" in alarm["text"]
            assert not shown["ready"]
            assert trials.mapping is None
            with pytest.raises(InputError, match="say that they are the same signal"):
                trials.start()
    finally:
        served.close()


def test_a_twin_that_is_switched_off_leaves_the_name_of_the_other(opened, tmp_path):
    """After a restart with one of them alone it is called as before: nobody takes its place."""
    mapping = maps(tmp_path / "map.toml", angle="leg (A): angle", torque="leg (A): torque")
    with device("B", 50.0):
        with device("A", 1.0):
            session = opened(mapping)
            sending(session)
            recorded(session)
            session.close()
        again = opened(mapping)
        sending(again, 1)
        number = recorded(again)
        assert [s["name"] for s in again.recorder.health()] == ["leg (B)"]
    with pytest.raises(InputError, match="leg"):
        read(tmp_path / f"out/trial-{number:02d}.xdf", mapping=mapping)


def test_what_came_before_another_layout_stays_readable(lsl, opened, tmp_path):
    session = opened()
    first = Device(lsl)
    first.until(lambda: heard(session.recorder) and session.mapping)
    number = session.start()
    before = of(session.recorder).received
    first.until(lambda: of(session.recorder).received > before + 50)
    other = Device(lsl, units={"angle": "deg", "torque": "Nm", "emg_sol": "mV"})
    returned(session.recorder, other)
    told = session.stop().result(20)
    assert told["verdict"] == "repeat"
    used = tmp_path / f"out/trial-{number:02d}-mapping.toml"
    assert session._judge.arguments["mapping"] == str(used)
    found = read(tmp_path / f"out/trial-{number:02d}.xdf", mapping=used)
    assert {role: set(c.values) for role, c in found.channels.items()} == {
        "angle": {1.0},
        "torque": {2.0},
        "emg_sol": {3.0},
    }
    other.until(lambda: session.mapping and "deg" in session.mapping.read_text())


TEXT = st.text(st.sampled_from("ab é"), max_size=3).map(str.strip)
ONE = st.builds(
    Identity,
    st.just("leg"),
    TEXT,
    TEXT,
    st.lists(TEXT, min_size=1, max_size=2).map(tuple),
    TEXT,
)


@given(st.lists(ONE, min_size=2, max_size=5, unique=True), st.randoms())
@settings(max_examples=200, deadline=None)
def test_names_are_of_streams_not_of_their_order(tmp_path_factory, streams, chance):
    folder = tmp_path_factory.mktemp("names")
    names = []
    for k in range(2):
        order = chance.sample(streams, len(streams))
        known = Identities(folder / f"{k}.json")
        for i, each in enumerate(order):
            known.meet(each, order[:i])
        names.append({each: known.called(each) for each in streams})
        again = Identities(folder / f"{k}.json")
        assert {each: again.called(each) for each in streams} == names[-1]
    assert names[0] == names[1]
    assert len(set(names[0].values())) == len(streams)


@pytest.mark.parametrize("content", [b"", b"[]", b'{"leg": 3}', b'{"leg": [{}]}', b"[" * 100000])
def test_a_damaged_list_of_streams_is_begun_anew(tmp_path, content):
    (tmp_path / STREAMS).write_bytes(content)
    known = Identities(tmp_path / STREAMS)
    one, other = (Identity("leg", source, "x", ("angle",), "here") for source in "AB")
    assert known.called(one) == "leg"
    assert known.meet(one, [other])
    assert known.called(one) == "leg (A)"
    assert np.size(Identities(tmp_path / STREAMS).ambiguous()) == 1
