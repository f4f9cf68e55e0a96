"""Measures that bend within their uncertainty, of possible legs that are drawn."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.uncertainty.combined import Uncertainty
from surae.measures.fitted_leg import leg_of, of_any_path
from surae.measures.leg import Leg
from surae.measures.points import Evaluated

#: Possible legs that are drawn, their seed, and how far a measure at the ends of its interval may
#: be from the linear ones, as a part of the half-width, before draws take its place.
_DRAWS = 1024
_SEED = 7
_BENT = 0.25


def drawn_legs(
    result: FitResult, known: Uncertainty, evaluated: Sequence[Evaluated]
) -> dict[str, FloatArray]:
    """Measures of possible legs, of those measures that bend; NaN where a leg has none.

    Legs are as they were fitted, and read at the angle that their zero says: turned with it too,
    what the zero makes unsure would cancel. Whether one bends is told along the line on which it
    changes most, from end to end of its interval, and so by no chance. Draws tell what leaves the
    line; along it they are brought to their own distribution, which is normal.
    """
    if known.lost == known.names:
        return {}
    likeliest = of_any_path(leg_of(result)) if known.geometry else leg_of(result)
    known = replace(known, turned=FrozenDict())
    lines = {}
    for each in evaluated:
        if each.point.definition.of_recordings or each.value is None or each.missing:
            continue
        line = _Line.of(each, known, likeliest)
        if line is not None and line.bends:
            lines[each.point] = line
    if not lines:
        return {}
    away = known.away(_DRAWS, _SEED)
    rows = np.empty((len(away), len(lines)))
    for i, drawn in enumerate(known.legs_at(away)):
        leg = likeliest.with_values(dict(zip(known.names, drawn.tolist(), strict=True)))
        rows[i] = [point.value(leg)[0] for point in lines]
    return {
        point.name: values + line.by_chance(away - known.mean_away)
        for (point, line), values in zip(lines.items(), rows.T, strict=True)
    }


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """A measure on the line through the likeliest leg along which it changes most."""

    value: float  #: Of the likeliest leg.
    slopes: FloatArray  #: Its gradient on the parameters' scale, shape (p,).
    half: float  #: Half of its interval, were it straight.
    at: FloatArray  #: Places on the line, in standard deviations from the middle, shape (k,).
    values: FloatArray  #: The measure there, shape (k,).

    @classmethod
    def of(cls, evaluated: Evaluated, known: Uncertainty, leg: Leg) -> "_Line | None":
        """The line; None where nothing makes the measure unsure."""
        slopes = evaluated.gradient * known.scale
        rows = np.concatenate(list(known.rows.values())) / known.scale
        along = rows.T @ (rows @ slopes)
        sd = math.sqrt(max(float(slopes @ along), 0.0))
        if not sd > 0.0:
            return None
        bias = known.bias(evaluated.gradient) / NORMAL
        direction = along / sd * (1.0 + bias / sd)
        at = np.array([-NORMAL, -1.0, 0.0, 1.0, NORMAL])
        legs = known.legs_at(known.mean_away + at[:, None] * direction)
        values = [
            evaluated.point.value(
                leg.with_values(dict(zip(known.names, each.tolist(), strict=True)))
            )[0]
            for each in legs
        ]
        assert evaluated.value is not None
        return cls(evaluated.value, slopes / sd, NORMAL * sd + bias * NORMAL, at, np.array(values))

    @property
    def bends(self) -> bool:
        """Whether it ends elsewhere than a straight one about the value, or is not everywhere."""
        ends = self.values[[0, -1]] - self.value
        off = np.abs(ends - np.array([-self.half, self.half])).max()
        return not off <= _BENT * self.half

    def by_chance(self, away: FloatArray) -> FloatArray:
        """What brings draws, so far from the middle, to their distribution on the line, (n,)."""
        from scipy.special import ndtri

        where = away @ self.slopes
        count = len(where)
        scores = np.empty(count)
        scores[np.argsort(where, kind="stable")] = ndtri((np.arange(count) + 0.5) / count)
        if not np.isfinite(self.values).all():
            return np.zeros(count)
        return np.asarray(self._on(scores) - self._on(where))

    def _on(self, where: FloatArray) -> FloatArray:
        """The measure at places on the line, straight beyond its ends."""
        inner = np.interp(where, self.at, self.values)
        low, high = np.diff(self.values)[[0, -1]] / np.diff(self.at)[[0, -1]]
        below = np.minimum(where - self.at[0], 0.0) * low
        return np.asarray(inner + below + np.maximum(where - self.at[-1], 0.0) * high)
