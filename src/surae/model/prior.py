"""What is known of a parameter beforehand."""

from dataclasses import dataclass

import numpy as np

from surae.base.file_form import filed

#: Below this part of its median a parameter's prior no longer changes: its logarithm would not end.
_SMALLEST = 1e-6


@filed(sparse=("source", "log"), source="origin")
@dataclass(frozen=True, slots=True)
class Prior:
    """A Gaussian, on the parameter's logarithm or on itself."""

    median: float  #: Expected value, in the parameter's unit.
    #: Standard deviation of the logarithm, for small ones the relative one; or of the parameter.
    spread: float
    source: str = ""  #: Where it is from.
    log: bool = True  #: Whether it is on the logarithm; false of what may be negative.

    @property
    def centre(self) -> float:
        """The median where it is Gaussian: its logarithm, or itself."""
        return float(np.log(self.median)) if self.log else self.median

    def row(self, value: float) -> tuple[float, float]:
        """Standard deviations that a value is away from the median, its derivative first."""
        if not self.log:
            return 1.0 / self.spread, (value - self.median) / self.spread
        value = max(value, _SMALLEST * self.median)
        return 1.0 / (self.spread * value), float(np.log(value / self.median)) / self.spread
