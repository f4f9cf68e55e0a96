"""The page of a relaxed leg: its curve, the numbers at stated angles, and what was met."""

from collections.abc import Iterator, Mapping
from datetime import datetime

from surae.base.units import on_page
from surae.base.words import JUDGEMENTS
from surae.inference import Grade
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.measure import Measure
from surae.report import block
from surae.report.figures.relaxed import relaxed_figure
from surae.report.language import Words, words_in
from surae.report.output import Report

#: Measures of which the page says more than the table, the first that has a value leads.
_LEADING = ("slow_stiffness", "passive_stiffness", "end_stiffness")


def relaxed_report(
    curve: RelaxedCurve,
    measures: Mapping[str, Measure],
    *,
    created: datetime,
    language: str = "en",
) -> Report:
    """The page of what rest says of a leg, in a language."""
    _ = words_in(language)
    picture = block.Picture(
        "relaxed",
        _("Torque of the relaxed ankle over its angle"),
        _(
            "What was measured at rest, without the weight of foot and plate and the sensor’s "
            "zero, and the fully relaxed curve with its 95 % band; the darker one is of its shape, "
            "whatever the zero of the torque. A moving leg lies above it on the way to "
            "dorsiflexion and nearer to it on the way back: its tissue relaxes."
        ),
        "here",
        100,
    )
    document = block.Document(
        kicker="",
        heading=_("The relaxed ankle"),
        under=_("Report of {date}.", date=f"{created:%Y-%m-%d %H:%M}"),
        title=_("The relaxed ankle"),
        blocks=(
            block.Section(_("Torque and angle"), (*_answer(measures, _), picture), "curve"),
            block.Section(_("Can I trust it?"), (_light(curve, _), *_found(curve, _)), "trust"),
            _numbers(measures, _),
            _rest(curve, _),
        ),
        footer=_("Made by surae for research."),
        language=language,
    )
    return Report(document, [("relaxed", relaxed_figure(curve, measures, _))])


def _answer(measures: Mapping[str, Measure], _: Words) -> Iterator[block.Text]:
    """The first number, in a sentence."""
    for base in _LEADING:
        known = [m for m in measures.values() if m.name.partition("@")[0] == base and m.value]
        if known:
            m = known[-1]
            assert m.value is not None
            value, span = _.estimate(m.value, m.ci95)
            text = _(
                "{measure}: {value} Nm/° ({span}).",
                measure=_.measure(m.name),
                value=value,
                span=span,
            )
            yield block.Text(text, "say")
            return


def _light(curve: RelaxedCurve, _: Words) -> block.AdequacyWords:
    """One light: whether rest speaks against its numbers."""
    if curve.grade is Grade.ADEQUATE:
        reason = _("nothing that was looked at speaks against these numbers")
        return block.AdequacyWords("adequate", "●", _("Yes: {reason}.", reason=reason), ())
    reason = _(curve.findings[0]).rstrip(".")
    return block.AdequacyWords(
        str(curve.grade), "▲", _("With caution: {reason}.", reason=reason), ()
    )


def _found(curve: RelaxedCurve, _: Words) -> tuple[block.Block, ...]:
    """What else was met."""
    rest = curve.findings if curve.grade is Grade.ADEQUATE else curve.findings[1:]
    return tuple(block.Text(_(each), "note") for each in rest)


def _numbers(measures: Mapping[str, Measure], _: Words) -> block.Section:
    """Every measure that has a value, and why others have none."""
    heads = block.columns(
        "",
        _("Value"),
        _("95 % interval"),
        _("at the device’s angle"),
        _("Unit"),
        _("Judgement"),
        numbers=(1, 2, 3),
        wide=(0,),
    )
    rows = []
    missing: dict[str, list[str]] = {}
    for m in measures.values():
        if m.value is None:
            missing.setdefault(_(m.note), []).append(_.measure(m.name))
            continue
        value, span = _.estimate(m.value, m.ci95)
        device = _.estimate(m.value, m.ci95_device)[1] if m.ci95_device else ""
        unit = on_page(m.unit)[0]
        rows.append((_.measure(m.name), value, span, device, unit, _(JUDGEMENTS[m.verdict].plain)))
    table = block.Grid(_("The numbers"), heads, block.rows(rows))
    why = tuple(
        block.Text(f"{', '.join(names)}: {reason}.", "note") for reason, names in missing.items()
    )
    about = _(
        "Angles and intervals are the ankle’s own, the error of its zero in them; the interval at "
        "the device’s angle is without that error. Slow is at 5°/s, as a device would show it; at "
        "rest is after all has relaxed. No parameter of a muscle is in these numbers."
    )
    return block.Section(_("The numbers"), (table, *why, block.Text(about, "note")), "numbers")


def _rest(curve: RelaxedCurve, _: Words) -> block.Section:
    """Which parts of the trials it is made of."""
    heads = block.columns(_("Recording"), _("Rest [s]"), _("Angles"), numbers=(1,))
    rows = [
        (
            trial.name,
            _.number(f"{trial.seconds:.3g}"),
            ""
            if trial.low is None or trial.high is None
            else _("{low} to {high}", low=_degrees(trial.low, _), high=_degrees(trial.high, _)),
        )
        for trial in curve.trials
    ]
    title = _("What it rests on")
    return block.Section(title, (block.Grid(title, heads, block.rows(rows)),), "rest")


def _degrees(angle: float, _: Words) -> str:
    return _.number(f"{angle:.0f}°".replace("-", "−"))
