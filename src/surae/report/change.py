"""What changed between two visits of a leg, or how two legs differ: a page."""

from collections.abc import Sequence
from datetime import datetime

from surae.base.formatting import NO_NUMBER
from surae.base.words import JUDGEMENTS
from surae.inference import AssessedFit, Grade
from surae.measures.change import Change, ChangeVerdict, Difference
from surae.measures.torque_curve import torque_curve
from surae.report import block
from surae.report.figures.leg import visits_figure
from surae.report.language import MEASURES, Words, words_in
from surae.report.leg import angle_of, compared
from surae.report.leg_cards import change_card, differing, light, reason_of, sides
from surae.report.output import Report


def change_report(
    change: Change,
    fits: Sequence[AssessedFit],
    *,
    created: datetime,
    baselines: Sequence[AssessedFit] = (),
    language: str = "en",
    angle: float | None = None,
) -> Report:
    """The page of a comparison: three measures fixed beforehand, then every measure.

    `fits` are both that were compared, `baselines` further visits from before anything changed;
    torque and stiffness are given at `angle` [deg].
    """
    _ = words_in(language, fits[1].result.problem.options.anatomy)
    at = angle_of(fits[1]) if angle is None else angle
    lead = compared(*fits, baselines=baselines, legs=change.legs)
    names = sides(change, _)
    worst = max(fits, key=lambda fit: list(Grade).index(fit.assessment.adequacy.grade)).assessment
    drawn = visits_figure(
        [(name, torque_curve(fit)) for name, fit in zip(names, fits, strict=True)],
        _,
    )
    curves = (
        block.Picture("visits", _("Torque of the relaxed ankle over its angle"), "", "here", 100),
    )
    title = _("Do the legs differ?") if change.legs else _("Did it change?")
    cards = (
        block.Section(title, change_card(lead, _), "change", "card"),
        block.Section(_("Torque and angle"), curves, "curves", "card"),
        block.Section(
            _("Can I trust it?"),
            (light(worst.adequacy, reason_of(worst, (), _), _),),
            "trust",
            "card",
        ),
    )
    document = block.Document(
        kicker="",
        heading=title,
        under=_("Report of {date}.", date=f"{created:%Y-%m-%d %H:%M}"),
        title=title,
        blocks=(block.Section("", cards, look="leg"), _every(change, at, _)),
        footer=_("Made by surae for research."),
        language=language,
    )
    return Report(document, [("visits", drawn)])


def _every(change: Change, at: float, _: Words) -> block.Section:
    """Every measure at an angle [deg], or that has none."""
    measures = [
        d
        for name in MEASURES
        for d in (*change.measures.values(), *change.parameters.values())
        if d.name.partition("@")[0] == name
        and (not d.name.endswith("deg") or d.name.endswith(f"@{at:g}deg"))
        and (d.before, d.after) != (None, None)
    ]
    heads = block.columns(
        "", *sides(change, _), _("Difference (95 %)"), _("Judgement"), numbers=(1, 2), wide=(0,)
    )
    table = block.Grid(_("The numbers"), heads, block.rows(_row(d, change, _) for d in measures))
    blocks: tuple[block.Grid | block.Text, ...] = (table,)
    if not change.is_withheld:
        every = (*change.measures.values(), *change.parameters.values())
        count = sum(d.p is not None for d in every)
        text = _(
            "{count} differences were looked at and allowed for (Holm). Intervals aren’t "
            "corrected for multiple comparisons.",
            count=str(count),
        )
        blocks = table, block.Text(text, "note")
    return block.Section(_("The numbers"), blocks, "numbers")


def _row(d: Difference, change: Change, _: Words) -> block.Row:
    verdict = NO_NUMBER
    if d.smallest is not None or d.difference is None:
        verdict = _(JUDGEMENTS[d.verdict].plain)
        if change.legs and d.verdict is ChangeVerdict.CHANGED:
            verdict = _("different")
    return (*differing(d, _), verdict)
