"""Answers of a leg's page in words: stiffness, what resists, and what changed."""

from collections.abc import Sequence

import numpy as np

from surae.base.formatting import NO_NUMBER, short, significant
from surae.base.units import on_page
from surae.inference import AssessedFit, Grade, Verdict
from surae.inference.judging.reasons import Reason
from surae.measures import Measure, Measures
from surae.measures.change.result import Change
from surae.measures.difference import ChangeVerdict, Difference
from surae.measures.norms import Norm
from surae.measures.table import LEADING
from surae.measures.torque_curve import MeasuredSlope
from surae.nerve.leg import Nerve
from surae.report import block
from surae.report.language import PARTS, Words
from surae.report.normal import beside

#: What a part of the torque is called, its share and the share's interval [%].
Part = tuple[str, float, tuple[float, float] | None]
#: What is compared between visits, chosen before any is seen; the first leads.
COMPARED = LEADING
#: A share that is known no better than this cannot be separated from the others [% of the torque].
_UNSURE = 30.0
#: Parameters that the stiffness of a relaxed ankle rests on.
PASSIVE = {"k_tri", "x0_tri", "k_tib", "x0_tib", "k_rel"}
#: Calf muscles among the channels of the EMG.
_CALF = slice(1, 4)
#: A part is most of the torque where all of its interval is above this [%].
_HALF = 50.0
#: Part of a value below which the lower end of its interval is next to nothing.
_NOTHING = 0.1
#: Share of the torque from which a part is written [%].
_WRITTEN = 1.0


def is_known(m: Measure) -> bool:
    """Whether a measure is known well enough to be shown as a number."""
    return m.ci95 is not None and m.verdict in (Verdict.IDENTIFIED, Verdict.WEAK)


def is_told(m: Measure) -> bool:
    """Whether it is known, and not from next to nothing up: that tells an upper end at most."""
    if m.value is None or m.ci95 is None or not is_known(m):
        return False
    near = m.ci95[0] if m.value > 0.0 else -m.ci95[1]
    return m.unit == "deg" or near >= _NOTHING * abs(m.value)


def modelled_stiffness(
    m: Measure, of_fit: Measures, known: Sequence[Norm], slope: MeasuredSlope | None, _: Words
) -> tuple[block.Block, ...]:
    """The model's stiffness, which the recordings show; beside it norms and the measured slope."""
    assert m.value is not None
    value, span = _.estimate(m.value, m.ci95)
    where = _("{range}, relaxed · 95 %: {span}", range=over(m, _), span=span)
    number = block.Text(where, "say", f"{value} Nm/°")
    lines = beside(number, of_fit, known, _, m.name)
    if slope is not None:
        lines.append(block.Text(_("Measured slope: {slope}.", slope=slope_text(slope, _))))
    return tuple(lines)


def measured_stiffness(
    slope: MeasuredSlope | None,
    modelled: Measure | None,
    disputed: Reason | None,
    _: Words,
    *,
    without_weight: bool = False,
) -> tuple[block.Block, ...]:
    """The measured slope where there is one, and why not what is `modelled`: what is `disputed`.

    `without_weight`: whether the weight that the model found was taken out of what was measured.
    """
    if slope is None:
        return (
            block.Text("", "say", _("Not measured")),
            block.Text(_("Record one slow relaxed movement over the whole range: 30 s.")),
        )
    why = _("The model cannot yet separate stiffness from the rest.")
    if disputed is not None and modelled is not None and modelled.value is not None:
        value, span = _.estimate(modelled.value, modelled.ci95)
        why = _(
            "The model’s stiffness {range}, {value} Nm/° ({span}), does not stand: {reason}.",
            value=value,
            range=over(modelled, _),
            span=span,
            reason=_(disputed.plain),
        )
    value, origin = _slope(slope, _)
    weight = _("This is the measured slope; it includes the foot’s weight.")
    if without_weight:
        weight = _("This is the measured slope, without the foot’s weight.")
    return block.Text(origin, "say", value), block.Text(f"{weight} {why}")


def stiffness_picture(
    holds: int, stretches: int, zero: float, _: Words, *, without_weight: bool
) -> block.Picture:
    """Torque over angle, and what was measured of it."""
    seen = []
    if holds:
        seen.append(_.many("{n} held angle", "{n} held angles", holds))
    if stretches:
        seen.append(_.many("{n} slow stretch", "{n} slow stretches", stretches))
    caption = _("No passive trial was recorded.")
    if seen:
        caption = _("Measured: {what}.", what=", ".join(seen))
    if without_weight:
        caption += " " + _("The foot’s weight is taken out.")
    if zero:
        number = _.number(significant(zero, 3))
        caption += " " + _(
            "One torque offset, {zero} Nm, is subtracted from every trial.", zero=number
        )
    alt = _("Measured torque of the relaxed ankle over its angle, with the model’s curve.")
    return block.Picture("stiffness", alt, caption, "here", 100)


def slope_text(slope: MeasuredSlope, _: Words) -> str:
    """A measured slope with what it was taken from."""
    return " ".join(_slope(slope, _))


def _slope(slope: MeasuredSlope, _: Words) -> tuple[str, str]:
    value = _.number(significant(slope.value, 2))
    origin = _between(slope.low, slope.high, _)
    if slope.holds:
        origin += ", " + _.many("{n} held angle", "{n} held angles", slope.holds)
    if slope.interval is not None:
        span = _.span(*(significant(end, 2) for end in slope.interval))
        if slope.holds:
            origin += f" · 95 %: {span}"
        else:
            origin += " " + _("in a slow stretch · {span} in both directions", span=span)
    return f"{value} Nm/°", origin


def _between(low: float, high: float, _: Words) -> str:
    """From one angle to another."""
    ends = (_.number(short(round(each, 1))) for each in (low, high))
    return _("from {low}° to {high}°", **dict(zip(("low", "high"), ends, strict=True)))


def over(m: Measure | Difference, _: Words) -> str:
    """What a measure over the range that was moved is taken over; empty for others."""
    if m.from_deg is None or m.to_deg is None:
        return ""
    return (
        _.angle(round(m.to_deg, 1)) if m.from_deg == m.to_deg else _between(m.from_deg, m.to_deg, _)
    )


def parts_of(of_fit: Measures) -> list[Part]:
    """The parts of the torque, their shares and intervals [%]; empty where none is told apart."""
    parts = [(PARTS[name], of_fit[name].value or 0.0, of_fit[name].ci95) for name in PARTS]
    wide = any(ci is None or ci[1] - ci[0] > 2 * _UNSURE for *_, ci in parts[:2])
    return [] if wide else parts


def made_of(
    joint: AssessedFit | None,
    of_fit: Measures | None,
    parts: Sequence[Part],
    _: Words,
    *,
    disputed: bool = False,
    where: str = "",
) -> tuple[block.Block, ...]:
    """The shares of the torque, where the recordings separate them; `where`: in which of them."""
    if joint is None or of_fit is None:
        return (
            block.Text("", "say", _("Not known")),
            block.Text(
                _("Record one trial in which the calf works and rests in turn, with its EMG: 35 s.")
            ),
        )
    why = ""
    if not parts:
        why = _("Record one trial in which the calf works and rests in turn, with its EMG: 35 s.")
        if has_no_calf(joint):
            why = _("Record the same trial with EMG of soleus and both gastrocnemii: 35 s.")
    elif of_fit.adequacy.grade is Grade.INADEQUATE:
        why = _("The fit is not good enough: first do what “Can I trust it?” says.")
    if why:
        return block.Text("", "say", _("Cannot separate")), block.Text(why), _tendon(of_fit, _)
    unheard = has_no_calf(joint)
    headline = share_words(parts, _, unheard=unheard, disputed=disputed)
    numbers = " · ".join(
        f"{_(message)} {value:.0f} % ({_.span(f'{max(ci[0], 0):.0f}', f'{min(ci[1], 100):.0f}')})"
        for message, value, ci in parts
        if ci is not None and value >= _WRITTEN
    )
    alt = _("Shares of the torque: {numbers}", numbers=numbers)
    picture = block.Picture("made", alt, numbers, "here", 100)
    text = _("No EMG of the calf was recorded: tissue may be less, and muscle more.")
    hidden = (block.Text(text, "note"),) if unheard else ()
    said = block.Text(where or _("in these trials"), "say", headline)
    return said, picture, *hidden, _tendon(of_fit, _)


def share_words(
    parts: Sequence[Part], _: Words, *, unheard: bool = False, disputed: bool = False
) -> str:
    """Which of tissue and muscle resists, as far as the intervals of their shares tell.

    A calf that works unheard looks like tissue, or takes from what the tibialis is seen to do: what
    is said of muscle is then the least of it, and nothing of tissue. Where trials dispute the
    stiffness (`disputed`), neither is called more than the other.
    """
    (_tissue, _value, tissue), (_muscle, _other, muscle) = parts[:2]
    low_tissue, high_tissue = tissue or (0.0, 100.0)
    low_muscle, high_muscle = muscle or (0.0, 100.0)
    least = f"{max(low_muscle, 0.0):.0f}"
    claims = (
        (low_tissue > _HALF and not unheard, _("Mostly tissue")),
        (low_muscle > _HALF, _("Mostly active muscle")),
        (low_muscle > high_tissue and not disputed, _("More muscle than tissue")),
        (unheard, _("Muscle: at least {least} %", least=least)),
        (low_tissue > high_muscle and not disputed, _("More tissue than muscle")),
        (min(low_tissue, low_muscle) > 0.0, _("Both tissue and muscle")),
    )
    return next((said for holds, said in claims if holds), _("Not clear which resists more"))


def has_no_calf(joint: AssessedFit) -> bool:
    """Whether a fit has no EMG of the calf."""
    return not any(np.ptp(each.emg[:, _CALF]) for each in joint.result.problem.inputs)


def _tendon(of_fit: Measures, _: Words) -> block.Text:
    m = of_fit.get("tendon_strain_tri@500N")
    if m is None or not is_told(m) or m.value is None:
        return block.Text(
            _("How far the tendon stretches is not known; ultrasound of the muscle would show it."),
            "note",
        )
    value, span = _.estimate(m.value, m.ci95)
    text = _("The calf’s tendon lengthens by {value} % at 500 N ({span}).", value=value, span=span)
    return block.Text(text, "note")


def change_card(
    change: Change | None, _: Words, told: Measure | None = None, nerve: Nerve | None = None
) -> tuple[block.Block, ...]:
    """What changed since another visit, or between two legs, in measures that are fixed.

    Of one visit: from which change on another would show it, in the measure `told`; else below
    which none would, in the stiffness that `nerve` has.
    """
    if change is None:
        again = _("Record the same trials again another day, and add that visit.")
        said = block.Text(_would_show(told, nerve, _), "say", _("One visit"))
        return said, block.Text(again)
    every = {**change.measures, **change.parameters}
    shown = [d for n, d in every.items() if n in COMPARED or d.asked]
    shown += [d for d in change.changed if d not in shown]
    asked = any(d.asked for d in every.values())  # what was asked is what the card answers
    changed = [d.name for d in change.changed if d.asked or not asked]
    if changed:
        how = _("different") if change.legs else _("changed")
        headline = f"{_.measure(changed[0])}: {how}"
    elif change.is_withheld:
        headline = _("Cannot tell")
    elif all(d.verdict is ChangeVerdict.NOT_COMPARABLE for d in every.values()):
        headline = _("Cannot compare")
    else:
        headline = _("Not shown")
    rows = [differing(d, _) for d in shown]
    heads = block.columns(
        _("Measure"), *sides(change, _), _("Difference (95 %)"), numbers=(1, 2), wide=(0,)
    )
    title = _("Fixed beforehand, or changed")
    table = block.Grid(title, heads, block.rows(rows), "small")
    return block.Text(_(change.sentence), "say", headline), table


def _would_show(measure: Measure | None, nerve: Nerve | None, _: Words) -> str:
    """From which change on another visit would show it, or below which not; empty: not known."""
    if measure is not None and measure.sdc is not None and is_known(measure):
        unit, factor = on_page(measure.unit)
        return _(
            "so far. {measure}: a change of {least} {unit} or more would show",
            measure=_.measure(measure.name),
            least=_.number(significant(factor * measure.sdc, 2)),
            unit=unit,
        )
    stiff = None if nerve is None else nerve.stiffness
    if stiff is None or stiff.value is None:
        return ""
    half = 0.5 * float(np.deg2rad(stiff.ci95[1] - stiff.ci95[0]))
    return _(
        "so far. Stiffness against small movements: a change of less than {least} Nm/° would "
        "not show",
        least=_.number(significant(float(np.sqrt(2.0)) * half, 2)),
    )


def sides(change: Change, _: Words) -> tuple[str, str]:
    """What the two sides of a comparison are called."""
    return (_("First leg"), _("Second leg")) if change.legs else (_("Before"), _("After"))


def differing(d: Difference, _: Words) -> tuple[str | block.Cell, ...]:
    """A row of a comparison: what is compared, both values, the difference."""
    factor = on_page(d.unit)[1]
    both = [
        NO_NUMBER if v is None else _.number(significant(factor * v, 3))
        for v in (d.before, d.after)
    ]
    difference = block.Cell(NO_NUMBER)
    if d.difference is not None and d.ci95 is not None:
        low, high = (factor * end for end in d.ci95)
        difference = block.Cell(*_.estimate(factor * d.difference, (low, high)))
    return (titled(d, _), *both, difference)


def on_page_of(m: Measure) -> tuple[float, tuple[float, float] | None]:
    """A measure's value and interval in the unit of pages."""
    factor = on_page(m.unit)[1]
    ci95 = None if m.ci95 is None else (factor * m.ci95[0], factor * m.ci95[1])
    return factor * (m.value or 0.0), ci95


def titled(m: Measure | Difference, _: Words) -> str:
    """What a measure is called, over which range, and with its unit where it has one."""
    unit = on_page(m.unit)[0]
    where = over(m, _)
    name = _.measure(m.name) + (f", {where}" if where else "")
    return f"{name} [{unit}]" if unit else name
