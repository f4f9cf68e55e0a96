"""What both channels allow to be claimed: a position in coarse steps, a torque at its limit."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from surae.base.words import N_, Message
from surae.nerve.coarse import coarser
from surae.nerve.fitting import Fitted, Problem
from surae.nerve.identify import Cascade
from surae.nerve.judged import INTRINSIC, REFLEX, Number, share
from surae.nerve.limits import limits_of, repeats_its_largest, restored
from surae.nerve.measures import MEASURES
from surae.nerve.perturbed_records import ReflexPath
from surae.nerve.reflex_claim import Claimed
from surae.nerve.samples import Samples

#: What the same steps once more may change one number by, as a part of it, before none is told; and
#: how many times that counts in the interval else.
MOST = 0.1
TWICE = 2.0
#: What steps of unknown size may do to every number, as a part: those of 0.2° in movements of 2°
#: between two positions made tissue's numbers wrong by 2 to 17 % (five legs).
UNKNOWN = 0.15
TOO_COARSE = N_(
    "the position’s steps are too coarse: the same steps once more would change numbers by up to "
    "{part:.0f} %"
)
#: What a limited torque still tells, by what it may be wrong by at least, as a part; and why no
#: more than that.
SLOW = "intrinsic_stiffness"
WRONG = 0.05
CUT_OFF = N_(
    "the torque was at its channel’s limit: its largest, which fast movement makes, is gone; raise "
    "the channel’s range, and do not filter what was limited"
)


def in_channels(
    claims: Claimed, samples: Samples, problem: Problem, cascade: Cascade, highest: float
) -> tuple[Claimed, bool]:
    """Claims as far as both channels allow them, and whether the torque was limited."""
    if not claims.numbers:
        return claims, False
    fit_of = (problem, cascade.fitted)
    if np.isnan(samples.step):
        claims = _allowing(claims, dict.fromkeys(claims.numbers, UNKNOWN))
    elif samples.step:
        fits = coarser(samples, highest, *fit_of)
        parts = [_apart(claims.numbers, fit_of, each) for each in fits]
        most = {name: max(part[name] for part in parts) for name in claims.numbers}
        claims = _allowing(claims, {name: TWICE * part for name, part in most.items()})
        if (worst := max(most.values())) > MOST:  # they are estimated together
            why = Message(TOO_COARSE, part=100.0 * worst)
            claims = replace(without(claims, MEASURES, why), reflex=_cannot_tell(why))
    ends = limits_of(*fit_of)
    limited = bool(ends) or repeats_its_largest(samples.torque)
    if limited:
        apart = _apart(claims.numbers, fit_of, restored(*fit_of, ends))
        claims = _allowing(claims, {name: max(part, WRONG) for name, part in apart.items()})
        claims = without(claims, [name for name in MEASURES if name != SLOW], Message(CUT_OFF))
    return claims, limited


def _allowing(claims: Claimed, parts: Mapping[str, float]) -> Claimed:
    """Claims with so great errors, as parts of the numbers, in their intervals."""
    numbers = {name: number.allowing(parts[name]) for name, number in claims.numbers.items()}
    return replace(claims, numbers=numbers)


def without(claims: Claimed, names: Iterable[str], why: Message) -> Claimed:
    """Claims without some numbers, and so without a reflex that is not seen."""
    refused = dict.fromkeys(names, why)
    numbers = {name: each for name, each in claims.numbers.items() if name not in refused}
    reflex = claims.reflex
    if reflex.verdict == "none seen":
        reflex = _cannot_tell(why)
    return replace(
        claims, reflex=reflex, numbers=numbers, hidden={}, refused={**claims.refused, **refused}
    )


def _cannot_tell(why: Message) -> ReflexPath:
    return ReflexPath("cannot tell", None, why)


def _apart(
    numbers: Mapping[str, Number], fit_of: tuple[Problem, Fitted], other: tuple[Problem, Fitted]
) -> dict[str, float]:
    """By what part of each number another fit, of channels that were changed, differs."""
    tables = INTRINSIC | REFLEX

    def value(name: str, problem: Problem, fitted: Fitted) -> float:
        if name == "reflex_share":
            return share(problem.pieces, fitted)[0]
        return tables[name](fitted)[0]

    apart = {}
    for name in numbers:
        first, second = (value(name, *each) for each in (fit_of, other))
        apart[name] = abs(second - first) / max(abs(first), 1e-12)
    return apart
