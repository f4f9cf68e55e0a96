"""Two clocks: by how much a stream is late for the others, and whether that grows in a trial.

Model 1.0 is fitted quickly; what it leaves is then explained, to first order, by a lag of the EMG
(the angle, the torque), a lag that grows, all parameters, and drifts, even or bent, of the torque's
zero and of the electrodes; where the angle is moved, by viscosity, friction and inertia too. What a
model lacks is slow, and says little of time: the equations are freed of the residual's
autocorrelation first (Prais and Winsten; generalised least squares), so that quick changes count.
The steps are repeated until lag and rate stay. Their standard errors are the larger of those of
white residuals and of a jackknife over stretches of the trial, which hears what a model lacks.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, solve_toeplitz

from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import FitProblem
from surae.inference.diagnosis.explanations import EVIDENCE
from surae.inference.diagnosis.moving import Stream, moved
from surae.inference.diagnosis.quick import QuickFit, growing, quick_fit, quick_problem
from surae.inference.least_squares.residuals import Residuals
from surae.quality import Finding
from surae.quality.finding import make_finding
from surae.quality.numeric import span_of
from surae.quality.trial import Signals
from surae.recording import Recording

#: What the fit must explain for a lag to be looked for.
_EXPLAINS = 0.8
#: A rate that is claimed [s/s], at least and at most: no clock is wrong by more, and a measured
#: trial on one clock passes for 15 ms/s.
_RATE = (8e-4, 0.006)
#: It is so many of its standard errors from none, of which what the model lacks makes so much at
#: least [s/s]: of some 24 clean virtual legs one passed for a drift of 1.3 ms/s, 4 of its own.
_CLEAR = 3.0
_LACKS = 3e-4
#: And makes so much of the torque's changes: in a measured trial of 17 s 0.00007 passed for a
#: drift of 6 ms/s, 1.5 ms/s make 0.0003 to 0.0015 of virtual legs'.
_VISIBLE = 2e-4
#: The largest drift makes so much of what the fit leaves, or nothing is told: in measured trials of
#: one electrode it is 0.02, and what the model lacks moves the estimate by more than its interval;
#: on virtual legs and a measured walk it is 0.3 to 1 of the EMG.
_TOLD = 0.1
#: A drift is one in twenty beforehand: so much more evidence, in 2 ln, than of what is common.
_RARE = 6.0
#: Differences are taken of so much [s], a step is at most so much, and lags beyond are none.
_DIFFERENCE = 0.01
_STEP = 0.06
_FARTHEST = 0.5
#: Steps at most, those that are taken whole, and the part of its standard error below which a
#: change is none, of the rate and, more coarsely, of the lag.
_STEPS = 8
_WHOLE = 2
_STAYS = 0.15
_LAG_STAYS = 0.6
#: After the first step no more is looked for where so little drifts, in standard errors.
_HINT = 1.5
#: Order of the autocorrelation, and stretches of the jackknife.
_ORDER = 8
_STRETCHES = 10
#: The normal distribution's 97.5 %.
_Z95 = 1.96


@dataclass(frozen=True, slots=True)
class Estimated:
    """A lag of a stream in the middle of a trial, and by how much it grows."""

    lag: float  #: By how much it is late for the others [s]; negative where it is early.
    rate: float  #: By how much it comes later every second [s/s]; negative where earlier.
    lag_sem: float  #: Standard error of the lag [s].
    rate_sem: float  #: Standard error of the rate [s/s].
    seen: float  #: Part of the torque's changes that the growth makes, and nothing else here can.
    most: float = 1.0  #: What the largest drift would make of what the fit leaves, as a part of it.

    @property
    def told(self) -> bool:
        """Whether a drift would show beside what the model lacks."""
        return self.most >= _TOLD

    @property
    def lag_ci95(self) -> tuple[float, float]:
        """The 95 % confidence interval of the lag [s]."""
        return self.lag - _Z95 * self.lag_sem, self.lag + _Z95 * self.lag_sem


@dataclass(frozen=True, slots=True)
class ClockDrift:
    """A lag of a stream for the others that grows, and what has it."""

    rate: float  #: By how much it comes later every second [s/s]; negative where earlier.
    sem: float  #: Its standard error [s/s].
    lag: float  #: By how much it is late in the middle [s].
    lag_sem: float  #: Its standard error [s].
    stream: Stream  #: What has that clock.
    before: QuickFit  #: The fit with that lag alone.
    after: QuickFit  #: The fit with the one that grows.

    @property
    def ci95(self) -> tuple[float, float]:
        """The 95 % confidence interval of the rate [s/s]."""
        return self.rate - _Z95 * self.sem, self.rate + _Z95 * self.sem

    @property
    def ppm(self) -> float:
        """By how much its clock is fast [10⁻⁶]: true = stamp / (1 + 10⁻⁶ ppm)."""
        return 1e6 * self.rate

    @property
    def certain(self) -> bool:
        """Whether the odds for it are those that are asked of an error."""
        return (self.rate / self.sem) ** 2 >= EVIDENCE + _RARE

    def right(self, signals: Signals) -> Signals:
        """The signals with the stream's times put right."""
        return moved(signals, self.lag, self.rate, self.stream)


def clock_drift(
    recording: Recording, signals: Signals, fit: QuickFit, stream: Stream = "emg"
) -> ClockDrift | None:
    """The rate at which a stream's clock drifts from the others'; None where none is to be seen.

    `fit` is the quick fit of the recording as it is.
    """
    drift = estimated_clock(recording, signals, fit, stream=stream)
    if drift is None or not drift.told or drift.seen < _VISIBLE:
        return None
    sem = float(np.hypot(drift.rate_sem, _LACKS))
    if abs(drift.rate) < _CLEAR * sem:
        return None
    if not _RATE[0] <= abs(drift.rate) <= _RATE[1]:
        return None
    before = quick_fit(recording, moved(signals, drift.lag, 0.0, stream), near=fit)
    after = quick_fit(recording, moved(signals, drift.lag, drift.rate, stream), near=fit)
    if before is None or after is None or not after.r2 > max(before.r2, _EXPLAINS):
        return None
    numbers = (drift.rate, sem, drift.lag, drift.lag_sem)
    return ClockDrift(*numbers, stream, before, after)


def estimated_clock(
    recording: Recording,
    signals: Signals,
    fit: QuickFit,
    *,
    stream: Stream = "emg",
    hinted: bool = True,
) -> Estimated | None:
    """Lag and rate of a stream for the others; None where they cannot be told.

    `fit` is the quick fit of the recording as it is. Where the first step hints at no drift, or
    what drifts would not show, and only such are wanted (`hinted`), no more is looked for.
    """
    if not _can_be_moved(signals, fit, stream):
        return None
    half = float(signals.time[-1] - signals.time[0]) / 2.0
    lag = 0.0
    rate = 0.0
    near = fit
    for number in range(_STEPS):
        again = (
            quick_fit(recording, moved(signals, lag, rate, stream), near=near) if number else fit
        )
        step = None if again is None else _step(recording, signals, (lag, rate), again, stream)
        if again is None or step is None:
            return None
        near = again
        quiet = abs(step.rate) < min(_HINT * step.rate_sem, _RATE[0]) and abs(step.lag) < _STEP
        if hinted and not number and (quiet or _most(step, again) < _TOLD):
            return None
        # The fit is not freed of autocorrelation, and would pull back what it is moved by.
        part = 1.0 if number < _WHOLE else 0.5
        lag += part * float(np.clip(step.lag, -_STEP, _STEP))
        rate += part * float(np.clip(step.rate, -_STEP / half, _STEP / half))
        if abs(lag) > _FARTHEST or abs(rate) * half > _FARTHEST:
            return None
        stays = max(abs(step.lag) / step.lag_sem - _LAG_STAYS, 0.0) + abs(step.rate) / step.rate_sem
        if stays < _STAYS:
            seen = step.seen * rate**2
            return Estimated(lag, rate, step.lag_sem, step.rate_sem, seen, _most(step, again))
    return None


def drift_shows(recording: Recording, signals: Signals, fit: QuickFit, stream: Stream) -> bool:
    """Whether a drift of a stream's clock would show beside what the quick fit leaves."""
    if not _can_be_moved(signals, fit, stream):
        return False
    step = _step(recording, signals, (0.0, 0.0), fit, stream)
    return step is not None and _most(step, fit) >= _TOLD


def _can_be_moved(signals: Signals, fit: QuickFit, stream: Stream) -> bool:
    """Whether there is anything to move a stream by."""
    there = signals.torque is not None and (stream != "emg" or bool(signals.fast))
    return there and len(signals.time) > 1 and fit.r2 >= _EXPLAINS


def _most(step: Estimated, fit: QuickFit) -> float:
    """What the largest drift would make of what a fit leaves, as a part of it."""
    return step.seen * _RATE[1] ** 2 / fit.unexplained


def _step(
    recording: Recording, signals: Signals, at: tuple[float, float], fit: QuickFit, stream: Stream
) -> Estimated | None:
    """By how much lag and rate are to change, to first order, with standard errors."""
    lag, rate = at
    half = float(signals.time[-1] - signals.time[0]) / 2.0
    x = np.array(fit.at)

    def residual(of: Signals) -> Residuals | None:
        problem = quick_problem(recording, of)
        return None if problem is None or len(problem.free) != len(x) else Residuals(problem)

    slope = _DIFFERENCE / half
    there = moved(signals, lag, rate, stream)
    here = residual(there)
    ways = [
        residual(moved(signals, lag + way * later, rate + way * faster, stream))
        for way in (1.0, -1.0)
        for later, faster in ((_DIFFERENCE, 0.0), (0.0, slope))
    ]
    problem = quick_problem(recording, there)
    if here is None or problem is None or None in ways:
        return None
    with one_blas_thread(), np.errstate(all="ignore"):
        rows = here.data_rows(x).copy()
        later, faster, earlier, slower = (each.data_rows(x)[-1].copy() for each in ways if each)
    by_lag = (later - earlier) / (2.0 * _DIFFERENCE)
    by_rate = (faster - slower) / (2.0 * slope)
    values = dict(zip(problem.free, x.tolist(), strict=True))
    slow = growing(rows[:-1], values)
    slow.pop("emg", None)  # the sum of the two groups
    bend = 4.0 * np.linspace(-0.5, 0.5, len(by_lag))  # electrodes do not drift evenly
    slow |= {f"{name}, bent": bend * each for name, each in slow.items()}
    others = [*rows[:-1], np.ones_like(by_lag), *slow.values()]
    if stream != "emg":
        others += _of_movement(problem)
    measured = problem.inputs[0].torque
    assert measured is not None
    changes = float(((measured - measured.mean()) ** 2).sum())
    of_lag = _solved(-rows[-1], np.column_stack([by_lag, by_rate, *others]), changes)
    of_rate = _solved(-rows[-1], np.column_stack([by_rate, by_lag, *others]), changes)
    if of_lag is None or of_rate is None:
        return None
    return Estimated(of_lag.first, of_rate.first, of_lag.sem, of_rate.sem, of_rate.share)


def _of_movement(problem: FitProblem) -> list[FloatArray]:
    """Torques of tissue that a late angle may pass for: viscosity, friction, inertia."""
    inputs = problem.inputs[0]
    speeds = np.abs(inputs.velocity)  # of a leg that is mostly held still most are none
    fast = np.quantile(speeds, 0.9) or max(float(np.max(speeds)), 1e-9)
    return [inputs.velocity, np.tanh(inputs.velocity / (0.1 * fast)), inputs.acceleration]


@dataclass(frozen=True, slots=True)
class _Coefficient:
    """The first coefficient of a regression."""

    first: float
    sem: float  #: Its standard error.
    share: float  #: Part of the torque's changes that its column alone makes where it is 1.


def _solved(y: FloatArray, columns: FloatArray, changes: float) -> _Coefficient | None:
    """The first coefficient of a regression whose errors are autocorrelated."""
    size = np.linalg.norm(columns, axis=0)
    if not np.isfinite(columns).all() or size[0] <= 0.0:
        return None
    used = size > 1e-12 * size.max()
    scaled = columns[:, used] / size[used]
    across = columns[:, 0] - scaled[:, 1:] @ np.linalg.lstsq(scaled[:, 1:], columns[:, 0])[0]
    try:
        y, scaled = _whitened(y, scaled)
        inverse = np.linalg.pinv(scaled.T @ scaled)
    except (LinAlgError, np.linalg.LinAlgError):
        return None
    beta = inverse @ (scaled.T @ y)
    left = y - scaled @ beta
    free = len(y) - scaled.shape[1]
    if free < _ORDER:
        return None
    white = float(np.sqrt(float(left @ left) / free * inverse[0, 0]))
    sem = max(white, _jackknife(y, scaled)) / float(size[0])
    first = float(beta[0] / size[0])
    if not (np.isfinite([first, sem]).all() and sem > 0.0):
        return None
    return _Coefficient(first, sem, float(across @ across) / changes)


def _whitened(y: FloatArray, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The equations freed of the autocorrelation of what they leave."""
    beta = np.linalg.lstsq(columns, y, rcond=None)[0]
    white = y
    free = columns
    for _ in range(3):
        left = y - columns @ beta
        power = np.abs(np.fft.rfft(left, 2 * len(left))) ** 2
        covariance = np.fft.irfft(power)[: _ORDER + 1] / len(left)
        covariance[0] *= 1.0 + 1e-4
        filter_ = np.concatenate(([1.0], -solve_toeplitz(covariance[:-1], covariance[1:])))
        white = np.convolve(y, filter_, "valid")
        free = np.column_stack([np.convolve(each, filter_, "valid") for each in columns.T])
        beta = np.linalg.lstsq(free, white, rcond=None)[0]
    return white, free


def _jackknife(y: FloatArray, columns: FloatArray) -> float:
    """Standard error of the first coefficient, by leaving out one stretch after another."""
    normal = columns.T @ columns
    moment = columns.T @ y
    each = []
    for stretch in np.array_split(np.arange(len(y)), _STRETCHES):
        part = columns[stretch]
        without = np.linalg.pinv(normal - part.T @ part) @ (moment - part.T @ y[stretch])
        each.append(float(without[0]))
    return float(np.sqrt((_STRETCHES - 1) * np.var(each)))


def clock_finding(drift: ClockDrift, signals: Signals) -> Finding:
    """What is said of a drift, and the line of a mapping that corrects it.

    It is an error only where the odds for it are those that are asked of every such claim.
    """
    start, end = span_of(signals.time)
    low, high = sorted(abs(edge) for edge in drift.ci95)
    return make_finding(
        f"{drift.stream}-clock/{'fast' if drift.rate > 0.0 else 'slow'}",
        None if drift.stream == "emg" else drift.stream,
        (start, end),
        drift.rate,
        severity="error" if drift.certain else "warning",
        rate=1e3 * abs(drift.rate),
        low=1e3 * low,
        high=1e3 * high,
        ms=1e3 * abs(drift.rate) * (end - start),
        ppm=abs(drift.ppm),
        signed=drift.ppm,
        before=_percent(drift.before.r2),
        after=_percent(drift.after.r2),
    )


def _percent(r2: float) -> Message:
    """R² in percent, with the digits in which a drift shows."""
    return Message("{r2:.2f} %", r2=100.0 * r2)
