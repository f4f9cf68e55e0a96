"""One measure or parameter over a cohort: groups, contrasts, and each leg among them."""

from dataclasses import dataclass

from surae.base.file_form import filed
from surae.base.frozen import FrozenDict
from surae.cohorts.effects import Effects

#: Degrees by which ends of ranges may differ and still be one.
ALIKE = 0.5


@filed("leg")
@dataclass(frozen=True, slots=True)
class Among:
    """One leg among its group: its own value, and the one drawn to the group with its interval."""

    leg: str
    group: str
    value: float
    sd: float
    shrunken: float
    ci95: tuple[float, float]


@filed(k="n")
@dataclass(frozen=True, slots=True)
class Contrast:
    """A difference, its 95 % interval, and the p-value of none; `k` legs are behind it."""

    difference: float
    ci95: tuple[float, float]
    p: float
    k: int


@dataclass(frozen=True, slots=True)
class Correlation:
    """Spearman's rank correlation of n legs with a scale, and the p-value of none."""

    rho: float
    p: float
    n: int


@filed("name")
@dataclass(frozen=True, slots=True)
class PooledQuantity:
    """One measure or parameter over the cohort."""

    #: `name`, `unit`, `meaning`, `kind`: as of `Quantity`.
    name: str
    unit: str
    meaning: str
    kind: str
    groups: FrozenDict[str, Effects]  #: Mean and spread of each group of at least three legs.
    legs: tuple[Among, ...]  #: Every leg that has a value.
    #: Of each pair of groups, the second minus the first; p is Holm's of what was asked
    #: beforehand, else of the false discovery rate over all else.
    differences: FrozenDict[str, Contrast]
    changes: FrozenDict[str, Contrast]  #: Of each group, last session minus first.
    #: Of legs with each clinical scale, by rank; p as of differences.
    scales: FrozenDict[str, Correlation]
    left_out: FrozenDict[str, int]  #: Legs without a value, by reason.
    at_bound: int  #: Legs whose value lies at a bound.
    asked: bool = False  #: Whether it was asked beforehand.
    #: Of one over the range that was moved: the least and the largest of the angles [deg] from
    #: which, and to which, a leg's is taken; None of others.
    begins: tuple[float, float] | None = None
    ends: tuple[float, float] | None = None

    @property
    def over(self) -> str:
        """What it is taken over, where that is the same in all legs; else empty."""
        if self.begins is None or self.ends is None or self.is_mixed:
            return ""
        return f"{self.begins[0]:.1f}° to {self.ends[0]:.1f}°"

    @property
    def is_mixed(self) -> bool:
        """Whether legs have it over ranges of their own, which differ."""
        sides = [each for each in (self.begins, self.ends) if each is not None]
        return any(high - low > ALIKE for low, high in sides)
