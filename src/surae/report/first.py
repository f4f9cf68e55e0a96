"""The first screen of a fit's report: what was asked, a picture, and what came out with its ±."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from surae.base.formatting import short, with_half
from surae.base.units import on_page
from surae.base.words import Message
from surae.inference import AssessedFit, FitResult
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures import Measure
from surae.measures.at_rest import rest_of_fit
from surae.measures.compute import judged_measures
from surae.measures.points import ANGLES, points
from surae.measures.rest.judged import rated_measures
from surae.measures.table import INVARIANT
from surae.measures.torque_curve import torque_curve
from surae.report import block
from surae.report.figures import Figure
from surae.report.figures.first import SHOWN, first_figure
from surae.report.figures.leg import stiffness_figure
from surae.report.figures.relaxed import relaxed_figure
from surae.report.invariants import is_invariant
from surae.report.language import MEASURES, Words, words_in
from surae.report.leg import angle_of
from surae.report.leg_cards import is_told, on_page_of
from surae.report.provenance import requested
from surae.report.rest_card import stated_angle
from surae.report.traces import Traces
from surae.report.wording import adequacy_words

#: Of the relaxed leg, in their order: at the angle that leads, at a torque, over the range.
_RELAXED = (
    "slow_stiffness",
    "passive_stiffness",
    "passive_torque",
    "end_stiffness",
    "end_torque",
    "range_at_torque",
)
_AT_TORQUE = "range_at_torque@10Nm"
#: Rows of each kind at most, so that the screen holds them.
_MOST = 5
#: Letters from which on a setting's value is listed below alone.
_LONG = 40
#: Size of the relaxed curve [inch].
_WIDTH = 5.2
_HEIGHT = 2.4


@dataclass(frozen=True, slots=True)
class First:
    """What stands first in a report."""

    section: block.Section
    figures: dict[str, Figure]
    measures: tuple[Measure, ...]  #: What was computed of the leg; invariants among them.


def asked(result: FitResult) -> str:
    """What was asked for, in a line: of which recordings, by which model, with what changed."""
    inputs = result.problem.inputs
    seconds = sum(each.n / each.rate_hz for each in inputs)
    what = inputs[0].name if len(inputs) == 1 else f"{len(inputs)} recordings together"
    text = (
        f"Asked: parameters of one leg from {what}, {short(round(seconds, 1))} s, by model "
        f"{result.problem.settings.model}"
    )
    settings = [
        f"{label} {value if len(value) <= _LONG else 'as listed below'}"
        for label, value in requested(result)
    ]
    whole = f"{text}; {'; '.join(settings)}." if settings else f"{text}."
    return result.problem.options.anatomy.worded(whole)


def first_screen(fit: AssessedFit, traces: Sequence[Traces]) -> First:
    """The grade in a sentence, torque with its parts, the relaxed curve, and a table with ±."""
    result = fit.result
    words = words_in("en", result.problem.options.anatomy)
    failed = result.status == "failed"
    curve = rest_of_fit(fit)
    at, measures = (0.0, ()) if failed else _measures(fit, curve)
    figures = {"first": first_figure(traces)}
    if isinstance(curve, RelaxedCurve):
        by_name = {m.name: m for m in measures}
        figures["relaxed"] = relaxed_figure(curve, by_name, words, width=_WIDTH, height=_HEIGHT)
    elif not failed:
        model = torque_curve(fit)
        figures["relaxed"] = stiffness_figure(
            [], [], model, [], [], words, width=_WIDTH, height=_HEIGHT
        )
    blocks = (
        _torque_picture(traces),
        _relaxed_picture(curve, words),
        _table(measures, at, words),
    )
    return First(block.Section("", blocks, look="first"), figures, measures)


def grade_line(fit: AssessedFit) -> block.AdequacyWords:
    """The grade in a sentence, with the reason that weighs most; all of them stand below."""
    whole = adequacy_words(fit.assessment.adequacy, fit.quality)
    if not whole.reasons:
        return whole
    first, *others = whole.reasons
    more = f" ({len(others)} more below)" if others else ""
    word = whole.sentence.partition(":")[0]
    return block.AdequacyWords(whole.grade, whole.mark, f"{word}: {first.rstrip('.')}{more}.", ())


def _measures(fit: AssessedFit, curve: RelaxedCurve | Message) -> tuple[float, tuple[Measure, ...]]:
    """The angle that leads [deg], and measures at it, in one computation of them.

    A slow stretch of the model's tissue takes as long as all else: it stands where rest tells it.
    """
    at = angle_of(fit)
    slow = False
    if isinstance(curve, RelaxedCurve):
        rated = rated_measures(curve, (at, *ANGLES))
        by_rest = [m.measure for m in rated if m.measure.value is not None]
        at = stated_angle({m.name: m for m in by_rest}, at)
        slow = f"slow_stiffness@{at:g}deg" in {m.name for m in by_rest}
    names = {*_RELAXED, *(definition.name for definition in INVARIANT)}
    names.remove("passive_stiffness" if slow else "slow_stiffness")
    wanted = tuple(
        point
        for point in points([at])
        if point.definition.name in names
        and (point.definition.name != "range_at_torque" or point.name == _AT_TORQUE)
    )
    return at, tuple(m for _, m in judged_measures(fit, wanted))


def _torque_picture(traces: Sequence[Traces]) -> block.Picture:
    caption = "Torque measured (wide, pale) and modelled (thin, dark), and the parts of the latter."
    if len(traces) > SHOWN:
        caption += f" The first {SHOWN} of {len(traces)} recordings; all stand below."
    alt = "Angle, measured and modelled torque, and the parts of the modelled torque, against time."
    return block.Picture("first", alt, caption, "here", 100)


def _relaxed_picture(curve: object, words: Words) -> block.Picture:
    caption = "By the model: these recordings hold no rest that tells it."
    if isinstance(curve, RelaxedCurve):
        caption = "Relaxed leg by its rest alone, foot and plate taken off; bands hold 95 %."
    alt = "Torque of the relaxed leg over the angle, with its 95 % band."
    return block.Picture("relaxed", words(alt), words(caption), "here", 100)


def _table(measures: Sequence[Measure], at: float, words: Words) -> block.Grid:
    """Relaxed measures and invariants that are known, and what is not."""
    relaxed = [m for m in measures if _is_relaxed(m, at)]
    relaxed.sort(key=lambda m: _RELAXED.index(_name(m)))
    muscles = [m for m in measures if is_invariant(m) and _name(m) in MEASURES]
    groups = [
        (words("Relaxed leg"), tuple(_rows(relaxed, words))),
        ("Muscles, whatever arms and paths are", tuple(_rows(muscles, words))),
    ]
    if missing := [m for m in (*relaxed, *muscles) if not is_told(m)]:
        names = ", ".join(_called(m, words) for m in missing)
        groups.append(("", ((block.Cell(why=f"Not known: {names}."),),)))
    heads = block.columns("", "Value", "95 %", "", numbers=(1, 2), wide=(0,))
    return block.Grid("Relaxed measures and invariants", heads, tuple(groups), "measured")


def _name(m: Measure) -> str:
    return m.name.partition("@")[0]


def _is_relaxed(m: Measure, at: float) -> bool:
    base, _, point = m.name.partition("@")
    return base in _RELAXED and (not point.endswith("deg") or point == f"{at:g}deg")


def _rows(measures: Sequence[Measure], words: Words) -> Iterator[block.Row]:
    """Those that are known, a row each."""
    for m in [m for m in measures if is_told(m)][:_MOST]:
        number, ci95 = on_page_of(m)
        assert ci95 is not None
        value, half = with_half(number, ci95)
        yield _called(m, words), value, f"{half} {on_page(m.unit)[0]}", block.verdict(m.verdict)


def _called(m: Measure, words: Words) -> str:
    """What a measure is called, and where, in few letters."""
    base, _, point = m.name.partition("@")
    at = point.replace("deg", "°").replace("Nm", " Nm").replace("-", "−")
    name = words(MEASURES[base], at=at)
    if m.from_deg is None or m.to_deg is None or m.from_deg == m.to_deg:
        return name
    low, high = (f"{end:.0f}°".replace("-", "−") for end in (m.from_deg, m.to_deg))
    return f"{name}, {low} to {high}"
