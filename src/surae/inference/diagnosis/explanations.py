"""What a recording might be instead, compared by what a quick fit makes of each possibility."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Literal

import numpy as np

from surae.base.words import Message
from surae.inference.diagnosis.quick import QuickFit, percent, quick_fit
from surae.quality.trial import Signals, sampled
from surae.recording import MUSCLE_NAMES, Recording
from surae.recording.corrections import Corrections

#: What is claimed must explain this much, and leave so many times less than what it is held
#: against.
EXPLAINS = 0.8
CLEARLY = 2.5
#: Evidence of what is claimed as an error over the recording as it is, in 2 ln: odds of 150 to 1
#: ("very strong", Kass and Raftery 1995), by as many samples as the residual is worth.
EVIDENCE = 10.0
#: So many muscles that do nothing while their EMG shows effort make an explanation unlikely: of 24
#: legs of other shapes, right ones had one at most, turned ones taken for swapped ones two.
IDLE = 2


@dataclass(frozen=True, slots=True)
class Explanation:
    """One way to read a recording: what would then be wrong with it, and what a fit says."""

    words: str  #: Such as "the angle is turned"; empty for the recording as it is.
    right: Corrections = field(default_factory=Corrections)  #: What puts it right.
    departures: int = 1  #: How many things would be wrong.
    fit: QuickFit | None = None  #: None where it was not tried, or no model can be fitted to it.

    @property
    def r2(self) -> float:
        """What the fit explains; below everything where there is none."""
        return -float("inf") if self.fit is None else self.fit.r2


def evidence(better: Explanation, worse: Explanation) -> float:
    """Twice the logarithm of the odds by which one explanation is better than another.

    Both leave Gaussian noise of unknown strength; the samples are those that the residual of the
    better one is worth, as many as are independent.
    """
    if better.fit is None or worse.fit is None:
        return 0.0 if better.fit is None else float("inf")
    return better.fit.samples * float(np.log(worse.fit.unexplained / better.fit.unexplained))


def tried(
    recording: Recording, signals: Signals, how: Explanation, *, zero: bool = True
) -> Explanation:
    """An explanation with its fit, in which the torque's `zero` is free or not."""
    channels = how.right(recording).channels
    angle, torque = (
        sampled(channels[role], signals.time, signals.rate_hz) for role in ("angle", "torque")
    )
    fast = dict(signals.fast)
    for a, b in how.right.swap:
        exchanged = {a: fast.get(b), b: fast.get(a)}
        fast |= {muscle: each for muscle, each in exchanged.items() if each is not None}
    instead = replace(signals, angle=angle, torque=torque, fast=fast)
    fit = quick_fit(recording, instead, zero=zero)
    return replace(how, fit=fit)


def possible(explanations: Iterable[Explanation]) -> list[Explanation]:
    """Those that no other is clearly better than, the best first; none where none explains much."""
    ranked = sorted(explanations, key=lambda each: -each.r2)
    if not ranked or ranked[0].fit is None or ranked[0].r2 < EXPLAINS:
        return []
    least = ranked[0].fit.unexplained
    good = [e for e in ranked if e.fit is not None and e.fit.unexplained < CLEARLY * least]
    # Two muscles exchanged look like all signs turned, but for the muscles that are then idle.
    # What is not claimed needs no such reason.
    busy = [e for e in good if e.fit is not None and (e.fit.idle < IDLE or not e.departures)]
    return busy or good


def joined(*words: str, by: Literal["and", "or"] = "and") -> str:
    """What of several is not empty, as one text."""
    kept = [each for each in words if each]
    return reduce(lambda a, b: Message(f"read/{by}", one=a, other=b), kept) if kept else ""


def compared(best: Explanation, as_it_is: Explanation, others: Sequence[Explanation]) -> str:
    """The numbers that an explanation is named by, the next best beside it."""
    if best.fit is None:
        return ""
    text = Message("read/rises", before=percent(as_it_is.r2), after=percent(best.r2))
    if as_it_is.fit is None or as_it_is.r2 > best.r2:
        text = Message("read/then", after=percent(best.r2))
    next_best = max(others, key=lambda each: each.r2, default=None)
    if next_best is not None and next_best.fit is not None:
        reached = percent(next_best.r2)
        text = Message("read/next", numbers=text, other=next_best.words, reached=reached)
    return text


def turned(angle: float, torque: float) -> Explanation:
    """Signs that may be the other way round."""
    roles = [name for name, sign in (("angle", angle), ("torque", torque)) if sign < 0.0]
    words = Message(f"read/turned/{'-'.join(roles)}") if roles else ""
    return Explanation(words, Corrections(sign=dict.fromkeys(roles, -1.0)), len(roles))


#: Signs other than those of a recording.
SIGNS = (turned(-1.0, 1.0), turned(1.0, -1.0), turned(-1.0, -1.0))


def swapped(first: str, second: str) -> Explanation:
    """Two muscles whose electrodes may have been exchanged."""
    names = (Message(MUSCLE_NAMES[muscle]) for muscle in (first, second))
    words = Message("read/swapped", **dict(zip(("first", "second"), names, strict=True)))
    return Explanation(words, Corrections(swap=((first, second),)))
