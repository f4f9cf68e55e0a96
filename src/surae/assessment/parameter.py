"""One parameter of a fit and what it is worth, as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from surae.assessment.verdict import Verdict


class Interval(StrEnum):
    """Which standard error an interval is made of."""

    THESIS = "thesis"
    ROBUST = "robust"
    MARGINAL = "marginal"


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One parameter of a fit.

    Attributes
    ----------
    name, unit, meaning, group : str
        As in `surae.model.Parameter`.
    value : float
        Estimate, or the value it was fixed at.
    sem : float or None
        Standard error, equation (34), which takes the residual for white noise; None where there
        is none, and `note` says why.
    sem_robust : float or None
        Standard error under noise that is correlated as the residual says.
    ci95 : tuple of float, or None
        95 % interval, from the standard error that `interval` names.
    interval : Interval or None
        Which standard error `ci95` and `verdict` rest on; None without one.
    lower, upper : float
        Bounds of the fit.
    free, at_bound : bool
        Whether it was estimated, and whether the estimate lies at a bound.
    verdict : Verdict
        identified, weak, undetermined, at-bound or fixed.
    note : str
        The verdict in a plain sentence.
    ci95_repeat : tuple of float, or None
        95 % interval of what another trial of this leg would give: what all its trials share, and
        is wrong alike in all of them, is not in it.
    repeatable : bool
        Whether that interval is within 10 % of the value, and the fit is not inadequate.
    budget : mapping of str to float
        Shares of the variance behind `ci95` by source, their sum 1; empty without an interval.
    """

    name: str
    unit: str
    meaning: str
    group: str
    value: float
    sem: float | None
    sem_robust: float | None
    ci95: tuple[float, float] | None
    interval: Interval | None
    lower: float
    upper: float
    free: bool
    at_bound: bool
    verdict: Verdict
    note: str
    ci95_repeat: tuple[float, float] | None = None
    repeatable: bool = False
    budget: Mapping[str, float] = field(default_factory=dict)

    @property
    def trusted_sem(self) -> float | None:
        """The standard error that `ci95` is made of."""
        return self.sem_robust if self.interval is Interval.ROBUST else self.sem
