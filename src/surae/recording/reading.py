"""Any supported file to a recording: by its own format, a mapping, or columns with our names."""

from surae.errors import InputError
from surae.files import PathLike
from surae.recording import hdf5, mapping, opensim
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.formats import open_table
from surae.recording.naming import NAMES, TIMES, role_and_unit
from surae.recording.recording import Recording
from surae.recording.source import Source, open_source
from surae.recording.table import Table, some
from surae.units import plain


def read(path: PathLike) -> Recording:
    """Read a recording: our CSV or HDF5, a TOML mapping, or a file whose columns have our names.

    What the file is shows in its content; its name doesn't matter.

    Parameters
    ----------
    path : str or path
        A regular file.

    Returns
    -------
    Recording
        In SI units, each channel on its own times, with the SHA-256 of every file read.

    Raises
    ------
    InputError
        One line that names file, column and row, and says what to do.
    """
    source = open_source(path)
    if hdf5.recognises(source):
        return hdf5.read_recording(source)
    if mapping.recognises(source) and not opensim.recognises(source):
        return mapping.read_mapping(source)
    return _by_names(open_table(source), source)


def _by_names(table: Table, source: Source) -> Recording:
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
    columns_of: dict[str, str] = {}
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
        if columns_of.get(role) == name:
            raise InputError(f"{_where(table, name)}: the column is there twice; keep one")
        if role in columns_of:
            raise InputError(
                f"{_where(table, name)}: column {columns_of[role]!r} is the {role} too; keep one"
            )
        columns_of[role] = name
        units[role] = settle_unit(table, role, name, unit, _where(table, name))
    if "angle" not in columns_of:
        raise InputError(_no_angle(table))
    columns = table.load(tuple(columns_of.values()))
    return Recording(
        name=table.notes.get("name", source.name),
        channels={
            role: channel(role, columns[name], Scaling(units[role]), table)
            for role, name in columns_of.items()
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
