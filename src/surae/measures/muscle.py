"""A muscle group of a leg: its path at an angle, its tissue and tendon, and both in series."""

import math
from typing import NamedTuple

import numpy as np

from surae.model.contraction import force_length
from surae.model.tendon import TendonCurve, tendon_force

#: A degree [rad].
_DEGREE = math.pi / 180.0


class MuscleHold(NamedTuple):
    """A muscle group that holds still at an angle."""

    force: float  #: On its tendon [N].
    #: Of muscle and tendon in series, by the length of both together, tissue fully relaxed [N/m].
    stiffness: float
    quick: float  #: The same before tissue relaxes [N/m].
    length: float  #: Of the muscle [m].
    #: By how much the muscle lengthens of what both together do, slowly [-]; 1 on a rigid tendon.
    given: float
    #: `arm`, `slope`: moment arm [m], and length of both together by the angle [m/rad].
    arm: float
    slope: float
    arm_slope: float  #: Moment arm by the angle [m/rad].
    lift: float  #: Force-length factor (16) [-].

    @property
    def torque(self) -> float:
        """Torque of the muscle on the ankle, positive where the triceps pulls [Nm]."""
        return self.arm * self.force

    def torque_slope(self, stiffness: float) -> float:
        """Torque by the angle for a stiffness of this muscle [Nm/deg]."""
        return (self.arm_slope * self.force + self.arm * stiffness * self.slope) * _DEGREE


class MusclePlace(NamedTuple):
    """Path of a muscle group at an angle."""

    #: `length`, `slope`: length of muscle and tendon beyond the tendon's slack length [m], and its
    #: derivative by the angle [m/rad].
    length: float
    slope: float
    #: `arm`, `arm_slope`: moment arm [m] and its derivative.
    arm: float
    arm_slope: float


class Muscle(NamedTuple):
    """A muscle group of a leg, at any angle."""

    k: float  #: Stiffness coefficient [1/m].
    x0: float  #: Slack length [m]; infinite where it has no tissue.
    l0: float  #: Optimal length [m].
    relaxed: float  #: As of `Leg`.
    shift: float  #: F0, of models that have one [N].
    shape: tuple[float, float, float, float]  #: Of its curves, as of `Leg.curves`.
    curve: TendonCurve | None  #: Of its tendon; None where that is rigid.

    def elastic(self, x: float) -> float:
        """Elastic force before relaxation (8) [N]; infinite where there is no number as large."""
        if self.x0 == math.inf:
            return 0.0
        try:
            return math.exp(self.k * (x - self.x0))
        except OverflowError:
            return math.inf

    def lift(self, x: float) -> tuple[float, float]:
        """Force-length factor (16) and its slope [1/m]."""
        value, slope, _, _ = force_length(x, self.l0, *self.shape[:2])
        return value, slope


def elongation(curve: TendonCurve, force: float) -> float:
    """Elongation of a tendon at a force [m]: equation (18) turned round."""
    e_toe, bend, scale, k_lin, offset = curve
    if force <= tendon_force(e_toe, curve)[0]:
        return float(np.log1p(force / scale) / bend)
    return (force - offset) / k_lin


def series(a: float, b: float) -> float:
    """Stiffness of two springs in series [N/m]."""
    return a * b / (a + b) if a + b else 0.0
