"""One parameter of a fit: its verdict in a word and a sentence, and all of it as plain data."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from surae.assessment.uncertainty.covariance import Covariance
from surae.filed import filed
from surae.model.registry import PARAMETERS

#: Half-width of the 95 % interval, as a part of the value, up to which a parameter is identified.
IDENTIFIED = 0.10
#: Correlation from which the partner is named.
_STRONG = 0.9


class Verdict(StrEnum):
    """Judgement of one parameter."""

    IDENTIFIED = "identified"
    WEAK = "weak"
    UNDETERMINED = "undetermined"
    AT_BOUND = "at-bound"
    FIXED = "fixed"


def judge_interval(
    name: str,
    value: float,
    half: float,
    estimated: Covariance,
    unit: str = "-",
    *,
    withheld: bool = False,
) -> tuple[Verdict, str]:
    """Verdict and sentence of a parameter that has an interval.

    `half` is the half-width of its 95 % interval; its strongest partner is looked up in
    `estimated`. `withheld` says that the fit is inadequate, so that nothing is claimed.
    """
    relative = half / abs(value) if value else np.inf
    if relative <= IDENTIFIED:
        if withheld:
            return Verdict.WEAK, "the fit is inadequate: what it says of a parameter means nothing"
        return Verdict.IDENTIFIED, f"known to ±{percent(relative)}"
    verdict = Verdict.WEAK if relative <= 1.0 else Verdict.UNDETERMINED
    # A part of a value that may as well be 0 says nothing.
    nothing = name in PARAMETERS and PARAMETERS[name].off_at_zero and half >= abs(value)
    if nothing:
        known = f"not distinguishable from 0 (95 %: {_interval(value, half, unit)})"
    elif verdict is Verdict.WEAK:
        known = f"known only to ±{percent(relative)}"
    else:
        known = "not determined: its interval is wider than its value"
    row = estimated.correlation[estimated.names.index(name)].copy()
    row[estimated.names.index(name)] = 0.0
    partner = int(np.argmax(np.abs(row)))
    if abs(row[partner]) >= _STRONG:
        against = estimated.names[partner]
        return verdict, (
            f"{known}: trades off with {against} (correlation {row[partner]:+.2f}); fix one of the "
            "two, or measure a movement that tells them apart"
        )
    if nothing:
        return verdict, known
    return verdict, f"{known}: it has little influence on this torque"


def judge_singular(name: str, directions: Sequence[Sequence[str]]) -> str:
    """Why a parameter has no interval: the parameters it trades off with."""
    partners = sorted({p for d in directions if name in d for p in d if p != name})
    if not partners:
        return "no interval: the torque does not depend on it; fix it"
    return f"no interval: cannot be separated from {', '.join(partners)}; fix one of them"


def _interval(value: float, half: float, unit: str) -> str:
    """Both ends, to two digits of the half-width; parts of a second in ms."""
    low, high = value - half, value + half
    if unit == "s" and max(-low, high) < 1.0:
        low, high, half, unit = 1e3 * low, 1e3 * high, 1e3 * half, "ms"
    digits = 1 - math.floor(math.log10(half)) if 0.0 < half < math.inf else 0
    ends = (f"{round(end, digits) + 0.0:.15g}".replace("-", "−") for end in (low, high))
    return " … ".join(ends) + (f" {unit}" if unit not in ("", "-") else "")


def percent(part: float) -> str:
    """A part in percent to two digits, or as many as tell it from the threshold of a verdict."""
    if part >= 0.995:
        return f"{100 * part:.0f} %"
    text = f"{100 * part:.2g} %"
    same = text == f"{100 * IDENTIFIED:.2g} %"
    return f"{100 * part:.4g} %" if same and part != IDENTIFIED else text


class Interval(StrEnum):
    """Which standard error an interval is made of."""

    THESIS = "thesis"
    ROBUST = "robust"
    MARGINAL = "marginal"


@filed("name", "meaning", "group")
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
        95 % interval of what would be found were this leg measured and fitted once more in the same
        way: as many trials of the same kind, electrodes and foot left as they are, with other
        noise, effort, drift and zero of the sensor. What is wrong alike in both is not in it, nor a
        change of the leg itself, unless recordings of a joint fit show how much trials differ. Two
        such values differ by up to √((a² + b²)/2), a and b the half-widths of their intervals.
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
    def is_informed(self) -> bool:
        """Whether its interval is narrower than its bounds; else its value is only a start."""
        width = self.upper - self.lower
        return self.ci95 is not None and self.ci95[1] - self.ci95[0] < (1.0 - 1e-6) * width

    @property
    def trusted_sem(self) -> float | None:
        """The standard error that `ci95` is made of."""
        return self.sem_robust if self.interval is Interval.ROBUST else self.sem
