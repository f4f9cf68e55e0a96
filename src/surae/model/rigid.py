"""One muscle group on a rigid tendon: passive tissue and gain times active state, (2) to (17).

Its torque is r·F_elas + gain·α with the gain r·f_l·f_v. The sensitivities of the relaxation obey
its own recursion, driven by the derivatives of its coefficients, so they are exact for the discrete
model.
"""

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.contraction import CF, FECC, MVSH, force_velocity
from surae.model.jit import jit
from surae.model.passive import relaxation_step

#: A group's own parameters: stiffness, slack length, optimal length, relaxation.
K = 0
X0 = 1
L0 = 2
TAU = 3
K_REL = 4


def exponentials(p: FloatArray, length: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Elastic force before relaxation (8) [N] and force-length factor (16), by array: the fastest.

    Parameters
    ----------
    p : ndarray, shape (5,)
        The group's parameters: k [1/m], x0, l0 [m], tau_rel [s], k_rel.
    length : ndarray, shape (n,)
        Length of the muscle [m].

    Returns
    -------
    elastic, fl : ndarray, shape (n,)
        What `elastic_force` and `force_length` give.
    """
    k = p[K]
    x0 = p[X0]
    l0 = p[L0]
    with np.errstate(over="ignore"):  # the torque is then not finite, which is told
        elastic: FloatArray = np.exp(k * (length - x0))
        fl: FloatArray = np.exp(((length - l0) / l0) ** 2 / -CF)
    return elastic, fl


@jit
def rigid_forces(
    p: FloatArray,
    elastic: FloatArray,
    fl: FloatArray,
    speed: FloatArray,
    alpha: FloatArray,
    factor: float,
    dt: float,
) -> FloatArray:
    """Elastic and active force, equations (8) to (11) and (15) to (17).

    Parameters
    ----------
    p : ndarray, shape (5,)
        The group's parameters, as in `exponentials`.
    elastic, fl : ndarray, shape (n,)
        From `exponentials`.
    speed : ndarray, shape (n,)
        Lengthening speed [m/s].
    alpha : ndarray, shape (n,)
        Active state [N].
    factor : float
        vmax in optimal lengths per second.
    dt : float
        Sample time [s].

    Returns
    -------
    ndarray, shape (2, n)
        Elastic and active force [N].
    """
    n = len(speed)
    forces = np.empty((2, n))
    step = relaxation_step(p[TAU], p[K_REL], dt)
    a = step[0]
    b0 = step[1]
    b1 = step[2]
    vmax = factor * p[L0]
    z = p[K_REL] / (1.0 + p[K_REL]) * elastic[0]  # the trial starts relaxed to its first sample
    for i in range(n):
        if i > 0:
            z = a * z + b0 * elastic[i - 1] + b1 * elastic[i]
        forces[0, i] = max(elastic[i] - z, 0.0)
        forces[1, i] = alpha[i] * fl[i] * force_velocity(speed[i], vmax, MVSH, FECC - 1.0)[0]
    return forces


@jit
def rigid_torque(
    p: FloatArray,
    slots: IntArray,
    path: FloatArray,
    path_slopes: FloatArray,
    turned: IntArray,
    elastic: FloatArray,
    fl: FloatArray,
    alpha: FloatArray,
    alpha_slopes: FloatArray,
    alpha_slots: IntArray,
    factor: float,
    dt: float,
    torque: FloatArray,
    jacobian: FloatArray,
) -> None:
    """Add the group's torque, equation (2), and its derivatives.

    Parameters
    ----------
    p, elastic, fl, alpha, factor, dt
        As in `rigid_forces`.
    slots : ndarray of int, shape (5,)
        Row of the jacobian that belongs to each parameter.
    path : ndarray, shape (3, n)
        Signed moment arm [m], length [m] and lengthening speed [m/s].
    path_slopes, turned : ndarray, shape (3, s, n) and (s,)
        Derivatives of the path by what turns it, and the rows of the jacobian they go to.
    alpha_slopes, alpha_slots : ndarray, shape (q, n) and (q,)
        Derivatives of the active state, and the rows of the jacobian they go to.
    torque : ndarray, shape (n,)
        Is added to [Nm].
    jacobian : ndarray, shape (rows, n)
        Is added to, one contiguous row a parameter.
    """
    arm = path[0]
    length = path[1]
    speed = path[2]
    arm_by = path_slopes[0]
    length_by = path_slopes[1]
    speed_by = path_slopes[2]
    n = len(length)
    gains = np.empty(n)  # torque per active state [m]
    a, b0, b1, a_t, b0_t, b1_t, a_k, b0_k, b1_k = relaxation_step(p[TAU], p[K_REL], dt)
    dc = p[K_REL] / (1.0 + p[K_REL])
    dc_k = 1.0 / (1.0 + p[K_REL]) ** 2
    k = p[K]
    x0 = p[X0]
    l0 = p[L0]
    vmax = factor * l0
    bend = 2.0 / (CF * l0**3)
    by_k = jacobian[slots[K]]
    by_x0 = jacobian[slots[X0]]
    by_l0 = jacobian[slots[L0]]
    by_tau = jacobian[slots[TAU]]
    by_rel = jacobian[slots[K_REL]]
    # relaxation and its sensitivities by k, tau_rel, k_rel; by x0 all is −k times itself
    before = elastic[0]
    before_k = (length[0] - x0) * before
    z = dc * before
    z_k = dc * before_k
    z_t = 0.0
    z_r = dc_k * before
    before_s = k * before * length_by[:, 0]
    z_s = dc * before_s
    for i in range(n):
        x = length[i]
        r = arm[i]
        now = elastic[i]
        now_k = (x - x0) * now
        if i > 0:
            z_t = a * z_t + (a_t * z + (b0_t * before + b1_t * now))
            z_r = a * z_r + (a_k * z + (b0_k * before + b1_k * now))
            z_k = a * z_k + (b0 * before_k + b1 * now_k)
            z = a * z + (b0 * before + b1 * now)
        before = now
        before_k = now_k
        force = now - z
        if force <= 0.0:  # equation (11): tissue cannot push
            force = 0.0
        else:  # also where the exponential overflowed: the torque is not a number then
            by_k[i] += r * (now_k - z_k)
            by_x0[i] -= r * k * force
            by_tau[i] -= r * z_t
            by_rel[i] -= r * z_r
        fv, fv_v, _, _ = force_velocity(speed[i], vmax, MVSH, FECC - 1.0)
        gain = r * fl[i] * fv
        gains[i] = gain
        torque[i] += r * force + gain * alpha[i]
        fv_vmax = -speed[i] / vmax * fv_v
        by_l0[i] += alpha[i] * (gain * (x - l0) * x * bend + r * fl[i] * fv_vmax * factor)
        for j in range(len(turned)):
            now_s = k * now * length_by[j, i]
            if i > 0:
                z_s[j] = a * z_s[j] + (b0 * before_s[j] + b1 * now_s)
            before_s[j] = now_s
            bent = fv * (l0 - x) * l0 * bend
            force_s = alpha[i] * fl[i] * (bent * length_by[j, i] + fv_v * speed_by[j, i])
            if force > 0.0:
                force_s += now_s - z_s[j]
            pulled = alpha[i] * fl[i] * fv + force
            jacobian[turned[j], i] += arm_by[j, i] * pulled + r * force_s
    for j in range(len(alpha_slots)):
        row = jacobian[alpha_slots[j]]
        for i in range(n):
            row[i] += gains[i] * alpha_slopes[j, i]
