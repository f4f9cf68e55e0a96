"""Torque over angle of a relaxed ankle: as it was measured, and as the model has it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.frozen import Comparable, read_only
from surae.base.normal import Student
from surae.base.units import FloatArray
from surae.inference import AssessedFit, FitResult
from surae.measures.fitted_leg import measured_range
from surae.measures.points import MeasurePoint, evaluate
from surae.measures.table import DEFINITIONS
from surae.model.movement import gravity_torque

#: Holds at angles that lie closer together show no slope [deg].
_SPAN = 5.0
#: Width of the steps of angle over which a stretch is averaged [deg].
_STEP = 1.0
#: Half of the range around an angle over which the slope of a stretch is taken [deg].
_AROUND = 5.0
#: Part of the speed that the ankle has for most of a stretch, below which it rests; a quick return
#: may be much faster.
_RESTS = 0.05


@dataclass(frozen=True, slots=True)
class HeldPoint:
    """A passive trial that holds still."""

    name: str  #: The trial's.
    angle: float  #: [deg], dorsiflexion positive.
    torque: float  #: Mean [Nm].


@dataclass(frozen=True, slots=True, eq=False)
class Stretch(Comparable):
    """A passive trial that moves, averaged by the angle; each array has shape (n,)."""

    name: str  #: The trial's.
    angle: FloatArray  #: [deg], dorsiflexion positive.
    #: `loading`, `unloading`: torque towards dorsiflexion and back [Nm]; NaN where there is none.
    loading: FloatArray
    unloading: FloatArray

    @property
    def torque(self) -> FloatArray:
        """Mean of both directions where both were measured, else the one that was [Nm]."""
        both = np.stack([self.loading, self.unloading])
        there = np.isfinite(both)
        mean: FloatArray = np.where(there, both, 0.0).sum(axis=0) / there.sum(axis=0)
        return mean


@dataclass(frozen=True, slots=True)
class MeasuredSlope:
    """Torque by the angle of a relaxed ankle, the foot's weight in it [Nm/deg]."""

    value: float
    #: 95 % interval of a line through three holds or more, or the slopes towards dorsiflexion and
    #: back of a stretch; None where there is neither.
    interval: tuple[float, float] | None
    low: float  #: `low`, `high`: angles between which it was taken [deg].
    high: float
    holds: int  #: Held angles it was taken from; 0 from a stretch.


def stretch(name: str, angle: FloatArray, velocity: FloatArray, torque: FloatArray) -> Stretch:
    """Average a passive movement [rad, rad/s, Nm] by angle, to dorsiflexion and back apart."""
    degrees = np.degrees(angle)
    slow = _RESTS * float(np.quantile(np.abs(velocity), 0.75))
    place = np.floor((degrees - degrees.min()) / _STEP).astype(int)
    count = int(place.max()) + 1
    lines = []
    for moves in (velocity > slow, velocity < -slow):
        n = np.bincount(place[moves], minlength=count)
        total = np.bincount(place[moves], torque[moves], minlength=count)
        line = np.where(n > 0, total / np.maximum(n, 1), np.nan)
        # a quick return shows inertia, at a few angles
        lines.append(line if 2 * np.count_nonzero(n) > count else np.full(count, np.nan))
    there = np.isfinite(lines).any(axis=0)
    middle = degrees.min() + _STEP * (np.arange(count) + 0.5)
    return Stretch(name, *(read_only(each[there]) for each in (middle, *lines)))


def measured_slope(
    holds: Sequence[HeldPoint], stretches: Sequence[Stretch], at: float
) -> MeasuredSlope | None:
    """The slope of a line through the holds, else of a stretch about `at` [deg]; else None."""
    angle, torque = (np.array([getattr(h, key) for h in holds]) for key in ("angle", "torque"))
    if len(holds) > 1 and np.ptp(angle) >= _SPAN:
        return _through(angle, torque)
    for each in stretches:
        near = np.abs(each.angle - at) <= _AROUND
        lines = (each.loading, each.unloading, each.torque)
        slopes = [_slope(each.angle[near], line[near]) for line in lines]
        if np.isfinite(slopes[2]):
            low, high = sorted(slopes[:2])
            ends = (low, high) if np.isfinite(low + high) else None
            angles = each.angle[near]
            return MeasuredSlope(slopes[2], ends, float(angles.min()), float(angles.max()), 0)
    return None


def _through(angle: FloatArray, torque: FloatArray) -> MeasuredSlope:
    """A line through holds, by least squares, with Student's t of what it misses."""
    slope, away = _line(angle, torque)
    free = len(angle) - 2
    interval = None
    if free > 0:
        missed = torque - torque.mean() - slope * away
        se = float(np.sqrt(missed @ missed / free / (away @ away)))
        interval = Student(slope, se, free).ci95
    return MeasuredSlope(slope, interval, float(angle.min()), float(angle.max()), len(angle))


def _slope(angle: FloatArray, torque: FloatArray) -> float:
    there = np.isfinite(torque)
    if there.sum() < 3 or np.ptp(angle[there]) < _AROUND:
        return np.nan
    return _line(angle[there], torque[there])[0]


def _line(angle: FloatArray, torque: FloatArray) -> tuple[float, FloatArray]:
    """Slope of a line by least squares, and the angles from their mean."""
    away = angle - angle.mean()
    return float(away @ torque / (away @ away)), away


#: Angles of the curve, at most, and the farthest that an ankle is drawn [deg].
_COUNT = 15
_LOWEST = -50.0
_HIGHEST = 35.0


@dataclass(frozen=True, slots=True, eq=False)
class TorqueCurve(Comparable):
    """Torque of the relaxed ankle over the measured range, without weight; shape (n,)."""

    angle: FloatArray  #: [deg], dorsiflexion positive.
    torque: FloatArray  #: [Nm]
    #: `low`, `high`: ends of its 95 % interval [Nm]; NaN where the recordings do not show it.
    low: FloatArray
    high: FloatArray


def weight_torque(result: FitResult, angle: FloatArray) -> FloatArray:
    """Torque of the foot's and the plate's weight [Nm] at angles [deg], as a fit has it."""
    options = result.problem.options
    weight, _ = gravity_torque(
        angle=np.radians(angle), theta_foot=options.theta_foot, distance=options.anatomy.distance
    )
    return np.asarray(result.values.get("m", 0.0) * weight)


def torque_curve(fit: AssessedFit) -> TorqueCurve:
    """The curve of a fit."""
    low, high = measured_range(fit.result)
    low = min(max(low, _LOWEST), _HIGHEST)
    high = max(min(high, _HIGHEST), _LOWEST)
    angle = np.linspace(low, high, _COUNT)
    known = fit.assessment.uncertainty
    (torque,) = (each for each in DEFINITIONS if each.name == "passive_torque")
    evaluated = evaluate(fit.result, known, [MeasurePoint(torque, float(at)) for at in angle])
    values = np.array([np.nan if t.value is None else t.value for t in evaluated])
    lost = np.isin(known.names, known.lost)
    half = np.array(
        [
            np.nan if t.missing or t.gradient[lost].any() else known.half_width(t.gradient)
            for t in evaluated
        ]
    )
    return TorqueCurve(*map(read_only, (angle, values, values - half, values + half)))
