"""Filmed fascicles in the posterior: exact derivatives, the film's noise, what is reported."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import surae
from surae.base.frozen import read_only
from surae.inference import make_problem
from surae.inference.judging.fascicles import followed
from surae.inference.noise import NoiseModel
from surae.inference.posterior.empirical_bayes import BEGIN
from surae.inference.posterior.family import Family
from surae.inference.posterior.film import noise_of_film
from surae.inference.posterior.log_posterior import LogPosterior
from surae.inference.posterior.valleys import white_noise
from surae.model import ModelOptions, get_model, with_optional
from surae.protocol import Protocol, generate
from surae.signals import Film
from surae.studies import virtual_subject, virtual_trial

SCALE, ZERO = 0.02, 3e-3
SEEN = {f"film_scale_{at}": SCALE for at in ("tib", "gm")}
SEEN |= {f"film_zero_{at}": ZERO for at in ("tib", "gm")}


def _films_of(plain, subject):
    """Films of the gastrocnemius and the tibialis at 30 frames a second."""
    spec = get_model("muscle-tendon")
    simulator = spec.simulator(plain, ModelOptions())
    state = simulator.tendon(spec.vector(subject.truth(spec.name), ModelOptions()))
    time = np.arange(1.5, plain.time[-1] - 0.1, 1 / 30.0)
    rng = np.random.default_rng(1)
    films = []
    for channel, length in zip(("fascicle_gm", "fascicle_tib"), state.muscle_length, strict=True):
        seen = (1.0 + SCALE) * np.interp(time, plain.time, length) + ZERO
        noisy = seen + rng.normal(0.0, 2e-4, len(time))
        films.append(Film(channel, read_only(time), read_only(noisy)))
    return tuple(films)


@pytest.fixture(scope="module")
def filmed():
    """A short virtual trial with both muscle groups filmed at 30 frames a second."""
    subject = virtual_subject(3)
    protocol = generate(Protocol(profile="multiple-holds", duration=12.0, rate_hz=64.0))
    plain = virtual_trial(subject, protocol, noise=0.02, model="muscle-tendon")
    return replace(plain, films=_films_of(plain, subject)), subject.truth("muscle-tendon")


@pytest.fixture(scope="module")
def posterior(filmed) -> LogPosterior:
    family = Family(make_problem([filmed[0]], "auto"))
    return family.posterior(("arm", "curves"), 64.0, white_noise(family.original, 0.05), BEGIN)


@pytest.fixture(scope="module")
def point(posterior):
    rng = np.random.default_rng(2)
    posterior = posterior.having(fast=0.1)
    inside = 1e-3 * (posterior.upper - posterior.lower)
    z = np.clip(posterior.start({}), posterior.lower + inside, posterior.upper - inside)
    c = tuple(0.02 * rng.standard_normal(len(own)) for own in posterior.still())
    for own, latents in zip(c, posterior.latents, strict=True):
        for at in latents.own_of_films():
            own[at] *= 0.05
    w = tuple(0.05 * rng.standard_normal(len(own)) for own in posterior.expected())
    return posterior, z, c[0], w[0]


def _residuals(posterior, z, c, w):
    return np.concatenate([rows.residual for rows in posterior.observed.rows(z, c, w, 0)[1:]])


@pytest.mark.parametrize("of", ["z", "c"])
def test_derivatives_are_those_of_the_residual(point, of) -> None:
    posterior, z, c, w = point
    exact = np.concatenate(
        [getattr(rows, f"by_{of}") for rows in posterior.observed.rows(z, c, w, 0)[1:]], axis=1
    )
    own = {"z": z, "c": c}
    for j in range(0, len(own[of]), 1 if of == "z" else 21):
        step = min(1e-4 / posterior.weight[j], 1e-5) if of == "z" else 1e-5
        ends = []
        for sign in (-1.0, 1.0):
            moved = own[of].copy()
            moved[j] += sign * step
            ends.append(_residuals(posterior, **{"z": z, "c": c, "w": w, of: moved}))
        numeric = (ends[1] - ends[0]) / (2 * step)
        size = max(np.abs(numeric).max(), 1e-3 * np.abs(exact).max())
        # the gains are followed to first order through the force balance, for a limited time
        np.testing.assert_allclose(
            exact[j], numeric, rtol=0, atol=(1e-4 if of == "z" else 1e-2) * size
        )


def test_fast_gains_reach_the_frames(point) -> None:
    posterior, z, c, w = point
    films = posterior.observed.rows(z, c, w, 0)[1:]
    j = len(w) // 2
    moved = w.copy()
    moved[j] += 1e-3
    after = _residuals(posterior, z, c, moved)
    before = _residuals(posterior, z, c, w)
    exact = []
    for rows in films:
        columns, first = rows.fast, rows.first
        whole = np.zeros(len(rows.residual))
        stop = min(len(whole), first[j] + columns.shape[1])
        whole[first[j] : stop] = columns[j, : stop - first[j]]
        exact.append(whole)
    numeric = (after - before) / 1e-3
    np.testing.assert_allclose(
        np.concatenate(exact), numeric, rtol=0, atol=0.05 * np.abs(numeric).max()
    )


def test_a_film_tells_the_length_of_its_muscle(filmed, posterior) -> None:
    recording, _ = filmed
    family = Family(make_problem([replace(recording, films=())], "auto"))
    blind = family.posterior(("arm", "curves"), 64.0, posterior.noise, BEGIN)
    known = NoiseModel(np.zeros(0), 2e-4**2, np.array([2e-4**2]), 300.0)
    latents = tuple(
        replace(each, films=tuple(replace(film, noise=known) for film in each.films))
        for each in posterior.latents
    )
    spread = []
    for each in (blind, posterior.having(latents=latents)):
        z = each.start({})
        H, _ = each.reduced(each.blocks(z, each.still(), each.expected()))
        V = np.linalg.inv(H + np.diag(each.weight**2))
        spread.append(np.sqrt(V[each.names.index("dlt_tib"), each.names.index("dlt_tib")]))
    assert spread[1] < 0.7 * spread[0]


def test_what_is_followed_is_reported_in_millimetres(filmed) -> None:
    recording, values = filmed
    spec, options = get_model("muscle-tendon"), ModelOptions()
    filmed = with_optional(spec, SEEN)
    own = followed(filmed, options, values | SEEN, recording)
    assert [film.channel for film in own] == ["fascicle_gm", "fascicle_tib"]
    for film in own:
        assert film.quality.n == len(recording.films[0].time)
        assert film.quality.rmse_mm == pytest.approx(0.2, rel=0.15)
        assert film.quality.noise_mm == pytest.approx(0.2, rel=0.15)
        assert film.quality.correlation > 0.99
        np.testing.assert_allclose(film.filmed_stretch, film.stretch, atol=1e-3)
    other = followed(spec, options, values, recording)[1]
    assert other.quality.bias_mm == pytest.approx(3.0 + 0.02 * 1e3 * 0.06, abs=1.0)
    rigid = followed(get_model("muscle"), options, values, recording)[1]
    assert not rigid.stretch.any()
    assert rigid.quality.rmse_mm > 2.0


def test_frames_count_for_as_little_as_the_slow_part_of_their_noise_says() -> None:
    rng = np.random.default_rng(3)
    slow = lfilter([1.0], [1.0, -0.97], 1e-4 * rng.standard_normal(2000))
    model = noise_of_film(slow, np.zeros((1, 2000)))
    assert model.order == 0
    assert model.variance > 4.0 * np.var(np.diff(slow))


def test_the_trackers_drift_is_followed_faster_than_it_forgets(posterior) -> None:
    film = posterior.latents[0].films[0]
    apart = np.diff([film.length.size * row.argmax() / row.size for row in film.drift]) / 30.0
    assert apart.max() < 0.3 * 5.0


def test_a_joint_fit_has_one_zero_of_each_film(filmed) -> None:
    recording, _ = filmed
    family = Family(make_problem([recording, replace(recording, name="again")], "auto"))
    joint = family.posterior((), 64.0, white_noise(family.original, 0.05), BEGIN)
    at = joint.names.index("film_zero_tib")
    assert joint.names.count("film_zero_tib") == 1
    z, c, w = joint.start({}), joint.still(), joint.expected()
    for number in range(2):
        films = joint.observed.rows(z, c[number], w[number], number)[1:]
        seen = {
            view.channel: rows.by_z[at].any()
            for view, rows in zip(joint.latents[number].films, films, strict=True)
        }
        assert seen == {"fascicle_gm": False, "fascicle_tib": True}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 5])
def test_a_relaxed_leg_whose_gains_are_free_shows_no_optimal_length(seed) -> None:
    """Its EMG is noise: the muscle is not taken for active, whose length would make up for it."""
    subject = virtual_subject(seed, tendons=True)
    protocol = Protocol(profile="multiple-holds", task="passive", duration=15.0, rate_hz=64.0)
    plain = virtual_trial(subject, generate(protocol), model="muscle-tendon")
    filmed = replace(plain, films=_films_of(plain, subject)[1:])
    fit = surae.fit(filmed, prepared=True, quality=())
    for name in ("l0_tib", "l0_tri"):
        estimate, truth = fit.parameters[name], subject.parameters[name]
        assert estimate.verdict not in {"identified", "at-bound"}
        assert estimate.ci95[0] < truth < estimate.ci95[1]
    assert fit.measures()["optimal_fascicle_tib"].value is None


@pytest.mark.parametrize("still", [pytest.param(True, marks=pytest.mark.slow), False])
def test_a_hold_and_a_relaxed_leg_show_no_optimal_length(still) -> None:
    """Their film is followed; what it can't show is not identified, and no interval is false."""
    task = "active" if still else "passive"
    protocol = generate(Protocol(profile="multiple-holds", task=task, duration=15.0, rate_hz=64.0))
    if still:  # a robot that holds sways a little
        sway = 3e-3 * np.sin(np.pi * protocol.time)
        motion = (sway, np.gradient(sway, protocol.time), -(np.pi**2) * sway)
        angle, velocity, acceleration = map(read_only, motion)
        protocol = replace(protocol, angle=angle, velocity=velocity, acceleration=acceleration)
    silent = {} if still else dict.fromkeys(("g1", "g2", "g3", "g4"), 0.0)
    subject = virtual_subject(3, tendons=True)
    subject = replace(subject, parameters={**subject.parameters, **silent})
    plain = virtual_trial(subject, protocol, model="muscle-tendon")
    recording = replace(plain, films=_films_of(plain, subject)[1:])
    fit = surae.fit(recording, prepared=True, fixed=silent, quality=())
    (film,) = fit.assessment.recordings[0].fascicles
    assert film.rmse_mm < 0.3
    assert (fit.adequacy.grade == "inadequate") == still
    truth = subject.truth("muscle-tendon")
    estimates = [fit.assessment.parameters[name] for name in ("l0_tib", "x0_tib", "dlt_tib")]
    assert all(e.ci95[0] < truth[e.name] < e.ci95[1] for e in estimates)
    assert {e.verdict for e in estimates[:2]} == {"weak"}
    optimum = fit.measures()["optimal_fascicle_tib"]
    if not still:
        assert optimum.value is None
        assert "hardly changes" in optimum.note
        return
    assert optimum.verdict != "identified"
    assert optimum.ci95[0] < 1e3 * ((1.0 + SCALE) * truth["l0_tib"] + ZERO) < optimum.ci95[1]
