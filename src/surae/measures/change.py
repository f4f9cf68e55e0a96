"""Whether a leg has changed between two sessions, or differs from the other leg.

What both sessions are wrong in alike cancels in their difference: the leg's own delay, its tendon's
toe, the curve from EMG to force. What is drawn anew does not: noise, the torque's zero, electrodes
and foot mounted anew; nor does what models leave unsure, as noise decides among them. Virtual legs
differ between sessions by a little more than that (`SCATTER`). Between two legs nothing cancels:
each has its own delay, tendon and skin.

Many differences are looked at, and one of twenty would be beyond its 95 % interval by chance alone.
What was asked beforehand is judged at the full level, by Holm's p-values among what was asked; all
else is exploratory, by the false discovery rate (`surae.measures.claims`), and a claim of it is to
be confirmed. Intervals aren't corrected for multiple comparisons.

What rest tells (`surae.measures.relaxed_change`) is one estimate of both sessions, and is doubted
by rest alone; what muscles' fits tell is withheld where one of them is doubtful.

A spread between sessions that repeated baselines show is known as badly as they are few: what it
adds has Student's t, with the degrees of freedom of Welch and Satterthwaite.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import NO_NUMBER, nearest, of_interval, significant
from surae.base.frozen import FrozenDict
from surae.base.normal import Student
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.base.words import Message
from surae.measures.claims import false_discovery, holm
from surae.measures.compared import Quantities, Quantity
from surae.measures.course import Series
from surae.measures.difference import ChangeVerdict, Difference, sentence_of, with_part
from surae.measures.relaxed_change import RestChange, RestDifference
from surae.measures.reliability import SCATTER
from surae.measures.strength import STRENGTH, StrengthDifference

#: `SCATTER` of the tibialis's tendon, hardly stretched and the worst of these; on a measured leg it
#: differed by chance in three of 21 pairs of trials that 1.2 was for.
_TENDON = ("dlt_tib", "tendon_stiffness_tib", "tendon_secant_tib", "tendon_strain_tib")
_OF_TENDON = 2.0
#: By how much two ranges may differ in which one stiffness is compared [deg].
_RANGES = 1.0
#: Level of all claims together, and the power with which the smallest change would be shown.
LEVEL = 0.05
POWER = 0.80
#: Questions by a word: the measures that they are about.
QUESTIONS = {"strength": tuple(STRENGTH)}
#: Columns of the table that hold numbers.
_NUMBERS = ("before", "after", "difference", "95 % interval", "would show")
#: Degrees of freedom of what is known as well as the normal distribution.
_MANY = 1e9


@filed("before", "after", "legs", "is_withheld", sparse=("visits", "times", "series"))
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
    sentence: str  #: The answer in one sentence: a `Message`, unless it was read from a file.
    #: Repeated baselines from which the spread between sessions was estimated; 0 without.
    baselines: int = 0
    legs: bool = False  #: Whether they are two legs, and not two sessions of one.
    #: Whether differences are shown and none is judged, for what they rest on is doubtful.
    is_withheld: bool = False
    #: Of more than two visits: names of all, when they were, and every measure at each.
    visits: tuple[str, ...] = ()
    times: tuple[float, ...] = ()
    series: FrozenDict[str, Series] = field(default_factory=FrozenDict)

    @property
    def changed(self) -> tuple[Difference, ...]:
        """What has changed, measures first."""
        every = (*self.measures.values(), *self.parameters.values())
        return tuple(d for d in every if d.verdict is ChangeVerdict.CHANGED)

    def to_dataframe(self) -> Any:
        """Every difference as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row each by name, measures first: both values, difference, ends of its interval,
            p, verdict and more; None where there is no number.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        from surae.recording.frames import records_frame

        return records_frame({**self.measures, **self.parameters}, "of")

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
        sides = self.visits or [", ".join(s.recordings) for s in (self.before, self.after)]
        baselines = f"The spread between sessions is that of {self.baselines} baselines."
        return TextTable(
            ("of", *_NUMBERS, "unit", "verdict"),
            tuple(rows),
            above=(" → ".join(sides), self.sentence),
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
        own = [b.by_name[name] for b in baselines if name in b.by_name]
        draft, freedom = _difference(name, before, after, own, legs=legs)
        doubt = None if draft.p is None else doubt_of(name, before, after, legs=legs)
        drafts[name] = draft, freedom, doubt or ""
    if rest is not None:
        drafts = _with_rest(drafts, rest)
    efforts = {name: (_unjudged(each, "effort"), _MANY, "") for name, each in strength.items()}
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
        _multiplicity(counts, [why for *_, why in drafts.values()], withheld=withheld),
        sentence_of(tuple(judged.values()), counts[1], legs=legs),
        repeated,
        legs,
        withheld,
    )


def asked_of(question: Sequence[str], names: Iterable[str]) -> frozenset[str]:
    """The names that a question is about."""
    every = tuple(names)
    asked: set[str] = set()
    for one in question:
        of = [name for name in QUESTIONS.get(one, ()) if name in every]
        if one in QUESTIONS and not of:
            raise InputError(
                f"question {one!r}: neither visit has a trial of maximal effort; record three "
                "efforts of each group, held still, and name the file max"
            )
        of = of or [name for name in every if one in (name, name.partition("@")[0])]
        if not of:
            raise InputError(
                f"question {one!r}: no such measure or parameter is compared"
                f"{nearest(one, (*every, *QUESTIONS))}"
            )
        asked.update(of)
    return frozenset(asked)


def _with_rest(
    drafts: Mapping[str, tuple[Difference, float, str]], rest: RestChange
) -> dict[str, tuple[Difference, float, str]]:
    """With what rest tells in place of what fits say of the same, first."""
    made = {}
    for name, each in rest.differences.items():
        if each.difference is not None or name not in drafts:
            made[name] = (_of_rest(each), _MANY, rest.doubt)
    return {**made, **{name: draft for name, draft in drafts.items() if name not in made}}


def _of_rest(d: RestDifference) -> Difference:
    """A difference that rest tells, not yet judged."""
    made = _unjudged(d, "rest")
    return replace(made, from_deg=d.from_deg, to_deg=d.to_deg, ci95_device=d.ci95_device)


def _unjudged(d: RestDifference | StrengthDifference, basis: str) -> Difference:
    """A difference that an estimate of both sessions brings, with its p-value and no verdict."""
    p = None
    if d.difference is not None and d.sd is not None:
        p = Student(d.difference, d.sd, _MANY).p
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


def _multiplicity(counts: tuple[int, int], doubts: Sequence[str], *, withheld: bool) -> Message:
    """How many were looked at, and what that does to the claims."""
    if withheld:
        return Message("change/none-judged", why=next((why for why in doubts if why), ""))
    if counts[0]:
        return Message("change/asked", asked=counts[0], n=counts[1])
    return Message("change/exploratory", n=counts[1])


def doubt_of(name: str, before: Quantities, after: Quantities, *, legs: bool) -> str | None:
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
    freedom = more * (variance / (2.0 * between)) ** 2 if between > 0.0 else _MANY
    change = Student(b.value - a.value, math.sqrt(variance), freedom)
    draft = replace(bare, difference=change.value, ci95=change.ci95, p=change.p)
    return draft, freedom


def obstacle(before: Quantities, after: Quantities, a: Quantity | None, b: Quantity | None) -> str:
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
        note = with_part(note, draft.difference, draft)
        return replace(draft, p=p, smallest=smallest, verdict=ChangeVerdict.CHANGED, note=note)
    least = Message("{size:.2g} {unit}", size=smallest, unit=draft.unit.strip("-"))
    note = Message(
        f"change/no-{'difference' if legs else 'change'}",
        smallest=with_part(least, smallest, draft),
    )
    return replace(draft, p=p, smallest=smallest, verdict=ChangeVerdict.NONE_SHOWN, note=note)
