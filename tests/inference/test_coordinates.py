"""Coordinates of a search: on a logarithm or as they are, a zero for each recording, valleys."""

from dataclasses import replace

import numpy as np
import pytest

from richer_legs import richer_leg
from surae.inference import make_problem
from surae.inference.coordinates import Coordinates, is_straight
from surae.inference.posterior.empirical_bayes import NEARLY_NONE
from surae.inference.posterior.family import Family
from surae.inference.posterior.valleys import white_noise
from surae.model.laboratory import Gaussian
from surae.model.parameters import OPTIONAL
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


def coordinates(trials: int) -> Coordinates:
    motion = generate(Protocol(profile="multiple-holds", duration=12.0, rate_hz=32.0))
    trial = virtual_trial(virtual_subject(1), motion)
    problem = make_problem([trial] * trials, "muscle", free=["torque_zero"], fixed={"beta": 1.0})
    start = dict(zip(problem.free, problem.start.tolist(), strict=True))
    priors = {n: Gaussian(v if is_straight(n) else np.log(v), 0.5) for n, v in start.items()}
    return Coordinates(problem, priors)


def test_values_come_back_and_stay_within_their_bounds() -> None:
    one = coordinates(1)
    values = dict(zip(one.problem.free, one.problem.start.tolist(), strict=True))
    told = one.by_name(one.start(values | {"k_tri": 150.0}))
    assert told == pytest.approx(values | {"k_tri": 150.0, "beta": 1.0})
    assert one.by_name(one.start({})) == pytest.approx(values | {"beta": 1.0})
    far = one.by_name(one.start({"g1": 0.0, "m": 99.0}))
    assert 0.0 < far["g1"] < 0.02 * values["g1"]
    assert far["m"] == one.problem.upper[one.problem.free.index("m")]
    z, step = one.start({}), 1e-6
    slopes = [
        (one.by_name(z + step * e)[n] - one.by_name(z)[n]) / step
        for n, e in zip(one.names, np.eye(len(z)), strict=True)
    ]
    np.testing.assert_allclose(one.scale(z), slopes, rtol=1e-4)
    assert one.prior_cost(z + 0.1) == pytest.approx(len(z) * 0.2**2)


def test_each_of_several_recordings_has_its_zero() -> None:
    one, two = coordinates(1), coordinates(2)
    assert (one.per_recording, "torque_zero" in one.names) == ((), True)
    assert (two.per_recording, "torque_zero" in two.names) == (("torque_zero",), False)
    assert len(two.lower) == len(two.upper) == len(two.mean) == len(two.names) + 2
    z = two.start({"torque_zero": 2.0})
    np.testing.assert_allclose(z[-2:], 2.0)
    z[-2:] = 1.0, 4.0
    zeros = [two.by_name(z, number)["torque_zero"] for number in (None, 0, 1)]
    assert zeros == pytest.approx([2.5, 1.0, 4.0])


def test_each_of_several_recordings_has_its_level_at_rest() -> None:
    """It differs between trials, and shared by force it makes claims of joint fits false."""
    legs = [richer_leg(0, trial=trial, rate_hz=64.0, duration=12.0).inputs for trial in (0, 1)]
    problem = make_problem(legs, "auto")
    white = white_noise(problem, 0.1)
    post = Family(problem).posterior((), 64.0, white, NEARLY_NONE)
    point = post.descend(post.start({}), evaluations=0, tolerance=1.0)
    assert {*post.per_recording} == {"torque_zero", *OPTIONAL["emg_rest"]}
    shared = len(post.names)
    at = [post.of_recording(number)[shared:] for number in (0, 1)]
    assert not {*at[0]} & {*at[1]}  # the other's own moves nothing here
    for number in (0, 1):
        rows = post.rows(point, number)[0].by_z
        for row, j in zip(rows[shared:], at[number], strict=True):
            name, h = post.of[j], 1e-6 if post.of[j] == "torque_zero" else 1e-9
            ends = [point.z.copy(), point.z.copy()]
            ends[0][j] -= h
            ends[1][j] += h
            still = point.c[number], point.w[number]
            low, high = (post.observed.rows(z, *still, number)[0].residual for z in ends)
            slope = (high - low) / (2.0 * h)
            assert np.quantile(np.abs(row - slope), 0.97) <= 1e-3 * np.abs(slope).max(), name


def test_a_step_along_a_valley_moves_what_the_tissue_does_straight() -> None:
    one = coordinates(1)
    pairs = [("k_tri", "x0_tri"), ("k_tib", "x0_tib")]
    assert [(one.names[k], one.names[x0]) for k, x0, _ in one.valleys] == pairs
    z, step = one.start({}), np.zeros(len(one.names))
    k, x0, longest = one.valleys[0]
    step[[k, x0]] = 0.3, 1e-3
    moved = one.curved(z, step)
    reach, stiffness = longest - z[x0], np.exp(z[k])
    straight = stiffness * (reach + reach * 0.3 - 1e-3)
    assert np.exp(moved[k]) * (longest - moved[x0]) == pytest.approx(straight)
    others = [j for j in range(len(z)) if j not in (k, x0)]
    np.testing.assert_array_equal(moved[others], z[others])


def test_an_electrode_of_noise_alone_has_a_level_for_what_was_given() -> None:
    """What parameters follow is looked at in recordings as given, that electrode in them."""
    leg = richer_leg(0, rate_hz=64.0, duration=12.0).inputs
    emg = leg.emg.copy()
    draw = np.random.default_rng(1).uniform(0.9, 1.1, len(emg))
    emg[:, 0] = 1e-3 * emg.max() * draw  # a tibialis at rest
    problem = make_problem([replace(leg, emg=emg)], "auto")
    assert {"ta"} <= {*problem.inputs_heard[0].missing_emg}
    post = Family(problem).posterior(("shape",), 64.0, white_noise(problem, 0.1), NEARLY_NONE)
    assert np.isfinite(post.observed.plain_residual(post.start({}), *problem.inputs, 0)).all()
