"""The thesis's simulation study (2.5, 3.1): which motion and task determine the parameters best.

`grid` runs the studies, whose fits are `cells`; `rules` and `choices` decide the claims.
"""

from collections.abc import Mapping

import numpy as np

from surae import ComputationError
from surae_thesis.claims import judge_all
from surae_thesis.section import Context, Result, Row, Table
from surae_thesis.simulation.cells import (
    CHOSEN_AMPLITUDE,
    CHOSEN_FACTOR,
    EQUAL,
    MAGNITUDE,
    MODELS,
    PROFILES,
    SIGNED,
    Study,
    along_profile,
    scores,
    select,
)
from surae_thesis.simulation.figures import drawings
from surae_thesis.simulation.grid import studies

#: Modules whose functions decide the claims.
RULES = (f"{__name__}.rules", f"{__name__}.choices")


def run(context: Context) -> Result:
    """Run the studies and judge the claims."""
    views, rows = studies(context)
    if not views[MAGNITUDE].grid:
        raise ComputationError("simulation-grid: no fit succeeded; see `surae study status`")
    return Result(
        findings=judge_all("simulation", views, *RULES),
        figures=drawings(views),
        tables=(_chosen(views[MAGNITUDE]), _grid(rows)),
        notes=_notes(context, rows, views),
    )


def _notes(context: Context, rows: list[Row], views: Mapping[str, Study]) -> tuple[str, ...]:
    study = views[MAGNITUDE]
    factors = {cell.factor for cell in study.grid if cell.factor}
    subjects = len({cell.subject for cell in study.others})
    quick = " Quick: fewer factors and subjects than the thesis's." if context.quick else ""
    return (
        f"The grid has {len(rows):,} combinations: five profiles by four amplitudes by "
        f"{len(factors)} factors of the chirp A·sin(s·t²) by two tasks by two models, "
        f"{len(study.grid):,} distinct fits, since the factor is irrelevant without a chirp; "
        f"{study.failed} rows gave no fit.{quick} One virtual subject (seed {context.seed}), its "
        "parameters drawn from the healthy ranges, since the thesis does not give its own; "
        f"{subjects}, it among them, for what hangs on one. Two starts per fit, neither the "
        "truth.",
        "White noise of 5 % of each signal's mean is added to EMG and torque after simulating "
        "(2.5.3). The torque changes its sign, so that its mean can be read as the signed one, "
        "which is the literal reading; as the mean magnitude, with which the grid is fitted; or "
        "as a level that is equal in every cell. VAF and SEM under the other two follow from the "
        f"fits, equation (34); {_agreement(views)} IPDE does not depend on the level.",
    )


def _agreement(views: Mapping[str, Study]) -> str:
    """How far what `under` says of a SEM is from real fits under another reading."""
    told = []
    for reading in (SIGNED, EQUAL):
        real: dict[tuple[str, float | None], list[float]] = {}
        for cell in views[reading].noise:
            if "k_tri" in cell.sem:
                real.setdefault((cell.profile, cell.factor), []).append(cell.sem["k_tri"])
        cells = select(views[reading].grid, model="muscle", task="part-passive", amplitude=0.1)
        ratio = [
            cell.sem["k_tri"] / float(np.mean(real[cell.profile, cell.factor]))
            for cell in cells
            if (cell.profile, cell.factor) in real and "k_tri" in cell.sem
        ]
        if ratio:
            told.append(f"{reading} {100 * float(np.median(np.abs(np.array(ratio) - 1))):.1f} %")
    return (
        "at 0.1 rad they were also fitted, and the SEMs of k_tri agree within (median) "
        f"{', '.join(told)}."
    )


def _chosen(study: Study) -> Table:
    """The profiles at the chosen chirp."""
    lines = []
    for model in MODELS:
        some = along_profile(study.grid, model)
        for cell, score in zip(some, scores(some), strict=True):
            same = select(
                study.others, model=model, profile=cell.profile, amplitude=CHOSEN_AMPLITUDE,
                task="part-passive",
            )  # fmt: skip
            more = [other.ipde for other in same if other.ipde is not None]
            worst, off = cell.worst
            lines.append(
                (
                    model, cell.profile, round(cell.vaf, 3), round(float(score), 3),
                    None if cell.ipde is None else round(cell.ipde, 2),
                    round(float(np.median(more)), 2) if more else None,
                    f"{worst} {100 * off:.0f} %",
                )
            )  # fmt: skip
    return Table(
        name="simulation-profiles",
        title=f"Profiles at the chosen chirp, {CHOSEN_AMPLITUDE:g} rad and factor "
        f"{CHOSEN_FACTOR:g}, part-passive",
        columns=(
            "model", "profile", "VAF [%]", "mean SEM / mean over profiles [-]", "IPDE [-]",
            "median IPDE of the other subjects [-]", "worst estimate",
        ),
        rows=tuple(lines),
    )  # fmt: skip


def _grid(rows: list[Row]) -> Table:
    """The whole grid, without the time that it took."""
    columns = tuple(name for name in rows[0] if name != "seconds")
    return Table(
        name="simulation-grid",
        title=f"All fits of the grid: {len(PROFILES)} profiles",
        columns=columns,
        rows=tuple(tuple(row[name] for name in columns) for row in rows),
        long=True,
    )
