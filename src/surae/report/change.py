"""What changed between two visits of a leg, or how two legs differ: a page."""

from collections.abc import Sequence
from datetime import datetime

from surae.base.formatting import NO_NUMBER
from surae.base.words import JUDGEMENTS
from surae.inference import AssessedFit, Grade
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.change.result import Change
from surae.measures.difference import ChangeVerdict, Difference
from surae.measures.torque_curve import torque_curve
from surae.report import block
from surae.report.figures import Figure
from surae.report.figures.change import before_and_after_figure, course_figure
from surae.report.figures.leg import visits_figure
from surae.report.language import MEASURES, Words, words_in
from surae.report.leg import angle_of
from surae.report.leg_cards import change_card, differing, sides
from surae.report.output import Report
from surae.report.trust_card import light, reason_of

#: Where torque and stiffness are given where no fit says better [deg].
_ANGLE = 10.0


def change_report(
    change: Change,
    fits: Sequence[AssessedFit],
    *,
    created: datetime,
    language: str = "en",
    angle: float | None = None,
    curves: Sequence[RelaxedCurve] = (),
) -> Report:
    """The page of a comparison: what was asked and what changed, then every measure.

    `fits` are both that were compared, none where recordings were; `curves` are those of their
    rest, none where one has no rest; torque and stiffness are given at `angle` [deg].
    """
    anatomy = [fit.result.problem.options.anatomy for fit in fits]
    _ = words_in(language, *anatomy[1:2])
    at = _ANGLE
    if angle is not None or fits:
        at = angle_of(fits[1]) if angle is None else angle
    title = _("Do the legs differ?") if change.legs else _("Did it change?")
    cards = [block.Section(title, change_card(change, _), "change", "card")]
    figures: list[tuple[str, Figure]] = []
    if change.series:
        name = _shown(change)
        said = _("Bars: 95 % of what another such visit would find. Line: the trend.")
        picture = block.Picture("visits", _("Course over the visits"), said, "here", 100)
        cards.append(block.Section(_("Course over the visits"), (picture,), "curves", "card"))
        figures.append(("visits", course_figure(change, name, _)))
    elif len(curves) == 2:
        cards.append(_of_rest(_))
        names = sides(change, _)
        drawn = before_and_after_figure(curves[0], curves[1], names, _, legs=change.legs)
        figures.append(("visits", drawn))
    elif fits:
        cards.append(_of_models(_))
        figures.append(("visits", _models_figure(change, fits, _)))
    if fits:
        cards.append(_trusted(fits, _))
    document = block.Document(
        kicker="",
        heading=title,
        under=_("Report of {date}.", date=f"{created:%Y-%m-%d %H:%M}"),
        title=title,
        blocks=(block.Section("", tuple(cards), look="leg"), _every(change, at, _)),
        footer=_("Made by surae for research."),
        language=language,
    )
    return Report(document, figures)


def _shown(change: Change) -> str:
    """The measure whose course is drawn: what was asked, what changed, else the first that has."""
    drawn = [d for n, d in change.measures.items() if n in change.series and d.difference]
    order = sorted(
        drawn, key=lambda d: (not d.asked, d.verdict is not ChangeVerdict.CHANGED, d.p or 1.0)
    )
    return order[0].name if order else next(iter(change.series))


def _of_rest(_: Words) -> block.Section:
    """Both relaxed curves, and their difference."""
    said = _(
        "Above: the relaxed ankle at both, with 95 % bands. Below: what lies between the two, laid "
        "on each other where the range begins; where its band is off zero, they differ."
    )
    picture = block.Picture(
        "visits", _("Torque of the relaxed ankle over its angle"), said, "here", 100
    )
    return block.Section(_("Torque and angle"), (picture,), "curves", "card")


def _of_models(_: Words) -> block.Section:
    """Both curves as fits have them."""
    alt = _("Torque of the relaxed ankle over its angle")
    curves = (block.Picture("visits", alt, "", "here", 100),)
    return block.Section(_("Torque and angle"), curves, "curves", "card")


def _models_figure(change: Change, fits: Sequence[AssessedFit], _: Words) -> Figure:
    names = sides(change, _)
    return visits_figure(
        [(name, torque_curve(fit)) for name, fit in zip(names, fits, strict=True)], _
    )


def _trusted(fits: Sequence[AssessedFit], _: Words) -> block.Section:
    """Whether the worse of both fits can be trusted."""
    worst = max(fits, key=lambda fit: list(Grade).index(fit.assessment.adequacy.grade)).assessment
    trusted = (light(worst.adequacy, reason_of(worst, (), _), _),)
    return block.Section(_("Can I trust it?"), trusted, "trust", "card")


def _every(change: Change, at: float, _: Words) -> block.Section:
    """Every measure at an angle [deg], or that has none."""
    every = (*change.measures.values(), *change.parameters.values())
    measures = [
        d
        for name in MEASURES
        for d in every
        if d.name.partition("@")[0] == name
        and (not d.name.endswith("deg") or d.name.endswith(f"@{at:g}deg"))
        and (d.before, d.after) != (None, None)
    ]
    measures += [
        d for d in every if d not in measures and (d.asked or d.verdict is ChangeVerdict.CHANGED)
    ]
    heads = block.columns(
        "", *sides(change, _), _("Difference (95 %)"), _("Judgement"), numbers=(1, 2), wide=(0,)
    )
    table = block.Grid(_("The numbers"), heads, block.rows(_row(d, change, _) for d in measures))
    return block.Section(
        _("The numbers"), (table, block.Text(_(change.multiplicity), "note")), "numbers"
    )


def _row(d: Difference, change: Change, _: Words) -> block.Row:
    verdict = NO_NUMBER
    if d.smallest is not None or d.difference is None:
        verdict = _(JUDGEMENTS[d.verdict].plain)
        if change.legs and d.verdict is ChangeVerdict.CHANGED:
            verdict = _("different")
    return (*differing(d, _), verdict)
