"""Recordings as OpenSim storage files, which read back to the same numbers."""

from itertools import islice

from surae.errors import InputError
from surae.files import PathLike, atomic_file, shown
from surae.recording.axis import shared_time
from surae.recording.recording import Recording
from surae.recording.writing import columns

#: Rows that are turned into text at a time.
_CHUNK = 16384


def write_sto(path: PathLike, recording: Recording) -> None:
    """Write a recording as OpenSim's .sto at full double precision, all of it or nothing.

    Columns have our names with their SI units (``angle_rad``); angles are in rad, as ``inDegrees``
    says. OpenSim skips the header's line ``emg=``, which says whether EMG is raw.

    Parameters
    ----------
    path : str or path
        The file; what it held before is replaced.
    recording : Recording
        Its channels must share one time axis.

    Raises
    ------
    InputError
        The channels have times of their own, or the file cannot be written.
    """
    where = f"cannot write {shown(path)}"
    shared_time(recording, where)
    table = columns(recording)
    title = " ".join(recording.name.split()) or "recording"
    if title.casefold() == "endheader" or not title.isprintable():
        raise InputError(f"{where}: {recording.name!r} cannot be the title of an OpenSim file")
    header = [
        title,
        "version=1",
        f"nRows={len(table['time_s'])}",
        f"nColumns={len(table)}",
        "inDegrees=no",
        f"emg={recording.emg}",
        "endheader",
        "\t".join(["time", *(name for name in table if name != "time_s")]),
    ]
    rows = zip(*(values.tolist() for values in table.values()), strict=True)
    with atomic_file(path) as handle:
        handle.write(("\n".join(header) + "\n").encode())
        while chunk := list(islice(rows, _CHUNK)):
            handle.write("".join("\t".join(map(repr, row)) + "\n" for row in chunk).encode())
