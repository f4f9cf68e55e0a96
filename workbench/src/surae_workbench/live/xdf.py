"""What arrives, on disk as it arrives: XDF, the field's append-only format, whole at any moment.

A chunk is written in one go and unbuffered, so that it survives the end of this process at once;
`XdfLog.sync`, called every second, makes it survive the end of the power. A file without an end is
a valid file: `mended_xdf` cuts off the chunk that was being written.
"""

import json
import os
import struct
import uuid
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.api import xdf_end
from surae.base.units import FloatArray

_MAGIC = b"XDF:"
_HEADER = b'<?xml version="1.0"?><info><version>1.0</version></info>'
_FILE = 1
_STREAM = 2
_SAMPLES = 3
_CLOCK = 4
_BOUNDARY = 5
#: Where readers find their way back after damage.
_SIGN = uuid.UUID("43a546dc-cbf5-410f-b30e-d5467383cbe4").bytes


class XdfLog:
    """A new XDF file that is written as streams arrive.

    Parameters
    ----------
    path : Path
        Made at once; on a full disk, by the first chunk that finds room.

    Raises
    ------
    FileExistsError
        It is there already.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: int | None = None
        self._size = 0
        try:
            self._make()
        except FileExistsError:
            raise
        except OSError:
            return

    def stream(self, number: int, xml: str) -> None:
        """Describe a stream, before its samples."""
        self._append(_chunk(_STREAM, struct.pack("<I", number) + xml.encode()))

    def samples(self, number: int, stamps: FloatArray, values: npt.NDArray[Any]) -> None:
        """Add samples of numbers, shape (n, channels), with a stamp each [s]."""
        little = values.dtype.newbyteorder("<")
        kind = [("bytes", "u1"), ("stamp", "<f8"), ("values", little, (values.shape[1],))]
        rows = np.empty(len(stamps), kind)
        rows["bytes"], rows["stamp"], rows["values"] = 8, stamps, values
        head = struct.pack("<IBI", number, 4, len(stamps))
        self._append(_chunk(_SAMPLES, head + rows.tobytes()))

    def words(
        self, number: int, stamps: Sequence[float], rows: Sequence[Sequence[str | bytes]]
    ) -> None:
        """Add samples of words; bytes that are no UTF-8 become U+FFFD."""
        parts = [struct.pack("<IBI", number, 4, len(stamps))]
        for stamp, row in zip(stamps, rows, strict=True):
            parts.append(struct.pack("<Bd", 8, stamp))
            for text in row:
                data = (text.decode(errors="replace") if isinstance(text, bytes) else text).encode()
                parts.append(struct.pack("<BI", 4, len(data)) + data)
        self._append(_chunk(_SAMPLES, b"".join(parts)))

    def clock(self, number: int, time: float, offset: float) -> None:
        """Add a measurement of how far a stream's clock is behind ours [s], at a time of ours."""
        self._append(_chunk(_CLOCK, struct.pack("<Idd", number, time - offset, offset)))

    def mark(self) -> None:
        """Add a mark where readers find their way back."""
        self._append(_chunk(_BOUNDARY, _SIGN))

    def sync(self) -> None:
        """Have the disk keep what was written, whatever happens to the power."""
        file = self._file
        if file is not None:
            os.fsync(file)

    def close(self) -> None:
        """End the file."""
        file = self._file
        self._file = None
        if file is not None:
            os.close(file)

    def _make(self) -> int:
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        self._file = os.open(self.path, flags, 0o600)
        return self._file

    def _append(self, chunk: bytes) -> None:
        """Write a whole chunk, or nothing of it: a full disk takes a part."""
        file = self._make() if self._file is None else self._file
        if not self._size:
            chunk = _MAGIC + _chunk(_FILE, _HEADER) + chunk
        done = 0
        try:
            while done < len(chunk):
                done += os.write(file, chunk[done:])
        except OSError:
            os.ftruncate(file, self._size)
            os.lseek(file, self._size, os.SEEK_SET)
            raise
        self._size += done


def mended_xdf(path: Path) -> int:
    """Cut off the chunk that was being written when a recording broke off; how many bytes it had.

    0 where the file is whole; where it is no XDF; and where it is damaged before its end, since
    readers find their way back behind that. Such files are left as they are.
    """
    with path.open("r+b") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            return 0
        at = file.seek(xdf_end(file))
        torn = file.read()
        if _SIGN in torn:
            return 0
        if torn:
            file.truncate(at)
            os.fsync(file.fileno())
    return len(torn)


def events_in(path: Path) -> Iterator[tuple[float, dict[str, Any]]]:
    """What a recorder wrote down in a file, stream 1 of it, each with its stamp [s]."""
    with path.open("rb") as file:
        end = file.seek(xdf_end(file) if file.read(len(_MAGIC)) == _MAGIC else 0)
        at = file.seek(len(_MAGIC))
        while at < end:
            head = file.read(15)  # width, length, tag, stream: of chunks as we write them
            width = head[0]
            length = int.from_bytes(head[1 : 1 + width], "little")
            if head[1 + width :][:6] == struct.pack("<HI", _SAMPLES, 1):
                file.seek(at + 1 + width + 6)
                with suppress(struct.error, ValueError, RecursionError):
                    yield from _events(file.read(length - 6))
            at = file.seek(at + 1 + width + length)


def _events(samples: bytes) -> Iterator[tuple[float, dict[str, Any]]]:
    """Samples of one word each, which is an event as JSON."""
    place = 5
    while place < len(samples):
        stamp, size = struct.unpack_from("<xdxI", samples, place)
        place += 14 + size
        event = json.loads(samples[place - size : place])
        if isinstance(event, dict):
            yield stamp, event


def _chunk(tag: int, content: bytes) -> bytes:
    return struct.pack("<BIH", 4, len(content) + 2, tag) + content
