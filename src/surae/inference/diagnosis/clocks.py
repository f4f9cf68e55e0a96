"""Two clocks that drift apart: a lag of the EMG for the torque that grows through a trial.

Model 1.0 is fitted quickly to the torque with the EMG moved by ``lag + rate·(t − middle)``. What it
leaves, as a function of the rate with the lag free, is a parabola whose lowest point is the rate
and whose width its interval. How strong muscles are, and how they follow their EMG, changes what is
left at every rate alike.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from surae.inference.diagnosis.explanations import EVIDENCE
from surae.inference.diagnosis.quick import QuickFit, percent, quick_fit
from surae.quality import Finding
from surae.quality.finding import make_finding
from surae.quality.numeric import span_of
from surae.quality.trial import Signals
from surae.recording import Recording

#: Steps of the lag and of what the rate moves the ends by [s], and how far both are looked for.
_STEP = 0.02
_LAG_STEPS = (0.04, 0.02)
_FARTHEST = 0.6
_LAGS = (-0.2, 0.4)
#: A rate that is claimed [s/s], at least and at most: beyond, the rate of one file is wrong.
_RATE = (8e-4, 0.012)
#: It is so many of its standard errors from none, and a fit leaves so many times less with it than
#: with the best lag that does not grow.
_CLEAR = 3.0
_LESS = 1.1
#: Part of the torque's changes that it explains beyond: a rest before a measured trial made 0.0003
#: of it, drifts of 2 to 3 ms/s of virtual legs 0.0019 to 0.0028.
_VISIBLE = 0.001
#: What a quick fit leaves is alike for so long [s]: fewer of its samples tell anew.
_ALIKE_S = 0.6
#: The normal distribution's 97.5 %.
_Z95 = 1.96
#: What the fit must explain, and where a growing lag is looked for at all.
_EXPLAINS = 0.8
_HINT = 1.03
#: Steps of the rate that a first look takes.
_PROBE = 2.0


@dataclass(frozen=True, slots=True)
class ClockDrift:
    """A lag of the EMG that grows, estimated against the torque."""

    rate: float  #: By how much the EMG comes later every second [s/s]; negative where earlier.
    sem: float  #: Its standard error [s/s].
    lag: float  #: By how much the EMG is late in the middle, what muscles take left out [s].
    before: QuickFit  #: The fit with the best lag that does not grow.
    after: QuickFit  #: The fit with the one that does.

    @property
    def ci95(self) -> tuple[float, float]:
        """The 95 % confidence interval of the rate [s/s]."""
        return self.rate - _Z95 * self.sem, self.rate + _Z95 * self.sem

    @property
    def ppm(self) -> float:
        """By how much the EMG's clock is fast [10⁻⁶]: true = stamp / (1 + 10⁻⁶ ppm)."""
        return 1e6 * self.rate

    def right(self, signals: Signals) -> Signals:
        """The signals with the EMG's times put right."""
        return _moved(signals, self.lag, self.rate)


def clock_drift(recording: Recording, signals: Signals, fit: QuickFit) -> ClockDrift | None:
    """The rate at which the EMG's clock drifts from the torque's; None where none is to be seen.

    `fit` is the quick fit of the recording as it is.
    """
    if not signals.fast or signals.torque is None or len(signals.time) < 2:
        return None
    half = float(signals.time[-1] - signals.time[0]) / 2.0
    near = fit

    def left(lag: float, rate: float) -> QuickFit:
        made = quick_fit(recording, _moved(signals, lag, rate), near=near)
        return made if made is not None and np.isfinite(made.r2) else replace(fit, r2=-1.0)

    step = _STEP / half
    probes = [left(_LAG_STEPS[0], way * _PROBE * step) for way in (1.0, -1.0)]
    if fit.unexplained < _HINT * min(each.unexplained for each in probes):
        return None  # as of most recordings, at the cost of two fits
    lag, before = _best_lag(left, 0.0, 0.0, fit)
    sides = [(r, *_best_lag(left, r, lag, None)) for r in (step, -step)]
    rate, lag_there, after = max(sides, key=lambda each: each[2].r2)
    if before.unexplained < _HINT * after.unexplained:
        return None
    profile = {0.0: before.unexplained, **{r: each.unexplained for r, _, each in sides}}
    lag = lag_there
    way = float(np.sign(rate))
    while abs(rate) * half < _FARTHEST:
        further = rate + way * step
        lag_there, next_ = _best_lag(left, further, lag, None)
        profile[further] = next_.unexplained
        if next_.unexplained >= after.unexplained:
            break
        rate, lag, after = further, lag_there, next_
    return _drift(profile, rate, step, half, lag, before, after)


def _drift(
    profile: dict[float, float],
    rate: float,
    step: float,
    half: float,
    lag: float,
    before: QuickFit,
    after: QuickFit,
) -> ClockDrift | None:
    """The drift at the lowest point of a profile; None where it is not clear."""
    keys = [min(profile, key=lambda r: abs(r - rate - k * step)) for k in (-1, 0, 1)]
    low, middle, high = (profile[key] for key in keys)
    bend = low - 2.0 * middle + high
    if len(set(keys)) < 3 or bend <= 0.0 or after.r2 < _EXPLAINS:
        return None
    best = rate + step * (low - high) / (2.0 * bend)
    # The sum of squares rises by one noise variance at one standard error.
    told = max(2.0 * half / _ALIKE_S, 2.0)
    sem = step * float(np.sqrt(2.0 * after.unexplained / (told * bend)))
    clear = abs(best) >= _CLEAR * sem and before.unexplained >= _LESS * after.unexplained
    clear = clear and after.r2 - before.r2 >= _VISIBLE
    if not clear or not _RATE[0] <= abs(best) <= _RATE[1]:
        return None
    return ClockDrift(best, sem, lag, before, after)


def _best_lag(
    left: Callable[[float, float], QuickFit], rate: float, start: float, there: QuickFit | None
) -> tuple[float, QuickFit]:
    """The lag with which a fit leaves least at a rate, walked to from `start`."""
    lag = start
    best = there or left(start, rate)
    for step in _LAG_STEPS:
        for way in (step, -step):
            moved = False
            while _LAGS[0] < lag + way < _LAGS[1]:
                next_ = left(lag + way, rate)
                if next_.unexplained >= best.unexplained:
                    break
                lag, best, moved = lag + way, next_, True
            if moved:
                break
    return lag, best


def _moved(signals: Signals, lag: float, rate: float) -> Signals:
    """The signals with the EMG earlier by a lag that grows about the middle."""
    if lag == 0.0 and rate == 0.0:
        return signals
    time = signals.time
    at = time + lag + rate * (time - (time[0] + time[-1]) / 2.0)
    return replace(signals, fast={m: np.interp(at, time, own) for m, own in signals.fast.items()})


def clock_finding(drift: ClockDrift, signals: Signals) -> Finding:
    """What is said of a drift, and the line of a mapping that corrects it.

    It is an error only where the odds for it are those that are asked of every such claim.
    """
    start, end = span_of(signals.time)
    gain = float(np.log(drift.before.unexplained / drift.after.unexplained))
    certain = drift.after.samples * gain >= EVIDENCE
    low, high = sorted(abs(edge) for edge in drift.ci95)
    return make_finding(
        f"emg-clock/{'fast' if drift.rate > 0.0 else 'slow'}",
        None,
        (start, end),
        drift.rate,
        severity="error" if certain else "warning",
        rate=1e3 * abs(drift.rate),
        low=1e3 * low,
        high=1e3 * high,
        ms=1e3 * abs(drift.rate) * (end - start),
        ppm=abs(drift.ppm),
        signed=drift.ppm,
        before=percent(drift.before.r2),
        after=percent(drift.after.r2),
    )
