"""Which channel of which stream is which signal: as streams say, as a mapping says, as chosen."""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, TypedDict

from surae.api import MUSCLES, ROLES, channels_by_names, toml_text, weight_of
from surae.base.errors import InputError, SuraeError
from surae.base.records import read_toml
from surae.base.units import FACTORS, SI, kind, stated
from surae.base.units import plain as plain_unit
from surae_workbench.live.stream import Stream
from surae_workbench.live.target import KIND

#: The signals that can be chosen for a channel; films, and what else there is, take a mapping.
CHOSEN_ROLES = ROLES[:6]


class Chosen(TypedDict):
    """The channel that a signal was chosen to be."""

    column: str
    unit: str | None  #: One of ours; None where the stream states it.
    sign: Literal[1, -1]


def mapping_of(streams: list[Stream]) -> tuple[str, dict[str, list[str]]]:
    """A mapping for streams that name their channels as we do: ``angle``, ``emg_ta``, with a unit.

    Empty where the angle is not among them. Beside it the signals that several columns say they
    are, which make it empty too. A stream that was lost counts where no other says the same, or
    both were there together: then it is another device.
    """
    said: dict[str, list[tuple[Stream, str, str]]] = {}
    for stream in streams:
        for column, label, unit in zip(stream.columns, stream.labels, stream.units, strict=True):
            role = plain_unit(label)
            known = plain_unit(unit)
            if role in ROLES and known in FACTORS[kind(role)] and stream.kind != KIND:
                said.setdefault(role, []).append((stream, column, known))
    lines = []
    twice: dict[str, list[str]] = {}
    for role, columns in said.items():
        there = [each for each in columns if each[0].state != "lost" or each[0].told] or columns
        if len(there) > 1:
            twice[role] = [column for _, column, _ in there]
        _, column, unit = there[0]
        lines.append(
            f"[channels.{role}]\ncolumn = {json.dumps(column)}\nunit = {json.dumps(unit)}\n"
        )
    return "".join(lines) if "angle" in said and not twice else "", twice


def columns_of(mapping: Path | None) -> tuple[str, ...]:
    """The columns that a mapping names; none where it cannot be read now."""
    with suppress(SuraeError, OSError, AttributeError, TypeError, KeyError):
        if mapping is not None:
            channels = read_toml(mapping)["channels"].values()
            return tuple(str(each.get("column", "")) for each in channels)
    return ()


def offered(streams: Sequence[Stream], mapping: Path | None) -> dict[str, Any]:
    """What can be chosen, and what is: as the mapping says, else as names and units suggest.

    By role, a guess of `surae inspect` says by which rule it was made; nothing is settled by it.
    """
    there = [stream for stream in streams if stream.kind != KIND and not stream.words]
    units = {
        column: unit
        for stream in there
        for column, unit in zip(stream.columns, stream.units, strict=True)
    }
    guessed, open_ = channels_by_names(list(units.items()))
    chosen, emg = _chosen(mapping)
    return {
        "columns": [{"column": column, "unit": unit} for column, unit in units.items()],
        "units": {role: list(FACTORS[kind(role)]) for role in CHOSEN_ROLES},
        "chosen": chosen,
        "emg": emg,
        "guesses": {
            role: {
                "column": channel.column,
                "unit": channel.known_unit or SI[kind(role)],
                "scale": channel.scale,
            }
            for role, channel in guessed.items()
            if role in CHOSEN_ROLES
        },
        "open": {
            role: [channel.column for channel in several]
            for role, several in open_.items()
            if role in CHOSEN_ROLES
        },
    }


def chosen_text(
    streams: Sequence[Stream],
    channels: Mapping[str, Chosen],
    emg: str | None,
    before: Path | None = None,
) -> str:
    """The mapping of a choice of channels; InputError where it is none that can be read.

    What the mapping `before` says of a channel that stays, and of all else, stays too.
    """
    known = _known(before)
    units = {
        column: unit
        for stream in streams
        for column, unit in zip(stream.columns, stream.units, strict=True)
    }
    tables: dict[str, Any] = {}
    for role in CHOSEN_ROLES:
        if role not in channels:
            continue
        column = channels[role]["column"]
        if column not in units:
            raise InputError(f"{role}: no stream has {column!r} now; choose another channel")
        for other, table in tables.items():
            if table["column"] == column:
                raise InputError(f"{column!r} was chosen for {other} and {role}; it is one of them")
        old = known.get("channels", {}).get(role, {})
        tables[role] = {
            **(old if old.get("column") == column else {}),
            "column": column,
            **_unit(role, units[column], channels[role]["unit"]),
            "sign": channels[role]["sign"],
        }
    if "angle" not in tables or "torque" not in tables:
        missing = "angle" if "angle" not in tables else "torque"
        raise InputError(f"which channel is the {missing}? Choose it; without it nothing is judged")
    silent = [muscle for muscle in MUSCLES if f"emg_{muscle}" not in tables]
    weights = {weight_of(muscle) for muscle in MUSCLES}
    fixed = {name: value for name, value in known.get("fixed", {}).items() if name not in weights}
    fixed |= {weight_of(muscle): 0.0 for muscle in silent}
    more = {r: e for r, e in known.get("channels", {}).items() if r not in CHOSEN_ROLES}
    head = {name: value for name, value in known.items() if name not in ("fixed", "channels")}
    head |= ({"emg": emg} if emg else {}) | ({"fixed": fixed} if fixed else {})
    return toml_text({**head, "channels": tables | more})


def _unit(role: str, said: str, chosen: str | None) -> dict[str, Any]:
    """A channel's unit in a mapping: the stream's own where it is one of the signal's."""
    unit = stated(said)
    if unit is not None and unit.kind == kind(role) and unit.unit and not unit.per_kg:
        return (
            {"unit": unit.unit} if unit.scale == 1.0 else {"unit": unit.unit, "scale": unit.scale}
        )
    if chosen not in FACTORS[kind(role)]:
        known = ", ".join(FACTORS[kind(role)])
        raise InputError(f"{role}: its stream states no unit; choose one of: {known}")
    return {"unit": chosen}


def _known(mapping: Path | None) -> dict[str, Any]:
    """What a mapping says; nothing where there is none that can be read."""
    with suppress(SuraeError, OSError):
        if mapping is not None:
            return dict(read_toml(mapping))
    return {}


def _chosen(mapping: Path | None) -> tuple[dict[str, Chosen], str | None]:
    """What a mapping says of the signals that can be chosen; nothing where it cannot be read."""
    chosen: dict[str, Chosen] = {}
    emg = None
    with suppress(SuraeError, OSError, AttributeError, TypeError, KeyError):
        if mapping is not None:
            said = read_toml(mapping)
            emg = str(said["emg"]) if "emg" in said else None
            for role, entry in said["channels"].items():
                if role in CHOSEN_ROLES:
                    sign: Literal[1, -1] = -1 if entry.get("sign") == -1 else 1
                    unit = entry.get("unit")
                    chosen[role] = {
                        "column": str(entry["column"]),
                        "unit": None if unit is None else str(unit),
                        "sign": sign,
                    }
    return chosen, emg
