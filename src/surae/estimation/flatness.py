"""Where a posterior is flatter than the quadratic around its mode says.

Tissue goes slack at some angle, sample by sample, and the torque's surface has a kink at each. The
valley of stiffness, slack length and torque zero is so flat that the search rests on kinks: a
standard deviation away −2 ln p is often higher by 0.1 instead of 1. The quadratic, which is that of
derivatives at one point, takes the valley for narrower than it is, by a factor of two on some legs.

So the search begins again beside the mode, on either side along the least certain direction. In a
smooth valley both come back. Where one rests elsewhere, at a distance d and higher by Δ, the data
say of that way σ² = d²/Δ, and what this is more than the quadratic's is added.
"""

from dataclasses import dataclass

import numpy as np

from surae.estimation.mode import Mode, Target
from surae.units import FloatArray

#: How far beside the mode the search begins [standard deviations], and how long it goes on.
_BESIDE, _EVALUATIONS, _TOLERANCE = 1.0, 15, 0.003
#: Distance, squared and in standard deviations of the quadratic, of what has come back; least rise
#: that is told from none.
_BACK, _LEVEL = 0.05, 0.25


@dataclass(frozen=True, slots=True)
class Flatness:
    """A mode and what its valley is wider by."""

    mode: Mode
    shifts: FloatArray  #: As they are searched, shape (2, q); their products are the covariance.


def flatness(target: Target, mode: Mode, covariance: FloatArray) -> Flatness:
    """The best mode of a valley, and how much wider that is than the quadratic says.

    Parameters
    ----------
    target : Target
        What is minimised.
    mode : Mode
        Where the search has come to.
    covariance : ndarray, shape (q, q)
        Of the quadratic there.
    """
    deviations = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(deviations, deviations))
    step = _BESIDE * vectors[:, -1] * np.sqrt(values[-1]) * deviations
    ends = [
        target.descend(mode.z + sign * step, evaluations=_EVALUATIONS, tolerance=_TOLERANCE)
        for sign in (1.0, -1.0)
    ]
    best, *others = sorted((mode, *ends), key=lambda end: end.cost)
    information = np.linalg.pinv(covariance, hermitian=True)
    shifts = []
    for end in others:
        away = end.z - best.z
        expected, risen = float(away @ information @ away), end.cost - best.cost
        more = 1.0 / max(risen, _LEVEL) - 1.0 / expected if expected > _BACK else 0.0
        shifts.append(away * np.sqrt(max(more, 0.0) / len(others)))
    return Flatness(best, np.stack(shifts))
