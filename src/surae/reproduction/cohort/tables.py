"""Tables of the cohort: who, every fit, what each imperfection costs."""

from surae.reproduction.chapter import Table
from surae.reproduction.cohort.evidence import Evidence
from surae.reproduction.cohort.results import Fits
from surae.studies.cohort import ACTIVE_PROTOCOL, PASSIVE_PROTOCOL
from surae.studies.cohort_trials import REMOVABLE


def subjects_table(fits: Fits) -> Table:
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


def costs_table(evidence: Evidence) -> Table:
    """Mean change of the VAF of repetition 1, spared an imperfection."""
    cases = [("1.0", PASSIVE_PROTOCOL), ("1.0", ACTIVE_PROTOCOL), ("2.0", ACTIVE_PROTOCOL)]
    gains = [evidence.gains(*case) for case in cases]
    return Table(
        name="cohort-costs",
        title="What each imperfection costs: mean change of the VAF of repetition 1 without it",
        columns=("without", *(f"{m}, {p} [points]" for m, p in cases)),
        rows=tuple(
            (text, *(None if name not in g else round(g[name], 3) for g in gains))
            for name, text in (REMOVABLE | {"all": "all of them"}).items()
        ),
    )


def fits_table(fits: Fits) -> Table:
    """Every fit of one recording: goodness, and each parameter with its standard error."""
    names = sorted(
        {name for found in fits.single.values() for name, p in found["parameters"].items()
         if p["free"]}, key=_order(fits).index,
    )  # fmt: skip
    rows = []
    for label, found in fits.single.items():
        model, subject, protocol, repetition = label.split()
        cells: list[str | float | int | None] = []
        for name in names:
            p = found["parameters"].get(name)
            estimated = p is not None and p["free"]
            cells += [p["value"], p["sem"]] if p and estimated else [None, None]
        rows.append(
            (model, subject, protocol, int(repetition), found["status"], found["vaf"],
             found["ipde"], *cells)
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


def _order(fits: Fits) -> list[str]:
    """Parameters in the models' order."""
    return list(dict.fromkeys(n for found in fits.single.values() for n in found["parameters"]))
