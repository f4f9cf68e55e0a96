"""A stretch's torque taken apart: tissue, as it is where no muscle answers, and what is beyond."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.nerve.competing import Competition
from surae.nerve.driven import Envelopes, driven
from surae.nerve.ramps import RATE, SMOOTH, RampSpan, Stretched, at_rate, low
from surae.nerve.tissue import RELAXES, Tissue

#: Without EMG: time from a stretch's begin in which no reflex has torque yet, and how long its
#: torque lasts after the stretch [s].
NOT_YET = 0.04
LATE = 0.6
#: Speed as a multiple of the slowest stretch's beyond which a reflex is looked for without EMG.
FAST = 2.0
#: Time from a stretch's begin to a reflex's torque, and after its stop until which it may be at its
#: largest: slow muscles take 0.3 s to it [s].
BEGINS = 0.03
LARGEST = 0.5
#: Time after a stretch in which the device comes to rest, and in which a reflex shows [s].
SETTLED = 0.06
SHOWN = 0.4
#: What of a reflex's peak is not known for its smoothing [1].
PEAK = 0.06
#: EMG later than this after the begin may be by will: reflexes of the ankle begin within 0.1 s
#: (Petersen 1998), and are smoothed [s]. EMG that goes on, later than a reflex's latency after the
#: stop, for longer than a beat of clonus (3 to 8 Hz: Hidler and Rymer 1999) is neither [s].
BY_WILL = 0.12
GONE = 0.08
GOES_ON = 0.2
#: When a tonic answer alone is left, after the stop, and for how long at least it must be seen [s];
#: cutoff that tells it from noise [Hz].
TONIC = (0.8, 1.4)
SEEN = 0.2
HELD = 6.0


@dataclass(frozen=True, slots=True)
class Parts:
    """Torque [Nm] of one stretch, at its most."""

    elastic: float
    viscous: float
    inertial: float
    neural: float
    error: float  #: Standard error of the neural part.
    early: float  #: The neural part without what EMG drives that comes late enough to be by will.
    sustained: float  #: What EMG drives that goes on after the stop for longer than a reflex does.
    rise: float  #: By how much torque rises again after the foot has stopped.
    rest: float  #: The same before the stretch, when nothing happens.


class TissueTorque:
    """Elastic, viscous and inertial torque of a leg, beside that of its EMG.

    Where there is EMG, its torque is that of second-order muscles which it drives, fitted with
    tissue's; where there is none, tissue is fitted to the samples in which no reflex is expected.
    """

    def __init__(
        self,
        every: Sequence[Stretched],
        quiet: Sequence[FloatArray],
        speeds: Sequence[np.ndarray],
    ) -> None:
        """Of each recording's samples `quiet` are fitted; `speeds` number those of one speed."""
        self.every = every
        self.tissue = Tissue([at_rate(of, of.angle) for of in every])
        self.envelopes = Envelopes(every)
        torques = [at_rate(of, low(of.torque, of.rate, SMOOTH)) for of in every]
        use = [at_rate(of, q.astype(float)) > 0.99 for of, q in zip(every, quiet, strict=True)]
        competition = Competition(self.tissue, self.envelopes, torques, use)
        self.descriptions = competition.best()
        rows = self.tissue.rows
        self.best = self.descriptions[0]
        # columns that compete share what is fast: their single torques are no one's
        plain = competition.plain(self.best.law).c
        self.inertia, self.viscosity = float(plain[0]), float(plain[1] + plain[2] * RELAXES[0])
        groups = [
            g[np.minimum((np.arange(len(r)) / RATE * of.rate).astype(int), len(g) - 1)]
            for g, r, of in zip(speeds, rows, every, strict=True)
        ]
        label = np.concatenate([g[u] for g, u in zip(groups, use, strict=True)])
        self.apart = competition.left_out(self.best, label)
        #: Torque beyond tissue's by each description, of each recording, (descriptions, n).
        self.beyond = [
            t - np.stack([d.c for d in self.descriptions]) @ r.T
            for t, r in zip(torques, rows, strict=True)
        ]
        drives = competition.drives(self.best.law)
        self.residuals = [
            b[0] - d @ self.best.gains for b, d in zip(self.beyond, drives, strict=True)
        ]
        against = np.array([m == "ta" for m in self.envelopes.muscles], bool)
        self.against = [d[:, against] @ self.best.gains[against] for d in drives]
        # torque of activity that its EMG does not show
        self.unseen = abs(float(self.envelopes.unseen(self.best.law) @ self.best.gains))
        self.called = self.envelopes.bent(self.best.law.bend)
        at_once = np.zeros(rows[0].shape[1])
        at_once[:2] = self.best.c[:2]
        curve = self.tissue.curve
        at_once[curve] = self.best.c[curve]
        self.still = [t - r @ at_once for t, r in zip(torques, rows, strict=True)]

    def parts(self, index: int, ramp: RampSpan) -> Parts:
        """Of one stretch: largest viscous and inertial torque, elastic rise, and what is beyond."""
        of = self.every[index]
        tissue = self.tissue
        best = self.best
        first, last = (round((of.time[k] - of.time[0]) * RATE) for k in (ramp.begin, ramp.stop))
        rows = tissue.rows[index]
        sign = float(ramp.direction)
        n = len(rows)
        span = slice(max(first - 5, 0), last + 6)
        before = slice(max(first - 30, 0), max(first - 2, 1))
        window = slice(first + round(BEGINS * RATE), min(last + round(LARGEST * RATE), n))
        curve = rows[:, tissue.curve] @ best.c[tissue.curve]
        end = min(last + round(0.05 * RATE), n - 1)
        inertial = rows[span, 0] * self.inertia
        viscous = rows[span, 1] * self.viscosity

        beyond = sign * self.beyond[index]
        weights = np.array([d.weight for d in self.descriptions])
        each = beyond[:, window].max(axis=1) - beyond[:, before].mean(axis=1)
        neural = float(weights @ each)
        mean = weights @ beyond
        top = window.start + int(np.argmax(mean[window]))
        at = rows[top][best.used]
        left = self.residuals[index]
        answers = left[first : min(last + round(SHOWN * RATE), n)] - float(np.mean(left[before]))
        error = float(
            np.linalg.norm(
                [
                    math.sqrt(at @ best.covariance @ at),
                    max(best.sd, float(np.sqrt(np.mean(answers**2)))),
                    0.5 * float(np.mean(mean[before])),
                    rows[top] @ best.diluted,
                    np.linalg.norm(self.apart @ (at - rows[before][:, best.used].mean(axis=0))),
                    math.sqrt(weights @ (each - neural) ** 2),
                    self.unseen,
                    self.against[index][top],
                    PEAK * neural,
                ]
            )
        )
        late = self._late(index, ramp, first, last)
        by_will = np.maximum(driven([late], best.law, n)[:, 0], 0.0)
        early = float(np.max((beyond[0] - by_will)[window])) - float(np.mean(beyond[0, before]))
        return Parts(
            sign * float(curve[end] - curve[max(first - 5, 0)]),
            float(np.max(sign * viscous)),
            float(np.max(np.abs(inertial))),
            neural,
            error,
            early,
            _lasting(low(late, RATE, HELD)[last + round(GONE * RATE) :]),
            self._rise(index, sign, last + round(SETTLED * RATE)),
            self._rise(index, sign, first - round(SHOWN * RATE) - 5),
        )

    def _late(self, index: int, ramp: RampSpan, first: int, last: int) -> FloatArray:
        """Torque [Nm] that EMG which may be by will would hold, beyond a tonic answer's; (n,).

        Of a hold that is too short to show what is tonic nothing is told: 0.
        """
        of = self.every[index]
        late = np.zeros(len(self.tissue.rows[index]))
        following = [r.begin for r in of.ramps if r.begin > ramp.begin]
        until = round(following[0] / of.rate * RATE) if following else len(late)
        end = min(last + round(TONIC[1] * RATE), until)
        begin = min(last + round(TONIC[0] * RATE), end - round(SEEN * RATE))
        if begin > last + round((GONE + GOES_ON) * RATE):
            cut = slice(first + round(BY_WILL * RATE), begin)
            for gain, emg in zip(self.best.gains, self.called[index], strict=True):
                late[cut] += gain * (emg[cut] - float(np.mean(emg[begin:end])))
        return ramp.direction * late

    def _rise(self, index: int, sign: float, first: int) -> float:
        """Largest rise of the torque at rest over `SHOWN`: relaxed tissue's only falls."""
        torque = sign * self.still[index][max(first, 0) : first + round(SHOWN * RATE)]
        return float(np.max(torque - np.minimum.accumulate(torque))) if len(torque) else 0.0


def _lasting(values: FloatArray) -> float:
    """Largest value that is exceeded for `GOES_ON`."""
    n = round(GOES_ON * RATE)
    ends = range(max(len(values) - n + 1, 0))
    return max((float(values[k : k + n].min()) for k in ends), default=0.0)
