"""Many legs together: groups, differences between them, change over time, and each leg among them.

Every measure and parameter is a random effect over legs (`surae.cohorts.pooled`), each leg as
uncertain as its interval says. A value at its bound says only that it lies between the bounds, and
enters so; a leg without a value, or of an inadequate fit, is left out and counted, with the reason.
Of a leg with several sessions the first counts for its group, and last minus first is its change.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from surae._version import __version__
from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import natural_order
from surae.base.formatting import estimate, significant
from surae.base.frozen import FrozenDict
from surae.base.normal import NORMAL, Student, standard_error_of
from surae.base.records import Saved, to_plain
from surae.base.tables import Tabular, TextTable
from surae.base.units import FloatArray
from surae.measures.change.asked import asked_of
from surae.measures.change.compare import compare_sessions
from surae.measures.claims import false_discovery, holm
from surae.measures.compared import Quantities, Quantity
from surae.measures.table import LEADING
from surae.recording.frames import library, records_frame

#: Level of a claim, and sentences at most, of what was asked.
LEVEL = 0.05
_MOST_SAID = 4
#: Legs from which a mean and a spread are estimated.
FEWEST = 3
#: Degrees by which ends of ranges may differ and still be one.
_ALIKE = 0.5


@filed("se", "tau2", k="n", ci95="ci95", between="sd_between")
@dataclass(frozen=True, slots=True)
class Effects:
    """Mean and spread of k legs."""

    k: int  #: Legs.
    #: `mean`, `se`: μ and its standard error after Hartung and Knapp.
    mean: float
    se: float
    tau2: float  #: Variance between legs.

    @property
    def between(self) -> float:
        """Standard deviation between legs."""
        return math.sqrt(self.tau2)

    @property
    def student(self) -> Student:
        """The mean as an estimate."""
        return Student(self.mean, self.se, self.k - 1)

    @property
    def ci95(self) -> tuple[float, float]:
        """95 % interval of the mean."""
        return self.student.ci95

    def shrunken(self, value: float, variance: float) -> tuple[float, float]:
        """A leg's value drawn to the mean, and its standard deviation."""
        whole = self.tau2 + variance
        share = self.tau2 / whole if whole > 0.0 else 1.0
        sd = math.sqrt(share * variance + ((1.0 - share) * self.se) ** 2)
        return self.mean + share * (value - self.mean), sd


def random_effects(values: FloatArray, variances: FloatArray) -> Effects:
    """Mean and spread of at least `FEWEST` finite values, shape (k,), with known variances.

    No value weighs more than an ordinary one, of the median variance: where errors are a part of
    the value, a small one seems surer than a large one, and would draw every mean down.
    """
    from scipy.optimize import minimize_scalar

    y = np.asarray(values, dtype=float)
    v = np.asarray(variances, dtype=float)
    scale = max(float(np.var(y)), float(np.median(v)), 1e-300)

    def against(tau2: float) -> float:
        w = 1.0 / (v + tau2)
        mean = float(w @ y / w.sum())
        return float(-np.log(w).sum() + np.log(w.sum()) + w @ (y - mean) ** 2)

    # τ² = 0 is a bound that the logarithm does not reach
    ends = (math.log(1e-8 * scale), math.log(1e3 * scale))
    best = minimize_scalar(lambda t: against(math.exp(t)), bounds=ends, method="bounded")
    at_zero = np.all(v > 0.0) and against(0.0) <= best.fun
    tau2 = 0.0 if at_zero else math.exp(float(best.x))
    w = 1.0 / (np.maximum(v, np.median(v)) + tau2)
    mean = float(w @ y / w.sum())
    se = math.sqrt(float(w @ (y - mean) ** 2) / ((len(y) - 1) * float(w.sum())))
    return Effects(len(y), mean, se, tau2)


#: By how much the ranges of legs may differ over which one measure is compared [deg].
_RANGES = 3.0
#: Legs of a group beside whose interval the errors that all fits share are no longer small: 94 %
#: of 300 differences were true with 20 legs a group, 57 % of 30 with 1,000 (benchmarks/cohort.py).
_MANY = 100


@dataclass(frozen=True, slots=True)
class CohortMember:
    """One row of a cohort."""

    #: `subject`, `side`, `group`, `session`: whose leg it is, and when it was measured; sessions
    #: are in the order of their names.
    subject: str
    side: str
    group: str
    session: str
    scales: Mapping[str, float]  #: Clinical scales of this row.
    quantities: Quantities | None  #: Of its fit; None where there is none.
    missing: str = ""  #: Why there is no fit.

    @property
    def leg(self) -> str:
        """Subject and side."""
        return " ".join(part for part in (self.subject, self.side) if part)

    @property
    def row(self) -> str:
        """Leg and session."""
        return " ".join(part for part in (self.leg, self.session) if part)


@filed("leg")
@dataclass(frozen=True, slots=True)
class Among:
    """One leg among its group: its own value, and the one drawn to the group with its interval."""

    leg: str
    group: str
    value: float
    sd: float
    shrunken: float
    ci95: tuple[float, float]


@filed(k="n")
@dataclass(frozen=True, slots=True)
class Contrast:
    """A difference, its 95 % interval, and the p-value of none; `k` legs are behind it."""

    difference: float
    ci95: tuple[float, float]
    p: float
    k: int


@dataclass(frozen=True, slots=True)
class Correlation:
    """Spearman's rank correlation of n legs with a scale, and the p-value of none."""

    rho: float
    p: float
    n: int


@filed("name")
@dataclass(frozen=True, slots=True)
class PooledQuantity:
    """One measure or parameter over the cohort."""

    #: `name`, `unit`, `meaning`, `kind`: as of `Quantity`.
    name: str
    unit: str
    meaning: str
    kind: str
    groups: FrozenDict[str, Effects]  #: Mean and spread of each group of at least three legs.
    legs: tuple[Among, ...]  #: Every leg that has a value.
    #: Of each pair of groups, the second minus the first; p is Holm's of what was asked
    #: beforehand, else of the false discovery rate over all else.
    differences: FrozenDict[str, Contrast]
    changes: FrozenDict[str, Contrast]  #: Of each group, last session minus first.
    #: Of legs with each clinical scale, by rank; p as of differences.
    scales: FrozenDict[str, Correlation]
    left_out: FrozenDict[str, int]  #: Legs without a value, by reason.
    at_bound: int  #: Legs whose value lies at a bound.
    asked: bool = False  #: Whether it was asked beforehand.
    #: Of one over the range that was moved: the least and the largest of the angles [deg] from
    #: which, and to which, a leg's is taken; None of others.
    begins: tuple[float, float] | None = None
    ends: tuple[float, float] | None = None

    @property
    def over(self) -> str:
        """What it is taken over, where that is the same in all legs; else empty."""
        if self.begins is None or self.ends is None or self.is_mixed:
            return ""
        return f"{self.begins[0]:.1f}° to {self.ends[0]:.1f}°"

    @property
    def is_mixed(self) -> bool:
        """Whether legs have it over ranges of their own, which differ."""
        sides = [each for each in (self.begins, self.ends) if each is not None]
        return any(high - low > _ALIKE for low, high in sides)


@dataclass(frozen=True, slots=True, repr=False)
class Cohort(Tabular, Saved):
    """A cohort: its members, and everything they have over all of them."""

    members: tuple[CohortMember, ...]
    pooled: FrozenDict[str, PooledQuantity]
    rounds: int = 0
    #: Least and largest angle [deg] that legs reached, where these differ; else None.
    reached: tuple[float, float] | None = None

    @property
    def note(self) -> str:
        """What is to be read with care: ranges that differ, and intervals of very many legs."""
        notes = []
        if self.reached is not None:
            low, high = self.reached
            notes.append(
                f"some legs were moved to {low:.1f}° and others to {high:.1f}°: what is of the end "
                f"of the range is compared at {low:.1f}°, which all reached"
            )
        if mixed := [p.name for p in self.pooled.values() if p.is_mixed]:
            notes.append(f"{', '.join(mixed)}: each leg over a range of its own, and these differ")
        most = max((e.k for p in self.pooled.values() for e in p.groups.values()), default=0)
        if most > _MANY:
            notes.append(
                f"with {most} legs in a group, intervals of means and differences are narrower "
                "than what all fits are wrong in alike: a small difference may be none"
            )
        return "; ".join(notes)

    def to_dataframe(self) -> Any:
        """Every group of every quantity as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row for each quantity and group, by both: number of legs, mean, standard error, ends
            of the 95 % interval, spread between legs.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        groups = {p.name: records_frame(p.groups, "group") for p in self.pooled.values()}
        return library("pandas", "a DataFrame").concat(groups, names=["of"])

    @property
    def sentence(self) -> str:
        """The answer: how groups differ, or legs changed, in what was asked beforehand, or most."""
        told = [
            (p, kind, key, c)
            for p in self.pooled.values()
            for kind, contrasts in (("groups", p.differences), ("sessions", p.changes))
            for key, c in contrasts.items()
        ]
        asked = [each for each in told if each[0].asked]
        if not told:
            return "There are no two groups, and no two sessions, of three legs each to compare."
        if asked:
            return " ".join(_said(*each) for each in asked[:_MOST_SAID])
        return _said(*min(told, key=lambda each: each[3].p))

    def as_table(self) -> TextTable:
        """Every group, then differences and changes that are shown, and who is left out."""
        rows = []
        notes = []
        every = self.pooled.values()
        for p in every:
            for group, effects in p.groups.items():
                text = estimate(effects.mean, effects.se, effects.ci95)
                spread = significant(effects.between, 2)
                left_out = "; ".join(f"{count}: {why}" for why, count in p.left_out.items())
                rows.append(
                    (
                        p.name,
                        group or "all",
                        str(effects.k),
                        text.value,
                        text.interval,
                        spread,
                        p.unit,
                        p.over,
                        str(p.at_bound or ""),
                        left_out,
                    )
                )
            for kind, contrasts in (("differs", p.differences), ("changed", p.changes)):
                how = "asked beforehand" if p.asked else "exploratory: confirm it"
                notes += [
                    f"{p.name} {kind}, {key or 'all'}: {c.difference:.3g} {p.unit} "
                    f"({c.ci95[0]:.3g} … {c.ci95[1]:.3g}), p = {c.p:.2g}, {how}"
                    for key, c in contrasts.items()
                    if c.p < 0.05
                ]
        notes += [self.note] if self.note else []
        notes += [f"{m.row}: no fit ({m.missing})" for m in self.members if m.missing]
        if self.rounds:
            notes.append(f"every leg was fitted again with its population, {self.rounds} rounds")
        heads = (
            "of",
            "group",
            "legs",
            "mean",
            "95 % interval",
            "spread",
            "unit",
            "over",
            "at a bound",
            "left out",
        )
        above = (self.sentence,)
        return TextTable(heads, tuple(rows), above=above, below=tuple(notes), numbers=heads[2:6])

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as C.json has it."""
        return {
            "surae": __version__,
            "note": self.note,
            "sentence": self.sentence,
            "legs": len({m.leg for m in self.members}),
            "missing": {m.row: m.missing for m in self.members if m.missing},
            "refit_rounds": self.rounds,
            "quantities": {
                p.name: {**to_plain(p), "legs": {leg.leg: to_plain(leg) for leg in p.legs}}
                for p in self.pooled.values()
            },
        }


def _said(p: PooledQuantity, kind: str, key: str, c: Contrast) -> str:
    """One contrast in a sentence: direction, amount, interval, and what would have been shown."""
    unit = "" if p.unit == "-" else f" {p.unit}"
    ends = f"95 % {c.ci95[0]:.2g} to {c.ci95[1]:.2g}{unit}".replace("-", "−")
    size = f"{abs(c.difference):.2g}{unit}"
    first, _, second = key.partition(" → ")
    how = "asked beforehand" if p.asked else "exploratory: confirm it"
    if c.p >= LEVEL:
        of = (
            f"between {first} and {second}"
            if kind == "groups"
            else f"over sessions ({key or 'all'})"
        )
        half = 0.5 * (c.ci95[1] - c.ci95[0])
        return (
            f"{p.name}: no difference is shown {of}; it is {c.difference:.2g}{unit} ({ends}), and "
            f"one of {1.4 * half:.2g}{unit} would mostly have been shown ({c.k} legs)."
        ).replace("is -", "is −")
    more = "more" if c.difference > 0.0 else "less"
    where = (
        f"in {second} than in {first}"
        if kind == "groups"
        else f"in later sessions ({key or 'all'})"
    )
    return f"{p.name} is {more} {where}, by {size} ({ends}; p = {c.p:.2g}, {c.k} legs, {how})."


def ends_of(members: Sequence[CohortMember]) -> tuple[float, float] | None:
    """Least and largest angle [deg] that the legs reached; None where these do not differ."""
    reached = [
        q.to_deg
        for m in members
        if m.quantities is not None
        and (q := m.quantities.by_name.get(LEADING[0])) is not None
        and q.to_deg is not None
    ]
    if not reached or max(reached) - min(reached) <= _ALIKE:
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


def sessions_of(members: Sequence[CohortMember]) -> dict[str, list[CohortMember]]:
    """The sessions of each leg, in order."""
    sessions: dict[str, list[CohortMember]] = {}
    for member in sorted(members, key=lambda m: natural_order(m.session)):
        before = sessions.setdefault(member.leg, [])
        if any(m.session == member.session for m in before):
            raise InputError(f"cohort: {member.leg} is there twice in session {member.session!r}")
        if before and before[0].group != member.group:
            raise InputError(f"cohort: {member.leg} is in two groups")
        before.append(member)
    return sessions


def borrowed(cohort: Cohort, refitted: Sequence[CohortMember], rounds: int) -> Cohort:
    """The cohort with each leg's value of a fit that knew its population.

    Means, spreads and differences stay those of fits that did not: what a leg borrows from the
    others does not enter them.
    """
    own = {leg: each[0].quantities for leg, each in sessions_of(refitted).items()}
    pooled = {}
    for name, p in cohort.pooled.items():
        legs = []
        for leg in p.legs:
            quantities = own.get(leg.leg)
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
    enough = {group: zip(*own, strict=True) for group, own in pairs.items() if len(own) >= FEWEST}
    return {group: random_effects(*map(np.array, both)) for group, both in enough.items()}


def _among(member: CohortMember, value: float, variance: float, effects: Effects | None) -> Among:
    sd = math.sqrt(variance)
    drawn, own = (value, sd) if effects is None else effects.shrunken(value, variance)
    return Among(
        member.leg, member.group, value, sd, drawn, (drawn - NORMAL * own, drawn + NORMAL * own)
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
            own = dict(getattr(done[name], kind))
            own[key] = replace(own[key], p=p)
            renewed: dict[str, Any] = {kind: FrozenDict(own)}
            done[name] = replace(done[name], **renewed)
    return done
