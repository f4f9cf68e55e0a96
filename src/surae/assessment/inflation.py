"""By how much noise that is correlated over time counts more than white noise does.

A profile and a posterior take the residual for white noise, as equation (33) does. Where an
assessment does not believe that, the variance of the noise is multiplied by the square of the
robust standard error over the thesis's, so that a parabola has the robust one's width. What a loss
for outliers asks for is part of it: the robust standard error has the curvature of the loss and its
scale (`surae.assessment.uncertainty.robust`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.assessment.assess import Assessment
from surae.assessment.parameter import Interval


@dataclass(frozen=True, slots=True)
class Inflation:
    """Factors on the variance of the noise."""

    factors: Mapping[str, float]  #: Of every parameter that was estimated.
    reason: str  #: Why, in a plain phrase.

    @property
    def common(self) -> float:
        """One factor for all: the median over the parameters."""
        return float(np.median(list(self.factors.values()))) if self.factors else 1.0


def variance_inflation(assessment: Assessment) -> Inflation:
    """The factors that an assessment asks for: 1 where its residuals pass for white noise.

    Where intervals are robust it is (sem_robust/sem)² of each parameter. One without a standard
    error, as at a bound, has the median of the others.
    """
    free = [p for p in assessment.parameters.values() if p.free]
    if assessment.interval is not Interval.ROBUST:
        return Inflation({p.name: 1.0 for p in free}, assessment.interval_note)
    known = {p.name: (p.sem_robust / p.sem) ** 2 for p in free if p.sem and p.sem_robust}
    common = Inflation(known, "").common
    return Inflation({p.name: known.get(p.name, common) for p in free}, assessment.interval_note)


def described(factors: Mapping[str, float], reason: str) -> str:
    """What was done to the noise and why, as a line: ``variance of the noise ×4: …``."""
    least, most = f"{min(factors.values()):.3g}", f"{max(factors.values()):.3g}"
    text = f"×{least}" if least == most else f"×{least} … ×{most}, by parameter"
    return f"variance of the noise {text}" + (f": {reason}" if reason else "")
