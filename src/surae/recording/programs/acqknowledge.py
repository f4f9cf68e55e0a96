"""AcqKnowledge's own files (.acq of BIOPAC), read with bioread."""

import io
import struct
from typing import Any

import numpy as np

from surae.recording.programs.foreign import Parsed, foreign_table, optional, packed
from surae.recording.source import Source
from surae.recording.table import Table
from surae.recording.untrusted import untrusted

#: Versions that bioread knows of, and sizes of the header's first part.
_VERSIONS = range(30, 200)
_SIZES = range(100, 20_000)


def recognises(source: Source) -> bool:
    """Whether a version, a header's size and a count of channels stand where they should."""
    if len(source.data) < 1000:
        return False
    for order in "<>":
        _, version, size, channels = struct.unpack_from(f"{order}hiih", source.data)
        if version in _VERSIONS and size in _SIZES and 0 < channels < 1000:
            return True
    return False


def open_table(source: Source) -> Table:
    """The channels."""
    return foreign_table(source, "AcqKnowledge", __name__)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The columns of a file."""
    bioread = optional("bioread", "AcqKnowledge", shown)
    with untrusted(shown):
        columns = []
        for channel in bioread.read(io.BytesIO(data)).channels:
            values = np.asarray(channel.data, dtype=np.float64)
            clock = (0.0, float(channel.samples_per_second))
            columns.append(Parsed(str(channel.name), values, clock, str(channel.units or "")))
        return packed(columns)
