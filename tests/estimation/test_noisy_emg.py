"""Noise of the EMG: found in the residual, counted once, and no more than it can be."""

from dataclasses import replace

import numpy as np
import pytest

from richer_legs import richer_leg
from surae.assessment import Verdict, assess
from surae.estimation import make_problem, solve
from surae.estimation.mode import Mode, Target
from surae.estimation.noisy_emg import noisy_emg, without_emg_bias
from surae.frozen import read_only
from surae.recording import MUSCLES, Recording
from surae.signals import prepare
from surae.signals.settings import Preparation
from surae.studies.disturbances import raw_emg
from surae.studies.leg import EMG_FULL

SEED = 723  # of none of the legs that this was made on


def prepared(leg, emg, kind):
    recording = Recording.from_arrays(
        leg.inputs.time, leg.inputs.angle, leg.inputs.torque, emg, emg_kind=kind
    )
    return prepare(recording, Preparation(rate_hz=128.0))


def found(inputs):
    """The fit, and the target and mode that it ended at."""
    result = solve(make_problem([inputs], "auto"))
    family = result.family
    target = Target(result.problem, family.beliefs, family.noise)
    mode = Mode(target.start(result.values), 0.0)
    return result, target, mode


@pytest.fixture(scope="module")
def leg():
    return richer_leg(SEED, raw=True, emg_noise=0.0, profile="ramp-and-hold", duration=17.0)


@pytest.fixture(scope="module")
def raw(leg):
    return found(prepared(leg, leg.raw, "raw"))


def test_the_noise_of_raw_emg_is_what_the_residual_is_made_of(raw):
    _, target, mode = raw
    noisy = noisy_emg(target, mode, target.quadratic(mode))
    assert noisy.part > 0.5
    assert noisy.strength > 0.7
    assert noisy.power > 0.5 * target.quadratic(mode).cost


def test_a_smooth_envelope_makes_none_of_the_residual(leg):
    _, target, mode = found(prepared(leg, leg.inputs.emg.clip(0.0), "envelope"))
    noisy = noisy_emg(target, mode, target.quadratic(mode))
    assert noisy.part < 0.1
    assert noisy.strength == 1.0


def test_noise_that_a_residual_does_not_have_is_not_there(raw):
    """Effort that trembles is no noise: the torque trembles with it, and no residual is left."""
    _, target, mode = raw
    recording = target.problem.inputs[0]
    rng = np.random.default_rng(2)
    emg = recording.emg * rng.gamma(0.3, 3.0, (recording.n, 1))
    trembling = replace(recording, emg=read_only(emg))
    torque = recording.torque + target.of_inputs((trembling,)).residuals(mode.z)[0]
    torque += 0.05 * rng.standard_normal(recording.n)
    followed = target.of_inputs((replace(trembling, torque=read_only(torque)),))
    noisy = noisy_emg(followed, mode, followed.quadratic(mode))
    assert noisy.strength < 0.7


def test_a_shift_is_no_longer_than_noise_can_make_it(raw):
    _, target, mode = raw
    recording = target.problem.inputs[0]
    rng = np.random.default_rng(5)
    scatter = recording.emg.max(axis=0) * np.abs(rng.standard_normal(recording.emg.shape))
    loud = target.of_inputs((replace(recording, emg=read_only(recording.emg + 3.0 * scatter)),))
    quadratic = loud.quadratic(mode)
    noisy = noisy_emg(loud, mode, quadratic)
    z, left = without_emg_bias(loud, mode, quadratic, noisy)
    assert np.array_equal(z, mode.z)
    most = (np.sqrt(quadratic.cost) + np.sqrt(noisy.power)) ** 2 + len(z)
    length = left @ (quadratic.information @ left + quadratic.weight**2 * left)
    assert 0.0 < length <= most * (1.0 + 1e-9)


def curved(leg, draw):
    """What a fit is worth of a force that is curved over raw EMG, of one draw of that."""
    shape, rate = -2.0, leg.inputs.rate_hz
    effort = leg.inputs.emg.clip(0.0) / EMG_FULL
    heard = EMG_FULL * np.log1p(effort * np.expm1(shape)) / shape
    emg = raw_emg(heard, rate, np.random.default_rng(draw))
    return assess(solve(make_problem([prepared(leg, emg, "raw")], "auto")))


def claimed(worth):
    """What is called identified, but for weights: another level is their reference."""
    weights = {f"g{c + 1}" for c in range(len(MUSCLES))}
    return [
        p
        for p in worth.parameters.values()
        if p.verdict is Verdict.IDENTIFIED and p.name not in weights
    ]


def test_a_force_that_is_curved_over_raw_emg_leaves_the_intervals_useful(leg):
    """The curve is one of effort: over raw EMG's fluctuation a bias had no end (decision 16)."""
    worth = curved(leg, 11)
    assert all(worth.parameters[n].sem < 0.2 * worth.parameters[n].value
               for n in ("m", "l0_tri", "l0_tib"))  # fmt: skip
    assert claimed(worth)
    for p in claimed(worth):  # one interval of twenty misses; the test below counts them
        assert abs(p.value - leg.parameters[p.name]) < 3.0 * p.sem


@pytest.mark.slow
def test_what_is_claimed_of_a_force_curved_over_raw_emg_is_true(leg):
    hits = [
        p.ci95[0] <= leg.parameters[p.name] <= p.ci95[1]
        for draw in range(11, 19)
        for p in claimed(curved(leg, draw))
    ]
    assert len(hits) >= 10
    assert np.mean(hits) >= 0.9
