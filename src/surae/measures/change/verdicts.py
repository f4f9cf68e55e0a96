"""Verdicts of differences among all that were looked at."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from surae.base.words import Message
from surae.measures.claims import false_discovery, holm
from surae.measures.difference import ChangeVerdict, Difference, with_part

#: Level of all claims together, and the power with which the smallest change would be shown.
LEVEL = 0.05
POWER = 0.80


def all_judged(
    drafts: Mapping[str, tuple[Difference, float, str]], asked: frozenset[str], *, legs: bool
) -> tuple[dict[str, Difference], tuple[int, int]]:
    """All differences judged, and how many were: of what was asked, and of all else."""
    judged = {name: replace(draft, asked=name in asked) for name, (draft, _, _) in drafts.items()}
    tested: tuple[dict[str, float], dict[str, float]] = {}, {}
    for name, (draft, _, doubt) in drafts.items():
        if draft.p is None:
            continue
        if doubt:
            note = Message("change/no-verdict", why=doubt)
            judged[name] = replace(judged[name], p=None, note=note)
        else:
            tested[name not in asked][name] = draft.p
    for p, adjusted in zip(tested, (holm(tested[0]), false_discovery(tested[1])), strict=True):
        for name, each in adjusted.items():
            freedom = drafts[name][1]
            judged[name] = _judged(judged[name], freedom, each, LEVEL / len(p), legs=legs)
    return judged, (len(tested[0]), len(tested[1]))


def multiplicity_of(counts: tuple[int, int], doubts: Sequence[str], *, withheld: bool) -> Message:
    """How many were looked at, and what that does to the claims."""
    if withheld:
        return Message("change/none-judged", why=next((why for why in doubts if why), ""))
    if counts[0]:
        return Message("change/asked", asked=counts[0], n=counts[1])
    return Message("change/exploratory", n=counts[1])


def _judged(draft: Difference, freedom: float, p: float, level: float, *, legs: bool) -> Difference:
    """A difference among all that were looked at, with its part of the level."""
    from scipy.special import stdtrit

    assert draft.ci95 is not None
    assert draft.difference is not None
    sd = (draft.ci95[1] - draft.ci95[0]) / (2.0 * float(stdtrit(freedom, 0.975)))
    smallest = float(stdtrit(freedom, POWER) - stdtrit(freedom, level / 2.0)) * sd
    if p < LEVEL:
        more = "more" if draft.difference > 0.0 else "less"
        note = Message(f"change/{more}-than-{'first' if legs else 'before'}")
        note = with_part(note, draft.difference, draft)
        return replace(draft, p=p, smallest=smallest, verdict=ChangeVerdict.CHANGED, note=note)
    least = Message("{size:.2g} {unit}", size=smallest, unit=draft.unit.strip("-"))
    note = Message(
        f"change/no-{'difference' if legs else 'change'}",
        smallest=with_part(least, smallest, draft),
    )
    return replace(draft, p=p, smallest=smallest, verdict=ChangeVerdict.NONE_SHOWN, note=note)
