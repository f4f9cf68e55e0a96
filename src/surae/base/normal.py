"""Intervals and p-values of normal distributions and of Student's."""

from dataclasses import dataclass

#: Half of a 95 % interval, in standard errors.
NORMAL = 1.959964


def standard_error_of(ci95: tuple[float, float]) -> float:
    """The standard error of which a 95 % interval is that of a normal distribution."""
    return (ci95[1] - ci95[0]) / (2.0 * NORMAL)


@dataclass(frozen=True, slots=True)
class Student:
    """An estimate whose standard error is known as well as its degrees of freedom say."""

    value: float
    se: float
    freedom: float

    @property
    def ci95(self) -> tuple[float, float]:
        """Its 95 % interval."""
        from scipy.special import stdtrit

        half = float(stdtrit(self.freedom, 0.975)) * self.se
        return self.value - half, self.value + half

    @property
    def p(self) -> float:
        """The p-value of zero; 1 without a standard error."""
        from scipy.special import stdtr

        return 2.0 * float(stdtr(self.freedom, -abs(self.value) / self.se)) if self.se else 1.0
