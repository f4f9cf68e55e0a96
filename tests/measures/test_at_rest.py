"""What rest tells of a fitted leg goes before the model's, by every door alike, or not at all."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import surae
from ankle_legs.make import make, truth_of
from relaxed_ankle import Ankle, efforts, measured, movement
from surae.cli import group
from surae.inference import Grade, Verdict
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import quantities
from surae.measures.difference import ChangeVerdict
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject, virtual_trial

#: Torque of the calf for its EMG [Nm/V], and when it works [s].
_GAIN = 4e4
_WORKS = (24.0, 30.0)
#: A leg with a toe, which is no exponential.
TOE = Ankle(toe=-20.0, stiff=0.3)


def trial(ankle=TOE, seed=3, works=_WORKS, seconds=2.0):
    """A recording of slow stretches with efforts in between."""
    emg = efforts(movement()[0], works, seconds)
    return measured(ankle, seed, emg=emg, beside=_GAIN * emg[:, 1], name=f"visit{seed}")


def written(recording, path):
    """The same as a file."""
    values = {role: channel.values for role, channel in recording.channels.items()}
    columns = {
        "time_s": recording.channels["angle"].time,
        "angle_rad": values["angle"],
        "torque_Nm": values["torque"],
    }
    columns |= {f"emg_{m}_V": np.maximum(values[f"emg_{m}"], 0.0) for m in MUSCLES}
    surae.write_csv(path, columns, ["emg: envelope"])
    return path


def fitted(recording):
    return surae.fit([recording], "muscle", starts=1, quality=())


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return written(trial(), tmp_path_factory.mktemp("rest") / "trial.csv")


@pytest.fixture(scope="module")
def fit(file):
    return fitted(surae.read(file))


def test_a_toe_that_no_model_has_is_told_by_rest(fit) -> None:
    told = fit.measures()
    for angle in (-10.0, 0.0, 10.0):
        stiffness = told[f"passive_stiffness@{angle:g}deg"]
        assert stiffness.basis == "rest"
        low, high = stiffness.ci95
        assert low <= TOE.stiffness(angle) <= high
        slow = told[f"slow_stiffness@{angle:g}deg"]
        assert slow.basis == "rest"
        assert slow.value > stiffness.value
    low, high = told["end_stiffness"].ci95
    assert low <= (TOE.torque(20.0) - TOE.torque(10.0)) / 10.0 <= high
    assert told.rest.grade is Grade.ADEQUATE


def test_parts_of_muscles_stay_the_models(fit) -> None:
    told = fit.measures()
    for name in ("passive_stiffness_tri@0deg", "end_torque_tib", "quick_stiffness@0deg"):
        assert told[name].basis == "model"


def test_every_door_says_the_same_to_the_last_digit(fit, file, tmp_path) -> None:
    told = fit.measures()
    alone = surae.relaxed(file).measures
    fit.save(tmp_path / "fit.json")
    loaded = surae.load(tmp_path / "fit.json").measures()
    command = ["measures", str(tmp_path / "fit.json"), "--output", str(tmp_path / "m.json")]
    assert CliRunner().invoke(group, command).exit_code == 0
    saved = json.loads((tmp_path / "m.json").read_text())["measures"]
    by_rest = {name for name, m in told.items() if m.basis == "rest"}
    assert len(by_rest) > 15
    for name in by_rest:
        assert alone[name] == told[name] == loaded[name]
        assert saved[name]["value"] == told[name].value
        assert saved[name]["ci95"] == list(told[name].ci95)
        assert saved[name]["basis"] == "rest"
    compared = quantities(fit, (0.0, 10.0)).by_name
    for name in ("slow_stiffness@10deg", "end_stiffness", "torque_rise"):
        assert compared[name].value == told[name].value
        assert compared[name].basis == "rest"


def test_a_trial_without_rest_is_the_models() -> None:
    busy = trial(works=tuple(np.arange(0.0, 60.0, 1.0)), seconds=2.0)
    told = fitted(busy).measures()
    assert told.rest.grade is None
    assert told.rest.missing
    assert {m.basis for m in told.values()} == {"model"}


def test_what_nobody_called_relaxed_is_not_taken_for_it() -> None:
    # a tone that never stops, through an electrode that shows it as one level
    time = movement()[0]
    tone = np.full((len(time), 4), 8e-5)
    recording = measured(TOE, 5, emg=tone, beside=_GAIN * 8e-5)
    told = fitted(recording).measures()
    by_rest = [m for m in told.values() if m.basis == "rest"]
    assert by_rest
    assert not any(m.verdict is Verdict.IDENTIFIED for m in by_rest)


def test_no_unit_of_the_emg_changes_what_rest_tells() -> None:
    silent = np.full((len(movement()[0]), 4), 1e-6)
    one, other = (fitted(measured(TOE, 5, emg=silent * times)).measures() for times in (1.0, 1e5))
    for name in ("slow_stiffness@10deg", "end_stiffness", "torque_rise"):
        assert one[name].basis == other[name].basis == "rest"
        assert one[name].ci95 == pytest.approx(other[name].ci95, rel=1e-9)


def test_the_muscles_doubts_do_not_touch_rest_and_rests_own_do(fit) -> None:
    adequacy = replace(fit.assessment.adequacy, grade=Grade.INADEQUATE)
    doubtful = replace(fit, assessment=replace(fit.assessment, adequacy=adequacy))
    assert doubtful.measures()["slow_stiffness@10deg"] == fit.measures()["slow_stiffness@10deg"]
    heavy = fitted(trial(Ankle(weight=7.5, inertia=0.1)))
    slow = heavy.measures()["slow_stiffness@10deg"]
    assert heavy.measures().rest.grade is Grade.DOUBTFUL
    assert slow.verdict is not Verdict.IDENTIFIED
    assert quantities(heavy, (10.0,)).by_name["slow_stiffness@10deg"].doubt


def test_another_trial_lies_where_it_was_said_and_only_a_change_is_called_one(fit) -> None:
    again = fitted(trial(seed=4))
    stiffer = fitted(trial(replace(TOE, stiff=0.6), seed=5))
    before, same, after = (quantities(each, (10.0,), 19.5) for each in (fit, again, stiffer))
    for name in ("slow_stiffness@10deg", "end_stiffness"):
        first = fit.measures()[name]
        low, high = first.ci95_repeat
        assert low <= again.measures()[name].value <= high
        assert compare_sessions(before, same).measures[name].verdict is ChangeVerdict.NONE_SHOWN
        assert compare_sessions(before, after).measures[name].verdict is ChangeVerdict.CHANGED


def test_a_common_end_of_the_range_is_rests_too(fit) -> None:
    ending = quantities(fit, (10.0,), 12.0).by_name["end_stiffness"]
    assert ending.to_deg == 12.0
    low, high = ending.value - 2.0 * ending.total, ending.value + 2.0 * ending.total
    assert low <= (TOE.torque(12.0) - TOE.torque(2.0)) / 10.0 <= high


def test_one_by_rest_and_one_by_the_model_are_not_compared(fit) -> None:
    brought = quantities(fit, (10.0,))
    name = "slow_stiffness@10deg"
    other = replace(brought.by_name[name], basis="model", value=0.1)
    mixed = replace(brought, by_name=type(brought.by_name)({**brought.by_name, name: other}))
    told = compare_sessions(brought, mixed).measures[name]
    assert told.verdict is ChangeVerdict.NOT_COMPARABLE


def test_a_toe_that_the_models_tissue_cannot_follow_is_said_and_doubts_its_parts(fit) -> None:
    told = fit.measures()
    assert told.rest.conflict.code == "rest/two-tissues"
    assert told["passive_stiffness_tri@10deg"].verdict is Verdict.UNDETERMINED
    assert told["slow_stiffness@10deg"].note.code != "rest/two-tissues"
    assert "two tissues" in told.as_table().text()


@pytest.mark.parametrize("seed", [3, 20, 21])
def test_one_tissue_is_not_called_two(seed) -> None:
    def made(task, number, seconds):
        protocol = Protocol(
            profile="multiple-holds",
            chirp_amplitude=0.2,
            chirp_rate=0.05,
            rate_hz=100.0,
            task=task,
            duration=seconds,
        )
        return virtual_trial(virtual_subject(seed), generate(protocol), seed=number, noise=0.02)

    trials = [made("passive", seed, 40.0), made("active", seed + 50, 30.0)]
    told = surae.fit(trials, "muscle", starts=2, quality=()).measures()
    assert told["slow_stiffness@10deg"].basis == "rest"
    assert not told.rest.conflict


@pytest.mark.parametrize("leg", [1, 2])
def test_a_toe_of_another_author_is_told_by_rest(leg, tmp_path) -> None:
    (path,) = make("rb", leg, tmp_path, (1,))
    told = surae.fit(path, "muscle", starts=1, quality=()).measures()
    truth = truth_of("rb", leg, 1)["measures"]
    by_rest = [m for name, m in told.items() if m.basis == "rest" and name in truth]
    stiff = [m for m in by_rest if m.name.startswith(("slow_stiffness", "passive_stiffness"))]
    assert stiff
    assert all(m.ci95[0] <= truth[m.name] <= m.ci95[1] for m in stiff)


def test_how_the_foot_hangs_is_taken_as_it_is_stated() -> None:
    hangs = trial(replace(TOE, tilt=-20.0))
    told = surae.fit(
        [hangs], "muscle", starts=1, quality=(), theta_foot=np.radians(20.0)
    ).measures()
    stiffness = told["passive_stiffness@10deg"]
    assert stiffness.basis == "rest"
    assert stiffness.ci95[0] <= TOE.stiffness(10.0) <= stiffness.ci95[1]
    assert stiffness.value == pytest.approx(TOE.stiffness(10.0), rel=0.05)
