"""Whether a leg's number is normal: where it lies among legs that were measured, beside it."""

from collections.abc import Sequence

from surae.measures import Measures
from surae.measures.norms import Norm, Placed, placed
from surae.report import block
from surae.report.language import Words


def beside(number: block.Text, of_fit: Measures, known: Sequence[Norm], _: Words) -> block.Section:
    """An answer's number with its place among the first group in letters as large beside it."""
    return block.Section("", (number, _normal(of_fit, known, _)), look="pair")


def _normal(of_fit: Measures, known: Sequence[Norm], _: Words) -> block.Text:
    groups = [norm for norm in known if "healthy" in norm.group] or list(known)
    among = placed(of_fit, groups)
    if among:
        return _among(among[0], of_fit, _)
    angles = sorted({norm.measure.partition("@")[2] for norm in groups})
    if not angles:
        return block.Text(_("No group of legs was measured."), "say", _("Normal? Not known"))
    at = _.point(groups[0].measure)
    text = _("Move the relaxed ankle slowly past {at}: healthy adults were measured there.", at=at)
    return block.Text(text, "say", _("Normal? Not known"))


def _among(p: Placed, of_fit: Measures, _: Words) -> block.Text:
    """Which part of a group lies below, at both ends of the leg's own interval too."""
    below = p.text if p.ends is None else f"{p.text} ({_.span(*p.ends)})"
    own, _span = _.estimate(p.value, of_fit[p.norm.measure].ci95)
    text = _(
        "of {n} {group} lie below · {measure}: {value} {unit} ({reference})",
        n=str(p.norm.n),
        group=", ".join(filter(None, [_(p.norm.group), p.norm.age, p.norm.sex])),
        measure=_.measure(p.norm.measure),
        value=own,
        unit=p.norm.unit.replace("deg", "°"),
        reference=p.norm.reference,
    )
    return block.Text(text, "say", below)
