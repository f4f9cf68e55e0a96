"""The thesis's simulation study (2.5, 3.1): which motion and task determine the parameters best.

`grid` asks for the fits, which are `cells`; `rules` decide the claims.
"""

from surae import ComputationError
from surae_thesis.claims import judge_all, turned
from surae_thesis.legs import STRAIN
from surae_thesis.section import Context, Result, Table
from surae_thesis.simulation.cells import SIGNED, Study
from surae_thesis.simulation.figures import drawings
from surae_thesis.simulation.grid import studies

#: Modules whose functions decide the claims.
RULES = (f"{__name__}.rules",)


def run(context: Context) -> Result:
    """Run the studies and judge the claims."""
    views = studies(context)
    if not views[SIGNED].grid:
        raise ComputationError("simulation-grid: no fit succeeded")
    findings = judge_all("simulation", views, *RULES)
    return Result(
        findings=findings,
        insights=(turned(findings, SIGNED, STRAIN),),
        figures=drawings(views[SIGNED]),
        tables=(_grid(views[SIGNED]),),
        notes=_notes(context, views[SIGNED]),
    )


def _notes(context: Context, study: Study) -> tuple[str, ...]:
    factors = {cell.factor for cell in study.grid if cell.factor}
    subjects = len({cell.subject for cell in study.others})
    quick = " Quick: fewer factors and subjects than the thesis's." if context.quick else ""
    return (
        "Five profiles by four amplitudes by "
        f"{len(factors)} factors of the chirp A·sin(s·t²) by two tasks by two models make "
        f"{len(study.grid):,} distinct fits, since the factor does not matter without a chirp; "
        f"{study.failed} gave no estimates.{quick} One virtual leg (seed {context.seed}), its "
        "parameters drawn from the healthy ranges, since the thesis does not print its own; "
        f"{subjects} legs where a claim depends on the leg. 256 Hz (2.1); the thesis's explicit "
        "scheme at 1000 Hz (4.4). Two starts per fit, neither the truth.",
        "The first column is the reading that decides: noise of 5 % of each signal's mean, the "
        "torque's with its sign (2.5.3). The others show what hangs on it: noise of the mean "
        "magnitude (VAF and SEM follow from the fits by equation (34)), the tendon's ε0 as a "
        "strain, which Table 2 calls it, where the printed equations take metres, an effort in "
        "which the heads of the triceps take turns, and the thesis's integrator with an optimiser "
        "of its kind.",
    )


def _grid(study: Study) -> Table:
    """Every fit of the grid."""
    names = tuple(study.grid[0].off)
    rows = tuple(
        (
            c.model,
            c.profile,
            c.task,
            c.amplitude,
            c.factor,
            c.vaf,
            c.ipde,
            *(c.sem.get(n) for n in names),
            *(c.off.get(n) for n in names),
        )
        for c in study.grid
    )
    return Table(
        name="simulation-grid",
        title="All fits of the grid",
        columns=(
            "model",
            "profile",
            "task",
            "chirp_amplitude",
            "chirp_factor",
            "vaf",
            "ipde",
            *(f"{n}_sem" for n in names),
            *(f"{n}_error" for n in names),
        ),
        rows=rows,
        long=True,
    )
