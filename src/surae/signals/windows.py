"""What of a recording is fitted: its parts between gaps, and of a long one windows.

Parts are fitted as recordings of their own, jointly, and named by their times. Windows stay one
recording, with one zero and one leg: they follow one another, and what lies before and behind each
does not count.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.recording import MUSCLES, Recording
from surae.signals.inputs import Film, ModelInputs
from surae.signals.timebase import GAP_STEPS

#: A recording that lasts longer [s] is thinned to as many windows of that length [s] as it has room
#: for, and not more than so many; together they are no shorter than the longest that is read whole,
#: so that more seconds never tell less. For a family of models, whose fit takes a hundred times as
#: long as a named one's, and for one model.
FAMILY = (300.0, 6, 75.0)
ONE = (900.0, 10, 90.0)
#: So long before a window [s] the model begins, which tissue and muscles remember, and so long
#: behind it filters look ahead.
LEAD_S = 8.0
_BEHIND_S = 1.0
#: What model inputs have at each sample.
_ROWS = ("angle", "velocity", "acceleration", "emg", "torque")
#: Where samples are missing for so long [s], a recording is in parts; shorter ones tell nothing.
_GAP = 0.05
_SHORTEST = 3.0
#: The step of a preparation that says so.
_WINDOWS = "made/windows"
#: Windows are compared by pieces of this length [s].
_PIECE = 5.0


def parted(recordings: Sequence[Recording | ModelInputs]) -> tuple[Recording | ModelInputs, ...]:
    """Recordings, one in which all signals, or some, stopped for a while as its parts."""
    made: list[Recording | ModelInputs] = []
    for each in recordings:
        pieces = _pieces(each) if isinstance(each, Recording) else []
        made += [_window(each, *piece) for piece in pieces] or [each]  # type: ignore[arg-type]
    return tuple(made)


def _pieces(recording: Recording) -> list[tuple[float, float]]:
    """Begin and end of the parts between gaps [s]; none where there is no gap, or no part."""
    gaps = []
    for channel in recording.signals.values():
        steps = np.diff(channel.time)
        usual = float(np.median(steps)) if len(steps) else 0.0
        where = np.flatnonzero(steps > max(_GAP, GAP_STEPS * usual))
        gaps += [(float(channel.time[i]), float(channel.time[i + 1])) for i in where]
    if not gaps:
        return []
    at, last = recording.shared
    pieces = []
    for begin, end in [*sorted(gaps), (last, last)]:
        if begin - at >= _SHORTEST:
            pieces.append((at, begin))
        at = max(at, end)
    return pieces


Prepare = Callable[[Sequence[Recording | ModelInputs]], Sequence[ModelInputs]]


def prepared_parts(
    recordings: Sequence[Recording | ModelInputs], prepare: Prepare, *, family: bool
) -> tuple[ModelInputs, ...]:
    """What a fit reads of recordings: their parts between gaps, windows of long ones joined.

    `prepare` makes model inputs of all of them at once, as many as it is given.
    """
    each = [_thinned(part, *(FAMILY if family else ONE)) for part in parted(recordings)]
    made = iter(prepare([window for thinned in each for window in thinned.windows]))
    return tuple(thinned.joined([next(made) for _ in thinned.windows]) for thinned in each)


@dataclass(frozen=True, slots=True)
class _Thinned:
    """A recording, or windows of a long one with what lies around them."""

    name: str
    windows: tuple[Recording | ModelInputs, ...]
    spans: tuple[tuple[float, float], ...] = ()  #: Those that count [s]; none: all of one.
    seconds: float = 0.0  #: How long the recording lasts.

    def joined(self, prepared: Sequence[ModelInputs]) -> ModelInputs:
        """The windows as one recording, whose time runs on from one to the next."""
        first = prepared[0]
        if not self.spans:
            return first
        n = sum(window.n for window in prepared)
        time = first.time[0] + np.arange(n) / first.rate_hz
        starts = time[np.cumsum([0, *(window.n for window in prepared[:-1])])]
        later = [start - window.time[0] for start, window in zip(starts, prepared, strict=True)]
        rows: dict[str, Any] = {
            name: read_only(np.concatenate([getattr(window, name) for window in prepared]))
            for name in _ROWS
            if getattr(first, name) is not None
        }
        said = Message(_WINDOWS, windows=_spans(self.spans), minutes=self.seconds / 60.0)
        return replace(
            first,
            **rows,
            name=f"{self.name}, {_spans(self.spans)}",
            time=read_only(time),
            weight=read_only(np.concatenate(list(map(_within, prepared, self.spans)))),
            emphasised=any(window.emphasised for window in prepared),
            second=tuple(
                read_only(np.concatenate(each))
                for each in zip(*(window.second for window in prepared), strict=True)
            ),
            films=_films(prepared, later),
            rectified=tuple(np.mean([window.rectified for window in prepared], axis=0).tolist()),
            emg_lost=max(window.emg_lost for window in prepared),
            effort=None,
            steps=(*first.steps, said),
        )


def _spans(spans: Sequence[tuple[float, float]]) -> str:
    return ", ".join(f"{begin:.0f} to {end:.0f}" for begin, end in spans) + " s"


def _within(prepared: ModelInputs, span: tuple[float, float]) -> FloatArray:
    """What each sample of a window counts: none of what lies around it."""
    inside = (prepared.time >= span[0]) & (prepared.time <= span[1])
    return np.where(inside, prepared.weights, 0.0)


def _films(prepared: Sequence[ModelInputs], later: Sequence[float]) -> tuple[Film, ...]:
    """The films of windows, each so much `later` [s]."""
    channels = dict.fromkeys(film.channel for pairs in prepared for film in pairs.films)
    made = []
    for channel in channels:
        pairs = [
            (film.time + by, film.length)
            for window, by in zip(prepared, later, strict=True)
            for film in window.films
            if film.channel == channel
        ]
        time, length = (read_only(np.concatenate(each)) for each in zip(*pairs, strict=True))
        made.append(Film(channel, time, length))
    return tuple(made)


def _thinned(
    recording: Recording | ModelInputs, longest: float, count: int, seconds: float
) -> _Thinned:
    """A recording whole, or where it lasts longer [s] as windows of it.

    Each of as many equal parts gives the window in which the angle and the EMG vary most, by what
    was asked and done, not by the torque that is to be explained.
    """
    moved = _moved(recording)
    time = moved[0][0] if moved else np.zeros(1)
    lasts = float(time[-1] - time[0])
    if lasts <= longest:
        return _Thinned(recording.name, (recording,))
    count = min(count, int(lasts / seconds))
    spans = tuple((begin, begin + seconds) for begin in _begins(moved, count, seconds))
    cut = recording.crop if isinstance(recording, Recording) else partial(_cropped, recording)
    windows = tuple(cut(begin - LEAD_S, end + _BEHIND_S) for begin, end in spans)
    return _Thinned(recording.name, windows, spans, lasts)


def _cropped(inputs: ModelInputs, start: float, end: float) -> ModelInputs:
    """The part of model inputs between two times [s]."""
    inside = (inputs.time >= start) & (inputs.time <= end)
    names = ("time", *_ROWS, "weight")
    rows: dict[str, Any] = {
        name: read_only(values[inside])
        for name in names
        if (values := getattr(inputs, name)) is not None
    }
    films = []
    for film in inputs.films:
        shown = (film.time >= start) & (film.time <= end)
        films.append(Film(film.channel, film.time[shown], film.length[shown]))
    second = tuple(read_only(each[inside]) for each in inputs.second)
    return replace(inputs, **rows, second=second, films=tuple(films), effort=None)


def are_windows(inputs: ModelInputs) -> bool:
    """Whether a recording is windows of a long one."""
    return any(isinstance(step, Message) and step.code == _WINDOWS for step in inputs.steps)


def liveliest(recording: Recording, count: int, seconds: float) -> list[Recording]:
    """Of each of `count` equal parts the window [s] in which the angle and the EMG vary most."""
    begins = _begins(_moved(recording), count, seconds)
    return [_window(recording, begin, begin + seconds) for begin in begins]


def _window(recording: Recording, begin: float, end: float) -> Recording:
    return replace(recording.crop(begin, end), name=f"{recording.name}, {begin:.0f} to {end:.0f} s")


#: Times [s] and values of one signal.
_Signal = tuple[FloatArray, FloatArray]


def _moved(recording: Recording | ModelInputs) -> list[_Signal]:
    """The angle, then each muscle's EMG; nothing where the angle was not recorded."""
    if isinstance(recording, ModelInputs):
        signals = (recording.angle, *recording.emg.T)
        return [(recording.time, values) for values in signals]
    channels = recording.channels
    roles = ("angle", *(f"emg_{muscle}" for muscle in MUSCLES))
    there = [channels[role] for role in roles if role in channels and "angle" in channels]
    return [(channel.time, channel.values) for channel in there]


def _begins(moved: Sequence[_Signal], count: int, seconds: float) -> list[float]:
    """Where the windows begin [s], of the signals that move; none reaches into the next."""
    time, _ = moved[0]
    first = float(time[0])
    edges = np.arange(first, float(time[-1]), _PIECE)
    score = np.sum([_spread(*signal, edges) for signal in moved], axis=0)
    whole = np.convolve(score, np.ones(round(seconds / _PIECE)), "valid")
    part = (float(time[-1]) - first) / count
    begins = []
    for low in first + part * np.arange(count):
        inside = np.flatnonzero((edges >= low) & (edges <= low + part - seconds))
        inside = inside[inside < len(whole)]
        begins.append(float(edges[max(inside, key=lambda i: whole[i])] if len(inside) else low))
    return begins


def _spread(time: FloatArray, values: FloatArray, edges: FloatArray) -> FloatArray:
    """Variance of a signal in each piece, as a part of the largest."""
    at = np.minimum(np.searchsorted(time, edges), len(time) - 1)
    counts = np.maximum(np.diff([*at, len(time)]), 1)
    centred = values - float(values.mean())
    sums = np.add.reduceat(centred, at)
    squares = np.add.reduceat(centred**2, at)
    variance: FloatArray = np.maximum(squares / counts - (sums / counts) ** 2, 0.0)
    return variance / (float(variance.max()) or 1.0)
