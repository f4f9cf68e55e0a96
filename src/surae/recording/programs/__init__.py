"""Files of other programs and devices, each by a library or a reader of its own."""

from surae.base.errors import InputError
from surae.recording.format_module import FormatModule
from surae.recording.programs import (
    acqknowledge,
    c3d,
    discover,
    edf,
    excel,
    filelb,
    labview,
    matlab,
    parquet,
    poly5,
    spike2_text,
    text_exports,
    trigno,
    vicon,
    xdf,
)
from surae.recording.source import Source
from surae.recording.table import Table

#: In the order in which they are asked.
READERS: tuple[FormatModule, ...] = (
    matlab,
    poly5,
    edf,
    xdf,
    c3d,
    excel,
    trigno,
    discover,
    spike2_text,
    text_exports,
    vicon,
    labview,
    parquet,
    filelb,
    acqknowledge,
)
#: How the names of their files end, beside those that are text.
ENDINGS = (
    ".mat",
    ".c3d",
    ".edf",
    ".bdf",
    ".xdf",
    ".poly5",
    ".xlsx",
    ".xls",
    ".ods",
    ".lvm",
    ".tdms",
    ".acq",
    ".parquet",
    ".feather",
    ".flb",
)


def recognises(source: Source) -> bool:
    """Whether its content is of one of the formats."""
    return _reader(source) is not None


def open_table(source: Source) -> Table:
    """The columns of a file, by the first reader that recognises it."""
    reader = _reader(source)
    if reader is None:
        raise InputError(f"{source.shown}: it is of none of the formats")
    return reader.open_table(source)


def _reader(source: Source) -> FormatModule | None:
    return next((reader for reader in READERS if reader.recognises(source)), None)
