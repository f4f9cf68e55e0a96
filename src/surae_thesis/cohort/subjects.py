"""Section: the thesis's subjects, a virtual cohort in their place (3.2, Figures 17 to 35, 40)."""

from collections.abc import Mapping
from dataclasses import replace
from statistics import fmean

from surae_thesis.claims import INTEGRATOR, judge_all
from surae_thesis.cohort import plan
from surae_thesis.cohort.drawings import (
    explicit_drawing,
    snsem_drawings,
    spectra_drawing,
    trace_drawings,
    vaf_drawings,
)
from surae_thesis.cohort.members import ACTIVE_PROTOCOL, COMPLETED, PASSIVE_PROTOCOL
from surae_thesis.cohort.results import (
    Fits,
    fair_fits,
    fitted,
    strengths,
    thesis_fits,
)
from surae_thesis.cohort.rules import METRES, STRAIN, Evidence, gains, strength
from surae_thesis.cohort.trials import REMOVABLE
from surae_thesis.section import Context, Result, Table

#: The module whose functions decide the claims.
RULES = "surae_thesis.cohort.rules"
#: What a fair optimiser makes of the explicit scheme, by subject; see `work.explicit_job`.
Fair = Mapping[str, Mapping[str, float | None]]


def run(context: Context) -> Result:
    """Fit the cohort as the thesis fitted its subjects, and judge its claims."""
    fits = thesis_fits(context)
    size = fits.size
    explicit = replace(fits, single=fitted(context, "explicit", plan.explicit_fits(size)))
    strain = replace(fits, single=fitted(context, "strain", plan.strain_fits(size)))
    fair = fair_fits(context, fits)
    spectra, apart = spectra_drawing(fits)
    spared = fitted(context, "spared", plan.spared_fits(size))
    evidence = Evidence(fits, spared, strengths(context), tuple(apart))
    views = {
        METRES: evidence,
        STRAIN: evidence.another_way(strain),
        INTEGRATOR: evidence.another_way(explicit),
    }
    figures = [*vaf_drawings(fits), *trace_drawings(fits), *snsem_drawings(fits), spectra]
    figures.append(explicit_drawing(fits, explicit))
    return Result(
        findings=judge_all("subjects", views, RULES),
        insights=(_integrator(views, fair), strength(evidence)),
        figures=tuple(sorted(figures, key=lambda drawing: drawing.name)),
        tables=(_members(fits), _costs(evidence), _fits(fits)),
        notes=_notes(fits),
    )


def _integrator(views: Mapping[str, Evidence], fair: Fair) -> str:
    """What makes the compliant model follow worse than the rigid one in the thesis."""
    tried = {p.subject for p in views[INTEGRATOR].fits.vaf("2.0", ACTIVE_PROTOCOL)}

    def mean(name: str, model: str) -> float:
        points = views[name].fits.vaf(model, ACTIVE_PROTOCOL)
        return fmean(p.value for p in points if p.repetition == 1 and p.subject in tried)

    got = {
        key: [value for of_subject in fair.values() if (value := of_subject[key]) is not None]
        for key in ("replayed", "default", "warm")
    }
    each = [[v for v in of_subject.values() if v is not None] for of_subject in fair.values()]
    best = [max(values) for values in each if values]
    told = {key: f"{fmean(values):.1f} %" if values else "none" for key, values in got.items()}
    return (
        "Solved implicitly, the compliant model 2.0 follows the multiple holds with a VAF of "
        f"{mean(METRES, '2.0'):.1f} % (with ε0 as a strain {mean(STRAIN, '2.0'):.1f} %), the rigid "
        f"1.0 with {mean(METRES, '1.0'):.1f} % (means over the first repetitions of {len(tried)} "
        "subjects). With the thesis's explicit integrator our solver ends at "
        f"{mean(INTEGRATOR, '2.0'):.1f} %. A least-squares solver with finite differences wider "
        f"than the chatter ends at {told['default']} from the default start and at {told['warm']} "
        "from the implicit solution, whose parameters give the explicit scheme "
        f"{told['replayed']} as they are; the best of all per subject {fmean(best):.1f} %. So the "
        "scheme follows the torque as well as the implicit one; what it lacks is a smooth way "
        "there, and how badly a fit of it ends "
        "says more of the solver than of the model."
    )


def _notes(fits: Fits) -> tuple[str, ...]:
    size = fits.size
    alone = fmean(fit["first_start"] for fit in fits.single.values())
    best = f"; the default start alone finds the best one in {100 * alone:.0f} %"
    failed = sum(fit["status"] == "failed" for fit in fits.single.values())
    women = sum(m.sex == "female" for m in fits.members)
    finished = ", ".join(str(sum(p in m.completed for m in fits.members)) for p in COMPLETED)
    return (
        "The thesis's recordings are not public. A virtual cohort stands in: "
        f"{len(fits.members)} subjects ({len(fits.members) - women} men, {women} women, 20 to 30 "
        f"years), {size.repetitions} repetitions; {finished} of them did protocol 1, 2, 3. It is a "
        "model of the thesis's subjects, not them: 'holds' says that its pattern is theirs, "
        "'differs' that it is not; neither is evidence on people.",
        "Its legs are richer than every fitted model: compliant tendons of their own (ε0 of the "
        "triceps 2.8 to 5 % of the slack length, weights twice those of rigid legs, so that they "
        "reach the thesis's torques), a stretch reflex, muscles without electrodes, crosstalk, "
        "knee motion, an ankle axis off the device's, torque noise, effort that differs by "
        "repetition; motions are those that the device can follow. Raw signals of 2048 Hz go "
        f"through the thesis's preparation to {size.rate_hz:g} Hz (2.1).",
        f"Every model was fitted to every recording alone, {len(fits.single)} fits of "
        f"{size.starts} start{'' if size.starts == 1 else 's'}; {failed} reached no minimum"
        f"{best if size.starts > 1 else ''}. Models with tendons "
        "are judged with Table 2's ε0 in metres and as a strain, and as the thesis's explicit "
        "integrator has them at its 1000 Hz, the latter two on repetition 1, the last of the first "
        f"{min(size.closer, len(fits.members))} subjects alone, as refits that are spared "
        "imperfections. Its fits are those of our "
        "solver, which follows derivatives that the chatter spoils: see the finding above.",
    )


def _members(fits: Fits) -> Table:
    """The cohort."""
    return Table(
        name="cohort-subjects",
        title="The virtual cohort",
        columns=(
            "subject", "sex", "age [years]", "range of motion [rad]", "protocols", "remarks",
            "ε0 triceps [m]", "crosstalk [%]", "without electrode [%]", "axis forward [mm]",
            "axis up [mm]", "knee [rad]", "reflex [1/(l0/s)]", "torque noise [Nm]",
        ),
        rows=tuple(
            (
                m.id, m.sex, m.age, f"{m.range_of_motion[0]:.2f} … {m.range_of_motion[1]:.2f}",
                len(m.completed), "; ".join(m.remarks),
                round(m.subject.tendons["dlt_tri"], 4),
                round(100 * m.imperfections.crosstalk, 1),
                round(100 * m.imperfections.unmeasured, 1),
                round(1e3 * m.imperfections.axis_forward, 1),
                round(1e3 * m.imperfections.axis_up, 1), round(m.imperfections.knee_motion, 3),
                round(m.imperfections.reflex_gain, 3), round(m.imperfections.torque_noise, 2),
            )
            for m in fits.members
        ),
    )  # fmt: skip


def _costs(evidence: Evidence) -> Table:
    """Mean change of the VAF of repetition 1, spared an imperfection."""
    cases = [("1.0", PASSIVE_PROTOCOL), ("1.0", ACTIVE_PROTOCOL), ("2.0", ACTIVE_PROTOCOL)]
    changes = [gains(evidence, *case) for case in cases]
    return Table(
        name="cohort-costs",
        title="What each imperfection costs: mean change of the VAF of repetition 1 without it, "
        f"{min(evidence.fits.size.closer, len(evidence.fits.members))} subjects",
        columns=("without", *(f"{m}, {p} [points]" for m, p in cases)),
        rows=tuple(
            (text, *(None if name not in change else round(change[name], 3) for change in changes))
            for name, text in (REMOVABLE | {"all": "all of them"}).items()
        ),
    )


def _fits(fits: Fits) -> Table:
    """Every fit of one recording: goodness, and each parameter with its standard error."""
    names = list(
        dict.fromkeys(
            name
            for fit in fits.single.values()
            for name, p in fit["parameters"].items()
            if p["free"]
        )
    )
    rows = []
    for label, fit in fits.single.items():
        model, subject, protocol, repetition = label.split()
        several = [fit["parameters"].get(name) for name in names]
        cells = [p[key] if p and p["free"] else None for p in several for key in ("value", "sem")]
        rows.append(
            (model, subject, protocol, int(repetition), fit["status"], fit["vaf"], fit["ipde"],
             *cells)
        )  # fmt: skip
    return Table(
        name="cohort-fits",
        title="Every fit of one recording",
        columns=(
            "model", "subject", "protocol", "repetition", "status", "vaf [%]", "ipde [-]",
            *(column for name in names for column in (name, f"{name} sem")),
        ),
        rows=tuple(rows),
        long=True,
    )  # fmt: skip
