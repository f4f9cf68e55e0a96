"""C3D of motion capture (https://www.c3d.org): analog channels, and the coordinates of points.

ezc3d reads the parameters. The samples are taken from the file here, because ezc3d believes the
parameters where the header and the file's own size contradict them and then reads other samples
than those that were written, reads scales that do not exist, and takes an offset without its sign.
A channel's value is (raw - OFFSET) · SCALE · GEN_SCALE in UNITS. Points are markers, and what
models compute of them: angles, moments, forces and powers of joints, each with three coordinates.
Frames of points carry a whole number of analog samples each; time counts from the first frame of
the file, wherever in the trial that was. Frames in which a point was not seen are left out: gaps
stay in the times.
"""

import math
import struct
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording.programs.foreign import Parsed, Patience, foreign_table, optional, packed
from surae.recording.source import Source
from surae.recording.table import Table
from surae.recording.untrusted import untrusted

_BLOCK = 512
_INTEL = 84
_DEC = 85
_MIPS = 86
#: A count of frames in 16 bits that ends here may mean more.
_UNCOUNTED = 65535
#: Zeros that are a frame of any file.
_FRAME = 2**18
#: ezc3d reads no more than the parameters: what takes it longer are dimensions that a file invents.
_PATIENCE = Patience(2.0, 5e-8)
#: Groups of points that are no places; their unit is in ANGLE_UNITS, FORCE_UNITS, …
_KINDS = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS")
#: Parameters continue in others where there are more values than one holds: LABELS2, LABELS3, ...
_PARTS = 99


def recognises(source: Source) -> bool:
    """Whether it begins as C3D does: a block number, the byte 80, and parameters there."""
    data = source.data
    if len(data) < 2 * _BLOCK or data[1] != 0x50 or not data[0]:
        return False
    begin = (data[0] - 1) * _BLOCK
    return len(data) > begin + 4 and data[begin + 3] in (_INTEL, _DEC, _MIPS)


def open_table(source: Source) -> Table:
    """The channels and points; a file that contradicts itself beyond telling is refused."""
    return foreign_table(source, "C3D", __name__, _PATIENCE)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The columns of a file."""
    with untrusted(shown):
        parameters = _Parameters(data, shown)
        layout, doubts = _layout(data, parameters, shown)
        points, analog = _samples(data, layout, parameters.processor)
        point_hz, analog_hz, doubt = _rates(data, parameters, layout, shown)
        if parameters.cut:
            doubts = [
                *doubts,
                "its parameters end before their block does: if names or units are "
                "missing, it was cut short",
            ]
        about = [*doubts, doubt] if doubt else doubts
        columns = [*_channels(parameters, layout, analog, analog_hz, about)]
        columns += _points(parameters, layout, points, point_hz, doubts, alone=not columns)
        if not columns:
            raise InputError(f"{shown}: this C3D file holds neither analog channels nor points")
        return packed(columns)


class _Parameters:
    """What the parameters say, as ezc3d reads them; it is shown nothing behind them."""

    def __init__(self, data: bytes, shown: str) -> None:
        ezc3d = optional("ezc3d", "C3D", shown)
        begin = (data[0] - 1) * _BLOCK
        self.processor = data[begin + 3]
        if self.processor == _MIPS:
            raise InputError(
                f"{shown}: C3D as SGI computers wrote it, which ezc3d does not read; save it again "
                "with the software that made it"
            )
        (block,) = struct.unpack_from("<H", data, 16)
        end = max(begin + data[begin + 2] * _BLOCK, (block - 1) * _BLOCK)
        # A section behind the samples may end with its last parameter, not with its block.
        self.cut = len(data) < end
        with tempfile.TemporaryDirectory(prefix="surae-") as folder:
            path = Path(folder) / "parameters.c3d"
            path.write_bytes(data[:end].ljust(end, b"\0"))
            try:
                groups = ezc3d.c3d(str(path), ignore_bad_formatting=True)["parameters"]
            except ValueError:  # it insists on a frame
                path.write_bytes(data[:end] + bytes(_FRAME))
                groups = ezc3d.c3d(str(path), ignore_bad_formatting=True)["parameters"]
        self._groups: Mapping[str, Any] = {name: groups[name] for name in groups}

    def texts(self, group: str, name: str) -> list[str]:
        """A parameter's texts, empty where it has none."""
        return [_text(text) for text in self._values(group, name) if isinstance(text, str)]

    def numbers(self, group: str, name: str) -> list[float]:
        """A parameter's numbers, empty where it has none."""
        return [float(x) for x in self._values(group, name) if not isinstance(x, str)]

    def number(self, group: str, name: str, default: float = 0.0) -> float:
        """The first of a parameter's numbers."""
        return next(iter(self.numbers(group, name)), default)

    def whole(self, group: str, name: str) -> int | None:
        """A count, stored in 16 bits that may be meant without a sign."""
        number = self.number(group, name, math.nan)
        if not math.isfinite(number):
            return None
        return int(number) % 65536 if number < 0 else int(number)

    def real(self, raw: bytes) -> float:
        """A 32-bit float of the header, as the file's processor stores it."""
        if self.processor != _DEC:
            return float(struct.unpack("<f", raw)[0])
        return float(struct.unpack("<f", raw[2:] + raw[:2])[0]) / 4

    def _values(self, group: str, name: str) -> Iterator[Any]:
        """The values of a parameter and its continuations."""
        for part in range(1, _PARTS):
            parameter = self._groups.get(group, {}).get(name if part == 1 else f"{name}{part}")
            if parameter is None:
                return
            yield from np.ravel(parameter["value"], order="F").tolist()


@dataclass(frozen=True, slots=True)
class _Layout:
    """The places of the samples in the file."""

    begin: int
    frames: int
    points: int
    channels: int
    per_frame: int
    floats: bool
    signed: bool
    point_scale: float

    @property
    def words(self) -> int:
        """Numbers of a frame."""
        return 4 * self.points + self.channels * self.per_frame

    @property
    def bytes_per_frame(self) -> int:
        """Size of a frame."""
        return self.words * (4 if self.floats else 2)

    def fills(self, data: bytes) -> bool:
        """Whether the samples end where the file does, apart from the rest of a block."""
        end = self.begin + self.frames * self.bytes_per_frame
        return end <= len(data) and (len(data) - end < _BLOCK or not any(data[end:]))


def _layout(data: bytes, parameters: _Parameters, shown: str) -> tuple[_Layout, list[str]]:
    """Header and parameters put together; where they differ, the file's size decides."""
    in_header, samples, first_frame, last_frame = struct.unpack_from("<4H", data, 2)
    block, per_frame = struct.unpack_from("<2H", data, 16)
    scale = parameters.real(data[12:16]) or parameters.number("POINT", "SCALE", 1.0)
    begin = ((parameters.whole("POINT", "DATA_START") or block) - 1) * _BLOCK
    if not _BLOCK <= begin <= len(data):
        raise InputError(f"{shown}: the file is cut short or damaged (no data block)")
    signed = [text.upper() for text in parameters.texts("ANALOG", "FORMAT")[:1]] != ["UNSIGNED"]
    points, channels = (parameters.whole(group, "USED") for group in ("POINT", "ANALOG"))
    analog = samples // per_frame if per_frame else 0
    point_hz, analog_hz = (parameters.number(group, "RATE") for group in ("POINT", "ANALOG"))
    ratio = analog_hz / point_hz if point_hz else 0.0
    shapes = [
        (p, c, n)
        for n in dict.fromkeys((per_frame, round(ratio) if 0.0 < ratio < _UNCOUNTED else 0))
        for p in dict.fromkeys((in_header if points is None else points, in_header))
        for c in dict.fromkeys((analog if channels is None else channels, analog))
        if 4 * p + c * n
    ]
    announced = _frames(parameters, last_frame - first_frame + 1)
    layouts = [
        _Layout(begin, n, *shape, scale < 0, signed, scale)
        for n in announced or [_UNCOUNTED]
        for shape in shapes
    ]
    if not layouts:
        raise InputError(f"{shown}: this C3D file holds neither analog channels nor points")
    exact = [each for each in layouts if each.fills(data)]
    first = (exact or layouts)[0]
    doubts = []
    if not exact and len({each[:2] for each in shapes}) > 1:
        claims = " or ".join(f"{p} points and {c} channels" for p, c in {e[:2] for e in shapes})
        raise InputError(f"{shown}: the file contradicts itself: {claims}; its size fits neither")
    if points not in (None, first.points) or (first.per_frame and channels != first.channels):
        doubts.append(
            f"the parameters say {points} points and {channels} channels, header and size of the "
            f"file {first.points} and {first.channels}, which is believed"
        )
    complete = (len(data) - begin) // first.bytes_per_frame
    if not announced or (first.frames >= _UNCOUNTED - 1 and not exact):
        first = replace(first, frames=complete)
    if complete < 1:
        raise InputError(f"{shown}: the file is cut short: it holds no frame")
    if complete < first.frames:
        doubts.append(f"the file is cut short: it holds {complete} of its {first.frames} frames")
        first = replace(first, frames=complete)
    elif announced and first.frames != announced[0]:
        doubts.append(f"{announced[0]} frames are announced, but the file holds {first.frames}")
    if first_frame > 1:
        doubts.append(f"time 0 is frame {first_frame} of the trial")
    return first, doubts


def _frames(parameters: _Parameters, counted: int) -> list[int]:
    """Numbers of frames that the file states; only the first count beyond 16 bits."""
    stated = [parameters.whole("POINT", "LONG_FRAMES"), counted]
    if last := parameters.numbers("TRIAL", "ACTUAL_END_FIELD"):
        first = parameters.numbers("TRIAL", "ACTUAL_START_FIELD") or [1.0]
        # Each in two words of 16 bits, the low one first.
        begin, end = (
            int(words[0]) % 65536 + (int([*words, 0.0][1]) % 65536 << 16) for words in (first, last)
        )
        stated.insert(0, end - begin + 1)
    return list(dict.fromkeys(count for count in stated if count and count > 0))


def _rates(
    data: bytes, parameters: _Parameters, layout: _Layout, shown: str
) -> tuple[float, float, str]:
    """Rates of frames and of analog samples [Hz], and what is doubtful about the latter."""
    point = parameters.number("POINT", "RATE") or parameters.real(data[20:24])
    analog = parameters.number("ANALOG", "RATE")
    if not point and layout.per_frame:
        point = analog / layout.per_frame
    if not (math.isfinite(point) and point > 0):
        raise InputError(f"{shown}: {point:g} frames/s: not a sampling rate")
    counted = point * layout.per_frame
    if math.isclose(analog, counted, rel_tol=1e-3):
        return point, analog, ""
    doubt = (
        f"the file states {analog:g} Hz, but {layout.per_frame} samples in each of {point:g} "
        f"frames/s are {counted:g} Hz, which is used"
    )
    return point, counted, doubt


def _samples(data: bytes, layout: _Layout, processor: int) -> tuple[FloatArray, FloatArray]:
    """Points, shape (frames, points, 4), and raw analog samples, shape (n, channels)."""
    kind = "f4" if layout.floats else "i2" if layout.signed else "u2"
    swapped = layout.floats and processor == _DEC
    raw = np.frombuffer(
        data, f"<{'u4' if swapped else kind}", layout.frames * layout.words, layout.begin
    ).reshape(layout.frames, layout.words)
    with np.errstate(all="ignore"):
        if swapped:
            raw = ((raw << 16) | (raw >> 16)).view("<f4") / np.float32(4)
        points = raw[:, : 4 * layout.points]
        if kind == "u2":  # which says how analog samples are stored
            points = points.view("<i2")
        return (
            points.astype(np.float64).reshape(layout.frames, layout.points, 4),
            raw[:, 4 * layout.points :].astype(np.float64).reshape(-1, layout.channels or 1),
        )


def _channels(
    parameters: _Parameters, layout: _Layout, analog: FloatArray, rate_hz: float, doubts: list[str]
) -> Iterator[Parsed]:
    """Read the analog channels."""
    names = _names(parameters.texts("ANALOG", "LABELS"), "channel", layout.channels)
    units, described = (parameters.texts("ANALOG", name) for name in ("UNITS", "DESCRIPTIONS"))
    scales, offsets = (parameters.numbers("ANALOG", name) for name in ("SCALE", "OFFSET"))
    general = parameters.number("ANALOG", "GEN_SCALE", 1.0)
    plates = parameters.numbers("FORCE_PLATFORM", "CHANNEL")
    each = len(plates) // (parameters.whole("FORCE_PLATFORM", "USED") or 1) or 1
    plate = {int(at) - 1: f"force plate {k // each + 1}" for k, at in enumerate(plates)}
    for index, name in enumerate(names):
        remarks = [*described[index : index + 1], plate.get(index, ""), *doubts]
        refused = ""
        values = analog[:0, index]
        if index >= len(scales):
            refused = "the file states no scale for it, so its values have no unit"
        elif offsets and index >= len(offsets):
            refused = "the file states no offset for it, so its zero is not known"
        else:
            if not offsets:
                remarks.append("no offset is stated: taken as 0")
            elif scales[index] == 0:
                remarks.append("its scale is 0, so all its values are")
            offset = offsets[index] if offsets else 0.0
            with np.errstate(all="ignore"):
                values = analog[:, index] - (offset if layout.signed else offset % 65536)
                values *= scales[index] * general
        yield Parsed(
            name,
            values,
            (0.0, rate_hz),
            "".join(units[index : index + 1]),
            "; ".join(filter(None, remarks)),
            refused,
            description="".join(described[index : index + 1]),
        )


def _points(
    parameters: _Parameters,
    layout: _Layout,
    points: FloatArray,
    rate_hz: float,
    doubts: list[str],
    *,
    alone: bool,
) -> Iterator[Parsed]:
    """The coordinates of points in the frames in which they were seen."""
    labels = parameters.texts("POINT", "LABELS")
    names = _names(labels, "point", layout.points)
    units = {
        name: "".join(parameters.texts("POINT", f"{group[:-1]}_UNITS")[:1])
        for group in _KINDS
        for name in parameters.texts("POINT", group)
    }
    if alone and not units:
        doubts = ["a marker: this file holds markers alone, no angle, torque or EMG", *doubts]
    place = "".join(parameters.texts("POINT", "UNITS")[:1])
    scale = 1.0 if layout.floats else layout.point_scale
    lost = np.signbit(points[:, :, 3])
    if lost.size and lost.all():  # a mark that marks everything says nothing
        lost[:] = False
        doubts = [
            "every frame of every point is marked as lost, yet has values, which are read",
            *doubts,
        ]
    for index, name in enumerate(names):
        seen = ~(lost[:, index] | np.isnan(points[:, index, :3]).any(axis=1))
        time: tuple[float, float] | FloatArray = (0.0, rate_hz)
        remarks = doubts
        if not seen.all():
            time = np.flatnonzero(seen) / rate_hz
            remarks = [*doubts, f"only {len(time)} of {len(seen)} frames have it"]
        unit = units.get(labels[index] if index < len(labels) else name, place)
        for axis, letter in enumerate("XYZ"):
            values = points[seen, index, axis] * scale
            yield Parsed(f"{name}.{letter}", values, time, unit, "; ".join(remarks))


def _names(labels: Sequence[str], kind: str, count: int) -> list[str]:
    """Names of columns, each once; one without a label is called by its number."""
    counts: Counter[str] = Counter()
    unique = []
    for number in range(1, count + 1):
        name = "".join(labels[number - 1 : number]) or f"{kind} {number}"
        counts[name] += 1
        unique.append(name if counts[name] == 1 else f"{name} #{counts[name]}")
    return unique


def _text(text: str) -> str:
    """A text in one printable line; ezc3d keeps bytes that are no UTF-8."""
    return cleaned(text.partition("\0")[0])
