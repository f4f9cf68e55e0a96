"""XDF of the Lab Streaming Layer (https://github.com/sccn/xdf), read with pyxdf.

Every stream is a set of columns ``stream: channel``. Clocks are synchronised by pyxdf. Time counts
from the earliest sample of all streams. Regular streams get a uniform time axis by least squares
over their stamps, which jitter with the network; where samples are missing it has a gap, which a
check then finds, and where no such axis fits the stamps, the stream is refused. Irregular streams
keep their stamps; streams of words are left out, and the target that surae itself sends, which is
no measurement. What pyxdf skips with a message in its log, or
fills with the sample before where the file ends early, is refused.
"""

import io
import logging
import os
import sys
from collections.abc import Iterator, Mapping
from itertools import chain
from logging.handlers import BufferingHandler
from typing import Any, BinaryIO

import numpy as np

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.names import TARGET_SOURCE
from surae.base.units import FloatArray
from surae.recording.programs.foreign import Parsed, foreign_table, optional, packed
from surae.recording.source import Source
from surae.recording.table import Table
from surae.recording.untrusted import untrusted

_MAGIC = b"XDF:"
#: A stamp further than this from a uniform axis [s] is no jitter.
MOST_JITTER_S = 0.05
#: A step of a clock's offset that stays for three measurements, and is larger than this [s] and
#: what a clock may drift meanwhile, is no drift.
_CLOCK_STEP = 0.02
_DRIFT = 2e-4
#: A step of the stamps is a gap where they stay away, for this long [s] before and after, by more
#: than this [s] and than so many periods, beside three times their scatter; jitter comes back.
_STAY = 0.5
_STEP = 0.005
_STEP_PERIODS = 3.0
_SCATTER = 3.0


def recognises(source: Source) -> bool:
    """Whether it begins as XDF does."""
    return source.data.startswith(_MAGIC)


def open_table(source: Source) -> Table:
    """The file's streams; one that is damaged or has none of numbers is refused."""
    return foreign_table(source, "XDF", __name__)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The streams of numbers that have samples."""
    pyxdf = optional("pyxdf", "XDF", shown)
    with untrusted(shown):
        end = xdf_end(io.BytesIO(data))
        if end < len(data):
            raise InputError(f"{shown}: the file is cut short or damaged at byte {end}")
        streams = [
            (stream, np.asarray(stream["time_series"]), np.asarray(stream["time_stamps"]))
            for stream in _loaded(pyxdf, data, shown)
            if _is_measured(stream["info"]) and len(stream["time_stamps"]) > 1
        ]
        if not streams:
            raise InputError(f"{shown}: no stream of numbers with samples in it")
        if not all(np.isfinite(stamps).all() for _, _, stamps in streams):
            raise InputError(f"{shown}: a time stamp is not a finite number")
        origin = min(float(stamps[0]) for _, _, stamps in streams)
        columns = (_columns(stream, values, stamps - origin) for stream, values, stamps in streams)
        return packed(list(chain.from_iterable(columns)))


def xdf_end(file: BinaryIO) -> int:
    """Where the last whole chunk ends that follows others from the file's beginning."""
    size = file.seek(0, os.SEEK_END)
    at = len(_MAGIC)
    while at < size:
        file.seek(at)
        head = file.read(9)
        width = head[0] if head[0] in (1, 4, 8) else 0  # bytes of the length
        length = int.from_bytes(head[1 : 1 + width], "little")
        if not length or at + 1 + width + length > size:
            break
        at += 1 + width + length
    return at


def _loaded(pyxdf: Any, data: bytes, shown: str) -> list[Any]:
    """The streams as pyxdf gives them; what it would skip, logging an error, is one."""
    log = logging.getLogger("pyxdf")
    complaints = BufferingHandler(sys.maxsize)
    complaints.setLevel(logging.ERROR)
    before = log.propagate
    log.propagate = False
    log.addHandler(complaints)
    try:
        streams, _ = pyxdf.load_xdf(
            io.BytesIO(data), synchronize_clocks=True, dejitter_timestamps=False
        )
    finally:
        log.removeHandler(complaints)
        log.propagate = before
    if complaints.buffer:
        raise InputError(f"{shown}: the file is damaged: some of its samples are unreadable")
    return list(streams)


def _is_measured(info: Mapping[str, Any]) -> bool:
    """Whether a stream has numbers of somebody else: not what was asked for."""
    words = info["channel_format"][0] == "string"
    return not words and _text(info.get("source_id")) != TARGET_SOURCE


def _columns(
    stream: Mapping[str, Any], values: np.ndarray[Any, Any], time: FloatArray
) -> Iterator[Parsed]:
    """The channels of a stream."""
    info = stream["info"]
    refused = ""
    remark = ""
    if float(info["nominal_srate"][0]) > 0:
        time, jitter_ms, gaps = _axis(time)
        remark = f"time stamps jittered by up to {jitter_ms:.2g} ms, replaced by a line"
        if gaps:
            remark += f" with {gaps} gap{'s' if gaps > 1 else ''} where samples are missing"
        if np.any(np.diff(time) <= 0):
            refused = "its time stamps don't increase"
        elif jitter_ms > 1e3 * MOST_JITTER_S:
            refused = (
                f"its time stamps lie up to {jitter_ms:.0f} ms from a uniform rate: samples are "
                "missing; use a part of the recording without a gap"
            )
    if step := _clock_step(stream):
        refused = (
            f"its clock jumped by {step:.2g} s during the recording, so its samples cannot be "
            "aligned with those of others; record again"
        )
    name = _text(info.get("name"))
    for index, (label, unit) in enumerate(_described(info, values.shape[1])):
        full = f"{name}: {label}" if name else label
        yield Parsed(full, values[:, index], time, unit, remark, refused, "time stamp")


def _clock_step(stream: Mapping[str, Any]) -> float:
    """A lasting step of a stream's clock [s] that pyxdf has drawn one line through, or 0."""
    if len(stream["info"]["clock_segments"]) > 1:  # it has seen it, and drawn a line for each part
        return 0.0
    times = np.asarray(stream["clock_times"])
    offsets = np.asarray(stream["clock_values"])
    for at in range(2, len(offsets) - 1):
        before = slice(max(at - 3, 0), at)
        after = slice(at, at + 3)
        step = abs(float(np.median(offsets[after]) - np.median(offsets[before])))
        apart = abs(float(np.median(times[after]) - np.median(times[before])))
        if step > _CLOCK_STEP + _DRIFT * apart:
            return step
    return 0.0


def _axis(time: FloatArray) -> tuple[FloatArray, float, int]:
    """Times with one step by least squares, the stamps' largest distance [ms], and the gaps."""
    pieces = _pieces(time)
    index = np.arange(len(time), dtype=np.float64)
    centred = np.concatenate([index[piece] - index[piece].mean() for piece in pieces])
    step = float(centred @ time / (centred @ centred))
    fitted = np.concatenate([time[piece].mean() + step * centred[piece] for piece in pieces])
    return fitted, 1e3 * float(np.max(np.abs(time - fitted))), len(pieces) - 1


def _pieces(time: FloatArray) -> list[slice]:
    """The parts of a stream's stamps between which samples are missing."""
    steps = np.diff(time)
    period = float(np.median(steps))
    away = time - period * np.arange(len(time))
    least = max(_STEP, _STEP_PERIODS * period)
    candidates = np.flatnonzero(np.abs(steps - period) > least) + 1
    window = max(int(_STAY / period), 3) if period > 0 else 3
    open_ = [(0, len(time))]
    pieces = []
    while open_:
        first, last = open_.pop()
        best = 0.0
        at = 0
        for here in candidates[(candidates > first) & (candidates < last)]:
            before = away[max(here - window, first) : here]
            after = away[here:][:window]
            after = after[: last - here]
            ends = float(np.median(before)), float(np.median(after))
            scatter = max(
                float(np.median(np.abs(part - end)))
                for part, end in zip((before, after), ends, strict=True)
            )
            if abs(ends[1] - ends[0]) - least - _SCATTER * scatter > best:
                best = abs(ends[1] - ends[0]) - least - _SCATTER * scatter
                at = int(here)
        if at:
            open_ += [(first, at), (at, last)]
        else:
            pieces.append(slice(first, last))
    return sorted(pieces, key=lambda piece: int(piece.start))


def _described(info: Mapping[str, Any], count: int) -> Iterator[tuple[str, str]]:
    """Names and units of a stream's channels."""
    try:
        described = list(info["desc"][0]["channels"][0]["channel"])
    except (KeyError, IndexError, TypeError):
        described = []
    for index in range(count):
        channel = described[index] if index < len(described) else {}
        known = channel if isinstance(channel, dict) else {}
        yield _text(known.get("label")) or f"channel {index + 1}", _text(known.get("unit"))


def _text(values: Any) -> str:
    """The first of some texts, in one printable line."""
    first = values[0] if isinstance(values, list) and values else ""
    return cleaned(first) if isinstance(first, str) else ""
