"""Angle, torque and EMG on clocks of their own: which of them is out of step, and by how much.

Inertia, the foot's weight and the tissue tie the torque to the angle, muscles tie it to the EMG.
What is late for both others is so to both. Each stream that may have a clock of its own (one whose
times are not those of another's) is moved alone; what explains the torque best is named. Viscosity
is what a late angle makes of stiff tissue, and stands beside it: a lag of the angle is told from
where the stiffness changes, and only where it is large.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from surae.inference.diagnosis.clocks import ClockDrift, clock_drift, drift_shows, estimated_clock
from surae.inference.diagnosis.explanations import EVIDENCE, Explanation, evidence
from surae.inference.diagnosis.moving import Stream, moved
from surae.inference.diagnosis.quick import QuickFit, percent, quick_fit
from surae.quality import Finding
from surae.quality.finding import make_finding
from surae.quality.numeric import span_of
from surae.quality.trial import Signals
from surae.recording import Recording

#: By how much each is late, least and most, where all are in step [s]: viscosity and a device that
#: gives make an angle early (clean virtual legs of four families: 0 to 50 ms, measured trials -10
#: to 30), and muscles follow their EMG by 0 to 100 ms (some 20 virtual legs: 4 to 90).
_IN_STEP: Mapping[Stream, tuple[float, float]] = {"angle": (-0.05, 0.0), "torque": (0.0, 0.1)}
#: What is claimed is off by so much at least [s], at the near end of its interval.
_CLAIMED = 0.06
#: A lag is looked for in such steps, so far at most [s].
_SHIFT = 0.06
_FARTHEST = 0.6
#: It must leave so many times less, and explain so much more of the torque's changes.
_BETTER = 1.1
_VISIBLE = 0.005
#: Longer recordings [s] are looked at for the EMG's clock alone: windows of hours are so long, and
#: of eight each would take as long as all other checks.
_LONGEST = 280.0
#: What a fit must explain with it.
_EXPLAINS = 0.9


@dataclass(frozen=True, slots=True)
class StreamLag:
    """An angle or a torque that is late for the others, or early."""

    stream: Stream
    seconds: float  #: By how much its clock is late; negative where it is early.
    #: The 95 % confidence interval of that [s], wider by what may be where all are in step.
    ci95: tuple[float, float]
    before: QuickFit  #: The fit of the recording as it is.
    after: QuickFit  #: The fit with the stream put right.


def may_be_apart(recording: Recording) -> tuple[Stream, ...]:
    """The streams that may have a clock of their own, by whose times are the same.

    Of two that share their stamps and a third that does not, the third; else each.
    """
    roles = ("angle", "torque", next((r for r in recording.channels if r.startswith("emg_")), ""))
    streams: tuple[Stream, ...] = ("angle", "torque", "emg")
    axes = {
        stream: recording.channels[role].time
        for stream, role in zip(streams, roles, strict=True)
        if role in recording.channels
    }
    same = [pair for pair in combinations(axes, 2) if np.array_equal(axes[pair[0]], axes[pair[1]])]
    if recording.shared[1] - recording.shared[0] > _LONGEST:
        return tuple(stream for stream in axes if stream == "emg")
    if len(axes) < len(streams) or len(same) != 1:
        return tuple(stream for stream in streams if stream in axes)
    return tuple(stream for stream in streams if stream not in same[0])


def drifting_clock(recording: Recording, signals: Signals, fit: QuickFit) -> ClockDrift | None:
    """The clock that drifts from the others'; None where none is seen to.

    The EMG's is named where another explains it as well: electrodes are mostly another device's,
    angle and torque one's.
    """
    seen = [
        drift
        for stream in may_be_apart(recording)
        if (drift := clock_drift(recording, signals, fit, stream)) is not None
    ]
    best = max(seen, key=lambda drift: drift.after.r2, default=None)
    emg = next((drift for drift in seen if drift.stream == "emg"), None)
    if best is None or emg is None or emg is best:
        return best
    gain = evidence(Explanation("", fit=best.after), Explanation("", fit=emg.after))
    return best if gain >= EVIDENCE else emg


def lagging_stream(
    recording: Recording, signals: Signals, fit: QuickFit, emg: QuickFit | None
) -> StreamLag | None:
    """The angle or the torque that is out of step; None where neither is, or `emg` explains it.

    `emg` is the fit with the EMG moved alone, where that is out of step.
    """
    if signals.torque is None or fit.r2 < 0.5:
        return None
    lags: list[StreamLag] = []
    for stream in may_be_apart(recording):
        if stream == "emg" or (stream == "torque" and not signals.fast):
            continue
        lags += _lags(recording, signals, fit, stream)
    best = max(lags, key=lambda lag: lag.after.r2, default=None)
    if best is None or (emg is not None and emg.r2 >= best.after.r2):
        return None
    return best


def lag_finding(lag: StreamLag, signals: Signals) -> Finding:
    """What is said of a stream that is out of step, with its interval."""
    low, high = sorted(abs(edge) for edge in lag.ci95)
    return make_finding(
        f"angle-torque-lag/{lag.stream}-{'late' if lag.seconds > 0.0 else 'early'}",
        lag.stream,
        span_of(signals.time),
        lag.seconds,
        ms=1e3 * abs(lag.seconds),
        low=1e3 * low,
        high=1e3 * high,
        signed=-lag.seconds,
        before=percent(lag.before.r2),
        after=percent(lag.after.r2),
    )


def cannot_tell(recording: Recording, signals: Signals, fit: QuickFit) -> str:
    """Why angle and torque cannot be told to be on one clock or two; empty where they can."""
    if not {"angle", "torque"} & {*may_be_apart(recording)}:
        return ""
    if fit.r2 < _EXPLAINS:
        return "No quick fit explains enough of the torque to tell a lag or drift of the angle."
    if not drift_shows(recording, signals, fit, "angle"):
        return (
            "What a lag or drift of the angle would change of the torque is too small beside what "
            "a quick fit leaves: the angle moves too slowly, or the torque follows it too little."
        )
    return ""


def _lags(
    recording: Recording, signals: Signals, fit: QuickFit, stream: Stream
) -> Iterator[StreamLag]:
    """How a stream is late or early, where that is clear."""

    def at(lag: float, near: QuickFit) -> QuickFit:
        return quick_fit(recording, moved(signals, lag, 0.0, stream), near=near) or fit

    for way in (_SHIFT, -_SHIFT):
        lag = 0.0
        best = fit
        while abs(lag) < _FARTHEST and (later := at(lag + way, best)).r2 > best.r2:
            lag += way
            best = later
        if best.unexplained * _BETTER >= fit.unexplained or best.r2 - fit.r2 < _VISIBLE:
            continue
        if abs(lag) <= _SHIFT or abs(lag) >= _FARTHEST - 0.5 * _SHIFT or best.r2 < _EXPLAINS:
            continue
        there = moved(signals, lag, 0.0, stream)
        beyond = estimated_clock(recording, there, best, stream=stream, hinted=False)
        if beyond is None or not beyond.told:
            continue
        least, most = _IN_STEP[stream]
        low, high = (lag + edge for edge in beyond.lag_ci95)
        low, high = low - most, high - least
        if max(low, -high) > _CLAIMED:
            yield StreamLag(stream, (low + high) / 2.0, (low, high), fit, best)
