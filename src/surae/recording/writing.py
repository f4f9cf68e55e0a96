"""Recordings as CSV that reads back to the same numbers."""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.files import PathLike, atomic_file, shown
from surae.base.units import FloatArray
from surae.recording.recording import Recording
from surae.recording.table import check_finite

#: Rows that are turned into text at a time.
_CHUNK = 16384


def csv_columns(recording: Recording) -> dict[str, FloatArray]:
    """The channels of a recording under their CSV names, time first.

    The channels must share the time axis of the angle, which is the one that is given.
    """
    named = {"time_s": recording.channels["angle"].time}
    for role, channel in recording.channels.items():
        named[column_name(role, channel.unit)] = channel.values
    return named


def column_name(role: str, unit: str) -> str:
    """Our name of a column with such a signal in this unit: ``"angular_velocity_rad_s"``."""
    return f"{role}_{unit.replace('/', '_')}"


def write_csv(
    path: PathLike, columns: Mapping[str, npt.ArrayLike], comments: Sequence[str] = ()
) -> None:
    """Write columns as CSV at full double precision, all of the file or nothing of it.

    Parameters
    ----------
    path : str or path
        The file; what it held before is replaced.
    columns : mapping of str to array_like, shape (n,)
        Finite numbers by column name, such as ``"torque_Nm"``, in the order to write.
    comments : sequence of str
        Lines to put before the header, each behind ``#``.

    Raises
    ------
    InputError
        The columns differ in length, hold no finite numbers or have names that a CSV header
        cannot hold, or the file cannot be written.

    Examples
    --------
    >>> surae.write_csv("own.csv", {"time_s": [0.0, 0.1], "angle_rad": [0.0, 0.2]})
    """
    where = f"cannot write {shown(path)}"
    arrays = {name: np.asarray(values, dtype=np.float64) for name, values in columns.items()}
    if not arrays:
        raise InputError(f"{where}: there are no columns")
    length = len(next(iter(arrays.values())).ravel())
    for name, array in arrays.items():
        if name.strip() != name or not name.isprintable() or set(name) & set(',;"#') or not name:
            raise InputError(f"{where}: {name!r} cannot be the name of a CSV column")
        if array.shape != (length,):
            raise InputError(
                f"{where}: column {name!r} has shape {array.shape}; the first has ({length},)"
            )
        check_finite(array, where=where, name=f"column {name!r}")
    lines = [f"# {line}".rstrip() for comment in comments for line in comment.splitlines()]
    lines.append(",".join(arrays))
    with atomic_file(path) as handle:
        handle.write(("\n".join(lines) + "\n").encode())
        for first in range(0, length, _CHUNK):
            part = zip(*(a[first : first + _CHUNK].tolist() for a in arrays.values()), strict=True)
            handle.write("".join(",".join(map(repr, row)) + "\n" for row in part).encode())


def write_parquet(path: PathLike, recording: Recording) -> None:
    """Write a recording as Parquet, the table of pandas, Polars and R, its units in the columns.

    Parameters
    ----------
    path : str or path
        The file; what it held before is replaced.
    recording : Recording
        Its channels share one time axis.

    Raises
    ------
    InputError
        The package pyarrow is missing, the channels have times of their own, or the file cannot be
        written.

    Examples
    --------
    >>> surae.api.write_parquet("trial.parquet", surae.read("trial.csv"))
    """
    from surae.recording.frames import library

    where = f"cannot write {shown(path)}"
    arrow = library("pyarrow", "a Parquet file", "formats")
    parquet = library("pyarrow.parquet", "a Parquet file", "formats")
    time = shared_time(recording, where)
    roles = list(recording.channels.items())
    fields = [arrow.field("time_s", arrow.float64(), metadata={"unit": "s"})]
    fields += [
        arrow.field(column_name(role, c.unit), arrow.float64(), metadata={"unit": c.unit})
        for role, c in roles
    ]
    said = {"name": recording.name, "emg": recording.emg}
    table = arrow.table([time, *(c.values for _, c in roles)], schema=arrow.schema(fields, said))
    with atomic_file(path) as handle:
        parquet.write_table(table, handle)


def shared_time(recording: Recording, where: str) -> FloatArray:
    """The times that all channels have, shape (n,) [s].

    Raises
    ------
    InputError
        The channels have times of their own; the message begins with `where`.
    """
    channels = list(recording.channels.values())
    time = channels[0].time
    for channel in channels[1:]:
        if len(channel.time) != len(time) or not np.array_equal(channel.time, time):
            raise InputError(
                f"{where}: {channels[0].role} and {channel.role} have times of their own "
                f"({channels[0].rate_hz:.6g} and {channel.rate_hz:.6g} Hz, from "
                f"{channels[0].time[0]:.6g} and {channel.time[0]:.6g} s), but the file has one "
                "column of times; prepare the recording first (--prepare), or write .h5"
            )
    return time
