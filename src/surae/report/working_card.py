"""How stiff a leg is while it works, of a leg that was never at rest: steps under load."""

from dataclasses import dataclass

from surae.base.formatting import short, significant
from surae.measures.working import WorkingStiffness
from surae.report import block
from surae.report.figures import Figure
from surae.report.figures.working import working_figure
from surae.report.language import Words


@dataclass(frozen=True, slots=True)
class WorkingCard:
    """The answer by steps, and its figure."""

    said: tuple[block.Block, ...]
    picture: block.Picture
    figure: Figure


def working_card(trial: str, steps: WorkingStiffness, _: Words) -> WorkingCard:
    """What steps of a trial tell, what they do not, and their picture."""
    value, low, high = (_.number(significant(each, 2)) for each in (steps.value, *steps.span))
    from_deg, to_deg = (_.number(short(round(each))) for each in (steps.from_deg, steps.to_deg))
    where = _(
        "while the calf works and gives way from {from_deg}° to {to_deg}°, median of {n} steps · "
        "95 % of them: {span}",
        from_deg=from_deg,
        to_deg=to_deg,
        n=str(steps.steps),
        span=_.span(low, high),
    )
    blocks = (
        block.Text(where, "say", f"{value} Nm/°"),
        block.Text(
            _(
                "Muscles make most of this: it is no stiffness of the relaxed ankle. For that, "
                "record one slow relaxed movement over the whole range: 30 s."
            )
        ),
    )
    caption = _(
        "{trial}: mean over {n} steps, largest torque {peak} Nm. The thick line is its slope.",
        trial=trial,
        n=str(steps.steps),
        peak=_.number(f"{steps.peak:.0f}"),
    )
    alt = _("Torque of the ankle over its angle while it steps.")
    picture = block.Picture("stiffness", alt, caption, "here", 100)
    return WorkingCard(blocks, picture, working_figure(steps, _))
