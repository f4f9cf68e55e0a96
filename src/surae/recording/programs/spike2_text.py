"""Text exports of Spike2: channels one below the other, each with its title, unit and rate.

A summary lists the channels; each then begins with ``"CHANNEL"``, and its samples follow lines
``"START"`` (or ``"GAP"``, where sampling stopped) with an instant and the time between samples.
That time is rounded, so that the rate is the summary's where both agree.
"""

import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.units import FloatArray
from surae.recording.headings import numeric
from surae.recording.rows import split
from surae.recording.source import Source
from surae.recording.table import Column, Table

#: The summary's rate may differ from the rounded time between samples by so much [part].
_ROUNDED = 0.02
#: Lines among which the summary is.
_HEAD = 40
_FEWEST = 2


@dataclass(frozen=True, slots=True)
class _Channel:
    """A channel as it is read."""

    number: str
    words: list[str] = field(default_factory=list)  #: The lines before its samples.
    #: Instant and time between samples [s] of every stretch, and its samples.
    stretches: list[tuple[float, float, list[float]]] = field(default_factory=list)

    @property
    def title(self) -> str:
        """Its title, or its number."""
        return (self.words[2] if len(self.words) > 2 else "") or f"channel {self.number}"

    @property
    def unit(self) -> str:
        """Its unit; empty where it has none."""
        return next((word for word in self.words[3:] if word and not numeric(word)), "")


def recognises(source: Source) -> bool:
    """Whether it begins with Spike2's information and summary."""
    head = [line.strip() for line in source.head()[:_HEAD]]
    return '"INFORMATION"' in head[:3] and '"SUMMARY"' in head


def open_table(source: Source) -> Table:
    """The waveforms; events and markers are left out."""
    source.require_text()
    channels = [c for c in _channels(source) if c.stretches]
    if not channels:
        raise InputError(
            f"{source.shown}: Spike2's text holds no waveform; export it with the waveforms, or as "
            "MATLAB data"
        )
    rates = _rates(source)
    made = {}
    for channel in channels:
        name = channel.title
        if name in made:
            name = f"{name} ({channel.number})"
        made[name] = _column(name, channel, rates.get(channel.number, 0.0))
    made = _whole(made, len(rates))
    units = {name: c.unit for name, c in zip(made, channels, strict=True) if c.unit}

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return {name: made[name] for name in wanted}

    return Table(source.shown, "Spike2 text", tuple(made), "time", load, units)


def _cells(source: Source, row: int, line: str) -> list[str]:
    try:
        return split(line.strip("\n"), "\t")
    except csv.Error as error:
        raise InputError(f"{source.shown}: row {row}: {error}") from None


def _channels(source: Source) -> Iterator[_Channel]:
    """The channels in the file's order."""
    channel: _Channel | None = None
    for row, line in enumerate(source.lines(), start=1):
        text = line.strip()
        if text.startswith('"CHANNEL"'):
            if channel is not None:
                yield channel
            channel = _Channel([*_cells(source, row, line), ""][1])
        elif channel is None:
            continue
        elif text.startswith(('"START"', '"GAP"')):
            begin = _numbers(_cells(source, row, line)[1:3])
            if len(begin) < 2 or not begin[1] > 0.0:
                raise InputError(
                    f"{source.shown}: row {row}: {text!r} is no instant and time between samples"
                )
            channel.stretches.append((begin[0], begin[1], []))
        elif not channel.stretches:
            channel.words.extend(_cells(source, row, line) if text else [])
        elif text:
            sample = _numbers([text])
            if not sample:
                raise InputError(f"{source.shown}: row {row}: {text[:40]!r} is not a number")
            channel.stretches[-1][2].append(sample[0])
    if channel is not None:
        yield channel


def _numbers(cells: Sequence[str]) -> list[float]:
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        return []


def _rates(source: Source) -> dict[str, float]:
    """The rate of every waveform in the summary [Hz], that of the converter where it is said."""
    rates = {}
    for row, line in enumerate(islice(source.lines(), 10 * _HEAD), start=1):
        if line.startswith('"CHANNEL"'):
            break
        cells = _cells(source, row, line)
        if len(cells) > 4 and cells[1] == "Waveform":
            wanted, *others = _numbers(cells[4:6]) or [0.0]
            near = [rate for rate in others if abs(rate - wanted) <= _ROUNDED * wanted]
            rates[cells[0]] = near[0] if near else wanted
    return rates


def _column(name: str, channel: _Channel, rate: float) -> Column:
    """A channel's samples at its times."""
    times: list[FloatArray] = []
    values: list[float] = []
    for start, step, samples in channel.stretches:
        agrees = rate > 0.0 and abs(rate * step - 1.0) <= _ROUNDED
        interval = 1.0 / rate if agrees else step
        times.append(start + interval * np.arange(len(samples), dtype=np.float64))
        values += samples
    time = freeze(np.concatenate(times))
    stretches = len(channel.stretches)
    remark = f"{stretches} stretches with gaps between" if stretches > 1 else ""
    return Column(
        name, time, freeze(np.array(values)), "time", lambda k: f"sample {k + 1}", None, remark
    )


def _whole(columns: Mapping[str, Column], announced: int) -> dict[str, Column]:
    """Columns of which the last says where it ends before the others, or that more were to come."""
    made = dict(columns)
    if len(made) < announced:
        said = f"the summary lists {announced} waveforms, the file holds {len(made)}: "
        return {n: replace(c, remark=f"{said}it was cut short") for n, c in made.items()}
    *others, last = columns
    ends = [float(columns[name].time[-1]) for name in others if len(columns[name].time) >= _FEWEST]
    times = columns[last].time
    step = float(times[1] - times[0]) if len(times) >= _FEWEST else 0.0
    if ends and (len(times) < _FEWEST or times[-1] + 1.5 * step < max(ends)):
        n = len(times)
        said = f"it ends at sample {n}, before the other channels: the file was cut short"
        made[last] = replace(columns[last], remark=said)
    return made
