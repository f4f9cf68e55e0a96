"""What a report says, as plain data: strings and numbers, ready for any page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from surae.assessment import Assessment, Interval, Prediction, Verdict
from surae.estimation import FitResult
from surae.quality import Quality
from surae.report.budget import BudgetSection, budget_section
from surae.report.formatting import NO_NUMBER, percentage, significant
from surae.report.identifiability import IdentifiabilitySection, identifiability_section
from surae.report.laboratory import (
    FamilySection,
    LaboratorySection,
    TrialsSection,
    family_section,
    laboratory_section,
    trials_section,
)
from surae.report.parameters import ParameterGroup, parameter_groups
from surae.report.provenance import Setting, Source, fit_settings, sources
from surae.report.recordings import RecordingSection, recording_section
from surae.report.sections import (
    CorrelationSection,
    PredictionSection,
    QualitySection,
    SnsemSection,
    StartRow,
    correlation_section,
    prediction_section,
    quality_sections,
    snsem_section,
    start_rows,
)
from surae.report.traces import Traces
from surae.report.wording import AdequacyWords, adequacy_words, caution, closeness, summary

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
    """Everything a report says."""

    title: str  #: Model.
    names: tuple[str, ...]  #: Recordings.
    created: str  #: When the report was made.
    #: `status`, `status_text`, `message`: of the fit: the word, its wording, and what happened.
    status: str
    status_text: str
    message: str
    adequacy: AdequacyWords  #: Whether the fit is good enough for its numbers to mean something.
    summary: tuple[str, ...]  #: Plain language, one paragraph an entry.
    key: tuple[KeyFigure, ...]  #: The few numbers to see first.
    glance: tuple[Glance, ...]  #: The parameters by verdict.
    interval: str  #: Which standard errors the intervals are made of, ``"thesis"`` or ``"robust"``.
    caution: str  #: What to know before reading the parameter table; empty where there is nothing.
    priors: bool  #: Whether any parameter has one.
    #: `recordings`, `groups`, `correlation`, `identifiability`, `starts`, `settings`, `sources`,
    #: `versions`: the sections.
    recordings: tuple[RecordingSection, ...]
    groups: tuple[ParameterGroup, ...]
    correlation: CorrelationSection
    identifiability: IdentifiabilitySection
    starts: tuple[StartRow, ...]
    agreeing: int  #: Starts that reached the best minimum.
    settings: tuple[Setting, ...]
    sources: tuple[Source, ...]
    versions: tuple[Setting, ...]
    budget: BudgetSection  #: What makes each parameter unsure, and what would help.
    #: `laboratory`, `family`, `trials`: of a fit with model auto: what is not known of the
    #: laboratory, which models were weighed, and how trials differ; None where there is nothing to
    #: say.
    laboratory: LaboratorySection | None
    family: FamilySection | None
    trials: TrialsSection | None
    #: `predictions`, `snsem`: the sections on other recordings and on simulations; None without
    #: any.
    predictions: PredictionSection | None
    snsem: SnsemSection | None
    #: Whether the first start was the solution that the weights of outliers came from.
    weighted_first: bool
    #: What was found in each recording before the fit; empty where nobody looked.
    quality: tuple[QualitySection, ...]


def make_content(
    result: FitResult,
    assessment: Assessment,
    traces: tuple[Traces, ...],
    *,
    versions: Mapping[str, str],
    created: datetime,
    predictions: Sequence[Prediction] = (),
    quality: Sequence[Quality] = (),
) -> Content:
    """Put a fit and its assessment into words.

    `versions` are those of the programs that made the fit; `predictions` are of other recordings;
    `quality` is what was found in each recording before the fit.
    """
    torque = np.concatenate([trial.measured[trial.counted] for trial in traces])
    rms = float(np.sqrt(np.mean(torque**2)))
    groups = parameter_groups(assessment, result.problem.priors)
    return Content(
        title=result.problem.spec.title,
        names=tuple(recording.name for recording in assessment.recordings),
        created=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        status=result.status,
        status_text=_STATUS.get(result.status, result.status),
        message=result.message,
        adequacy=adequacy_words(assessment.adequacy),
        summary=summary(result, assessment, rms),
        key=_key(result, assessment, rms),
        glance=_glance(groups),
        interval=str(assessment.interval),
        caution=caution(result, assessment),
        priors=bool(result.problem.priors),
        recordings=tuple(
            recording_section(*each)
            for each in zip(assessment.recordings, traces, assessment.whiteness, strict=True)
        ),
        groups=groups,
        correlation=correlation_section(assessment),
        identifiability=identifiability_section(result, assessment),
        starts=start_rows(result),
        agreeing=result.agreeing,
        settings=fit_settings(result, assessment),
        sources=sources(result),
        versions=tuple(Setting(name, version) for name, version in versions.items()),
        budget=budget_section(result, assessment),
        laboratory=laboratory_section(result, assessment),
        family=family_section(result, assessment),
        trials=trials_section(result, assessment),
        predictions=prediction_section(assessment, predictions),
        snsem=snsem_section(assessment),
        weighted_first=result.outliers is not None,
        quality=quality_sections(quality, traces),
    )


def _key(result: FitResult, assessment: Assessment, rms: float) -> tuple[KeyFigure, ...]:
    parameters = assessment.parameters.values()
    free = sum(p.free for p in parameters)
    identified = sum(p.verdict is Verdict.IDENTIFIED for p in parameters)
    failed = result.status == "failed"
    robust = assessment.interval is Interval.ROBUST and not failed
    coloured = not all(whiteness.white for whiteness in assessment.whiteness)
    return (
        KeyFigure(
            "Torque’s changes followed, R²",
            f"{percentage(assessment.adequacy.r2)} %",
            "no minimum reached"
            if failed
            else f"{closeness(assessment.adequacy.r2)}; with its "
            f"mean, VAF {percentage(assessment.vaf)} %",
        ),
        KeyFigure(
            "Root mean square error",
            f"{significant(assessment.rmse, 3)} Nm",
            f"torque itself {significant(rms, 3)} Nm",
        ),
        KeyFigure(
            "Parameters identified",
            NO_NUMBER if failed else f"{identified} of {free}",
            "what is not known of the laboratory allowed for"
            if result.family is not None
            else ("correlation of the residual allowed for" if coloured else "robust errors")
            if robust
            else "",
        ),
        KeyFigure(
            "Parameters repeatable",
            NO_NUMBER if failed else f"{sum(p.repeatable for p in parameters)} of {free}",
            "another trial would give the same",
        )
        if result.family is not None
        else KeyFigure(
            "Starts that agree",
            f"{result.agreeing} of {len(result.starts)}",
            "on the best minimum",
        ),
    )


def _glance(groups: tuple[ParameterGroup, ...]) -> tuple[Glance, ...]:
    rows = [row for group in groups for row in group.rows]
    texts = {row.verdict: row.verdict_text for row in rows}
    return tuple(
        Glance(
            verdict,
            texts[verdict],
            tuple(
                (row.name, f"{row.value} {row.unit}".rstrip() if row.determined else "undetermined")
                for row in rows
                if row.verdict == verdict
            ),
        )
        for verdict in map(str, Verdict)
        if verdict in texts
    )
