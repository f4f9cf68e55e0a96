"""Whether a leg's number is normal: where it lies among legs that were measured, beside it."""

from collections.abc import Sequence

from surae.base.units import on_page
from surae.inference import Grade
from surae.measures import Measures
from surae.measures.norms import Norm, Placed, placed
from surae.report import block
from surae.report.language import Words


def beside(
    number: block.Text, of_fit: Measures, known: Sequence[Norm], _: Words, own: str = ""
) -> list[block.Block]:
    """An answer's number with its place among the first group in letters as large beside it.

    `own` is the measure that the number is of: where the group's is another, it is named.
    """
    groups = [norm for norm in known if "healthy" in norm.group] or list(known)
    among = [p for p in placed(of_fit, groups) if _stands(of_fit, p.norm.measure)]
    if among:
        place = _among(among[0], of_fit, own, _)
        source = block.Text(among[0].norm.reference, "note")
        return [block.Section("", (number, place), look="pair"), source]
    text = _("No group of people was measured for this.")
    if groups:
        at = _.point(groups[0].measure)
        text = _(
            "Move the relaxed ankle slowly past {at}: healthy adults were measured there.", at=at
        )
    place = block.Text(text, "say", _("Normal? Not known"))
    return [block.Section("", (number, place), look="pair")]


def _stands(of_fit: Measures, name: str) -> bool:
    """Whether a measure is told by rest, or by a fit that nothing speaks against.

    A model that is doubted calls healthy legs that walk stiffer than all.
    """
    return of_fit[name].basis == "rest" or of_fit.adequacy.grade is Grade.ADEQUATE


def _among(p: Placed, of_fit: Measures, headline: str, _: Words) -> block.Text:
    """Which part of a group lies below, at both ends of the leg's own interval too."""
    group = ", ".join(filter(None, [_(p.norm.group), p.norm.age, p.norm.sex]))
    text = _("of {n} {group}", n=str(p.norm.n), group=group)
    if p.ends is not None:
        text += f" · 95 %: {_.span(*p.ends)}"
    if p.norm.measure != headline:
        value, _span = _.estimate(p.value, of_fit[p.norm.measure].ci95)
        unit = on_page(p.norm.unit)[0]
        text += f" · {_.measure(p.norm.measure)}: {value} {unit}"
    return block.Text(text, "say", _("Normal? Above {below}", below=p.text))
