"""Losses that spare outliers: what they withstand, what they cost, what they say."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.inference import LOSSES, Interval, assess, fit_problem, fit_robust, make_problem
from surae.inference.least_squares.outliers import spread


@pytest.fixture(scope="module")
def struck(noisy):
    """The noisy trial with bursts of −100 … −431 Nm over 2 % of its samples, and where they are."""
    rng = np.random.default_rng(5)
    hit = np.zeros(noisy.n, dtype=bool)
    torque = noisy.torque.copy()
    for first in rng.choice(noisy.n - 10, 15, replace=False):
        hit[first : first + 6] = True
        torque[first : first + 6] -= rng.uniform(100.0, 431.0)
    return replace(noisy, torque=read_only(torque)), hit


@pytest.fixture(scope="module")
def reference(noisy):
    """The fit of the trial without bursts, and its standard errors."""
    result = fit_problem(make_problem([noisy]), starts=1)
    return result.values, {n: p.sem for n, p in assess(result).parameters.items()}


def distances(values, reference):
    found, sem = reference
    return np.array([abs(values[name] - found[name]) / sem[name] for name in found])


@pytest.mark.parametrize("loss", LOSSES)
def test_bursts_hardly_move_the_estimates(loss, struck, reference):
    inputs, hit = struck
    result = fit_robust(make_problem([inputs]), loss, starts=1)
    assert result.status == "converged"
    assert distances(result.values, reference).max() < 2.5
    (weights,) = result.solution.outliers.weights
    assert weights[hit].max() < 0.1
    assert np.median(weights[~hit]) > 0.75
    assert result.solution.outliers.share == pytest.approx(hit.mean(), abs=0.03)
    clean = struck[0].torque[~hit]
    noise = spread(result.residuals[0][~hit])
    assert result.solution.outliers.scale == pytest.approx(noise, rel=0.05)
    assert result.solution.outliers.scale < 0.1 * np.abs(clean).mean()


def test_bursts_ruin_least_squares(struck, reference):
    values = fit_problem(make_problem([struck[0]]), starts=1).values
    assert np.median(distances(values, reference)) > 10


def test_the_fit_holds_its_weights_and_every_sample_counts(struck):
    inputs, _ = struck
    weight = np.where(np.arange(inputs.n) < 500, 0.0, 1.0)
    result = fit_robust(make_problem([replace(inputs, weight=weight)]), "tukey", starts=1)
    (one,), (residual,) = result.problem.inputs, result.residuals
    np.testing.assert_array_equal(one.weight, weight * result.solution.outliers.weights[0])
    assert result.sse == pytest.approx(float(np.sum(one.weight * residual**2)), rel=1e-9)
    assert one.counted == inputs.n - 500  # an outlier stays a sample
    counted = weight > 0
    vaf = 100 * (1 - np.sum(residual[counted] ** 2) / np.sum(inputs.torque[counted] ** 2))
    quality = assess(result)
    assert quality.vaf == pytest.approx(vaf, rel=1e-12)
    assert quality.vaf < 90
    assert quality.vaf_weighted > 99


def test_intervals_of_a_loss_are_robust_ones(struck, noisy, reference):
    result = fit_robust(make_problem([struck[0]]), starts=1)
    assessment = assess(result)
    assert assessment.interval is Interval.ROBUST
    assert "outliers" in assessment.interval_note
    _, sem = reference
    ratios = [p.sem_robust / sem[name] for name, p in assessment.parameters.items()]
    # 5 % for the loss, and a few for bursts that are bounded, not gone.
    assert 1.0 < np.median(ratios) < 1.3


def test_without_outliers_a_loss_costs_little(noisy, reference):
    result = fit_robust(make_problem([noisy]), starts=1)
    assert distances(result.values, reference).max() < 1.0
    assert result.solution.outliers.share == pytest.approx(0.007, abs=0.006)
    _, sem = reference
    ratios = [p.sem_robust / sem[name] for name, p in assess(result).parameters.items()]
    assert np.median(ratios) == pytest.approx(np.sqrt(1.05), abs=0.03)


@pytest.mark.slow
def test_efficiency_under_gaussian_noise_is_about_95_percent(clean, subject):
    free = ("k_tri", "g3", "l0_tri", "f0")
    fixed = {name: value for name, value in subject.parameters.items() if name not in free}
    found: dict[str, list[list[float]]] = {"squares": [], "huber": []}
    for seed in range(60):
        noise = 1.3 * np.random.default_rng(seed).standard_normal(clean.n)
        trial = replace(clean, torque=read_only(clean.torque + noise))
        problem = make_problem([trial], fixed=fixed, start={n: subject.parameters[n] for n in free})
        for name, result in (
            ("squares", fit_problem(problem, starts=1)),
            ("huber", fit_robust(problem, starts=1)),
        ):
            found[name].append([result.values[n] for n in free])
    squares, huber = (np.var(found[name], axis=0) for name in ("squares", "huber"))
    # Theory: 1.053. The same noise in both leaves a standard error of about 0.03.
    assert np.mean(huber / squares) == pytest.approx(1.053, abs=0.09)


def test_two_recordings_share_one_scale(noisy, struck):
    result = fit_robust(make_problem([noisy, struck[0]]), starts=1)
    quiet, hit = result.solution.outliers.weights
    assert (quiet < 0.1).mean() < 0.001
    assert (hit < 0.1).mean() > 0.01


def test_priors_are_weighed_against_the_noise_without_outliers(struck, noisy):
    priors = {"tau_rel": (1.2, 0.05)}
    plain = fit_problem(make_problem([noisy], priors=priors), starts=1)
    robust = fit_robust(make_problem([struck[0]], priors=priors), starts=1)
    assert robust.values["tau_rel"] == pytest.approx(plain.values["tau_rel"], rel=0.1)
    # Weighed against the noise with the bursts in it, the prior would have won.
    assert robust.values["tau_rel"] > 1.5


def test_a_fit_without_noise_has_a_scale(clean, subject):
    result = fit_robust(make_problem([clean], start=subject.parameters), starts=1)
    assert result.values["l0_tri"] == pytest.approx(subject.parameters["l0_tri"], rel=1e-4)
    assert result.solution.outliers.scale > 0


def test_a_loss_unknown(noisy):
    with pytest.raises(InputError, match=r"loss .cauchy. is not known; use one of: huber, soft-l1"):
        fit_robust(make_problem([noisy]), "cauchy")


def test_ctrl_c_leaves_the_least_squares(noisy, monkeypatch):
    problem = make_problem([noisy])
    calls = []

    def stopped(*arguments):
        calls.append(arguments)
        raise KeyboardInterrupt

    monkeypatch.setattr("surae.inference.least_squares.outliers._iterated", stopped)
    result = fit_robust(problem, starts=1)
    assert calls
    assert result.status == "failed"
    assert result.solution.is_interrupted
    assert "these are the least squares" in result.message
    assert result.solution.outliers is None


def test_weights_that_do_not_rest_are_a_failure(struck, monkeypatch):
    monkeypatch.setattr("surae.inference.least_squares.outliers._ROUNDS", 2)
    result = fit_robust(make_problem([struck[0]]), starts=1)
    assert result.status == "failed"
    assert "did not rest in 2 rounds" in result.message


def test_a_search_that_loses_the_minimum_is_a_failure(struck, monkeypatch):
    def worse(problem, **given):
        found = fit_problem(problem, **given)
        return replace(found, sse=1.1 * found.sse)

    monkeypatch.setattr("surae.inference.least_squares.outliers.fit_problem", worse)
    result = fit_robust(make_problem([struck[0]]), starts=1)
    assert result.status == "failed"
    assert "no start came back" in result.message


@pytest.mark.parametrize("name", LOSSES)
def test_a_loss_is_a_square_at_0_and_its_slope_the_derivative(name):
    loss = LOSSES[name]
    t = np.linspace(-2.5, 2.5, 1001)
    t = t[np.abs(np.abs(t) - 1) > 1e-3]  # ψ has a kink there
    psi = t * loss.weight(t)
    step = 1e-6
    slope = ((t + step) * loss.weight(t + step) - psi) / step
    np.testing.assert_allclose(loss.slope(t), slope, atol=1e-4)
    assert loss.weight(np.zeros(1))[0] == 1.0
    assert (loss.weight(t) <= 1.0).all()


@pytest.mark.parametrize("name", LOSSES)
def test_the_tuning_costs_5_percent_of_gaussian_efficiency(name):
    loss = LOSSES[name]
    z = np.linspace(-10, 10, 200_001)
    p = np.exp(-(z**2) / 2)
    p /= p.sum()
    t = z / loss.tuning
    psi = z * loss.weight(t)
    assert (loss.slope(t) @ p) ** 2 / (psi**2 @ p) == pytest.approx(0.95, abs=1e-3)
