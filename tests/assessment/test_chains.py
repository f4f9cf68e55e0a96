"""The sampler on densities whose moments are known, and what it does when something fails."""

import importlib.util
import itertools
import time

import numpy as np
import pytest

from surae.assessment.posterior.chains import _attend, convergence, require_sampler, run_chains
from surae.errors import InputError

MEAN = np.array([1.0, -0.5, 0.0])
COVARIANCE = np.array([[1.0, 0.6, 0.0], [0.6, 2.0, -0.3], [0.0, -0.3, 0.5]])


def gaussian():
    """A density of its own for every thread."""
    precision = np.linalg.inv(COVARIANCE)

    def density(z):
        away = precision @ (z - MEAN)
        return float(-0.5 * (z - MEAN) @ away), -away

    return density


def draw(make=gaussian, **settings):
    default = {"draws": 200, "tune": 200, "chains": 4, "seed": 1}
    return run_chains(make, 3, **(default | settings))


def test_a_gaussian_has_its_moments(sampler):
    found = draw(draws=1500)
    assert found.draws.shape == (4, 1500, 3)
    assert found.whole
    assert found.diverging == 0
    flat = found.draws.reshape(-1, 3)
    for j in range(3):
        effective = convergence(found.draws[..., j]).ess_bulk
        assert effective > 3000
        standard_error = np.sqrt(COVARIANCE[j, j] / effective)
        assert flat[:, j].mean() == pytest.approx(MEAN[j], abs=4 * standard_error)
    assert np.cov(flat, rowvar=False) == pytest.approx(COVARIANCE, abs=0.1)
    assert np.mean(np.abs(flat[:, 0] - 1.0) < 1.96) == pytest.approx(0.95, abs=0.01)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_draws_on_any_number_of_cores(sampler):
    first = draw(cores=1)
    assert np.array_equal(draw(cores=2).draws, first.draws)
    assert np.array_equal(draw(cores=4).draws, first.draws)
    assert not np.array_equal(draw(seed=2).draws, first.draws)
    assert not np.array_equal(first.draws[0], first.draws[1])


def test_draws_stay_where_the_density_is_finite(sampler):
    def half():
        density = gaussian()

        def cut(z):
            return density(z) if z[0] > 0 else (-np.inf, np.zeros(3))

        return cut

    assert draw(half).draws[..., 0].min() > 0


def test_an_error_in_the_density_is_raised_and_not_lost(sampler):
    def broken():
        density, count = gaussian(), 0

        def fails(z):
            nonlocal count
            count += 1
            if count > 500:
                raise ZeroDivisionError("in a thread")
            return density(z)

        return fails

    with pytest.raises(ZeroDivisionError, match="in a thread"):
        draw(broken, draws=100_000)


@pytest.mark.parametrize("cores", [1, 2])
def test_progress_is_told_and_ctrl_c_keeps_what_is_drawn(sampler, cores):
    """One chain after the other, too: the first is whole, the second short."""
    told, evaluations = [], itertools.count()

    def slowing():
        density = gaussian()

        def slows(z):  # so that it is looked after before it ends
            time.sleep(0.0 if next(evaluations) < 2_000 else 2e-3)
            return density(z)

        return slows

    def stop(done, total):
        told.append((done, total))
        if done > 0.6 * total:
            raise KeyboardInterrupt

    found = draw(slowing, draws=300, tune=10, chains=2, cores=cores, progress=stop)
    assert not found.whole
    assert [total for _, total in told] == [2 * 310] * len(told)
    chains, draws, _ = found.draws.shape
    assert chains == 2
    assert 10 <= draws < 300
    assert np.isfinite(found.draws).all()


def test_ctrl_c_before_there_is_anything_to_keep(sampler):
    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        draw(draws=20_000, tune=20_000, progress=stop)


@pytest.mark.parametrize(
    ("settings", "says"),
    [({"draws": 1}, "draws is 1; give at least 10"), ({"tune": 0}, "tune"),
     ({"chains": 1}, "chains is 1; give at least 2"), ({"cores": 0}, "cores"),
     ({"seed": -1}, "seed")],
)  # fmt: skip
def test_impossible_settings(sampler, settings, says):
    with pytest.raises(InputError, match=says):
        draw(**settings)


def test_without_the_extra_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r'not installed: pip install "surae\[bayes\]"'):
        require_sampler()


class Panicking(BaseException):
    """What a library of another language raises."""


def test_a_sampler_that_panics_at_its_end_does_not_hide_what_went_wrong():
    class Sampler:
        def wait(self, **_limits):
            raise RuntimeError("nothing is finite")

        def cancel(self):
            raise Panicking

    class Work:
        error = ZeroDivisionError("in a thread")

    with pytest.raises(ZeroDivisionError, match="in a thread"):
        _attend(Sampler(), Work(), None, 10)
