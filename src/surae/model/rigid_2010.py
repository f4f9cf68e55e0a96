"""The muscle model of 2010: torque and exact sensitivities in one pass.

A reconstruction; `surae.model.muscle_2010` gives its equations and where they come from.
"""

import numpy as np

from surae.model.activation import filter_step
from surae.model.contraction import force_length, force_velocity
from surae.model.jit import jit
from surae.model.passive import elastic_force
from surae.units import FloatArray

# Positions in the parameter vector.
M, K, X0, E, F, B, F0 = 0, 1, 2, 3, 7, 8, 9
N_2010 = 10


@jit
def contraction_gain(
    arm: FloatArray, length: FloatArray, speed: FloatArray, l0: float, factor: float
) -> FloatArray:
    """Active torque per active state, r·f_l·f_v of equations (2), (15) to (17).

    No parameter of this model touches it: l0 is a length of the geometry.

    Parameters
    ----------
    arm, length, speed : ndarray, shape (n,)
        Signed moment arm [m], muscle length [m] and lengthening speed [m/s].
    l0 : float
        Optimal length [m].
    factor : float
        vmax in optimal lengths per second.

    Returns
    -------
    ndarray, shape (n,)
        Gain [m].
    """
    gain = np.empty(len(arm))
    for i in range(len(arm)):
        contraction = force_length(length[i], l0) * force_velocity(speed[i], factor * l0)
        gain[i] = arm[i] * contraction
    return gain


@jit
def torque_2010(
    p: FloatArray, limb: FloatArray, arm: FloatArray, length: FloatArray, speed: FloatArray,
    iemg: FloatArray, gains: FloatArray, dt: float,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Torque of the model of 2010 and its derivatives by all ten parameters.

    Parameters
    ----------
    p : ndarray, shape (10,)
        Parameters in the order of the thesis.
    limb : ndarray, shape (n,)
        Inertial and gravitational torque of 1 kg [Nm/kg].
    arm, length, speed : ndarray, shape (n,)
        Moment arm [m], length [m] and lengthening speed [m/s] of the triceps.
    iemg : ndarray, shape (4, n)
        Integrated EMG of TA, GL, SOL, GM [V].
    gains : ndarray, shape (4, n)
        Active torque per active state of each of them [m].
    dt : float
        Sample time [s].

    Returns
    -------
    torque : ndarray, shape (n,)
        Torque [Nm].
    jacobian : ndarray, shape (10, n)
        ∂T/∂p, one contiguous row a parameter.
    """
    n = len(limb)
    torque = np.empty(n)
    J = np.empty((N_2010, n))
    for i in range(n):
        elastic = arm[i] * elastic_force(length[i], p[K], p[X0])
        J[M, i] = limb[i]
        J[K, i] = (length[i] - p[X0]) * elastic
        J[X0, i] = -p[K] * elastic
        J[F, i] = 0.0
        J[B, i] = arm[i] * speed[i]
        J[F0, i] = arm[i]
        torque[i] = p[M] * J[M, i] + elastic + p[B] * J[B, i] + p[F0] * J[F0, i]

    s, s_f, _ = filter_step(p[F], 1.0, dt)  # critically damped
    for c in range(4):
        # the channel's active state of weight 1 with its rate, and their derivatives by f
        y0 = y1 = d0 = d1 = before = 0.0
        for i in range(n):
            now = iemg[c, i]
            if i > 0:
                d0, d1 = (
                    s[0, 0] * d0 + s[0, 1] * d1
                    + s_f[0, 0] * y0 + s_f[0, 1] * y1 + s_f[0, 2] * before + s_f[0, 3] * now,
                    s[1, 0] * d0 + s[1, 1] * d1
                    + s_f[1, 0] * y0 + s_f[1, 1] * y1 + s_f[1, 2] * before + s_f[1, 3] * now,
                )  # fmt: skip
                y0, y1 = (
                    s[0, 0] * y0 + s[0, 1] * y1 + s[0, 2] * before + s[0, 3] * now,
                    s[1, 0] * y0 + s[1, 1] * y1 + s[1, 2] * before + s[1, 3] * now,
                )
            before = now
            J[E + c, i] = gains[c, i] * y0
            J[F, i] += p[E + c] * gains[c, i] * d0
            torque[i] += p[E + c] * J[E + c, i]
    return torque, J
