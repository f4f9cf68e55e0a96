"""The torque of a fit's relaxed ankle over its angle, with its band."""

from dataclasses import dataclass

import numpy as np

from surae.assessment import Assessment
from surae.estimation import FitResult
from surae.frozen import Comparable, read_only
from surae.measures.compute import Evaluated, MeasurePoint, evaluate
from surae.measures.leg import measured_range
from surae.measures.spread import Spread, spread_of
from surae.measures.table import DEFINITIONS
from surae.model.movement import gravity_torque
from surae.normal import NORMAL
from surae.units import FloatArray

#: Angles of the curve, at most, and the farthest that an ankle is drawn [deg].
_COUNT, _LOWEST, _HIGHEST = 15, -50.0, 35.0


@dataclass(frozen=True, slots=True, eq=False)
class TorqueCurve(Comparable):
    """Torque of the relaxed ankle over the measured range, the foot's weight in it.

    Arrays of shape (n,); without a band, NaN, where the recordings do not show what the torque
    rests on.
    """

    angle: FloatArray  #: [deg], dorsiflexion positive.
    torque: FloatArray  #: [Nm]
    #: `low`, `high`: ends of its 95 % interval [Nm].
    low: FloatArray
    high: FloatArray


def torque_curve(result: FitResult, assessment: Assessment) -> TorqueCurve:
    """The curve of a fit."""
    low, high = measured_range(result)
    low, high = min(max(low, _LOWEST), _HIGHEST), max(min(high, _HIGHEST), _LOWEST)
    angle = np.linspace(low, high, _COUNT)
    spread = spread_of(result, assessment)
    (torque,) = (each for each in DEFINITIONS if each.name == "passive_torque")
    evaluated = evaluate(result, spread, [MeasurePoint(torque, float(at)) for at in angle])
    values = np.array([np.nan if t.value is None else t.value for t in evaluated])
    options = result.problem.options
    values += result.values.get("m", 0.0) * gravity_torque(
        angle=np.radians(angle), theta_foot=options.theta_foot, distance=options.anatomy.distance
    )
    half = NORMAL * np.array([_deviation(t, spread) for t in evaluated])
    return TorqueCurve(*map(read_only, (angle, values, values - half, values + half)))


def _deviation(evaluated: Evaluated, spread: Spread) -> float:
    lost = any(
        g != 0.0 and n in spread.lost for n, g in zip(spread.names, evaluated.gradient, strict=True)
    )
    return np.nan if evaluated.missing or lost else spread.sd(evaluated.gradient)
