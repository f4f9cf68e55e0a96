"""The look back: what parameters alone follow, which no later stage of a search may lose.

Latents can take of the torque what parameters explained before, and a search that lets them ends
in another valley, with a good fit and false values.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.base.units import FloatArray
from surae.estimators import STARTS
from surae.inference.least_squares.residuals import Residuals
from surae.inference.posterior.empirical_bayes import Reached
from surae.inference.posterior.family import RATE_HZ, Family
from surae.inference.posterior.linearised import measured
from surae.signals import ModelInputs

#: By how much less of the torque's variance parameters may follow than before a stage of the
#: search, or than those of the simplest member do.
LESS = 0.005
#: Part that the simplest member follows of recordings that it follows well.
_LITTLE = 0.9


def simplest(family: Family) -> tuple[Mapping[str, float], float]:
    """Values of the simplest member, and the part of the torque's variance they follow.

    Where that is little it has several valleys, and is fitted as a user's own is.
    """
    fits: list[tuple[Mapping[str, float], float]] = []
    for inputs, starts in ((family.at_rate(RATE_HZ), 1), (family.inputs, STARTS)):
        plain = family.rigid(inputs, starts=starts)
        whole = replace(plain.problem, inputs=family.inputs)
        left = Residuals(whole).of(np.array([plain.values[name] for name in whole.free]))
        fits.append((plain.values, explained(family.inputs, left)))
        if fits[-1][1] > _LITTLE:
            break
    return max(fits, key=lambda fit: fit[1])


def followed(reached: Reached, inputs: Sequence[ModelInputs]) -> float:
    """Part of the variance of the torque that parameters alone follow, latents left out."""
    post, point = reached
    left = [post.observed.plain_residual(point.z, r, i) for i, r in enumerate(inputs)]
    return explained(inputs, left)


def unless_worse(found: Reached, before: Reached, inputs: Sequence[ModelInputs]) -> Reached:
    """What was found, unless parameters alone follow less of these recordings than before."""
    return before if followed(found, inputs) < followed(before, inputs) - LESS else found


def explained(inputs: Sequence[ModelInputs], residuals: Sequence[FloatArray]) -> float:
    """Part of the variance of the torque of recordings that is not in their residuals.

    Samples count as their weights say; −∞ of residuals that are not finite.
    """
    left = whole = 0.0
    for recording, e in zip(inputs, residuals, strict=True):
        w = recording.weights
        torque = measured(recording)
        left += float(w @ e**2)
        whole += float(w @ (torque - np.average(torque, weights=w)) ** 2)
    return 1.0 - left / max(whole, 1e-300) if np.isfinite(left) else -np.inf
