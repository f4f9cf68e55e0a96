"""Profiles of curves whose likelihood is known, and of a virtual trial."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import t as student
from toys import linear, toy_fit, toy_problem

from surae.base.errors import InputError
from surae.inference import Prior, fit_problem, make_problem
from surae.inference.least_squares.minimise import compress
from surae.inference.least_squares.residuals import Residuals
from surae.sampling.conditional import Conditional, ConditionalMinimum
from surae.sampling.one_profile import profile

RNG = np.random.default_rng(7)
N = 200
TIME = np.linspace(0.0, 2.0, N)
NOISE = 0.1 * RNG.standard_normal(N)
WIDE = (-100.0, 100.0)


@pytest.fixture(scope="module")
def line():
    """A straight line, whose two parameters correlate, beside a sine."""
    design = np.column_stack([np.ones(N), TIME, np.sin(5 * TIME)])
    data = design @ [1.0, 2.0, 0.5] + NOISE
    return toy_fit(linear(design), data, dict.fromkeys("abc", 0.0), dict.fromkeys("abc", WIDE))


def decay(values):
    """a·exp(−b·t)."""
    a, b = values
    e = np.exp(-b * TIME)
    return a * e, np.array([e, -a * TIME * e])


@pytest.fixture(scope="module")
def decayed():
    """An exponential decay with much noise: its rate has a skew profile."""
    data = decay([1.0, 1.5])[0] + 4 * NOISE
    return toy_fit(decay, data, {"a": 1.0, "b": 1.0}, {"a": (0.0, 10.0), "b": (0.0, 50.0)})


def decay_chi2(result, b):
    """Δχ² of the decay's rate, its amplitude solved in closed form."""
    (one,) = result.problem.inputs
    e = np.exp(-b * TIME)
    sse = one.torque @ one.torque - (one.torque @ e) ** 2 / (e @ e)
    return (sse - result.sse) / (result.sse / (N - 2))


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_of_a_linear_model_it_is_the_parabola_of_the_covariance(line, name):
    found = profile(line, name)
    j = line.problem.free.index(name)
    inverse = np.linalg.inv(line.R.T @ line.R)
    variance = line.sse / (N - 3) * inverse[j, j]
    assert found.sem == pytest.approx(np.sqrt(variance), rel=1e-9)
    (one,) = line.problem.inputs
    exact = inverse @ (line.problem.spec.simulator(one, None).curve(np.zeros(3))[1] @ one.torque)
    parabola = (found.values - exact[j]) ** 2 / variance
    np.testing.assert_allclose(found.chi2, parabola - parabola.min(), rtol=1e-6, atol=1e-7)
    half = student.ppf(0.975, N - 3) * np.sqrt(variance)
    assert found.threshold == pytest.approx(student.ppf(0.975, N - 3) ** 2, rel=1e-10)
    expected = line.values[name] - half, line.values[name] + half
    assert found.interval == pytest.approx(expected, abs=2e-3 * half)
    assert found.from_covariance == pytest.approx(expected, rel=1e-9)
    assert (found.status, found.message, found.lower) == ("closed", "both ends found", None)
    # The others follow the straight line that the covariance gives them.
    others = [i for i in range(3) if i != j]
    slope = inverse[others, j] / inverse[j, j]
    path = exact[others] + np.outer(found.values - exact[j], slope)
    spread = np.sqrt(line.sse / (N - 3) * np.diag(inverse)[others])
    assert np.max(np.abs(np.stack([*found.along.values()], 1) - path) / spread) < 1e-3


def test_of_a_curve_it_is_the_known_likelihood(decayed):
    found = profile(decayed, "b")
    known = np.array([decay_chi2(decayed, b) for b in found.values])
    np.testing.assert_allclose(found.chi2, known, rtol=1e-5, atol=1e-5)
    b = decayed.values["b"]
    low = brentq(lambda x: decay_chi2(decayed, x) - found.threshold, 0.01, b)
    high = brentq(lambda x: decay_chi2(decayed, x) - found.threshold, b, 49.0)
    assert found.interval == pytest.approx((low, high), rel=2e-3)
    # Skewed: the upper arm is the longer one, which the covariance cannot say.
    assert (high - b) > 1.15 * (b - low)
    assert found.along["a"] == pytest.approx(
        [
            decayed.problem.inputs[0].torque @ np.exp(-v * TIME) / np.exp(-2 * v * TIME).sum()
            for v in found.values
        ],
        rel=1e-4,
    )


def test_the_variance_inflation_divides_and_widens(line):
    plain, wide = profile(line, "b"), profile(line, "b", variance_inflation=4.0)
    assert wide.sem == pytest.approx(2 * plain.sem)
    widths = [np.diff(one.interval)[0] for one in (plain, wide)]
    assert widths[1] == pytest.approx(2 * widths[0], rel=3e-3)
    assert np.interp(plain.interval[1], wide.values, wide.chi2) < 0.3 * wide.threshold


def test_an_end_beyond_the_bound_is_open(decayed):
    b = decayed.values["b"]
    bounds = {"a": (0.0, 10.0), "b": (0.0, b + 0.05)}
    found = profile(
        toy_fit(decay, decayed.problem.inputs[0].torque, {"a": 1.0, "b": 1.0}, bounds), "b"
    )
    low, high = found.interval
    assert low == pytest.approx(profile(decayed, "b").interval[0], rel=3e-3)
    assert high is None
    assert found.status == "open"
    assert found.values[-1] == bounds["b"][1]
    assert found.reasons[0] == ""
    assert "upper bound" in found.reasons[1]
    assert found.message.startswith("open upwards: ")


def test_flat_to_both_sides_is_open_to_both():
    def product(values):
        a, b = values
        return a * b * TIME, np.array([b * TIME, a * TIME])

    bounds = {"a": (0.5, 8.0), "b": (0.01, 100.0)}
    found = profile(toy_fit(product, 2 * TIME + NOISE, {"a": 1.0, "b": 1.0}, bounds), "a")
    assert found.interval == (None, None)
    assert found.sem is None
    assert found.from_covariance is None
    assert (found.values[0], found.values[-1]) == bounds["a"]
    assert found.chi2.max() < 1e-3
    for why, side in zip(found.reasons, ("lower", "upper"), strict=True):
        assert why.startswith("flat: ")
        assert f"{side} bound" in why
    product = found.values * found.along["b"]
    np.testing.assert_allclose(product, product[0], rtol=1e-4)


def test_a_parameter_without_any_influence_is_flat():
    design = np.column_stack([TIME, np.zeros(N)])
    fit = toy_fit(linear(design), TIME + NOISE, {"a": 0.0, "b": 0.5}, {"a": WIDE, "b": (0.0, 1.0)})
    found = profile(fit, "b")
    assert found.interval == (None, None)
    assert found.chi2 == pytest.approx(0.0, abs=1e-9)


def test_from_a_bound_it_goes_inwards_only():
    design = np.column_stack([np.ones(N), TIME])
    data = design @ [1.0, -0.02] + NOISE
    fit = toy_fit(linear(design), data, {"a": 0.0, "b": 0.5}, {"a": WIDE, "b": (0.0, 5.0)})
    assert fit.at_bound == ("b",)
    found = profile(fit, "b")
    assert found.values[0] == 0.0
    assert found.interval[0] is None
    assert found.reasons[0] == "the estimate lies at its lower bound 0"
    assert found.sem is None
    # Exact: the other is solved, and the threshold is above where the bound stopped the fit.
    sse = [np.sum((data - b * TIME - np.mean(data - b * TIME)) ** 2) for b in found.values]
    np.testing.assert_allclose(found.sse, sse, rtol=1e-9)
    at = found.interval[1]
    rise = np.sum((data - at * TIME - np.mean(data - at * TIME)) ** 2) - sse[0]
    assert rise / (fit.sse / (N - 1)) == pytest.approx(found.threshold, rel=1e-2)


def test_the_others_meet_their_bounds_on_the_way():
    design = np.column_stack([np.ones(N), TIME])
    fit = toy_fit(
        linear(design),
        design @ [1.0, 2.0] + NOISE,
        {"a": 1.0, "b": 2.0},
        {"a": WIDE, "b": (2.005, 2.02)},
    )
    found = profile(fit, "a")
    (one,) = fit.problem.inputs
    slope = np.array(
        [np.clip((one.torque - a) @ TIME / (TIME @ TIME), 2.005, 2.02) for a in found.values]
    )
    np.testing.assert_allclose(found.along["b"], slope, rtol=1e-6)
    assert {2.005, 2.02} <= set(found.along["b"])


def test_one_without_influence_at_its_bound_does_not_lead_astray():
    def with_tail(values):
        a, b, c = values
        tail = np.exp(b * (TIME - 2.5))
        return a * TIME + tail + c, np.array([TIME, (TIME - 2.5) * tail, np.ones(N)])

    data = TIME + 1.0 + NOISE
    start = {"a": 1.0, "b": 600.0, "c": 1.0}
    problem = toy_problem(with_tail, data, start, {"a": WIDE, "b": (0.5, 600.0), "c": WIDE})
    a, c = np.polyfit(TIME, data, 1)
    near = np.array([a, 600.0, c])
    R = compress(Residuals(problem).rows(near).copy())[0]
    fit = replace(fit_problem(problem, starts=1), values={"a": a, "b": 600.0, "c": c})
    minima = Conditional(fit, 0.0, "a", bool)
    for step in (1e-6, 1e-3, 0.1, -1e-6, -1e-3, -0.1):
        found = minima.at(a + step, ConditionalMinimum(a, near, minima.fit.sse, R))
        assert found.x == pytest.approx([a + step, 600.0, np.mean(data - (a + step) * TIME)])
        assert found.converged
    assert minima.evaluations <= 30


def test_the_fixed_ones_stay(line):
    problem = replace(
        line.problem,
        free=("a", "c"),
        base=np.array([0.0, 1.9, 0.0]),
        lower=np.full(2, -100.0),
        upper=np.full(2, 100.0),
    )
    fit = fit_problem(problem, starts=1)
    found = profile(fit, "a")
    assert list(found.along) == ["c"]
    (one,) = problem.inputs
    for a, sse in zip(found.values, found.sse, strict=True):
        left = one.torque - 1.9 * TIME - a
        sine = np.sin(5 * TIME)
        assert sse == pytest.approx(left @ left - (left @ sine) ** 2 / (sine @ sine), rel=1e-9)
    with pytest.raises(InputError, match="b is fixed in this fit and has no profile"):
        profile(fit, "b")


def test_a_single_parameter():
    fit = toy_fit(linear(TIME[:, None]), TIME + NOISE, {"a": 0.0}, {"a": WIDE})
    found = profile(fit, "a")
    assert found.along == {}
    assert found.interval == pytest.approx(found.from_covariance, rel=1e-4)


def test_a_prior_counts():
    design = np.column_stack([np.ones(N), TIME])
    data = design @ [1.0, 2.0] + NOISE
    bounds = {"a": (0.01, 10.0), "b": (0.01, 10.0)}
    start = {"a": 1.0, "b": 1.0}
    problem = toy_problem(linear(design), data, start, bounds, priors={"b": Prior(2.0, 0.005)})
    fit = fit_problem(problem, starts=1)
    free = profile(toy_fit(linear(design), data, start, bounds), "b")
    held = profile(fit, "b")
    assert np.diff(held.interval)[0] < 0.9 * np.diff(free.interval)[0]
    # Δχ² of the data and of the prior add up.
    sigma2 = np.sum(fit.residuals[0] ** 2) / (N - 2)
    plain = [np.sum((data - b * TIME - np.mean(data - b * TIME)) ** 2) for b in held.values]
    noise2 = np.sum(toy_fit(linear(design), data, start, bounds).residuals[0] ** 2) / (N - 2)
    total = np.array(plain) / sigma2 + noise2 / sigma2 * (np.log(held.values / 2.0) / 0.005) ** 2
    np.testing.assert_allclose(held.chi2, total - total.min(), atol=1e-3)


def test_where_the_torque_ends_the_profile_does():
    data = 1.0 + 2.0 * TIME + NOISE
    fence = float(np.polyfit(TIME, data, 1)[1]) + 0.005  # a third of a standard error

    def fenced(values):
        a, b = values
        level = a if a < fence else np.nan
        return level + b * TIME, np.array([np.full(N, level / a), TIME])

    fit = toy_fit(fenced, data, {"a": 0.9, "b": 2.0}, {"a": (0.1, 5.0), "b": WIDE})
    found = profile(fit, "a")
    assert found.interval[0] is not None
    assert found.interval[1] is None
    assert found.values[-1] < fence
    assert found.reasons[1].endswith("where the search ended: no finite torque beyond")
    assert np.isfinite(found.chi2).all()


def wiggle(values):
    """A curve whose sum of squares has two valleys in its frequency."""
    (f,) = values
    return np.sin(f * TIME), (TIME * np.cos(f * TIME))[None]


def test_a_lower_minimum_is_told_and_offered():
    data = np.sin(6.0 * TIME) + 6 * NOISE
    problem = toy_problem(wiggle, data, {"f": 9.2}, {"f": (1.0, 20.0)})
    fit = fit_problem(problem, starts=1)
    assert fit.values["f"] > 8  # stuck in the next valley
    found = profile(fit, "f", variance_inflation=60.0)  # wide enough to look over the hill
    assert found.status == "lower-minimum"
    assert found.lower["f"] == pytest.approx(6.0, abs=0.1)
    assert "met a lower minimum" in found.message
    assert np.sum((data - np.sin(found.lower["f"] * TIME)) ** 2) < fit.sse
    assert found.chi2.min() == 0
    assert found.values[found.chi2.argmin()] == pytest.approx(found.lower["f"])
    again = fit_problem(replace(problem, base=np.array([found.lower["f"]])), starts=1)
    assert profile(again, "f").status == "closed"


def test_what_has_no_profile(line, decayed):
    with pytest.raises(InputError, match="no parameter 'd'; this fit estimated: a, b, c"):
        profile(line, "d")
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="variance inflation"):
            profile(line, "a", variance_inflation=wrong)
    with pytest.raises(InputError, match="without a finite torque"):
        profile(replace(decayed, sse=np.inf), "a")
    with pytest.raises(InputError, match="leaves no residual"):
        profile(replace(decayed, sse=0.0), "a")


@pytest.fixture(scope="module")
def tibialis(fitted):
    return profile(fitted, "k_tib")


@pytest.mark.slow
def test_it_equals_independent_refits_with_many_starts(fitted, tibialis):
    problem = fitted.problem
    for i in (0, 3, len(tibialis.values) - 3, len(tibialis.values) - 1):
        held = {"k_tib": float(tibialis.values[i])}
        again = fit_problem(make_problem(problem.inputs, fixed=held), starts=6, seed=3)
        sigma2 = fitted.sse / (problem.n - 15)
        assert abs(tibialis.sse[i] - again.sse) < 0.1 * sigma2


def test_the_passive_tibialis_is_skew(tibialis):
    low, high = tibialis.interval
    assert (high - tibialis.value) > 1.1 * (tibialis.value - low)
