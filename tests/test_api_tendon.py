"""Torque parts, and muscles and tendons over time, from parameters and from a fit."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.errors import ComputationError, InputError
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

SUBJECT = virtual_subject(seed=1)


def trial(seed=0):
    protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.3, rate_hz=64.0)
    return virtual_trial(SUBJECT, generate(protocol), model="muscle-tendon", noise=0.02, seed=seed)


@pytest.fixture(scope="module")
def inputs():
    return trial()


@pytest.fixture(scope="module")
def fit(inputs):
    return surae.fit([inputs, trial(1)], "muscle-tendon", starts=1)


@pytest.fixture(scope="module")
def state(inputs):
    return surae.simulate_tendon("muscle-tendon", SUBJECT.parameters, inputs)


def test_lengths_add_up_and_force_follows_the_law(state, inputs):
    assert state.unsolved == (None, None)
    rigid = 0.118 - 1.67 * (0.0480 - 0.0104 * inputs.angle)
    whole = state.muscle_length[0] + state.tendon_length[0]
    np.testing.assert_allclose(whole, 0.415 + rigid, atol=1e-12)
    for group, law in enumerate(state.laws):
        np.testing.assert_allclose(
            state.tendon_length[group] - law.slack_length, state.elongation[group], atol=1e-12
        )
        np.testing.assert_allclose(
            law.force(state.elongation[group]), state.tendon_force[group], rtol=1e-9, atol=1e-9
        )


def rate_error(rate_hz):
    """Relative RMS difference of the four velocities from central differences of the lengths."""
    motion = generate(Protocol(profile="sine", chirp_amplitude=0.0, rate_hz=rate_hz))
    state = surae.simulate_tendon(
        "muscle-tendon", SUBJECT.parameters, virtual_trial(SUBJECT, motion, noise=0.0)
    )
    given = np.concatenate([state.muscle_velocity, state.tendon_velocity])[:, 2:-1]
    lengths = np.concatenate([state.muscle_length, state.tendon_length])
    slope = np.gradient(lengths, 1 / rate_hz, axis=1)[:, 2:-1]
    return np.sqrt(np.mean((given - slope) ** 2, axis=1) / np.mean(slope**2, axis=1))


def test_velocities_are_the_rates_of_the_lengths():
    coarse, fine = rate_error(128.0), rate_error(512.0)
    assert np.all(fine < 0.005)
    assert np.all(fine < 0.35 * coarse)


def test_the_law_is_that_of_the_thesis_s_table(state):
    """Table 2: 30 % of 8000 N and 1400 N; beyond, a line through (0.04 m, Fmax)."""
    for law, highest in zip(state.laws, (8000.0, 1400.0), strict=True):
        assert law.toe_force == pytest.approx(0.3 * highest, rel=1e-12)
        there = law.toe_force + law.stiffness * (0.04 - law.toe_elongation)
        assert there == pytest.approx(highest, rel=1e-12)
        assert law.force(np.array([-0.01, 0.0, 0.04])) == pytest.approx([0.0, 0.0, highest])


def test_the_law_follows_the_options(inputs):
    given = dict(SUBJECT.parameters) | {"dlt_tri": 0.05}
    state = surae.simulate_tendon(
        "muscle-tendon-strain", given | {"dlt_tib": 0.04}, inputs, tendon_strain="slack-length"
    )
    assert state.laws[0].force(np.array([0.05 * 0.415])) == pytest.approx([8000.0])
    assert state.laws[1].force(np.array([0.04 * 0.216])) == pytest.approx([1400.0])


def test_the_thesis_s_integrator_has_states_too(inputs):
    state = surae.simulate_tendon(
        "muscle-tendon", SUBJECT.parameters, inputs, integrator="explicit-euler"
    )
    step = np.diff(state.muscle_length, axis=1) * inputs.rate_hz
    np.testing.assert_allclose(state.muscle_velocity[:, :-1], step, atol=1e-9)


def test_a_fit_gives_parts_and_states_of_each_recording(fit):
    problem = fit.result.problem
    for number, recording in enumerate(problem.inputs):
        modelled = recording.torque - fit.result.residuals[number]
        np.testing.assert_allclose(fit.parts(number).total, modelled, atol=1e-9)
        alone = surae.simulate_tendon("muscle-tendon", fit.values, recording)
        np.testing.assert_array_equal(fit.tendon(number).tendon_force, alone.tendon_force)
    np.testing.assert_array_equal(fit.parts().total, fit.parts(0).total)
    assert not fit.tendon().muscle_length.flags.writeable


@pytest.mark.parametrize("number", [2, -1, "trial"])
def test_a_recording_that_the_fit_does_not_have(fit, number):
    for of in (fit.parts, fit.tendon):
        with pytest.raises(InputError, match="numbered 0 … 1"):
            of(number)


def test_a_model_with_rigid_tendons_says_which_have_others(inputs):
    known = "muscle-tendon, muscle-tendon-strain, muscle-tendon-toe"
    with pytest.raises(InputError, match=f"'muscle' has rigid tendons.*: {known}"):
        surae.simulate_tendon("muscle", SUBJECT.parameters, inputs)
    with pytest.raises(InputError, match="rigid tendons"):
        surae.fit(inputs, "muscle", fixed={"beta": 1.0}, starts=1).tendon()


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
def test_a_torque_that_is_not_finite_is_refused_at_its_first_sample(model, inputs):
    angle = inputs.angle.copy()
    angle[500] = np.nan
    broken = replace(inputs, angle=angle)
    first = r"not finite, first at sample 501 \(7.8125 s\); check their units"
    for of in (surae.simulate, surae.simulate_parts):
        with pytest.raises(ComputationError, match=first):
            of(model, SUBJECT.parameters, broken)
    with pytest.raises(ComputationError, match=first):
        surae.simulate(model, SUBJECT.parameters, broken, jacobian=True)


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
def test_parameters_that_overflow_are_refused_without_a_warning(model, inputs):
    given = dict(SUBJECT.parameters) | {"m": 1e308}
    for of in (surae.simulate, surae.simulate_parts):
        with pytest.raises(ComputationError, match="the model overflows with these parameters"):
            of(model, given, inputs)


def test_states_say_where_they_end(inputs):
    angle = inputs.angle.copy()
    angle[500] = np.nan
    state = surae.simulate_tendon("muscle-tendon", SUBJECT.parameters, replace(inputs, angle=angle))
    assert state.unsolved == (500, 500)
    assert np.isfinite(state.tendon_force[:, :500]).all()
    assert np.isnan(state.tendon_force[:, 500:]).all()
