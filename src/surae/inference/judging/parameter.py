"""One parameter of a fit: its verdict in a word and a sentence, and all of it as plain data."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from surae.base.file_form import filed
from surae.base.formatting import in_a_line
from surae.base.normal import NORMAL, standard_error_of
from surae.base.words import Message
from surae.inference.judging.verdict import IDENTIFIED, Verdict, verdict_of
from surae.inference.uncertainty.covariance import Covariance
from surae.model.registry import PARAMETERS

if TYPE_CHECKING:
    from surae.inference.uncertainty.combined import Uncertainty

#: Correlation from which the partner is named.
_STRONG = 0.9
#: Part of the variance by arms and paths, from which an interval is said to rest on them.
_GEOMETRY = 0.25
#: What is said of a parameter in place of a claim.
INADEQUATE = Message("note/inadequate")


def judge_interval(
    name: str,
    value: float,
    half: float,
    estimated: Covariance,
    *,
    withheld: bool = False,
    room: float = np.inf,
    narrowed: float = 0.0,
    noise: float | None = None,
) -> tuple[Verdict, Message]:
    """Verdict and sentence of a parameter that has an interval.

    `half` is the half-width of its 95 % interval, and `noise` what of it is noise; its strongest
    partner is looked up in `estimated`. `withheld` says that the fit is inadequate, so that nothing
    is claimed; `room` and `narrowed` are as of `verdict_of`.
    """
    noise = half if noise is None else noise
    relative = half / abs(value) if value else np.inf
    verdict = verdict_of(value, half, room=room, narrowed=narrowed, doubted=withheld)
    if verdict is Verdict.IDENTIFIED:
        return verdict, Message("note/known", percent=percent(relative))
    if relative <= IDENTIFIED and verdict is Verdict.WEAK:
        if withheld:
            return verdict, INADEQUATE
        known = Message("note/known", percent=percent(relative))
        return verdict, Message("note/but", known=known, but=Message("note/no-better"))
    # A part of a value that may as well be 0 says nothing.
    p = PARAMETERS.get(name)
    nothing = p is not None and p.off_at_zero and noise >= abs(value)
    if p is not None and nothing:
        known = Message("note/zero", interval=_interval(value, noise, p.unit))
    elif verdict is Verdict.WEAK:
        known = Message("note/known-only", percent=percent(relative))
    elif relative <= 1.0:
        known = Message("note/as-bounds")
    else:
        known = Message("note/wide")
    place = estimated.names.index(name)
    row = np.where(np.arange(len(estimated.names)) == place, 0.0, estimated.correlation[place])
    partner = int(np.argmax(np.abs(row)))
    if abs(row[partner]) >= _STRONG:
        other = estimated.names[partner]
        known = Message("note/trades", known=known, partner=other, r=row[partner])
    elif not nothing:
        known = Message("note/little", known=known)
    return verdict, known


def by_geometry(name: str, known: "Uncertainty", ci95: tuple[float, float]) -> Message | None:
    """What an interval rests on where arms and paths make much of it; None where they do not."""
    if known.geometry is None or not known.goes_with_geometry(name):
        return None
    value = float(known.values[known.names.index(name)])
    parts = known.variances(known.along(name))
    variance = {source: parts.get(source, 0.0) for source in known.geometry.rows}
    if not value > 0.0 or sum(variance.values()) < _GEOMETRY * sum(parts.values()):
        return None
    alone = known.interval(name, NORMAL * math.sqrt(sum(variance.values())))
    code = "note/geometry" if variance.get("arm_size", 0.0) < sum(variance.values()) else "note/arm"
    ends = (*ci95, *alone)
    low, high, least, most = (
        f"{100.0 * (end / value - 1.0):+.0f}".replace("-", "−") for end in ends
    )
    return Message(code, low=low, high=high, least=least, most=most)


def judge_singular(name: str, directions: Sequence[Sequence[str]]) -> Message:
    """Why a parameter has no interval: the parameters it trades off with."""
    partners = sorted({p for d in directions if name in d for p in d if p != name})
    if not partners:
        return Message("note/silent")
    return Message("note/inseparable", names=", ".join(partners))


def _interval(value: float, half: float, unit: str) -> str:
    """Both ends, to two digits of the half-width; parts of a second in ms."""
    low = value - half
    high = value + half
    if unit == "s" and max(-low, high) < 1.0:
        low = 1e3 * low
        high = 1e3 * high
        half = 1e3 * half
        unit = "ms"
    digits = 1 - math.floor(math.log10(half)) if 0.0 < half < math.inf else 0
    ends = (f"{round(end, digits) + 0.0:.15g}".replace("-", "−") for end in (low, high))
    return " … ".join(ends) + (f" {unit}" if unit not in ("", "-") else "")


def percent(part: float) -> Message:
    """A part in percent to two digits, or as many as tell it from the threshold of a verdict."""
    if part >= 0.995:
        return Message("{percent:.0f} %", percent=100 * part)
    texts = [Message(f"{{percent:.{digits}g}} %", percent=100 * part) for digits in (2, 3, 4)]
    same = f"{100 * IDENTIFIED:.2g} %"
    return next((text for text in texts if text != same or part == IDENTIFIED), texts[0])


class Interval(StrEnum):
    """Which standard error an interval is made of."""

    THESIS = "thesis"
    ROBUST = "robust"
    MARGINAL = "marginal"


@filed("name", "meaning", "group")
@dataclass(frozen=True, slots=True, repr=False)
class ParameterEstimate:
    """One parameter of a fit."""

    #: `name`, `unit`, `meaning`, `group`: as in `surae.model.Parameter`.
    name: str
    unit: str
    meaning: str
    group: str
    value: float  #: Estimate, or the value it was fixed at.
    #: Standard error, equation (34), which takes the residual for white noise; None where there is
    #: none, and `note` says why.
    sem: float | None
    #: Standard error under noise that is correlated as the residual says.
    sem_robust: float | None
    ci95: tuple[float, float] | None  #: 95 % interval, from the standard error `interval` names.
    interval: Interval | None  #: What `ci95` and `verdict` rest on; None without one.
    #: `lower`, `upper`: bounds of the fit.
    lower: float
    upper: float
    free: bool  #: Whether it was estimated.
    at_bound: bool  #: Whether the estimate lies at a bound.
    verdict: Verdict  #: identified, weak, undetermined, at-bound or fixed.
    note: str  #: The verdict in a plain sentence: a `Message`, unless it was read from a file.
    #: 95 % interval of what would be found were this leg measured and fitted once more in the same
    #: way: as many trials of the same kind, electrodes and foot left as they are, with other noise,
    #: effort, drift and zero of the sensor. What is wrong alike in both is not in it, nor a change
    #: of the leg itself, unless recordings of a joint fit show how much trials differ. Two such
    #: values differ by up to √((a² + b²)/2), a and b the half-widths of their intervals.
    ci95_repeat: tuple[float, float] | None = None
    #: Whether that interval is within 10 % of the value, and the fit is usable.
    repeatable: bool = False
    #: Shares of the variance behind `ci95` by source, their sum 1; empty without an interval.
    budget: Mapping[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        known = in_a_line(self.name, self.value, self.ci95, self.unit)
        return f"{known}: {self.verdict}: {self.note}"

    @property
    def trusted_sem(self) -> float | None:
        """The standard error that `ci95` is made of; with arms and paths what it stands for."""
        if self.interval is not Interval.MARGINAL and self.ci95 and self.budget.get("arm_size"):
            return standard_error_of(self.ci95)
        return self.sem_robust if self.interval is Interval.ROBUST else self.sem
