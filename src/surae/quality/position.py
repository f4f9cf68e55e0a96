"""The angle: unit, range, and whether it follows the profile that was commanded."""

from collections.abc import Iterator, Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.quality.finding import Finding, Unjudged, make_finding
from surae.quality.numeric import (
    IndexArray,
    digit_of,
    equal_runs,
    held_for,
    quantile,
    runs,
    smooth,
    span_of,
)
from surae.quality.trial import RATE, CheckedTrial, Signals, to_radians
from surae.recording import Recording

#: No ankle goes further than this from neutral [rad]: 63° up, 92° down.
HIGHEST = 1.1
LOWEST = -1.6
#: Range of motion that determines the passive parameters [rad]: 60 % of the healthy 1.5 rad.
ROM = 0.9
#: Below this, not even the optimal lengths are determined.
SMALL_ROM = 0.6
#: Share of the commanded range that must be reached.
REACHED = 0.9
#: Departure from the commanded profile as a part of its span. Clean virtual trials keep to 0.006 of
#: a recognised profile; the thesis's overshoots were seen by eye.
DEPARTURE = 0.015
#: Range [rad], time [s] and bandwidth [Hz] of small random perturbations: a held foot trembles by
#: less.
PERTURBED = (0.01, 0.175)
PERTURBED_S = 20.0
PERTURBED_HZ = 5.0
#: They go on: most stretches of so many seconds have this part of the least range, where a foot
#: that is put in its place has moved once.
_GOES_ON_S = 2.0
_GOES_ON = 0.5
#: Least speed [rad/s] and range [rad] of a stretch, and its hold [s], as in `surae.nerve`; speed of
#: a fast one [rad/s] (Tardieu's V3: as fast as possible), and a slow one's part of it.
RAMP = (0.035, 0.087, 0.2)
FAST = 1.7
SLOWER = 0.4
#: Time before a stretch [s] in which a relaxed muscle shows little more than it mostly does: less
#: than this part of its largest EMG.
RESTS = 0.3
AT_REST = 0.15
#: Overshoot of a movement as a part of it, where no profile is known, and the least [rad].
OVERSHOOT = 0.04
LEAST = 0.012
#: What goes further beyond (a damping of 0.15 makes so much), or stays there for longer [s] (half a
#: period of 1.5 Hz, the slowest ringing that is meant), was sent there and back.
RINGS = 0.62
RINGS_S = 0.33
#: A jump of the angle [rad] that is no encoder's step...
JUMP = 0.012
#: ...and is so many times the movement of the samples around it, and stays: the middle of samples
#: of so long [s], five at least, after it is as far away by half of it.
_ALONE = 8.0
_STAYS_S = 0.04
#: Values that are kept for longer [s] are no slower clock's, but a device's that stands still.
_HELD_S = 0.05


def units(trial: CheckedTrial) -> Iterator[Finding]:
    """An angle that no ankle reaches: `surae.inference.diagnosis` says what it may be."""
    channel = trial.recording.channels["angle"]
    low = float(channel.values.min())
    high = float(channel.values.max())
    if high > HIGHEST or low < LOWEST:
        yield make_finding(
            "angle-units",
            "angle",
            trial.span,
            max(abs(low), abs(high)),
            joint=trial.joint,
            low=low,
            high=high,
        )


def perturbing(angle: FloatArray, rate: float) -> bool:
    """Whether a movement is small, broad-band and goes on: a perturbation, no trial of a fit."""
    if not PERTURBED[0] < float(np.ptp(angle)) < PERTURBED[1] or len(angle) < PERTURBED_S * rate:
        return False
    smoothed = smooth(angle, 3)
    size = max(round(_GOES_ON_S * rate), 1)
    pieces = smoothed[: len(smoothed) // size * size].reshape(-1, size)
    if np.median(np.ptp(pieces, axis=1)) < _GOES_ON * PERTURBED[0]:
        return False
    power = np.abs(np.fft.rfft(np.diff(smoothed) * np.hanning(len(smoothed) - 1))) ** 2
    speed = np.cumsum(power)
    f = np.fft.rfftfreq(len(smoothed) - 1, 1.0 / rate)
    noise = float(np.std(np.diff(angle))) > 0.5 * float(np.std(angle))
    return not noise and float(f[np.searchsorted(speed, 0.95 * speed[-1])]) > PERTURBED_HZ


def is_perturbed(recording: Recording) -> bool:
    """Whether a recording with torque is one of small random perturbations."""
    channels = recording.channels
    if "torque" not in channels or "angle" not in channels:
        return False
    angle = channels["angle"]
    width = max(round(angle.rate_hz / RATE), 1)  # as checks look at it
    moved = smooth(angle.values * to_radians(angle), width)[::width]
    return perturbing(moved, angle.rate_hz / width)


def range_of_motion(trial: CheckedTrial) -> Iterator[Finding]:
    """A range too small to tell the parameters, or smaller than was commanded."""
    span = float(np.ptp(trial.angle))
    low = float(trial.angle.min())
    high = float(trial.angle.max())
    given = trial.commanded is not None and trial.commanded.given
    moved = float(np.ptp(trial.commanded.angle)) if trial.commanded is not None and given else 0.0
    missed = moved > 0.0 and span / moved < REACHED
    if span >= ROM and not missed:
        return
    which = "rom-not-covered/commanded" if missed else "rom-not-covered"
    if trial.torque is not None and perturbing(trial.angle, trial.rate_hz):
        which = "rom-not-covered/perturbed"
    yield make_finding(
        which,
        "angle",
        trial.span,
        span,
        severity="warning" if span < SMALL_ROM or missed else "info",
        degrees=np.rad2deg(span),
        low=np.rad2deg(low),
        high=np.rad2deg(high),
        percent=100 * (span / moved) if missed else 0.0,
    )


def stretches(trial: CheckedTrial) -> Iterator[Finding]:
    """Slow and fast ramps of a relaxed foot that end in holds: they tell tissue from nerve."""
    speeds = relaxed_speeds(trial)
    if slow_and_fast(speeds):
        yield make_finding(
            "stretch-series",
            "angle",
            trial.span,
            np.rad2deg(max(speeds)).item(),
            n=len(speeds),
            low=np.rad2deg(min(speeds)),
            high=np.rad2deg(max(speeds)),
        )


def relaxed_speeds(trial: Signals) -> list[float]:
    """Speeds of ramps that end in holds [rad/s]; none without torque or of a leg that is tense."""
    speeds: list[float] = []
    relaxed = 0
    usual = [
        (envelope, 2.0 * quantile(envelope, 0.25) + AT_REST * quantile(envelope, 0.999))
        for envelope in trial.fast.values()
    ]
    velocity = np.gradient(smooth(trial.angle, 3), 1.0 / trial.rate_hz)
    for begin, end in runs(velocity > RAMP[0]):
        held = velocity[end : end + round(RAMP[2] * trial.rate_hz)]
        moved = trial.angle[end - 1] - trial.angle[begin]
        if moved > RAMP[1] and np.all(np.abs(held) < 4.0 * RAMP[0]):
            speeds.append(float(np.median(velocity[begin:end])))
            before = slice(max(begin - round(RESTS * trial.rate_hz), 0), begin + 1)
            relaxed += all(envelope[before].mean() <= most for envelope, most in usual)
    return speeds if trial.torque is not None and relaxed >= 0.9 * len(speeds) else []


def slow_and_fast(speeds: Sequence[float]) -> bool:
    """Whether two stretches at least are fast, and two much slower [rad/s]."""
    fast = sum(speed > FAST for speed in speeds)
    return fast >= 2 and sum(speed < SLOWER * max(speeds) for speed in speeds) >= 2


def steps(trial: CheckedTrial) -> Iterator[Finding]:
    """Jumps of the position after which it stays (thesis 4.4: steps instead of the profile).

    Spikes of a sensor, a recorder's digits and values of a slower clock are no steps.
    """
    channel = trial.recording.channels["angle"]
    kept = held_for(channel.values)
    kept = kept if kept <= _HELD_S * channel.rate_hz else 1
    first = equal_runs(channel.values)[0] if kept > 1 else slice(None)
    angle = channel.values[first] * to_radians(channel)
    time = channel.time[first]
    size = np.abs(np.diff(angle))
    # A jump may fall on two samples; the two next to it are not looked at.
    around = np.lib.stride_tricks.sliding_window_view(np.pad(size, 5, mode="edge"), 11)
    beside = np.maximum(around[:, :3].max(axis=1), around[:, 8:].max(axis=1))
    jumps = np.flatnonzero((size > JUMP) & (size > _ALONE * beside))
    gaps = np.diff(time)
    jumps = jumps[gaps[jumps] < 1.5 * float(np.median(gaps))]
    digit = digit_of(angle)
    fine = jumps[size[jumps] > 1.5 * digit]
    width = max(round(_STAYS_S * channel.rate_hz / kept), 5)
    real = [jump for jump in fine.tolist() if _moved(angle, jump, width) > 0.5 * size[jump]]

    def found(which: str, at: IndexArray) -> Finding:
        """A finding on jumps, or on the whole channel where there are none."""
        return make_finding(
            f"position-steps{which}",
            "angle",
            (time[at[0]], time[at[-1] + 1]) if len(at) else trial.span,
            float(size[at].max(initial=0.0)),
            severity="info" if which else "error",
            advice="position-steps/recorded" if which else "",
            n=len(at),
            size=float(size[at].max(initial=0.0)),
            degrees=float(np.rad2deg(size[at].max(initial=0.0))),
            hz=channel.rate_hz / kept,
        )

    if real:
        yield found("", np.array(real))
    elif fine.size:
        yield found("/spikes", fine)
    elif jumps.size:
        yield found("/digits", jumps)
    elif kept > 1:
        yield found("/held", jumps)


def _moved(angle: FloatArray, jump: int, width: int) -> float:
    """How far the angle lies after a jump from where it was before, but for its own movement.

    By the middle of samples on both sides, and of their steps: a spike changes neither.
    """
    before = angle[max(jump - width + 1, 0) : jump + 1]
    after = angle[jump + 2 : jump + 2 + width]
    if min(len(before), len(after)) < 2:
        return 0.0
    speed = float(np.median(np.concatenate([np.diff(before), np.diff(after)])))
    apart = 0.5 * (len(before) + len(after)) + 1.0
    return abs(float(np.median(after) - np.median(before)) - speed * apart)


def overshoot(trial: CheckedTrial) -> Iterator[Finding]:
    """A position beyond or beside the profile that was commanded."""
    if trial.commanded is not None:
        yield from _departure(trial)
        return
    holds, shot = _ringing(trial.angle, trial.time, trial.rate_hz)
    if holds == 0:
        raise Unjudged(
            "No commanded profile is given or recognised, and no movement ends in a hold."
        )
    if shot:
        sizes, begins, ends = zip(*shot, strict=True)
        yield make_finding(
            "overshoot/movements",
            "angle",
            (min(begins), max(ends)),
            max(sizes),
            n=len(shot),
            size=max(sizes),
        )


def _departure(trial: CheckedTrial) -> Iterator[Finding]:
    """How far the angle lies from the commanded one, once a constant delay is allowed for."""
    commanded = trial.commanded
    assert commanded is not None
    first = float(commanded.time[0])
    last = float(commanded.time[-1])
    inside = (trial.time >= first) & (trial.time <= last)
    if float(inside.mean()) < 0.5:
        raise Unjudged(f"{commanded.name} covers less than half of the trial.")
    time = trial.time[inside]
    if commanded.given:
        asked = (commanded.time, commanded.angle)
        delays = np.arange(0.0, 0.11, 0.01)
        apart = (trial.angle[inside] - np.interp(time - delay, *asked) for delay in delays)
        best = min(apart, key=lambda left: float(np.mean(left**2)))
    else:
        # A recognised profile was fitted to the angle's own samples.
        channel = trial.recording.channels["angle"]
        measured = channel.values[np.searchsorted(channel.time, commanded.time)]
        best = (measured - commanded.angle) * to_radians(channel)
        time = commanded.time
    span = float(np.ptp(trial.angle))
    left = np.abs(best)
    wrong = left > DEPARTURE * span
    if not commanded.given:
        # The ends of a filtered profile are not known as exactly as the rest.
        wrong &= (time > time[0] + 0.3) & (time < time[-1] - 0.3)
    if float(wrong.sum()) * float(np.median(np.diff(time))) < 0.03:
        return
    where = np.flatnonzero(wrong)
    size = float(left[wrong].max())
    yield make_finding(
        "overshoot/profile",
        "angle",
        span_of(time, where),
        size,
        # a profile that was only recognised may be another one
        severity="error" if commanded.given and size >= 0.1 * span else "warning",
        profile=commanded.name,
        size=size,
        percent=100 * size / span,
    )


def _ringing(
    angle: FloatArray, time: FloatArray, rate: float
) -> tuple[int, list[tuple[float, float, float]]]:
    """How many fast movements end in a hold; of those that shot past it: how far [rad], when."""
    velocity = np.gradient(smooth(angle, round(0.05 * rate)), 1.0 / rate)
    still = smooth(np.abs(velocity), round(0.3 * rate)) < 0.05
    holds = 0
    shot = []
    for begin, end in runs(still):
        if (end - begin) < 0.3 * rate:
            continue
        before = slice(max(begin - round(1.5 * rate), 0), begin + round(0.15 * rate))
        rest = float(np.median(angle[begin + (end - begin) // 2 : end]))
        piece = angle[before]
        moved = rest - float(piece[0])
        if abs(moved) < 0.1:
            continue
        holds += 1
        past = np.sign(moved) * (piece - rest)
        beyond = float(past.max())
        peak = int(past.argmax())
        if not max(OVERSHOOT * abs(moved), LEAST) < beyond < RINGS * abs(moved):
            continue
        first, last = next(run for run in runs(past > 0.1 * beyond) if run[0] <= peak < run[1])
        if last - first < RINGS_S * rate:
            shot.append((beyond, float(time[before][0]), float(time[begin])))
    return holds, shot
