"""A leg that walks: what its steps tell without a model, and where nothing may be said of them."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from ankle_legs.make import make
from surae import simulate
from surae.inference import Grade
from surae.inference.judging.reasons import against
from surae.measures.working import working_stiffness
from surae.nerve.leg import IntervalEstimate, Nerve
from surae.protocol import Protocol, generate
from surae.report import block
from surae.report.language import words_in
from surae.report.leg import followed_alone, leg_answers
from surae.report.leg_cards import change_card
from surae.report.trust_card import trust
from surae.signals.cycles import find_cycles
from surae.studies import virtual_subject, virtual_trial

EN = words_in("en")


def steps(stiffness=5.0, uneven=0.0, noise=0.0, seed=1, active=True):
    """Forty steps of an ankle that is a spring while the foot is loaded: prepared signals."""
    random = np.random.default_rng(seed)
    rate, n = 100.0, 110
    phase = np.arange(n) / n
    swing = phase < 0.4
    deg = np.where(swing, 8.0 - 8.0 * np.sin(np.pi * phase / 0.4), 14.0 * (phase - 0.4) / 0.6 - 4.0)
    deg = np.convolve(np.r_[deg, deg, deg], np.ones(7) / 7, "same")[n : 2 * n]
    angle, torque, calf = [], [], []
    for _step in range(40):
        k = stiffness * (1.0 + uneven * random.standard_normal())
        load = np.where(swing, 0.0, np.maximum(k * (deg + 3.0), 0.0))
        angle.append(deg)
        torque.append(load + noise * random.standard_normal(n))
        calf.append(0.02 + 0.9 * load / load.max() * active)
    emg = np.concatenate(calf)[:, None] * np.array([0.1, 1.0, 1.0, 1.0])
    emg = emg + 0.003 * random.standard_normal(emg.shape)
    made = virtual_trial(
        virtual_subject(seed=1),
        generate(Protocol(profile="sine", task="active", duration=5.0, rate_hz=rate)),
    )
    radians = np.radians(np.concatenate(angle))
    return replace(
        made,
        time=np.arange(len(radians)) / rate,
        angle=radians,
        velocity=np.gradient(radians, 1 / rate),
        acceleration=0.0 * radians,
        torque=np.concatenate(torque),
        emg=emg,
        rate_hz=rate,
        weight=None,
    )


@pytest.mark.parametrize("stiffness", [2.0, 5.0, 9.0])
def test_a_spring_that_steps_has_its_stiffness(stiffness) -> None:
    told = working_stiffness(steps(stiffness, noise=0.5))
    assert told is not None
    assert told.value == pytest.approx(stiffness, rel=0.03)
    assert told.steps >= 35
    assert told.from_deg < 0.0
    assert told.to_deg > 8.0


def test_steps_that_differ_are_said_to() -> None:
    told = working_stiffness(steps(uneven=0.1))
    assert told.span[0] == pytest.approx(5.0 * (1 - 0.2), rel=0.12)
    assert told.span[1] == pytest.approx(5.0 * (1 + 0.2), rel=0.12)


def test_a_relaxed_leg_that_is_moved_in_steps_tells_none() -> None:
    """Its calf is not heard: what resists is tissue, or a calf that no electrode hears."""
    assert working_stiffness(steps(active=False)) is None
    silent = steps()
    assert working_stiffness(replace(silent, emg=0.0 * silent.emg)) is None
    assert working_stiffness(replace(silent, torque=None)) is None


def test_a_torque_that_falls_as_the_angle_grows_tells_none() -> None:
    forward = steps()
    assert working_stiffness(replace(forward, torque=-forward.torque)) is None
    assert working_stiffness(replace(forward, torque=np.roll(forward.torque, 55))) is None


@pytest.mark.parametrize("effort", [0.0, 1.0])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_robot_that_moves_a_leg_to_and_fro_tells_none(effort, seed) -> None:
    """Muscles that work by chance, or rest, while a machine moves the ankle."""
    subject = virtual_subject(seed=seed)
    motion = generate(Protocol(profile="sine", task="active", rate_hz=50.0, duration=40.0))
    trial = virtual_trial(subject, motion, seed=seed)
    moved = replace(trial, emg=effort * trial.emg)
    torque = simulate("muscle", subject.parameters, moved)
    assert working_stiffness(replace(moved, torque=torque)) is None


@pytest.mark.parametrize("family", ["a", "g", "va", "ra"])
def test_legs_of_another_author_that_a_robot_moves_tell_none(family, tmp_path) -> None:
    for file in make(family, 4242, tmp_path, (1, 2)):
        assert working_stiffness(surae.prepare(surae.read(file))) is None, file


def test_a_measured_walk_tells_what_its_mean_step_does(shared) -> None:
    walk = surae.prepare(surae.read(shared / "gait" / "walk36.toml"))
    told = working_stiffness(walk)
    cycles = find_cycles(walk.angle, walk.rate_hz)
    _, angle, _ = cycles.over(np.degrees(walk.angle))
    _, torque, _ = cycles.over(walk.torque)
    late = slice(60, 96)  # of the cycle, which ends at the largest dorsiflexion: the foot is loaded
    line = np.polyfit(angle[late], torque[late], 1)[0]
    assert told.value == pytest.approx(line, rel=0.25)
    assert told.span[0] < line < told.span[1]
    assert 45 <= told.steps <= 52


@pytest.mark.parametrize(
    "name", ["perturbed/dorsiflexing.csv", "dynamometer/PL_50_01.toml", "gait/run81.toml"]
)
def test_measured_trials_without_such_steps_tell_none(shared, name) -> None:
    """The torque of the running trial stands in the air in every fourth step."""
    recording = surae.read(shared / name)
    assert working_stiffness(surae.prepare(recording)) is None


def fits_of(done, *grades):
    """Two fits of a leg's trials, and that of both, of these grades; the last is of both."""
    joint = done[1].joint
    made = []
    for grade in grades:
        reasons = (against("not-followed", grave=True, r2=50.0),) if grade == "inadequate" else ()
        adequacy = replace(joint.assessment.adequacy, grade=Grade(grade), against=reasons, r2=96.4)
        made.append(replace(joint, assessment=replace(joint.assessment, adequacy=adequacy)))
    return dict(zip(("walk", "run"), made, strict=False)), made[-1]


def test_a_trial_that_is_followed_alone_speaks_for_itself(done) -> None:
    fits, joint = fits_of(done, "doubtful", "inadequate", "inadequate")
    assert followed_alone(joint, fits)[0] == "walk"
    lines = [
        b.text for b in trust(joint, (), EN, alone=("walk", fits["walk"])) if b.kind == "paragraph"
    ]
    assert "walk alone is followed: 96.4 % of its torque’s changes." in lines


@pytest.mark.parametrize(
    "grades",
    [
        ("inadequate", "inadequate", "inadequate"),
        ("doubtful", "inadequate", "doubtful"),
        ("adequate", "adequate", "adequate"),
    ],
)
def test_no_trial_speaks_for_a_leg_that_is_followed_or_of_which_none_is(done, grades) -> None:
    fits, joint = fits_of(done, *grades)
    assert followed_alone(joint, fits) is None


def test_trials_that_may_be_of_several_legs_speak_for_none(done) -> None:
    fits, joint = fits_of(done, "doubtful", "inadequate", "inadequate")
    adequacy = joint.assessment.adequacy
    told = (*adequacy.against, against("other-slope", grave=False))
    other = replace(
        joint,
        assessment=replace(joint.assessment, adequacy=replace(adequacy, against=told)),
    )
    assert followed_alone(other, fits) is None


def test_small_movements_alone_are_trusted_by_what_they_predict() -> None:
    for part, grade in ((94.0, "doubtful"), (40.0, "inadequate")):
        nerve = Nerve(reflex="cannot tell", held_out=part)
        (judged,) = trust(None, (), EN, nerve=nerve)
        assert judged.grade == grade
        assert f"{part:.0f} %" in judged.sentence


def test_of_small_movements_no_change_below_what_two_visits_show_is_promised() -> None:
    stiff = IntervalEstimate(90.0, (60.0, 120.0))  # Nm/rad: ± 0.52 Nm/°
    said, _again = change_card(None, EN, None, Nerve(stiffness=stiff))
    assert "a change of less than 0.74 Nm/° would not show" in said.text
    assert change_card(None, EN, None, Nerve())[0].text == ""


def test_a_leg_of_small_movements_alone_has_three_answers() -> None:
    stiff = IntervalEstimate(90.0, (60.0, 120.0))
    nerve = Nerve(reflex="cannot tell", stiffness=stiff, held_out=94.0)
    cards = {c.anchor: c.blocks for c in leg_answers((), {}, None, EN, nerve=nerve).cards}
    assert cards["stiff"][0].lead == "1.6 Nm/°"
    assert "would not show" in cards["change"][0].text
    assert isinstance(cards["trust"][0], block.AdequacyWords)
    assert cards["trust"][0].grade == "doubtful"
