"""Contraction: force-length (16), force-velocity (17), bridges that hold; partial derivatives.

(16) and (17) may be shaped otherwise than they are printed: what shapes them is a logarithm, 0 as
printed, or a constant of (17).
"""

import math

import numpy as np

from surae.base.units import FloatArray
from surae.model.jit import jit

#: cf, width of the force-length curve, equation (16).
CF = 0.1
#: mvsh, mvshl and fecc: shape of the force-velocity curve, equation (17) (Thelen 2003).
MVSH = 0.25
MVSHL = 0.5
FECC = 1.5
#: (16) and (17) as what `surae.model.equilibrium` calls a muscle's curves.
CURVES = (0.0, 0.0, MVSH, FECC - 1.0)


@jit
def force_length(
    x: float, l0: float, short: float = 0.0, long: float = 0.0
) -> tuple[float, float, float, float]:
    """Force-length factor, equation (16), with a width of its own on either side of l0.

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
        f_l in (0, 1], 1 at the optimal length; ∂f_l/∂x, ∂f_l/∂l0 [1/m] and ∂f_l/∂w.
    """
    u = (x - l0) / l0
    width = CF * math.exp(2.0 * (short if u < 0.0 else long))
    f = math.exp(-u * u / width)
    d_x = -2.0 * u / (width * l0) * f
    return f, d_x, -d_x * x / l0, 2.0 * u * u / width * f


@jit
def force_velocity(
    speed: float, vmax: float, bend: float = MVSH, gain: float = FECC - 1.0
) -> tuple[float, float, float, float]:
    """Force-velocity factor, equation (17), with the plus sign in the eccentric branch.

    Parameters
    ----------
    speed : float
        Lengthening speed x' [m/s]; negative when the muscle shortens.
    vmax : float
        Maximum shortening speed [m/s].
    bend : float
        mvsh, 0.25 in (17); mvshl stays.
    gain : float
        fecc − 1, 0.5 in (17).

    Returns
    -------
    tuple of float
        f_v: 0 at −vmax, 1 at rest, fecc at +vmax; ∂f_v/∂speed [s/m], ∂f_v/∂ln mvsh and
        ∂f_v/∂ln(fecc − 1). By vmax it is −(speed/vmax)·∂f_v/∂speed, as f_v depends on speed/vmax
        alone.
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


@jit
def bridge_strain(moved: float, before: float, reach: float) -> tuple[float, float, float, float]:
    """How far bridges are strained that hold a muscle and yield, short-range stiffness.

    ds/dx = 1 − sgn(dx)·s/ρ (P. R. Dahl, 1968, TOR-158(3107-18)), exact where x goes one way:
    s = ±ρ + (ŝ ∓ ρ)·exp(−|x − x̂|/ρ). The contractile element pulls by α·f_l·K·s/l0 more than by
    (17) alone (De Groote et al. 2018, J. Biomech. 68:19-23).

    Parameters
    ----------
    moved : float
        By how much the muscle lengthened, x − x̂ [m].
    before : float
        ŝ, the strain where it was [m].
    reach : float
        ρ, the strain at which they yield [m].

    Returns
    -------
    tuple of float
        s in [−ρ, ρ] [m]; ∂s/∂x, ∂s/∂ŝ and ∂s/∂ρ [-].
    """
    end = reach if moved > 0.0 else -reach
    kept = math.exp(-abs(moved) / reach)
    left = (before - end) * kept
    way = end / reach
    return end + left, -left / end, kept, way - way * kept + left * abs(moved) / reach**2


@jit
def length_velocity_factor(
    length: FloatArray, speed: FloatArray, l0: float, factor: float
) -> FloatArray:
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
        fl, fl_x, _, _ = force_length(length[i], l0)
        fv, fv_v, _, _ = force_velocity(speed[i], factor * l0)
        out[0, i], out[1, i], out[2, i] = fl * fv, fl_x * fv, fl * fv_v
    return out
