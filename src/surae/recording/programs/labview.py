"""LabVIEW measurements: text (.lvm) as lvm_read reads it, binary (.tdms) as npTDMS does."""

import io
import re
from codecs import BOM_UTF8
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from surae.recording.programs.foreign import Parsed, cut_short, foreign_table, optional, packed
from surae.recording.source import Source
from surae.recording.table import Table
from surae.recording.times import is_time
from surae.recording.untrusted import untrusted

_TEXT = b"LabVIEW Measurement"
_BINARY = b"TDSm"
#: Instants before 1980 [s] are those of a clock that was never set.
_NO_CLOCK = 315_532_800.0


def recognises(source: Source) -> bool:
    """Whether it begins as one of the two does."""
    return source.data.removeprefix(BOM_UTF8).startswith((_TEXT, _BINARY))


def open_table(source: Source) -> Table:
    """The channels of all groups."""
    return foreign_table(source, "LabVIEW", __name__)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The columns of a file."""
    binary = data.startswith(_BINARY)
    library = optional("nptdms" if binary else "lvm_read", "LabVIEW", shown)
    with untrusted(shown):
        if not binary:
            return packed(list(_segments(library, data)))
        file = library.TdmsFile.read(io.BytesIO(data))
        return packed(list(_groups(file)), _began(file))


def _segments(lvm_read: Any, data: bytes) -> Iterator[Parsed]:
    """Columns of a text file, with a column of times (X_Value) for none, all or each of them."""
    whole = lvm_read.read_str(_as_it_reads(data.removeprefix(BOM_UTF8).decode(errors="replace")))
    starts = _segment_starts(whole)
    several = whole.get("X_Columns", "One") == "Multi"  # what a header says may skip their columns
    for number in range(whole["Segments"]):
        segment = whole[number]
        block = np.atleast_2d(segment["data"])
        before = f"segment {number + 1}: "
        said = {key: values for key, values in segment.items() if isinstance(values, list)}
        if several:
            said = {k: [v for v in of if str(v) not in ("", "nan")] for k, of in said.items()}
        time: Any = None
        channel = -1
        for index, name in enumerate(segment["Channel names"][: block.shape[1]]):
            if name == "X_Value":
                time = block[:, index]
            elif name and name != "Comment":
                channel += 1
                count = int(_nth(said.get("Samples"), channel, len(block)))
                step, start = (_nth(said.get(k), channel, 0.0) for k in ("Delta_X", "X0"))
                later = starts.get((number, channel), 0.0)
                clock: Any = (start + later, 1.0 / step if step > 0 else 0.0)
                if whole.get("X_Columns", "One") != "No" and time is not None:
                    clock = time[:count] + later
                unit = _nth(said.get("Y_Unit_Label"), channel, "")
                label = before * (whole["Segments"] > 1) + name
                remark = ""
                if count > len(block):
                    remark = cut_short(count, len(block))
                yield Parsed(label, block[:count, index], clock, unit, remark)


def _segment_starts(whole: Any) -> dict[tuple[int, int], float]:
    """When each channel of each segment began [s], from the first of all; by both numbers."""
    keys = []
    given = []
    for number in range(whole["Segments"]):
        dates, times = (whole[number].get(key) for key in ("Date", "Time"))
        if not isinstance(dates, list) or not isinstance(times, list):
            continue
        for channel, (date, time) in enumerate(zip(dates, times, strict=False)):
            keys.append((number, channel))
            day = str(date).strip().replace("/", "-").replace(".", "-")
            given.append(f"{day}T{str(time).strip().replace(',', '.')[:15]}")
    return dict(zip(keys, _starts(given), strict=True))


def _as_it_reads(text: str) -> str:
    """The text with what lvm_read goes by.

    It begins a segment at a blank line, which need not stand before a later one's header, and
    counts its columns by the first line there, where columns of times may not be counted.
    """
    text = re.sub(r"(?<=[^\n\r\t,])\s*\n(?=Channels[\t,])", "\n\n", text)
    if re.search(r"^X_Columns[\t,]Multi", text, re.MULTILINE):
        widen = lambda m: f"{m[1]}{m[2]}{m[3]}{m[2] * (2 * int(m[3]))}"  # noqa: E731
        text = re.sub(
            r"^(Channels)([\t,])(\d{1,4})[\t, ]*(?=\r?$)", widen, text, flags=re.MULTILINE
        )
    return text


def _nth(values: Any, index: int, default: Any) -> Any:
    """What a header says of a channel."""
    return values[index] if values and index < len(values) and values[index] else default


def _began(file: Any) -> str:
    """The date and time at which the first waveform began; empty where none says it."""
    every = [c.properties.get("wf_start_time") for group in file.groups() for c in group.channels()]
    seconds = [s for each in every if each is not None and np.isfinite(s := _instant(each))]
    if not seconds:
        return ""
    return str(np.datetime64(round(1e6 * min(seconds)), "us")).replace("T", " ")


def _groups(file: Any) -> Iterator[Parsed]:
    """Channels of a binary file: waveforms, or columns beside one of times.

    Each waveform begins at its own instant; the earliest is 0 s.
    """
    groups = file.groups()
    status = file.file_status
    cut = status.channel_statuses if status.incomplete_final_segment else None
    every = [channel for group in groups for channel in group.channels()]
    began = _starts([channel.properties.get("wf_start_time") for channel in every])
    start_of = {channel.path: start for channel, start in zip(every, began, strict=True)}
    for group in groups:
        before = f"{group.name}: " if len(groups) > 1 else ""
        channels = [c for c in group.channels() if c.dtype is not None and c.dtype.kind in "fiu"]
        times = {c.name: np.asarray(c[:], dtype=np.float64) for c in channels if is_time(c.name)}
        for channel in channels:
            if channel.name in times:
                continue
            values = np.asarray(channel[:], dtype=np.float64)
            said = channel.properties
            step = float(said.get("wf_increment", 0.0))
            start = float(said.get("wf_start_offset", 0.0)) + start_of[channel.path]
            clock: Any = (start, 1.0 / step if step > 0 else 0.0)
            if not clock[1]:
                clock = next((time for time in times.values() if len(time) == len(values)), clock)
            unit = said.get("unit_string") or said.get("NI_UnitDescription") or ""
            remark = "the file was cut short" if cut is not None else ""
            if cut is not None and channel.path in cut:
                expected = cut[channel.path].expected_length
                remark = cut_short(expected, len(values)) or remark
            yield Parsed(before + channel.name, values, clock, str(unit), remark)


def _starts(given: Sequence[Any]) -> list[float]:
    """Instants [s] from the earliest of them; 0 where none is stated."""
    seconds = [np.nan if each is None else _instant(each) for each in given]
    first = np.nanmin(seconds) if np.isfinite(seconds).any() else 0.0
    return [float(each - first) if np.isfinite(each) else 0.0 for each in seconds]


def _instant(stated: Any) -> float:
    """A date and time in seconds from 1970; NaN for one that no clock has shown."""
    try:
        moment = np.datetime64(stated, "us").astype("int64") * 1e-6
    except (ValueError, TypeError):
        return float("nan")
    return float(moment) if moment > _NO_CLOCK else float("nan")
