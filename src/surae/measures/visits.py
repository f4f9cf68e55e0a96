"""Several visits of one leg compared: a line through every measure, judged as differences are."""

import math
from collections.abc import Mapping, Sequence

from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.base.normal import Student
from surae.base.words import Message
from surae.measures.change.asked import asked_of
from surae.measures.change.doubts import doubt_of, obstacle
from surae.measures.change.result import Change
from surae.measures.change.verdicts import all_judged
from surae.measures.compared import Quantities
from surae.measures.course import FEWEST, Series, trend_of
from surae.measures.difference import ChangeVerdict, Difference, sentence_of
from surae.measures.reliability import SCATTER
from surae.measures.strength import STRENGTH

#: Degrees of freedom of what is known as well as the normal distribution.
_MANY = 1e9


def compare_visits(
    visits: Sequence[Quantities],
    times: Sequence[float],
    direct: Mapping[str, Series],
    doubt: str = "",
    *,
    question: Sequence[str] = (),
    names: Sequence[str] = (),
) -> Change:
    """Whether a leg changed over its visits, by a straight line through each measure.

    Parameters
    ----------
    visits : sequence of Quantities
        What the fit of each brings; nothing where recordings are compared.
    times : sequence of float
        When they were: days, or their numbers.
    direct : mapping of str to Series
        What rest tells, and strength; it goes before what fits tell.
    doubt : str
        Why none of what rest tells is judged.
    question : sequence of str
        What was asked beforehand.
    names : sequence of str
        What visits are called.

    Returns
    -------
    Change
        `difference` is that from the first visit to the last along the line; `series` has every
        value.

    Raises
    ------
    InputError
        There are fewer than three visits, or all at one time.
    """
    if len(visits) < FEWEST or len(times) != len(visits):
        raise InputError(f"a course has {FEWEST} visits or more, each with its time")
    if not max(times) > min(times):
        raise InputError("all visits are of one day; give the day of each")
    drafts: dict[str, tuple[Difference, float, str]] = {}
    every = {**direct}
    for name, each in direct.items():
        why = "" if name in STRENGTH else doubt
        drafts[name] = (_draft(each, times), _MANY, why)
    for name in dict.fromkeys(name for side in visits for name in side.by_name):
        if name not in drafts:
            made, why = _of_fits(name, visits)
            if made is not None:
                every[name] = made
                drafts[name] = (_draft(made, times, _kind(name, visits)), _MANY, why)
    judged, counts = all_judged(drafts, asked_of(question, drafts), legs=False)
    measures, parameters = (
        FrozenDict((n, d) for n, d in judged.items() if d.kind == kind)
        for kind in ("measure", "parameter")
    )
    withheld = not any(counts) and any(d.difference is not None for d in judged.values())
    return Change(
        visits[0],
        visits[-1],
        measures,
        parameters,
        Message("change/course", visits=len(visits), asked=counts[0], n=counts[1]),
        sentence_of(tuple(judged.values()), counts[1], legs=False),
        is_withheld=withheld,
        visits=tuple(names),
        times=tuple(map(float, times)),
        series=FrozenDict(every),
    )


def _draft(series: Series, times: Sequence[float], kind: str = "measure") -> Difference:
    """The difference along the line, not yet judged."""
    trend = trend_of(times, series)
    order = sorted(range(len(times)), key=lambda k: times[k])
    values = [series.values[k] for k in order if series.values[k] is not None]
    why = Message("change/few-visits", n=FEWEST)
    return Difference(
        series.name,
        series.unit,
        series.meaning,
        kind,
        values[0] if values else None,
        values[-1] if values else None,
        None if trend is None else trend.difference,
        None if trend is None else trend.ci95,
        None if trend is None else Student(trend.difference, trend.sd, _MANY).p,
        None,
        ChangeVerdict.NOT_COMPARABLE,
        Message("change/not-comparable", why=why) if trend is None else "",
        series.from_deg,
        series.to_deg,
        basis=series.basis,
    )


def _kind(name: str, visits: Sequence[Quantities]) -> str:
    return next(str(side.by_name[name].kind) for side in visits if name in side.by_name)


def _of_fits(name: str, visits: Sequence[Quantities]) -> tuple[Series | None, str]:
    """What fits tell of a measure at every visit, and why to doubt it; None where they cannot."""
    measured = [side.by_name.get(name) for side in visits]
    first = next((k for k, each in enumerate(measured) if each is not None), 0)
    usual = measured[first]
    values: list[float | None] = []
    sems: list[float | None] = []
    doubt = ""
    for side, each in zip(visits, measured, strict=True):
        sem = math.nan if each is None else SCATTER * math.hypot(each.session, each.model)
        usable = each is not None and not obstacle(visits[first], side, usual, each)
        usable = usable and math.isfinite(sem) and sem > 0.0
        values.append(each.value if usable and each is not None else None)
        sems.append(sem if usable else None)
        if usable and side is not visits[first]:
            doubt = doubt or doubt_of(name, visits[first], side, legs=False) or ""
    if usual is None or all(value is None for value in values):
        return None, ""
    made = Series(
        name,
        usual.unit,
        usual.meaning,
        usual.basis,
        tuple(values),
        tuple(sems),
        usual.from_deg,
        usual.to_deg,
    )
    return made, doubt
