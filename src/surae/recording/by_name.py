"""A recording from a table whose columns have our names."""

from surae.errors import InputError
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.naming import NAMES, TIMES, role_and_unit
from surae.recording.recording import Recording
from surae.recording.source import Source
from surae.recording.table import Table, some
from surae.units import plain


def recording_by_names(table: Table, source: Source) -> Recording:
    """The recording in `table`; columns that aren't ours are ignored.

    Raises
    ------
    InputError
        No column is the angle, two are the same signal, a unit is missing or not known, or a
        sample is wrong.
    """
    if table.header is not None and table.time_name not in TIMES:
        raise InputError(
            f"{_where(table, table.time_name)}: the unit is missing; write {' or '.join(TIMES)}"
        )
    found: dict[str, str] = {}
    units: dict[str, str] = {}
    for name in table.names:
        # Only in our own format does a name that is nearly ours mean a mistake.
        claim = (
            NAMES.get(plain(name))
            if table.header is None
            else role_and_unit(name, _where(table, name))
        )
        if claim is None:
            continue
        role, unit = claim
        if found.get(role) == name:
            raise InputError(f"{_where(table, name)}: the column is there twice; keep one")
        if role in found:
            raise InputError(
                f"{_where(table, name)}: column {found[role]!r} is the {role} too; keep one"
            )
        found[role] = name
        units[role] = settle_unit(table, role, name, unit, _where(table, name))
    if "angle" not in found:
        raise InputError(_no_angle(table))
    columns = table.load(tuple(found.values()))
    return Recording(
        name=table.notes.get("name", source.name),
        channels={
            role: channel(role, columns[name], Scaling(units[role]), table)
            for role, name in found.items()
        },
        emg="envelope" if table.notes.get("emg") == "envelope" else "raw",
        files=(source.file,),
    )


def _where(table: Table, name: str) -> str:
    """A column's place for a message."""
    row = "" if table.header is None else f", row {table.header}"
    return f"{table.file}: column {name!r}{row}"


def _no_angle(table: Table) -> str:
    """Why a table without a column of ours for the angle is refused."""
    if table.header is not None:
        return (
            f"{table.file}: row {table.header}: missing column angle_rad (or angle_deg); columns "
            f"found: {some((table.time_name, *table.names))}; rename them, or describe the file "
            "in a TOML mapping, which `surae inspect` begins"
        )
    return (
        f"{table.file}: {table.format} columns don't say which is the angle, the torque, the EMG: "
        "write a TOML mapping, which `surae inspect FILE --output MAP.toml` begins, and read "
        f"that; columns here: {some(table.names)}{_alike(table)}"
    )


def _alike(table: Table) -> str:
    """What is remarked of all columns alike."""
    remarks = {table.remarks.get(name, "") for name in table.names}
    only = remarks.pop() if len(remarks) == 1 else ""
    return f" ({only})" if only else ""
