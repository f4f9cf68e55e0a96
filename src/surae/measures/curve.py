"""The torque-angle curve of a fit, at rest and at its largest activity, with bands."""

from dataclasses import dataclass

import numpy as np

from surae.assessment import Assessment
from surae.estimation import FitResult
from surae.frozen import Comparable, read_only
from surae.measures.compute import Evaluated, MeasurePoint, evaluate
from surae.measures.leg import measured_range
from surae.measures.spread import Spread, spread_of
from surae.measures.table import DEFINITIONS
from surae.normal import NORMAL
from surae.units import FloatArray

#: Angles of the curve, at most, and the farthest that an ankle is drawn [deg].
_COUNT, _LOWEST, _HIGHEST = 15, -50.0, 35.0
_LINES = ("passive_torque", "active_torque_max_tri", "active_torque_max_tib")


@dataclass(frozen=True, slots=True, eq=False)
class CurveLine(Comparable):
    """One line of the curve: torque [Nm] and its 95 % band at the angles, arrays of shape (n,).

    Without a band, NaN, where the recordings do not tell what the torque rests on.
    """

    torque: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class TorqueCurve(Comparable):
    """Torque against angle over the measured range."""

    angle: FloatArray  #: [deg], dorsiflexion positive, shape (n,).
    #: `passive`, `active_tri`, `active_tib`: the relaxed ankle; and what calf and tibialis add at
    #: the session's largest activity.
    passive: CurveLine
    active_tri: CurveLine
    active_tib: CurveLine


def torque_curve(result: FitResult, assessment: Assessment) -> TorqueCurve:
    """The curve of a fit."""
    low, high = measured_range(result)
    low, high = min(max(low, _LOWEST), _HIGHEST), max(min(high, _HIGHEST), _LOWEST)
    angle = np.linspace(low, high, _COUNT)
    spread = spread_of(result, assessment)
    known = {definition.name: definition for definition in DEFINITIONS}
    wanted = [MeasurePoint(known[name], float(at)) for name in _LINES for at in angle]
    evaluated = evaluate(result, spread, wanted)
    values = [np.nan if t.value is None else t.value for t in evaluated]
    value = np.reshape(values, (len(_LINES), _COUNT))
    sd = np.reshape([_deviation(t, spread) for t in evaluated], value.shape)
    lines = zip(value, value - NORMAL * sd, value + NORMAL * sd, strict=True)
    return TorqueCurve(read_only(angle), *(CurveLine(*map(read_only, line)) for line in lines))


def _deviation(evaluated: Evaluated, spread: Spread) -> float:
    lost = any(
        g != 0.0 and n in spread.lost for n, g in zip(spread.names, evaluated.gradient, strict=True)
    )
    return np.nan if evaluated.missing or lost else spread.sd(evaluated.gradient)
