"""The chunks of an XDF file, walked before pyxdf reads them.

pyxdf allocates the number of samples that a chunk claims, fills what it cannot read with the bytes
of the sample before, and skips damaged chunks with a message in its log. A file that passes here
holds what it claims.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import numpy as np

from surae.errors import InputError
from surae.recording.source import Source

MAGIC = b"XDF:"
_HEADER, _SAMPLES, _CLOCK, _FOOTER = 2, 3, 4, 6
_KNOWN = range(1, 7)
#: Bytes of a value.
_FORMATS = {"int8": 1, "int16": 2, "int32": 4, "int64": 8, "float32": 4, "double64": 8}
_STAMP = 8
_MOST_CHANNELS = 10_000
_LONGEST_XML = 16 * 2**20


@dataclass(frozen=True, slots=True)
class _Kind:
    """What a stream's samples are; `size` is None for words."""

    channels: int
    size: int | None


def check(source: Source) -> None:
    """Walk through the file.

    Raises
    ------
    InputError
        A chunk is damaged or leads outside the file.
    """
    data = source.data
    streams: dict[int, _Kind] = {}
    for tag, begin, end in _chunks(source):
        where = f"{source.shown}: byte {begin}"
        if tag in (_HEADER, _SAMPLES, _CLOCK, _FOOTER):
            if end - begin < 4:
                raise InputError(f"{where}: the file is damaged (a chunk without its stream)")
            (number,) = struct.unpack_from("<I", data, begin)
            if (tag == _HEADER) == (number in streams):
                raise InputError(f"{where}: the file is damaged (stream {number})")
            if tag == _HEADER:
                streams[number] = _kind(data[begin + 4 : end], where)
            elif tag == _SAMPLES:
                _samples(data, begin + 4, end, streams[number], where)
            elif tag == _CLOCK and end - begin != 4 + 16:
                raise InputError(f"{where}: the file is damaged (a clock offset)")
            elif tag == _FOOTER:
                _xml(data[begin + 4 : end], where)
        elif tag == 1:
            _xml(data[begin:end], where)


def _chunks(source: Source) -> Iterator[tuple[int, int, int]]:
    """Tag, begin and end of the content of each chunk."""
    data, at = source.data, len(MAGIC)
    while at < len(data):
        length, begin = _length(data, at)
        end = begin + length
        if length < 2 or end > len(data):
            raise InputError(f"{source.shown}: the file is cut short or damaged at byte {at}")
        (tag,) = struct.unpack_from("<H", data, begin)
        if tag not in _KNOWN:
            raise InputError(f"{source.shown}: byte {at}: a chunk of unknown kind {tag}")
        yield tag, begin + 2, end
        at = end


def _length(data: bytes, at: int) -> tuple[int, int]:
    """A number of one, four or eight bytes, and where it ends."""
    width = data[at]
    if width not in (1, 4, 8):
        raise ValueError(f"a number of {width} bytes")
    raw = data[at + 1 : at + 1 + width]
    if len(raw) < width:
        raise ValueError("a number cut short")
    return int.from_bytes(raw, "little"), at + 1 + width


def _xml(raw: bytes, where: str) -> Any:
    """XML without definitions of entities, which could grow without end."""
    if len(raw) > _LONGEST_XML or b"<!" in raw.replace(b"<!--", b""):
        raise InputError(f"{where}: a description that is no plain XML")
    try:
        return ElementTree.fromstring(raw.decode("utf-8", "replace"))
    except ElementTree.ParseError as error:
        raise InputError(f"{where}: the file is damaged ({error})") from None


def _kind(raw: bytes, where: str) -> _Kind:
    """What a stream's header says of its samples."""
    info = _xml(raw, where)
    text = {key: info.findtext(key) or "" for key in ("channel_format", "channel_count")}
    rate = float(info.findtext("nominal_srate") or "nan")
    channels = int(text["channel_count"])
    form = text["channel_format"]
    if form not in (*_FORMATS, "string") or not 1 <= channels <= _MOST_CHANNELS:
        raise InputError(f"{where}: a stream of {channels} channels of {form!r}")
    if not 0 <= rate < 1e9:
        raise InputError(f"{where}: a stream of {rate:g} Hz: not a sampling rate")
    return _Kind(channels, _FORMATS.get(form))


def _samples(data: bytes, at: int, end: int, kind: _Kind, where: str) -> None:
    """Check that a chunk holds the samples that it claims, and no more."""
    count, at = _length(data, at)
    size = kind.channels * (kind.size or 1)
    if count * (1 + size) > end - at:
        raise InputError(f"{where}: the file is damaged ({count} samples claimed)")
    if kind.size is None:
        _words(data, at, end, kind.channels, count, where)
        return
    for flag, stamp in ((0, 0), (_STAMP, _STAMP)):
        step = 1 + stamp + size
        if count * step == end - at and count:
            flags = np.frombuffer(data, np.uint8, count=end - at, offset=at)[::step]
            if (flags == flag).all():
                return
    for _ in range(count):
        if at >= end or data[at] not in (0, _STAMP):
            raise InputError(f"{where}: the file is damaged (a time stamp)")
        at += 1 + data[at] + size
    if at != end:
        raise InputError(f"{where}: the file is damaged (samples longer than their chunk)")


def _words(data: bytes, at: int, end: int, channels: int, count: int, where: str) -> None:
    """Check the samples of words in a chunk."""
    for _ in range(count):
        if at >= end or data[at] not in (0, _STAMP):
            raise InputError(f"{where}: the file is damaged (a time stamp)")
        at += 1 + data[at]
        for _ in range(channels):
            if at >= end:
                raise InputError(f"{where}: the file is damaged (a word)")
            length, at = _length(data, at)
            at += length
    if at != end:
        raise InputError(f"{where}: the file is damaged (words longer than their chunk)")
