"""Random effects: the mean and spread of legs whose values are uncertain, by REML.

    y_i = μ + u_i + e_i,   u_i ~ N(0, τ²),   e_i ~ N(0, v_i), v_i known

τ² maximises the restricted likelihood; the standard error of μ is that of Hartung and Knapp (2001),
with Student's t of k − 1 degrees of freedom, which holds for few legs too. A leg's own value is
drawn to the mean by as much as it is uncertain.

References
----------
J. Hartung, G. Knapp (2001). A refined method for the meta-analysis of controlled clinical trials
with binary outcome. Statistics in Medicine 20(24):3875-3889.
"""

import math
from dataclasses import dataclass

import numpy as np

from surae.filed import filed
from surae.units import FloatArray

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
    def ci95(self) -> tuple[float, float]:
        """95 % interval of the mean."""
        from scipy.special import stdtrit

        half = float(stdtrit(self.k - 1, 0.975)) * self.se
        return self.mean - half, self.mean + half

    def shrunken(self, value: float, variance: float) -> tuple[float, float]:
        """A leg's value drawn to the mean, and its standard deviation."""
        whole = self.tau2 + variance
        share = self.tau2 / whole if whole > 0.0 else 1.0
        sd = math.sqrt(share * variance + ((1.0 - share) * self.se) ** 2)
        return self.mean + share * (value - self.mean), sd


def random_effects(values: FloatArray, variances: FloatArray) -> Effects:
    """Mean and spread of values, shape (k,), with known variances.

    There are at least `FEWEST` of them, all finite.
    """
    from scipy.optimize import minimize_scalar

    y, v = np.asarray(values, dtype=float), np.asarray(variances, dtype=float)
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
    w = 1.0 / (v + tau2)
    mean = float(w @ y / w.sum())
    se = math.sqrt(float(w @ (y - mean) ** 2) / ((len(y) - 1) * float(w.sum())))
    return Effects(len(y), mean, se, tau2)
