"""Profile and posterior of a filmed leg: those of the posterior that was fitted, film included."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.assessment.parameter import percent
from surae.assessment.posterior.density import make_target
from surae.frozen import read_only
from surae.model import ModelOptions, get_model
from surae.protocol import Protocol, generate
from surae.signals import Film
from surae.studies import virtual_subject, virtual_trial

pytestmark = pytest.mark.usefixtures("few")
SCALE, ZERO = 0.02, 3e-3


@pytest.fixture(scope="module")
def fits():
    """Fits of a virtual leg with a film of its tibialis and without."""
    subject = virtual_subject(3, tendons=True)
    protocol = generate(Protocol(profile="multiple-holds", duration=20.0, rate_hz=64.0))
    plain = virtual_trial(subject, protocol, noise=0.02, model="muscle-tendon")
    spec = get_model("muscle-tendon")
    state = spec.simulator(plain, ModelOptions()).tendon(
        spec.vector(subject.truth(spec.name), ModelOptions())
    )
    time = np.arange(0.5, plain.time[-1], 1 / 30.0)
    seen = (1.0 + SCALE) * np.interp(time, plain.time, state.muscle_length[1]) + ZERO
    seen = seen + 2e-4 * np.random.default_rng(1).standard_normal(len(time))
    film = Film("fascicle_tib", read_only(time), read_only(seen))
    both = replace(plain, films=(film,)), plain
    return [surae.fit(recording, prepared=True, quality=()) for recording in both]


@pytest.mark.slow
def test_the_profile_of_a_filmed_length_is_as_narrow_as_its_interval(fits) -> None:
    own, blind = (fit.parameters["dlt_tib"].ci95 for fit in fits)
    profiled = surae.profile(fits[0], "dlt_tib")["dlt_tib"].interval
    assert profiled == pytest.approx(own, abs=0.35 * (own[1] - own[0]) / 2)
    assert profiled[1] - profiled[0] < 0.6 * (blind[1] - blind[0])


def test_the_whole_muscles_length_says_what_the_film_knows_better(fits) -> None:
    filmed, blind = (fit.parameters["l0_tib"].note for fit in fits)
    optimum = fits[0].measures()["optimal_fascicle_tib"]
    part = (optimum.ci95[1] - optimum.ci95[0]) / 2 / optimum.value
    assert f"own optimum is {optimum.value:.1f} mm ±{percent(part)} (optimal_" in filmed
    assert "optimal_fascicle_tib" not in blind


def test_the_density_is_that_of_the_posterior(fits) -> None:
    target = make_target(fits[0].result)
    density, zero = target.density(), np.zeros(len(target.mode))
    names = fits[0].result.problem.free
    values = target.parameters(np.zeros((1, len(zero))))[0]
    bounded = np.minimum(target.mode - target.lower, target.upper - target.mode)
    off = bounded < 3.0 * np.sqrt(np.diag(target.covariance))  # there u = 0 is the middle
    for j, (own, value) in enumerate(zip(names, values, strict=True)):
        sd = fits[0].result.family.covariance[j, j] ** 0.5
        assert abs(value - fits[0].result.values[own]) < (1.0 if off[j] else 0.3) * sd, own
    rng = np.random.default_rng(2)
    for _ in range(3):
        u, along = 0.5 * rng.standard_normal((2, len(zero)))
        height, slope = density(u)
        assert height < density(zero)[0]
        numeric = (density(u + 1e-4 * along)[0] - density(u - 1e-4 * along)[0]) / 2e-4
        assert slope @ along == pytest.approx(numeric, abs=0.1)


def test_a_prior_that_is_given_moves_the_posterior(fits) -> None:
    value = fits[0].result.values["l0_tib"]
    target = make_target(fits[0].result, {"l0_tib": (1.1 * value, 0.005)})
    at = fits[0].result.problem.free.index("l0_tib")
    moved = target.parameters(np.zeros((1, len(target.mode))))[0, at]
    assert moved == pytest.approx(1.1 * value, rel=0.02)
    assert target.priors["l0_tib"].median == pytest.approx(1.1 * value)
    assert target.priors["l0_tib"].origin == "given"


def test_no_draw_is_beyond_a_bound(fits) -> None:
    target, problem = make_target(fits[0].result), fits[0].result.problem
    points = 3.0 * np.random.default_rng(3).standard_normal((20, len(target.mode)))
    inside = target.parameters(points)
    assert inside.shape == (20, len(problem.free))
    assert (inside >= problem.lower).all()
    assert (inside <= problem.upper).all()


@pytest.mark.slow
def test_draws_of_auto_end_and_give_intervals_only_where_they_can_be_believed(fits) -> None:
    found = surae.posterior(fits[1], draws=50, evaluations=600)
    assert found.evaluations == 600
    assert found.draws.shape == (50, len(fits[1].result.problem.free))
    assert found.k_hat is not None
    believed = found.k_hat <= 0.7 and found.effective >= 200
    assert (found.status == "reliable") == believed
    assert all((marginal.ci95 is not None) == believed for marginal in found.marginals.values())
