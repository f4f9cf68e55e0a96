"""Measures at points: their values for a leg, and their derivatives by all that was estimated."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.plugins import plugins
from surae.base.setting import is_number
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import FitResult
from surae.inference.uncertainty.combined import Uncertainty
from surae.measures.fitted_leg import leg_of, of_any_path, thinned_leg
from surae.measures.leg import Leg, NotDefinedError
from surae.measures.table import DEFINITIONS, Definition
from surae.model.laboratory import OUTSIDE, group_of

#: Default angles of measures, and those that are possible [deg].
ANGLES = (-10.0, 0.0, 10.0)
_MOST = 60.0
#: Step of a derivative: of a logarithm, and of other parameters as a part of value or range.
_STEP = 1e-3


@dataclass(frozen=True, slots=True)
class MeasurePoint:
    """A measure at a point."""

    definition: Definition
    at: float

    @property
    def name(self) -> str:
        """Name of the measure, with the point."""
        return self.definition.named(self.at)

    def value(self, leg: Leg) -> tuple[float, Message | None]:
        """The measure of a leg; where it has none, NaN and why."""
        try:
            value = self.definition.value(leg, self.at)
        except NotDefinedError as error:
            return math.nan, Message(error.code, leg.options.anatomy.worded, **error.values)
        except (ComputationError, OverflowError, ZeroDivisionError):
            value = math.nan
        return (value, None) if math.isfinite(value) else (math.nan, Message("none/number"))


@dataclass(frozen=True, slots=True, eq=False)
class Evaluated:
    """A measure of one fit, as far as comparisons need it."""

    point: MeasurePoint  #: Which.
    value: float | None  #: None where there is none, for the reason `missing`.
    gradient: FloatArray  #: By the free parameters, shape (p,).
    missing: Message | None = None  #: Why it has no value or no interval.
    #: Of one by rest alone, on which no parameter acts: its standard deviation, and that of what
    #: another session draws anew.
    deviations: tuple[float, float] | None = None


def points(angles: Sequence[float] = ANGLES, end: float = math.inf) -> tuple[MeasurePoint, ...]:
    """All measures at their points; `end` [deg] is that of the range, if not each fit's own."""
    for angle in angles:
        if not (is_number(angle) and abs(float(angle)) <= _MOST):
            raise InputError(f"angle {angle!r}: give degrees from −{_MOST:g} to {_MOST:g}")
    distinct = tuple(dict.fromkeys(float(angle) for angle in angles))
    return tuple(
        MeasurePoint(each, at)
        for each in (*DEFINITIONS, *plugins("measures", Definition).values())
        for at in (distinct if each.at == "deg" else (end,) if each.span else each.points)
    )


def evaluate(
    result: FitResult, known: Uncertainty, wanted: Sequence[MeasurePoint]
) -> tuple[Evaluated, ...]:
    """Values of measures and their derivatives by everything that was estimated."""
    leg = leg_of(result)
    values, missing = (list(of) for of in zip(*(point.value(leg) for point in wanted), strict=True))
    gradients = np.zeros((len(wanted), len(known.names)))
    reach = np.maximum(np.abs(known.values), 0.01 * (known.upper - known.lower))
    reach = np.where(np.isfinite(reach), reach, 1.0)
    steps = np.where(np.isnan(known.origin), _STEP * reach, _STEP)
    if any(point.definition.of_recordings for point in wanted):
        leg = thinned_leg(leg)
    with_geometry = of_any_path(leg) if known.geometry else leg
    for j, name in enumerate(known.names):
        step = float(steps[j])
        moving = with_geometry if known.geometry and name in known.geometry.by else leg
        follows = name not in result.problem.free  # as a length at 0 rad follows its path
        if follows and not any(by[:, j].any() for by in known.rows.values()):
            continue
        sides = [moving.with_values(known.moved_leg(name, by)) for by in (-step, step)]
        for i, point in enumerate(wanted):
            group = group_of(name)
            of = point.definition
            # where the ankle was at the end of the movement depends on its axis
            outside = group in OUTSIDE and not (of.of_recordings or (of.span and group == "axis"))
            if math.isnan(values[i]) or outside:
                continue
            (low, below), (high, above) = (point.value(side) for side in sides)
            gradients[i, j] = (high - low) / (2.0 * step * known.scale[j])
            if why := below or above:
                gradients[i, j] = 0.0
                computed = why.code == "none/number"
                edge = "none/edge-computed" if computed else "none/edge-defined"
                missing[i] = Message(edge, name=name, why=why)
    return tuple(
        Evaluated(point, None if math.isnan(value) else value, gradient, why)
        for point, value, gradient, why in zip(wanted, values, gradients, missing, strict=True)
    )
