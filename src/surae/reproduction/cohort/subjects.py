"""Section: the thesis's subjects, a virtual cohort in their place (3.2, Figures 17 to 35, 40)."""

from statistics import fmean

from surae.reproduction.chapter import Context, Result, Section
from surae.reproduction.cohort.drawings import (
    explicit_drawing,
    snsem_drawings,
    spectra_drawing,
    trace_drawings,
    vaf_drawings,
)
from surae.reproduction.cohort.evidence import Evidence
from surae.reproduction.cohort.judge_errors import error_findings, spectra_finding
from surae.reproduction.cohort.judge_orders import order_findings
from surae.reproduction.cohort.judge_vaf import vaf_findings
from surae.reproduction.cohort.results import (
    Fits,
    explicit_fits,
    replays,
    spared_fits,
    strengths,
    thesis_fits,
)
from surae.reproduction.cohort.tables import costs_table, fits_table, subjects_table


def run(context: Context) -> Result:
    """Fit the cohort as the thesis fitted its subjects, and judge its claims."""
    fits = thesis_fits(context)
    evidence = Evidence(
        fits,
        spared_fits(context),
        explicit_fits(context),
        strengths(context),
        replays(context, fits),
    )
    spectra, apart = spectra_drawing(fits)
    figures = [*vaf_drawings(fits), *trace_drawings(fits), *snsem_drawings(fits), spectra]
    figures.append(explicit_drawing(fits, evidence.explicit))
    return Result(
        findings=(
            *vaf_findings(evidence),
            *order_findings(evidence),
            *error_findings(evidence),
            spectra_finding(apart),
        ),
        figures=tuple(sorted(figures, key=lambda one: one.name)),
        tables=(subjects_table(fits), costs_table(evidence), fits_table(fits)),
        notes=_notes(fits),
    )


def _notes(fits: Fits) -> tuple[str, ...]:
    size = fits.size
    alone = fmean(found["first_start"] for found in fits.single.values())
    women = sum(m.sex == "female" for m in fits.members)
    finished = ", ".join(
        str(sum(p in m.completed for m in fits.members))
        for p in ("ramp-and-hold", "multiple-holds", "multi-sine-holds")
    )
    return (
        "The thesis's recordings are not public. A virtual cohort stands in: "
        f"{len(fits.members)} subjects ({len(fits.members) - women} men, {women} women, 20 to 30 "
        f"years), {size.repetitions} repetitions; {finished} of them did protocol 1, 2, 3. It was "
        "drawn from a seed before anything was fitted to it, and is a model of the thesis's "
        "subjects, not them: 'holds' says that its pattern is theirs, 'differs' that it is not; "
        "neither is evidence on people.",
        "Its legs are richer than every fitted model: compliant tendons of their own, a stretch "
        "reflex, muscles without electrodes, crosstalk, knee motion, an ankle axis off the "
        "device's, torque noise, effort that differs by repetition; motions are those that the "
        "device can follow. Raw signals of 2048 Hz go through the thesis's preparation to "
        f"{size.rate_hz:g} Hz (2.1).",
        f"Every model was fitted to every recording alone, {len(fits.single)} fits of "
        f"{size.starts} start{'' if size.starts == 1 else 's'}; {fits.failed} reached no minimum; "
        f"the default start alone finds the best one in {100 * alone:.0f} %. Muscle-tendon models "
        "are integrated implicitly; what the thesis's explicit integrator makes of repetition 1, "
        "at its 1000 Hz, is beside it.",
    )


SECTION = Section(
    name="subjects",
    title="Subjects: a virtual cohort",
    source="3.2, 4.2, 4.4; Figures 17 to 35 and 40",
    run=run,
)
