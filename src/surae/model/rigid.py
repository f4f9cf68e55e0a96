"""One muscle group on a rigid tendon: passive tissue and gain times active state, (2) to (17).

Its torque is r·F_elas + gain·α with the gain r·f_l·f_v. The sensitivities of the relaxation obey
its own recursion, driven by the derivatives of its coefficients, so they are exact for the discrete
model.
"""

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.contraction import CF, FECC, MVSH, force_velocity
from surae.model.jit import inner, jit
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


#: Signed moment arm [m], length [m] and lengthening speed [m/s], shape (3, n); their derivatives by
#: what turns the path, (3, s, n), and the rows of the jacobian these go to, (s,).
Path = tuple[FloatArray, FloatArray, IntArray]
#: Elastic force and force-length factor, from `exponentials`.
Curves = tuple[FloatArray, FloatArray]
#: Active state, shape (n,), its derivatives, (q, n), and rows of the jacobian they go to, (q,).
Drive = tuple[FloatArray, FloatArray, IntArray]

#: Rows of what turns the path: sensitivity of the relaxation, and the elastic force's before.
_OF_RELAXATION, _OF_ELASTIC = range(2)
#: k [1/m], l0 [m]; ∂ ln f_l/∂x over (l0 − x)·l0.
_Tissue = tuple[float, float, float]
#: Coefficients of (10), from `relaxation_step`.
_Coefficients = tuple[float, float, float]
#: Length [m], elastic force [N], what the tissue pulls with [N], α·f_l [N], f_v, ∂f_v/∂x' [s/m].
_Instant = tuple[float, float, float, float, float, float]


@inner
def _turned(
    i: int,
    path: Path,
    before: FloatArray,
    tissue: _Tissue,
    step: _Coefficients,
    now: _Instant,
    jacobian: FloatArray,
) -> None:
    """Add what turns the path, and carry what the relaxation keeps of it, (2, s)."""
    arms, slopes, turned = path
    k, l0, bend = tissue
    x, elastic, force, active, fv, fv_v = now
    a, b0, b1 = step
    r = arms[0, i]
    for j in range(len(turned)):
        length_by = slopes[1, j, i]
        now_s = k * elastic * length_by
        if i > 0:
            before[_OF_RELAXATION, j] = a * before[_OF_RELAXATION, j] + (
                b0 * before[_OF_ELASTIC, j] + b1 * now_s
            )
        before[_OF_ELASTIC, j] = now_s
        bent = fv * (l0 - x) * l0 * bend
        force_s = active * (bent * length_by + fv_v * slopes[2, j, i])
        if force > 0.0:
            force_s += now_s - before[_OF_RELAXATION, j]
        pulled = active * fv + force
        jacobian[turned[j], i] += slopes[0, j, i] * pulled + r * force_s


@inner
def _at_rest(elastic: float, dc: float, k: float, path: Path) -> FloatArray:
    """What turns the path in a trial that starts relaxed to its first sample, (2, s)."""
    slopes = path[1]
    before = np.empty((2, slopes.shape[1]))
    for j in range(slopes.shape[1]):
        before[_OF_ELASTIC, j] = k * elastic * slopes[1, j, 0]
        before[_OF_RELAXATION, j] = dc * before[_OF_ELASTIC, j]
    return before


@inner
def _driven(gains: FloatArray, drive: Drive, jacobian: FloatArray) -> None:
    """Add the torque's derivatives by what moves the active state."""
    _, slopes, slots = drive
    for j in range(len(slots)):
        row = jacobian[slots[j]]
        for i in range(len(gains)):
            row[i] += gains[i] * slopes[j, i]


@jit
def rigid_torque(
    p: FloatArray,
    slots: IntArray,
    constants: tuple[float, float],
    path: Path,
    curves: Curves,
    drive: Drive,
    torque: FloatArray,
    jacobian: FloatArray,
) -> None:
    """Add the group's torque, equation (2), and its derivatives.

    Parameters
    ----------
    p : ndarray, shape (5,)
        The group's parameters, as in `exponentials`.
    slots : ndarray of int, shape (5,)
        Row of the jacobian that belongs to each parameter.
    constants : tuple of float
        vmax in optimal lengths per second; sample time [s].
    path : tuple of ndarray
        Signed moment arm [m], length [m] and lengthening speed [m/s], shape (3, n); their
        derivatives by what turns them, shape (3, s, n), and the rows of the jacobian they go to.
    curves : tuple of ndarray, shape (n,)
        From `exponentials`.
    drive : tuple of ndarray
        Active state [N], shape (n,); its derivatives, shape (q, n), and the rows of the jacobian
        they go to.
    torque : ndarray, shape (n,)
        Is added to [Nm].
    jacobian : ndarray, shape (rows, n)
        Is added to, one contiguous row a parameter.
    """
    factor, dt = constants
    length = path[0][1]
    speed = path[0][2]
    elastic, fl = curves
    alpha = drive[0]
    gains = np.empty(len(length))  # torque per active state [m]
    a, b0, b1, a_t, b0_t, b1_t, a_k, b0_k, b1_k = relaxation_step(p[TAU], p[K_REL], dt)
    dc = p[K_REL] / (1.0 + p[K_REL])
    dc_k = 1.0 / (1.0 + p[K_REL]) ** 2
    k = p[K]
    l0 = p[L0]
    vmax = factor * l0
    tissue = (k, l0, 2.0 / (CF * l0**3))
    by_k = jacobian[slots[K]]
    by_x0 = jacobian[slots[X0]]
    by_l0 = jacobian[slots[L0]]
    # relaxation and its sensitivities by k, tau_rel, k_rel; by x0 all is −k times itself
    before = elastic[0]
    before_k = (length[0] - p[X0]) * before
    z = dc * before
    z_k = dc * before_k
    z_t = 0.0
    z_r = dc_k * before
    before_s = _at_rest(before, dc, k, path)
    for i in range(len(length)):
        x = length[i]
        r = path[0][0, i]
        now = elastic[i]
        now_k = (x - p[X0]) * now
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
            jacobian[slots[TAU], i] -= r * z_t
            jacobian[slots[K_REL], i] -= r * z_r
        fv, fv_v, _, _ = force_velocity(speed[i], vmax, MVSH, FECC - 1.0)
        gains[i] = r * fl[i] * fv
        torque[i] += r * force + gains[i] * alpha[i]
        by_l0[i] += alpha[i] * (
            gains[i] * (x - l0) * x * tissue[2] + r * fl[i] * (-speed[i] / vmax * fv_v) * factor
        )
        instant = (x, now, force, alpha[i] * fl[i], fv, fv_v)
        _turned(i, path, before_s, tissue, (a, b0, b1), instant, jacobian)
    _driven(gains, drive, jacobian)
