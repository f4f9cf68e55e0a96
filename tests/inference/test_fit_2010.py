"""Fits of the model of 2010: its own truth, its structure, and what it makes of model 1.0's."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.inference import assess, fit_problem, make_problem
from surae.inference.least_squares.residuals import Residuals
from surae.inference.least_squares.separable import solve_linear
from surae.model import ModelOptions, get_model

MODEL = "muscle-2010"
SPEC = get_model(MODEL)
TRUTH = {
    "m": 2.1,
    "k_tri": 200.0,
    "x0_tri": 0.017,
    "e1": 5e5,
    "e2": 9e5,
    "e3": 1.3e6,
    "e4": 1e6,
    "f": 2.0,
    "b_tri": 800.0,
    "F0": -12.0,
}
THESIS, VIRTUAL_WORK = ModelOptions(), ModelOptions(geometry="virtual-work")


def own(inputs, truth=TRUTH, options=THESIS, noise=0.0, seed=0):
    """The trial as the model of 2010 makes it, noise added to EMG and torque."""
    torque = SPEC.simulator(inputs, options).torque(SPEC.vector(truth, options))
    rng = np.random.default_rng(seed)

    def noisy(signal):
        scale = noise * np.abs(signal).mean(axis=0)
        return read_only(signal + scale * rng.standard_normal(signal.shape))

    return replace(inputs, torque=noisy(torque), emg=noisy(inputs.emg))


@pytest.fixture(scope="module")
def trial(clean):
    return own(clean)


@pytest.fixture(scope="module")
def noisy_trial(clean):
    return own(clean, noise=0.05)


def assert_truth(result, truth=TRUTH):
    assert result.status == "converged"
    for name, value in truth.items():
        assert result.values[name] == pytest.approx(value, rel=1e-5), name


def test_every_random_start_finds_the_truth(trial):
    result = fit_problem(make_problem([trial], MODEL), starts=12, seed=5)
    assert_truth(result)
    for start in result.solution.starts:
        for name, value in TRUTH.items():
            assert start.values[name] == pytest.approx(value, rel=1e-5), name


def test_with_noise_all_starts_agree_and_the_truth_is_within_the_errors(noisy_trial):
    result = fit_problem(make_problem([noisy_trial], MODEL), starts=8, seed=1)
    found = assess(result)
    assert result.solution.agreeing == 8
    assert 99.5 < found.vaf < 100
    # Noise on the EMG shrinks weights a little: the low-pass leaves some of it.
    for name, value in TRUTH.items():
        p = found.parameters[name]
        assert abs(p.value - value) < 4 * p.sem, name
        assert abs(p.value - value) < 0.25 * abs(value), name


def test_only_stiffness_and_cut_off_are_searched(trial):
    problem = make_problem([trial], MODEL)
    rng = np.random.default_rng(0)
    x = problem.lower + (problem.upper - problem.lower) * rng.random(10)
    for name in ("k_tri", "f"):
        x[problem.free.index(name)] = TRUTH[name]
    solved, sse = solve_linear(problem, Residuals(problem).data_rows, x)
    np.testing.assert_allclose(solved, list(TRUTH.values()), rtol=1e-6)
    assert sse < 1e-12 * float(trial.torque @ trial.torque)


def test_old_and_new_on_a_trial_of_the_new(noisy, subject):
    old, new = (fit_problem(make_problem([noisy], name), starts=4) for name in (MODEL, "muscle"))
    assert old.solution.agreeing == 4
    was, now = assess(old), assess(new)
    # The old model follows the torque, but not to the noise, whatever the number of parameters.
    assert 98.5 < was.vaf < now.vaf - 0.3
    assert was.rmse > 2 * now.rmse
    scores = [
        one.problem.n * np.log(one.sse / one.problem.n) + 2 * len(one.problem.free)
        for one in (old, new)
    ]
    assert scores[0] > scores[1] + 100
    # What both have is alike; what the old has not goes elsewhere: relaxation into the shift.
    for name in ("m", "k_tri", "x0_tri"):
        assert was.parameters[name].value == pytest.approx(subject.parameters[name], rel=0.05)
    assert was.parameters["F0"].value < -10
    assert "b_tri" in old.at_bound


def test_a_muscle_without_emg_needs_its_own_weight_fixed(trial):
    silent = replace(trial, missing_emg=("sol",))
    with pytest.raises(InputError, match=r"its weight e3 cannot be .* \(e3=0\)"):
        make_problem([silent], MODEL)
    assert "e3" not in make_problem([silent], MODEL, fixed={"e3": 0.0}).free


def test_a_parameter_that_may_be_negative_takes_no_prior(trial):
    with pytest.raises(InputError, match=r"^prior of F0: it is on a logarithm, and F0 may be neg"):
        make_problem([trial], MODEL, priors={"F0": (10.0, 0.2)})
    make_problem([trial], MODEL, priors={"b_tri": (700.0, 0.2)})


def test_the_shift_can_be_fixed_started_and_bounded_below_zero(trial):
    problem = make_problem([trial], MODEL, start={"F0": -30.0}, bounds={"F0": (-40.0, -5.0)})
    assert_truth(fit_problem(problem, starts=1))
    assert_truth(fit_problem(make_problem([trial], MODEL, fixed={"F0": -12.0}), starts=1))
