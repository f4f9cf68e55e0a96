"""A stretch's torque taken apart: tissue, as it is where no muscle answers, and what is beyond."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline
from scipy.signal import butter, hilbert, lfilter, sosfiltfilt, sosfreqz

from surae.base.units import FloatArray
from surae_nerve.ramps import RATE, SMOOTH, RampSpan, Stretched, low

#: Without EMG: time from a stretch's begin in which no reflex has torque yet, and how long its
#: torque lasts after the stretch [s].
NOT_YET, LATE = 0.04, 0.6
#: Speed as a multiple of the slowest stretch's beyond which a reflex is looked for without EMG.
FAST = 2.0
#: Time after a stretch in which the device comes to rest, and in which a reflex shows [s].
SETTLED, SHOWN = 0.06, 0.4
#: Times in which tissue relaxes [s]; time between knots of a torque's drift [s].
RELAXES, DRIFT = (0.05, 0.8), 15.0
#: Knots of the elastic torque over the angle, and what keeps them together.
KNOTS, RIDGE = 6, 1e-6
#: Natural frequencies of muscles that EMG drives [rad/s]; the one that fits best is taken.
OMEGAS = (8.0, 10.0, 12.5, 15.5, 19.0, 24.0, 30.0, 40.0, 60.0)
#: Band in which an envelope's noise is seen [Hz]: faster than a muscle is called up, slower than
#: what smooths an envelope; and time over which its size is taken [s].
NOISY, AVERAGED = (9.0, 15.0), 0.25
#: Samples of which one is independent; what of a reflex's peak is not known for its smoothing [1].
DEPENDENT, PEAK = 20.0, 0.06
#: EMG later than this after the begin may be by will: reflexes of the ankle begin within 0.1 s
#: (Petersen 1998), and are smoothed [s]. EMG that goes on, later than a reflex's latency after the
#: stop, for longer than a beat of clonus (3 to 8 Hz: Hidler and Rymer 1999) is neither [s].
BY_WILL, GONE, GOES_ON = 0.12, 0.08, 0.2
#: When a tonic answer alone is left, after the stop, and for how long at least it must be seen [s];
#: cutoff that tells it from noise [Hz].
TONIC, SEEN, HELD = (0.8, 1.4), 0.2, 6.0


@dataclass(frozen=True, slots=True)
class Parts:
    """Torque [Nm] of one stretch, at its most."""

    elastic: float
    viscous: float
    inertial: float
    neural: float
    error: float  #: Standard error of the neural part.
    early: float  #: The neural part without what EMG drives that comes late enough to be by will.
    held: float  #: What EMG drives that goes on after the stop for longer than a reflex does.
    rise: float  #: By how much torque rises again after the foot has stopped.
    rest: float  #: The same before the stretch, when nothing happens.


class TissueTorque:
    """Elastic, viscous and inertial torque of a leg, beside that of its EMG.

    Where there is EMG, its torque is that of second-order muscles which it drives, fitted with
    tissue's; where there is none, tissue is fitted to the samples in which no reflex is expected.
    """

    def __init__(
        self, every: Sequence[Stretched], quiet: Sequence[FloatArray],
        speeds: Sequence[np.ndarray],
    ) -> None:  # fmt: skip
        """Of each recording's samples `quiet` are fitted; `speeds` number those of one speed."""
        self.every = every
        self.angles = [_slow(of, of.angle) for of in every]
        joined = np.concatenate(self.angles)
        ends = float(joined.min()) - 1e-6, float(joined.max()) + 1e-6
        inner = np.linspace(*ends, KNOTS)[1:-1]
        self.knots = np.concatenate([[ends[0]] * 4, inner, [ends[1]] * 4])
        self.bends, self.lead = len(self.knots) - 5, 2 + len(RELAXES)
        self.rows = [self._rows(i) for i in range(len(every))]
        torques = [_slow(of, low(of.torque, of.rate, SMOOTH)) for of in every]
        use = [_slow(of, q.astype(float)) > 0.99 for of, q in zip(every, quiet, strict=True)]
        muscles = sorted(set.intersection(*({*of.emg} for of in every)))
        self.heard = [
            {m: _slow(of, low(of.emg[m], of.rate, SMOOTH)) for m in muscles} for of in every
        ]  # smoothed alike: corners of the movement would else be left
        power = np.array([_noise(every, m) for m in muscles])
        best = np.inf
        for omega in OMEGAS if muscles else OMEGAS[:1]:
            driven = [
                _driven([h[m] for m in muscles], omega, len(r))
                for h, r in zip(self.heard, self.rows, strict=True)
            ]
            x = np.concatenate(
                [np.hstack([r, d])[u] for r, d, u in zip(self.rows, driven, use, strict=True)]
            )
            y = np.concatenate([t[u] for t, u in zip(torques, use, strict=True)])
            size = np.sqrt(np.mean(x**2, axis=0)) + 1e-12
            normal = (x / size).T @ (x / size) / len(y) + RIDGE * np.eye(x.shape[1])
            c = np.linalg.solve(normal, (x / size).T @ y / len(y)) / size
            sd = float(np.std(y - x @ c))
            if sd < best:
                best, k = sd, self.rows[0].shape[1]
                # noise of the EMG draws what it drives to 0, and tissue takes it (Fuller 1987);
                # its variance behind a muscle is that of ω/8 Hz
                blurred = np.concatenate([np.zeros(k), power * omega / 8.0 * c[k:]])
                self.diluted = (np.linalg.solve(normal, blurred / size) / size)[:k]
                self.c, self.sd = c[:k] + self.diluted, sd
                inverse = np.linalg.inv(normal) / np.outer(size, size) / len(y)
                self.covariance = (inverse * sd**2 * DEPENDENT)[:k, :k]
                self.omega, self.gains, fitted = omega, c[k:], (x, y, c)
        own = [
            g[np.minimum((np.arange(len(r)) / RATE * of.rate).astype(int), len(g) - 1)]
            for g, r, of in zip(speeds, self.rows, every, strict=True)
        ]
        label = np.concatenate([g[u] for g, u in zip(own, use, strict=True)])
        self.apart = _left_out(*fitted, label)[:, :k]
        self.left = [t - r @ self.c for t, r in zip(torques, self.rows, strict=True)]
        at_once = np.zeros(k)
        at_once[:2] = self.c[:2]
        at_once[self.lead : self.lead + self.bends] = self.c[self.lead : self.lead + self.bends]
        self.still = [t - r @ at_once for t, r in zip(torques, self.rows, strict=True)]

    def _rows(self, index: int) -> FloatArray:
        angle = self.angles[index]
        v = np.gradient(angle, 1.0 / RATE)
        columns = [np.gradient(v, 1.0 / RATE), v]
        for time in RELAXES:
            keep = np.exp(-1.0 / (RATE * time))
            columns.append(lfilter([keep, -keep], [1.0, -keep], angle - angle[0]))
        curve = BSpline.design_matrix(angle, self.knots, 3).toarray()[:, 1:]
        counts = [max(round(len(a) / RATE / DRIFT), 1) + 1 for a in self.angles]
        at, where = np.linspace(0.0, 1.0, len(angle)), np.linspace(0.0, 1.0, counts[index])
        own = np.stack([np.interp(at, where, row) for row in np.eye(counts[index])], axis=1)
        drift = [own if i == index else np.zeros((len(angle), n)) for i, n in enumerate(counts)]
        return np.column_stack([*columns, curve, *drift])

    def parts(self, index: int, ramp: RampSpan) -> Parts:
        """Of one stretch: largest viscous and inertial torque, elastic rise, and what is beyond."""
        of, n, lead = self.every[index], self.bends, self.lead
        first, last = (round((of.time[k] - of.time[0]) * RATE) for k in (ramp.begin, ramp.stop))
        rows, sign = self.rows[index], float(ramp.direction)
        span = slice(max(first - 5, 0), last + 6)
        curve = rows[:, lead : lead + n] @ self.c[lead : lead + n]
        end = min(last + round(0.05 * RATE), len(curve) - 1)
        viscous = rows[span, 1] * (self.c[1] + self.c[2] * RELAXES[0])
        window = slice(first + round(0.03 * RATE), min(last + round(0.3 * RATE), len(curve)))
        beyond = sign * self.left[index]
        before = float(np.mean(beyond[max(first - 30, 0) : max(first - 2, 1)]))
        top = window.start + int(np.argmax(beyond[window]))
        error = float(np.sqrt(rows[top] @ self.covariance @ rows[top] + self.sd**2))
        neural = float(beyond[top]) - before
        error = float(np.hypot(error, 0.5 * before))
        error = float(np.hypot(error, rows[top] @ self.diluted))
        rest = rows[max(first - 30, 0) : max(first - 2, 1)].mean(axis=0)
        error = float(np.hypot(error, np.linalg.norm(self.apart @ (rows[top] - rest))))
        late = self._late(index, ramp, first, last)
        driven = _driven([late], self.omega, len(rows))[:, 0]
        early = float(np.max((beyond - np.maximum(driven, 0.0))[window])) - before
        return Parts(
            sign * float(curve[end] - curve[max(first - 5, 0)]), float(np.max(sign * viscous)),
            float(np.max(np.abs(rows[span, 0] * self.c[0]))), neural,
            float(np.hypot(error, PEAK * neural)), early,
            _lasting(low(late, RATE, HELD)[last + round(GONE * RATE) :]),
            self._rise(index, sign, last + round(SETTLED * RATE)),
            self._rise(index, sign, first - round(SHOWN * RATE) - 5),
        )  # fmt: skip

    def _late(self, index: int, ramp: RampSpan, first: int, last: int) -> FloatArray:
        """Torque [Nm] that EMG which may be by will would hold, beyond a tonic answer's; (n,).

        Of a hold that is too short to show what is tonic nothing is told: 0.
        """
        of, late = self.every[index], np.zeros(len(self.rows[index]))
        following = [r.begin for r in of.ramps if r.begin > ramp.begin]
        until = round(following[0] / of.rate * RATE) if following else len(late)
        end = min(last + round(TONIC[1] * RATE), until)
        begin = min(last + round(TONIC[0] * RATE), end - round(SEEN * RATE))
        if begin > last + round((GONE + GOES_ON) * RATE):
            cut = slice(first + round(BY_WILL * RATE), begin)
            for gain, emg in zip(self.gains, self.heard[index].values(), strict=True):
                late[cut] += gain * (emg[cut] - float(np.mean(emg[begin:end])))
        return ramp.direction * late

    def _rise(self, index: int, sign: float, first: int) -> float:
        """Largest rise of the torque at rest over `SHOWN`: relaxed tissue's only falls."""
        torque = sign * self.still[index][max(first, 0) : first + round(SHOWN * RATE)]
        return float(np.max(torque - np.minimum.accumulate(torque))) if len(torque) else 0.0


def _left_out(x: FloatArray, y: FloatArray, c: FloatArray, label: np.ndarray) -> FloatArray:
    """By what coefficients change if one label's samples are left out, of a jackknife's weight.

    Their squares' sum is the variance of a jackknife over groups (Tukey 1958): what equations
    get wrong alike in all repeats of one speed shows where other speeds alone predict it.
    """
    size = np.sqrt(np.mean(x**2, axis=0)) + 1e-12
    scaled, groups, moved = x / size, np.unique(label), []
    ridge = RIDGE * len(y) * np.eye(x.shape[1])
    for group in groups:
        keep = scaled[label != group]
        normal = keep.T @ keep + ridge
        # towards the coefficients of all: of what only this group tells nothing is known
        moved.append(np.linalg.solve(normal, keep.T @ (y[label != group] - keep @ (c * size))))
    weight = np.sqrt((len(groups) - 1.0) / len(groups))
    return np.asarray(weight * np.array(moved) / size)


def _lasting(values: FloatArray) -> float:
    """Largest value that is exceeded for `GOES_ON`."""
    n = round(GOES_ON * RATE)
    ends = range(max(len(values) - n + 1, 0))
    return max((float(values[k : k + n].min()) for k in ends), default=0.0)


def _slow(of: Stretched, values: FloatArray) -> FloatArray:
    """A signal at `RATE`, smoothed before."""
    at = np.arange(of.time[0], of.time[-1], 1.0 / RATE)
    return np.interp(at, of.time, low(values, of.rate, 0.4 * RATE))


def _noise(every: Sequence[Stretched], muscle: str) -> float:
    """Power of an envelope's noise [1/Hz], its mean over all recordings.

    EMG is noise that a muscle's activity modulates: its envelope has noise in proportion to itself,
    of one power at all frequencies below the smoother's. Where activity begins or ends something
    else is in the band: the median is taken, which of a narrow band's power is ln 2 of the mean.
    """
    ratios, squares = list[FloatArray](), list[FloatArray]()
    for of in every:
        sections = butter(2, NOISY, "bandpass", fs=of.rate, output="sos")
        f, gain = sosfreqz(sections, 4096, fs=of.rate)
        width = float(np.sum(np.abs(gain) ** 4) * (f[1] - f[0]))
        noise = 0.5 * np.abs(hilbert(sosfiltfilt(sections, of.emg[muscle]))) ** 2 / width
        size = low(of.emg[muscle], of.rate, 1.0 / AVERAGED) ** 2
        ratios.append(noise / (size + 1e-100))
        squares.append(size)
    usual = float(np.median(np.concatenate(ratios))) / math.log(2.0)
    return usual * float(np.mean(np.concatenate(squares)))


def _driven(emg: Sequence[FloatArray], omega: float, n: int) -> FloatArray:
    """Torque of critically damped muscles that EMG drives, (n, muscles)."""
    keep = float(np.exp(-omega / RATE))
    once = [lfilter([1.0 - keep], [1.0, -keep], each) for each in emg]
    twice = [lfilter([1.0 - keep], [1.0, -keep], each) for each in once]
    return np.stack(twice, axis=1) if twice else np.zeros((n, 0))
