"""Whether a leg has changed between two sessions, or differs from the other leg.

What both sessions are wrong in alike cancels in their difference: the leg's own delay, its tendon's
toe, the curve from EMG to force. What is drawn anew does not: noise, the torque's zero, electrodes
and foot mounted anew; nor does what models leave unsure, as noise decides among them. Virtual legs
differ between sessions by a little more than that (`SCATTER`). Between two legs nothing cancels:
each has its own delay, tendon and skin.

Many differences are looked at, and one of twenty would be beyond its 95 % interval by chance alone.
The p-values are Holm's (1979), with weights: three questions that are fixed beforehand, torque and
stiffness of the relaxed ankle and how steeply the calf stiffens, have four fifths of the 5 % to
themselves, all else the rest. At most 5 % of comparisons without any change claim one. Intervals
aren't corrected for multiple comparisons.

A spread between sessions that repeated baselines show is known as badly as they are few: what it
adds has Student's t, with the degrees of freedom of Welch and Satterthwaite.

References
----------
S. Holm (1979). A simple sequentially rejective multiple test procedure. Scandinavian Journal of
Statistics 6(2):65-70.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, TypeVar

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import NO_NUMBER, of_interval, significant
from surae.base.frozen import FrozenDict
from surae.base.normal import Student
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.base.words import Message
from surae.inference.judging.parameter import percent
from surae.measures.compared import Quantities, Quantity
from surae.measures.table import LEADING

#: By how much sessions of one leg differ beyond their covariance: 1.05 on average over all measures
#: and parameters of 40 pairs of virtual legs, 1.6 of the worst.
SCATTER = 1.2
#: The same of the tibialis's tendon, hardly stretched and the worst of these; on a measured leg it
#: differed by chance in three of 21 pairs of trials that 1.2 was for.
_TENDON = ("dlt_tib", "tendon_stiffness_tib", "tendon_secant_tib", "tendon_strain_tib")
_OF_TENDON = 2.0
#: What most comparisons are made for, and the part of the level that these share; stiffness and
#: torque are those at the end of the range that both sessions moved through.
FIXED = (*LEADING, "passive_exponent_tri")
_SHARE = 0.8
#: By how much two ranges may differ in which one stiffness is compared [deg].
_RANGES = 1.0
#: Level of all claims together, and the power with which the smallest change would be shown.
LEVEL = 0.05
POWER = 0.80
#: Columns of the table that hold numbers.
_NUMBERS = ("before", "after", "difference", "95 % interval", "would show")
_Key = TypeVar("_Key", str, tuple[str, str])
#: Degrees of freedom of what is known as well as the normal distribution.
_MANY = 1e9


class ChangeVerdict(StrEnum):
    """Judgement of one difference."""

    CHANGED = "changed"
    NONE_SHOWN = "no change shown"
    NOT_COMPARABLE = "not comparable"


@filed("name", "kind", sparse=("from_deg", "to_deg"))
@dataclass(frozen=True, slots=True)
class Difference:
    """One measure or parameter of two fits."""

    #: `name`, `unit`, `meaning`, `kind`: as of `Quantity`.
    name: str
    unit: str
    meaning: str
    kind: str
    #: `before`, `after`: values; None where there is none.
    before: float | None
    after: float | None
    difference: float | None  #: After minus before; None where it cannot be compared.
    ci95: tuple[float, float] | None  #: Its 95 % interval.
    p: float | None  #: Holm's p-value of no difference.
    #: Smallest change that these recordings would show in four of five cases.
    smallest: float | None
    verdict: ChangeVerdict  #: ``changed``, ``no change shown`` or ``not comparable``.
    note: str  #: The verdict in a plain sentence: a `Message`, unless it was read from a file.
    #: `from_deg`, `to_deg`: as of `Measure`.
    from_deg: float | None = None
    to_deg: float | None = None


@filed("before", "after", "legs", "is_withheld")
@dataclass(frozen=True, slots=True, repr=False)
class Change(Tabular, Saved):
    """Two sessions compared."""

    #: `before`, `after`: what each fit brings.
    before: Quantities
    after: Quantities
    #: `measures`, `parameters`: by name.
    measures: FrozenDict[str, Difference]
    parameters: FrozenDict[str, Difference]
    multiplicity: str  #: How many were looked at, and what that does to the claims.
    #: Repeated baselines from which the spread between sessions was estimated; 0 without.
    baselines: int = 0
    legs: bool = False  #: Whether they are two legs, and not two sessions of one.
    #: Whether a fit is doubtful, so that differences are shown and none is judged.
    is_withheld: bool = False

    @property
    def changed(self) -> tuple[Difference, ...]:
        """What has changed, measures first."""
        every = (*self.measures.values(), *self.parameters.values())
        return tuple(d for d in every if d.verdict is ChangeVerdict.CHANGED)

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each difference, then what cannot be compared, by reason.
        """
        rows = []
        reasons: dict[str, list[str]] = {}
        for d in (*self.measures.values(), *self.parameters.values()):
            if d.difference is None or d.ci95 is None:
                if d.before is not None or d.after is not None:
                    reasons.setdefault(d.note, []).append(d.name)
                continue
            values = [significant(math.nan if v is None else v, 3) for v in (d.before, d.after)]
            text = of_interval(d.difference, d.ci95)
            shown = NO_NUMBER
            verdict = NO_NUMBER
            if d.smallest is not None:
                shown = significant(d.smallest, 2)
                verdict = str(d.verdict)
            rows.append((d.name, *values, text.value, text.interval, shown, d.unit, verdict))
        sides = (", ".join(side.recordings) for side in (self.before, self.after))
        baselines = f"The spread between sessions is that of {self.baselines} baselines."
        return TextTable(
            ("of", *_NUMBERS, "unit", "verdict"),
            tuple(rows),
            above=(" → ".join(sides),),
            below=(
                *(f"{reason}: {', '.join(names)}" for reason, names in reasons.items()),
                self.multiplicity,
                *([baselines] if self.baselines else []),
            ),
            numbers=_NUMBERS,
        )

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as C.json has it."""
        return {
            **Saved.as_dict(self),
            "before": list(self.before.recordings),
            "after": list(self.after.recordings),
            "of": "legs" if self.legs else "sessions",
        }


def compare_sessions(
    before: Quantities,
    after: Quantities,
    baselines: Sequence[Quantities] = (),
    *,
    legs: bool = False,
) -> Change:
    """Compare two sessions of a leg, or its two legs, whose own errors do not cancel.

    How far `baselines`, sessions before anything changed, scatter beyond their own uncertainty is
    taken for the spread between sessions.
    """
    if legs and baselines:
        raise InputError("baselines are sessions of one leg; leave them out to compare two legs")
    names = dict.fromkeys((*before.by_name, *after.by_name))
    drafts = {
        name: _difference(
            name,
            before,
            after,
            [b.by_name[name] for b in baselines if name in b.by_name],
            legs=legs,
        )
        for name in names
    }
    judged = {name: draft for name, (draft, _) in drafts.items()}
    compared = [name for name, draft in judged.items() if draft.p is not None]
    doubts = {name: _doubt(name, before, after, legs=legs) for name in compared}
    weights = _weights([name for name, why in doubts.items() if why is None])
    adjusted = holm({name: drafts[name][0].p or 0.0 for name in weights}, weights)
    for name, p in adjusted.items():
        judged[name] = _judged(*drafts[name], p, LEVEL * weights[name], legs=legs)
    doubtful = {name: why for name, why in doubts.items() if why is not None}
    for name, why in doubtful.items():
        note = Message("change/no-verdict", why=why)
        judged[name] = replace(judged[name], p=None, note=note)
    multiplicity = Message("change/holm", n=len(weights))
    first = next(iter(doubtful.values()), None)
    if first is not None and not weights:
        multiplicity = Message("change/none-judged", why=first)
    elif first is not None:
        multiplicity = Message("change/some-judged", n=len(weights), why=first)
    measures, parameters = (
        FrozenDict((n, d) for n, d in judged.items() if d.kind == kind)
        for kind in ("measure", "parameter")
    )
    repeated = len(baselines) + 1 if baselines else 0
    none = bool(doubtful) and not weights
    return Change(before, after, measures, parameters, multiplicity, repeated, legs, none)


def _doubt(name: str, before: Quantities, after: Quantities, *, legs: bool) -> str | None:
    """Which fits are doubtful of it: of unchanged pairs of a leg, such called one in four changed.

    A doubt that does not touch a value does not withhold its change; what both have by rest alone
    is not doubted with the fits.
    """
    pair = [side.by_name[name] for side in (before, after)]
    if all(q.basis == "rest" for q in pair):
        return next((q.doubt for q in pair if q.doubt), None)
    places = ("first", "second") if legs else ("before", "after")
    doubtful = [
        Message(f"change/doubtful/{place}", reason=str(doubt))
        for place, side in zip(places, (before, after), strict=True)
        if (doubt := side.adequacy.doubt_of(side.by_name[name].rests_on))
    ]
    if len(doubtful) < 2:
        return doubtful[0] if doubtful else None
    return Message("change/both", one=doubtful[0], other=doubtful[1])


def holm(p: Mapping[_Key, float], weights: Mapping[_Key, float]) -> dict[_Key, float]:
    """Holm's p-values of several claims, which share the level by their weights, 1 in all."""
    adjusted: dict[_Key, float] = {}
    left = 1.0
    before = 0.0
    for key in sorted(sorted(p), key=lambda key: p[key] / weights[key]):
        before = adjusted[key] = min(1.0, max(before, left * p[key] / weights[key]))
        left -= weights[key]
    return adjusted


def _weights(names: Sequence[str]) -> dict[str, float]:
    """Part of the level that each of these has; 1 in all."""
    leading = [name for name in names if name in FIXED]
    rest = [name for name in names if name not in leading]
    share = (_SHARE if rest else 1.0) if leading else 0.0
    parts = ((leading, share), (rest, 1.0 - share))
    return {name: part / len(own) for own, part in parts for name in own}


def _difference(
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
    why = _obstacle(before, after, a, b)
    if why or a is None or b is None or a.value is None or b.value is None:
        return replace(bare, note=Message("change/not-comparable", why=why)), math.inf
    drawn = sum(s.total**2 if legs else s.session**2 + s.model**2 for s in (a, b))
    between, more = _between(a, baselines)
    scatter = _OF_TENDON if name.partition("@")[0] in _TENDON else SCATTER
    variance = scatter**2 * drawn + 2.0 * between
    if not variance > 0.0:
        note = Message("change/not-comparable", why=Message("measure/nothing"))
        return replace(bare, note=note), 1.0
    freedom = more * (variance / (2.0 * between)) ** 2 if between > 0.0 else _MANY
    change = Student(b.value - a.value, math.sqrt(variance), freedom)
    draft = replace(bare, difference=change.value, ci95=change.ci95, p=change.p)
    return draft, freedom


def _obstacle(before: Quantities, after: Quantities, a: Quantity | None, b: Quantity | None) -> str:
    """Why two values cannot be compared; empty where they can."""
    for side, when in ((a, "before"), (b, "after")):
        if side is None:
            return Message(f"change/not-estimated/{when}")
        if side.missing:
            both = a and b and a.missing == b.missing
            return side.missing if both else Message(f"change/only/{when}", why=side.missing)
    assert a is not None
    assert b is not None
    why = ""
    if before.options != after.options:
        every = sorted({*before.options, *after.options})
        differing = [n for n in every if before.options.get(n) != after.options.get(n)]
        why = Message("change/options", names=", ".join(differing))
    elif a.from_deg is not None and abs(a.from_deg - (b.from_deg or 0.0)) > _RANGES:
        why = Message("change/ranges")
    elif a.basis != b.basis:
        why = Message("change/bases")
    elif a.unit != b.unit:
        why = Message("change/units", before=a.unit, after=b.unit)
    elif a.kind == "parameter" and before.model != after.model:
        why = Message("change/models", before=before.model, after=after.model)
    return why


def _between(before: Quantity, baselines: Sequence[Quantity]) -> tuple[float, int]:
    """Variance between sessions beyond their own uncertainty, from how many free baselines."""
    usable = [q for q in (before, *baselines) if q.value is not None and not q.missing]
    if len(usable) < 2:
        return 0.0, 0
    values = [q.value for q in usable if q.value is not None]
    mean = sum(values) / len(values)
    seen = sum((value - mean) ** 2 for value in values) / (len(values) - 1)
    own = sum(q.session**2 + q.model**2 for q in usable) / len(usable)
    return max(seen - SCATTER**2 * own, 0.0), len(usable) - 1


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
        note = _with_part(note, draft.difference, draft)
        return replace(draft, p=p, smallest=smallest, verdict=ChangeVerdict.CHANGED, note=note)
    least = Message("{size:.2g} {unit}", size=smallest, unit=draft.unit.strip("-"))
    note = Message(
        f"change/no-{'difference' if legs else 'change'}",
        smallest=_with_part(least, smallest, draft),
    )
    return replace(draft, p=p, smallest=smallest, verdict=ChangeVerdict.NONE_SHOWN, note=note)


def _with_part(said: Message, change: float, of: Difference) -> Message:
    """What is said of a change, in percent of the value before too, where that means something."""
    if of.unit == "deg" or not of.before or abs(change) > 10.0 * abs(of.before):
        return said
    return Message("{said} ({percent})", said=said, percent=percent(abs(change / of.before)))
