"""What is known of a parameter beforehand."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.errors import InputError

#: Below this part of its median a parameter's prior no longer changes: its logarithm would not end.
_SMALLEST = 1e-6


@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of a parameter beforehand: a Gaussian on its logarithm.

    Attributes
    ----------
    median : float
        Expected value, in the parameter's unit.
    spread : float
        Standard deviation of the logarithm; for small ones, the relative standard deviation.
    straight : bool
        The Gaussian is on the parameter itself, `spread` in its unit: a nuisance of the laboratory.
    """

    median: float
    spread: float
    straight: bool = False

    def row(self, value: float) -> tuple[float, float]:
        """Standard deviations that a value is away from the median, its derivative first."""
        if self.straight:
            return 1.0 / self.spread, (value - self.median) / self.spread
        value = max(value, _SMALLEST * self.median)
        return 1.0 / (self.spread * value), float(np.log(value / self.median)) / self.spread

    def drawn(self, rng: np.random.Generator) -> "Prior":
        """The prior about a median that is drawn from it, as a bootstrap asks for."""
        away = self.spread * float(rng.standard_normal())
        median = self.median + away if self.straight else self.median * float(np.exp(away))
        return replace(self, median=median)


def checked_prior(name: str, pair: object, free: Sequence[str]) -> Prior:
    """The prior that a median and a spread make, of one of the free parameters."""
    if name not in free:
        raise InputError(
            f"prior of {name}: it is not estimated; free parameters: {', '.join(free)}"
        )
    if not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
        raise InputError(f"prior of {name} is {pair!r}; give its median and its spread")
    median, spread = pair
    for value in (median, spread):
        number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        if not number or not 0 < value < np.inf:
            raise InputError(f"prior of {name} is {pair!r}; median and spread must be above zero")
    return Prior(float(median), float(spread))
