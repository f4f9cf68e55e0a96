"""Posteriors that are known otherwise, and those of whole fits."""

import json
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.inference import assess, fit_problem, make_problem
from surae.inference.least_squares.residuals import Residuals
from surae.sampling.profiles import profiles
from surae.sampling.sample import sample
from surae.signals import thinned
from surae.studies import virtual_trial

FEW = {"draws": 250, "evaluations": 1200}
MANY = {"draws": 2000, "evaluations": 3600}


@pytest.fixture(scope="module")
def one(noisy, subject):
    """A fit of f0 alone to a third of the samples, all else known."""
    fixed = {name: value for name, value in subject.parameters.items() if name != "f0"}
    return fit_problem(make_problem([thinned(noisy, 3)], fixed=fixed), starts=1)


@pytest.fixture
def at_fitted_arms(monkeypatch):
    """Draws at the arms and paths of the fit, as profiles are; others: test_arms_and_paths.py."""
    monkeypatch.setattr("surae.sampling.sample.arms_and_paths", lambda _: None)


def quantiles(grid, log_density):
    """2.5, 50 and 97.5 % quantiles of a density on a grid."""
    density = np.exp(log_density - log_density.max())
    total = np.cumsum(density) / density.sum()
    return np.interp([0.025, 0.5, 0.975], total, grid)


@pytest.mark.parametrize("prior", [pytest.param(None, marks=pytest.mark.slow), (2.4, 0.002)])
def test_one_parameter_has_the_posterior_of_a_quadrature(one, prior):
    known = {} if prior is None else {"f0": prior}
    found = sample(one, **MANY, priors=known)
    assert found.status == "reliable", found.message
    residuals, estimate = Residuals(one.problem), one.values["f0"]
    grid = np.linspace(0.95 * estimate, 1.15 * estimate, 1001)
    sse = np.array([np.sum(residuals.data_rows(np.array([x]))[-1] ** 2) for x in grid])
    median, spread = prior or (1.96, 0.375)
    logarithm = -one.problem.n / 2 * np.log(sse) - (np.log(grid / median) / spread) ** 2 / 2
    expected = quantiles(grid, logarithm - np.log(grid))  # per Hz: log-normal
    width = expected[2] - expected[0]
    marginal = found["f0"]
    error = 4 * width / np.sqrt(found.effective)
    assert marginal.median == pytest.approx(expected[1], abs=error)
    assert marginal.ci95 == pytest.approx((expected[0], expected[2]), abs=error)
    assert (marginal.prior_part > 0.7) == marginal.of_prior == (prior is not None)


@pytest.mark.slow
def test_inflated_noise_widens_posterior_and_covariance_alike(one):
    plain, wide = sample(one, **FEW), sample(one, variance_inflation=9.0, **FEW)
    for way in (lambda m: m.ci95, lambda m: m.from_covariance):
        (a, b), (c, d) = way(plain["f0"]), way(wide["f0"])
        assert (d - c) / (b - a) == pytest.approx(3.0, rel=0.15)
    assert wide.covariance.matrix == pytest.approx(9.0 * plain.covariance.matrix)


@pytest.mark.slow
@pytest.mark.usefixtures("at_fitted_arms")
def test_a_whole_fit_is_the_same_on_any_number_of_cores(fitted, tmp_path):
    first = sample(fitted, workers=1, **FEW)
    again = sample(fitted, workers=2, **FEW)
    assert np.array_equal(first.draws, again.draws)
    assert first.draws.shape == (250, 15)
    assert first.status == "reliable", first.message
    assert first.names == fitted.problem.free
    for name in ("m", "k_tri", "l0_tri", "g2", "beta"):
        marginal = first[name]
        low, high = marginal.from_covariance
        assert abs(marginal.median - marginal.value) < 0.2 * (high - low)
        assert (marginal.ci95[1] - marginal.ci95[0]) / (high - low) == pytest.approx(1.0, abs=0.25)
    assert first.correlation.shape == (15, 15)
    assert first.of("f0").shape == (250,)
    assert not first.draws.flags.writeable

    path = tmp_path / "posterior.json"
    first.save(path)
    saved = json.loads(path.read_text(encoding="utf-8"))
    assert saved["samples"]["f0"] == first.draws[:, 13].tolist()
    assert saved["parameters"]["f0"]["ci95"] == list(first["f0"].ci95)
    assert saved["parameters"]["f0"]["prior"]["origin"] == "population"
    assert saved["k_hat"] == first.k_hat < 0.7

    tree = first.to_inference_data()
    assert dict(tree["posterior"].sizes) == {"chain": 1, "draw": 250}
    assert tree["posterior"]["f0"].attrs["units"] == "Hz"
    assert tree.attrs["status"] == "reliable"
    assert np.array_equal(tree["posterior"]["f0"].values[0], first.of("f0"))
    known = first["f0"].prior
    drawn = np.log(tree["prior"]["f0"].values)
    assert drawn.mean() == pytest.approx(np.log(known.median), abs=4 * known.spread / 250**0.5)
    assert float(tree["sample_stats"]["k_hat"]) == first.k_hat


def test_too_few_effective_draws_have_no_intervals(fitted):
    found = sample(fitted, draws=100, evaluations=60)
    assert found.status == "not reliable"
    assert "profile the parameters" in found.message
    assert found["f0"].ci95 is found["f0"].median is found["f0"].prior_part is None
    assert not found["f0"].of_prior
    assert json.loads(json.dumps(found.as_dict(), allow_nan=False))["parameters"]


def test_what_has_no_posterior(one):
    with pytest.raises(InputError, match="no residual"):
        sample(replace(one, sse=0.0), **FEW)
    with pytest.raises(InputError, match="without a finite torque"):
        sample(replace(one, sse=np.inf), **FEW)
    with pytest.raises(InputError, match="variance inflation is 0"):
        sample(one, variance_inflation=0, **FEW)
    with pytest.raises(InputError, match="not estimated"):
        sample(one, priors={"m": (2.0, 0.1)}, **FEW)


@pytest.mark.slow
@pytest.mark.usefixtures("at_fitted_arms")
def test_where_the_model_is_nearly_linear_all_three_intervals_agree(fitted):
    found = sample(fitted, **MANY)
    assert found.status == "reliable", found.message
    profiled = profiles(fitted)
    for name, one in found.marginals.items():
        half = (one.ci95[1] - one.ci95[0]) / 2
        off = np.abs(np.subtract(profiled[name].interval, one.ci95)).max() / half
        if name in ("k_tib", "x0_tib"):  # the passive tibialis: bent, and its prior has a say
            assert found[name].prior_part > 0.3
            assert not found[name].of_prior
        else:
            assert off < 0.25, name
            assert one.off_covariance < 0.25, name


@pytest.mark.slow
def test_strain_and_toe_force_of_the_tibialis_do_not_part(subject, trajectory):
    trial = virtual_trial(subject, trajectory, model="muscle-tendon", noise=0.05)
    tibialis = ("k_tib", "x0_tib", "g1", "l0_tib", "m")
    fixed = {name: v for name, v in subject.parameters.items() if name not in tibialis}
    problem = make_problem([trial], "muscle-tendon", free=["dlt_tib", "pt_tib"], fixed=fixed)
    # Around the tendon that the trial has, the thesis's, which is more compliant than in health.
    tendon = {"dlt_tib": (0.04, 0.5), "pt_tib": (0.3, 0.4)}
    found = sample(fit_problem(problem, starts=2), priors=tendon, **MANY)
    assert found.status == "reliable", found.message
    toe = found["pt_tib"]
    assert toe.of_prior
    assert toe.ci95[0] > 0.1  # where the covariance's interval reaches to zero
    assert toe.from_covariance[0] < 0.02
    assert toe.off_covariance > 0.5
    assert found["m"].off_covariance < 0.25
    assert found["dlt_tib"].ci95[0] < 0.04 < found["dlt_tib"].ci95[1]


def test_a_fit_gives_draws_with_its_own_intervals_and_correlations(fitted):
    fit = surae.Fit(fitted, assess(fitted))
    tree = fit.to_inference_data(20_000, seed=1)
    drawn = tree["posterior"]
    assert tree.attrs["status"] == "approximation"
    known = {name: p for name, p in fit.parameters.items() if p.ci95}
    assert list(drawn) == list(known)
    for name, p in known.items():
        half = (p.ci95[1] - p.ci95[0]) / 2
        found = np.quantile(drawn[name].values, [0.025, 0.5, 0.975])
        bends = 0.05 + 0.6 * half / abs(p.value)  # on a logarithm what is wide reaches higher
        # arms and paths move the middle: intervals are about the mean of what these may be
        middle = np.sqrt(p.ci95[0] * p.ci95[1]) if p.budget.get("path_size") else p.value
        assert np.abs(found - [p.ci95[0], middle, p.ci95[1]]).max() < bends * half
    names = fit.covariance.names
    k, x0 = names.index("m"), names.index("k_rel")
    assert dict(drawn.sizes) == {"chain": 4, "draw": 5000}
    r = np.corrcoef(drawn["m"].values.ravel(), drawn["k_rel"].values.ravel())[0, 1]
    assert r == pytest.approx(fit.covariance.correlation[k, x0], abs=0.03)
    assert fit.to_inference_data(seed=1).equals(fit.to_inference_data(seed=1))


def test_arviz_has_what_was_seen_and_how_likely_it_is(fitted):
    fit = surae.Fit(fitted, assess(fitted))
    tree = fit.to_inference_data(8, seed=1, log_likelihood=True)
    (inputs,) = fitted.problem.inputs
    np.testing.assert_array_equal(tree["observed_data"]["torque"].values, inputs.torque)
    told = tree["log_likelihood"]["torque"]
    assert dict(told.sizes) == {"chain": 4, "draw": 2, "sample": inputs.n}
    best = -0.5 * fitted.sse / fit.covariance.sigma2
    free = told.sum("sample").values + 0.5 * inputs.n * np.log(2 * np.pi * fit.covariance.sigma2)
    assert np.all(free < best + 1e-6)
    assert np.all(free > best - 60.0)  # a χ² of fifteen
    over_time = fit.to_xarray()
    np.testing.assert_allclose(
        over_time["torque"].values - over_time["modelled"].values, fitted.residuals[0], atol=1e-12
    )


def test_draws_leave_out_what_has_no_interval(fitted):
    judged = assess(fitted)
    own = dict(judged.parameters)
    own["f0"] = replace(own["f0"], ci95=None)
    tree = surae.Fit(fitted, replace(judged, parameters=own)).to_inference_data(200)
    assert "f0" not in tree["posterior"]
    assert tree["posterior"]["k_rel"].values.min() > 0.0
    assert tree.attrs["message"].endswith("left out: f0")
    nothing = {name: replace(p, ci95=None) for name, p in own.items()}
    with pytest.raises(InputError, match="nothing to draw"):
        surae.Fit(fitted, replace(judged, parameters=nothing)).to_inference_data()
