"""Tables of several devices side by side, each of which has a column of times before its own.

A second column of times between signals is that of those behind it, where its name says a device
(`emg time`) and it does not merely say the first one's instants in other words. Rows that were
logged together on one clock have their times once, or twice with a constant between them.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.recording.roles import WORDS, words_of
from surae.recording.table import Clock
from surae.recording.times import rises_evenly, split_unit, unit_since_epoch

_TIME, _BESIDE = (set(WORDS[each]) for each in ("time", "beside_time"))
#: Times that differ by less than this part of a step are the same.
_SAME = 0.5


def clocks_behind(
    names: Sequence[str], first: Clock, columns: Mapping[str, FloatArray]
) -> dict[str, Clock]:
    """The clock of every column that has another than the first; empty where all have that one.

    `columns` are the first numbers of each column with a name.
    """
    instants = columns.get(first.column)
    if instants is None or not len(instants) or first.column not in names:
        return {}
    at = names.index(first.column)
    current: Clock | None = None
    of: dict[str, Clock] = {}
    signals = 0
    for name in names[at + 1 :]:
        clock = _clock(name, columns.get(name)) if signals else None
        if clock is not None:
            same = _same(instants * first.in_seconds, columns[name] * clock.in_seconds)
            current = None if same else clock
        elif name:
            signals += 1
            if current is not None:
                of[name] = current
    return of


def _clock(name: str, values: FloatArray | None) -> Clock | None:
    """The clock that a column is, by a word of the time in its name beside a device's."""
    bare, unit = split_unit(name)
    words = {*words_of(bare)}
    device = words - _TIME - _BESIDE
    if values is None or not words & _TIME or not device:
        return None
    if not rises_evenly(values):
        return None
    unit = unit or unit_since_epoch(values) or "s"
    return Clock(name, unit, "a time of its own, by its name and place")


def _same(one: FloatArray, other: FloatArray) -> bool:
    """Whether two columns say the same instants, in units that are known."""
    n = min(len(one), len(other))
    step = float(np.median(np.diff(one[:n]))) if n > 1 else 0.0
    return bool(np.abs(one[:n] - other[:n]).max() <= _SAME * abs(step))
