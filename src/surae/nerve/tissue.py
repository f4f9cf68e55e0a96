"""Torque of tissue in columns: those that are always fitted, and those that compete.

Tissue of a stretched leg is no spring and damper alone: it relaxes at several rates, more where it
is stiffer (Fung 1993), is damped by another power of velocity or more near the end of its range,
holds until it yields (Dahl 1968), and torque and angle are not measured at quite one moment.
"""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import BSpline
from scipy.signal import lfilter

from surae.base.units import FloatArray
from surae.nerve.ramps import RATE

#: Times in which tissue relaxes [s]; time between knots of a torque's drift [s].
RELAXES = (0.05, 0.8)
DRIFT = 15.0
#: Knots of the elastic torque over the angle.
KNOTS = 6
#: Further times of relaxing [s]: of torque in proportion to angle, and of torque that grows with it
#: exponentially, by so much [1/rad] (calves: 2.5 to 6, de Vlugt 2010; that of the stiffer half).
ALSO = (0.015, 0.15, 0.3, 2.5)
BENT = (0.05, 0.3, 0.8, 2.0)
STEEP = 5.0
#: Movement after which what holds has yielded [rad]: cross-bridges, and the skin in its straps.
YIELDS = np.deg2rad((1.5, 5.0))


class Tissue:
    """Columns of all recordings of a leg, one row a sample of `RATE`."""

    def __init__(self, angles: Sequence[FloatArray]) -> None:
        """Of the angle of each recording [rad], shapes (n,)."""
        self.angles = angles
        self.low, self.high = (float(f(np.concatenate(angles))) for f in (np.min, np.max))
        ends = self.low - 1e-6, self.high + 1e-6
        inner = np.linspace(*ends, KNOTS)[1:-1]
        self.knots = np.concatenate([[ends[0]] * 4, inner, [ends[1]] * 4])
        made = [self._of(i) for i in range(len(angles))]
        #: Columns that are always fitted: their number; those of the elastic curve.
        self.always = made[0][0].shape[1]
        self.curve = slice(2 + len(RELAXES), 2 + len(RELAXES) + len(self.knots) - 5)
        self.rows = [np.hstack(pair) for pair in made]

    def _of(self, index: int) -> tuple[FloatArray, FloatArray]:
        """Columns of one recording: always fitted, and competing."""
        angle = self.angles[index]
        v = np.gradient(angle, 1.0 / RATE)
        a = np.gradient(v, 1.0 / RATE)
        curve = BSpline.design_matrix(angle, self.knots, 3).toarray()[:, 1:]
        counts = [max(round(len(x) / RATE / DRIFT), 1) + 1 for x in self.angles]
        at = np.linspace(0.0, 1.0, len(angle))
        where = np.linspace(0.0, 1.0, counts[index])
        knots = np.stack([np.interp(at, where, row) for row in np.eye(counts[index])], axis=1)
        drift = [knots if i == index else np.zeros((len(angle), n)) for i, n in enumerate(counts)]
        always = [a, v, *(_relaxing(angle, t) for t in RELAXES), curve, *drift]
        steep = np.exp(STEEP * (angle - self.high))
        competing = [
            *(_relaxing(angle, t) for t in ALSO),
            *(_relaxing(steep, t) for t in BENT),
            v * (angle - self.low),
            np.sign(v) * np.sqrt(np.abs(v)),
            v * np.abs(v),
            *(_held(angle, reach) for reach in YIELDS),
            np.gradient(a, 1.0 / RATE),
        ]
        return np.column_stack(always), np.column_stack(competing)


def _relaxing(values: FloatArray, seconds: float) -> FloatArray:
    """What of a signal has not yet relaxed."""
    keep = float(np.exp(-1.0 / (RATE * seconds)))
    return np.asarray(lfilter([keep, -keep], [1.0, -keep], values - values[0]))


def _held(angle: FloatArray, reach: float) -> FloatArray:
    """Part of its torque, −1 to 1, with which something holds that yields after a reach [rad]."""
    held = [0.0]
    now = 0.0
    for step in (np.diff(angle) / reach).tolist():
        now = (now + step) / (1.0 + abs(step))
        held.append(now)
    return np.array(held)
