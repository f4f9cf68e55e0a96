"""Active states at the stages of the implicit integrator, with their sensitivities (12) to (14)."""

import numpy as np

from surae.model.activation import filter_step
from surae.model.jit import jit
from surae.units import FloatArray

#: Abscissa and diagonal coefficient of the two-stage SDIRK, γ = 1 − 1/√2: L-stable, second order.
GAMMA = 1.0 - 0.5**0.5

#: EMG channels of triceps and tibialis.
GROUPS = ((1, 2, 3), (0,))
#: Signals of `staged_activation`: active states, channels TA, GL, SOL, GM, derivatives.
ALPHA, CHANNEL, BY_F0, BY_BETA = 0, 2, 6, 8


def staged_activation(
    emg: FloatArray, weights: FloatArray, f0: float, beta: float, dt: float, derivatives: bool
) -> FloatArray:
    """Active states at both stages of every step, exact for an EMG linear between samples.

    Parameters
    ----------
    emg : ndarray, shape (4, n)
        EMG envelopes TA, GL, SOL, GM [V].
    weights : ndarray, shape (4,)
        g1 … g4 [N/V].
    f0, beta : float
        Cut-off [Hz] and relative damping of the filter.
    dt : float
        Sample time [s].
    derivatives : bool
        Whether the derivatives are wanted too; without them their signals are zero.

    Returns
    -------
    ndarray, shape (10, n, 2)
        Per sample the first stage of its step, at t[n−1] + γ·dt, and the sample itself: α of
        triceps and tibialis [N]; then the filtered channels TA … GM [V] (∂α/∂g), ∂α/∂f0 of both
        groups [N/Hz] and ∂α/∂beta of both [N]. All start at rest.
    """
    whole, whole_f0, whole_beta = filter_step(f0, beta, dt)
    part, part_f0, part_beta = filter_step(f0, beta, GAMMA * dt)
    # from the inputs at both ends of the sample to those at both ends of its first stage
    for step in (part, part_f0, part_beta):
        step[:, 2] += (1.0 - GAMMA) * step[:, 3]
        step[:, 3] *= GAMMA
    signals = np.zeros((10, emg.shape[1], 2))
    for muscle, channels in enumerate(GROUPS):
        total = np.zeros(emg.shape[1])
        for c in channels:
            total += weights[c] * emg[c]
        _filtered(total, whole, part, signals[ALPHA + muscle])
        if derivatives:
            for c in channels:
                _filtered(emg[c], whole, part, signals[CHANNEL + c])
            _driven(total, whole, part, whole_f0, part_f0, signals[BY_F0 + muscle])
            _driven(total, whole, part, whole_beta, part_beta, signals[BY_BETA + muscle])
    return signals


@jit
def _filtered(total: FloatArray, whole: FloatArray, part: FloatArray, out: FloatArray) -> None:
    """An input through the filter, at both stages of every step."""
    s00, s01, s02, s03 = whole[0, 0], whole[0, 1], whole[0, 2], whole[0, 3]
    s10, s11, s12, s13 = whole[1, 0], whole[1, 1], whole[1, 2], whole[1, 3]
    p0, p1, p2, p3 = part[0, 0], part[0, 1], part[0, 2], part[0, 3]
    a = b = 0.0
    for i in range(1, len(total)):
        before, now = total[i - 1], total[i]
        out[i, 0] = p0 * a + p1 * b + p2 * before + p3 * now
        a, b = (
            s00 * a + s01 * b + s02 * before + s03 * now,
            s10 * a + s11 * b + s12 * before + s13 * now,
        )
        out[i, 1] = a


@jit
def _driven(
    total: FloatArray, whole: FloatArray, part: FloatArray, whole_d: FloatArray,
    part_d: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """Derivative of `_filtered` by a parameter of the filter."""
    s00, s01, s02, s03 = whole[0, 0], whole[0, 1], whole[0, 2], whole[0, 3]
    s10, s11, s12, s13 = whole[1, 0], whole[1, 1], whole[1, 2], whole[1, 3]
    d00, d01, d02, d03 = whole_d[0, 0], whole_d[0, 1], whole_d[0, 2], whole_d[0, 3]
    d10, d11, d12, d13 = whole_d[1, 0], whole_d[1, 1], whole_d[1, 2], whole_d[1, 3]
    p0, p1 = part[0, 0], part[0, 1]
    q0, q1, q2, q3 = part_d[0, 0], part_d[0, 1], part_d[0, 2], part_d[0, 3]
    a = b = a_d = b_d = 0.0
    for i in range(1, len(total)):
        before, now = total[i - 1], total[i]
        out[i, 0] = p0 * a_d + p1 * b_d + q0 * a + q1 * b + q2 * before + q3 * now
        a_d, b_d = (
            s00 * a_d + s01 * b_d + d00 * a + d01 * b + d02 * before + d03 * now,
            s10 * a_d + s11 * b_d + d10 * a + d11 * b + d12 * before + d13 * now,
        )
        out[i, 1] = a_d
        a, b = (
            s00 * a + s01 * b + s02 * before + s03 * now,
            s10 * a + s11 * b + s12 * before + s13 * now,
        )
