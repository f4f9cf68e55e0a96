"""Tendon: force against elongation, equations (18) to (21), with its derivatives."""

import math

from surae.model.jit import jit

TendonCurve = tuple[float, float, float, float, float]
TendonShape = tuple[float, float, float, float, float, float, float, float]


@jit
def tendon_curve(eps0: float, toe: float, k_toe: float, f_max: float) -> TendonCurve:
    """What the force needs of the parameters, computed once: equations (19) to (21).

    Toe and linear part join with one slope, and the curve passes through (ε0, Fmax).

    Parameters
    ----------
    eps0 : float
        ε0, elongation at the force Fmax [m].
    toe : float
        F̄toe, fraction of Fmax at which the linear part begins [-].
    k_toe : float
        ktoe, shape of the exponential toe [-].
    f_max : float
        Fmax [N].

    Returns
    -------
    tuple of float
        e_toe [m]; ktoe/e_toe [1/m]; Ftoe/(exp(ktoe) − 1) [N]; k_lin [N/m]; force of the linear
        part carried on to e = 0 [N].
    """
    grown = math.exp(k_toe)
    above = math.expm1(k_toe)
    e_toe = eps0 * toe * k_toe * grown / ((1.0 - toe) * above + toe * k_toe * grown)
    k_lin = f_max / eps0 * (1.0 - toe + toe * k_toe * grown / above)
    return e_toe, k_toe / e_toe, toe * f_max / above, k_lin, f_max - k_lin * eps0


@jit
def tendon_force(e: float, curve: TendonCurve) -> tuple[float, float]:
    """Tendon force, equation (18), and its slope; a slack tendon (e < 0) has neither.

    Parameters
    ----------
    e : float
        Elongation [m].
    curve : tuple
        From `tendon_curve`.

    Returns
    -------
    tuple of float
        F_t [N], ∂F_t/∂e [N/m] (at e = 0 the slope of the taut side).
    """
    e_toe, bend, scale, k_lin, offset = curve
    if e < 0.0:
        return 0.0, 0.0
    if e <= e_toe:
        grown = scale * math.exp(bend * e)
        return grown - scale, bend * grown
    return offset + k_lin * e, k_lin


@jit
def tendon_shape(eps0: float, toe: float, k_toe: float, f_max: float) -> TendonShape:
    """What the derivatives by the parameters need, computed once.

    Parameters
    ----------
    eps0, toe, k_toe, f_max : float
        As in `tendon_curve`.

    Returns
    -------
    tuple of float
        ε0, F̄toe, Fmax; ∂log(e_toe)/∂F̄toe and by ktoe; exp(ktoe)/(exp(ktoe) − 1); ∂F_t/∂F̄toe and
        by ktoe of the linear part, per ε0 − e [N/m].
    """
    grown = math.exp(k_toe)
    above = math.expm1(k_toe)
    below = (1.0 - toe) * above + toe * k_toe * grown
    ratio = grown / above
    return (
        eps0,
        toe,
        f_max,
        1.0 / toe - (k_toe * grown - above) / below,
        1.0 / k_toe + 1.0 - grown * (1.0 + toe * k_toe) / below,
        ratio,
        -f_max / eps0 * (k_toe * ratio - 1.0),
        -f_max / eps0 * toe * ratio * (1.0 - k_toe / above),
    )


@jit
def tendon_partials(
    e: float, force: float, slope: float, curve: TendonCurve, shape: TendonShape
) -> tuple[float, float, float, float]:
    """Derivatives of the tendon force (18) by its four parameters.

    Parameters
    ----------
    e : float
        Elongation [m].
    force, slope : float
        From `tendon_force` at `e`.
    curve, shape : tuple
        From `tendon_curve` and `tendon_shape`.

    Returns
    -------
    tuple of float
        ∂F_t/∂ε0 [N/m], ∂F_t/∂F̄toe [N], ∂F_t/∂ktoe [N], ∂F_t/∂Fmax [-].
    """
    e_toe, _, scale, _, _ = curve
    eps0, toe, f_max, toe_toe, toe_k, ratio, line_toe, line_k = shape
    if e < 0.0:
        return 0.0, 0.0, 0.0, 0.0
    stretched = slope * e
    if e <= e_toe:
        by_toe = force / toe - stretched * toe_toe
        by_k = (force + scale) * e / e_toe - force * ratio - stretched * toe_k
    else:
        by_toe = line_toe * (eps0 - e)
        by_k = line_k * (eps0 - e)
    return -stretched / eps0, by_toe, by_k, force / f_max
