"""The activation filter (14) behind a delay: exact, and smooth in the delay.

EMG shifted by part of a sample and interpolated anew would make a torque that has a kink wherever
the delay is a whole number of samples, and whose amplitude dips in between. The filter is linear
and knows no absolute time, so its output is shifted instead: the input is linear between its own
samples, the output is exact at any instant between them, and has two continuous derivatives by
time and therefore by the delay. Its rate is among the states, so that ∂α/∂delay = −α' is free.
"""

import math

import numpy as np

from surae.model.activation import filter_step
from surae.model.jit import jit
from surae.units import FloatArray

#: Rows of what `delayed` gives: the output, and its derivatives by delay, f0 and beta.
OUT, BY_DELAY, BY_F0, BY_BETA = 0, 1, 2, 3


@jit
def _respond(
    total: FloatArray, first: float, held: FloatArray, steps: FloatArray, back: int, omega: float,
    out: FloatArray,
) -> None:  # fmt: skip
    """The output of one input, and its derivatives, at one instant of every sample.

    The input's change since its first sample goes through the filter from rest; `held`, of shape
    (4, n), is the output of a unit step, which takes the first sample's part. `steps`, of shape
    (2, 3, 2, 4), are a step of one sample and one of the part of it that lies before the instant,
    with their derivatives by f0 and beta. `out` has shape (4, n).
    """
    s, f, b = steps[0, 0], steps[0, 1], steps[0, 2]
    s00, s01, s02, s03 = s[0, 0], s[0, 1], s[0, 2], s[0, 3]
    s10, s11, s12, s13 = s[1, 0], s[1, 1], s[1, 2], s[1, 3]
    f00, f01, f02, f03 = f[0, 0], f[0, 1], f[0, 2], f[0, 3]
    f10, f11, f12, f13 = f[1, 0], f[1, 1], f[1, 2], f[1, 3]
    b00, b01, b02, b03 = b[0, 0], b[0, 1], b[0, 2], b[0, 3]
    b10, b11, b12, b13 = b[1, 0], b[1, 1], b[1, 2], b[1, 3]
    p, q, r = steps[1, 0], steps[1, 1], steps[1, 2]
    p00, p01, p02, p03 = p[0, 0], p[0, 1], p[0, 2], p[0, 3]
    p10, p11, p12, p13 = p[1, 0], p[1, 1], p[1, 2], p[1, 3]
    q0, q1, q2, q3 = q[0, 0], q[0, 1], q[0, 2], q[0, 3]
    r0, r1, r2, r3 = r[0, 0], r[0, 1], r[0, 2], r[0, 3]
    for i in range(len(total)):
        out[OUT, i] = first * held[OUT, i]
        out[BY_DELAY, i] = 0.0
        out[BY_F0, i] = first * held[BY_F0, i]
        out[BY_BETA, i] = first * held[BY_BETA, i]
    v = w = v_f = w_f = v_b = w_b = 0.0  # α and α'/ω0, their derivatives by f0 and by beta
    for i in range(len(total) - back - 1):
        before, now, j = total[i] - first, total[i + 1] - first, i + back + 1
        out[OUT, j] += p00 * v + p01 * w + p02 * before + p03 * now
        out[BY_DELAY, j] -= omega * (p10 * v + p11 * w + p12 * before + p13 * now)
        out[BY_F0, j] += p00 * v_f + p01 * w_f + q0 * v + q1 * w + q2 * before + q3 * now
        out[BY_BETA, j] += p00 * v_b + p01 * w_b + r0 * v + r1 * w + r2 * before + r3 * now
        v_f, w_f = (
            s00 * v_f + s01 * w_f + f00 * v + f01 * w + f02 * before + f03 * now,
            s10 * v_f + s11 * w_f + f10 * v + f11 * w + f12 * before + f13 * now,
        )
        v_b, w_b = (
            s00 * v_b + s01 * w_b + b00 * v + b01 * w + b02 * before + b03 * now,
            s10 * v_b + s11 * w_b + b10 * v + b11 * w + b12 * before + b13 * now,
        )
        v, w = (
            s00 * v + s01 * w + s02 * before + s03 * now,
            s10 * v + s11 * w + s12 * before + s13 * now,
        )


@jit
def _steps(f0: float, beta: float, dt: float, late: float) -> tuple[FloatArray, int]:
    """The steps that `_respond` takes to be `late` [s], and whole samples it goes back for that."""
    back = math.floor(max(late, 0.0) / dt)
    after = (back + 1) * dt - late  # the instant lies in (0, dt] after sample i − back − 1
    if after <= 0.0:  # rounding
        back, after = back + 1, after + dt
    share = after / dt
    steps = np.empty((2, 3, 2, 4))
    steps[0, 0], steps[0, 1], steps[0, 2] = filter_step(f0, beta, dt)
    steps[1, 0], steps[1, 1], steps[1, 2] = filter_step(f0, beta, after)
    # from the inputs at both ends of the sample to those at both ends of its part
    steps[1, :, :, 2] += (1.0 - share) * steps[1, :, :, 3]
    steps[1, :, :, 3] *= share
    return steps, back


@jit
def _delayed(
    inputs: FloatArray, f0: float, beta: float, dt: float, delay: float, lags: FloatArray
) -> FloatArray:
    """What `delayed` gives, of inputs that numba has compiled this for."""
    k, n = inputs.shape
    omega = 2.0 * math.pi * f0
    found = np.empty((4, k, n, len(lags)))
    one, nothing, held = np.ones(n), np.zeros((4, n)), np.empty((4, n))
    for at in range(len(lags)):
        steps, back = _steps(f0, beta, dt, lags[at])
        late, further = _steps(f0, beta, dt, lags[at] + delay)
        # A step from the rest before the recording: its first sample is input already.
        _respond(one, 0.0, nothing, steps, back, omega, held)
        for c in range(k):
            _respond(inputs[c], inputs[c, 0], held, late, further, omega, found[:, c, :, at])
    return found


def delayed(
    inputs: FloatArray, f0: float, beta: float, dt: float, delay: float, lags: tuple[float, ...]
) -> FloatArray:
    """Activation filter (14), from rest, of inputs that come late.

    Before the recording an input is held at its first sample. That part is a step which no delay
    moves, the rest begins at zero and is moved: hence smooth in the delay at the start too.

    Parameters
    ----------
    inputs : ndarray, shape (k, n)
        Inputs, linear between samples.
    f0, beta : float
        Cut-off [Hz] and relative damping of the filter.
    dt : float
        Sample time [s].
    delay : float
        Of the inputs [s], zero or more.
    lags : tuple of float
        The output is wanted so long before each sample [s].

    Returns
    -------
    ndarray, shape (4, k, n, number of lags)
        Outputs, and their derivatives by `delay`, `f0` and `beta`.
    """
    # A copy: for a read-only or strided array numba would compile the kernel once more.
    copied = np.array(inputs, dtype=np.float64, order="C")
    return _delayed(copied, f0, beta, dt, delay, np.array(lags))
