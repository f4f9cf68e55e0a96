"""What a position in coarse steps would be, had it been recorded in such steps once more."""

from dataclasses import replace

import numpy as np

from surae.base.units import FloatArray
from surae.nerve.fitting import Fitted, Problem
from surae.nerve.samples import Samples, filled

#: Movements like the recorded one whose steps are tried: their sizes beside it, and over how many
#: steps they drift meanwhile, so that levels lie everywhere between steps.
LIKE = (0.79, 1.31, 1.67)
DRIFT = 3.7


def coarser(
    samples: Samples, highest: float, problem: Problem, fitted: Fitted
) -> list[tuple[Problem, Fitted]]:
    """Fits of the position with errors as its steps make them, added once more.

    What is estimated then differs by about as much as the first steps did (simulation and
    extrapolation: Cook and Stefanski, *J Am Stat Assoc* 89 (1994) 1314). The errors are those of
    movements like the recorded one.
    """
    fits = []
    for scale in LIKE:
        more = replace(samples, angle=samples.angle + _error(samples, scale))
        again = Problem(more.pieces(highest=highest), problem.noise)
        fits.append((again, again.fit(fitted.structure, fitted.values)))
    return fits


def _error(samples: Samples, scale: float) -> FloatArray:
    """What steps make of a movement like the recorded one [rad]."""
    angle = filled(samples.angle)
    drift = np.linspace(0.0, DRIFT * samples.step, len(angle))
    like = scale * (angle - angle.mean()) + drift
    error: FloatArray = np.round(like / samples.step) * samples.step - like
    return error
