"""How XDF lies on disk, for who reads and who writes it: chunks, each a length, a tag, content."""

import os
from typing import Any, BinaryIO

import numpy as np

MAGIC = b"XDF:"
#: The bytes that a length may have.
WIDTHS = (1, 4, 8)


def end_of_chunks(file: BinaryIO) -> int:
    """Where the last whole chunk ends that follows others from the file's beginning."""
    size, at = file.seek(0, os.SEEK_END), len(MAGIC)
    while at < size:
        file.seek(at)
        head = file.read(9)
        width = head[0] if head[0] in WIDTHS else 0
        length = int.from_bytes(head[1 : 1 + width], "little")
        if not length or at + 1 + width + length > size:
            break
        at += 1 + width + length
    return at


def stamped_rows(kind: "np.dtype[Any]", channels: int) -> "np.dtype[Any]":
    """Samples of numbers each of which brings its stamp, in a chunk."""
    values = ("values", kind.newbyteorder("<"), (channels,))
    return np.dtype([("bytes", "u1"), ("stamp", "<f8"), values])
