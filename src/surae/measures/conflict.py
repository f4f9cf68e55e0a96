"""Whether rest and effort tell of one tissue: the relaxed curve against the muscles' fit."""

from collections.abc import Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference.relaxed.curve import LEFT_OUT, RelaxedCurve

#: Angles at which both are compared, so many and so far apart at least [deg]; the level.
_ANGLES = 4
_APART = 5.0
LEVEL = 0.001
#: From this angle on [deg]: a slow stretch from -30° has become one, and tissue pulls.
_FROM = -20.0


def compared_angles(curve: RelaxedCurve) -> FloatArray:
    """Angles by the device [deg] at which rest tells the curve; empty where there are too few."""
    every = np.arange(np.ceil(curve.low / _APART), np.floor(curve.high / _APART) + 1.0) * _APART
    middle = max(_FROM, 0.5 * (curve.low + curve.high))
    passed = np.array([at for at in every if at >= middle and curve.passed(float(at))])
    if len(passed) < _ANGLES:
        return np.empty(0)
    return np.asarray(passed[np.linspace(0, len(passed) - 1, _ANGLES).round().astype(int)])


def disagreement(
    curve: RelaxedCurve, angles: FloatArray, torque: Sequence[float], covariance: FloatArray
) -> float:
    """Probability of curves so far apart if both were of one tissue.

    Of the torque in a slow stretch, which least depends on how tissue relaxes, the differences
    between neighbouring angles, in which no zero of a sensor is:

        χ² = dᵀ·(C_rest + C_fit)⁻¹·d,  of as many degrees of freedom

    The fit has seen rest too, so that its errors are partly rest's and χ² is rather too small.

    Parameters
    ----------
    curve : RelaxedCurve
        By rest alone.
    angles : ndarray
        By the device [deg], shape (n,).
    torque : sequence of float
        The fit's torque in a slow stretch there [Nm], shape (n,).
    covariance : ndarray
        Of it [Nm²], shape (n, n).

    Returns
    -------
    float
        The p-value.
    """
    from scipy.special import chdtrc

    mean, known = curve.slow_torque(angles)
    fitted = np.asarray(torque)
    to = np.diff(np.eye(len(angles)), axis=0)
    apart = to @ (fitted - mean)
    rises = to @ fitted
    both = to @ (known + covariance) @ to.T + LEFT_OUT**2 * np.outer(rises, rises)
    chi2 = float(apart @ np.linalg.solve(both + 1e-12 * np.eye(len(apart)), apart))
    return float(chdtrc(len(apart), chi2))
