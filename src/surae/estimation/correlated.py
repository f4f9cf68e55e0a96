"""Noise that is correlated over time: how much of its correlation may be believed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surae.estimation.mode import Mode, Target
from surae.estimation.noise import NoiseModel, drawn_by, level_above_half

#: Sum of squares, as a part of what least squares leave, from which a mode under correlated noise
#: has let the torque go; and the frequencies [Hz] whose noise counts then.
_LET_GO, _SLOW = 1.3, 2.0
#: By how much the distance of a mode under correlated noise from least squares may exceed what
#: noise makes it on average, which is taken for no less than that of so many free values.
_EXPLAINED, _LEAST = 3.0, 3.0


def under_noise(target: Target, mode: Mode) -> tuple[Target, Mode]:
    """The target under the noise that its residual has, and its mode.

    A noise model trusts most the frequencies with the least residual. Where these hold no signal,
    as above the cut-off of a filter that the recording went through, or where the model does not
    hold, its mode moves away from that of least squares by more than noise can move it (Hausman
    1978). Then no frequency is trusted more than those that half of the residual lies below; and
    where that moves too far as well, samples count alike, for as little as the residual's slow
    part says.
    """
    white = target.with_noise(target.noise_at(mode.z, white=True))
    plain = white.descend(mode.z, evaluations=20, tolerance=0.03)
    noise = target.noise_at(plain.z)
    for believed in (noise, tuple(level_above_half(model) for model in noise)):
        correlated = target.with_noise(believed)
        there = correlated.descend(plain.z, evaluations=15, tolerance=0.01)
        if _as_near_as_noise(white, plain, correlated, noise, there):
            return correlated, there
    inflated = target.with_noise(counted_alike(target, noise))
    return inflated, inflated.descend(plain.z, evaluations=15, tolerance=0.01)


def counted_alike(target: Target, noise: Sequence[NoiseModel]) -> tuple[NoiseModel, ...]:
    """White noise for which samples count for as little as the slow part of a noise says."""
    return tuple(
        replace(
            model,
            coefficients=np.zeros(0),
            variance=max(model.below(_SLOW / recording.rate_hz), model.variance),
        )
        for model, recording in zip(noise, target.problem.inputs, strict=True)
    )


def _as_near_as_noise(
    white: Target, plain: Mode, correlated: Target, noise: Sequence[NoiseModel], there: Mode
) -> bool:
    """Whether a mode under correlated noise is as far from least squares as noise explains.

    The distance is that of the modelled torques, Σ (ΔT/σ)²; what noise of this correlation makes
    of it is the trace of the information times what least squares are less certain.
    """
    if correlated.sum_of_squares(there.z) > _LET_GO * white.sum_of_squares(plain.z):
        return False
    q = len(plain.z)
    information, meat = np.zeros((q, q)), np.zeros((q, q))
    for block, own, its in zip(white.data_rows(plain.z), white.noise, noise, strict=True):
        rows = block[:-1]
        information += rows @ rows.T
        coloured = drawn_by(rows, its) / np.sqrt(own.variance)
        meat += coloured @ coloured.T
    prior = np.diag(white.weight**2)
    inverse = np.linalg.inv(information + prior)
    least_squares = inverse @ (meat + prior) @ inverse
    weighted = correlated.quadratic(there).solved({})[2]
    away = there.z - plain.z
    distance = float(away @ information @ away)
    expected = float(np.trace(information @ (least_squares - weighted)))
    return distance <= _EXPLAINED * max(expected, _LEAST)
