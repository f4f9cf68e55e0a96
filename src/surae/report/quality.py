"""What was found in recordings before they were fitted, as rows of text with marks in time."""

from collections.abc import Sequence
from dataclasses import dataclass

from surae.quality import Quality
from surae.report.traces import Traces


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
