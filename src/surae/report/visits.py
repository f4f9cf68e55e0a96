"""A leg over its visits, and beside the other leg: two compared, and stiffness over time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

from surae.base.formatting import significant
from surae.base.normal import NORMAL
from surae.inference import AssessedFit
from surae.measures.change import compare_sessions
from surae.measures.compared import common_end
from surae.measures.table import LEADING
from surae.report import block
from surae.report.figures import Figure
from surae.report.figures.leg import over_time_figure
from surae.report.language import words_in
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
    visits: Sequence[Visit], before: int, after: int, *, language: str = "en"
) -> Report:
    """What changed from one of these visits to another, and stiffness at all of them over time.

    All are compared over the end of the range that every one of them moved through. Two legs, where
    their sides differ, are compared as such.
    """
    _ = words_in(language, visits[after].fit.result.problem.options.anatomy)
    end = common_end(visit.fit.result for visit in visits)
    sides = [fixed_quantities(visit.fit, end) for visit in visits]
    legs = visits[before].side != visits[after].side
    change = compare_sessions(sides[before], sides[after], legs=legs)
    lead, points = LEADING[0], []
    for visit, side in zip(visits, sides, strict=True):
        one = side.by_name.get(lead)
        if one is not None and one.value is not None and math.isfinite(one.session):
            points.append((visit.day, visit.side, one.value, NORMAL * one.session))
    blocks = [block.Text(f"{visits[before].name} → {visits[after].name}", "note"),
              *change_card(change, _)]  # fmt: skip
    figures: list[tuple[str, Figure]] = []
    first = sides[before].by_name.get(lead)
    difference = change.measures.get(lead)
    if len(points) > 1 and first is not None and difference is not None:
        smallest = difference.smallest
        band = None if smallest is None or first.value is None else (first.value, smallest)
        unit = difference.unit.replace("deg", "°")
        title = _("Stiffness") + f" [{unit}]"
        figures.append(("visits", over_time_figure(points, band, title, _)))
        said = _("Stiffness {range}. Bars: 95 % of what another session would find.",
                 range=over(difference, _))  # fmt: skip
        if smallest is not None:
            number = _.number(significant(smallest, 2))
            said += " " + _("Grey: differences below {smallest} Nm/° that these recordings cannot "
                            "show.", smallest=number)  # fmt: skip
        if lost := len(visits) - len(points):
            said += " " + _.many("{n} visit has no stiffness that can be compared.",
                                 "{n} visits have no stiffness that can be compared.",
                                 lost)  # fmt: skip
        blocks.append(block.Picture("visits", _("Stiffness over the visits"), said, "here", 100))
    document = block.Document("", "", "", "", tuple(blocks), "", language)
    return Report(document, figures)
