"""The virtual cohort: who is in it, and recordings that the seed alone determines."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import ComputationError, InputError
from surae.inference import vaf
from surae.model import ModelOptions, get_model
from surae.protocol import generate, named_device
from surae.studies import Imperfections
from surae_thesis import legs
from surae_thesis.cohort.members import COMPLETED, GAIN, SUBJECTS, cohort_protocol, make_cohort
from surae_thesis.cohort.trials import TRUE_MODEL, cohort_recording
from surae_thesis.cohort.work import inputs_of
from surae_thesis.legs import thesis_leg

PASSIVE, HOLDS, FAST = COMPLETED
COHORT = make_cohort(1)
ALL_THREE = next(member for member in COHORT if len(member.completed) == 3)
TWO = next(member for member in COHORT if len(member.completed) == 2)


@pytest.fixture(scope="module")
def active():
    return inputs_of(TWO, HOLDS, 1, 64.0)


def signals(recording):
    return {role: channel.values for role, channel in recording.channels.items()}


@pytest.mark.parametrize("seed", [1, 2, 77])
def test_the_cohort_is_composed_as_the_thesis_says(seed):
    cohort = make_cohort(seed)
    assert len({member.id for member in cohort}) == len(cohort) == SUBJECTS == 14
    assert sum(member.sex == "female" for member in cohort) == 4
    assert all(20 <= member.age <= 30 for member in cohort)
    counts = {name: sum(name in member.completed for member in cohort) for name in COMPLETED}
    assert counts == {PASSIVE: 14, HOLDS: 14, FAST: 7}


def test_a_seed_is_a_cohort_and_fewer_are_the_first_of_it():
    assert make_cohort(1) == COHORT
    assert make_cohort(1, 5) == COHORT[:5]
    seeds = {member.subject.seed for seed in (1, 2) for member in make_cohort(seed)}
    assert len(seeds) == 2 * SUBJECTS


@pytest.mark.slow
def test_a_wandering_gain_changes_the_torque_and_nothing_else_of_the_cohort():
    steady, wandering = make_cohort(1, 2, 0.0)[1], make_cohort(1, 2)[1]
    assert wandering.imperfections == replace(steady.imperfections, gain_variation=GAIN)
    assert wandering.subject == steady.subject
    before, after = (inputs_of(who, HOLDS, 1, 64.0) for who in (steady, wandering))
    np.testing.assert_array_equal(before.angle, after.angle)
    assert np.std(after.torque - before.torque) > 0.1 * np.std(before.torque)


@pytest.mark.parametrize("subjects", [0, 15])
def test_there_are_fourteen_at_most(subjects):
    with pytest.raises(InputError, match="use 1 to 14"):
        make_cohort(1, subjects)


def test_every_leg_is_richer_than_the_models():
    many = [member for seed in range(20) for member in make_cohort(seed)]
    for member in many:
        low, high = member.angle_range
        assert -0.95 <= low <= -0.80
        assert 0.45 <= high <= 0.60
        assert member.subject.tendons.keys() == {"dlt_tri", "dlt_tib", "pt_tri", "pt_tib"}
        flaws = member.imperfections
        assert 0.10 <= flaws.unmeasured <= 0.20
        assert 0.02 <= flaws.reflex_gain <= 0.10
        assert 0.03 <= flaws.crosstalk <= 0.10
        assert 0.06 <= flaws.torque_noise <= 0.20  # Figure 18 leaves 0.15 Nm
        assert flaws.gain_variation == GAIN
        assert ("knee moves" in member.remarks) == (flaws.knee_motion >= 0.08)
    share = np.mean([member.imperfections.knee_motion >= 0.08 for member in many])
    assert share == pytest.approx(3 / 14, abs=0.08)


def test_weights_are_for_compliant_tendons_women_are_weaker_and_nothing_else():
    for member in COHORT:
        drawn = thesis_leg(member.subject.seed).parameters
        ratio = {name: value / drawn[name] for name, value in member.subject.parameters.items()}
        strength = [ratio.pop(name) for name in ("g1", "g2", "g3", "g4")]
        assert strength == pytest.approx([1.5 if member.sex == "female" else 2.0] * 4)
        assert set(ratio.values()) == {1.0}


@pytest.mark.parametrize("name", COMPLETED)
def test_protocols_are_those_that_the_device_could_do(name):
    settings = cohort_protocol(name, (-0.9, 0.6), 200.0)
    trajectory = generate(settings)
    assert np.abs(trajectory.velocity).max() < 1.5
    assert trajectory.effort.any() == (name != PASSIVE)
    if name == HOLDS:
        assert trajectory.adaptation.chirp_amplitude == (0.2, 0.1)
    if name != PASSIVE:
        assert trajectory.time[np.flatnonzero(trajectory.effort.any(axis=1))[0]] == (
            pytest.approx(7.0, abs=0.02)
        )
    assert settings.seconds == {PASSIVE: 30.0, HOLDS: 28.0, FAST: 40.0}[name]
    before = cohort_protocol(name, (-0.9, 0.6), 200.0, measured=False)
    assert before.seconds == {PASSIVE: 18.0, HOLDS: 35.0, FAST: 40.0}[name]
    assert before.passive_seconds is None


def test_an_unknown_protocol_is_refused():
    with pytest.raises(InputError, match="use one of: ramp-and-hold"):
        cohort_protocol("sine", (-0.9, 0.6), 200.0)


@pytest.mark.slow
def test_a_recording_does_not_depend_on_the_ones_before():
    first = signals(cohort_recording(ALL_THREE, PASSIVE, 2))
    cohort_recording(ALL_THREE, FAST, 1)
    cohort_recording(TWO, PASSIVE, 1)
    again = signals(cohort_recording(make_cohort(1)[COHORT.index(ALL_THREE)], PASSIVE, 2))
    assert first.keys() == again.keys()
    for role, values in first.items():
        np.testing.assert_array_equal(values, again[role])


@pytest.mark.slow
def test_repetitions_share_the_motion_and_differ_in_effort(active):
    first, second = active, inputs_of(TWO, HOLDS, 2, 64.0)
    np.testing.assert_array_equal(first.angle, second.angle)
    late = first.time > 12.0
    levels = first.emg[late].mean(axis=0) / second.emg[late].mean(axis=0)
    assert np.abs(levels - 1.0).max() > 0.03
    assert np.abs(first.torque).max() < 80.0
    assert first.name == f"{TWO.id} {HOLDS} 1"


@pytest.mark.slow
def test_the_passive_protocol_has_no_effort(active):
    relaxed = inputs_of(TWO, PASSIVE, 1, 64.0)
    assert relaxed.emg.max() < 0.2 * active.emg.max()


def test_a_protocol_that_was_not_completed_is_refused():
    with pytest.raises(InputError, match="did not complete"):
        cohort_recording(TWO, FAST, 1)


def test_without_imperfections_the_leg_is_the_muscle_tendon_model():
    who = replace(TWO, imperfections=Imperfections())
    inputs = inputs_of(who, PASSIVE, 1)
    spec, options = get_model(TRUE_MODEL), ModelOptions()
    truth = spec.vector({**TWO.subject.parameters, **TWO.subject.tendons}, options)
    torque = spec.simulator(inputs, options).torque(truth)
    # What is left: the preparation's filters, which smooth the motion and the torque.
    assert vaf(inputs.torque, inputs.torque - torque) > 99.5


@pytest.mark.slow
def test_a_trial_that_stops_the_device_is_redone_with_less_effort(monkeypatch):
    free = signals(cohort_recording(TWO, HOLDS, 1))
    limit = 0.95 * np.abs(free["torque"]).max()
    weaker = replace(named_device("achilles"), max_torque=limit)
    monkeypatch.setattr(legs, "named_device", lambda _: weaker)
    redone = signals(cohort_recording(TWO, HOLDS, 1))
    assert np.abs(redone["torque"]).max() < limit
    assert np.abs(redone["emg_sol"]).mean() < np.abs(free["emg_sol"]).mean()


@pytest.mark.slow
def test_a_subject_who_cannot_keep_the_limit_is_told(monkeypatch):
    monkeypatch.setattr(
        legs, "named_device", lambda name: replace(named_device(name), max_torque=1.0)
    )
    with pytest.raises(ComputationError, match=r"exceeds 1 Nm in 12 attempts"):
        cohort_recording(TWO, PASSIVE, 1)
