"""A raw column becomes a channel: its unit settled, its scaling applied, its samples checked."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.units import FACTORS, SI, kind, plain, spelled, to_si
from surae.recording.recording import FILM_ROLES, Channel
from surae.recording.roles import heading_unit
from surae.recording.table import Column, Table, check_finite, check_samples


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
    return table.units.get(name) or of_kind or heading_unit(name)


def stated_unit(table: Table, role: str, name: str) -> str | None:
    """The unit that the file itself states for a column used as `role`; None if it is unknown."""
    text = written_unit(table, name, role)
    unit = None if text is None else spelled(text)
    return unit if unit in FACTORS[kind(role)] else None


def settle_unit(table: Table, role: str, name: str, unit: str | None, where: str) -> str:
    """The unit of a column: as described by its user, else as stated by the file.

    It is refused where neither says it, it isn't known, or the two disagree. An EMG described as
    ``"1"`` has been normalised by its user and may disagree.
    """
    stated = stated_unit(table, role, name)
    if unit is None:
        if stated is None:
            allowed = ", ".join(FACTORS[kind(role)])
            raise InputError(
                f"{where}: unit is missing and {table.file} states none for column {name!r}; "
                f"write one of: {allowed}"
            )
        return stated
    unit = plain(unit)
    to_si(role, unit, where)
    if stated is not None and unit not in (stated, "1"):
        raise InputError(
            f"{where}: unit {unit!r} contradicts {table.file}, which states {stated!r} for column "
            f"{name!r}; write {stated!r}, with a scale if the file is wrong"
        )
    return unit


def channel(role: str, column: Column, scaling: Scaling, table: Table) -> Channel:
    """Check samples and bring them to SI; frames in which a film shows nothing are left out."""
    shown = f"column {column.name!r}"
    times, raw, position = column.time, column.values, column.position
    if role in FILM_ROLES:
        kept = np.flatnonzero(np.isfinite(raw) & (raw != 0.0))
        if len(kept) < len(raw):
            times, raw = freeze(times[kept]), freeze(raw[kept])
            position = lambda index: column.position(int(kept[index]))  # noqa: E731
    names = (f"column {column.time_name!r}", shown)
    check_samples(times, raw, where=table.file, names=names, position=position)
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
    remark = f"; {text}" if (text := table.remarks.get(column.name)) else ""
    si_unit = "1" if scaling.unit == "1" else SI[kind(role)]
    source = f"{Path(table.file).name}: {column.name} {scaling.describe()}{remark}"
    return Channel(role, times, freeze(values), si_unit, source)
