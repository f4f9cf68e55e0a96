"""Files to recordings: readers, units and signs, provenance."""

from surae.recording.hdf5 import write_hdf5
from surae.recording.inspected_channels import InspectedChannel, Inspection
from surae.recording.inspection import inspect
from surae.recording.mapping_text import mapping_text
from surae.recording.parts import description_of, files_of
from surae.recording.reading import read
from surae.recording.recording import (
    FILM_ROLES,
    FILMED,
    MUSCLE_NAMES,
    MUSCLES,
    PLACES,
    ROLES,
    Channel,
    Recording,
    SourceFile,
)
from surae.recording.table import leaving_gaps
from surae.recording.writing import csv_columns, write_csv, write_parquet

__all__ = [
    "FILMED",
    "FILM_ROLES",
    "MUSCLES",
    "MUSCLE_NAMES",
    "PLACES",
    "ROLES",
    "Channel",
    "InspectedChannel",
    "Inspection",
    "Recording",
    "SourceFile",
    "csv_columns",
    "description_of",
    "files_of",
    "inspect",
    "leaving_gaps",
    "mapping_text",
    "read",
    "write_csv",
    "write_hdf5",
    "write_parquet",
]
