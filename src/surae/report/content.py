"""What a report says, as plain data: strings and numbers, ready for any page."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from surae.assessment import Assessment, Verdict
from surae.estimation import FitResult
from surae.report.correlations import CorrelationSection, correlation_section
from surae.report.digits import NONE, percentage, significant
from surae.report.parameters import ParameterGroup, parameter_groups
from surae.report.provenance import Setting, Source, settings, sources
from surae.report.recordings import RecordingSection, recording_section
from surae.report.starts import StartRow, start_rows
from surae.report.traces import Traces
from surae.report.whiteness import Whiteness
from surae.report.wording import caution, closeness, remain_identified, summary, widening

_STATUS = {
    "converged": "converged",
    "at-bounds": "converged, with parameters at a bound",
    "failed": "failed",
}


@dataclass(frozen=True, slots=True)
class KeyFigure:
    """A number to see first, with a few words on how to read it."""

    label: str
    value: str
    note: str


@dataclass(frozen=True, slots=True)
class Glance:
    """The parameters of one verdict, each with its value and unit."""

    verdict: str
    text: str
    parameters: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Content:
    """Everything a report says.

    Attributes
    ----------
    title : str
        Model.
    names : tuple of str
        Recordings.
    created : str
        When the report was made.
    status, status_text, message : str
        Of the fit: the word, its wording, and what happened.
    summary : tuple of str
        Plain language, one paragraph an entry.
    key : tuple of KeyFigure
        The few numbers to see first.
    glance : tuple of Glance
        The parameters by verdict.
    caution : str
        What to know before reading the parameter table; empty where there is nothing.
    priors : bool
        Whether any parameter has one.
    recordings, groups, correlation, starts, settings, sources, versions
        The sections.
    agreeing : int
        Starts that reached the best minimum.
    """

    title: str
    names: tuple[str, ...]
    created: str
    status: str
    status_text: str
    message: str
    summary: tuple[str, ...]
    key: tuple[KeyFigure, ...]
    glance: tuple[Glance, ...]
    caution: str
    priors: bool
    recordings: tuple[RecordingSection, ...]
    groups: tuple[ParameterGroup, ...]
    correlation: CorrelationSection
    starts: tuple[StartRow, ...]
    agreeing: int
    settings: tuple[Setting, ...]
    sources: tuple[Source, ...]
    versions: tuple[Setting, ...]


def make_content(
    result: FitResult,
    assessment: Assessment,
    traces: tuple[Traces, ...],
    whiteness: tuple[Whiteness, ...],
    *,
    versions: Mapping[str, str],
    created: datetime,
) -> Content:
    """Put a fit and its assessment into words.

    Parameters
    ----------
    result, assessment : FitResult, Assessment
        The fit and what it is worth.
    traces, whiteness : tuple of Traces, tuple of Whiteness
        Signals of each recording and the autocorrelation of its residual.
    versions : mapping of str to str
        Of the programs that made the fit.
    created : datetime
        When the report is made.
    """
    torque = np.concatenate([one.measured[one.counted] for one in traces])
    rms = float(np.sqrt(np.mean(torque**2)))
    factor = widening(whiteness)
    groups = parameter_groups(assessment, result.problem.priors)
    return Content(
        title=result.problem.spec.title,
        names=tuple(one.name for one in assessment.recordings),
        created=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        status=result.status,
        status_text=_STATUS.get(result.status, result.status),
        message=result.message,
        summary=summary(result, assessment, whiteness, rms),
        key=_key(result, assessment, rms, factor),
        glance=_glance(groups),
        caution=caution(result, whiteness),
        priors=bool(result.problem.priors),
        recordings=tuple(
            recording_section(*each)
            for each in zip(assessment.recordings, traces, whiteness, strict=True)
        ),
        groups=groups,
        correlation=correlation_section(assessment),
        starts=start_rows(result),
        agreeing=result.agreeing,
        settings=settings(result, assessment),
        sources=sources(result),
        versions=tuple(Setting(name, version) for name, version in versions.items()),
    )


def _key(
    result: FitResult, assessment: Assessment, rms: float, factor: float | None
) -> tuple[KeyFigure, ...]:
    parameters = assessment.parameters.values()
    free = sum(p.free for p in parameters)
    identified = sum(p.verdict is Verdict.IDENTIFIED for p in parameters)
    widened = ""
    failed = result.status == "failed"
    if factor is not None and identified and not failed:
        left = remain_identified(assessment, factor)
        widened = f"{left} with intervals widened {significant(factor, 2)}×"
    return (
        KeyFigure(
            "Variance accounted for",
            f"{percentage(assessment.vaf)} %",
            "no minimum reached" if failed else f"follows {closeness(assessment.vaf)}",
        ),
        KeyFigure(
            "Root mean square error",
            f"{significant(assessment.rmse, 3)} Nm",
            f"torque itself {significant(rms, 3)} Nm",
        ),
        KeyFigure("Parameters identified", NONE if failed else f"{identified} of {free}", widened),
        KeyFigure(
            "Starts that agree",
            f"{result.agreeing} of {len(result.starts)}",
            "on the best minimum",
        ),
    )


def _glance(groups: tuple[ParameterGroup, ...]) -> tuple[Glance, ...]:
    rows = [row for group in groups for row in group.rows]
    found = {row.verdict: row.verdict_text for row in rows}
    return tuple(
        Glance(
            verdict,
            found[verdict],
            tuple(
                (row.name, f"{row.value} {row.unit}".rstrip() if row.determined else "undetermined")
                for row in rows
                if row.verdict == verdict
            ),
        )
        for verdict in map(str, Verdict)
        if verdict in found
    )
