"""Noise of the EMG: how strong it is, how much of the residual it makes, and what it biases.

Noise of an envelope is what changes faster than a muscle does. It is stronger where the EMG is,
most of all in raw EMG that was rectified, whose size fluctuates by as much as itself.

It is in the modelled torque, and so in the residual, whose noise is counted already. What draws of
it make of the residual, beside what is there, tells which part of that noise is the EMG's: that
part is not counted twice. And more than there is it cannot make: where draws make more, what is
taken for noise is a part of the effort, and there is less noise.

Being in the model's own columns, it does more: the data ask for a slower filter that lets less of
it through. That bias does not shrink with more data. As in SIMEX (Cook and Stefanski 1994), more
noise of the same kind shows it, and it is taken away.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target, whitened
from surae.frozen import read_only
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Band [Hz] in which an envelope is taken for noise, at most these parts of the sampling rate, and
#: the time [s] over which its size is averaged.
_NOISE_HZ, _NOISE_PART, _AVERAGED_S = (10.0, 40.0), (0.1, 0.35), 0.25
#: Shift of a logarithm that is no longer small, and sum of squares, as a part of what it
#: was, from which the torque is let go by it.
_FARTHEST, _WORSE = 1.0, 1.3
#: What is unsure of a shift that was taken away: what higher orders add is as much (decision 16).
_HIGHER = 1.0
#: Samples below which nothing is said of it.
_FEWEST = 30
#: Pairs of noise realisations, of opposite signs, that show the bias, and realisations that show
#: the scatter.
_PAIRS, _DRAWS = 3, 32
#: Frequencies [Hz] of the residual in which parameters act, and the least part of its noise that
#: is not taken for the EMG's.
_SLOW_HZ, _OTHER = 2.0, 0.1
#: Slow power that draws make, as a part of what there is, from which noise is not as strong as was
#: taken for it: some draws and one residual differ by so much by chance.
_PLAUSIBLE = 1.5


@dataclass(frozen=True, slots=True)
class NoisyEmg:
    """What noise of the EMG does to a residual."""

    changes: tuple[tuple[FloatArray, ...], ...]  #: Of the residual by each draw, by recording [Nm].
    power: float  #: Mean sum of squares of a draw's changes, whitened.
    part: float  #: Of the residual's noise that it makes, at most `1 - _OTHER`.
    strength: float  #: Of the noise, as a part of what was taken for it, at most 1.


def noisy_emg(target: Target, mode: Mode, quadratic: Quadratic, *, draws: int = _DRAWS) -> NoisyEmg:
    """What so many draws of the EMG's noise do to the residual at a mode."""
    before = target.residuals(mode.z)
    made = [
        [np.nan_to_num(e - old) for e, old in zip(noisy.residuals(mode.z), before, strict=True)]
        for noisy in _noisier(target, draws, 1.0)
    ]
    part, power = _of_residual(target, mode, quadratic, made)
    strength = float(np.sqrt(min(_PLAUSIBLE / max(part, _PLAUSIBLE), 1.0)))
    changes = tuple(tuple(strength * change for change in draw) for draw in made)
    return NoisyEmg(changes, strength**2 * power, min(part, 1.0 - _OTHER), strength)


def _of_residual(
    target: Target, mode: Mode, quadratic: Quadratic, draws: Sequence[Sequence[FloatArray]]
) -> tuple[float, float]:
    """What draws make of the residual, on average, as a part of its slow power; their whole power.

    Of draws as of the residual the fit takes what its parameters can follow. All are whitened.
    """
    blocks, changes = target.data_rows(mode.z), []
    for number, (recording, noise) in enumerate(
        zip(target.problem.inputs, target.noise, strict=True)
    ):
        counts = 1.0 if recording.weight is None else np.sqrt(recording.weight)
        changes.append(whitened(np.stack([draw[number] for draw in draws]) * counts, noise))
    pulls = sum(rows[:-1] @ change.T for rows, change in zip(blocks, changes, strict=True))
    taken = (quadratic.solved({})[2] @ pulls).T
    there = by_emg = 0.0
    for rows, change, recording in zip(blocks, changes, target.problem.inputs, strict=True):
        slow = np.fft.rfftfreq(recording.n, 1.0 / recording.rate_hz) < _SLOW_HZ
        left = change - taken @ rows[:-1]
        there += float((np.abs(np.fft.rfft(rows[-1])[slow]) ** 2).sum())
        by_emg += float((np.abs(np.fft.rfft(left, axis=1)[:, slow]) ** 2).sum()) / len(draws)
    power = sum(float((change**2).sum()) for change in changes) / len(draws)
    return (by_emg / there if there > 0.0 and np.isfinite(by_emg) else 0.0), power


def without_emg_bias(
    target: Target, mode: Mode, quadratic: Quadratic, noisy: NoisyEmg
) -> tuple[FloatArray, FloatArray]:
    """The mode without what noise of the EMG shifts it by on average, and what is left of that.

    A shift that is not small, or after which the torque is followed much worse, is no matter of
    first order: the mode stays, and the shift is something that is not known. It is no farther than
    noise can have moved an estimate: both the truth, whose residual is the noise, and the mode are
    as near to the measured torque as their residuals are long, and to the priors.

    What is given back is the mode, and the shift that was not taken away.
    """
    covariance = quadratic.solved({})[2]
    gradient = np.zeros(len(mode.z))
    for noisier in _noisier(target, _PAIRS, noisy.strength, both_signs=True):
        for rows in noisier.data_rows(mode.z):
            gradient += (rows[:-1] @ rows[-1]) / (2.0 * _PAIRS)
    most = (np.sqrt(quadratic.cost) + np.sqrt(noisy.power)) ** 2 + len(mode.z)
    shift = covariance @ (gradient - quadratic.gradient)
    if not np.isfinite(shift).all():
        return mode.z, np.sqrt(most * np.diag(covariance))
    moved = np.clip(mode.z + shift, target.lower, target.upper)
    far = np.abs(shift[: len(target.names)][target.log]) > _FARTHEST
    before, after = target.sum_of_squares(mode.z), target.sum_of_squares(moved)
    if not far.any() and after < _WORSE * before:
        return np.asarray(moved), _HIGHER * shift
    length = float(shift @ (quadratic.information @ shift + quadratic.weight**2 * shift))
    return mode.z, np.asarray(shift * min(1.0, np.sqrt(most / max(length, 1e-300))))


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


def _noisier(
    target: Target, count: int, strength: float, *, both_signs: bool = False
) -> Iterator[Target]:
    """The target with more noise of the EMG, so many times as much as there is."""
    rng = np.random.default_rng(0)
    recordings = target.problem.inputs
    levels = [emg_noise(recording) for recording in recordings]
    for _ in range(count):
        noise = [strength * level * rng.standard_normal(level.shape) for level in levels]
        for sign in (1.0, -1.0) if both_signs else (1.0,):
            yield target.of_inputs(
                tuple(
                    replace(recording, emg=read_only(recording.emg + sign * more))
                    for recording, more in zip(recordings, noise, strict=True)
                )
            )
