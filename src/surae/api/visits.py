"""A leg over its visits, and beside the other leg: two compared, and stiffness over time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any

from surae.api import Fit, fit_of
from surae.api.answers import CHANGE_ANGLES
from surae.base.files import PathLike
from surae.base.formatting import significant
from surae.base.normal import NORMAL
from surae.inference import AssessedFit
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.at_rest import relaxed_of
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import common_end
from surae.measures.relaxed_change import rest_change
from surae.measures.table import LEADING
from surae.report import block
from surae.report.figures import BLUE, GREY, INK, Figure, dress, new_figure
from surae.report.figures.leg import CARD_WIDTH
from surae.report.language import Words, words_in
from surae.report.leg import fixed_quantities
from surae.report.leg_cards import change_card, over
from surae.report.output import Report


@dataclass(frozen=True, slots=True)
class Visit:
    """One visit of one leg."""

    name: str  #: What the visit is called.
    day: date  #: When it was.
    side: str  #: ``"left"``, ``"right"``, or empty.
    fit: AssessedFit  #: The fit that stands for it.


def visits_report(
    visits: Sequence[Visit],
    before: int,
    after: int,
    *,
    language: str = "en",
    question: Sequence[str] = (),
) -> Report:
    """What changed from one of these visits to another, and stiffness at all of them over time.

    All are compared over the end of the range that every one of them moved through. Two legs, where
    their sides differ, are compared as such. `question` names what was asked before the second
    visit was seen, and is as of `surae.change`.
    """
    _ = words_in(language, visits[after].fit.result.problem.options.anatomy)
    end = common_end(visit.fit.result for visit in visits)
    sides = [fixed_quantities(visit.fit, end) for visit in visits]
    legs = visits[before].side != visits[after].side
    curves = [relaxed_of(visits[k].fit.result) for k in (before, after)]
    rest = None
    if isinstance(curves[0], RelaxedCurve) and isinstance(curves[1], RelaxedCurve):
        rest = rest_change(curves[0], curves[1], CHANGE_ANGLES, legs=legs)
    change = compare_sessions(sides[before], sides[after], legs=legs, rest=rest, question=question)
    lead = LEADING[0]
    points = []
    for visit, side in zip(visits, sides, strict=True):
        one = side.by_name.get(lead)
        if one is not None and one.value is not None and math.isfinite(one.session):
            points.append((visit.day, visit.side, one.value, NORMAL * one.session))
    blocks = [
        block.Text(f"{visits[before].name} → {visits[after].name}", "note"),
        *change_card(change, _),
    ]
    figures: list[tuple[str, Figure]] = []
    first = sides[before].by_name.get(lead)
    difference = change.measures.get(lead)
    if len(points) > 1 and first is not None and difference is not None:
        smallest = difference.smallest
        band = None if smallest is None or first.value is None else (first.value, smallest)
        unit = difference.unit.replace("deg", "°")
        title = _("Stiffness") + f" [{unit}]"
        figures.append(("visits", over_time_figure(points, band, title, _)))
        said = _(
            "Stiffness {range}. Bars: 95 % of what another session would find.",
            range=over(difference, _),
        )
        if smallest is not None:
            number = _.number(significant(smallest, 2))
            said += " " + _(
                "Grey: differences below {smallest} Nm/° that these recordings cannot show.",
                smallest=number,
            )
        if lost := len(visits) - len(points):
            said += " " + _.many(
                "{n} visit has no stiffness that can be compared.",
                "{n} visits have no stiffness that can be compared.",
                lost,
            )
        blocks.append(block.Picture("visits", _("Stiffness over the visits"), said, "here", 100))
    document = block.Document("", "", "", "", tuple(blocks), "", language)
    return Report(document, figures)


def visits_blocks(
    visits: Sequence[tuple[str, date, str, Fit | PathLike]],
    before: int,
    after: int,
    language: str = "en",
    question: Sequence[str] = (),
) -> dict[str, Any]:
    """What changed between two of these visits, and stiffness over all of them, as plain data.

    A visit is its name, its day, its side and its fit; see `visits_report`.
    """
    made = [Visit(name, day, side, fit_of(fit)) for name, day, side, fit in visits]
    report = visits_report(made, before, after, language=language, question=question)
    plain = report.plain(lines=True)
    return {key: plain[key] for key in ("blocks", "images")}


def over_time_figure(
    points: Sequence[tuple[date, str, float, float]],
    band: tuple[float, float] | None,
    title: str,
    _: Words,
) -> Figure:
    """A value over the days of visits, by side, each with its half-width.

    `band` is the middle and half-width of what could not be told from the visit compared with: its
    edges are drawn, as a wide one would fill the figure.
    """
    figure = new_figure(2.6, width=CARD_WIDTH)
    axes = figure.subplots()
    days = sorted({day for day, *_rest in points})
    apart = 0.012 * max((days[-1] - days[0]).days, 1)
    if band is not None:
        for edge in (band[0] - band[1], band[0] + band[1]):
            axes.axhline(edge, color=GREY, linewidth=1.2, linestyle=(0, (4, 3)))
    names = {"left": _("left leg"), "right": _("right leg")}
    looks = {"left": ("o", INK, -apart), "right": ("s", BLUE, apart)}
    for side in sorted({side for _day, side, *_rest in points}):
        mark, colour, shift = looks.get(side, ("o", INK, 0.0))
        of_side = sorted(point for point in points if point[1] == side)
        at = [(day - days[0]).days + shift for day, *_rest in of_side]
        values = [value for *_at, value, _h in of_side]
        halves = [half for *_at, half in of_side]
        axes.errorbar(
            at,
            values,
            halves,
            fmt=f"{mark}-",
            color=colour,
            ms=5,
            lw=1.2,
            capsize=3,
            label=names.get(side, "_"),
        )
    dress(axes, title, _("Day of the visit"))
    axes.set_xticks(
        [(day - days[0]).days for day in days],
        [f"{day:%Y-%m-%d}" for day in days],
        rotation=20 if len(days) > 2 else 0,
    )
    axes.margins(x=0.15)
    axes.yaxis.set_major_formatter(lambda tick, _place: _.number(f"{tick:g}".replace("-", "−")))
    if set(names) & {side for _day, side, *_rest in points}:
        axes.legend(frameon=False, fontsize=8, labelcolor=INK)
    return figure
