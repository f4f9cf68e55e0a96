"""Any supported file to a recording."""

from surae.files import PathLike
from surae.recording import hdf5, mapping, opensim
from surae.recording.by_name import recording_by_names
from surae.recording.formats import open_table
from surae.recording.recording import Recording
from surae.recording.source import open_source


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
    return recording_by_names(open_table(source), source)
