"""The simulation section: studies, claims, figures, tables."""

from collections.abc import Callable, Sequence

from surae.errors import ComputationError
from surae.reproduction.chapter import Context, Result, Table
from surae.reproduction.claims import Claim, Finding, unchecked
from surae.reproduction.fits import Row, study_rows
from surae.reproduction.simulation import choice, dependency, goodness, precision
from surae.reproduction.simulation.along import along_profile
from surae.reproduction.simulation.cells import Cell, NoFitError, at_chirp, cells, scores, select
from surae.reproduction.simulation.designs import (
    CHOSEN_AMPLITUDE,
    CHOSEN_RATE,
    MODELS,
    PROFILES,
    RATE_HZ,
    designs,
)
from surae.reproduction.simulation.figures import drawings
from surae.reproduction.simulation.torques import with_torques


def reproduce(context: Context) -> Result:
    """Run the studies and judge the claims."""
    asked = designs(context)
    rows = study_rows(context, asked.grid)
    grid = cells(rows)
    if not grid:
        raise ComputationError("simulation-grid: no fit succeeded; see `surae study status`")
    noise = cells(study_rows(context, asked.noise))
    patients = cells(study_rows(context, asked.patients))
    others = cells(study_rows(context, asked.others))
    grid, others = (
        with_torques(context, f"simulation-torque-{name}", found, "healthy", RATE_HZ)
        for name, found in (("grid", grid), ("others", others))
    )
    patients = with_torques(context, "simulation-torque-patients", patients, "patient", RATE_HZ)
    explicit = [
        (rate, cells(study_rows(context, text)))
        for rate, text in zip((125, 1000), asked.explicit, strict=True)
    ]
    return Result(
        findings=tuple(findings(grid, noise, patients, others, explicit)),
        figures=drawings(grid, noise, explicit),
        tables=(_chosen(grid, others), _cells(rows)),
        notes=_notes(context, rows, grid, others),
    )


def findings(
    grid: Sequence[Cell],
    noise: Sequence[Cell],
    patients: Sequence[Cell],
    others: Sequence[Cell],
    explicit: Sequence[tuple[int, Sequence[Cell]]],
) -> list[Finding]:
    """Every claim of the simulation study, in the thesis's order."""
    passive = select(grid, task="part-passive")
    found: list[Finding] = []
    judges: tuple[tuple[tuple[Claim, ...], Callable[[], list[Finding]]], ...] = (
        ((goodness.MUSCLE_VAF,), lambda: [goodness.muscle_vaf(grid)]),
        ((goodness.TENDON_VAF,), lambda: [goodness.tendon_vaf(grid)]),
        ((goodness.THRESHOLD,), lambda: [goodness.threshold(grid)]),
        (goodness.FAILURES, lambda: goodness.failures(grid, explicit)),
        (goodness.NOISE, lambda: goodness.noise(noise)),
        ((precision.TASK,), lambda: [precision.task(grid)]),
        ((dependency.TASK,), lambda: [dependency.task(grid)]),
        (precision.BY_RATE, lambda: precision.rates(grid)),
        (precision.BY_AMPLITUDE, lambda: precision.amplitudes(grid, others)),
        (precision.BY_PROFILE, lambda: precision.profiles(grid, others)),
        (dependency.BY_PROFILE, lambda: dependency.values(grid, others)),
        (dependency.BY_CHIRP, lambda: dependency.chirp(grid)),
        ((choice.SPEED,), lambda: [choice.speed(dict(grid[0].truth))]),
        (choice.PATIENTS, lambda: choice.patients(passive, patients)),
        (choice.CHOICES, lambda: choice.chosen(grid)),
    )
    for claims, judge in judges:
        try:
            found += judge()
        except NoFitError as error:
            found += [unchecked(claim, f"A fit that it needs failed: {error}.") for claim in claims]
    return found


def _notes(
    context: Context, rows: Sequence[Row], grid: Sequence[Cell], others: Sequence[Cell]
) -> tuple[str, ...]:
    failed = sum(row["status"] == "failed" for row in rows)
    rates = sorted({cell.rate for cell in grid if cell.rate})
    subjects = len({cell.subject for cell in others})
    quick = (
        " Quick: fewer chirp rates and subjects than the thesis's grid." if context.quick else ""
    )
    return (
        f"The grid has {len(rows):,} combinations: five profiles by four amplitudes by "
        f"{len(rates)} chirp rates by two tasks by two models. They are {len(grid):,} distinct "
        f"fits, since the rate is irrelevant without a chirp; {failed} rows gave no fit.{quick} "
        f"One virtual subject (seed {context.seed}), its parameters drawn from the healthy ranges, "
        "since the thesis does not give its own. White noise of 5 % of each signal's mean "
        "magnitude is added to the four EMG channels and the torque after simulating. Two starts "
        "per fit, neither of them the truth.",
        f"Conclusions that hang on the one subject are tried again on {subjects} virtual subjects "
        "drawn from the same ranges. Verdicts follow the grid, by the rule given with each claim. "
        "Claims about SEM are judged again at equal noise in every cell, the SEM divided by the "
        "noise that was added, which is what the motion alone does; and with noise of the torque's "
        "signed mean, the other reading of 2.5.3, to which the chirp's inertia adds nothing.",
    )


def _chosen(grid: Sequence[Cell], others: Sequence[Cell]) -> Table:
    """The profiles at the chosen chirp."""
    lines = []
    for model in MODELS:
        some = along_profile(grid, model)
        for cell, score in zip(some, scores(some), strict=True):
            same = at_chirp(
                others, CHOSEN_AMPLITUDE, CHOSEN_RATE, model=model, profile=cell.profile
            )
            more = [one.ipde for one in same]
            told = sorted(value for value in more if value is not None)
            middle = told[len(told) // 2] if told else None
            lines.append(
                (
                    model,
                    cell.profile,
                    round(cell.vaf, 3),
                    round(float(score), 3),
                    None if cell.ipde is None else round(cell.ipde, 2),
                    None if middle is None else round(middle, 2),
                    f"{cell.worst[0]} {100 * cell.worst[1]:.0f} %",
                )
            )
    return Table(
        name="simulation-profiles",
        title=f"Profiles at the chosen chirp, {CHOSEN_AMPLITUDE:g} rad and {CHOSEN_RATE:g}, "
        "part-passive",
        columns=(
            "model",
            "profile",
            "VAF [%]",
            "mean SEM / mean over profiles [-]",
            "IPDE [-]",
            "median IPDE of the other subjects [-]",
            "worst estimate",
        ),
        rows=tuple(lines),
    )


def _cells(rows: Sequence[Row]) -> Table:
    """The whole grid, without the time that it took."""
    columns = tuple(name for name in rows[0] if name != "seconds")
    return Table(
        name="simulation-grid",
        title=f"All fits of the grid: {len(PROFILES)} profiles",
        columns=columns,
        rows=tuple(tuple(row[name] for name in columns) for row in rows),
        long=True,
    )
