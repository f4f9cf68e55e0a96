"""Standard errors under correlated noise against the spread of the estimates themselves.

With masses and weights free and everything else fixed the model is linear, so that the covariance
has a closed form for any noise, and thousands of fits are one matrix product.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from surae.base.frozen import read_only
from surae.inference import Interval, assess, fit_problem, make_problem
from surae.inference.least_squares.residuals import Residuals

LINEAR = ("m", "g1", "g2", "g3", "g4")
RHO = 0.9


@pytest.fixture(scope="module")
def fixed(subject):
    return {name: value for name, value in subject.parameters.items() if name not in LINEAR}


@pytest.fixture(scope="module")
def truth(subject):
    return np.array([subject.parameters[name] for name in LINEAR])


@pytest.fixture(scope="module")
def jacobian(clean, fixed, truth):
    return Residuals(make_problem([clean], fixed=fixed)).data_rows(truth)[:-1].T.copy()


def correlated(rng, n, rho=RHO, sd=1.0):
    drive = sd * np.sqrt(1 - rho**2) * rng.standard_normal(n + 1000)
    return lfilter([1], [1, -rho], drive)[1000:]


def fitted_to(clean, noises, fixed, **changes):
    trials = [replace(clean, torque=read_only(clean.torque + e), **changes) for e in noises]
    return fit_problem(make_problem(trials, fixed=fixed), starts=1)


def exact(J, rho, sd=1.0):
    """(JᵀJ)⁻¹JᵀΣJ(JᵀJ)⁻¹, standard deviations."""
    scale = np.linalg.norm(J, axis=0)
    A = J / scale
    sigma = sd**2 * toeplitz(rho ** np.arange(len(J)))
    inverse = np.linalg.inv(A.T @ A)
    return np.sqrt(np.diag(inverse @ (A.T @ sigma @ A) @ inverse)) / scale


def sems(result, which="sem_robust"):
    found = assess(result).parameters
    return np.array([getattr(found[name], which) for name in LINEAR])


def test_correlated_noise_against_the_closed_form(clean, fixed, jacobian):
    expected = exact(jacobian, RHO)
    found, thesis = [], []
    for seed in range(8):
        noise = correlated(np.random.default_rng(seed), clean.n)
        result = fitted_to(clean, [noise], fixed)
        found.append(sems(result) / expected)
        thesis.append(sems(result, "sem") / expected)
    np.testing.assert_allclose(np.mean(found, axis=0), 1.0, atol=0.1)
    # Equation (34) is too small for the weights, which act slowly, and too large for the mass.
    assert np.all(np.mean(thesis, axis=0)[1:] < 0.5)
    assert np.mean(thesis, axis=0)[0] > 1.1


def test_the_closed_form_is_the_spread_of_the_estimates(clean, jacobian):
    solve = np.linalg.pinv(jacobian)
    rng = np.random.default_rng(0)
    errors = np.array([solve @ correlated(rng, clean.n) for _ in range(1000)])
    np.testing.assert_allclose(errors.std(axis=0), exact(jacobian, RHO), rtol=0.08)


@pytest.mark.slow
def test_noise_that_is_nearly_all_absorbed(clean, fixed, jacobian):
    # Noise that changes over half a minute: the fit takes half of it, and it must be given back.
    rho = 0.995
    expected = exact(jacobian, rho)
    found = [
        sems(fitted_to(clean, [correlated(np.random.default_rng(i), clean.n, rho)], fixed))
        for i in range(16)
    ]
    ratio = np.sqrt(np.mean(np.square(found), axis=0)) / expected
    assert np.all((ratio > 0.75) & (ratio < 1.5)), ratio


def test_white_noise_gives_the_standard_errors_of_the_thesis(clean, fixed):
    noise = np.random.default_rng(1).standard_normal(clean.n)
    result = fitted_to(clean, [noise], fixed)
    found = assess(result)
    np.testing.assert_allclose(sems(result), sems(result, "sem"), rtol=0.1)
    assert found.interval is Interval.THESIS
    assert "passes for white noise (p = " in found.interval_note
    for p in found.parameters.values():
        if p.free:
            assert p.interval is Interval.THESIS
            if not found.uncertainty.goes_with_geometry(p.name):
                assert p.trusted_sem == p.sem


def test_the_interval_notices_the_correlation_by_itself(clean, fixed, subject):
    result = fitted_to(clean, [correlated(np.random.default_rng(2), clean.n)], fixed)
    alike = replace(result.solution, starts=2 * result.solution.starts, agreeing=2)
    result = replace(result, solution=alike)  # one start alone claims nothing
    found = assess(result)
    assert found.interval is Interval.ROBUST
    assert found.interval_note == "the residual is correlated over time (p < 0.001)"
    for name in LINEAR:
        p = found.parameters[name]
        assert p.interval is Interval.ROBUST
        assert (p.sem_robust > 1.5 * p.sem) is (name != "m")
        low, high = p.ci95_repeat  # arms and paths have no part in it
        half = (high - low) / 2 if low > 0.0 else high - p.value
        assert 1.96 < half / p.sem_robust < 2.1
        if not found.uncertainty.goes_with_geometry(name):
            assert p.ci95 == p.ci95_repeat
            assert p.trusted_sem == p.sem_robust
            expected = "identified" if half <= 0.1 * p.value else "weak"
            assert p.verdict == (expected if half <= p.value else "undetermined")
        else:
            assert p.verdict in ("weak", "undetermined")
    assert found.parameters["beta"].interval is None
    assert assess(result).parameters == found.parameters


def test_samples_left_out_are_gaps(clean, fixed):
    noise = correlated(np.random.default_rng(3), clean.n)
    weight = np.ones(clean.n)
    weight[500:1500] = 0.0
    wild = noise.copy()
    wild[500:1500] = 1e3
    calm = fitted_to(clean, [noise], fixed, weight=read_only(weight))
    result = fitted_to(clean, [wild], fixed, weight=read_only(weight))
    np.testing.assert_allclose(sems(result), sems(calm), rtol=1e-6)
    J = (
        Residuals(make_problem([clean], fixed=fixed))
        .data_rows(np.array([result.values[name] for name in LINEAR]))[:-1]
        .T
        * (weight > 0)[:, None]
    )
    np.testing.assert_allclose(sems(result), exact(J, RHO), rtol=0.3)


def test_each_recording_has_noise_of_its_own(clean, fixed, jacobian):
    # One recording white and quiet, the other loud and correlated.
    expected = np.sqrt(exact(jacobian, 0.0, 0.2) ** 2 + exact(jacobian, RHO, 1.0) ** 2) / 2
    found = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        noises = [correlated(rng, clean.n, 0.0, 0.2), correlated(rng, clean.n)]
        result = fitted_to(clean, noises, fixed)
        found.append(sems(result) / expected)
        quiet, loud = assess(result).whiteness
        assert quiet.lag1 < 0.5 < loud.lag1
    np.testing.assert_allclose(np.mean(found, axis=0), 1.0, atol=0.12)


def test_a_prior_is_an_observation_of_its_own(clean, fixed, subject):
    noise = np.random.default_rng(4).standard_normal(clean.n)
    trial = replace(clean, torque=read_only(clean.torque + noise))
    prior = {"g2": (subject.parameters["g2"], 1e-3)}  # tells more than the data
    result = fit_problem(make_problem([trial], fixed=fixed, priors=prior), starts=1)
    p = assess(result).parameters["g2"]
    assert p.sem_robust == pytest.approx(p.sem, rel=0.02)
    assert p.sem / p.value == pytest.approx(1e-3, rel=0.1)


def test_a_parameter_between_tight_bounds_is_taken_as_known(clean, fixed, subject):
    noise = correlated(np.random.default_rng(5), clean.n)
    trial = replace(clean, torque=read_only(clean.torque + noise))
    low = 1.2 * subject.parameters["g1"]
    bound = fit_problem(
        make_problem([trial], fixed=fixed, bounds={"g1": (low, (1 + 1e-6) * low)}), starts=1
    )
    known = fit_problem(make_problem([trial], fixed=fixed | {"g1": low}), starts=1)
    one, two = assess(bound), assess(known)
    assert one.parameters["g1"].sem_robust is None
    assert one.robust.names == ("m", "g2", "g3", "g4")
    for name in one.robust.names:
        assert one.parameters[name].sem_robust == pytest.approx(
            two.parameters[name].sem_robust, rel=1e-3
        )


def test_inseparable_parameters_leave_the_others_their_robust_errors(clean, fixed):
    emg = clean.emg.copy()
    emg[:, 1] = emg[:, 2]
    noise = correlated(np.random.default_rng(6), clean.n)
    result = fitted_to(clean, [noise], fixed, emg=read_only(emg))
    found = assess(result).parameters
    assert found["g2"].sem_robust is found["g3"].sem_robust is None
    assert found["m"].sem_robust > found["m"].sem


def test_a_fit_without_noise_has_no_robust_surprise(clean, fixed):
    found = assess(fitted_to(clean, [np.zeros(clean.n)], fixed))
    for name in LINEAR:
        p = found.parameters[name]
        assert 0 <= p.sem_robust < 1e-6 * p.value
        assert p.repeatable
