"""Channels to one uniform axis: jitter removed, anti-aliasing, interpolation; or thinned."""

from dataclasses import dataclass, replace

import numpy as np

from surae.errors import InputError
from surae.frozen import read_only
from surae.recording import Channel
from surae.signals.filters import ANTIALIAS_PASS, ANTIALIAS_STOP, Ends, antialias
from surae.signals.inputs import ModelInputs
from surae.signals.timebase import SAME_STEPS, Axis, Timing, timing
from surae.units import FloatArray

#: Only content above `ANTIALIAS_STOP` × target rate folds back below `ANTIALIAS_PASS` × target
#: rate; a source with a Nyquist frequency below it has none.
_ANTIALIAS_FROM = 2.0 * ANTIALIAS_STOP

#: Degree of the interpolating spline.
_DEGREE = 5


@dataclass(frozen=True, slots=True)
class Uniform:
    """A channel on a uniform axis at its own rate."""

    where: str  #: Recording and role, for messages.
    axis: Axis  #: Its time axis.
    values: FloatArray  #: Its samples, shape (axis.n,).
    timing: Timing  #: How its time stamps were.

    def replaced(self, values: FloatArray) -> "Uniform":
        """The channel with other values on its axis."""
        return replace(self, values=values)


def uniform(channel: Channel, recording: str) -> Uniform:
    """Put a channel of the recording of that name on the axis that fits its time stamps best.

    Samples that lie on it already, but for the rounding of their time stamps, are kept as they are;
    jittered ones are interpolated by a quintic spline.
    """
    stamps = timing(channel, recording)
    where = f"{recording}: {channel.role}"
    values = channel.values
    if not stamps.uniform:
        values = _spline(channel.time, values, stamps.axis.time, where)
    return Uniform(where, stamps.axis, values, stamps)


def needs_antialias(source: Axis, target: Axis) -> bool:
    """Whether the source's rate is so high that its content would fold into the band kept."""
    return source.rate_hz > _ANTIALIAS_FROM * target.rate_hz * (1.0 + SAME_STEPS)


def resample(signal: Uniform, target: Axis, *, ends: Ends = "odd") -> FloatArray:
    """The signal at the instants of `target`, which must lie within its span.

    A source faster than 1.2 × the target rate is anti-aliased first (`antialias`, zero phase). Then
    instants that coincide with samples take them unchanged; others are interpolated by a quintic
    spline. Away from the ends, a tone at 0.2 of the target rate is kept to 4e-6 of its amplitude
    from sources at least twice as fast, and to 5e-4 at the same rate and half a step apart.
    """
    values = signal.values
    if needs_antialias(signal.axis, target):
        values = antialias(
            values, signal.axis.rate_hz, target.rate_hz, ends=ends, where=signal.where
        )
    position = (target.time - signal.axis.start) * signal.axis.rate_hz
    nearest = np.clip(np.rint(position).astype(np.intp), 0, signal.axis.n - 1)
    if np.max(np.abs(position - nearest)) <= 2.0 * SAME_STEPS:
        return values[nearest]
    index = np.arange(signal.axis.n, dtype=np.float64)
    return _spline(index, values, np.clip(position, 0.0, signal.axis.n - 1.0), signal.where)


def antialias_step(target: Axis) -> str:
    """The sentence that says what the anti-aliasing filter does."""
    return (
        f"zero-phase 10th-order Butterworth anti-aliasing (-3 dB at "
        f"{ANTIALIAS_PASS * target.rate_hz:.4g} Hz, below -60 dB from "
        f"{ANTIALIAS_STOP * target.rate_hz:.4g} Hz)"
    )


def _spline(x: FloatArray, y: FloatArray, at: FloatArray, where: str) -> FloatArray:
    """Interpolate by a quintic spline."""
    from scipy.interpolate import make_interp_spline

    if len(x) <= _DEGREE:
        raise InputError(
            f"{where}: {len(x)} samples are too few to interpolate; at least {_DEGREE + 1} "
            f"are needed"
        )
    interpolated: FloatArray = make_interp_spline(x, y, k=_DEGREE)(at)
    return interpolated


def thinned(inputs: ModelInputs, factor: int) -> ModelInputs:
    """Every `factor`-th sample of the inputs.

    EMG is averaged over the samples around each kept instant, which a low-pass activation filter
    cannot tell from the whole, and which comes neither early nor late; motion and torque are taken
    as they are at the kept instants.

    Parameters
    ----------
    inputs : ModelInputs
        Prepared signals.
    factor : int
        At least 1; samples that do not fill the last group are left out.
    """
    from scipy.ndimage import correlate1d

    used = inputs.n // factor * factor
    around = np.ones(factor if factor % 2 else factor + 1)
    if factor % 2 == 0:
        around[[0, -1]] = 0.5

    def kept(signal: FloatArray) -> FloatArray:
        return read_only(signal[factor // 2 : used : factor])

    return replace(
        inputs,
        rate_hz=inputs.rate_hz / factor,
        time=kept(inputs.time),
        angle=kept(inputs.angle),
        velocity=kept(inputs.velocity),
        acceleration=kept(inputs.acceleration),
        emg=kept(correlate1d(inputs.emg, around / factor, axis=0, mode="nearest")),
        torque=None if inputs.torque is None else kept(inputs.torque),
        weight=None if inputs.weight is None else kept(inputs.weight),
        second=tuple(map(kept, inputs.second)),
        steps=(*inputs.steps, f"Thinned to every {factor}th sample."),
    )


def thinning_factor(inputs: ModelInputs, rate_hz: float, samples: int) -> int:
    """The largest factor by which a recording may be thinned.

    Parameters
    ----------
    inputs : ModelInputs
        The recording.
    rate_hz : float
        Rate that must be left [Hz].
    samples : int
        Number of samples that must be left.

    Returns
    -------
    int
        1 where nothing may be left out.
    """
    return max(1, min(int(np.floor(inputs.rate_hz / rate_hz)), inputs.n // samples))
