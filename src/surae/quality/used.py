"""What a fit reads of a recording: the span that its channels share, without what is left out."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from surae.base.formatting import listed
from surae.base.frozen import read_only
from surae.quality.finding import Finding, make_finding
from surae.recording import Recording

#: A channel that goes on for less than this [s] beside the others needs no word.
_BESIDE = 1.0


def used(
    recording: Recording, left_out: Iterable[Sequence[float]] = ()
) -> tuple[Recording, list[Finding]]:
    """The recording as far as a fit reads it, and what to know about the rest.

    `left_out` are windows, start and end [s], that do not count: at an end of the recording they
    are cut off, within it they are bridged, so that no check sees what is in them.
    """
    signals = recording.signals.values()
    start, end = recording.shared
    inside = []
    for first, last, *_ in sorted(map(tuple, left_out)):
        if first <= start:
            start = max(start, last)
        elif last < end:
            inside.append((first, last))
        else:
            end = min(end, first)
    channels = dict(recording.channels)
    beside: dict[str, float] = {}
    for channel in signals:
        kept = slice(*np.searchsorted(channel.time, (start, end + 1e-9)))
        if kept.stop - kept.start < 2:
            return recording, []  # an unfit recording is another finding
        beside[channel.role] = start - float(channel.time[0]) + float(channel.time[-1]) - end
        time = channel.time[kept]
        values = channel.values[kept]
        for first, last in inside:
            gone = (time >= first) & (time <= last)
            if gone.any() and not gone.all():
                values = np.where(gone, np.interp(time, time[~gone], values[~gone]), values)
        if len(time) < len(channel.time) or inside:
            channels[channel.role] = replace(
                channel, time=read_only(time), values=read_only(values)
            )
    more = [role for role, seconds in beside.items() if seconds > _BESIDE]
    if channels == dict(recording.channels) or not more:
        return replace(recording, channels=channels), []
    longest = max(beside.values())
    finding = make_finding(
        "not-used",
        more[0],
        (start, end),
        longest,
        start=start,
        end=end,
        longest=longest,
        channels=listed(more),
    )
    return replace(recording, channels=channels), [finding]
