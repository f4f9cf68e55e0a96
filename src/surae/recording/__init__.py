"""Files to recordings: readers, units and signs, provenance."""

from surae.recording.reading import read
from surae.recording.recording import MUSCLES, ROLES, Channel, Recording, SourceFile, read_only
from surae.recording.writing import columns, write_csv

__all__ = [
    "MUSCLES",
    "ROLES",
    "Channel",
    "Recording",
    "SourceFile",
    "columns",
    "read",
    "read_only",
    "write_csv",
]
