"""Time: gaps, jitter, order, and whether the trial is long enough."""

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import listed
from surae.base.units import FloatArray
from surae.quality.finding import Finding, make_finding
from surae.quality.numeric import quantile
from surae.quality.trial import CheckedTrial
from surae.recording import Channel, Recording
from surae.recording.inspection import BY_NAME
from surae.signals.timebase import GAP_STEPS, timing

#: Jitter above this part of a step is worth a warning: the signals are then interpolated, which
#: loses the fastest content, and below it the clock is as good as a logger's.
JITTER = 0.02
#: Jitter from here on makes velocities and accelerations wrong.
BAD_JITTER = 0.25
#: tau_rel lies between 1 and 10 s; three times its usual 5 s show the relaxation and its end. All
#: protocols of the thesis last 18 s or more.
SHORT = 15.0
#: Below one usual tau_rel nothing of it can be seen, and signs and lags can be anything: a fit has
#: more parameters than such a trial tells.
TOO_SHORT = 5.0


def time_axes(recording: Recording) -> Iterator[Finding]:
    """Gaps and jitter in the time stamps, once for channels that share them."""
    seen: list[FloatArray] = []
    for channel in recording.signals.values():
        if not any(np.array_equal(channel.time, other) for other in seen):
            seen.append(channel.time)
            yield from axis_findings(channel)


def axis_findings(channel: Channel) -> Iterator[Finding]:
    """Gaps and jitter of one time axis, which may even go back in time."""
    time = channel.time
    steps = np.diff(time)
    step = float(np.median(steps))
    if step <= 0.0 or len(time) < 8:
        yield _disorder(channel, int((steps <= 0.0).sum()), step)
        return
    # A gap is at least one sample that is missing; jitter alone moves a step by less than that
    # in most samples, so what the usual scatter of steps explains is jitter.
    scatter = quantile(np.abs(steps - step), 0.9)
    longest = max(GAP_STEPS * step, step + 6.0 * scatter)
    explained = _explained(channel)
    # Stamps rounded to whole milliseconds have none.
    gaps = np.flatnonzero(steps > longest) if not explained else np.empty(0, dtype=np.intp)
    lost = float((steps[gaps] - step).sum())
    if gaps.size:
        worst = int(gaps[np.argmax(steps[gaps])])
        yield make_finding(
            "time-gap",
            _name(channel),
            (time[gaps[0]], time[gaps[-1] + 1]),
            lost,
            n=len(gaps),
            start=time[worst],
            end=time[worst + 1],
            ms=1e3 * step,
        )
    if back := int((steps <= 0.0).sum()):
        yield _disorder(channel, back, step)
        return
    jitter = 0.0 if explained else _jitter(time, gaps)
    if jitter > JITTER * step:
        yield make_finding(
            "time-jitter/scatter",
            _name(channel),
            (time[0], time[-1]),
            jitter,
            severity="warning" if jitter < BAD_JITTER * step else "error",
            by=1e3 * jitter,
            ms=1e3 * step,
            percent=100 * jitter / step,
        )


def _jitter(time: np.ndarray, gaps: np.ndarray) -> float:
    """Standard deviation of the stamps about even steps, within pieces without a gap [s]."""
    total = 0.0
    count = 0
    for piece in np.split(time, gaps + 1):
        if len(piece) >= 8:
            index = np.arange(len(piece)) - (len(piece) - 1) / 2
            slope = float(index @ piece / (index @ index))
            total += float(((piece - piece.mean() - slope * index) ** 2).sum())
            count += len(piece)
    return float(np.sqrt(total / max(count, 1)))


def _explained(channel: Channel) -> bool:
    """Whether the stamps are even, but perhaps for their rounding."""
    try:
        return timing(replace(channel, values=channel.time), "").uniform
    except InputError:
        return False


def _disorder(channel: Channel, back: int, step: float) -> Finding:
    return make_finding(
        "time-jitter/expected" if step > 0.0 else "time-jitter/order",
        _name(channel),
        (channel.time.min(), channel.time.max()),
        float(back),
        severity="error",
        unit="1",
        n=back,
        all=len(channel.time),
        ms=1e3 * step,
    )


def _name(channel: Channel) -> str:
    return "time" if channel.role in ("angle", "time") else channel.role


def too_short(recording: Recording) -> Iterator[Finding]:
    """Trials in which the relaxation of tau_rel cannot show."""
    start, end = recording.shared
    if end <= start:
        yield _apart(recording)
        return
    if (seconds := end - start) < SHORT:
        yield make_finding(
            "trial-too-short",
            None,
            (start, end),
            seconds,
            seconds=seconds,
            enough=SHORT,
            advice="trial-too-short/enough",
        )


def _apart(recording: Recording) -> Finding:
    """That channels have no time in common: what no fit can read."""
    last = max(recording.signals.values(), key=lambda c: float(c.time[0]))
    first = min(recording.signals.values(), key=lambda c: float(c.time[-1]))
    begin = float(last.time[0])
    end = float(first.time[-1])
    return make_finding(
        "no-shared-span",
        last.role,
        (end, begin),
        begin - end,
        last=last.role,
        first=first.role,
        begin=begin,
        end=end,
    )


#: What a reader says that it did to samples, as it stands in a channel's source.
_DONE = re.compile(
    r"\d+ unreadable [^;]*bridged by straight lines|times rounded to [^;]*? Hz|"
    r"the header states [^;]*|the file was cut short|row \d+ is incomplete [^;]*|"
    r"from row \d+ on no numbers: [^;]*|its letters are read as [^;]*|"
    r"quoted numbers have decimal commas|the names of the columns are repeated [^;]*|"
    r"(?:two|several) rows of names, read as one|clock [^;]* ppm [^;]*, corrected|"
    r"'[^;]*' is taken as [^;]*|[\d.]+ Hz, as the lines above the names say|"
    r"[\d.]+ Hz, as column '[^;]*' says|its times are those of column '[^;]*'|" + re.escape(BY_NAME)
)


def as_read(trial: CheckedTrial) -> Iterator[Finding]:
    """What was done to samples where they were read, each thing once, counted."""
    channels: dict[str, list[str]] = {}
    for role, channel in trial.recording.channels.items():
        for text in _DONE.findall(channel.source):
            channels.setdefault(text, []).append(role)
    for text, roles in channels.items():
        yield make_finding(
            "as-read",
            roles[0] if len(roles) == 1 else None,
            trial.span,
            None,
            channels=listed(roles),
            done=text,
        )
