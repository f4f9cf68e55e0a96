"""Activation dynamics: weighted EMG through a second-order filter, equations (12) to (14)."""

import math

import numpy as np

from surae.model.jit import jit
from surae.units import FloatArray

# Terms of the series of φ2, and the norm below which it is summed: 14 terms at ½ leave 1e-19.
_TERMS = 14
_SMALL = 0.5


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
    doublings = 0
    while norm > _SMALL:
        norm *= 0.5
        doublings += 1
    scale = 0.5**doublings
    Z = np.array([[0.0, h], [-h, -2.0 * beta * h]]) * scale
    D = np.zeros((2, 2, 2))  # derivatives of Z by h and by beta
    D[0] = Z / h
    D[1, 1, 1] = -2.0 * h * scale

    # Horner on φ2(Z) = Σ Z^j/(j+2)!, and on its two derivatives
    eye = np.eye(2)
    weight = 1.0
    for j in range(2, _TERMS + 2):
        weight /= j
    phi2 = eye * weight
    d2 = np.zeros((2, 2, 2))
    for j in range(_TERMS, 1, -1):
        weight *= j + 1
        for i in range(2):
            d2[i] = d2[i] @ Z + phi2 @ D[i]
        phi2 = phi2 @ Z + eye * weight
    d1 = np.zeros((2, 2, 2))
    phi1 = eye + Z @ phi2
    for i in range(2):
        d1[i] = D[i] @ phi2 + Z @ d2[i]
    for _ in range(doublings):
        # at 2Z: φ2 ← (φ1² + 2φ2)/4, then φ1 ← I + 2Z·φ2
        for i in range(2):
            d2[i] = 0.25 * (d1[i] @ phi1 + phi1 @ d1[i] + 2.0 * d2[i])
        phi2 = 0.25 * (phi1 @ phi1 + 2.0 * phi2)
        Z = 2.0 * Z
        D = 2.0 * D
        for i in range(2):
            d1[i] = D[i] @ phi2 + Z @ d2[i]
        phi1 = eye + Z @ phi2

    step = np.empty((2, 4))
    steps = np.empty((2, 2, 4))
    step[:, :2] = eye + Z @ phi1
    step[:, 2] = h * (phi1[:, 1] - phi2[:, 1])  # the input enters the second state with gain h
    step[:, 3] = h * phi2[:, 1]
    for i in range(2):
        steps[i, :, :2] = D[i] @ phi1 + Z @ d1[i]
        steps[i, :, 2] = h * (d1[i][:, 1] - d2[i][:, 1])
        steps[i, :, 3] = h * d2[i][:, 1]
    steps[0, :, 2] += phi1[:, 1] - phi2[:, 1]
    steps[0, :, 3] += phi2[:, 1]
    return step, steps[0] * (2.0 * math.pi * dt), steps[1]
