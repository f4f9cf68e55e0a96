"""A film tells its muscle's path: lengths are searched along the assumed one, which it replaces."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from ankle_legs.make import make, truth_of
from richer_legs import richer_leg
from surae.base.frozen import read_only
from surae.inference import make_problem
from surae.inference.metres import OwnMetres, filmed_paths, moved_by_film
from surae.inference.posterior.departures import _scored
from surae.inference.posterior.empirical_bayes import BEGIN
from surae.inference.posterior.family import Family
from surae.inference.posterior.valleys import white_noise
from surae.model.source_table import ARM_SIZE, GEAR
from surae.signals import Film

PATH = "path_scale_tib"


@pytest.fixture(scope="module")
def inputs():
    """A leg whose tibialis is filmed; what the film shows does not matter here."""
    plain = richer_leg(0, rate_hz=64.0, duration=15.0).inputs
    time = np.arange(1.0, 14.0, 0.05)
    length = 0.06 + 0.01 * np.interp(time, plain.time, plain.angle)
    return replace(plain, films=(Film("fascicle_tib", read_only(time), read_only(length)),))


@pytest.fixture(scope="module")
def posterior(inputs):
    family = Family(make_problem([inputs], "auto"))
    return family.posterior((), 64.0, white_noise(family.original, 0.05), BEGIN)


def test_a_filmed_path_is_in_the_fit_with_the_gears_prior_and_no_other_is(inputs, posterior):
    assert filmed_paths((inputs,)) == {PATH}
    assert PATH in posterior.names
    assert "path_scale_tri" not in posterior.names
    gear = 0.68  # of the thesis's tibialis
    assert posterior.priors[PATH].mean == pytest.approx(GEAR.mean - np.log(gear), abs=0.02)
    assert posterior.priors[PATH].sd == pytest.approx(np.hypot(GEAR.sd, ARM_SIZE))


def test_a_stated_path_keeps_its_prior(inputs) -> None:
    family = Family(make_problem([inputs], "auto", nuisances={PATH: (0.1, 0.02)}))
    post = family.posterior((), 64.0, white_noise(family.original, 0.05), BEGIN)
    assert (post.priors[PATH].mean, post.priors[PATH].sd) == (0.1, 0.02)


def test_no_path_moves_the_torque_and_each_the_film(posterior) -> None:
    z = posterior.start({})
    torque = posterior.observed.plain_residual
    recording = posterior.problem.inputs[0]
    other = z.copy()
    other[posterior.names.index(PATH)] += 0.4
    assert torque(other, recording, 0) == pytest.approx(torque(z, recording, 0), abs=1e-9)
    one, moved = (posterior.by_name(each) for each in (z, other))
    for name, power in (("k_tib", -1.0), ("l0_tib", 1.0), ("x0_tib", 1.0), ("dlt_tib", 1.0)):
        assert moved[name] == pytest.approx(one[name] * np.exp(0.4 * power), rel=1e-12)
    rows = posterior.observed.rows(z, posterior.still()[0], posterior.expected()[0], 0)
    j = posterior.names.index(PATH)
    size = np.abs(rows[0].by_z).max()
    assert np.abs(rows[0].by_z[j]).max() < 1e-9 * size
    assert np.abs(rows[1].by_z[j]).min() > 0.01


def test_derivatives_by_what_is_searched_are_those_of_small_steps(posterior) -> None:
    z = posterior.start({})
    z[posterior.names.index(PATH)] += 0.3
    exact = posterior.searched(np.eye(len(z)), z)
    for j in range(len(z)):
        step = 1e-6 / posterior.weight[j]
        ends = []
        for sign in (-1.0, 1.0):
            moved = z.copy()
            moved[j] += sign * step
            ends.append(posterior.values(moved)[posterior.columns])
        numeric = (ends[1] - ends[0]) / (2.0 * step)
        assert exact[j] == pytest.approx(numeric, rel=1e-5, abs=1e-6 * np.abs(numeric).max())


def test_values_bounds_and_priors_go_to_the_films_metres_and_back(posterior) -> None:
    z = posterior.start({})
    z[posterior.names.index(PATH)] = 0.3
    values = posterior.by_name(z)
    assert posterior.start(values) == pytest.approx(z, rel=1e-12)
    metres = OwnMetres.of(posterior.problem)
    there = metres.limits(posterior.problem, posterior.values(z))
    low, high = there.limits["l0_tib"]
    assert (low, high) == pytest.approx(
        [np.exp(0.3) * end for end in posterior.problem.limits["l0_tib"]]
    )
    assert there.limits["l0_tri"] == posterior.problem.limits["l0_tri"]
    back = metres.limits(there, posterior.values(z), back=True)
    assert back.lower == pytest.approx(posterior.problem.lower)
    moved = posterior.in_metres(posterior.priors, z)["l0_tib"]
    assert moved.mean == pytest.approx(posterior.priors["l0_tib"].mean + 0.3)
    assert moved_by_film(posterior.problem, "l0_tib") == PATH
    assert moved_by_film(posterior.problem, "l0_tri") == ""


def test_a_filmed_path_is_no_departure(posterior, inputs) -> None:
    family = Family(make_problem([inputs], "auto"))
    post = family.posterior(("arm",), 64.0, white_noise(family.original, 0.05), BEGIN)
    point = post._point(post.start({}), post.still(), post.expected())
    arm, none = (
        next(s for s in _scored(post, point, ("arm",)) if s.groups == g) for g in (("arm",), ())
    )
    at = post.names.index(PATH)
    assert none.variance[at] > 0.0
    assert arm.variance[at] > 0.0


@pytest.mark.slow
def test_lengths_along_a_path_of_another_gear_are_told_by_a_film(tmp_path) -> None:
    # the search in the thesis's metres gave this leg's l0_tib as 59.8 to 74.8 mm
    path = make("vd", 3431, tmp_path, (1,), film=True)[0]
    fit = surae.fit(path, quality=())
    truth = truth_of("vd", 3431, 1)["parameters"]
    for name in ("l0_tib", "k_tib", "dlt_tib"):
        low, high = fit[name].ci95
        assert low <= truth[name] <= high, name
    low, high = fit["l0_tib"].ci95
    assert (high - low) / 2.0 < 0.15 * fit["l0_tib"].value
