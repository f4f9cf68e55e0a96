"""Samples that count less, and what is known beforehand."""

from dataclasses import replace

import numpy as np
import pytest

from surae.inference import assess, fit_problem, make_problem


def quick(inputs, **given):
    return fit_problem(make_problem([inputs], **given), starts=1)


def test_samples_of_weight_zero_are_left_out(clean, subject):
    bad = (clean.time > 15.0) & (clean.time < 16.0)
    torque = clean.torque + np.where(bad, 50.0, 0.0)
    result = quick(replace(clean, torque=torque, weight=np.where(bad, 0.0, 1.0)))
    for name, value in subject.parameters.items():
        assert result.values[name] == pytest.approx(value, rel=1e-5), name
    assert result.problem.n == clean.n - np.count_nonzero(bad)
    # The residual is told as it is, there too.
    np.testing.assert_allclose(result.residuals[0][bad], 50.0, atol=1e-3)


@pytest.fixture(scope="module")
def alone(noisy, subject):
    """One weak parameter by itself: nearly a linear problem."""
    fixed = {name: value for name, value in subject.parameters.items() if name != "tau_rel"}
    return fixed, assess(quick(noisy, fixed=fixed)).parameters["tau_rel"]


def test_prior_and_data_share_by_their_precision(noisy, alone):
    fixed, plain = alone
    median = 1.05 * plain.value
    spread = plain.sem / plain.value  # as precise as the data
    result = quick(noisy, fixed=fixed, priors={"tau_rel": (median, spread)})
    p = assess(result).parameters["tau_rel"]
    assert np.log(p.value) == pytest.approx(
        0.5 * (np.log(plain.value) + np.log(median)), abs=0.1 * spread
    )
    assert p.sem == pytest.approx(plain.sem / np.sqrt(2), rel=0.1)


def test_a_sure_prior_is_kept_and_a_vague_one_ignored(noisy, alone):
    fixed, plain = alone
    sure = quick(noisy, fixed=fixed, priors={"tau_rel": (2 * plain.value, 1e-4)})
    assert sure.values["tau_rel"] == pytest.approx(2 * plain.value, rel=1e-3)
    vague = quick(noisy, fixed=fixed, priors={"tau_rel": (2 * plain.value, 100.0)})
    assert vague.values["tau_rel"] == pytest.approx(plain.value, abs=0.05 * plain.sem)


def test_priors_are_told_in_sse_only_of_the_data(noisy):
    result = quick(noisy, priors={"tau_rel": (3.0, 0.1), "k_tib": (110.0, 0.1)})
    (residual,) = result.residuals
    assert result.sse == pytest.approx(residual @ residual, rel=1e-12)
    plain = quick(noisy)
    assert result.sse > plain.sse
    assert assess(result).parameters["k_tib"].sem < assess(plain).parameters["k_tib"].sem
