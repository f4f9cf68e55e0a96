"""Time axes: whether a channel is uniformly sampled, and which axis several channels share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording import Channel
from surae.recording.table import check_samples, rounding

#: A step longer than this many median steps is a gap: at least one sample is missing.
GAP_STEPS = 1.5

#: Time stamps this close to a uniform axis [steps] are uniform.
UNIFORM_STEPS = 1e-3

#: Two instants this close [steps] are the same instant.
SAME_STEPS = 1e-6

#: Significant digits that programs write, and how coarse [steps] stamps of so many may be: a sample
#: that is missing moves those behind it by a step.
_DIGITS = (6, 7, 8)
_COARSEST_WRITTEN = 0.3

#: Stamps rounded more coarsely than this [steps] cannot be told from gaps.
_COARSEST_STAMPS = 0.6


@dataclass(frozen=True, slots=True)
class Axis:
    """A uniform time axis: `n` instants from `start` [s] at `rate_hz`."""

    start: float
    rate_hz: float
    n: int

    @property
    def end(self) -> float:
        """The last instant [s]."""
        return self.start + (self.n - 1) / self.rate_hz

    @property
    def time(self) -> FloatArray:
        """The instants [s], shape (n,)."""
        return self.start + np.arange(self.n) / self.rate_hz


@dataclass(frozen=True, slots=True)
class Timing:
    """How a channel is sampled in time."""

    axis: Axis  #: The uniform axis that fits its time stamps best.
    jitter_s: float  #: Largest distance of a time stamp from that axis [s].
    #: The samples may be taken as lying on `axis`: the stamps do, to a thousandth of a step, or
    #: their rounding to whole decimals (e.g. milliseconds), to six significant digits or to single
    #: precision explains why they do not.
    uniform: bool


def timing(channel: Channel, recording: str) -> Timing:
    """Find the uniform axis of a channel of the recording of that name.

    A gap, a step longer than `GAP_STEPS` median steps, is refused with recording, channel and time.
    """
    time = channel.time
    n = len(channel.time)
    where = f"{recording}: {channel.role}"
    check_samples(time, channel.values, where=recording, names=("time", channel.role))
    steps = np.diff(time)
    step = float(time[-1] - time[0]) / (n - 1)
    index = np.arange(n)
    start = float(time[0])
    jitter = float(np.max(np.abs(time - (start + index * step))))
    if jitter <= UNIFORM_STEPS * step:
        rate = _whole_rate(step, n, UNIFORM_STEPS * step)
        return Timing(Axis(start, rate, n), jitter, uniform=True)

    resolution = rounding(time, _COARSEST_STAMPS * step)
    axis = None if resolution is None else _axis_of_rounded(time, resolution)
    axis = axis or _axis_of_written(time, step)
    if axis is not None:
        return Timing(axis, float(np.max(np.abs(time - axis.time))), uniform=True)

    median = float(np.median(steps))
    longest = int(np.argmax(steps))
    if steps[longest] > GAP_STEPS * median:
        raise InputError(
            f"{where}: no samples from {time[longest]:.6g} to {time[longest + 1]:.6g} s, where one "
            f"every {median:.4g} s is expected; use a part of the recording without a gap"
        )
    return Timing(Axis(start, 1.0 / step, n), jitter, uniform=False)


def common_axis(axes: Sequence[Axis], rate_hz: float, where: str, fewest: int) -> Axis:
    """The axis on which channels with these axes can all be given, without extrapolation.

    Its rate is `rate_hz`, or that of the slowest channel where this is lower; then the axis is the
    slowest channel's own, so that its samples are used as they are.
    """
    first = max(axis.start for axis in axes)
    last = min(axis.end for axis in axes)
    if last <= first:
        raise InputError(
            f"{where}: the channels share no span of time: one begins at {first:g} s, when another "
            f"has ended at {last:g} s; check that the files belong to the same trial"
        )
    slowest = min(axes, key=lambda axis: axis.rate_hz)
    start = first
    if slowest.rate_hz <= rate_hz * (1.0 + SAME_STEPS):
        rate_hz = slowest.rate_hz
        skipped = int(np.ceil((first - slowest.start) * rate_hz - SAME_STEPS))
        start = slowest.start + skipped / rate_hz
    n = int(np.floor((last - start) * rate_hz + SAME_STEPS)) + 1
    if n < fewest:
        raise InputError(
            f"{where}: the channels share only {n} samples at {rate_hz:g} Hz ({first:g} to "
            f"{last:g} s); at least {fewest} are needed"
        )
    return Axis(start, rate_hz, n)


def _whole_rate(step: float, n: int, tolerance: float) -> float:
    """The roundest rate [Hz] that moves the last of `n` instants by at most `tolerance` [s]."""
    for decimals in range(4):
        rate = round(1.0 / step, decimals)
        if rate > 0.0 and (n - 1) * abs(1.0 / rate - step) <= tolerance:
            return rate
    return 1.0 / step


def _axis_of_rounded(time: FloatArray, resolution: float) -> Axis | None:
    """A uniform axis that becomes `time` when rounded to `resolution`; None if there is none.

    Such an axis leaves a band no wider than one `resolution` around the stamps, whereas a missing
    sample makes every band nearly one step wide, which is more (`_COARSEST_STAMPS`).
    """
    from scipy.optimize import minimize_scalar

    n = len(time)
    index = np.arange(n) - (n - 1) / 2
    slope = float(index @ time / (index @ index))

    def width(step: float) -> float:
        return float(np.ptp(time - step * index))

    # Rounding by half a resolution bends the least-squares slope by at most 1.5 resolutions / n.
    reach = 2.0 * resolution / n
    best = slope + float(
        minimize_scalar(
            lambda bend: width(slope + bend),
            bounds=(-reach, reach),
            method="bounded",
            options={"xatol": 1e-5 * reach},
        ).x
    )
    widest = resolution * (1.0 + 1e-3)
    if width(best) > widest:
        return None
    whole = _whole_rate(best, n, resolution)
    rate = whole if width(1.0 / whole) <= widest else 1.0 / best
    left = time - index / rate
    middle = float(left.max() + left.min()) / 2
    return Axis(middle - (n - 1) / 2 / rate, rate, n)


def _axis_of_written(time: FloatArray, step: float) -> Axis | None:
    """A uniform axis that becomes `time` when written with few digits; None if there is none.

    Six significant digits, or single precision, are coarser the later a stamp is: each has its own
    resolution, and none may lie further from the axis.
    """
    coarse = _written_resolution(time)
    if coarse is None or float(coarse.max()) > _COARSEST_WRITTEN * step:
        return None
    n = len(time)
    index = np.arange(n) - (n - 1) / 2
    weight = 1.0 / np.maximum(coarse, 1e-3 * float(coarse.max()))
    slope, middle = (float(c) for c in np.polyfit(index, time, 1, w=weight))
    whole = _whole_rate(slope, n, float(coarse.min()))
    for rate in (whole, 1.0 / slope):
        start = middle - (n - 1) / 2 / rate
        left = time - (start + np.arange(n) / rate)
        if bool(np.all(np.abs(left) <= coarse)):
            return Axis(start, rate, n)
    return None


def _written_resolution(time: FloatArray) -> FloatArray | None:
    """What each stamp was rounded to [s], where few digits explain all of them."""
    single = time.astype(np.float32)
    if np.array_equal(single.astype(np.float64), time):
        return np.asarray(np.spacing(np.abs(single)), dtype=np.float64)
    size = np.abs(time)
    decade = np.floor(np.log10(np.where(size > 0.0, size, 1.0)))
    for digits in _DIGITS:
        resolution = 10.0 ** (decade - digits + 1)
        scaled = time / resolution
        if float(np.max(np.abs(scaled - np.round(scaled)))) < 1e-4:
            return np.asarray(resolution, dtype=np.float64)
    return None
