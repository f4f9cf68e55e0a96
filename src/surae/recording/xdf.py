"""XDF of the Lab Streaming Layer (https://github.com/sccn/xdf), read with pyxdf after a check.

Every stream is a set of columns ``stream: channel``. Clocks are synchronised by pyxdf. Time counts
from the earliest sample of all streams. Regular streams get a uniform time axis by least squares
over their stamps, which jitter with the network; where stamps lie so far from it that samples must
be missing, the stream is refused. Irregular streams keep their stamps; streams of words are left
out.
"""

import io
import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording import xdf_chunks
from surae.recording.damage import guarded, optional
from surae.recording.recording import freeze, read_only
from surae.recording.samples import sample
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.units import FloatArray

#: A stamp further than this from a uniform axis [s] is no jitter: samples are missing.
MOST_JITTER_S = 0.05


@dataclass(frozen=True, slots=True)
class _Stream:
    """One stream of numbers."""

    time: FloatArray
    values: Any
    jitter_s: float
    rate_hz: float | None
    names: tuple[str, ...]
    units: tuple[str, ...]


def recognises(source: Source) -> bool:
    """Whether it begins as XDF does."""
    return source.data.startswith(xdf_chunks.MAGIC)


def open_table(source: Source) -> Table:
    """Read the file's streams.

    Raises
    ------
    InputError
        It is damaged or cut short, has no streams of numbers, or pyxdf is missing.
    """
    pyxdf = optional("pyxdf", "XDF", source)
    with guarded(source):
        xdf_chunks.check(source)
        streams = _streams(_loaded(pyxdf, source), source)
    names = tuple(name for stream in streams for name in stream.names)
    where = {
        name: (stream, i)
        for stream in reversed(streams)
        for i, name in reversed(list(enumerate(stream.names)))
    }

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        found = {}
        for name in wanted:
            stream, column = where[name]
            if stream.rate_hz is not None and stream.jitter_s > MOST_JITTER_S:
                raise InputError(
                    f"{source.shown}: column {name!r}: its time stamps lie up to "
                    f"{1e3 * stream.jitter_s:.0f} ms from a uniform rate: samples are missing; use "
                    "a part of the recording without a gap"
                )
            found[name] = Column(
                name, stream.time, read_only(stream.values[:, column]), "time stamp", sample
            )
        return found

    return Table(
        file=source.shown,
        format="XDF",
        names=names,
        time_name="time stamp",
        load=load,
        units={name: s.units[i] for name, (s, i) in where.items() if s.units[i]},
        remarks={
            name: f"time stamps jittered by up to {1e3 * s.jitter_s:.2g} ms, replaced by a line"
            for name, (s, _) in where.items()
            if s.rate_hz is not None
        },
    )


class _Complaints(logging.Handler):
    """What pyxdf logs instead of raising."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.found: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message."""
        self.found.append(record.getMessage())


def _loaded(pyxdf: Any, source: Source) -> list[Any]:
    """The streams as pyxdf gives them; what it would skip is an error."""
    log, complaints = logging.getLogger("pyxdf"), _Complaints()
    before = log.propagate
    log.addHandler(complaints)
    log.propagate = False
    try:
        streams, _ = pyxdf.load_xdf(
            io.BytesIO(source.data), synchronize_clocks=True, dejitter_timestamps=False
        )
    finally:
        log.removeHandler(complaints)
        log.propagate = before
    if complaints.found:
        raise InputError(f"{source.shown}: the file is damaged: some of its samples are unreadable")
    return list(streams)


def _streams(loaded: Sequence[Any], source: Source) -> list[_Stream]:
    """The streams of numbers that have samples."""
    numeric = [s for s in loaded if s["info"]["channel_format"][0] != "string"]
    numeric = [s for s in numeric if len(s["time_stamps"]) > 1]
    if not numeric:
        raise InputError(f"{source.shown}: no stream of numbers with samples in it")
    stamps = [np.asarray(s["time_stamps"], dtype=np.float64) for s in numeric]
    if not all(np.isfinite(each).all() for each in stamps):
        raise InputError(f"{source.shown}: a time stamp is not a finite number")
    origin = min(float(each[0]) for each in stamps)
    found = []
    for stream, raw in zip(numeric, stamps, strict=True):
        info = stream["info"]
        regular = float(info["nominal_srate"][0]) > 0
        time, jitter, rate = raw - origin, 0.0, None
        if regular:
            time, jitter, rate = _line(time, source)
        names, units = _described(info, np.asarray(stream["time_series"]).shape[1])
        found.append(_Stream(freeze(time), stream["time_series"], jitter, rate, names, units))
    return found


def _line(time: FloatArray, source: Source) -> tuple[FloatArray, float, float]:
    """Uniform times by least squares, the largest distance of a stamp [s], and the rate [Hz]."""
    index = np.arange(len(time), dtype=np.float64)
    centred = index - index.mean()
    step = float(centred @ time / (centred @ centred))
    if not step > 0:
        raise InputError(f"{source.shown}: a stream's time stamps don't increase")
    fitted = time.mean() + step * centred
    return fitted, float(np.max(np.abs(time - fitted))), 1.0 / step


def _described(info: Any, count: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of a stream's channels."""
    stream = _text(info.get("name"))
    described: list[Any] = []
    try:
        described = list(info["desc"][0]["channels"][0]["channel"])
    except (KeyError, IndexError, TypeError):
        described = []
    labels, units = [], []
    for i in range(count):
        one = described[i] if i < len(described) and isinstance(described[i], dict) else {}
        label = _text(one.get("label")) or f"channel {i + 1}"
        labels.append(f"{stream}: {label}" if stream else label)
        units.append(_text(one.get("unit")))
    return tuple(labels), tuple(units)


def _text(values: Any) -> str:
    """The first of some texts, in one printable line."""
    first = values[0] if isinstance(values, list) and values else ""
    return "".join(c for c in first if c.isprintable()).strip() if isinstance(first, str) else ""
