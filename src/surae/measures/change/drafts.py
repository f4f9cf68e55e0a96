"""Differences of two sessions before they are judged."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from surae.base.normal import Student
from surae.base.words import Message
from surae.measures.change.doubts import obstacle
from surae.measures.compared import Quantities, Quantity
from surae.measures.difference import ChangeVerdict, Difference
from surae.measures.relaxed_change import RestChange, RestDifference
from surae.measures.reliability import SCATTER
from surae.measures.strength import StrengthDifference

#: `SCATTER` of the tibialis's tendon, hardly stretched and the worst of these; on a measured leg it
#: differed by chance in three of 21 pairs of trials that 1.2 was for.
_TENDON = ("dlt_tib", "tendon_stiffness_tib", "tendon_secant_tib", "tendon_strain_tib")
_OF_TENDON = 2.0
#: Degrees of freedom of what is known as well as the normal distribution.
MANY = 1e9


def with_rest(
    drafts: Mapping[str, tuple[Difference, float, str]], rest: RestChange
) -> dict[str, tuple[Difference, float, str]]:
    """With what rest tells in place of what fits say of the same, first."""
    made = {}
    for name, each in rest.differences.items():
        if each.difference is not None or name not in drafts:
            made[name] = (_of_rest(each), MANY, rest.doubt)
    return {**made, **{name: draft for name, draft in drafts.items() if name not in made}}


def _of_rest(d: RestDifference) -> Difference:
    """A difference that rest tells, not yet judged."""
    made = unjudged(d, "rest")
    return replace(made, from_deg=d.from_deg, to_deg=d.to_deg, ci95_device=d.ci95_device)


def unjudged(d: RestDifference | StrengthDifference, basis: str) -> Difference:
    """A difference that an estimate of both sessions brings, with its p-value and no verdict."""
    p = None
    if d.difference is not None and d.sd is not None:
        p = Student(d.difference, d.sd, MANY).p
    return Difference(
        d.name,
        d.unit,
        d.meaning,
        "measure",
        d.before,
        d.after,
        d.difference,
        d.ci95,
        p,
        None,
        ChangeVerdict.NOT_COMPARABLE,
        Message("change/not-comparable", why=d.missing) if d.missing else "",
        basis=basis,
    )


def difference_of(
    name: str, before: Quantities, after: Quantities, baselines: Sequence[Quantity], *, legs: bool
) -> tuple[Difference, float]:
    """A difference with its own p-value, not yet judged among the others; and its freedom."""
    a = before.by_name.get(name)
    b = after.by_name.get(name)
    known = a or b
    assert known is not None
    bare = Difference(
        name,
        known.unit,
        known.meaning,
        known.kind,
        a.value if a else None,
        b.value if b else None,
        None,
        None,
        None,
        None,
        ChangeVerdict.NOT_COMPARABLE,
        "",
        known.from_deg,
        known.to_deg,
    )
    why = obstacle(before, after, a, b)
    if why or a is None or b is None or a.value is None or b.value is None:
        return replace(bare, note=Message("change/not-comparable", why=why)), math.inf
    drawn = sum(s.total**2 if legs else s.session**2 + s.model**2 for s in (a, b))
    between, more = _between(a, baselines)
    scatter = _OF_TENDON if name.partition("@")[0] in _TENDON else SCATTER
    variance = scatter**2 * drawn + 2.0 * between
    if not variance > 0.0:
        note = Message("change/not-comparable", why=Message("measure/nothing"))
        return replace(bare, note=note), 1.0
    freedom = more * (variance / (2.0 * between)) ** 2 if between > 0.0 else MANY
    change = Student(b.value - a.value, math.sqrt(variance), freedom)
    draft = replace(bare, difference=change.value, ci95=change.ci95, p=change.p)
    return draft, freedom


def _between(before: Quantity, baselines: Sequence[Quantity]) -> tuple[float, int]:
    """Variance between sessions beyond their own uncertainty, from how many free baselines."""
    usable = [q for q in (before, *baselines) if q.value is not None and not q.missing]
    if len(usable) < 2:
        return 0.0, 0
    values = [q.value for q in usable if q.value is not None]
    mean = sum(values) / len(values)
    seen = sum((value - mean) ** 2 for value in values) / (len(values) - 1)
    within = sum(q.session**2 + q.model**2 for q in usable) / len(usable)
    return max(seen - SCATTER**2 * within, 0.0), len(usable) - 1
