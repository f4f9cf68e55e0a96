"""Compare two sessions of a leg, or its two legs."""

from collections.abc import Mapping, Sequence

from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.measures.change.asked import asked_of
from surae.measures.change.doubts import doubt_of
from surae.measures.change.drafts import MANY, difference_of, unjudged, with_rest
from surae.measures.change.result import Change
from surae.measures.change.verdicts import all_judged, multiplicity_of
from surae.measures.compared import Quantities
from surae.measures.difference import Difference, sentence_of
from surae.measures.relaxed_change import RestChange
from surae.measures.strength import StrengthDifference


def compare_sessions(
    before: Quantities,
    after: Quantities,
    baselines: Sequence[Quantities] = (),
    *,
    legs: bool = False,
    rest: RestChange | None = None,
    strength: Mapping[str, StrengthDifference] = FrozenDict(),
    question: Sequence[str] = (),
) -> Change:
    """Compare two sessions of a leg, or its two legs, whose own errors do not cancel.

    How far `baselines`, sessions before anything changed, scatter beyond their own uncertainty is
    taken for the spread between sessions. What `rest` tells, and maximal efforts of `strength`, go
    before what fits tell; `question` names what was asked beforehand, with or without the point
    after its ``@``, or ``"strength"``.
    """
    if legs and baselines:
        raise InputError("baselines are sessions of one leg; leave them out to compare two legs")
    drafts: dict[str, tuple[Difference, float, str]] = {}
    for name in dict.fromkeys((*before.by_name, *after.by_name)):
        at_baselines = [b.by_name[name] for b in baselines if name in b.by_name]
        draft, freedom = difference_of(name, before, after, at_baselines, legs=legs)
        doubt = None if draft.p is None else doubt_of(name, before, after, legs=legs)
        drafts[name] = draft, freedom, doubt or ""
    if rest is not None:
        drafts = with_rest(drafts, rest)
    efforts = {name: (unjudged(each, "rest"), MANY, "") for name, each in strength.items()}
    drafts = {**drafts, **efforts}
    judged, counts = all_judged(drafts, asked_of(question, drafts), legs=legs)
    measures, parameters = (
        FrozenDict((n, d) for n, d in judged.items() if d.kind == kind)
        for kind in ("measure", "parameter")
    )
    repeated = len(baselines) + 1 if baselines else 0
    withheld = not any(counts) and any(d.difference is not None for d in judged.values())
    return Change(
        before,
        after,
        measures,
        parameters,
        multiplicity_of(counts, [why for *_, why in drafts.values()], withheld=withheld),
        sentence_of(tuple(judged.values()), counts[1], legs=legs),
        repeated,
        legs,
        withheld,
    )
