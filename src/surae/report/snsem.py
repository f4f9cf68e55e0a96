"""Standard errors beside those of simulations, as rows of text."""

from dataclasses import dataclass

from surae.assessment import Assessment
from surae.report.formatting import NO_NUMBER, significant, standard_error


@dataclass(frozen=True, slots=True)
class SnsemRow:
    """One parameter: SEM of the fit, mean SEM of the simulations, their ratio, and the unit."""

    name: str
    sem: str
    simulated: str
    ratio: str
    unit: str


@dataclass(frozen=True, slots=True)
class SnsemSection:
    """The comparison, and what was simulated."""

    about: str
    rows: tuple[SnsemRow, ...]


def snsem_section(assessment: Assessment) -> SnsemSection | None:
    """The snSEM of every parameter that has one; None without a baseline."""
    baseline = assessment.baseline
    if baseline is None:
        return None
    rows = []
    for name, ratio in assessment.snsem.items():
        p = assessment.parameters[name]
        rows.append(
            SnsemRow(
                name,
                standard_error(p.sem),
                standard_error(baseline.sem[name]),
                NO_NUMBER if ratio is None else significant(ratio, 3),
                "" if p.unit == "-" else p.unit,
            )
        )
    return SnsemSection(baseline.about, tuple(rows))
