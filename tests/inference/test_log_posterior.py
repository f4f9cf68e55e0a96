"""The density that is drawn from: its gradient, its coordinates, its priors."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.inference import Prior, fit_problem, make_problem
from surae.model import MODELS, ModelOptions
from surae.sampling.density import Target, beliefs


@pytest.fixture(scope="module")
def target(fitted):
    return Target(fitted)


def slope(density, z, step=1e-5):
    """Central differences."""
    return np.array(
        [(density(z + step * e)[0] - density(z - step * e)[0]) / (2 * step) for e in np.eye(len(z))]
    )


def test_the_gradient_is_that_of_finite_differences(target):
    density = target.density()
    for seed in range(3):
        z = np.random.default_rng(seed).standard_normal(15)
        assert density(z)[1] == pytest.approx(slope(density, z), rel=1e-5, abs=1e-5)


def test_the_gradient_with_weights_tendons_a_signed_parameter_and_inflation(
    noisy, subject, trajectory
):
    weight = np.where(np.arange(noisy.n) % 3 == 0, 0.0, 0.7)
    weighted = replace(noisy, weight=read_only(weight))
    known = ("g2", "g3", "g4", "tau_rel", "k_rel", "f0", "beta")
    fixed = {name: subject.parameters[name] for name in known}
    elastic = make_problem([weighted], "muscle-tendon", free=["dlt_tib"], fixed=fixed)
    result = fit_problem(elastic, starts=1)
    target = Target(result, {"dlt_tib": (0.05, 0.1)}, 3.0)
    density, z = target.density(), np.linspace(-0.7, 0.7, len(elastic.free))
    # Of slopes near 1: the tendon's steps are solved by a few Newton iterations, and have kinks.
    assert density(z)[1] == pytest.approx(slope(density, z, 1e-4), abs=5e-3)

    older = make_problem([noisy], "muscle-2010")
    target = Target(fit_problem(older, starts=1))
    assert [prior.log for prior in target.priors.values()] == [n != "F0" for n in older.free]
    density, z = target.density(), np.linspace(-0.7, 0.7, len(older.free))
    assert density(z)[1] == pytest.approx(slope(density, z), rel=1e-5, abs=1e-5)


def test_the_mode_is_the_highest_point_and_the_width_there_is_one(target):
    density, zero = target.density(), np.zeros(15)
    assert np.abs(density(zero)[1]).max() < 0.1
    # Over half a standard deviation, across the kinks where tissue goes slack, of what is nearly
    # linear: all but the passive tibialis.
    h = 0.5
    curvature = [(density(h * e)[1] - density(-h * e)[1]) / (2 * h) for e in np.eye(15)]
    linear = [i for i, name in enumerate(target.priors) if name not in ("k_tib", "x0_tib")]
    part = np.ix_(linear, linear)
    assert np.array(curvature)[part] == pytest.approx(-np.eye(15)[part], abs=0.25)


def test_inflated_noise_widens_what_the_data_determine(fitted, target):
    wide = Target(fitted, variance_inflation=4.0)
    ratio = (np.diag(wide.covariance) / np.diag(target.covariance)) ** 0.5
    names = fitted.problem.free
    for name in ("m", "l0_tri", "f0", "g1", "tau_rel"):
        assert ratio[names.index(name)] == pytest.approx(2.0, rel=0.03)
    assert ratio[names.index("k_tib")] < 1.9  # where the prior has a say


def test_a_narrow_prior_holds_its_parameter(fitted):
    target = Target(fitted, {"f0": (3.0, 1e-4)})
    f0 = fitted.problem.free.index("f0")
    assert target.parameters(np.zeros((1, 15)))[0, f0] == pytest.approx(3.0, rel=1e-3)


def test_no_finite_torque_has_no_density(target):
    far = np.zeros(15)
    far[:] = 1e6
    value, gradient = target.density()(far)
    assert value == -np.inf
    assert not gradient.any()


def test_a_weight_of_zero_is_a_place_to_start_from(fitted):
    at_bound = replace(fitted, values=dict(fitted.values) | {"g1": 0.0})
    target = Target(at_bound)
    assert target.parameters(np.zeros((1, 15)))[0] == pytest.approx(
        [fitted.values[name] for name in fitted.problem.free], rel=0.1
    )


@pytest.mark.parametrize("model", list(MODELS))
@pytest.mark.parametrize("geometry", ["thesis", "virtual-work"])
@pytest.mark.parametrize("unit", ["V", "1"])
def test_every_parameter_has_a_prior_within_the_bounds_of_a_fit(noisy, model, geometry, unit):
    options = ModelOptions(geometry=geometry, tendon_strain="slack-length")
    spec = MODELS[model]
    freed = [name for name in spec.names if name not in spec.free]
    one = replace(noisy, emg_unit=unit)
    try:
        problem = make_problem([one], model, free=freed, options=options)
    except InputError as error:
        pytest.skip(str(error))
    table = problem.table
    found = beliefs(problem)
    assert list(found) == list(spec.names)
    for name, prior in found.items():
        assert table[name].lower < prior.median < table[name].upper, name
        assert prior.source == "population"


def test_priors_of_the_fit_and_given_ones_come_first(noisy):
    problem = make_problem([noisy], priors={"f0": (2.5, 0.1), "beta": (1.1, 0.2)})
    found = beliefs(problem, {"f0": (1.8, 0.3)})
    assert found["f0"] == Prior(1.8, 0.3, "given")
    assert found["beta"] == Prior(1.1, 0.2, "fit")
    assert found["m"].source == "population"


@pytest.mark.parametrize(
    ("priors", "says"),
    [({"nope": (1, 1)}, "not estimated"), ({"f0": (1, -1)}, "above zero"), ({"f0": 2}, "median")],
)
def test_wrong_priors(fitted, priors, says):
    with pytest.raises(InputError, match=says):
        beliefs(fitted.problem, priors)
