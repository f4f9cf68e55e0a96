"""Factors on the variance of the noise, from an assessment."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import surae
from surae import api
from surae.base.frozen import read_only
from surae.inference import Interval, assess, fit_problem, fit_robust, make_problem
from surae.inference.judging.assessed import variance_inflation


@pytest.fixture(scope="module")
def drifting(clean):
    """A trial whose noise is correlated over time."""
    noise = np.random.default_rng(4).standard_normal(clean.n)
    for i in range(1, clean.n):
        noise[i] += 0.9 * noise[i - 1]
    return replace(clean, torque=read_only(clean.torque + 0.2 * noise))


def test_white_noise_counts_as_it_is(fitted):
    assessed = replace(assess(fitted), interval=Interval.THESIS, interval_note="white")
    assert variance_inflation(assessed) == dict.fromkeys(fitted.problem.free, 1.0)


@pytest.mark.parametrize("loss", [None, "huber"])
def test_correlated_noise_widens_to_the_robust_standard_error(drifting, loss):
    problem = make_problem([drifting], fixed={"tau_rel": 2.0})
    fit = fit_problem(problem, starts=1) if loss is None else fit_robust(problem, loss, starts=1)
    assessed = assess(fit)
    assert assessed.interval is Interval.ROBUST
    found = variance_inflation(assessed)
    assert tuple(found) == problem.free
    for name, factor in found.items():
        p = assessed.parameters[name]
        assert np.sqrt(factor) * p.sem == pytest.approx(p.sem_robust)
    assert np.median(list(found.values())) > 4


def test_one_without_a_standard_error_has_the_median_of_the_others(drifting):
    problem = make_problem([drifting], bounds={"m": (1.2, 1.3)})
    fit = fit_problem(problem, starts=1)
    assert "m" in fit.at_bound
    found = variance_inflation(assess(fit))
    others = [factor for name, factor in found.items() if name not in fit.at_bound]
    assert len(others) > 5
    assert found["m"] == np.median(others) == np.median(list(found.values()))


@dataclass(frozen=True)
class Drawn:
    """What is asked of a posterior."""

    variance_inflation: float
    inflation_reason: str = ""


def test_a_posterior_takes_the_median_unless_told_otherwise(drifting, monkeypatch):
    monkeypatch.setattr(
        "surae.api.draws.sample", lambda _, **options: Drawn(options["variance_inflation"])
    )
    fit = api.fit(drifting, "muscle", prepared=True, starts=1)
    factors = list(variance_inflation(fit.assessment).values())
    usual = surae.posterior(fit)
    assert usual.variance_inflation == np.median(factors) > 4
    assert "correlated over time" in usual.inflation_reason
    assert usual.inflation_reason.endswith("the median over the parameters")
    assert surae.posterior(fit, variance_inflation=2.0) == Drawn(2.0, "given")
