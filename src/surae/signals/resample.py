"""Channels to one uniform axis: jitter removed, anti-aliasing, interpolation; derivatives."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.recording import Channel
from surae.signals.filters import ANTIALIAS_PASS, ANTIALIAS_STOP, Ends, antialias
from surae.signals.inputs import ModelInputs
from surae.signals.timebase import SAME_STEPS, Axis, Timing, timing

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


def _spline(x: FloatArray, y: FloatArray, at: FloatArray, where: str) -> FloatArray:
    """Interpolate by a quintic spline."""
    from scipy.interpolate import make_interp_spline

    if len(x) <= _DEGREE:
        raise InputError(
            f"{where}: {len(x)} samples are too few to interpolate; at least {_DEGREE + 1} "
            f"are needed"
        )
    return np.asarray(make_interp_spline(x, y, k=_DEGREE)(at))


def thinned(inputs: ModelInputs, factor: int) -> ModelInputs:
    """The inputs at a rate that is lower by a whole `factor`, for a fit.

    All signals go through the filter of `resample` (`antialias`, zero phase, order 10): what lies
    above half of the new rate would fold back, and noise that is taken away there is information
    that every sample brought. Instants are those of the middle of each group of samples; those that
    do not fill a last one are left out. What has no weight does not spread: its torque is bridged
    first, and a group with any of it is left out.
    """
    if factor == 1:
        return inputs
    names = ("angle", "velocity", "acceleration", "torque")
    given = {name: getattr(inputs, name) for name in names}
    if inputs.torque is not None and inputs.weight is not None:
        given["torque"] = _bridged(inputs.torque, inputs.weight > 0.0)
    present = [name for name, each in given.items() if each is not None]
    rows = np.stack([*(given[name] for name in present), *inputs.second])
    rate_hz = inputs.rate_hz / factor
    chosen = slice(factor // 2, inputs.n // factor * factor, factor)

    def lowered(signals: FloatArray, ends: Ends) -> FloatArray:
        low = antialias(signals, inputs.rate_hz, rate_hz, ends=ends, where=inputs.where)
        return low[:, chosen]

    rates = {"hz": inputs.rate_hz, "to": rate_hz, "edge": ANTIALIAS_PASS * rate_hz}
    mechanical = [read_only(row.copy()) for row in lowered(rows, "odd")]
    thin: dict[str, Any] = dict(zip(present, mechanical, strict=False))
    emg = np.maximum(lowered(inputs.emg.T, "even").T, 0.0)
    weight = None if inputs.weight is None else _lowest_zero(inputs.weight, factor)[chosen]
    return replace(
        inputs,
        **thin,
        rate_hz=rate_hz,
        time=read_only(inputs.time[chosen]),
        emg=read_only(emg),
        weight=None if weight is None else read_only(weight),
        effort=None,
        second=tuple(mechanical[len(present) :]),
        steps=(*inputs.steps, Message("made/decimated", **rates)),
    )


def sampled(inputs: ModelInputs, factor: int) -> ModelInputs:
    """Every `factor`-th sample of the inputs, for a look in which only valleys are told apart.

    Motion and torque are taken as they are, however fast: a model's torque bends with them, and of
    filtered motion it has other valleys. EMG is averaged over the samples around each kept instant,
    which a low-pass activation filter cannot tell from the whole. Samples that do not fill the last
    group are left out.
    """
    from scipy.ndimage import correlate1d

    around = np.ones(factor if factor % 2 else factor + 1)
    if factor % 2 == 0:
        around[[0, -1]] = 0.5

    def every(signal: FloatArray) -> FloatArray:
        return read_only(signal[factor // 2 : inputs.n // factor * factor : factor])

    names = ("time", "angle", "velocity", "acceleration", "torque", "weight")
    given = {name: getattr(inputs, name) for name in names}
    thin: dict[str, Any] = {name: every(each) for name, each in given.items() if each is not None}
    return replace(
        inputs,
        **thin,
        rate_hz=inputs.rate_hz / factor,
        emg=every(correlate1d(inputs.emg, around / factor, axis=0, mode="nearest")),
        second=tuple(map(every, inputs.second)),
        effort=None,
    )


def _bridged(torque: FloatArray, counts: npt.NDArray[np.bool_]) -> FloatArray:
    """A torque whose samples that do not count lie on lines between those that do, shape (n,)."""
    if counts.all() or not counts.any():
        return torque
    at = np.arange(len(torque))
    return np.asarray(np.interp(at, at[counts], torque[counts]))


def _lowest_zero(weight: FloatArray, factor: int) -> FloatArray:
    """Weights, zero where any is that is less than `factor` samples away, half on either side."""
    from scipy.ndimage import minimum_filter1d

    return np.where(minimum_filter1d(weight, factor, mode="nearest") > 0.0, weight, 0.0)


def thinning_factor(inputs: ModelInputs, rate_hz: float, samples: int) -> int:
    """The largest factor that leaves a recording this rate [Hz] and so many samples; at least 1."""
    return max(1, min(int(np.floor(inputs.rate_hz / rate_hz)), inputs.n // samples))


#: Samples on either side of the central window.
HALF_WIDTH = 7

#: Samples of the windows at the ends.
_END_WIDTH = 7

#: Fewest samples that can be differentiated.
MINIMUM_SAMPLES = 2 * HALF_WIDTH + 1


def derivatives(
    angle: FloatArray, rate_hz: float, *, where: str = "angle"
) -> tuple[FloatArray, FloatArray]:
    """First and second time derivative of a uniformly sampled angle.

    The angle [rad] has 15 samples or more; `where` is what the message of an error begins with.
    """
    n = len(angle)
    if n < MINIMUM_SAMPLES:
        raise InputError(
            f"{where}: {n} samples are too few to differentiate; at least {MINIMUM_SAMPLES} "
            f"are needed"
        )
    # Both stencils sum to zero, but only to rounding: without its offset the angle loses no digits.
    centred = angle - angle[0]
    velocity = np.empty(n)
    acceleration = np.empty(n)
    outs = zip((velocity, acceleration), _stencils(), (-1.0, 1.0), strict=True)
    for out, (centre, start), sign in outs:
        out[HALF_WIDTH : n - HALF_WIDTH] = np.convolve(centred, centre[::-1], "valid")
        out[:HALF_WIDTH] = start @ centred[: 2 * HALF_WIDTH]
        # The end is the start of the reversed signal; reversing time turns odd derivatives around.
        reverse = centred[: -2 * HALF_WIDTH - 1 : -1]
        out[n - HALF_WIDTH :] = sign * (start @ reverse)[::-1]
    return velocity * rate_hz, acceleration * rate_hz**2


@cache
def _stencils() -> tuple[tuple[FloatArray, FloatArray], ...]:
    """Weights of the first and second derivative for samples one apart.

    Each inside, shape (15,), and at the first 7 samples, shape (7, 14).
    """
    centre = _weights(np.arange(-HALF_WIDTH, HALF_WIDTH + 1, dtype=np.float64))
    start = np.zeros((3, HALF_WIDTH, 2 * HALF_WIDTH))
    for i in range(HALF_WIDTH):
        width = max(_END_WIDTH, 2 * i + 1)
        start[:, i, :width] = _weights(np.arange(-i, width - i, dtype=np.float64))
    return (centre[1], start[1]), (centre[2], start[2])


def _weights(nodes: FloatArray) -> FloatArray:
    """Fornberg's weights at 0 of value, first and second derivative, shape (3, nodes)."""
    weights = np.zeros((3, len(nodes)))
    weights[0, 0] = 1.0
    orders = np.arange(1.0, 3.0)
    scale = 1.0
    for i in range(1, len(nodes)):
        previous = weights.copy()
        scale_before = scale
        gaps = nodes[i] - nodes[:i]
        scale = float(np.prod(gaps))
        ratio = scale_before / scale
        last = previous[:, i - 1]
        at = nodes[i - 1]
        weights[1:, i] = ratio * (orders * last[:-1] - at * last[1:])
        weights[0, i] = -ratio * at * last[0]
        weights[1:, :i] = (nodes[i] * previous[1:, :i] - orders[:, None] * previous[:-1, :i]) / gaps
        weights[0, :i] = nodes[i] * previous[0, :i] / gaps
    return weights
