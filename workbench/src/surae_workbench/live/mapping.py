"""Which channel of which stream is which signal: as streams say, and as a mapping says."""

import json
from contextlib import suppress
from pathlib import Path

from surae.api import ROLES
from surae.base.errors import SuraeError
from surae.base.records import read_toml
from surae.base.units import FACTORS, kind
from surae.base.units import plain as plain_unit
from surae_workbench.live.stream import Stream
from surae_workbench.live.target import KIND


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
