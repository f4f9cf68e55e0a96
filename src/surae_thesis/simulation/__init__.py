"""The thesis's simulation study (2.5, 3.1): which motion and task determine the parameters best.

`grid` runs the studies, `claims` has a row for each claim, `figures` draws.
"""

from surae_thesis.section import Context, Result, Section

__all__ = ["SECTION"]


def _run(context: Context) -> Result:
    from surae_thesis.simulation.study import reproduce

    return reproduce(context)


SECTION = Section(
    name="simulation",
    title="Simulation study",
    source="2.5, 3.1, 4.1; Figures 11–16",
    run=_run,
)
