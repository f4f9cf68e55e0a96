"""How much of a leg's resistance is nerve: the answer of its page, where that was measured."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.formatting import significant
from surae.nerve.leg import Nerve, StretchTorque
from surae.report import block
from surae.report.figures import GREY, RED, Figure, card_legend, dress, new_figure
from surae.report.figures.leg import CARD_WIDTH
from surae.report.figures.nerve import tick
from surae.report.language import Words

#: Stretches whose speed is within this part of the fastest are the fast ones [1].
_ALIKE = 0.15


@dataclass(frozen=True, slots=True)
class _Fast:
    """Means over the fastest stretches of the calf [Nm]."""

    speed: float  #: [deg/s]
    peak: float
    elastic: float
    neural: float | None  #: None where it cannot be told from tissue, or from will.
    low: float
    high: float
    heard: bool  #: Whether EMG says so.


def nerve_card(nerve: Nerve | None, _: Words) -> tuple[tuple[block.Block, ...], dict[str, Figure]]:
    """The answer, and its figures by name; how to measure it where it was not."""
    if nerve is None:
        how = _(
            "Stretch the relaxed ankle five times slowly and five times fast, with EMG of the "
            "calf: 2 min."
        )
        return (block.Text("", "say", _("Not measured")), block.Text(how)), {}
    said = list[tuple[str, str]]()
    blocks = list[block.Block]()
    figures = dict[str, Figure]()
    fast = _fastest(nerve.stretches)
    if fast is not None:
        said.append(_of_stretches(fast, _))
        figures["nerve-stretches"] = stretches_figure(_calf(nerve.stretches), _)
        parts = _("Beside it, elastic tissue: about {elastic} Nm.", elastic=_short(fast.elastic, _))
        alt = _("Torque of tissue and of the reflex over the speed of stretch.")
        blocks.append(block.Picture("nerve-stretches", alt, parts, "here", 100))
    if nerve.threshold is not None and nerve.threshold.value is not None:
        low, high = (f"{end:.0f}°" for end in nerve.threshold.ci95)
        at = _.angle(round(nerve.threshold.value))
        span = _.span(low, high).replace("-", "−")
        blocks.append(
            block.Text(
                _(
                    "The calf would answer a very slow stretch from {at} on (95 %: {span}).",
                    at=at,
                    span=span,
                )
            )
        )
    if nerve.reflex is not None:
        said.append(_of_perturbations(nerve, _))
        stiff = nerve.stiffness
        if stiff is not None and stiff.value is not None:
            value, *ends = (_short(float(np.deg2rad(v)), _) for v in (stiff.value, *stiff.ci95))
            span = _.span(*ends)
            blocks.append(
                block.Text(
                    _(
                        "Tissue and muscle resisted small movements by {value} Nm/° ({span}).",
                        value=value,
                        span=span,
                    )
                )
            )
    if not said:
        said.append((_("Cannot tell"), _("these recordings do not separate tissue and reflex")))
    first, *others = said
    lines = [block.Text(first[1], "say", first[0])]
    for lead, text in others:  # a number goes on as a sentence does
        lines.append(block.Text(f"{text}.", lead=f"{lead} –" if lead == _("Cannot tell") else lead))
    if _.language == "en":
        blocks += [block.Text(f"{problem}.", "note") for problem in nerve.problems]
    return (*lines, *blocks), figures


def stiffness_of(nerve: Nerve | None, _: Words) -> tuple[block.Block, ...]:
    """Stiffness against small movements, where that alone was measured; empty where it was not."""
    stiff = None if nerve is None else nerve.stiffness
    if stiff is None or stiff.value is None:
        return ()
    value, low, high = (_short(float(np.deg2rad(v)), _) for v in (stiff.value, *stiff.ci95))
    text = _(
        "against small random movements, tissue and muscle together · 95 %: {span}",
        span=_.span(low, high),
    )
    how = _("At rest: record one slow relaxed movement over the whole range, 30 s.")
    return block.Text(text, "say", f"{value} Nm/°"), block.Text(how)


def _calf(stretches: Sequence[StretchTorque]) -> list[StretchTorque]:
    return [s for s in stretches if s.direction == "dorsiflexion"]


def _fastest(stretches: Sequence[StretchTorque]) -> _Fast | None:
    """Means of the fastest stretches of the calf.

    What is wrong in all repeats alike does not get less by averaging: the ends of their intervals
    are averaged too.
    """
    calf = _calf(stretches)
    if not calf:
        return None
    top = max(s.speed for s in calf)
    fastest = [s for s in calf if s.speed >= (1.0 - _ALIKE) * top]
    answered = [s.neural for s in fastest if s.neural is not None]
    neural = float(np.mean(answered)) if len(answered) == len(fastest) else None
    low, high = np.mean([s.ci95 or (0.0, s.peak) for s in fastest], axis=0).tolist()
    speed, peak, elastic = np.mean([(s.speed, s.peak, s.elastic) for s in fastest], axis=0).tolist()
    heard = all(s.heard for s in fastest)
    return _Fast(speed, peak, elastic, neural, low, high, heard)


def _of_stretches(fast: _Fast, _: Words) -> tuple[str, str]:
    """What fast stretches say: a headline, and where it holds."""
    speed = f"{fast.speed:.0f}"
    if fast.neural is None and not fast.heard:
        return _("Cannot tell"), _(
            "without EMG, stretches do not show how much is reflex; record the calf’s EMG"
        )
    span = _.span(_short(max(fast.low, 0.0), _), _short(fast.high, _))
    if fast.neural == 0.0:  # no muscle was heard to answer
        return _("No reflex seen"), _(
            "at most {most} of {peak} Nm in stretches at {speed} °/s",
            most=_short(fast.high, _),
            peak=_short(fast.peak, _),
            speed=speed,
        )
    if fast.neural is None or fast.low <= 0.0:
        return _("Cannot tell"), _(
            "{span} Nm of reflex in stretches at {speed} °/s", span=span, speed=speed
        )
    about = _(
        "of reflex in stretches at {speed} °/s, of {peak} Nm at their peak · 95 %: {span}",
        speed=speed,
        peak=_short(fast.peak, _),
        span=span,
    )
    if not fast.heard:
        about += " · " + _("probably: no EMG was recorded")
    return f"{_short(fast.neural, _)} Nm", about


def _of_perturbations(nerve: Nerve, _: Words) -> tuple[str, str]:
    """What small random movements say."""
    share = nerve.share
    most = "" if share is None or not np.isfinite(share.ci95[1]) else _short(share.ci95[1], _)
    if nerve.reflex == "present" and share is not None and share.value is not None:
        value, *ends = (_short(v, _) for v in (share.value, *share.ci95))
        way = _("dorsiflexion") if nerve.direction == "dorsiflexion" else _("plantarflexion")
        return f"{value} %", _(
            "of the torque’s changes in small random movements are a reflex to "
            "{way} · 95 %: {span}",
            way=way,
            span=_.span(*ends),
        )
    if nerve.reflex == "none seen" and most:
        return _("No reflex seen"), _(
            "in small random movements: at most {most} % of the torque’s changes", most=most
        )
    return _("Cannot tell"), _("small random movements do not show whether there is a reflex")


def _short(value: float, _: Words) -> str:
    return _.number(significant(value, 2))


def stretches_figure(stretches: Sequence[StretchTorque], _: Words) -> Figure:
    """Elastic and neural torque [Nm] of each stretch over its speed, the latter with its interval.

    The viscous one is not drawn: beside a reflex it may be off by as much as itself.
    """
    figure = new_figure(2.6, width=CARD_WIDTH)
    axes = figure.subplots()
    for label, values, colour, mark in (
        (_("elastic"), [s.elastic for s in stretches], GREY, "s"),
        (_("reflex"), [s.neural for s in stretches], RED, "o"),
    ):
        points = [(s.speed, v) for s, v in zip(stretches, values, strict=True) if v is not None]
        if points:
            axes.plot(*zip(*points, strict=True), mark, color=colour, ms=4, label=label)
    for s in stretches:
        if s.ci95 is not None:
            axes.plot([s.speed] * 2, s.ci95, color=RED, linewidth=0.8)
    dress(axes, _("Torque [Nm]"), _("Speed of stretch [°/s]"))
    axes.set_ylim(bottom=min(axes.get_ylim()[0], 0.0))
    axes.set_xlim(0.0, 1.08 * max(s.speed for s in stretches))
    tick(axes, _)
    card_legend(axes, columns=3, size=8)
    return figure
