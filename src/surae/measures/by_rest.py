"""Measures by rest alone beside those by the model, and whether both tell one tissue."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from surae.base.words import Message
from surae.inference import AssessedFit, Grade, Verdict
from surae.inference.relaxed.curve import RelaxedCurve
from surae.inference.uncertainty.combined import ZERO
from surae.measures.at_rest import rest_of_fit
from surae.measures.conflict import LEVEL, compared_angles, disagreement
from surae.measures.measure import Measure
from surae.measures.points import Evaluated, MeasurePoint, evaluate
from surae.measures.rest.judged import RestMeasure
from surae.measures.table import DEFINITIONS

#: How those begin that are of the fit's relaxed tissue.
_OF_TISSUE = (
    "end_stiffness",
    "end_torque",
    "torque_rise",
    "passive_",
    "slow_",
    "quick_stiffness",
    "neutral_angle",
    "slack_",
    "range_at_torque",
    "stiffness_at_torque",
    "hysteresis",
    "dissipated_energy",
)


@lru_cache(maxsize=4)
def two_tissues(fit: AssessedFit) -> Message | None:
    """That rest and the fit tell two tissues, where they do; see `surae.measures.conflict`."""
    curve = rest_of_fit(fit)
    if not isinstance(curve, RelaxedCurve) or curve.grade is not Grade.ADEQUATE:
        return None
    angles = compared_angles(curve)
    (torque,) = (each for each in DEFINITIONS if each.name == "slow_torque")
    at = [MeasurePoint(torque, float(angle) + curve.zero_deg) for angle in angles]
    known = fit.assessment.uncertainty
    evaluated = evaluate(fit.result, known, at) if at and known.lost != known.names else ()
    values = [each.value for each in evaluated if each.value is not None and not each.missing]
    if not evaluated or len(values) < len(at):
        return None
    rows = np.array([np.where(np.array(known.names) == ZERO, 0.0, e.gradient) for e in evaluated])
    p = disagreement(curve, angles, values, rows @ known.covariance() @ rows.T)
    return Message("rest/two-tissues") if p < LEVEL else None


def doubted_by_rest(m: Measure, why: Message | None) -> Measure:
    """A measure of the fit's relaxed tissue, which rest contradicts; others as they are."""
    base = m.name.partition("@")[0]
    if why is None or m.ci95 is None or not base.startswith(_OF_TISSUE):
        return m
    return replace(m, verdict=Verdict.UNDETERMINED, note=why)


def claimed_by_rest(
    point: MeasurePoint, rest: RestMeasure, size: int, *, assumed: bool
) -> tuple[Evaluated, Measure]:
    """A measure by rest alone, which none of so many parameters moves.

    Who fits does not say that a leg rests: where no electrode shows an effort, a muscle that never
    lets go looks like one that does nothing, in whatever unit. Rest is `assumed` then, and nothing
    claimed.
    """
    measure = rest.measure
    if assumed and measure.verdict is Verdict.IDENTIFIED:
        measure = replace(measure, verdict=Verdict.WEAK, note=Message("rest/no-effort"))
    assert rest.total is not None
    assert rest.session is not None
    deviations = rest.total, rest.session
    evaluated = Evaluated(point, rest.measure.value, np.zeros(size), deviations=deviations)
    return evaluated, measure
