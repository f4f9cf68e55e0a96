"""Section: the thesis's subjects, a virtual cohort in their place (3.2, Figures 17 to 35, 40)."""

from collections.abc import Mapping
from statistics import fmean

from surae_thesis.claims import INTEGRATOR, judge_all, turned
from surae_thesis.cohort import work
from surae_thesis.cohort.drawings import (
    integrator_drawing,
    snsem_drawings,
    spectra_drawing,
    trace_drawings,
    vaf_drawings,
)
from surae_thesis.cohort.members import (
    COMPLETED,
    GAIN,
    MEASURED_SECONDS,
    PASSIVE_SECONDS,
    QUIET,
)
from surae_thesis.cohort.results import MADE_BY, Fits, Size, Ways, thesis_fits
from surae_thesis.cohort.rules import COHORT, DRAWS
from surae_thesis.legs import STRAIN
from surae_thesis.section import Context, Result, Table

#: The module whose functions decide the claims.
RULES = "surae_thesis.cohort.rules"


def run(context: Context) -> Result:
    """Fit the cohort as the thesis fitted its subjects, and judge its claims."""
    ways = thesis_fits(context)
    size = Size.of(context)
    views = {COHORT: ways.cohort, STRAIN: ways.strain, INTEGRATOR: ways.explicit}
    jobs = {who.id: {"seed": size.seed, "member": n} for n, who in enumerate(ways.few.members)}
    strengths = context.calls("cohort-strengths", work.strength_job, jobs, also=MADE_BY)
    figures = [
        *vaf_drawings(ways.cohort),
        *trace_drawings(ways.cohort),
        *snsem_drawings(ways.cohort),
        spectra_drawing(ways.cohort),
        integrator_drawing(ways),
    ]
    findings = judge_all("subjects", views, RULES)
    return Result(
        findings=findings,
        insights=(_integrator(ways), _strength(strengths), turned(findings, COHORT, STRAIN)),
        figures=tuple(sorted(figures, key=lambda drawing: drawing.name)),
        tables=(_turned(ways),),
        notes=_notes(ways),
    )


def _integrator(ways: Ways) -> str:
    """What the thesis's scheme and optimiser make of the same recordings."""
    tried = ways.explicit.vaf("2.0")

    def mean(fits: Fits, model: str) -> float:
        return fmean(vaf for which, vaf in fits.vaf(model).items() if which in tried)

    return (
        f"Solved implicitly, model 2.0 follows the multiple holds with a VAF of "
        f"{mean(ways.cohort, '2.0'):.1f} %, model 1.0 with {mean(ways.cohort, '1.0'):.1f} % "
        f"(means of {len(tried)} subjects, repetition 1). With the thesis's explicit scheme, least "
        "squares with the usual tiny finite differences stop in the scheme's chatter at "
        f"{mean(ways.explicit, '2.0'):.1f} %; with differences of 1 % they reach "
        f"{fmean(ways.wide.values()):.1f} %. What a fit of the scheme ends with says more of the "
        "optimiser than of the model."
    )


def _strength(strengths: Mapping[str, Mapping[str, float]]) -> str:
    """Which reading of ε0 lets the legs reach the thesis's torques."""
    measured, printed = (
        f"{min(v):.0f} to {max(v):.0f} Nm"
        for key in ("measured", "printed")
        for v in [[sizes[key] for sizes in strengths.values()]]
    )
    return (
        "Table 2 calls ε0 = 0.04 a strain, and only as a part of the slack length does it let legs "
        f"on compliant tendons reach the thesis's torques: the cohort {measured}, the same legs "
        f"and efforts with ε0 of 0.04 m, as the equations are printed, {printed}."
    )


def _notes(ways: Ways) -> tuple[str, ...]:
    members = ways.cohort.members
    seconds = MEASURED_SECONDS.values()
    women = sum(m.sex == "female" for m in members)
    finished = ", ".join(str(sum(p in m.completed for m in members)) for p in COMPLETED)
    return (
        "The thesis's recordings are not public. A virtual cohort stands in: "
        f"{len(members)} of fourteen subjects ({len(members) - women} men, {women} women), of whom "
        f"{finished} did protocol 1, 2, 3. It is a model of the thesis's subjects, not them.",
        "Its legs are richer than every fitted model: compliant tendons of their own, a stretch "
        "reflex, muscles without electrodes, crosstalk, knee motion, an ankle axis off the "
        "device's, effort that differs by repetition. Raw signals of 2048 Hz go through the "
        "thesis's preparation to 256 Hz (2.1).",
        f"Measured as the figures' axes show: {', '.join(f'{v:g} s' for v in seconds)}, the first "
        f"{PASSIVE_SECONDS:g} s relaxed. Two numbers are calibrated, and the claims that they were "
        "set by cannot hold: each muscle's force for its EMG wanders within seconds, by "
        f"{100 * GAIN:.0f} %, for the 95 % with which model 1.0 follows the multiple holds; and "
        f"the torque's noise is {QUIET:g} of the usual one, for the 99.95 % of Figure 18. A table "
        "has what each of them turns, and what the simulations' longer protocols would. The last "
        "column has the thesis's explicit integrator at 1000 Hz with an optimiser of its kind, "
        "repetition 1; the one before it the tendon models with ε0 as a part of the slack length, "
        "their snSEM over simulations in metres. What cohorts drawn again from these subjects "
        f"({DRAWS}, with replacement) say otherwise more often than once in ten, in holding or in "
        "size, is decided by chance and not tested by this.",
    )


def _turned(ways: Ways) -> Table:
    """Claims that what the cohort was made by turns, in both directions, for the same subjects."""
    ours = {f.id: f for f in judge_all("subjects", {COHORT: ways.few}, RULES, chance=False)}
    rows: list[tuple[str, ...]] = []
    for name, fits in ways.otherwise.items():
        for f in judge_all("subjects", {COHORT: fits}, RULES, chance=False):
            here, other = (g.ours.get(COHORT) for g in (ours[f.id], f))
            if here and other and here[0] != other[0]:
                turned = "gains" if here[0] else "loses"
                rows.append((name, f.id, f.number, other[1], here[1], turned))
    return Table(
        name="cohort-calibrations",
        title=f"What each turns, of the first {len(ways.few.members)} subjects",
        columns=("made otherwise", "claim", "thesis", "otherwise", "the cohort", "the cohort"),
        rows=tuple(rows),
    )
