"""The same fit as a competent script would do it: NumPy and lfilter, finite differences, SciPy.

This is what surae is measured against: vectorised, filters by the bilinear transform, the torque
as one function of the parameter vector, `scipy.optimize.least_squares` for the rest.
"""

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.signal import bilinear, lfilter, lfiltic

from surae.base.units import FloatArray
from surae.inference import FitProblem
from surae.signals import ModelInputs


def torque(p: FloatArray, inputs: ModelInputs) -> FloatArray:
    """Torque of model 1.0 [Nm], shape (n,)."""
    m, k_tri, k_tib, x0_tri, x0_tib, tau, k_rel, g1, g2, g3, g4, l0_tri, l0_tib, f0, beta = p
    angle, rate = inputs.angle, inputs.rate_hz
    r_tri, r_tib = 0.0480 - 0.0104 * angle, 0.0393 + 0.0171 * angle
    speed_tri, speed_tib = 1.67 * 0.0104 * inputs.velocity, -1.56 * 0.0171 * inputs.velocity
    w0 = 2 * np.pi * f0
    b, a = bilinear([w0**2], [1, 2 * beta * w0, w0**2], rate)
    e = inputs.emg
    alpha_tri = lfilter(b, a, g2 * e[:, 1] + g3 * e[:, 2] + g4 * e[:, 3])
    alpha_tib = lfilter(b, a, g1 * e[:, 0])
    t_tri = r_tri * _force(
        0.118 - 1.67 * r_tri, speed_tri, alpha_tri, k_tri, x0_tri, l0_tri, tau, k_rel, rate
    )
    t_tib = r_tib * _force(
        0.136 - 1.56 * r_tib, speed_tib, alpha_tib, k_tib, x0_tib, l0_tib, tau, k_rel, rate
    )
    limb = m * (0.15**2 * inputs.acceleration + 9.81 * 0.15 * np.cos(angle))
    return np.asarray(limb + t_tri - t_tib, dtype=np.float64)


def _force(x, speed, alpha, k, x0, l0, tau, k_rel, rate):  # type: ignore[no-untyped-def]
    elastic = np.exp(k * (x - x0))
    b, a = bilinear([tau, 1], [tau, 1 + k_rel], rate)
    steady = elastic[0] / (1 + k_rel)
    start = lfiltic(b, a, y=[steady], x=[elastic[0]])
    elastic = np.maximum(lfilter(b, a, elastic, zi=start)[0], 0)
    vmax = 8 * l0
    a_ecc = 0.25 * 0.5
    shortening = (speed + vmax) / (vmax - speed / 0.25)
    lengthening = 1 + (1 + a_ecc) * 0.5 * speed / (a_ecc * vmax + np.abs(speed))
    fv = np.where(speed < 0, shortening, lengthening)
    return elastic + alpha * np.exp(-((x - l0) ** 2) / (0.1 * l0**2)) * fv


def fit(problem: FitProblem) -> tuple[OptimizeResult, FloatArray]:
    """Fit from the default start; the result and the covariance of the parameters."""
    (inputs,) = problem.inputs
    minimum = least_squares(
        lambda p: torque(p, inputs) - inputs.torque,
        problem.start,
        bounds=(problem.lower, problem.upper),
        x_scale="jac",
    )
    n, k = minimum.jac.shape
    covariance = 2 * minimum.cost / (n - k) * np.linalg.inv(minimum.jac.T @ minimum.jac)
    return minimum, np.asarray(covariance)
