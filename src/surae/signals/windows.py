"""What of a recording is fitted: its parts between gaps, and of a long one windows.

Each is fitted as a recording of its own, jointly with the others, and named by its times.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surae.base.units import FloatArray
from surae.recording import MUSCLES, Recording
from surae.signals.inputs import ModelInputs
from surae.signals.timebase import GAP_STEPS

#: A recording that lasts longer [s] is thinned to so many windows of that length [s]: for a family
#: of models, whose fit takes a hundred times as long as a named one's, and for one model.
FAMILY = (300.0, 3, 20.0)
ONE = (900.0, 10, 60.0)
#: Where samples are missing for so long [s], a recording is in parts; shorter ones tell nothing.
_GAP = 0.05
_SHORTEST = 3.0
#: A window is as long as it should be but for so many seconds, of samples and of filters' ends.
_NEARLY = 0.2
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


def thinned(
    recordings: Sequence[Recording | ModelInputs], family: bool
) -> tuple[Recording | ModelInputs, ...]:
    """Recordings, a long one as windows of it.

    Each of as many equal parts gives the window in which the angle and the EMG vary most, by what
    was asked and done, not by the torque that is to be explained. The windows are fitted jointly.
    """
    longest, count, seconds = FAMILY if family else ONE
    made: list[Recording | ModelInputs] = []
    for each in recordings:
        if isinstance(each, Recording) and "angle" in each.channels:
            time = each.channels["angle"].time
            if time[-1] - time[0] > longest:
                made += liveliest(each, count, seconds)
                continue
        made.append(each)
    return tuple(made)


def are_windows(names: Sequence[str], seconds: Sequence[float]) -> bool:
    """Whether a recording's names and lengths [s] are those of windows of a long one."""
    for _, count, length in (FAMILY, ONE):
        of = [n.partition(",")[0] for n, s in zip(names, seconds, strict=True) if _alike(s, length)]
        if any(of.count(each) == count for each in of):
            return True
    return False


def _alike(seconds: float, length: float) -> bool:
    return abs(seconds - length) < _NEARLY


def liveliest(recording: Recording, count: int, seconds: float) -> list[Recording]:
    """Of each of `count` equal parts the window [s] in which the angle and the EMG vary most."""
    begins = _begins(recording, count, seconds)
    return [_window(recording, begin, begin + seconds) for begin in begins]


def _window(recording: Recording, begin: float, end: float) -> Recording:
    return replace(recording.crop(begin, end), name=f"{recording.name}, {begin:.0f} to {end:.0f} s")


def _begins(recording: Recording, count: int, seconds: float) -> list[float]:
    """Where the windows begin [s]."""
    channels = recording.channels
    angle = channels["angle"]
    first = float(angle.time[0])
    last = float(angle.time[-1])
    edges = np.arange(first, last, _PIECE)
    score = _spread(angle.time, angle.values, edges)
    for muscle in MUSCLES:
        if (emg := channels.get(f"emg_{muscle}")) is not None:
            score = score + _spread(emg.time, emg.values, edges)
    span = round(seconds / _PIECE)
    whole = np.convolve(score, np.ones(span), "valid")[: len(edges) - span]
    parts = np.array_split(np.arange(len(whole)), count)
    begins: list[float] = []
    for part in parts:
        free = [i for i in part if not begins or edges[i] >= begins[-1] + seconds]
        begins.append(float(edges[max(free or part, key=lambda i: whole[i])]))
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
