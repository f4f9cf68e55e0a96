"""FILELB (.flb) of McGill's REKLAB: cases of channels, as their flbio.m documents them.

A case is, in little-endian numbers of four bytes where nothing else is said: version (2, 3 or 4);
from 3 on dimensions and realizations; channels, samples, bytes of a sample (4: a float, 2: a whole
number); the domain's name, increment and start (floats); a comment; the channels' names; their
least and greatest values (eight bytes each); the samples, channel by channel. A text has its length
before it.
"""

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.frozen import as_read_only
from surae.base.units import FloatArray
from surae.recording.source import Source
from surae.recording.table import Column, Table, instants, sample

_VERSIONS = (2, 3, 4)
_FORMATS = {2: "<i2", 4: "<f4"}
_MOST_CHANNELS = 512
_LONGEST_TEXT = 10_000
_MOST_CASES = 1000


@dataclass(frozen=True, slots=True)
class _Case:
    """One case: what its header says, and where its samples begin."""

    names: tuple[str, ...]
    samples: int
    format: int
    start_s: float
    step_s: float
    begin: int

    @property
    def end(self) -> int:
        """Where the next one begins."""
        return self.begin + len(self.names) * self.samples * self.format

    def channel(self, data: bytes, index: int) -> FloatArray:
        """The samples of a channel."""
        at = self.begin + index * self.samples * self.format
        raw = np.frombuffer(data, _FORMATS[self.format], self.samples, at)
        with np.errstate(invalid="ignore"):
            return raw.astype(np.float64)


def recognises(source: Source) -> bool:
    """Whether it begins with a whole header."""
    try:
        return bool(_case(source.data, 0).names)
    except (struct.error, ValueError):
        return False


def open_table(source: Source) -> Table:
    """Read the headers of all cases."""
    try:
        cases = list(_cases(source.data))
    except (struct.error, ValueError) as error:
        raise InputError(f"{source.shown}: FILELB that is cut short or damaged ({error})") from None
    places: dict[str, tuple[_Case, int]] = {}
    for number, case in enumerate(cases, start=1):
        before = f"case {number}: " if len(cases) > 1 else ""
        for index, name in enumerate(case.names):
            full = before + (name or f"channel {index + 1}")
            places[full if full not in places else f"{full} #{index + 1}"] = case, index

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = {}
        for name in wanted:
            case, index = places[name]
            time = instants(case.start_s, 1.0 / case.step_s, case.samples)
            values = as_read_only(case.channel(source.data, index))
            loaded[name] = Column(name, time, values, "time", sample)
        return loaded

    counts = (name for name, (case, _) in places.items() if case.format == 2)
    remarks = dict.fromkeys(counts, "whole numbers without a scale: give it")
    return Table(source.shown, "FILELB", tuple(places), "time", load, remarks=remarks)


def _cases(data: bytes) -> Iterator[_Case]:
    at = number = 0
    while at < len(data):
        case = _case(data, at)
        at = case.end
        number = number + 1
        if at > len(data) or number > _MOST_CASES:
            raise ValueError("it states more than it holds")
        yield case


class _Reader:
    """Reads one value after another; struct.error where the file has ended."""

    def __init__(self, data: bytes, at: int) -> None:
        self.data = data
        self.at = at

    def real(self) -> float:
        """A float, as it was meant: 0.001 s and not 0.00100000005 s."""
        (number,) = struct.unpack_from("<f", self.data, self.at)
        self.at += 4
        return float(str(np.float32(number)))

    def count(self, most: int) -> int:
        """A whole number from 0 to `most`."""
        (number,) = struct.unpack_from("<i", self.data, self.at)
        self.at += 4
        if not 0 <= number <= most:
            raise ValueError(f"{number} where 0 to {most} can be")
        return int(number)

    def text(self) -> str:
        """A text with its length before it."""
        length = self.count(_LONGEST_TEXT)
        self.at += length
        return cleaned(self.data[self.at - length : self.at].decode("latin-1"))


def _case(data: bytes, at: int) -> _Case:
    """The header of the case that begins at a byte; of several realizations each is a channel."""
    reader = _Reader(data, at)
    version = reader.count(max(_VERSIONS))
    realizations = 1
    if version not in _VERSIONS:
        raise ValueError(f"version {version}")
    if version > 2:
        reader.count(3)
        realizations = reader.count(_MOST_CHANNELS)
    channels = reader.count(_MOST_CHANNELS)
    samples = reader.count(2**30)
    form = reader.count(4)
    reader.text()
    step = reader.real()
    start = reader.real()
    reader.text()
    names = tuple(reader.text() for _ in range(channels))
    reader.at += 16 * channels
    if not channels or not realizations or not samples or form not in _FORMATS:
        raise ValueError("no samples")
    if not (np.isfinite(start) and np.isfinite(step) and step > 0):
        raise ValueError(f"{step:g} s from sample to sample")
    if realizations > 1:
        names = tuple(f"{name} ({k + 1})" for k in range(realizations) for name in names)
    return _Case(names, samples, form, start, step, reader.at)
