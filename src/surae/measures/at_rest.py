"""The rest in a fit's recordings: what it tells goes before the model's, whatever muscles do."""

import math
from collections.abc import Sequence
from dataclasses import replace

from surae.base.words import Message
from surae.inference import AssessedFit, FitResult, Grade
from surae.inference.judging.of_data import OF_RECORDINGS
from surae.inference.judging.reasons import Reason, Scope
from surae.inference.relaxed.build import curve_of
from surae.inference.relaxed.context import Laboratory
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.measure import RestSaid
from surae.measures.relaxed_change import with_detectable_changes
from surae.measures.rest.judged import RestMeasure, rated_measures
from surae.model.joint import ANKLE
from surae.signals.windows import are_windows


def relaxed_of(result: FitResult) -> RelaxedCurve | Message:
    """The relaxed curve of a fit's recordings, or why their rest tells none.

    It is made of the recordings that are in the fit, and saved with it, so that it is the same
    wherever it is asked for.
    """
    problem = result.problem
    if problem.options.anatomy != ANKLE:
        return Message("rest/joint")
    curve = curve_of(problem.inputs, Laboratory.of(problem.settings))
    if isinstance(curve, RelaxedCurve) and any(map(are_windows, problem.inputs)):
        return replace(curve, findings=(*curve.findings, Message("rest/windows")))
    return curve


def rest_of_fit(fit: AssessedFit) -> RelaxedCurve | Message:
    """The relaxed curve of a fit's recordings, doubted where one of them has an error."""
    names = {each.name.partition(",")[0] for each in fit.result.problem.inputs}
    reasons = [r for r in fit.assessment.adequacy.against if r.values.get("trial") in names]
    return doubted_at_rest(relaxed_of(fit.result), reasons)


def doubted_at_rest(
    curve: RelaxedCurve | Message, reasons: Sequence[Reason]
) -> RelaxedCurve | Message:
    """A curve whose recordings are doubted: angle, torque or time is not what it is taken for.

    An error of EMG alone touches no rest.
    """
    said = [
        reason.says
        for reason in reasons
        if reason.code in OF_RECORDINGS and reason.scope is Scope.ALL
    ]
    if not said or not isinstance(curve, RelaxedCurve):
        return curve
    return replace(curve, grade=Grade.DOUBTFUL, findings=(*said, *curve.findings))


def measures_at(
    curve: RelaxedCurve, result: FitResult, angles: Sequence[float], end: float
) -> tuple[RestMeasure, ...]:
    """What rest tells of a fit's leg, at angles of the ankle's own and over a range to `end` [deg].

    Angles of ranges are those of the fit, in which a zero that was given is counted.
    """
    zero = math.degrees(result.values.get("angle_zero", 0.0))
    rated = [m for m in rated_measures(curve, angles, end - zero) if m.measure.value is not None]
    with_sdc = with_detectable_changes([each.measure for each in rated], curve, angles)
    judged = (replace(each, measure=m) for each, m in zip(rated, with_sdc, strict=True))
    return tuple(_turned(each, zero) for each in judged)


def _turned(rest: RestMeasure, zero: float) -> RestMeasure:
    """A measure over a range whose angles have the fit's zero [deg] in them."""
    m = rest.measure
    if not zero or m.from_deg is None or m.to_deg is None:
        return rest
    return replace(rest, measure=replace(m, from_deg=m.from_deg + zero, to_deg=m.to_deg + zero))


def rest_said(curve: RelaxedCurve | Message, conflict: Message | None = None) -> RestSaid:
    """What a table says of rest, and whether the muscles' fit is in conflict with it."""
    if not isinstance(curve, RelaxedCurve):
        return RestSaid(missing=curve)
    return RestSaid(
        curve.grade, curve.seconds, (curve.low, curve.high), curve.findings, conflict=conflict or ""
    )
