"""C3D: the analog channels of a motion-capture file (https://www.c3d.org), markers left out.

A channel's value is (raw - OFFSET) · SCALE · GEN_SCALE in UNITS. Frames of points carry a whole
number of analog samples each; time counts from the first frame of the file, wherever in the trial
that was.
"""

import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.recording.c3d_parameters import Parameters, read_parameters, to_float
from surae.recording.recording import freeze
from surae.recording.samples import sample
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.recording.timing import instants
from surae.units import FloatArray

_BLOCK = 512
_ANALOG = "ANALOG"
#: What a count in 16 bits says when it is too small.
_UNCOUNTED = 65535


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where the analog samples are, checked against the file's size."""

    first: int
    frames: int
    words: int
    before: int
    channels: int
    per_frame: int
    floats: bool
    signed: bool
    processor: int
    first_frame: int


def recognises(source: Source) -> bool:
    """Whether it begins as C3D does: a block number, the byte 80, and parameters there."""
    data = source.data
    if len(data) < 2 * _BLOCK or data[1] != 0x50 or not data[0]:
        return False
    begin = (data[0] - 1) * _BLOCK
    return len(data) > begin + 4 and data[begin + 3] in (84, 85, 86)


def open_table(source: Source) -> Table:
    """Read header and parameters.

    Raises
    ------
    InputError
        There are no analog channels, or the file is damaged or cut short.
    """
    parameters = read_parameters(source)
    layout = _layout(source, parameters)
    count = layout.channels
    names = _names(parameters.texts(_ANALOG, "LABELS"), count)
    units = parameters.texts(_ANALOG, "UNITS")[:count]
    scales = parameters.numbers(_ANALOG, "SCALE")
    offsets = parameters.numbers(_ANALOG, "OFFSET")
    general = (parameters.numbers(_ANALOG, "GEN_SCALE") or [1.0])[0]
    if not layout.signed:
        offsets = [offset % 65536 for offset in offsets]
    if len(scales) < count or len(offsets) < count:
        raise InputError(
            f"{source.shown}: {count} analog channels, but {min(len(scales), len(offsets))} with "
            "scale and offset; the file is damaged"
        )
    rate = _rate(source, parameters, layout)
    n = layout.frames * layout.per_frame
    described = parameters.texts(_ANALOG, "DESCRIPTIONS")
    remarks = {name: text for name, text in zip(names, described, strict=False) if text}
    if layout.first_frame > 1:
        cropped = f"time 0 is frame {layout.first_frame} of the trial"
        remarks = {
            name: "; ".join([*([remarks[name]] if name in remarks else []), cropped])
            for name in names
        }

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        time = instants(0.0, rate, n)
        columns = {}
        for name in wanted:
            at = names.index(name)
            values = _values(source, layout, at, offsets[at], scales[at] * general)
            columns[name] = Column(name, time, values, "time", sample)
        return columns

    return Table(
        file=source.shown,
        format="C3D",
        names=names,
        time_name="time",
        load=load,
        units={name: unit for name, unit in zip(names, units, strict=False) if unit},
        remarks=remarks,
    )


def _layout(source: Source, parameters: Parameters) -> _Layout:
    """Header and parameters put together; the parameters count where both say it."""
    data, kind = source.data, parameters.processor
    order = ">" if kind == 86 else "<"
    points, per_all, first, last = struct.unpack_from(f"{order}4H", data, 2)
    block, per_frame = struct.unpack_from(f"{order}2H", data, 16)
    scale = to_float(data[12:16], kind)
    points = _whole(parameters, "POINT", "USED", points)
    channels = _whole(parameters, _ANALOG, "USED", per_all // per_frame if per_frame else 0)
    if not channels or not per_frame:
        raise InputError(f"{source.shown}: this C3D file holds no analog channels")
    begin = (_whole(parameters, "POINT", "DATA_START", block) - 1) * _BLOCK
    if begin < _BLOCK:
        raise InputError(f"{source.shown}: the file is damaged (no data block)")
    floats = scale < 0
    words = 4 * points + channels * per_frame
    size = words * (4 if floats else 2)
    frames = _frames(parameters, last - first + 1 if last >= first else 0)
    held = max(len(data) - begin, 0) // size
    if frames < 1 or held < frames:
        raise InputError(
            f"{source.shown}: the file is cut short or damaged: it holds {held} of {frames} frames"
        )
    if frames == _UNCOUNTED and held > frames + _BLOCK:
        raise InputError(f"{source.shown}: its count of frames ends at {frames}, but it holds more")
    # 16-bit counts above 32767: only a file that says so means them.
    texts = parameters.texts(_ANALOG, "FORMAT")
    signed = not (texts and texts[0].upper() == "UNSIGNED")
    return _Layout(
        begin, frames, words, 4 * points, channels, per_frame, floats, signed, kind, first
    )


def _frames(parameters: Parameters, header: int) -> int:
    """Number of frames; only the newer parameters count beyond 16 bits."""
    if end := parameters.numbers("TRIAL", "ACTUAL_END_FIELD"):
        begin = parameters.numbers("TRIAL", "ACTUAL_START_FIELD") or [1.0, 0.0]
        return _long(end) - _long(begin) + 1
    for name in ("LONG_FRAMES", "FRAMES"):
        stated = parameters.numbers("POINT", name)
        if stated and math.isfinite(stated[0]):
            return int(stated[0]) % 65536 if stated[0] < 0 else int(stated[0])
    return header


def _long(words: Sequence[float]) -> int:
    """A number in two words of 16 bits, the low one first."""
    low, high = (int(word) % 65536 for word in [*words, 0.0][:2])
    return low + (high << 16)


def _rate(source: Source, parameters: Parameters, layout: _Layout) -> float:
    """The analog rate [Hz]; where the file states two that differ, none is right."""
    point = (parameters.numbers("POINT", "RATE") or [0.0])[0]
    if not point:
        point = to_float(source.data[20:24], layout.processor)
    analog = (parameters.numbers(_ANALOG, "RATE") or [point * layout.per_frame])[0]
    if not (math.isfinite(analog) and analog > 0):
        raise InputError(f"{source.shown}: analog rate {analog:g} Hz: not a sampling rate")
    if not math.isclose(analog, point * layout.per_frame, rel_tol=1e-3):
        raise InputError(
            f"{source.shown}: analog rate {analog:g} Hz contradicts {point:g} frames/s with "
            f"{layout.per_frame} samples each; the file is damaged"
        )
    return analog


def _values(source: Source, layout: _Layout, at: int, offset: float, scale: float) -> FloatArray:
    """One channel in its unit."""
    order = ">" if layout.processor == 86 else "<"
    if layout.floats:
        kind = np.dtype("<u4" if layout.processor == 85 else f"{order}f4")
    else:
        kind = np.dtype(f"{order}{'i' if layout.signed else 'u'}2")
    raw = np.ndarray(
        shape=(layout.frames, layout.per_frame),
        dtype=kind,
        buffer=source.data,
        offset=layout.first + kind.itemsize * (layout.before + at),
        strides=(kind.itemsize * layout.words, kind.itemsize * layout.channels),
    )
    with np.errstate(all="ignore"):
        if layout.floats and layout.processor == 85:
            raw = ((raw << 16) | (raw >> 16)).view("<f4") / np.float32(4)
        values = raw.astype(np.float64).reshape(-1)
        values -= offset
        values *= scale
    return freeze(values)


def _whole(parameters: Parameters, group: str, name: str, default: int) -> int:
    """A count, stored in 16 bits that may be meant without a sign."""
    found = parameters.numbers(group, name)
    return int(found[0]) % 65536 if found and math.isfinite(found[0]) else default


def _names(labels: Sequence[str], count: int) -> tuple[str, ...]:
    """Names of the channels; one without a label is called by its number."""
    padded = [*labels[:count], *([""] * (count - len(labels)))]
    return tuple(label or f"channel {index}" for index, label in enumerate(padded, start=1))
