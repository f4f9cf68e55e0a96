"""The pages of tissue and reflex: perturbed recordings in one table, each with its figures."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from math import nan

from surae.base.formatting import NO_NUMBER, percentage, significant
from surae.base.frozen import FrozenDict
from surae.base.units import on_page
from surae.base.words import N_, Message
from surae.nerve.answer import Impedance, in_degrees, measure_rows
from surae.nerve.leg import stretch_torque
from surae.nerve.measures import NerveMeasure
from surae.nerve.perturbed_records import Perturbed
from surae.nerve.stretch_records import Stretches
from surae.report import block
from surae.report.figures import Figure
from surae.report.figures.nerve import effort_figure, frequency_figure, impulse_figure
from surae.report.language import Words, words_in
from surae.report.nerve_card import stretches_figure
from surae.report.output import Report

#: What the page says of itself.
_ABOUT = N_(
    "The foot was moved by a few degrees at random. Torque is taken for that of two paths side by "
    "side: tissue, which answers at once, and a reflex, which answers the velocity of stretch in "
    "one direction, later. Intervals contain noise that is not white, drift, and what structures "
    "say that describe the torque about as well. No word of this is a diagnosis."
)

#: What the page of stretches says of itself.
_STRETCHES = N_(
    "Elastic is the rise of tissue’s torque, relaxed; viscous and inertial the largest of tissue’s "
    "and of foot and device; neural the largest beyond them after 30 ms. Elastic and viscous "
    "torque have no interval: beside a reflex the viscous one may be off by as much as itself, the "
    "elastic one by a quarter. Without EMG only torque that rises when the foot has stopped is "
    "taken for neural: tissue’s falls. EMG begins where it exceeds its rest by three standard "
    "deviations for 25 ms (Hodges and Bui 1996); the threshold is the angle of onset over its "
    "velocity, at none (Levin and Feldman 1994). No word of this is a diagnosis."
)
#: What measures are called, and words that judge.
_NAMES = {
    "intrinsic_stiffness": N_("Stiffness without reflex (tissue and working muscle)"),
    "intrinsic_viscosity": N_("Viscosity of tissue"),
    "inertia": N_("Inertia"),
    "reflex_gain": N_("Gain of the reflex"),
    "reflex_delay": N_("Delay of the reflex"),
    "reflex_share": N_("Share of the reflex"),
    "reflex_frequency": N_("Natural frequency of the reflex"),
    "reflex_damping": N_("Damping of the reflex"),
    "reflex_threshold": N_("Threshold of the reflex"),
}
_VERDICTS = (N_("present"), N_("none seen"), N_("cannot tell"))
#: Heads of the table of stretches.
_HEADS = {
    "recording": N_("Recording"),
    "start [s]": N_("start [s]"),
    "direction": N_("Direction"),
    "speed [°/s]": N_("speed [°/s]"),
    "from, to [°]": N_("from, to [°]"),
    "peak [Nm]": N_("peak [Nm]"),
    "elastic": N_("elastic"),
    "viscous": N_("viscous"),
    "inertial": N_("inertial"),
    "neural": N_("neural"),
    "EMG from [°]": N_("EMG from [°]"),
    "catch [°]": N_("catch [°]"),
    "note": N_("Note"),
}


def impedance_report(impedance: Impedance, *, created: datetime, language: str = "en") -> Report:
    """The report of perturbed recordings."""
    _ = words_in(language)
    figures = list[tuple[str, Figure]]()
    several = len(impedance.recordings) > 1
    sections = []
    if several:
        sections.append(_section(_("All recordings, means"), impedance.measures, _))
        figures.append(("effort", effort_figure(impedance.recordings, _)))
        sections.append(
            block.Section(
                _("Stiffness over effort and angle"),
                (
                    block.Picture(
                        "effort",
                        _("Stiffness over mean torque and over mean angle"),
                        _(
                            "Stiffness of each recording with its 95 % interval. "
                            "A torque’s zero that is not "
                            "known shifts the axis."
                        ),
                        "here",
                    ),
                ),
            )
        )
    for number, recording in enumerate(impedance.recordings, 1):
        sections.append(_recording(recording, number, figures, _))
    by_name = {row[0]: row for row in measure_rows(_on_page(impedance.measures))}
    key = tuple(
        (
            _(_NAMES[name]),
            _.number(value) if value == NO_NUMBER else f"{_.number(value)} {unit}",
            _(verdict),
        )
        for name in ("intrinsic_stiffness", "reflex_share")
        for _n, value, _i, unit, verdict, _t in (by_name[name],)
    )
    reflex = impedance.reflex
    document = block.Document(
        kicker=_("How much is nerve?"),
        heading=_("Tissue and reflex, from perturbations"),
        under=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        title=_("Tissue and reflex"),
        blocks=(
            block.KeyFigures(
                (
                    (
                        _("reflex"),
                        _(reflex.verdict),
                        _(reflex.direction) if reflex.direction else "",
                    ),
                    *key,
                )
            ),
            block.Text(_(_sentence(reflex.reason)), lead=_said(reflex.verdict, _)),
            block.Text(_(_ABOUT), "note"),
            *sections,
        ),
        footer=_("Made by surae for research."),
        language=language,
    )
    return Report(document, figures)


def stretches_report(answer: Stretches, *, created: datetime, language: str = "en") -> Report:
    """The report of slow and fast stretches."""
    _ = words_in(language)
    table = answer.as_table()
    figures = list[tuple[str, Figure]]()
    pictures = list[block.Block]()
    for way in dict.fromkeys(s.direction for s in answer.stretches):
        one_way = [stretch_torque(s) for s in answer.stretches if s.direction == way]
        figures.append((way, stretches_figure(one_way, _)))
        caption = _(
            "Elastic and neural torque in stretches to {way}; bars are 95 % intervals.", way=_(way)
        )
        alt = _("Torque over speed, {way}", way=_(way))
        pictures.append(block.Picture(way, alt, caption, "here", 62))
    # which recording is told where there are several
    first = 1 if len({s.recording for s in answer.stretches}) == 1 else 0
    heads = table.heads[first:]
    rows = [_translated(row, _)[first:] for row in table.rows]
    numbers = tuple(k for k, head in enumerate(heads) if head in table.numbers)
    columns = block.columns(*(_(_HEADS[h]) for h in heads), numbers=numbers, wide=(len(heads) - 1,))
    grid = block.Grid(_("Stretches"), columns, block.rows(rows), look="small")
    document = block.Document(
        kicker=_("How much is nerve?"),
        heading=_("Slow and fast stretches"),
        under=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        title=_("Slow and fast stretches"),
        blocks=(
            *(block.Text(_(_sentence(line))) for line in answer.lines()),
            *pictures,
            block.Section(_("Every stretch"), (grid,)),
            block.Text(_(_STRETCHES), "note"),
        ),
        footer=_("Made by surae for research."),
        language=language,
    )
    return Report(document, figures)


def _sentence(text: str) -> str:
    return Message(N_("{text}."), text=text)


def _said(verdict: str, _: Words) -> str:
    return _("Reflex: {verdict}:", verdict=_(verdict))


def _translated(row: Sequence[str], _: Words) -> tuple[str, ...]:
    """A row of stretches: direction and note in words, numbers as they are written there."""
    recording, *cells, note = row
    written = (
        _(cell)
        if cell in ("dorsiflexion", "plantarflexion")
        else _.number(cell.replace(" to ", " … "))
        for cell in cells
    )
    return (recording, *written, _(note))


def _on_page(measures: FrozenDict[str, NerveMeasure]) -> FrozenDict[str, NerveMeasure]:
    """Measures in the units of pages."""
    made = {}
    for name, m in measures.items():
        unit, factor = on_page(m.unit)
        value = None if m.value is None else factor * m.value
        ends = (factor * m.ci95[0], factor * m.ci95[1])
        made[name] = replace(m, value=value, unit=unit, ci95=ends)
    return FrozenDict(made)


def _stiffness(value: float) -> str:
    """A stiffness [Nm/rad] as pages have it."""
    return significant(on_page("Nm/rad")[1] * value, 3)


def _section(
    title: str, measures: FrozenDict[str, NerveMeasure], _: Words, *more: block.Block
) -> block.Section:
    heads = (_("Measure"), _("Value"), _("95 % interval"), _("Unit"), _("Verdict"), _("Note"))
    cells = []
    for name, value, ci, unit, verdict, note in measure_rows(_on_page(measures)):
        badge = block.Cell(badge=(f"verdict {verdict}", _(verdict)))
        span = _.number(ci.replace(" to ", " … "))
        cells.append((_(_NAMES[name]), _.number(value), span, unit, badge, _(note)))
    table = block.Grid(title, block.columns(*heads, numbers=(1, 2), wide=(5,)), block.rows(cells))
    return block.Section(title, (table, *more))


def _recording(
    r: Perturbed, number: int, figures: list[tuple[str, Figure]], _: Words
) -> block.Section:
    """A recording's table, figures and what else to know."""
    name = r.path.replace("\\", "/").rsplit("/", 1)[-1]
    figures += [
        (f"frequency-{number}", frequency_figure(r, _)),
        (f"impulse-{number}", impulse_figure(r, _)),
    ]
    held, alone, other = (
        _.number(percentage(v))
        for v in (r.vaf_held_out, r.vaf_held_out_intrinsic, r.vaf_held_out_other)
    )
    parts = "; ".join(_.number(_stiffness(value)) for _t, value, _s in r.stationarity.parts)
    halves = "; ".join(
        f"{_.number(_stiffness(value))} ({_.span(_stiffness(low), _stiffness(high))})"
        for value, low, high in r.stationarity.halves
    )
    steady = _("It is steady.")
    if r.stationarity.verdict == "changes":
        steady = _("It changes.")
    if (each := in_degrees(r.measures)) is not None:
        below, middle, above = (significant(of, 3) for of in each)
        said = _(
            "That is {value} Nm/° ({ends}), the unit of a fit’s measures.",
            value=_.number(middle),
            ends=_.span(below, above),
        )
        steady = f"{steady} {said}"
    structures = []
    for label, (value, low, high) in r.structures.items():
        ends = (low, high) if low < high else (nan, nan)  # some tell a value alone
        structures.append((_(label), *(_.number(_stiffness(x)) for x in (value, *ends))))
    return _section(
        name,
        r.measures,
        _,
        block.Text(_(_sentence(r.reflex.reason)), lead=_said(r.reflex.verdict, _)),
        block.Text(
            _(
                "Responses of both paths, of the first half, predict {held} % of the second half’s "
                "torque; tissue alone {alone} %, a reflex the other way round {other} %.",
                held=held,
                alone=alone,
                other=other,
            )
        ),
        block.Text(
            _(
                "Stiffness of the halves [Nm/°]: {halves}; of every 10 s: {parts}.",
                halves=halves,
                parts=parts,
            )
            + " "
            + steady
        ),
        *(block.Text(_(note), "note") for note in r.notes),
        block.Grid(
            _("Stiffness by structure"),
            block.columns(_("Structure"), "Nm/°", _("from"), _("to"), numbers=(1, 2, 3)),
            block.rows(structures),
            titled=True,
        ),
        block.Picture(
            f"frequency-{number}",
            _("Coherence, gain and phase of torque over angle"),
            _("Torque over angle: measured, and as the equations have it."),
            "here",
        ),
        block.Picture(
            f"impulse-{number}",
            _("Impulse responses of tissue and reflex"),
            _("Answers to an impulse: of tissue to the angle, of the reflex to velocity."),
            "here",
        ),
    )
