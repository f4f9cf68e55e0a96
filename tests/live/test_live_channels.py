"""Another laboratory's streams: which channel is which is chosen, and trials wait for it."""

import time
import tomllib
from contextlib import contextmanager

import numpy as np
import pytest
from streaming import Quick, waited

from surae.api import inspect, read
from surae.base.errors import InputError
from surae.base.names import TARGET_SOURCE
from surae_workbench.live.alarms import EVERY, Watch
from surae_workbench.live.lsl import outlet
from surae_workbench.live.mapping import chosen_text, mapping_of, offered
from surae_workbench.live.pages import ServedRoom
from surae_workbench.live.stream import Stream
from surae_workbench.live.trials import CHOSEN, UNMAPPED, Trials
from surae_workbench.live.xdf import XdfLog

#: What a robot and an amplifier call their channels that never heard of surae.
ROBOT = (["Ankle position", "Ankle moment", "Temperature"], ["degrees", "N.m", "C"])
AMPLIFIER = (["TA", "Soleus", "AUX 1"], ["uV", "uV", "V"])


def stream(name: str, labels: list[str], units: list[str], kind: str = "x") -> Stream:
    return Stream(2, name, kind, "here", labels, units, 100.0, False, "")


def there() -> list[Stream]:
    return [
        stream("Robot", *ROBOT),
        stream("Amp", *AMPLIFIER),
        stream("surae target", ["angle", "emg_sol"], ["rad", "1"], kind="Target"),
    ]


def choice(column: str, unit: str | None = None, sign: int = 1) -> dict:
    return {"column": column, "unit": unit, "sign": sign}


GOOD = {
    "angle": choice("Robot: Ankle position"),
    "torque": choice("Robot: Ankle moment", sign=-1),
    "emg_sol": choice("Amp: Soleus"),
}


def test_names_suggest_what_nothing_settles_and_our_target_is_no_channel() -> None:
    assert mapping_of(there()) == ("", {})
    shown = offered(there(), None)
    guesses = {role: guess["column"] for role, guess in shown["guesses"].items()}
    assert guesses == {
        "angle": "Robot: Ankle position",
        "torque": "Robot: Ankle moment",
        "emg_ta": "Amp: TA",
        "emg_sol": "Amp: Soleus",
    }
    assert shown["guesses"]["angle"]["unit"] == "deg"
    assert not any("target" in each["column"] for each in shown["columns"])
    assert shown["chosen"] == {}


def test_a_choice_is_a_mapping_in_which_missing_muscles_are_silent(tmp_path) -> None:
    made = tomllib.loads(chosen_text(there(), GOOD, "raw"))
    assert made["channels"]["torque"] == {
        "column": "Robot: Ankle moment",
        "unit": "Nm",
        "sign": -1,
    }
    assert made["fixed"] == {"g1": 0.0, "g2": 0.0, "g4": 0.0}
    assert made["emg"] == "raw"
    path = tmp_path / "map.toml"
    path.write_text(chosen_text(there(), GOOD, "raw"))
    again = offered(there(), path)
    assert again["chosen"]["torque"]["sign"] == -1
    assert again["emg"] == "raw"


def test_a_choice_leaves_what_a_mapping_says_besides(tmp_path) -> None:
    path = tmp_path / "map.toml"
    path.write_text(
        'side = "left"\n[fixed]\ng1 = 0.0\nm = 1.0\n'
        '[channels.torque]\ncolumn = "Robot: Ankle moment"\nunit = "Nm"\nscale = 2.0\n'
        '[channels.emg_sol]\ncolumn = "Amp: AUX 1"\nunit = "V"\nscale = 9.0\n'
        '[channels.fascicle_sol]\ncolumn = "Film: length"\nunit = "mm"\n'
    )
    made = tomllib.loads(chosen_text(there(), GOOD | {"emg_ta": choice("Amp: TA")}, None, path))
    assert made["channels"]["torque"]["scale"] == 2.0
    assert "scale" not in made["channels"]["emg_sol"]  # it is another channel now
    assert made["channels"]["fascicle_sol"]["column"] == "Film: length"
    assert made["fixed"] == {"m": 1.0, "g2": 0.0, "g4": 0.0}
    assert made["side"] == "left"


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"angle": choice("Robot: gone")}, "no stream has"),
        ({"emg_ta": choice("Amp: Soleus")}, "it is one of them"),
        ({"emg_ta": choice("Robot: Temperature", "V2")}, "choose one of"),
        ({"torque": None}, "which channel is the torque"),
    ],
)
def test_a_choice_that_cannot_be_is_refused(change, says) -> None:
    channels = {role: each for role, each in (GOOD | change).items() if each}
    with pytest.raises(InputError, match=says):
        chosen_text(there(), channels, "raw")


def xdf(path, sources: dict[str, tuple[list[str], list[str]]]) -> None:
    """A recording of streams by their source: all channels are their time."""
    log = XdfLog(path)
    for number, (source, (labels, units)) in enumerate(sources.items(), 1):
        channels = "".join(
            f"<channel><label>{label}</label><unit>{unit}</unit></channel>"
            for label, unit in zip(labels, units, strict=True)
        )
        log.stream(
            number,
            f"<info><name>stream {number}</name><type>x</type><source_id>{source}</source_id>"
            f"<channel_count>{len(labels)}</channel_count><nominal_srate>100</nominal_srate>"
            "<channel_format>double64</channel_format><desc><channels>"
            f"{channels}</channels></desc></info>",
        )
        times = 3.0 + number + np.arange(300) / 100.0
        log.clock(number, 3.0, 0.0)
        log.samples(number, times, np.tile(times[:, None], len(labels)))
    log.close()


def test_what_surae_itself_asked_for_is_read_by_nobody_as_a_signal(tmp_path) -> None:
    ours = (["angle", "emg_sol"], ["rad", "1"])
    path = tmp_path / "trial.xdf"
    xdf(path, {TARGET_SOURCE: ours, "robot": ROBOT, "amp": AMPLIFIER})
    seen = inspect(path)
    assert seen.roles["emg_sol"].column == "stream 3: Soleus"
    assert seen.roles["angle"].column == "stream 2: Ankle position"
    assert not any("stream 1" in channel.column for channel in seen.channels)
    assert seen.channels[0].start_s == 0.0  # times count from what was measured
    xdf(tmp_path / "other.xdf", {"a target of others": ours})
    assert inspect(tmp_path / "other.xdf").roles["emg_sol"].column == "stream 1: emg_sol"
    xdf(tmp_path / "alone.xdf", {TARGET_SOURCE: ours})
    with pytest.raises(InputError, match="no stream of numbers"):
        read(tmp_path / "alone.xdf")


@contextmanager
def robot(lsl, recorder):
    """The robot's stream, once it is heard; what is yielded sends some of it."""
    sent = outlet("Robot", "x", *ROBOT, 100.0, "robot")

    def send(seconds: float = 0.3) -> None:
        for _ in range(round(seconds / 0.02)):
            sent.push_chunk(np.ones((2, 3)), lsl.local_clock())
            time.sleep(0.02)

    def is_heard() -> bool:
        send(0.1)
        return any(s.received and s.name == "Robot" for s in recorder.streams.values())

    waited(is_heard)
    yield send


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)


CHANNELS = {role: GOOD[role] for role in ("angle", "torque")}


def test_a_trial_waits_for_a_choice_and_is_judged_then(lsl, quick, tmp_path) -> None:
    told = []
    trials = Trials(tmp_path, joint=False, tell=lambda event, data: told.append((event, data)))
    try:
        with robot(lsl, trials.recorder) as send:
            trials.start()
            send()
            first = trials.stop(lsl.local_clock() - 0.2).result(60)
            assert (first["verdict"], first["advice"]) == ("look", UNMAPPED)
            assert first["translated"]["nl"]["advice"] != UNMAPPED
            trials.choose(CHANNELS)
            second = trials.verdicts[1].result(60)
            assert (second["verdict"], second["use"]) == ("keep", "fit")
            assert trials._judge.arguments["mapping"] == str(tmp_path / CHOSEN)
            assert trials._judge.arguments["begin"] == pytest.approx(first["begun_s"])
            states = [data["state"] for event, data in told if event == "trial"]
            assert states[-2:] == ["being judged", "judged"]
            turned = CHANNELS | {"torque": choice("Robot: Ankle moment")}
            trials.choose(turned)
            assert trials.verdicts[1].result(60) == second  # it was read: nobody asked for it again
            trials.choose(turned, again=True)
            third = trials.verdicts[1].result(60)
            assert third["mapping"] not in (None, second["mapping"])
            trials.choose(CHANNELS)
            trials.start()
            with pytest.raises(InputError, match="stop it first"):
                trials.choose(CHANNELS)
    finally:
        trials.close()
    again = Trials(tmp_path, joint=False)  # the choice is the folder's
    try:
        assert again.mapping == tmp_path / CHOSEN
        assert 1 not in again.verdicts
    finally:
        again.close()


def test_a_mapping_that_comes_with_the_next_start_judges_what_waited(lsl, quick, tmp_path) -> None:
    trials = Trials(tmp_path / "out", joint=False)
    try:
        with robot(lsl, trials.recorder) as send:
            trials.start()
            send()
            assert trials.stop().result(60)["verdict"] == "look"
            text = chosen_text(list(trials.recorder.streams.values()), CHANNELS, "raw")
    finally:
        trials.close()
    still = Trials(tmp_path / "out", joint=False)
    try:
        assert 1 not in still.verdicts  # nothing has come
    finally:
        still.close()
    (tmp_path / "map.toml").write_text(text)
    again = Trials(tmp_path / "out", joint=False, mapping=tmp_path / "map.toml")
    try:
        assert again.verdicts[1].result(60)["verdict"] == "keep"
    finally:
        again.close()


def test_good_is_what_is_mapped_and_was_judged(lsl, quick, tmp_path) -> None:
    served = ServedRoom(tmp_path)
    trials = served.room.trials
    try:
        with robot(lsl, trials.recorder) as send:
            shown = served.health()
            assert not shown["mapped"]
            assert [(s["roles"], s["judged"]) for s in shown["streams"]] == [([], False)]
            trials.choose(CHANNELS)
            shown = served.health()
            assert shown["mapped"]
            assert [(s["roles"], s["judged"]) for s in shown["streams"]] == [
                (["angle", "torque"], False)
            ]
            trials.start()
            send()
            trials.stop().result(60)
            (one,) = served.health()["streams"]
            assert (one["judged"], one["bad"]) == (True, None)
            error = {"code": "torque-sign", "severity": "error", "channel": "torque"}
            trials._write(1, findings=[error])
            (one,) = served.health()["streams"]
            assert one["bad"] == 1
    finally:
        served.close()


def alarmed(watch: Watch) -> set[str]:
    """The codes of a leg that is turned fast and far, with a large torque."""
    watch.roles = {"D: angle": ("angle", 1.0, 0.0), "D: torque": ("torque", 1.0, 0.0)}
    source = stream("D", ["angle", "torque"], ["rad", "Nm"])
    told = set()
    for i in range(12):
        times = 0.25 * i + np.arange(25) / 100.0
        values = np.column_stack([4.0 * np.sin(9.0 * times), np.full(25, 75.0)])
        watch.show(source, times, values)
        told |= {alarm.code for alarm in watch.look(times[-1] + EVERY / 25, np.zeros(4))}
    return told


def test_no_limit_is_watched_of_a_device_that_nobody_chose(lsl, quick, tmp_path) -> None:
    served = ServedRoom(tmp_path)
    room = served.room
    try:
        room.load(profile="sine", task="passive", duration=20.0)
        assert served.state()["moves"]["device"] is None
        assert all("beyond" not in limit["text"] for limit in room.limits)
        assert alarmed(room.alarms) == set()
        room.choose_device("achilles")
        assert any("achilles" in limit["text"] for limit in room.limits)
        assert room.trials.limits["device"] == "achilles"
        assert {"torque-limit", "angle-range", "speed-limit"} <= alarmed(
            Watch(room.device, room.alarms.span)
        )
        room.choose_device(None)
        assert room.trials.limits["device"] is None
        assert room.alarms.span is None
        with pytest.raises(InputError, match="not known"):
            room.choose_device("nobody's")
    finally:
        served.close()
