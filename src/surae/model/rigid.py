"""Model 1.0, muscles on rigid tendons: torque and exact sensitivities in one pass (1) to (17)."""

import numpy as np

from surae.model.activation import filter_step
from surae.model.contraction import (
    force_length,
    force_length_partials,
    force_velocity,
    force_velocity_partials,
)
from surae.model.jit import jit
from surae.model.passive import elastic_force, relaxation_step
from surae.units import FloatArray

# Positions in the parameter vector, equal in all models.
M, K, X0, TAU, K_REL, G, L0, F0, BETA = 0, 1, 3, 5, 6, 7, 11, 13, 14
N_MUSCLE = 15


@jit
def active_state(
    emg: FloatArray, weights: FloatArray, f0: float, beta: float, dt: float
) -> FloatArray:
    """Active states of both muscle groups, equations (12) to (14), from rest.

    Parameters
    ----------
    emg : ndarray, shape (n, 4)
        EMG envelopes TA, GL, SOL, GM [V].
    weights : ndarray, shape (4,)
        g1 … g4 [N/V].
    f0, beta : float
        Cut-off [Hz] and relative damping of the filter.
    dt : float
        Sample time [s].

    Returns
    -------
    ndarray, shape (2, n)
        α of triceps surae and tibialis anterior [N].
    """
    s = filter_step(f0, beta, dt)[0]
    n = emg.shape[0]
    alpha = np.empty((2, n))
    for muscle in range(2):
        a = b = 0.0
        before = 0.0
        for i in range(n):
            if muscle == 0:
                now = weights[1] * emg[i, 1] + weights[2] * emg[i, 2] + weights[3] * emg[i, 3]
            else:
                now = weights[0] * emg[i, 0]
            if i > 0:
                a, b = (
                    s[0, 0] * a + s[0, 1] * b + s[0, 2] * before + s[0, 3] * now,
                    s[1, 0] * a + s[1, 1] * b + s[1, 2] * before + s[1, 3] * now,
                )
            alpha[muscle, i] = a
            before = now
    return alpha


@jit
def rigid_forces(
    p: FloatArray, lengths: FloatArray, speeds: FloatArray, alpha: FloatArray, factor: float,
    dt: float,
) -> FloatArray:  # fmt: skip
    """Elastic and active force of both muscle groups, equations (8) to (11) and (15) to (17).

    Parameters
    ----------
    p : ndarray, shape (15,)
        Parameters in the order of the thesis.
    lengths, speeds : ndarray, shape (2, n)
        Muscle lengths [m] and lengthening speeds [m/s], triceps first.
    alpha : ndarray, shape (2, n)
        Active states [N].
    factor : float
        vmax in optimal lengths per second.
    dt : float
        Sample time [s].

    Returns
    -------
    ndarray, shape (2, 2, n)
        Forces [N]: muscle group, then elastic and active.
    """
    n = lengths.shape[1]
    forces = np.empty((2, 2, n))
    step = relaxation_step(p[TAU], p[K_REL], dt)
    a, b0, b1 = step[0], step[1], step[2]
    dc = p[K_REL] / (1.0 + p[K_REL])
    for muscle in range(2):
        k, x0, l0 = p[K + muscle], p[X0 + muscle], p[L0 + muscle]
        vmax = factor * l0
        before = elastic_force(lengths[muscle, 0], k, x0)
        z = dc * before  # the trial starts relaxed to its first sample
        for i in range(n):
            x = lengths[muscle, i]
            elastic = elastic_force(x, k, x0)
            if i > 0:
                z = a * z + b0 * before + b1 * elastic
            before = elastic
            forces[muscle, 0, i] = max(elastic - z, 0.0)
            forces[muscle, 1, i] = (
                alpha[muscle, i] * force_length(x, l0) * force_velocity(speeds[muscle, i], vmax)
            )
    return forces


@jit
def rigid_torque(
    p: FloatArray, limb: FloatArray, arms: FloatArray, lengths: FloatArray, speeds: FloatArray,
    emg: FloatArray, factor: float, dt: float,
) -> FloatArray:  # fmt: skip
    """Reaction torque of model 1.0, equation (1), with (2) to (17).

    Parameters
    ----------
    p : ndarray, shape (15,)
        Parameters in the order of the thesis.
    limb : ndarray, shape (n,)
        Inertial and gravitational torque of 1 kg [Nm/kg].
    arms, lengths, speeds : ndarray, shape (2, n)
        Signed moment arms [m], muscle lengths [m] and speeds [m/s], triceps first.
    emg : ndarray, shape (n, 4)
        EMG envelopes TA, GL, SOL, GM [V].
    factor : float
        vmax in optimal lengths per second.
    dt : float
        Sample time [s].

    Returns
    -------
    ndarray, shape (n,)
        Torque [Nm].
    """
    alpha = active_state(emg, p[G : G + 4], p[F0], p[BETA], dt)
    forces = rigid_forces(p, lengths, speeds, alpha, factor, dt)
    torque: FloatArray = p[M] * limb
    for muscle in range(2):
        for i in range(limb.shape[0]):
            torque[i] += arms[muscle, i] * (forces[muscle, 0, i] + forces[muscle, 1, i])
    return torque


@jit
def rigid_torque_jacobian(
    p: FloatArray, limb: FloatArray, arms: FloatArray, lengths: FloatArray, speeds: FloatArray,
    emg: FloatArray, factor: float, dt: float,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Torque of model 1.0 and its derivatives by all fifteen parameters.

    The sensitivities of the two filters obey the filters' own recursions, driven by the
    derivatives of their coefficients, so they are exact for the discrete model.

    Parameters
    ----------
    p, limb, arms, lengths, speeds, emg, factor, dt
        As in `rigid_torque`.

    Returns
    -------
    torque : ndarray, shape (n,)
        Torque [Nm].
    jacobian : ndarray, shape (15, n)
        ∂T/∂p, one contiguous row a parameter.
    """
    n = limb.shape[0]
    J = np.empty((N_MUSCLE, n))
    torque = np.empty(n)

    a, b0, b1, a_t, b0_t, b1_t, a_k, b0_k, b1_k = relaxation_step(p[TAU], p[K_REL], dt)
    dc = p[K_REL] / (1.0 + p[K_REL])
    dc_k = 1.0 / (1.0 + p[K_REL]) ** 2

    s, s_f, s_b = filter_step(p[F0], p[BETA], dt)
    p00, p01, q00, q01 = s[0, 0], s[0, 1], s[0, 2], s[0, 3]
    p10, p11, q10, q11 = s[1, 0], s[1, 1], s[1, 2], s[1, 3]
    f00, f01, u00, u01 = s_f[0, 0], s_f[0, 1], s_f[0, 2], s_f[0, 3]
    f10, f11, u10, u11 = s_f[1, 0], s_f[1, 1], s_f[1, 2], s_f[1, 3]
    h00, h01, w00, w01 = s_b[0, 0], s_b[0, 1], s_b[0, 2], s_b[0, 3]
    h10, h11, w10, w11 = s_b[1, 0], s_b[1, 1], s_b[1, 2], s_b[1, 3]

    for i in range(n):
        J[M, i] = limb[i]
        torque[i] = p[M] * limb[i]

    for muscle in range(2):
        first, last = (1, 4) if muscle == 0 else (0, 1)  # EMG channels of this group
        k, x0, l0 = p[K + muscle], p[X0 + muscle], p[L0 + muscle]
        vmax = factor * l0
        # relaxation and its sensitivities by k, tau_rel, k_rel; by x0 all is −k times itself
        x = lengths[muscle, 0]
        before = elastic_force(x, k, x0)
        before_k = (x - x0) * before
        z, z_k, z_t, z_r = dc * before, dc * before_k, 0.0, dc_k * before
        # filtered EMG channels (g's derivatives), and the group's sensitivities by f0 and beta
        y = np.zeros((4, 2))
        e_before = np.zeros(4)
        total_before = 0.0
        vf0 = vf1 = vb0 = vb1 = v0 = v1 = 0.0
        for i in range(n):
            x, arm = lengths[muscle, i], arms[muscle, i]
            elastic = elastic_force(x, k, x0)
            elastic_k = (x - x0) * elastic
            total = 0.0
            for c in range(first, last):
                total += p[G + c] * emg[i, c]
            if i > 0:
                z_t = a * z_t + a_t * z + b0_t * before + b1_t * elastic
                z_r = a * z_r + a_k * z + b0_k * before + b1_k * elastic
                z_k = a * z_k + b0 * before_k + b1 * elastic_k
                z = a * z + b0 * before + b1 * elastic
                vf0, vf1 = (
                    p00 * vf0 + p01 * vf1 + f00 * v0 + f01 * v1 + u00 * total_before + u01 * total,
                    p10 * vf0 + p11 * vf1 + f10 * v0 + f11 * v1 + u10 * total_before + u11 * total,
                )
                vb0, vb1 = (
                    p00 * vb0 + p01 * vb1 + h00 * v0 + h01 * v1 + w00 * total_before + w01 * total,
                    p10 * vb0 + p11 * vb1 + h10 * v0 + h11 * v1 + w10 * total_before + w11 * total,
                )
                v0, v1 = 0.0, 0.0
                for c in range(first, last):
                    y0, y1 = y[c, 0], y[c, 1]
                    y[c, 0] = p00 * y0 + p01 * y1 + q00 * e_before[c] + q01 * emg[i, c]
                    y[c, 1] = p10 * y0 + p11 * y1 + q10 * e_before[c] + q11 * emg[i, c]
                    v0 += p[G + c] * y[c, 0]
                    v1 += p[G + c] * y[c, 1]
            before, before_k, total_before = elastic, elastic_k, total
            for c in range(first, last):
                e_before[c] = emg[i, c]

            force = elastic - z
            if force <= 0.0:  # equation (11): tissue cannot push
                force = 0.0
                J[K + muscle, i] = J[X0 + muscle, i] = relaxed_t = relaxed_r = 0.0
            else:  # also where the exponential overflowed: the torque is not a number then
                J[K + muscle, i] = arm * (elastic_k - z_k)
                J[X0 + muscle, i] = -arm * k * force
                relaxed_t, relaxed_r = -arm * z_t, -arm * z_r
            fl, _, fl_l0 = force_length_partials(x, l0)
            fv, _, fv_vmax = force_velocity_partials(speeds[muscle, i], vmax)
            gain = arm * fl * fv
            torque[i] += arm * force + gain * v0
            if muscle == 0:
                J[TAU, i], J[K_REL, i] = relaxed_t, relaxed_r
                J[F0, i], J[BETA, i] = gain * vf0, gain * vb0
            else:
                J[TAU, i] += relaxed_t
                J[K_REL, i] += relaxed_r
                J[F0, i] += gain * vf0
                J[BETA, i] += gain * vb0
            for c in range(first, last):
                J[G + c, i] = gain * y[c, 0]
            J[L0 + muscle, i] = arm * v0 * (fl_l0 * fv + fl * fv_vmax * factor)
    return torque, J
