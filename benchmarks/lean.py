"""The plain fit once more, as leanly as a stranger to this package writes it.

What no parameter changes is computed once, parameters are searched in parts of their start, and
the search ends by SciPy's own tolerances: no bounds but positive values, no covariance.
"""

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.signal import lfilter

from surae.base.units import FloatArray
from surae.inference import FitProblem


def fit(problem: FitProblem) -> OptimizeResult:
    """Fit from the default start; `x` are the parameters in parts of it."""
    (inputs,) = problem.inputs
    dt, e, start = 1.0 / inputs.rate_hz, inputs.emg, problem.start
    r_tri, r_tib = 0.0480 - 0.0104 * inputs.angle, 0.0393 + 0.0171 * inputs.angle
    x_tri, x_tib = 0.118 - 1.67 * r_tri, 0.136 - 1.56 * r_tib
    v_tri, v_tib = 1.67 * 0.0104 * inputs.velocity, -1.56 * 0.0171 * inputs.velocity
    limb = 0.15**2 * inputs.acceleration + 9.81 * 0.15 * np.cos(inputs.angle)

    def force(x, v, alpha, k, x0, l0, tau, k_rel):  # type: ignore[no-untyped-def]
        elastic = np.exp(k * (x - x0))
        c = dt * k_rel / (2 * tau + dt * (1 + k_rel))
        pole = (2 * tau - dt * (1 + k_rel)) / (2 * tau + dt * (1 + k_rel))
        relaxed = k_rel / (1 + k_rel) * elastic[0] - c * elastic[0]
        passive = np.maximum(elastic - lfilter([c, c], [1, -pole], elastic, zi=[relaxed])[0], 0)
        vmax = 8 * l0
        shortening = (v + vmax) / (vmax - 4 * v)
        lengthening = 1 + 0.5625 * v / (0.125 * vmax + np.abs(v))
        return passive + alpha * np.exp(-10 * (x / l0 - 1) ** 2) * np.where(
            v < 0, shortening, lengthening
        )

    def residual(q: FloatArray) -> FloatArray:
        m, k_tri, k_tib, x0_tri, x0_tib, tau, k_rel, g1, g2, g3, g4, l0_tri, l0_tib, f0, beta = (
            q * start
        )
        w = 2 * np.pi * f0 * dt
        b = np.array([1.0, 2.0, 1.0]) * w * w / (4 + 4 * beta * w + w * w)
        a = np.array([4 + 4 * beta * w + w * w, 2 * w * w - 8, 4 - 4 * beta * w + w * w])
        a_tri, a_tib = lfilter(b, a / a[0], np.stack([e[:, 1:] @ [g2, g3, g4], g1 * e[:, 0]]))
        t_tri = r_tri * force(x_tri, v_tri, a_tri, k_tri, x0_tri, l0_tri, tau, k_rel)
        t_tib = r_tib * force(x_tib, v_tib, a_tib, k_tib, x0_tib, l0_tib, tau, k_rel)
        torque: FloatArray = m * limb + t_tri - t_tib - inputs.torque
        return torque

    return least_squares(residual, np.ones(len(start)), bounds=(1e-3, np.inf))
