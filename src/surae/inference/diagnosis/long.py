"""Recordings of hours: every sample is looked at, and windows are judged as trials are.

What single samples show is looked for in one piece after the other, by what the whole recording
shows of its electrodes. Signs, units, lags and rest need a model of the torque: each window is
judged as a recording of its own, and what is wrong with most of them is wrong with the recording.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from surae.base.words import Message
from surae.quality import Finding, Quality, Skipped, check_samples
from surae.quality.electrodes import Electrodes, electrodes_of, together
from surae.quality.finding import SEVERITIES, make_finding
from surae.quality.registry import OF_SAMPLES, ordered, unfit
from surae.quality.timing import time_axes
from surae.quality.trial import signals_of
from surae.recording import Recording
from surae.signals.windows import liveliest

#: A recording that lasts longer [s] is judged in windows: so many, of that length [s].
LONGEST = 7200.0
#: Samples in a second from which on that may be so: of fewer the unit of time is in question [Hz].
_SLOWEST = 5.0
_COUNT = 8
_SECONDS = 300.0
#: Length of the pieces in which single samples are looked at [s].
_PIECE = 3600.0
#: What a window lacks another may have: it is said of the recording where all windows lack it.
_LACKING = ("active-not-active", "angle-still", "rom-not-covered", "trial-too-short")
#: Clocks run apart later on, and lags have other causes then: the first window says it alone.
_CLOCKS = ("emg-clock", "angle-clock", "torque-clock")
#: What may happen once.
_ONCE = ("mains-hum", "overshoot", "position-steps", "reflex-suspected", "stretch-series")
#: What is found of the whole recording, and so not again in its windows.
_OF_SAMPLES = {code for check in OF_SAMPLES for code in check.codes}
_OF_SAMPLES |= {"time-gap", "time-jitter"}


def is_long(recording: Recording) -> bool:
    """Whether a recording is judged in windows."""
    start, end = recording.shared
    if not end - start > LONGEST or "angle" not in recording.channels:
        return False
    return len(recording.channels["angle"].time) >= _SLOWEST * (end - start)


def examined_in_windows(
    recording: Recording,
    judge: Callable[[Recording, Electrodes | None, bool], Quality],
    electrodes: Electrodes | None,
) -> Quality:
    """All findings of a recording that `is_long`.

    `judge` finds what is wrong with a window, its clocks too where it is asked to: those of later
    windows are looked at only where the first one's drift. `electrodes` are what all trials of the
    leg show of theirs; without them, windows are judged by what the whole recording shows.
    """
    seen = electrodes or together(map(_electrodes, _pieces(recording))) or Electrodes({})
    findings = list(time_axes(recording))
    of_pieces = [check_samples(piece, seen) for piece in _pieces(recording)]
    findings += _once_each(of_pieces, "found/pieces")
    windows = _windows(recording)
    judged = [judge(window, electrodes, True) for window in windows[:1]]
    drifts = any(finding.code in _CLOCKS for each in judged for finding in each.findings)
    judged += [judge(window, electrodes, drifts) for window in windows[1:]]
    findings += _of_windows(judged)
    hours = (recording.shared[1] - recording.shared[0]) / 3600.0
    findings.append(
        make_finding(
            "looked-at-in-windows",
            None,
            recording.shared,
            hours,
            hours=hours,
            n=len(windows),
            minutes=_SECONDS / 60.0,
        )
    )
    skipped: dict[str, Skipped] = {}
    for quality in judged:
        skipped |= {each.check: each for each in quality.skipped if each.check not in skipped}
    codes = {finding.code for finding in findings}
    left = tuple(each for code, each in skipped.items() if code not in codes)
    return Quality(recording.name, ordered(findings), left)


def _pieces(recording: Recording) -> Iterator[Recording]:
    """One piece after the other, where all channels have samples."""
    start, end = recording.shared
    for begin in np.arange(start, end, _PIECE).tolist():
        piece = _part(recording, begin, min(begin + _PIECE, end))
        if all(len(each.time) > 1 for each in piece.signals.values()) and unfit(piece) is None:
            yield piece


def _part(recording: Recording, begin: float, end: float) -> Recording:
    """The part between two times [s], of which no copy is made, unlike `Recording.crop`."""
    parts = {}
    for role, channel in recording.channels.items():
        kept = slice(*np.searchsorted(channel.time, (begin, end)))
        parts[role] = replace(channel, time=channel.time[kept], values=channel.values[kept])
    return replace(recording, channels=parts)


def _electrodes(piece: Recording) -> Electrodes:
    signals = signals_of(piece)
    return electrodes_of(piece, signals.fast, signals.rate_hz)


def _windows(recording: Recording) -> list[Recording]:
    """The first minutes, in which clocks that drift have not run apart, and lively ones later."""
    start, end = recording.shared
    later = _part(recording, start + _SECONDS, end)
    windows = [_part(recording, start, start + _SECONDS), *liveliest(later, _COUNT - 1, _SECONDS)]
    whole = (w for w in windows if all(len(each.time) > 1 for each in w.signals.values()))
    return [window for window in whole if unfit(window) is None]


def _once_each(groups: Iterable[Sequence[Finding]], which: str) -> Iterator[Finding]:
    """Findings of several parts, each code of a channel once: the most severe, over all its time.

    How many parts have it is said where several do.
    """
    every = list(groups)
    alike: dict[tuple[str, str | None], list[Finding]] = {}
    counts: dict[tuple[str, str | None], int] = {}
    for group in every:
        for finding in group:
            alike.setdefault((finding.code, finding.channel), []).append(finding)
        for key in {(finding.code, finding.channel) for finding in group}:
            counts[key] = counts.get(key, 0) + 1
    for key, same in alike.items():
        worst = max(same, key=lambda each: SEVERITIES.index(each.severity))
        says = worst.message
        if counts[key] > 1:
            says = Message(which, says=worst.message, n=counts[key], all=len(every))
        start = min(each.start_s for each in same)
        end = max(each.end_s for each in same)
        yield replace(worst, start_s=start, end_s=end, message=says)


def _of_windows(judged: Sequence[Quality]) -> list[Finding]:
    """What is wrong with enough of the windows."""
    groups = [[f for f in each.findings if f.code not in _OF_SAMPLES] for each in judged]
    most: dict[str, int] = {}
    for group in groups:
        for code in {finding.code for finding in group}:
            most[code] = most.get(code, 0) + 1
    at_first = {f.code for f in groups[0] if f.code in _CLOCKS} if groups else set()

    def holds(code: str) -> bool:
        asked = len(groups) if code in _LACKING else 1 if code in _ONCE else (len(groups) + 1) // 2
        return most[code] >= asked or code in at_first

    kept = [[finding for finding in group if holds(finding.code)] for group in groups]
    return list(_once_each(kept, "found/windows"))
