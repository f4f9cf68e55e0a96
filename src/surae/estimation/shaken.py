"""What else shakes an estimate, beside the torque's noise: noise of the EMG, and the integrator.

Both are known errors of the modelled torque that the noise of the residual does not tell of. What
they do to the parameters is linear, δz = V·JᵀWᵀW·δT. Noise of the EMG does more: it is in the
model's own columns, so the data ask for a slower filter that lets less of it through. That bias
does not shrink with more data. As in SIMEX (Cook and Stefanski 1994), more noise of the same kind
shows it, and it is taken away.

Noise of an envelope is what changes faster than a muscle does. It is stronger where the EMG is,
most of all in raw EMG that was rectified, whose size fluctuates by as much as itself.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target, whitened
from surae.frozen import read_only
from surae.signals import ModelInputs, thinned
from surae.units import FloatArray

#: Band [Hz] in which an envelope is taken for noise, at most these parts of the sampling rate, and
#: the time [s] over which its size is averaged.
_NOISE_HZ, _NOISE_PART, _AVERAGED_S = (10.0, 40.0), (0.1, 0.35), 0.25
#: Shift of a logarithm that is no longer small, and sum of squares, as a part of what it
#: was, from which the torque is let go by it.
_FARTHEST, _WORSE = 1.0, 1.3
#: Samples below which nothing is said of it.
_FEWEST = 30
#: Pairs of noise realisations, of opposite signs, that show the bias, and realisations that show
#: the scatter.
_PAIRS, _DRAWS = 3, 12


def without_emg_bias(
    target: Target, mode: Mode, quadratic: Quadratic
) -> tuple[FloatArray, FloatArray]:
    """The mode without what noise of the EMG shifts it by on average, and what is left of that.

    A shift that is not small, or after which the torque is followed much worse, is no matter of
    first order: the mode stays, and the shift is something that is not known.

    What is given back is the mode, and the shift that was not taken away.
    """
    covariance = quadratic.solved({})[2]
    gradient = np.zeros(len(mode.z))
    for noisy in _noisier(target, _PAIRS, both_signs=True):
        for rows in noisy.data_rows(mode.z):
            gradient += (rows[:-1] @ rows[-1]) / (2.0 * _PAIRS)
    shift = covariance @ (gradient - quadratic.gradient)
    moved = np.clip(mode.z + shift, target.lower, target.upper)
    far = np.abs(shift[: len(target.names)][target.log]) > _FARTHEST
    if not np.isfinite(shift).all() or far.any():
        return mode.z, np.nan_to_num(shift)
    before, after = target.sum_of_squares(mode.z), target.sum_of_squares(moved)
    if not after < _WORSE * before:
        return mode.z, shift
    return np.asarray(moved), np.zeros(len(shift))


def emg_draws(target: Target, mode: Mode) -> list[list[FloatArray]]:
    """What draws of the EMG's noise change of the residual of each recording [Nm]."""
    before = target.residuals(mode.z)
    return [
        [np.nan_to_num(e - old) for e, old in zip(noisy.residuals(mode.z), before, strict=True)]
        for noisy in _noisier(target, _DRAWS)
    ]


def shaken(
    target: Target, mode: Mode, quadratic: Quadratic, noisy: Sequence[Sequence[FloatArray]]
) -> dict[str, FloatArray]:
    """Shifts as they are searched, by source; see `Family.spread`.

    `noisy` comes of `emg_draws`.
    """
    covariance = quadratic.solved({})[2]
    levers = []
    for rows, noise, recording in zip(
        target.data_rows(mode.z), target.noise, target.problem.inputs, strict=True
    ):
        # W twice: forwards on the error, which is backwards on the rows
        lever = covariance @ whitened(rows[:-1, ::-1], noise)[:, ::-1]
        levers.append(lever if recording.weight is None else lever * np.sqrt(recording.weight))
    values = target.values(mode.z)
    step = sum(
        lever @ _halved(target, values, recording)
        for lever, recording in zip(levers, target.problem.inputs, strict=True)
    )
    emg = [
        sum(lever @ change for lever, change in zip(levers, draw, strict=True)) for draw in noisy
    ]
    return {
        "emg_noise": np.nan_to_num(np.stack(emg) / np.sqrt(len(noisy))),
        "integration": np.nan_to_num(step)[None],
    }


def emg_noise(recording: ModelInputs) -> FloatArray:
    """Standard deviation of white noise as strong as that of the envelopes, shape (n, 4)."""
    from scipy.ndimage import uniform_filter1d
    from scipy.signal import butter, sosfiltfilt, sosfreqz

    if recording.n < _FEWEST:
        return np.zeros_like(recording.emg)
    rate = recording.rate_hz
    band = [min(hz, part * rate) for hz, part in zip(_NOISE_HZ, _NOISE_PART, strict=True)]
    sos = butter(2, band, btype="bandpass", fs=rate, output="sos")
    passed = np.abs(sosfreqz(sos, 2048)[1]) ** 4  # of both passes, on power
    fast = sosfiltfilt(sos, recording.emg, axis=0)
    size = max(3, int(_AVERAGED_S * rate))
    power = uniform_filter1d(fast**2, size, axis=0, mode="nearest") / passed.mean()
    return np.asarray(np.sqrt(np.maximum(power, 0.0)))  # a running sum may end below zero


def _noisier(target: Target, count: int, *, both_signs: bool = False) -> Iterator[Target]:
    """The target with more noise of the EMG, as much as there is."""
    rng = np.random.default_rng(0)
    recordings = target.problem.inputs
    levels = [emg_noise(recording) for recording in recordings]
    for _ in range(count):
        noise = [level * rng.standard_normal(level.shape) for level in levels]
        for sign in (1.0, -1.0) if both_signs else (1.0,):
            yield target.of_inputs(
                tuple(
                    replace(recording, emg=read_only(recording.emg + sign * more))
                    for recording, more in zip(recordings, noise, strict=True)
                )
            )


def _halved(target: Target, values: FloatArray, recording: ModelInputs) -> FloatArray:
    """Error of the torque by the size of the steps [Nm]: a third of what steps of twice it add."""
    spec, options = target.problem.spec, target.problem.options
    coarse_inputs = thinned(recording, 2)
    fine = spec.simulator(recording, options).torque(values)
    coarse = spec.simulator(coarse_inputs, options).torque(values)
    there = np.interp(coarse_inputs.time, recording.time, fine)
    error: FloatArray = np.interp(recording.time, coarse_inputs.time, coarse - there) / 3.0
    return error if np.isfinite(error).all() else np.zeros(recording.n)
