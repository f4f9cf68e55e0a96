"""A raw column becomes a channel: its unit settled, its scaling applied, its samples checked."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.units import FACTORS, SI, FloatArray, Stated, kind, plain, spelled, stated, to_si
from surae.recording.described import LONGEST_BRIDGE_S
from surae.recording.recording import FILM_ROLES, Channel
from surae.recording.roles import heading_unit, unknown_unit
from surae.recording.table import GAPS, Column, IndexArray, Table, check_finite, check_samples


@dataclass(frozen=True, slots=True)
class Scaling:
    """How raw values become SI: ``sign * (scale * raw + offset) * factor of the unit``.

    `scale` and `offset` bring the raw values to `unit` (an amplifier's gain, counts to volts);
    `sign` is -1 where the file counts the other direction as positive; `offset_note` says where an
    offset that was not given comes from.
    """

    unit: str
    sign: int = 1
    scale: float = 1.0
    offset: float = 0.0
    offset_note: str = ""
    bridge_s: float = 0.0  #: Longest gap [s] that a straight line fills.

    def describe(self) -> str:
        """What is applied, for the channel's source."""
        parts = [f"[{self.unit}]"]
        if self.scale != 1:
            parts.append(f"scale {self.scale:g}")
        if self.offset != 0:
            parts.append(self.offset_note or f"offset {self.offset:g}")
        if self.sign != 1:
            parts.append("sign reversed")
        return ", ".join(parts)


def written_unit(table: Table, name: str, role: str | None = None) -> str | None:
    """The unit that the file states for a column, in its own spelling; its name counts last."""
    of_kind = None if role is None else table.units_of_kind.get(kind(role))
    return table.units.get(name) or of_kind or heading_unit(name) or unknown_unit(name)


def stated_unit(table: Table, role: str, name: str) -> Stated | None:
    """What the file itself states a column used as `role` to be in; None where that is unknown."""
    unit = stated(written_unit(table, name, role))
    return unit if unit is not None and unit.kind == kind(role) and unit.unit else None


def settle_unit(table: Table, role: str, name: str, unit: str | None, where: str) -> str:
    """The unit of a column: as described by its user, else as stated by the file.

    It is refused where neither says it, it isn't known, or the two disagree. An EMG described as
    ``"1"`` has been normalised by its user and may disagree.
    """
    of_file = stated_unit(table, role, name)
    text = written_unit(table, name, role)
    ours = of_file is not None and of_file.scale == 1.0 and not of_file.per_kg
    if unit is None:
        if of_file is not None and ours:
            return of_file.unit
        says = "states none" if text is None else f"says {text!r}"
        means = (
            f": unit = {of_file.unit!r}, scale = {of_file.scale:.6g}" if of_file is not None else ""
        )
        means += " times the body's mass in kg" if of_file is not None and of_file.per_kg else ""
        allowed = ", ".join(FACTORS[kind(role)])
        raise InputError(
            f"{where}: unit is missing and {table.file} {says} for column {name!r}; "
            f"write {means[2:] or f'one of: {allowed}'}"
        )
    unit = spelled(unit) or plain(unit)
    to_si(role, unit, where)
    if of_file is not None and ours and unit not in (of_file.unit, "1"):
        raise InputError(
            f"{where}: unit {unit!r} contradicts {table.file}, which states {of_file.unit!r} for "
            f"column {name!r}; write {of_file.unit!r}, with a scale if the file is wrong"
        )
    return unit


@dataclass(frozen=True, slots=True)
class Gaps:
    """Samples that are no numbers, in a signal with such on either side."""

    lost: IndexArray  #: Their places.
    count: int  #: Number of stretches of them.
    longest_s: float  #: Time from the last number before the longest of them to the next [s].

    @property
    def text(self) -> str:
        """How many they are."""
        n = len(self.lost)
        longest = self.longest_s
        several = f" in {self.count} gaps, the longest" if self.count > 1 else ","
        ms = f"{longest:.3g} s" if longest >= 1.0 else f"{1e3 * longest:.3g} ms"
        return f"{n} unreadable {'samples' if n > 1 else 'sample'}{several} {ms}"

    @property
    def bridge_s(self) -> float:
        """What a mapping says to bridge them [s]."""
        return math.ceil(1e3 * self.longest_s) / 1e3

    def bridged(self, time: FloatArray, values: FloatArray) -> FloatArray:
        """The signal with a straight line over each."""
        good = np.delete(np.arange(len(values)), self.lost)
        whole = values.copy()
        whole[self.lost] = np.interp(time[self.lost], time[good], values[good])
        return freeze(whole)


def gaps_of(time: FloatArray, values: FloatArray) -> Gaps | None:
    """The gaps of a signal; None where there are none, or not between numbers."""
    if values.ndim != 1 or len(time) != len(values):
        return None
    lost = np.flatnonzero(~np.isfinite(values))
    if not len(lost) or lost[0] == 0 or lost[-1] == len(values) - 1:
        return None
    first = lost[np.diff(lost, prepend=-2) > 1]
    last = lost[np.diff(lost, append=len(values) + 1) > 1]
    return Gaps(lost, len(first), float(np.max(time[last + 1] - time[first - 1])))


def channel(role: str, column: Column, scaling: Scaling, table: Table) -> Channel:
    """Check samples and bring them to SI; frames in which a film shows nothing are left out."""
    shown = f"column {column.name!r}"
    times = column.time
    raw = column.values
    position = column.position
    if (filmed := role in FILM_ROLES) or GAPS.get():
        kept = np.flatnonzero(np.isfinite(raw) & ((raw != 0.0) | (not filmed)))
        if len(kept) < len(raw):
            times = freeze(times[kept])
            raw = freeze(raw[kept])
            position = lambda index: column.position(int(kept[index]))  # noqa: E731
    names = (f"column {column.time_name!r}", shown)
    gaps = gaps_of(times, raw) if scaling.bridge_s else None
    filled = "" if gaps is None else f", {gaps.text} bridged by straight lines"
    if gaps is not None and gaps.longest_s <= scaling.bridge_s:
        raw = gaps.bridged(times, raw)
    try:
        check_samples(
            times, raw, where=table.file, names=names, position=position, reason=column.reason
        )
    except InputError as error:
        short = gaps_of(times, raw)
        if short is None or not short.longest_s <= LONGEST_BRIDGE_S:  # of a NaN neither holds
            raise
        raise InputError(
            f"{error}; correct the file, or bridge it in a mapping: bridge_s = {short.bridge_s:g}"
        ) from None
    factor = scaling.sign * to_si(role, scaling.unit, f"{table.file}: {shown}")
    values = raw
    with np.errstate(over="ignore", invalid="ignore"):
        if scaling.scale != 1:
            values = values * scaling.scale
        if scaling.offset != 0:  # at most one copy is made, none where nothing changes
            values = np.add(values, scaling.offset, out=None if values is raw else values)
        if factor != 1:
            values = np.multiply(values, factor, out=None if values is raw else values)
    if values is not raw:
        check_finite(values, where=table.file, name=f"{shown} scaled to SI", position=position)
    remarks = filter(None, (table.remarks.get(column.name), column.remark))
    remark = "".join(f"; {text}" for text in remarks)
    si_unit = "1" if scaling.unit == "1" else SI[kind(role)]
    source = f"{Path(table.file).name}: {column.name} {scaling.describe()}{filled}{remark}"
    return Channel(role, times, freeze(values), si_unit, source)
