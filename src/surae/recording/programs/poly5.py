"""TMSi Poly5 2.03 and 2.04: a header, a description of each signal, blocks of samples.

Samples are little-endian words of 16 bits. Two words described as ``(Lo) name`` and ``(Hi) name``
are one 32-bit float. All signals have one rate. Every block but the last is full; what follows the
header's count of samples in the last one is left over from earlier.
"""

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.units import FloatArray
from surae.recording.source import Source
from surae.recording.table import Column, Table, instants, sample

_MAGIC = b"POLY SAMPLE FILE"
#: After the identification of 31 bytes (version 2.03) or 32 (2.04).
_HEADER = struct.Struct("<H81phhBHi4x14xiHHH64x")
_SIGNAL = struct.Struct("<41p4x11pffffH62x")
#: Before the samples of each block: index, time of day, reserved.
_BLOCK_HEADER = 86
_LOW = "(Lo) "
_HIGH = "(Hi) "
_Words = npt.NDArray[np.int16]


@dataclass(frozen=True, slots=True)
class _Signal:
    """One signal: where its words are and how they become its unit."""

    name: str
    unit: str
    word: int
    floats: bool
    scale: float
    offset: float


def recognises(source: Source) -> bool:
    """Whether it begins as Poly5 files do."""
    return source.data.startswith(_MAGIC)


def open_table(source: Source) -> Table:
    """Read the header.

    Another version, and a file that is compressed, damaged or cut short, is refused.
    """
    samples, n, rate_hz, signals, remark = _opened(source)
    by_name = {signal.name: signal for signal in signals}

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        time = instants(0.0, rate_hz, n)
        values = {name: _values(samples, n, by_name[name]) for name in wanted}
        return {name: Column(name, time, values[name], "time", sample) for name in wanted}

    return Table(
        source.shown,
        "Poly5",
        tuple(signal.name for signal in signals),
        "time",
        load,
        units={signal.name: signal.unit for signal in signals if signal.unit},
        remarks=dict.fromkeys(by_name, remark) if remark else {},
    )


def _opened(source: Source) -> tuple[_Words, int, float, list[_Signal], str]:
    """Words by block, sample and signal; samples, rate [Hz], signals, what a user should know."""
    where = source.shown
    data = source.data
    begin = next((b for b in (31, 32) if data[b : b + 2] in (b"\xcb\x00", b"\xcc\x00")), None)
    if begin is None or len(data) < begin + _HEADER.size:
        raise InputError(f"{where}: no Poly5 file of version 2.03 or 2.04, or cut short")
    _, _, rate, stored, _, words, count, blocks, per_block, size, compressed = _HEADER.unpack_from(
        data, begin
    )
    if compressed:
        raise InputError(f"{where}: its samples are delta compressed; export it uncompressed")
    if rate <= 0 or stored != rate:
        raise InputError(f"{where}: rate {rate} Hz, stored at {stored} Hz: not a sampling rate")
    first = begin + _HEADER.size + words * _SIGNAL.size
    if not words or first > len(data):
        raise InputError(f"{where}: {words} signals are described; the file is damaged")
    if size != 2 * words * per_block or not per_block or blocks <= 0:
        raise InputError(
            f"{where}: blocks of {size} bytes don't hold {per_block} samples of {words} words; "
            "the file is damaged"
        )
    complete = (len(data) - first) // (_BLOCK_HEADER + size)
    n = blocks * per_block
    remark = ""
    if complete < blocks:
        raise InputError(
            f"{where}: the file is cut short: it holds {complete} of its {blocks} blocks of samples"
        )
    if n - per_block < count < n:
        n = count
    elif count != n:
        remark = f"the header counts {count} samples, the blocks hold {n}"
    if n < 2:
        raise InputError(f"{where}: it holds fewer than two samples")
    samples: _Words = np.ndarray(
        (blocks, per_block, words),
        "<i2",
        data,
        first + _BLOCK_HEADER,
        strides=(_BLOCK_HEADER + size, 2 * words, 2),
    )
    signals = list(_signals(data[begin + _HEADER.size : first], where))
    return samples, n, float(rate), signals, remark


def _signals(described: bytes, where: str) -> Iterator[_Signal]:
    """The signals that the words are of, pairs joined."""
    words = enumerate(_SIGNAL.iter_unpack(described))
    for word, (raw, unit, *calibration, _) in words:
        name = _latin(raw)
        if floats := name.startswith(_LOW):
            name = name.removeprefix(_LOW).strip()
            _, (high, *_) = next(words, (0, (b"",)))
            if _latin(high) != _HIGH + name:
                raise InputError(
                    f"{where}: {_LOW + name!r} is not followed by its high word; the file is "
                    "damaged"
                )
        # Raw values between two are brought to the unit between two others.
        unit_low, unit_high, raw_low, raw_high = calibration
        scale = 1.0
        offset = 0.0
        if (unit_low, unit_high) != (raw_low, raw_high):
            apart = raw_high - raw_low
            scale = (unit_high - unit_low) / apart if apart else math.nan
            offset = unit_low - scale * raw_low
        if not (math.isfinite(scale) and math.isfinite(offset)):
            raise InputError(f"{where}: {name!r} has no calibration; the file is damaged")
        yield _Signal(name, _latin(unit), word, floats, scale, offset)


def _values(samples: _Words, n: int, signal: _Signal) -> FloatArray:
    """A signal in its unit."""
    raw = samples[:, :, signal.word : signal.word + 1 + signal.floats]
    if signal.floats:
        raw = np.ascontiguousarray(raw).view("<f4")
    with np.errstate(invalid="ignore", over="ignore"):
        values = raw.astype(np.float64).reshape(-1)[:n]
        if (signal.scale, signal.offset) != (1.0, 0.0):
            values *= signal.scale
            values += signal.offset
    return freeze(values)


def _latin(text: bytes) -> str:
    """A name or unit, in one printable line."""
    return cleaned(text.split(b"\0")[0].decode("latin-1"))
