"""The profile of a filmed leg is that of the posterior that was fitted, film included."""

import re
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only
from surae.inference import assess
from surae.model import ModelOptions, get_model
from surae.protocol import Protocol, generate
from surae.signals import Film
from surae.studies import virtual_subject, virtual_trial

#: Fits of films are in the fast suite in tests/inference/test_film.py.
pytestmark = [pytest.mark.usefixtures("few"), pytest.mark.slow]
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


@pytest.fixture(scope="module")
def profiled(fits):
    return surae.profile(fits[0], "dlt_tib")["dlt_tib"]


def test_the_profile_of_a_filmed_length_is_narrow_and_says_where_it_is(
    fits, profiled, monkeypatch
) -> None:
    """Film included; if it is about a lower minimum than the fit's, it says so and where."""
    # The profile itself is at the arms and paths of the fit, of which a film knows nothing.
    with monkeypatch.context() as patch:
        patch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
        (low, high), blind = (assess(fit.result).parameters["dlt_tib"].ci95 for fit in fits)
    left, right = profiled.interval
    assert right - left < 0.6 * (blind[1] - blind[0])
    assert (profiled.lower is not None) == (profiled.status == "lower-minimum")
    if profiled.lower is not None:
        assert "fit again from there" in profiled.message
        assert low < profiled.lower["dlt_tib"] < high


@pytest.mark.xfail(
    reason="the search ends 2.5 in −2 ln p above a minimum at which the tibialis's electrode hears "
    "nobody (crosstalk at its bound of zero); the profile finds that one, and says so"
)
def test_a_filmed_leg_is_fitted_at_the_minimum_that_its_profile_finds(fits, profiled) -> None:
    low, high = fits[0].parameters["dlt_tib"].ci95
    assert profiled.status == "closed"
    assert profiled.interval == pytest.approx((low, high), abs=0.35 * (high - low) / 2)
    left, right = profiled.with_geometry
    assert right - left == pytest.approx(high - low, abs=0.35 * (high - low) / 2)


def test_the_whole_muscles_length_says_what_the_film_knows_better(fits) -> None:
    filmed, blind = (fit.parameters["l0_tib"].note for fit in fits)
    optimum = fits[0].measures()["optimal_fascicle_tib"]
    part = (optimum.ci95[1] - optimum.ci95[0]) / 2 / optimum.value
    said = re.search(r"own optimum is ([\d.]+) mm ±([\d.]+) % \(optimal_fascicle_tib\)", filmed)
    assert said[1] == f"{optimum.value:.1f}"
    assert float(said[2]) == pytest.approx(100 * part, abs=0.1)  # by its slopes, and by draws
    assert "optimal_fascicle_tib" not in blind
