"""EDF, EDF+, BDF and BDF+ (https://www.edfplus.info), read with edfio.

What edfio passes over is looked at here: a signal without calibration, a file that ends early, and
the gaps of an interrupted recording (EDF+D), whose parts it joins. Time counts from the first
sample.
"""

import re
from datetime import datetime
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording.programs.foreign import Parsed, foreign_table, optional, packed
from surae.recording.source import Source
from surae.recording.table import Table, instants
from surae.recording.untrusted import untrusted

_EDF = b"0       "
_BDF = b"\xffBIOSEMI"
_BLOCK = 256
#: Before the numbers of samples in a header, for each signal.
_BEFORE_SAMPLES = 216
#: Records are unpacked in parts of about so many bytes: edfio needs many times a BDF file's size.
_PART = 2**20
_ONSET = re.compile(rb"([+-]\d{1,9}(?:\.\d{1,9})?)\x14")


def recognises(source: Source) -> bool:
    """Whether it begins as EDF or BDF do."""
    if source.data.startswith(_BDF):
        return True
    return source.data.startswith(_EDF) and source.data[184:192].strip().isdigit()


def open_table(source: Source) -> Table:
    """The signals; a file that is cut short, or a signal without calibration, is refused."""
    return foreign_table(source, "BDF" if source.data.startswith(_BDF) else "EDF", __name__)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The signals of a file."""
    with untrusted(shown):
        file = _File(data, shown)
        begins = file.begins()
        gaps = "" if begins is None else "interrupted: its records do not follow each other"
        times: dict[int, tuple[float, float] | FloatArray] = {}
        columns = []
        for signal, values in zip(file.signals, file.values(), strict=True):
            per_record = signal.samples_per_data_record
            rate = per_record / file.duration_s
            if per_record not in times:
                times[per_record] = (0.0, rate)
                if begins is not None:
                    within = instants(0.0, rate, per_record)
                    times[per_record] = (begins[:, None] + within[None, :]).reshape(-1)
            label = signal.label
            unit = signal.physical_dimension
            columns.append(Parsed(label, values, times[per_record], unit, gaps))
        return packed(columns, file.began)


class _File:
    """A file as edfio knows it, without its samples."""

    def __init__(self, data: bytes, shown: str) -> None:
        self._binary = data.startswith(_BDF)
        self._edfio = optional("edfio", "BDF" if self._binary else "EDF", shown)
        self._data = data
        self._shown = shown
        self._size = int(data[184:192])
        if not _BLOCK < self._size <= len(data):
            raise InputError(f"{shown}: the file is cut short or damaged in its header")
        self.duration_s = float(data[244:252])
        if not 0 < self.duration_s < 1e9:
            raise InputError(f"{shown}: records of {self.duration_s:g} s: no sampling rate")
        self._head = self._read(0, 0)
        self.signals = self._head.signals
        if not self.signals:
            raise InputError(f"{shown}: it holds no signals, only annotations")
        for signal in self.signals:
            low = signal.physical_min
            high = signal.physical_max
            least = signal.digital_min
            most = signal.digital_max
            if not np.isfinite([low, high]).all() or low == high or least >= most:
                raise InputError(
                    f"{shown}: column {signal.label!r}: its range ({low:g} to {high:g} for counts "
                    f"{least:g} to {most:g}) is no calibration"
                )
        count = int(data[252:256])
        at = _BLOCK + _BEFORE_SAMPLES * count
        self._samples = [int(data[at + 8 * i : at + 8 * i + 8]) for i in range(count)]
        labels = [data[_BLOCK + 16 * i : _BLOCK + 16 * i + 16].strip() for i in range(count)]
        self._notes = next((i for i, x in enumerate(labels) if x.endswith(b" Annotations")), None)
        self._width = 3 if self._binary else 2
        self._record = self._width * sum(self._samples)
        if min(self._samples) < 1:
            raise InputError(f"{shown}: a signal without samples")
        records = int(data[236:244])
        complete = (len(data) - self._size) // self._record
        # -1: still being recorded when it was copied, or never closed.
        self.records = complete if records == -1 else records
        if complete < self.records:
            raise InputError(
                f"{shown}: the file is cut short: it holds {complete} of its {records} records"
            )
        if self.records < 1:
            raise InputError(f"{shown}: it holds no samples")

    @property
    def began(self) -> str:
        """The date and time at which it began; empty where the header has none."""
        try:
            moment = datetime.strptime(self._data[168:184].decode(), "%d.%m.%y%H.%M.%S")
        except ValueError:
            return ""
        return moment.isoformat(sep=" ")

    def values(self) -> list[FloatArray]:
        """The signals in their units."""
        parts: list[list[FloatArray]] = [[] for _ in self.signals]
        each = max(_PART // self._record, 1)
        for first in range(0, self.records, each):
            part = self._read(first, min(each, self.records - first))
            for values, signal in zip(parts, part.signals, strict=True):
                values.append(signal.data)
        return [np.concatenate(values) for values in parts]

    def begins(self) -> FloatArray | None:
        """Times at which the records begin [s]; None where they follow each other without a gap."""
        if not self._head.reserved.endswith("+D"):
            return None
        if self._notes is None:
            raise InputError(f"{self._shown}: interrupted (EDF+D), without its records' times")
        skipped = self._size + self._width * sum(self._samples[: self._notes])
        onsets = np.empty(self.records)
        for record in range(self.records):  # the time stands first in its annotations
            at = skipped + record * self._record
            raw = self._data[at : at + self._width * self._samples[self._notes]]
            if (onset := _ONSET.match(raw)) is None:
                raise InputError(f"{self._shown}: record {record + 1} has no time; it is damaged")
            onsets[record] = float(onset[1])
        onsets -= onsets[0]
        even = np.abs(onsets - self.duration_s * np.arange(self.records)) < 1e-6
        return None if even.all() else onsets

    def _read(self, first: int, count: int) -> Any:
        """Some of the records, as edfio reads them."""
        read = self._edfio.read_bdf if self._binary else self._edfio.read_edf
        head = self._data[: self._size]
        data = self._data
        part = b""
        if count:
            begin = self._size + first * self._record
            part = data[begin : begin + count * self._record]
        whole = head[:236] + str(count).ljust(8).encode() + head[244:] + part
        return read(whole, header_encoding="latin-1")
