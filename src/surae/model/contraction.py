"""Contraction: force-length (16) and force-velocity (17), with their partial derivatives."""

import math

import numpy as np

from surae.model.jit import jit
from surae.units import FloatArray

#: cf, width of the force-length curve, equation (16).
CF = 0.1
#: mvsh, mvshl and fecc: shape of the force-velocity curve, equation (17) (Thelen 2003).
MVSH = 0.25
MVSHL = 0.5
FECC = 1.5
#: (16) and (17) as what `surae.model.equilibrium` calls a muscle's curves.
CURVES = (0.0, 0.0, MVSH, FECC - 1.0)


@jit
def force_length(x: float, l0: float) -> float:
    """Force-length factor, equation (16): f_l = exp(−(x − l0)²/(cf·l0²)).

    Parameters
    ----------
    x : float
        Muscle length [m].
    l0 : float
        Optimal length [m].

    Returns
    -------
    float
        Factor in (0, 1], 1 at the optimal length.
    """
    u = (x - l0) / l0
    return math.exp(-u * u / CF)


@jit
def force_length_partials(x: float, l0: float) -> tuple[float, float, float]:
    """Force-length factor (16) with its derivatives by x and l0 [1/m].

    Returns
    -------
    tuple of float
        f_l, ∂f_l/∂x, ∂f_l/∂l0.
    """
    u = (x - l0) / l0
    f = math.exp(-u * u / CF)
    d_x = -2.0 * u / (CF * l0) * f
    return f, d_x, -d_x * x / l0


@jit
def force_velocity(speed: float, vmax: float) -> float:
    """Force-velocity factor, equation (17), with the plus sign in the eccentric branch.

    Parameters
    ----------
    speed : float
        Lengthening speed x' [m/s]; negative when the muscle shortens.
    vmax : float
        Maximum shortening speed [m/s].

    Returns
    -------
    float
        Factor: 0 at −vmax, 1 at rest, fecc = 1.5 at +vmax.
    """
    if speed < 0.0:
        return (speed + vmax) / (vmax - speed / MVSH)
    a = MVSH * MVSHL
    return 1.0 + (1.0 + a) * (FECC - 1.0) * speed / (a * vmax + speed)


@jit
def force_velocity_partials(speed: float, vmax: float) -> tuple[float, float, float]:
    """Force-velocity factor (17) with its derivatives by speed and vmax [s/m].

    It depends on speed/vmax alone, so ∂f/∂vmax = −(speed/vmax)·∂f/∂speed.

    Returns
    -------
    tuple of float
        f_v, ∂f_v/∂speed, ∂f_v/∂vmax.
    """
    if speed < 0.0:
        below = vmax - speed / MVSH
        f = (speed + vmax) / below
        d_speed = (1.0 + f / MVSH) / below
    else:
        a = MVSH * MVSHL
        below = a * vmax + speed
        slope = (1.0 + a) * (FECC - 1.0)
        f = 1.0 + slope * speed / below
        d_speed = slope * a * vmax / (below * below)
    return f, d_speed, -speed / vmax * d_speed


@jit
def contraction(length: FloatArray, speed: FloatArray, l0: float, factor: float) -> FloatArray:
    """Factor f_l·f_v of equations (15) to (17), with its derivatives by length and speed.

    Parameters
    ----------
    length, speed : ndarray, shape (n,)
        Muscle length [m] and lengthening speed [m/s].
    l0 : float
        Optimal length [m].
    factor : float
        vmax in optimal lengths per second.

    Returns
    -------
    ndarray, shape (3, n)
        f_l·f_v, its derivatives by length [1/m] and by speed [s/m].
    """
    out = np.empty((3, len(length)))
    for i in range(len(length)):
        fl, fl_x, _ = force_length_partials(length[i], l0)
        fv, fv_v, _ = force_velocity_partials(speed[i], factor * l0)
        out[0, i], out[1, i], out[2, i] = fl * fv, fl_x * fv, fl * fv_v
    return out


@jit
def shaped_force_length_partials(
    x: float, l0: float, short: float, long: float
) -> tuple[float, float, float, float]:
    """Force-length factor (16) with a width of its own on either side of l0.

    f_l = exp(−u²/cf'), u = (x − l0)/l0, cf' = cf·exp(2·w): w is `short` where x < l0, else `long`.

    Parameters
    ----------
    x, l0 : float
        Muscle length and optimal length [m].
    short, long : float
        Logarithms of the widths over that of (16) [-]; at 0 it is (16) itself.

    Returns
    -------
    tuple of float
        f_l, ∂f_l/∂x, ∂f_l/∂l0 [1/m] and ∂f_l/∂w.
    """
    u = (x - l0) / l0
    width = CF * math.exp(2.0 * (short if u < 0.0 else long))
    f = math.exp(-u * u / width)
    d_x = -2.0 * u / (width * l0) * f
    return f, d_x, -d_x * x / l0, 2.0 * u * u / width * f


@jit
def shaped_force_velocity_partials(
    speed: float, vmax: float, bend: float, gain: float
) -> tuple[float, float, float, float]:
    """Force-velocity factor (17) with another bend and another force in stretch.

    Parameters
    ----------
    speed, vmax : float
        Lengthening speed and maximum shortening speed [m/s].
    bend : float
        mvsh, 0.25 in (17); mvshl stays.
    gain : float
        fecc − 1, 0.5 in (17).

    Returns
    -------
    tuple of float
        f_v, ∂f_v/∂speed [s/m], ∂f_v/∂ln mvsh, ∂f_v/∂ln(fecc − 1); that by vmax follows from the
        second, since f_v depends on speed/vmax alone.
    """
    if speed < 0.0:
        below = vmax - speed / bend
        f = (speed + vmax) / below
        return f, (1.0 + f / bend) / below, -f * speed / (bend * below), 0.0
    a = bend * MVSHL
    below = a * vmax + speed
    slope = (1.0 + a) * gain
    above = slope * speed / below
    by_a = gain * speed * (speed - vmax) / (below * below)
    return 1.0 + above, slope * a * vmax / (below * below), by_a * a, above
