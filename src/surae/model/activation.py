"""Activation dynamics: weighted EMG through a second-order filter, equations (12) to (14)."""

import math

import numpy as np

from surae.model.jit import jit
from surae.units import FloatArray

# Terms of the series of φ2, and the norm below which it is summed: 14 terms at ½ leave 1e-19.
_TERMS = 14
_SMALL = 0.5

# p·I + q·A with A = [[0, 1], [−1, −2β]], and the derivatives of p and q by h and by β. Every
# function of h·A has this form, because A² = −I − 2β·A.
_Element = tuple[float, float, float, float, float, float]


@jit
def _times(x: _Element, y: _Element, beta: float) -> _Element:
    """Product of two functions of A, with its derivatives."""
    p, q, p_h, q_h, p_b, q_b = x
    r, s, r_h, s_h, r_b, s_b = y
    b = 2.0 * beta
    return (
        p * r - q * s,
        p * s + q * r - b * q * s,
        p_h * r + p * r_h - q_h * s - q * s_h,
        p_h * s + p * s_h + q_h * r + q * r_h - b * (q_h * s + q * s_h),
        p_b * r + p * r_b - q_b * s - q * s_b,
        p_b * s + p * s_b + q_b * r + q * r_b - b * (q_b * s + q * s_b) - 2.0 * q * s,
    )


@jit
def _plus(x: _Element, constant: float) -> _Element:
    """Sum of x and constant·I."""
    return x[0] + constant, x[1], x[2], x[3], x[4], x[5]


@jit
def filter_step(f0: float, beta: float, dt: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """One sample of the activation filter (14), exact for an EMG linear between samples.

    α'' + 2βω0·α' + ω0²·α = ω0²·E, ω0 = 2π·f0, with the state v = (α, α'/ω0):
    v[n] = Φ·v[n−1] + Γ0·E[n−1] + Γ1·E[n]. Exact at any cut-off below the Nyquist frequency and
    at any damping, the critical one included: φ-functions by series, scaling and doubling
    (φ2(2Z) = (φ1(Z)² + 2φ2(Z))/4), never by eigenvalues.

    Parameters
    ----------
    f0 : float
        Cut-off frequency [Hz].
    beta : float
        Relative damping [-].
    dt : float
        Sample time [s].

    Returns
    -------
    step : ndarray, shape (2, 4)
        Columns Φ (two), Γ0, Γ1.
    step_f0, step_beta : ndarray, shape (2, 4)
        Its derivatives by f0 [1/Hz] and by beta.
    """
    h = 2.0 * math.pi * f0 * dt
    norm = h * (1.0 + 2.0 * abs(beta))
    scale = 1.0
    doublings = 0
    while norm > _SMALL:
        norm *= 0.5
        scale *= 0.5
        doublings += 1
    z = (0.0, scale * h, 0.0, scale, 0.0, 0.0)

    # Horner on φ2(Z) = Σ Z^j/(j+2)!
    weight = 1.0
    for j in range(2, _TERMS + 2):
        weight /= j
    phi2 = (weight, 0.0, 0.0, 0.0, 0.0, 0.0)
    for j in range(_TERMS, 1, -1):
        weight *= j + 1
        phi2 = _plus(_times(phi2, z, beta), weight)
    phi1 = _plus(_times(phi2, z, beta), 1.0)
    for _ in range(doublings):
        # at 2Z: φ2 ← (φ1² + 2φ2)/4, then φ1 ← I + 2Z·φ2
        square = _times(phi1, phi1, beta)
        phi2 = (
            0.25 * square[0] + 0.5 * phi2[0],
            0.25 * square[1] + 0.5 * phi2[1],
            0.25 * square[2] + 0.5 * phi2[2],
            0.25 * square[3] + 0.5 * phi2[3],
            0.25 * square[4] + 0.5 * phi2[4],
            0.25 * square[5] + 0.5 * phi2[5],
        )
        scale *= 2.0
        z = (0.0, scale * h, 0.0, scale, 0.0, 0.0)
        phi1 = _plus(_times(phi2, z, beta), 1.0)
    free = _plus(_times(phi1, z, beta), 1.0)

    steps = np.empty((3, 2, 4))  # the step, its derivatives by h and by beta
    for i in range(3):
        p, q = free[2 * i], free[2 * i + 1]
        steps[i, 0, 0], steps[i, 0, 1] = p, q
        steps[i, 1, 0], steps[i, 1, 1] = -q, p - 2.0 * beta * q
        # the input enters the second state with gain h: h times the second column of φ1 and φ2
        p1, q1, p2, q2 = phi1[2 * i], phi1[2 * i + 1], phi2[2 * i], phi2[2 * i + 1]
        steps[i, 0, 2], steps[i, 0, 3] = h * (q1 - q2), h * q2
        steps[i, 1, 3] = h * (p2 - 2.0 * beta * q2)
        steps[i, 1, 2] = h * (p1 - 2.0 * beta * q1) - steps[i, 1, 3]
    # what h outside the functions and β inside A add
    for column in range(2, 4):
        for row in range(2):
            steps[1, row, column] += steps[0, row, column] / h
    steps[2, 1, 1] -= 2.0 * free[1]
    steps[2, 1, 2] -= 2.0 * steps[0, 0, 2]
    steps[2, 1, 3] -= 2.0 * steps[0, 0, 3]
    return steps[0], steps[1] * (2.0 * math.pi * dt), steps[2]
