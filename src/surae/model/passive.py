"""Passive muscle tissue: exponential stiffness (8), relaxation (10), no push (11)."""

import math

from surae.model.jit import jit


@jit
def elastic_force(x: float, k: float, x0: float) -> float:
    """Elastic force before relaxation, equation (8): F = exp(k·(x − x0)).

    Parameters
    ----------
    x : float
        Muscle length [m].
    k : float
        Stiffness coefficient [1/m].
    x0 : float
        Slack length [m]: the length at which the force is 1 N.

    Returns
    -------
    float
        Force [N].
    """
    return math.exp(k * (x - x0))


@jit
def phi(z: float) -> tuple[float, float, float, float]:
    """φ1(z) = (e^z − 1)/z and φ2(z) = (φ1(z) − 1)/z with their derivatives, exact near zero.

    Returns
    -------
    tuple of float
        φ1, φ2, φ1', φ2' (dimensionless).
    """
    if abs(z) > 1.0:
        phi1 = math.expm1(z) / z
        phi2 = (phi1 - 1.0) / z
        d_phi1 = (math.exp(z) - phi1) / z
        return phi1, phi2, d_phi1, (d_phi1 - phi2) / z
    # The closed forms cancel here; 18 terms of the series reach rounding for |z| ≤ 1.
    phi2 = 0.0
    d_phi2 = 0.0
    term = 0.5
    for order in range(18):
        phi2 += term
        d_phi2 += (order + 1) * term / (order + 3)
        term *= z / (order + 3)
    return 1.0 + z * phi2, phi2, phi2 + z * d_phi2, d_phi2


@jit
def relaxation_step(
    tau_rel: float, k_rel: float, dt: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """One sample of the relaxation (10), exact for an elastic force linear between samples.

    Equation (10) is F_elas = F0 − z with τ·z' = −(1 + k_rel)·z + k_rel·F0, so
    z[n] = a·z[n−1] + b0·F0[n−1] + b1·F0[n].

    Parameters
    ----------
    tau_rel : float
        Relaxation time constant [s].
    k_rel : float
        Relaxation factor [-].
    dt : float
        Sample time [s].

    Returns
    -------
    tuple of float
        a, b0, b1; their derivatives by tau_rel [1/s]; their derivatives by k_rel.
    """
    h = dt * (1.0 + k_rel) / tau_rel
    gain = k_rel / (1.0 + k_rel)
    phi1, phi2, d_phi1, d_phi2 = phi(-h)
    a = math.exp(-h)
    c0 = h * (phi1 - phi2)
    c1 = h * phi2
    # by h, with φ evaluated at −h
    d_c0 = (phi1 - phi2) - h * (d_phi1 - d_phi2)
    d_c1 = phi2 - h * d_phi2
    h_tau = -h / tau_rel
    h_k = dt / tau_rel
    gain_k = 1.0 / (1.0 + k_rel) ** 2
    return (
        a,
        gain * c0,
        gain * c1,
        -a * h_tau,
        gain * d_c0 * h_tau,
        gain * d_c1 * h_tau,
        -a * h_k,
        gain * d_c0 * h_k + gain_k * c0,
        gain * d_c1 * h_k + gain_k * c1,
    )
