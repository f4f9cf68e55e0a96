"""Mean and spread of several legs: random effects, each leg as uncertain as its interval says."""

import math
from dataclasses import dataclass

import numpy as np

from surae.base.file_form import filed
from surae.base.normal import Student
from surae.base.units import FloatArray

#: Legs from which a mean and a spread are estimated.
FEWEST = 3


@filed("se", "tau2", k="n", ci95="ci95", between="sd_between")
@dataclass(frozen=True, slots=True)
class Effects:
    """Mean and spread of k legs."""

    k: int  #: Legs.
    #: `mean`, `se`: μ and its standard error after Hartung and Knapp.
    mean: float
    se: float
    tau2: float  #: Variance between legs.

    @property
    def between(self) -> float:
        """Standard deviation between legs."""
        return math.sqrt(self.tau2)

    @property
    def student(self) -> Student:
        """The mean as an estimate."""
        return Student(self.mean, self.se, self.k - 1)

    @property
    def ci95(self) -> tuple[float, float]:
        """95 % interval of the mean."""
        return self.student.ci95

    def shrunken(self, value: float, variance: float) -> tuple[float, float]:
        """A leg's value drawn to the mean, and its standard deviation."""
        whole = self.tau2 + variance
        share = self.tau2 / whole if whole > 0.0 else 1.0
        sd = math.sqrt(share * variance + ((1.0 - share) * self.se) ** 2)
        return self.mean + share * (value - self.mean), sd


def random_effects(values: FloatArray, variances: FloatArray) -> Effects:
    """Mean and spread of at least `FEWEST` finite values, shape (k,), with known variances.

    No value weighs more than an ordinary one, of the median variance: where errors are a part of
    the value, a small one seems surer than a large one, and would draw every mean down.
    """
    from scipy.optimize import minimize_scalar

    y = np.asarray(values, dtype=float)
    v = np.asarray(variances, dtype=float)
    scale = max(float(np.var(y)), float(np.median(v)), 1e-300)

    def against(tau2: float) -> float:
        w = 1.0 / (v + tau2)
        mean = float(w @ y / w.sum())
        return float(-np.log(w).sum() + np.log(w.sum()) + w @ (y - mean) ** 2)

    # τ² = 0 is a bound that the logarithm does not reach
    ends = (math.log(1e-8 * scale), math.log(1e3 * scale))
    best = minimize_scalar(lambda t: against(math.exp(t)), bounds=ends, method="bounded")
    at_zero = np.all(v > 0.0) and against(0.0) <= best.fun
    tau2 = 0.0 if at_zero else math.exp(float(best.x))
    w = 1.0 / (np.maximum(v, np.median(v)) + tau2)
    mean = float(w @ y / w.sum())
    se = math.sqrt(float(w @ (y - mean) ** 2) / ((len(y) - 1) * float(w.sum())))
    return Effects(len(y), mean, se, tau2)
