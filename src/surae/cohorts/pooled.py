"""Many legs together: groups, differences between them, change over time, and each leg among them.

Every measure and parameter is a random effect over legs (`surae.cohorts.effects`), each leg as
uncertain as its interval says. A value at its bound says only that it lies between the bounds, and
enters so; a leg without a value, or of an inadequate fit, is left out and counted, with the reason.
Of a leg with several sessions the first counts for its group, and last minus first is its change.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.base.normal import NORMAL, Student, standard_error_of
from surae.cohorts.effects import FEWEST, Effects, random_effects
from surae.cohorts.member import CohortMember, sessions_of
from surae.cohorts.quantity import ALIKE, Among, Contrast, Correlation, PooledQuantity
from surae.cohorts.result import Cohort
from surae.measures.change.asked import asked_of
from surae.measures.change.compare import compare_sessions
from surae.measures.claims import false_discovery, holm
from surae.measures.compared import Quantity
from surae.measures.table import LEADING

#: By how much the ranges of legs may differ over which one measure is compared [deg].
_RANGES = 3.0


def ends_of(members: Sequence[CohortMember]) -> tuple[float, float] | None:
    """Least and largest angle [deg] that the legs reached; None where these do not differ."""
    reached = [
        q.to_deg
        for m in members
        if m.quantities is not None
        and (q := m.quantities.by_name.get(LEADING[0])) is not None
        and q.to_deg is not None
    ]
    if not reached or max(reached) - min(reached) <= ALIKE:
        return None
    return min(reached), max(reached)


def _extent(angles: Iterable[float | None]) -> tuple[float, float] | None:
    """The least and the largest of the angles that there are."""
    known = [angle for angle in angles if angle is not None]
    return (min(known), max(known)) if known else None


def pool(members: Sequence[CohortMember], question: Sequence[str] = ()) -> Cohort:
    """All groups, differences and changes of a cohort; what was asked beforehand by name."""
    sessions = sessions_of(members)
    first = [each[0] for each in sessions.values()]
    known = [m.quantities for m in members if m.quantities is not None]
    if not known:
        raise InputError("cohort: no row has a fit")
    names = dict.fromkeys(name for q in known for name in q.by_name)
    changes = _changes(sessions)
    pooled = {name: _pooled(name, first, changes.get(name, {})) for name in names}
    asked = asked_of(question, pooled)
    return Cohort(tuple(members), FrozenDict(_judged(pooled, asked)))


def borrowed(cohort: Cohort, refitted: Sequence[CohortMember], rounds: int) -> Cohort:
    """The cohort with each leg's value of a fit that knew its population.

    Means, spreads and differences stay those of fits that did not: what a leg borrows from the
    others does not enter them.
    """
    by_leg = {leg: each[0].quantities for leg, each in sessions_of(refitted).items()}
    pooled = {}
    for name, p in cohort.pooled.items():
        legs = []
        for leg in p.legs:
            quantities = by_leg.get(leg.leg)
            q = None if quantities is None else quantities.by_name.get(name)
            if q is not None and q.value is not None and math.isfinite(q.total):
                ends = (q.value - NORMAL * q.total, q.value + NORMAL * q.total)
                legs.append(replace(leg, shrunken=q.value, ci95=ends))
            else:
                legs.append(leg)
        pooled[name] = replace(p, legs=tuple(legs))
    return replace(cohort, pooled=FrozenDict(pooled), rounds=rounds)


def _common_begin(name: str, first: Sequence[CohortMember]) -> float:
    """Where the range begins over which most legs have a measure [deg]; NaN without ranges."""
    begins = [
        q.from_deg
        for member in first
        if member.quantities is not None
        and (q := member.quantities.by_name.get(name)) is not None
        and q.from_deg is not None
    ]
    return float(np.median(begins)) if begins else math.nan


def _pooled(
    name: str, first: Sequence[CohortMember], changes: Mapping[str, list[tuple[float, float]]]
) -> PooledQuantity:
    left_out: Counter[str] = Counter()
    usable: list[tuple[CohortMember, Quantity, float, float]] = []
    at_bound = 0
    known = None
    begins = _common_begin(name, first)
    for member in first:
        q = None if member.quantities is None else member.quantities.by_name.get(name)
        known = q or known
        if q is not None and q.from_deg is not None and abs(q.from_deg - begins) > _RANGES:
            left_out["the range that was moved is not that of the other legs"] += 1
            continue
        if q is None or q.value is None:
            left_out[member.missing or "it was not estimated"] += 1
        elif q.at_bound and q.bounds is not None:
            low, high = q.bounds  # anywhere between them, for all that is known
            at_bound += 1
            usable.append((member, q, 0.5 * (low + high), (high - low) ** 2 / 12.0))
        elif q.missing and not q.is_comparable_between_legs:
            left_out[q.missing] += 1
        elif math.isfinite(q.total) and q.total > 0.0:
            usable.append((member, q, q.value, q.total**2))
        else:
            left_out[q.missing or "it has no interval"] += 1
    assert known is not None
    groups = _effects(
        {
            group: [(y, v) for m, _, y, v in usable if m.group == group]
            for group in sorted({m.group for m in first})
        }
    )
    changed = _effects(changes)
    legs = tuple(_among(m, y, v, groups.get(m.group)) for m, q, y, v in usable if not q.at_bound)
    return PooledQuantity(
        known.name,
        known.unit,
        known.meaning,
        known.kind,
        FrozenDict(groups),
        legs,
        FrozenDict(
            {f"{a} → {b}": _contrast(groups[a], groups[b]) for a, b in combinations(groups, 2)}
        ),
        FrozenDict({group: _shown(e.student, e.k) for group, e in changed.items()}),
        _scales([(m, y) for m, q, y, _ in usable if not q.at_bound]),
        FrozenDict(left_out),
        at_bound,
        begins=_extent(q.from_deg for _, q, _, _ in usable),
        ends=_extent(q.to_deg for _, q, _, _ in usable),
    )


def _effects(pairs: Mapping[str, Sequence[tuple[float, float]]]) -> dict[str, Effects]:
    """Of each group that has legs enough, by values and variances of its legs."""
    enough = {
        group: zip(*members, strict=True)
        for group, members in pairs.items()
        if len(members) >= FEWEST
    }
    return {group: random_effects(*map(np.array, both)) for group, both in enough.items()}


def _among(member: CohortMember, value: float, variance: float, effects: Effects | None) -> Among:
    sd = math.sqrt(variance)
    drawn, drawn_sd = (value, sd) if effects is None else effects.shrunken(value, variance)
    return Among(
        member.leg,
        member.group,
        value,
        sd,
        drawn,
        (drawn - NORMAL * drawn_sd, drawn + NORMAL * drawn_sd),
    )


def _contrast(a: Effects, b: Effects) -> Contrast:
    """Second minus first, with the degrees of freedom of Welch and Satterthwaite."""
    se2 = a.se**2 + b.se**2
    df = se2**2 / max(a.se**4 / (a.k - 1) + b.se**4 / (b.k - 1), 1e-300)
    return _shown(Student(b.mean - a.mean, math.sqrt(se2), df), a.k + b.k)


def _shown(of: Student, legs: int) -> Contrast:
    return Contrast(of.value, of.ci95, of.p, legs)


def _changes(
    sessions: Mapping[str, Sequence[CohortMember]],
) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """Differences of last and first session and their variances, by quantity and group."""
    by_quantity: dict[str, dict[str, list[tuple[float, float]]]] = {}
    for each in sessions.values():
        before = each[0].quantities
        after = each[-1].quantities
        if len(each) < 2 or before is None or after is None:
            continue
        compared = compare_sessions(before, after)
        for d in (*compared.measures.values(), *compared.parameters.values()):
            if d.difference is not None and d.ci95 is not None:
                sd = standard_error_of(d.ci95)
                groups = by_quantity.setdefault(d.name, {})
                groups.setdefault(each[0].group, []).append((d.difference, sd**2))
    return by_quantity


def _scales(usable: Sequence[tuple[CohortMember, float]]) -> FrozenDict[str, Correlation]:
    from scipy.stats import spearmanr

    correlations = {}
    for scale in sorted({s for m, _ in usable for s in m.scales}):
        pairs = [(m.scales[scale], y) for m, y in usable if scale in m.scales]
        values = np.array([y for _, y in pairs])
        marks = np.array([s for s, _ in pairs])
        if len(pairs) >= 4 and np.ptp(values) > 0 and np.ptp(marks) > 0:
            rho, p = spearmanr(marks, values)
            correlations[scale] = Correlation(float(rho), float(p), len(pairs))
    return FrozenDict(correlations)


def _judged(
    pooled: Mapping[str, PooledQuantity], asked: frozenset[str]
) -> dict[str, PooledQuantity]:
    """Differences, changes and correlations: Holm's p of what was asked, else of discoveries."""
    done = {name: replace(p, asked=name in asked) for name, p in pooled.items()}
    for kind in ("differences", "changes", "scales"):
        every = {
            (name, key): c.p for name, p in pooled.items() for key, c in getattr(p, kind).items()
        }
        adjusted = {
            **holm({place: p for place, p in every.items() if place[0] in asked}),
            **false_discovery({place: p for place, p in every.items() if place[0] not in asked}),
        }
        for (name, key), p in adjusted.items():
            comparisons = dict(getattr(done[name], kind))
            comparisons[key] = replace(comparisons[key], p=p)
            renewed: dict[str, Any] = {kind: FrozenDict(comparisons)}
            done[name] = replace(done[name], **renewed)
    return done
