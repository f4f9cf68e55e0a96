"""What else shakes an estimate, beside the torque's noise: noise of the EMG, and the integrator.

Both are known errors of the modelled torque that the noise of the residual does not tell of. What
they do to the parameters is linear: δz = V·JᵀWᵀW·δT.
"""

from collections.abc import Mapping

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target, whitened
from surae.model.activation import filter_step
from surae.model.contraction import contraction
from surae.model.geometry import paths
from surae.signals import ModelInputs, thinned
from surae.units import FloatArray

#: Median absolute third difference of white noise of variance 1: 0.6745·√(1 + 9 + 9 + 1).
_THIRD = 0.6745 * np.sqrt(20.0)


def shaken(target: Target, mode: Mode, quadratic: Quadratic) -> dict[str, Mapping[str, float]]:
    """Standard deviations by source and parameter of the leg, in their units."""
    covariance = quadratic.solved({})[2]
    count = len(target.names)
    emg, step = np.zeros(len(mode.z)), np.zeros(len(mode.z))
    whole = target.data_rows(mode.z)
    values = target.values(mode.z)
    for number, one in enumerate(target.problem.inputs):
        noise = target.noise[number]
        # W twice: forwards on the error, which is backwards on the rows
        twice = whitened(whole[number][:-1, ::-1], noise)[:, ::-1]
        lever = covariance @ twice
        if one.weight is not None:
            lever = lever * np.sqrt(one.weight)
        step += lever @ _halved(target, values, one)
        emg += _emg_variance(target, values, one, lever)
    scale = target.scale(mode.z)
    return {
        "emg_noise": dict(zip(target.names, (np.sqrt(emg)[:count] * scale).tolist(), strict=True)),
        "integration": dict(zip(target.names, (np.abs(step)[:count] * scale).tolist(),
                                strict=True)),
    }  # fmt: skip


def _halved(target: Target, values: FloatArray, one: ModelInputs) -> FloatArray:
    """Error of the torque by the size of the steps [Nm]: a third of what steps of twice it add."""
    spec, options = target.problem.spec, target.problem.options
    coarse_inputs = thinned(one, 2)
    fine = spec.simulator(one, options).torque(values)
    coarse = spec.simulator(coarse_inputs, options).torque(values)
    there = np.interp(coarse_inputs.time, one.time, fine)
    error: FloatArray = np.interp(one.time, coarse_inputs.time, coarse - there) / 3.0
    return error if np.isfinite(error).all() else np.zeros(one.n)


def _emg_variance(
    target: Target, values: FloatArray, one: ModelInputs, lever: FloatArray
) -> FloatArray:
    """Variance of each searched parameter by white noise of the envelopes, shape (q,)."""
    from scipy.signal import lfilter

    spec, options = target.problem.spec, target.problem.options
    value = dict(zip(spec.names, values.tolist(), strict=True))
    dt = 1.0 / one.rate_hz
    # the filter's response to one sample: what noise of the sample does to the active state
    n = min(one.n, max(8, int(3.0 / (value["f0"] * dt))))
    impulse = _response(value["f0"], value["beta"], dt, n)
    variance = np.zeros(len(lever))
    for muscle, path in enumerate(paths(angle=one.angle, velocity=one.velocity, options=options)):
        l0 = value["l0_tri" if muscle == 0 else "l0_tib"]
        shape = contraction(path.length.copy(), path.speed.copy(), l0, float(options.vmax_factor))
        gain = path.arm * shape[0]
        felt = lfilter(impulse, [1.0], (lever * gain)[:, ::-1], axis=1)
        power = np.sum(felt**2, axis=1)
        for channel in (1, 2, 3) if muscle == 0 else (0,):
            weight = value[spec.weights[channel]]
            deviation = np.median(np.abs(np.diff(one.emg[:, channel], 3))) / _THIRD
            variance += (weight * deviation) ** 2 * power
    return variance


def _response(f0: float, beta: float, dt: float, n: int) -> FloatArray:
    """Response of the activation filter (14) to one sample of 1, shape (n,)."""
    step = filter_step(f0, beta, dt)[0]
    state, before = np.zeros(2), 0.0
    out = np.zeros(n)
    for i in range(n):
        now = 1.0 if i == 1 else 0.0
        state = step[:2, :2] @ state + step[:2, 2] * before + step[:2, 3] * now
        out[i], before = state[0], now
    return out
