"""EDF, EDF+, BDF and BDF+ (https://www.edfplus.info), read with edfio after its header is checked.

The check is needed: edfio takes what a header claims, returns uncalibrated counts where a range is
empty, shortens the recording where the file ends early, and joins the parts of an interrupted
recording (EDF+D) as if nothing lay between them. Time counts from the first sample, or as the JSON
says that BIDS keeps beside ``…_emg.bdf``.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording.damage import guarded, optional
from surae.recording.recording import freeze
from surae.recording.samples import sample
from surae.recording.sidecar import read_sidecar
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.recording.timing import instants
from surae.units import FloatArray

_EDF, _BDF = b"0       ", b"\xffBIOSEMI"
_BLOCK = 256
#: Widths of the fields that every signal has, in the header's order.
_FIELDS = (16, 80, 8, 8, 8, 8, 8, 80, 8, 32)
_LABEL, _DIMENSION, _RANGES, _SAMPLES = 0, 2, (3, 4, 5, 6), 8
#: Records are unpacked in parts of about so many bytes: edfio needs many times a BDF file's size.
_PART = 2**20
_ONSET = re.compile(rb"([+-]\d{1,9}(?:\.\d{1,9})?)\x14")


@dataclass(frozen=True, slots=True)
class _Header:
    """The header, checked: it agrees with itself and with the file's size."""

    binary: bool
    size: int
    records: int
    duration_s: float
    labels: tuple[str, ...]
    units: tuple[str, ...]
    samples: tuple[int, ...]
    plus: str

    @property
    def width(self) -> int:
        """Bytes of a sample."""
        return 3 if self.binary else 2

    @property
    def record(self) -> int:
        """Bytes of a record."""
        return self.width * sum(self.samples)

    @property
    def signals(self) -> list[int]:
        """Which of the columns are signals, not annotations."""
        notes = f"{'BDF' if self.binary else 'EDF'} Annotations"
        return [i for i, label in enumerate(self.labels) if label != notes]


def recognises(source: Source) -> bool:
    """Whether it begins as EDF or BDF do."""
    if source.data.startswith(_BDF):
        return True
    return source.data.startswith(_EDF) and source.data[184:192].strip().isdigit()


def open_table(source: Source) -> Table:
    """Read the header.

    Raises
    ------
    InputError
        It contradicts itself or the file's size, a signal has no calibration, or edfio is missing.
    """
    with guarded(source):
        header = _header(source)
    index = {header.labels[i]: i for i in reversed(header.signals)}
    begins = _begins(source, header)
    beside = read_sidecar(source.path)

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        times: dict[int, FloatArray] = {}
        values = _values(source, header, [header.signals.index(index[name]) for name in wanted])
        found = {}
        for name, signal in zip(wanted, values, strict=True):
            per_record = header.samples[index[name]]
            if per_record not in times:
                times[per_record] = _times(header, begins, per_record, beside.start_s)
            found[name] = Column(name, times[per_record], signal, "time", sample)
        return found

    gaps = "" if begins is None else "interrupted: its records do not follow each other"
    return Table(
        file=source.shown,
        format="BDF" if header.binary else "EDF",
        names=tuple(header.labels[i] for i in header.signals),
        time_name="time",
        load=load,
        units={name: header.units[i] for name, i in index.items() if header.units[i]},
        notes={"emg": "envelope"} if beside.envelope else {},
        remarks=dict.fromkeys(index, gaps) if gaps else {},
    )


def _header(source: Source) -> _Header:
    """The header of an EDF or BDF file."""
    data, where = source.data, source.shown
    if len(data) < _BLOCK:
        raise InputError(f"{where}: the file is cut short: its header needs {_BLOCK} bytes")
    binary = data.startswith(_BDF)
    count, size = _whole(data[252:256]), _whole(data[184:192])
    records, duration = _whole(data[236:244]), float(data[244:252])
    if count < 1 or size != _BLOCK * (count + 1) or size > len(data):
        raise InputError(f"{where}: the file is damaged: a header of {size} bytes, {count} signals")
    fields: list[list[bytes]] = []
    at = _BLOCK
    for width in _FIELDS:
        fields.append([data[at + i * width : at + (i + 1) * width] for i in range(count)])
        at += width * count
    labels = tuple(_latin(text) for text in fields[_LABEL])
    samples = tuple(_whole(text) for text in fields[_SAMPLES])
    header = _Header(
        binary=binary,
        size=size,
        records=records,
        duration_s=duration,
        labels=labels,
        units=tuple(_latin(text) for text in fields[_DIMENSION]),
        samples=samples,
        plus=data[192:197].decode("latin-1"),
    )
    if not 0 < duration < 1e9 or min(samples) < 1 or not header.signals:
        raise InputError(f"{where}: no signals with a sampling rate in it")
    for i in header.signals:
        low, high, least, most = (float(fields[field][i]) for field in _RANGES)
        if not np.isfinite([low, high]).all() or low == high or least >= most:
            raise InputError(
                f"{where}: column {labels[i]!r}: its range ({low:g} to {high:g} for counts "
                f"{least:g} to {most:g}) is no calibration"
            )
    held = (len(data) - size) // header.record
    if records == -1:
        # Still being recorded when it was copied, or never closed.
        header = replace(header, records=held)
    elif held < records:
        raise InputError(
            f"{where}: the file is cut short: it holds {held} of its {records} records"
        )
    if header.records < 1:
        raise InputError(f"{where}: it holds no samples")
    return header


def _begins(source: Source, header: _Header) -> FloatArray | None:
    """Times at which the records begin [s]; None where they follow each other without a gap."""
    if not header.plus.endswith("+D"):
        return None
    signals = set(header.signals)
    first = next((i for i in range(len(header.labels)) if i not in signals), None)
    if first is None:
        raise InputError(f"{source.shown}: interrupted (EDF+D), without the times of its records")
    skipped = header.width * sum(header.samples[:first])
    length = header.width * header.samples[first]
    onsets = np.empty(header.records)
    for record in range(header.records):
        at = header.size + record * header.record + skipped
        onset = _ONSET.match(source.data[at : at + length])
        if onset is None:
            raise InputError(f"{source.shown}: record {record + 1} has no time; it is damaged")
        onsets[record] = float(onset[1])
    onsets -= onsets[0]
    even = np.abs(onsets - header.duration_s * np.arange(header.records)) < 1e-6
    return None if even.all() else onsets


def _times(
    header: _Header, begins: FloatArray | None, per_record: int, start_s: float
) -> FloatArray:
    """Times of a signal's samples [s], the first at `start_s`."""
    rate = per_record / header.duration_s
    if begins is None:
        return instants(start_s, rate, header.records * per_record)
    within = np.arange(per_record) / rate
    return freeze((start_s + begins[:, None] + within[None, :]).reshape(-1))


def _values(source: Source, header: _Header, wanted: Sequence[int]) -> list[FloatArray]:
    """The wanted signals in their units."""
    arrays = [np.empty(header.records * header.samples[header.signals[i]]) for i in wanted]
    done = [0] * len(wanted)
    for part in _parts(source, header):
        for k, i in enumerate(wanted):
            values = part.signals[i].data
            arrays[k][done[k] : done[k] + len(values)] = values
            done[k] += len(values)
    for k, (array, n) in enumerate(zip(arrays, done, strict=True)):
        if n != len(array):
            raise InputError(f"{source.shown}: signal {k + 1} is shorter than its header says")
    return [freeze(array) for array in arrays]


def _parts(source: Source, header: _Header) -> Iterator[Any]:
    """The file in parts of some records each, as edfio reads them."""
    edfio = optional("edfio", "BDF" if header.binary else "EDF", source)
    read = edfio.read_bdf if header.binary else edfio.read_edf
    each = max(_PART // header.record, 1)
    data = source.data
    for first in range(0, header.records, each):
        count = min(each, header.records - first)
        begin = header.size + first * header.record
        head = data[:236] + str(count).ljust(8).encode() + data[244 : header.size]
        with guarded(source):
            yield read(
                head + data[begin : begin + count * header.record], header_encoding="latin-1"
            )


def _whole(text: bytes) -> int:
    """A whole number of the header."""
    return int(text.decode("ascii").strip())


def _latin(text: bytes) -> str:
    """A text of the header in one printable line."""
    plain = text.decode("latin-1").strip()
    return "".join(letter if letter.isprintable() else "?" for letter in plain)
