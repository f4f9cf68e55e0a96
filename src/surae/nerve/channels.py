"""What both channels allow to be claimed: a position in coarse steps, a torque at its limit."""

from collections.abc import Mapping
from dataclasses import replace

from surae.base.words import N_, Message
from surae.nerve.coarse import coarser
from surae.nerve.fitting import Fitted, Problem
from surae.nerve.identify import Cascade
from surae.nerve.judged import INTRINSIC, REFLEX, Number, share
from surae.nerve.limits import limits_of, repeats_its_largest, restored
from surae.nerve.measures import MEASURES
from surae.nerve.reflex_claim import Claimed
from surae.nerve.samples import Samples

#: What the same steps once more may change one number by, as a part of it, before none is told; and
#: how many times that counts in the interval else.
MOST = 0.1
TWICE = 2.0
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
    claims: Claimed, samples: Samples, problem: Problem, found: Cascade, highest: float
) -> tuple[Claimed, bool]:
    """Claims as far as both channels allow them, and whether the torque was limited."""
    if not claims.numbers:
        return claims, False
    told = (problem, found.fitted)
    if samples.step:
        fits = coarser(samples, highest, *told)
        parts = [_apart(claims.numbers, told, each) for each in fits]
        most = {name: max(part[name] for part in parts) for name in claims.numbers}
        worst = max(most.values())
        refused = {}
        if worst > MOST:  # they are estimated together: where one goes wrong, others do
            refused = dict.fromkeys(MEASURES, Message(TOO_COARSE, part=100.0 * worst))
        claims = _allowing(claims, {n: TWICE * p for n, p in most.items()}, refused)
    ends = limits_of(*told)
    limited = bool(ends) or repeats_its_largest(samples.torque)
    if limited:
        apart = _apart(claims.numbers, told, restored(*told, ends))
        wrong = {name: max(part, WRONG) for name, part in apart.items()}
        lost = {name: Message(CUT_OFF) for name in MEASURES if name != SLOW}
        claims = _allowing(claims, wrong, lost)
    return claims, limited


def _allowing(
    claims: Claimed, parts: Mapping[str, float], refused: Mapping[str, Message]
) -> Claimed:
    """Claims with so great errors, as parts, in their intervals, and without what is refused."""
    numbers = {
        name: number.allowing(parts[name])
        for name, number in claims.numbers.items()
        if name not in refused
    }
    return replace(claims, numbers=numbers, refused={**claims.refused, **refused})


def _apart(
    numbers: Mapping[str, Number], told: tuple[Problem, Fitted], other: tuple[Problem, Fitted]
) -> dict[str, float]:
    """By what part of each number another fit, of channels that were changed, differs."""
    tables = INTRINSIC | REFLEX

    def value(name: str, problem: Problem, fitted: Fitted) -> float:
        if name == "reflex_share":
            return share(problem.pieces, fitted)[0]
        return tables[name](fitted)[0]

    apart = {}
    for name in numbers:
        first, second = (value(name, *each) for each in (told, other))
        apart[name] = abs(second - first) / max(abs(first), 1e-12)
    return apart
