"""Which column holds the times, and in which unit: by its name, or by its shape where none says it.

A name says it where all of its words are words of the time, in one of eight languages, or units of
it (``Czas [s]``, ``Time_us``, ``millis``). Where no name does, a column is offered as the time
whose numbers rise in nearly even steps; its unit is then what makes the sampling rate one that
laboratories have.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.units import FACTORS, FloatArray, clock_seconds, clock_units, plain, spelled
from surae.recording.roles import TIMES, WORDS, words_of
from surae.recording.table import Clock, Column, Table, regular, some

_TIME, _BESIDE, _PART = (set(WORDS[each]) for each in ("time", "beside_time", "part_of_movement"))
#: A name, and the unit in brackets, behind a comma or as its last word.
_WITH_UNIT = re.compile(
    r"(?P<name>.*?)\s*(?:[(\[]\s*(?P<in>[^()\[\]]{1,20}?)\s*[)\]]|[,:]\s*(?P<behind>[^\s,:]+))\s*"
)
#: What stands in brackets where a column has times of day or of a stopwatch.
_OF_CLOCK = re.compile(
    r"(?:h{1,2}:)?m{1,2}:s{1,2}(?:[.,:][a-z0]{1,9})?|h{1,2}:m{1,2}", re.IGNORECASE
)
_LAST = re.compile(r"(?P<name>.*[^\W_])[_ ](?P<in>[^\W_]+)")
#: What clocks show between the years 2000 and 2050, by their unit: from 1970 on, .NET's ticks of
#: 100 ns from the year 1.
_SINCE_1970 = (9.46e8, 2.53e9)
_EPOCHS = {
    unit: (_SINCE_1970[0] / FACTORS["time"][unit], _SINCE_1970[1] / FACTORS["time"][unit])
    for unit in ("s", "ms", "us", "ns")
} | {"100ns": (6.307e17, 6.465e17)}
#: Rates [Hz] at which laboratories sample angle, torque and EMG.
_SLOWEST, _FASTEST = 10.0, 50_000.0
#: So many samples show a shape, at least and at most.
_FEWEST = 8
#: Units in which a step alone is never told from others.
_NEVER_BY_SHAPE = ("min", "h", "100ns")
LOOKED_AT = 2000
#: A step may be so many of the median: a logger's steps differ, a count that was lost is a gap.
_UNEVEN = 0.5


#: Seconds of a day.
_DAY = 86400.0
_Key = TypeVar("_Key")


def split_unit(name: str) -> tuple[str, str]:
    """A column's name without its unit of time, and that unit; the unit is empty if it has none."""
    for pattern in (_WITH_UNIT, _LAST):
        if (match := pattern.fullmatch(name.strip())) is None:
            continue
        inside = next(text for key, text in match.groupdict().items() if key != "name" and text)
        if (unit := spelled(inside)) in FACTORS["time"]:
            return match["name"], str(unit)
    return name, ""


def is_clocks(unit: str) -> bool:
    """Whether what stands for a unit says how a time of day is written: ``hh:mm:ss``."""
    return _OF_CLOCK.fullmatch(unit) is not None


def unit_in_name(name: str) -> str:
    """What a name says in brackets where a unit would be; empty where it has none."""
    match = _WITH_UNIT.fullmatch(name.strip())
    return "" if match is None else str(match["in"] or match["behind"] or "")


def time_named(name: str) -> Clock | None:
    """The clock that a column is by its name; None where its name says none."""
    if "%" in name.removeprefix("%time"):
        return None
    bare, unit = split_unit(name)
    other = "" if unit else unit_in_name(name)
    if is_clocks(other):
        bare, other = name.partition(other)[0], ""
    words = words_of(bare)
    alone = spelled(plain(bare).strip(" _%"))
    if not unit and alone in FACTORS["time"] and len(words) == 1 and len(words[0]) > 2:
        return Clock(name, str(alone), "its name is a unit of time")  # Seconds, millis
    if other and other.casefold() not in _BESIDE:
        return None
    if words == ("t",) or (words and {*words} <= _TIME | _BESIDE and {*words} & _TIME):
        return Clock(name, unit, "its name")
    return None


def is_time(name: str) -> bool:
    """Whether a column's name is one of the time."""
    return time_named(name) is not None


def is_percent(name: str) -> bool:
    """Whether a column's name says part of a movement, in percent."""
    words = {*words_of(name)}
    percent = "%" in name or bool(words & {"percent", "procent", "prozent", "percentage"})
    stretched = "time" in words and bool(words & {"normalised", "normalized"})
    return stretched or (percent and (bool(words & _PART) or not words))


def is_part_of_movement(name: str) -> bool:
    """Whether a column's name has a word for a cycle or a phase in it."""
    return bool({*words_of(name)} & (_PART - {"time"}))


def time_column(names: Sequence[str], where: str) -> Clock | None:
    """The column of times by the names of all; None where none says it.

    Two of our own are refused, as is a movement in percent as the first column. The thesis's t and
    T are time and torque.
    """
    ours = [name for name in names if name in TIMES]
    if len(ours) > 1:
        raise InputError(f"{where}: columns {some(ours)} are all the time; keep one")
    if ours:
        return Clock(ours[0], ours[0].removeprefix("time_"), "a name of surae's own format")
    for name in names:
        if name.startswith("time_"):
            seconds(name[5:], name, where)
    clocks = [clock for name in names if (clock := time_named(name)) is not None]
    if {"t", "T"} <= {clock.column.strip() for clock in clocks}:
        clocks = [clock for clock in clocks if clock.column.strip() != "T"]
    if clocks:
        return clocks[0]
    for name in names[:1]:
        if is_percent(name):
            seconds("%", name, where)
    for name in names:
        bare = {*words_of(name.partition("(")[0].partition("[")[0])}
        if (other := unit_in_name(name)) and bare and bare <= _TIME:
            seconds(other, name, where)
    return None


def seconds(unit: str, name: str, where: str) -> float:
    """Factor from a unit of the time to seconds.

    Raises
    ------
    InputError
        It is no unit of time.
    """
    known = FACTORS["time"].get(spelled(unit) or "")
    if known is None:
        if "%" in unit or "percent" in unit:
            raise InputError(
                f"{where}, column {name!r}: a movement in percent has no speed; give the recording "
                "as it was measured, with its times"
            )
        raise InputError(
            f"{where}, column {name!r}: unit {unit!r} is not known for time; use "
            "time_s or time_ms, time_us, time_ns, time_min or time_h"
        )
    return known


def time_by_shape(columns: Mapping[str, FloatArray]) -> Clock | None:
    """The clock that one of the columns is by its shape; None where none or several are.

    It rises from sample to sample in steps that are nearly even. A count of samples (steps of one)
    is none.
    """
    rising = {name: steps for name, v in columns.items() if (steps := _steps(v)) is not None}
    clocks = []
    for name, step in rising.items():
        since = unit_since_epoch(columns[name]) or split_unit(name)[1]
        units = [since] if since else [u for u in clock_units() if u not in _NEVER_BY_SHAPE]
        clocks += [
            Clock(name, unit, f"it rises in nearly even steps, {1 / seconds:.4g} Hz in {unit}")
            for unit in units
            if (step != 1.0 or since)
            and _SLOWEST <= 1.0 / (seconds := step * clock_units()[unit]) <= _FASTEST
        ]
    first = next(iter(columns), "")
    if len(rising) > 1 and first in rising:  # a command may rise evenly too
        clocks = [clock for clock in clocks if clock.column == first]
    elif len(rising) != 1:
        return None
    return clocks[0] if clocks else None


def unit_since_epoch(values: FloatArray) -> str:
    """The unit in which numbers are the time since 1970 (or .NET's year 1); empty where none is."""
    first = float(values[0]) if len(values) else 0.0
    return next((unit for unit, (low, high) in _EPOCHS.items() if low <= first <= high), "")


def counted(columns: Mapping[str, FloatArray]) -> str:
    """The column that counts samples; empty where none does."""
    return next((name for name, v in columns.items() if _steps(v) == 1.0), "")


def counts(values: FloatArray) -> bool:
    """Whether numbers rise by one from sample to sample, also where a counter begins again."""
    if len(values) < _FEWEST or not np.isfinite(values).all():
        return False
    steps = np.diff(values)
    return bool((steps == 1.0).mean() > 0.98 and ((steps == 1.0) | (steps < 0.0)).all())


def rises_in_percent(values: FloatArray) -> bool:
    """Whether numbers go from 0 to 100, or to 1, in even steps."""
    falls = np.flatnonzero(np.diff(values) < 0.0)
    if len(falls):  # the first of several cycles
        values = values[: falls[0] + 1]
    step = _steps(values)
    whole = step is not None and len(values) <= LOOKED_AT
    return (
        whole
        and abs(values[0]) < 1.5 * (step or 0)
        and min(abs(values[-1] - end) for end in (100.0, 1.0)) < 1e-6
    )


def rises_evenly(values: FloatArray) -> bool:
    """Whether numbers rise from sample to sample in nearly even steps."""
    return _steps(values) is not None


def _steps(values: FloatArray) -> float | None:
    """The median step of what rises nearly evenly; None for anything else."""
    if len(values) < _FEWEST or not np.isfinite(values).all():
        return None
    steps = np.diff(values)
    median = float(np.median(steps))
    near = np.abs(steps - median) <= _UNEVEN * median
    # Resting signals step by nothing; a start or a gap may be long.
    if not ((steps > 0.0).all() and near.mean() > 0.9):
        return None
    return 1.0 if bool((steps == 1.0).all()) else float(steps[near].mean())


def timed_by(table: Table, column: str, unit: str | None, where: str) -> Table:
    """The table with the times in a column of it, in a unit that its name may say.

    Raises
    ------
    InputError
        There is no such column, or its unit is none of time.
    """
    if column not in (*table.names, table.time_name):
        raise InputError(
            f"{where}: time: {table.file} has no column {some([column])}; it has: "
            f"{some(table.names)}"
        )
    said = unit or table.units.get(column) or split_unit(column)[1]
    factor = clock_seconds(said or "s")
    if factor is None:
        raise InputError(
            f"{where}: time: {table.file} says {said!r} for column {column!r}, which is no unit of "
            f'time; write {{ column = "{column}", unit = … }} with one of: '
            f"{', '.join(clock_units())}"
        )
    if table.retimed is not None:
        return table.retimed(column, said)
    if column == table.time_name:
        return _scaled(table, factor) if unit and factor != 1.0 else table

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = table.load(list(dict.fromkeys((*wanted, column))))
        clock = loaded[column]
        seconds, remark = regular(clock.values * factor)
        seconds = freeze(np.array(seconds))
        made = {}
        for name in wanted:
            each = loaded[name]
            if len(each.values) != len(seconds):
                raise InputError(
                    f"{where}: time: column {column!r} of {table.file} has {len(seconds)} samples, "
                    f"{name!r} {len(each.values)}; give that channel a time of its own"
                )
            said = "; ".join(filter(None, (each.remark, remark)))
            made[name] = replace(each, time=seconds, time_name=column, remark=said)
        return made

    names = tuple(name for name in table.names if name != column)
    return replace(table, names=names, time_name=column, load=load, offered=None)


def on_one_clock(columns: Mapping[_Key, Column]) -> dict[_Key, Column]:
    """Columns of several files with times of day: the earliest begins at 0 s, others later.

    Columns whose times are no clock's stay as they are.
    """
    days = [column.clock_s for column in columns.values() if column.clock_s is not None]
    if len(set(days)) < 2:
        return dict(columns)
    first = min(days)
    if max(days) - first > _DAY / 2:  # some begin after midnight
        first = min(day for day in days if day > max(days) - _DAY / 2)
    made = dict(columns)
    for name, column in columns.items():
        if column.clock_s is None or not (late := (column.clock_s - first) % _DAY):
            continue
        said = f"it begins {late:.6g} s after the other file's, by their clocks"
        remark = "; ".join(filter(None, (column.remark, said)))
        made[name] = replace(column, time=freeze(column.time + late), remark=remark)
    return made


def _scaled(table: Table, factor: float) -> Table:
    """The table whose times are multiplied by a factor."""

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = table.load(wanted)
        return {name: replace(c, time=freeze(c.time * factor)) for name, c in loaded.items()}

    return replace(table, load=load)
