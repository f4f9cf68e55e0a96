"""The first card of a leg's page where its rest tells how stiff it is: one number, one curve."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from surae.base.formatting import short
from surae.inference import AssessedFit, Grade
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures import Measure, Measures
from surae.measures.at_rest import rest_of_fit
from surae.measures.norms import Norm
from surae.report import block
from surae.report.figures import Figure
from surae.report.figures.leg import CARD_WIDTH
from surae.report.figures.relaxed import relaxed_figure
from surae.report.language import Words
from surae.report.leg_cards import is_known
from surae.report.normal import beside

#: What leads: as a device would measure it, and what is least touched by how tissue relaxes.
_LEADS = "slow_stiffness"


@dataclass(frozen=True, slots=True)
class RestCard:
    """The answer by rest, and its figure."""

    said: tuple[block.Block, ...]
    picture: block.Picture
    figure: Figure
    doubt: str = ""  #: Why rest is believed with caution.


def stated_angle(of_fit: Mapping[str, Measure], at: float) -> float:
    """Where stiffness is given: at `at` [deg], or the nearest angle at which rest tells it."""
    angles = [
        float(m.name.partition("@")[2].removesuffix("deg")) for m in of_fit.values() if _tells(m)
    ]
    return min(angles, key=lambda angle: abs(angle - at), default=at)


def rest_card(
    fit: AssessedFit, of_fit: Measures, at: float, known: Sequence[Norm], _: Words
) -> RestCard | None:
    """The card of a leg whose rest tells its stiffness at an angle [deg]; None for others."""
    m = of_fit.get(f"{_LEADS}@{at:g}deg")
    curve = rest_of_fit(fit)
    if m is None or not isinstance(curve, RelaxedCurve) or not _tells(m):
        return None
    assert m.value is not None
    value, span = _.estimate(m.value, m.ci95)
    angle = _.number(short(at))
    where = _(
        "at {angle}°, slowly stretched, measured at rest · 95 %: {span}", angle=angle, span=span
    )
    very = [norm for norm in known if norm.measure == m.name]
    others = [norm for norm in known if norm not in very]
    number = block.Text(where, "say", f"{value} Nm/°")
    lines = beside(number, of_fit, [*very, *others], _, m.name)
    if m.ci95_device is not None:
        _value, device = _.estimate(m.value, m.ci95_device)
        text = _("At this angle as the device shows it: {span}.", span=device)
        lines.append(block.Text(text, "note"))
    doubt = ""
    if curve.grade is not Grade.ADEQUATE:
        reason = doubt = _(curve.findings[0]).rstrip(".")
        lines.append(block.Text(_("With caution: {reason}.", reason=reason), "note"))
    elif of_fit.adequacy.grade is not Grade.ADEQUATE:
        text = _("No muscle is in this number: doubts about the fit do not touch it.")
        lines.append(block.Text(text, "note"))
    picture = block.Picture(
        "stiffness",
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
    behind = [norm for norm in known if norm.measure.startswith("slow_torque@")]
    behind = [norm for norm in behind if "healthy" in norm.group]
    figure = relaxed_figure(curve, of_fit, _, behind=behind, width=CARD_WIDTH)
    return RestCard(tuple(lines), picture, figure, doubt)


def _tells(m: Measure) -> bool:
    """Whether it is the leading measure, and rest tells it."""
    return m.name.startswith(f"{_LEADS}@") and m.basis == "rest" and is_known(m)
