"""The movements and efforts of the thesis: Figures 2, 3, 6 to 9 and 36 to 38.

`claims` judges what the thesis says of them, `figures` draws them.
"""

from surae.reproduction.chapter import Context, Result, Section
from surae.reproduction.protocols.claims import durations, findings
from surae.reproduction.protocols.figures import drawings


def run(context: Context) -> Result:
    """Generate every movement and effort, judge and draw them."""
    context.progress("protocols", 0, 1)
    result = Result(
        findings=findings(),
        figures=drawings(),
        tables=(durations(),),
        notes=(
            "The thesis prints its movements as figures without tables. Where an instant, a speed "
            "or a hold's position cannot be read from them it is our choice; the durations, the "
            "range of motion, the chirp and its placement are the thesis's. Angles run from full "
            "plantarflexion (0 rad in the thesis's figures) to full dorsiflexion (1.5 rad).",
        ),
    )
    context.progress("protocols", 1, 1)
    return result


SECTION = Section(
    name="protocols",
    title="Movements and efforts",
    source="2.1, 2.5, 4.1.5; Figures 2, 3, 6–9, 36–38",
    run=run,
)
