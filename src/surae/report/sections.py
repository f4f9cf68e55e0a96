"""Sections of a report as rows of text: correlations, starts, simulations, predictions, quality."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.assessment import Assessment, Prediction, pooled
from surae.estimation import FitResult
from surae.quality import Quality
from surae.report.formatting import NO_NUMBER, percentage, signed, significant, standard_error
from surae.report.traces import Traces

#: Correlation from which a pair of parameters is named.
_STRONG = 0.9
#: Pairs that are named at most.
_PAIRS = 6


@dataclass(frozen=True, slots=True)
class CorrelationSection:
    """Correlations of the estimates."""

    #: Parameters of rows and columns; fewer than two when there is nothing to show.
    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]  #: Normalised covariance.
    #: `passive`, `active`: the rows and columns of the outlined block.
    passive: tuple[str, ...]
    active: tuple[str, ...]
    #: `ipde`, `note`: equation (35), its largest possible value, and which parameters it leaves out
    #: or why there is none.
    ipde: str
    note: str
    pairs: tuple[str, ...]  #: The strongest pairs in words.
    alt: str  #: The figure in words.


def correlation_section(assessment: Assessment) -> CorrelationSection:
    """Describe the correlations: the map, the strongest pairs and the IPDE."""
    names = assessment.covariance.names
    matrix = assessment.covariance.correlation
    group = {p.name: p.group for p in assessment.parameters.values()}
    k = len(names)
    ranked = sorted(
        ((float(matrix[i, j]), names[i], names[j]) for i in range(k) for j in range(i + 1, k)),
        key=lambda pair: -abs(pair[0]),
    )
    strong = [pair for pair in ranked if abs(pair[0]) >= _STRONG]
    pairs = tuple(f"{a} – {b}: {signed(r, 3)}" for r, a, b in strong[:_PAIRS])
    if len(strong) > _PAIRS:
        pairs += (f"and {len(strong) - _PAIRS} more",)
    ipde = NO_NUMBER
    if assessment.ipde is not None:
        ipde = (
            f"{significant(assessment.ipde, 3)} (0 if independent, at most "
            f"{significant((k * (k - 1) / 2) ** 0.5, 3)} for these {k} parameters)"
        )
    strongest = f"; strongest {ranked[0][1]} with {ranked[0][2]}" if ranked else ""
    return CorrelationSection(
        names=names,
        matrix=tuple(tuple(row) for row in matrix.tolist()),
        passive=tuple(name for name in names if group[name] == "passive"),
        active=tuple(name for name in names if group[name] == "active"),
        ipde=ipde,
        note=assessment.ipde_note,
        pairs=pairs,
        alt=(
            f"Heat map of the correlations of {k} estimated parameters{strongest}"
            f"{f' ({signed(ranked[0][0], 3)})' if ranked else ''}; the block of passive against "
            "active parameters is outlined."
        ),
    )


@dataclass(frozen=True, slots=True)
class StartRow:
    """One start: its number, sum of squares [Nm²], excess over the best, and how it ended."""

    number: int
    sse: str
    excess: str
    agrees: bool
    iterations: int
    outcome: str


def start_rows(result: FitResult) -> tuple[StartRow, ...]:
    """The starts in the order in which they were made."""
    order = sorted(range(len(result.starts)), key=lambda i: _finite(result.starts[i].sse))
    best = result.starts[order[0]].sse
    agreeing = set(order[: result.agreeing])
    return tuple(
        StartRow(
            number=index + 1,
            sse=significant(start.sse, 6),
            excess=_excess(start.sse, best),
            agrees=index in agreeing,
            iterations=start.iterations,
            outcome=start.outcome,
        )
        for index, start in enumerate(result.starts)
    )


def _finite(sse: float) -> float:
    return sse if np.isfinite(sse) else np.inf


def _excess(sse: float, best: float) -> str:
    """Write by which part a sum of squares exceeds the best one."""
    if not np.isfinite(sse) or best <= 0:
        return NO_NUMBER
    part = 100 * (sse / best - 1)
    if part == 0:
        return "best"
    return f"+{significant(part, 2)} %" if part >= 1e-4 else "< 0.0001 %"


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


#: VAF [%] that a prediction may lie below that of the fit before it is worth a word.
_FALL = 5.0


@dataclass(frozen=True, slots=True)
class PredictionRow:
    """One predicted recording: its figures as text, and its figure in words."""

    name: str
    vaf: str
    rmse: str
    bias: str
    alt: str


@dataclass(frozen=True, slots=True)
class PredictionSection:
    """All predicted recordings, and what they say together; the first `drawn` have a figure."""

    text: str
    rows: tuple[PredictionRow, ...]
    drawn: int


def prediction_section(
    assessment: Assessment, predictions: Sequence[Prediction]
) -> PredictionSection | None:
    """The predictions in words; None where there are none."""
    if not predictions:
        return None
    rows = [
        _row(prediction.name, prediction.vaf, prediction.rmse, prediction.bias)
        for prediction in predictions
    ]
    together = pooled(predictions)
    if len(predictions) > 1:
        rows.append(_row("all together", together.vaf, together.rmse, together.bias))
    fall = assessment.vaf - together.vaf
    text = (
        f"With the parameters of this fit, {percentage(together.vaf)} % of the mean square of "
        f"torque that the fit has not seen is accounted for; of its own torque it was "
        f"{percentage(assessment.vaf)} %."
    )
    if fall > _FALL:
        text += (
            " The parameters carry over only in part: they describe the recordings they were "
            "fitted to better than the leg."
        )
    return PredictionSection(text, tuple(rows), len(predictions))


def _row(name: str, vaf: float, rmse: float, bias: float) -> PredictionRow:
    return PredictionRow(
        name,
        percentage(vaf),
        significant(rmse, 3),
        significant(bias, 3),
        f"Measured and predicted torque against time, VAF {percentage(vaf)} %, and their "
        f"difference, RMS {significant(rmse, 3)} Nm.",
    )


@dataclass(frozen=True, slots=True)
class FindingRow:
    """A finding, and where its span lies in the trial: start and width, parts of its length."""

    severity: str
    code: str
    channel: str
    span: str
    start: float
    width: float
    message: str
    advice: str


@dataclass(frozen=True, slots=True)
class QualitySection:
    """The findings of one recording, and the checks that could not be made."""

    name: str
    summary: str
    rows: tuple[FindingRow, ...]
    skipped: tuple[tuple[str, str], ...]


def quality_sections(
    quality: Sequence[Quality], traces: Sequence[Traces]
) -> tuple[QualitySection, ...]:
    """One section for each recording; none where nobody looked.

    Marks are drawn on the span of the recordings' `traces`.
    """
    return tuple(_section(checked, trace) for checked, trace in zip(quality, traces, strict=False))


def _section(quality: Quality, trace: Traces) -> QualitySection:
    ends = [float(trace.time[0]), float(trace.time[-1])]
    ends += [f.start_s for f in quality.findings] + [f.end_s for f in quality.findings]
    first, length = min(ends), max(max(ends) - min(ends), 1e-9)
    rows = tuple(
        FindingRow(
            severity=finding.severity,
            code=finding.code,
            channel=finding.channel or "",
            span=f"{finding.start_s:.4g} to {finding.end_s:.4g} s",
            start=(finding.start_s - first) / length,
            width=(finding.end_s - finding.start_s) / length,
            message=finding.message,
            advice=finding.advice,
        )
        for finding in quality.findings
    )
    return QualitySection(
        name=quality.recording,
        summary=quality.summary,
        rows=rows,
        skipped=tuple((check.check, check.reason) for check in quality.skipped),
    )
