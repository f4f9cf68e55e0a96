"""What one fit brings to a comparison with others: every measure and parameter, as plain data."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.normal import standard_error_of
from surae.base.records import OrNaN
from surae.base.words import Message
from surae.inference import Adequacy, AssessedFit, FitResult, Grade
from surae.inference.judging.reasons import Scope, scopes_of
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.at_rest import rest_of_fit
from surae.measures.beyond import extrapolated
from surae.measures.by_model import disputed, rests_on
from surae.measures.compute import judged_measures
from surae.measures.fitted_leg import leg_of
from surae.measures.measure import Measure
from surae.measures.points import ANGLES, Evaluated, points
from surae.measures.table import ELECTRODES, LEADING
from surae.model.laboratory import group_of

#: Where there is no interval.
_NONE = (np.nan, np.nan, np.nan)
#: Parameters that time the force after the EMG.
_TIMING = ("f0", "beta", "emd")
#: Of one unchanged leg with one electrode, f0 was 1.6 Hz in one trial and 2.8 Hz in another.
_UNHEARD = Message("alone/unheard")


@dataclass(frozen=True, slots=True)
class Quantity:
    """A measure or parameter of one fit."""

    #: `name`, `unit`, `meaning`: as in the tables of measures and parameters.
    name: str
    unit: str
    meaning: str
    kind: Literal["measure", "parameter"]  #: Which table.
    value: float | None  #: None where there is none.
    total: OrNaN  #: Standard deviation, everything included; NaN where there is none.
    #: Standard deviation of what another session would draw anew; NaN where there is none.
    session: OrNaN
    model: OrNaN  #: Standard deviation that models add which the data do not reject.
    #: Why it can be compared with nothing, as a `Message`; empty where it can.
    missing: str = ""
    at_bound: bool = False  #: Whether it is a parameter at its bound.
    bounds: tuple[float, float] | None = None  #: Of a parameter's search.
    #: `from_deg`, `to_deg`: as of `Measure`.
    from_deg: float | None = None
    to_deg: float | None = None
    #: Whether it can be pooled with other legs although no two sessions are compared by it.
    is_comparable_between_legs: bool = False
    rests_on: tuple[Scope, ...] = ()  #: What of the fit touches it; empty where all does.
    basis: str = "model"  #: As of `Measure`; what is by rest alone is not doubted with the fit.
    doubt: str = ""  #: Why differences of one by rest alone are shown and not judged.


@dataclass(frozen=True, slots=True)
class Quantities:
    """All of one fit, and what decides with which other fits they can be compared."""

    model: str  #: Name of the model.
    options: Mapping[str, object]  #: Its switches, without the reference level of the EMG.
    adequacy: Adequacy  #: Of the fit.
    recordings: tuple[str, ...]  #: Names of the recordings.
    by_name: FrozenDict[str, Quantity]  #: Measures, then parameters.


def common_end(results: Iterable[FitResult]) -> float:
    """The end of the range [deg] that all of these moved through, as devices told their angles."""
    return min(end for leg in map(leg_of, results) if leg.moved for end in leg.moved[1:])


def quantities(
    fit: AssessedFit,
    angles: Sequence[float] = ANGLES,
    end: float = math.inf,
    only: Collection[str] = (),
) -> Quantities:
    """What a fit brings to a comparison; torque and stiffness are those at `angles` [deg].

    `only` names the measures that are computed; without it all are, and all parameters are brought.

    At the `end` [deg] of the range that others moved through too, those at the end are compared.
    """
    result = fit.result
    assessment = fit.assessment
    problem = result.problem
    known = assessment.uncertainty
    has_reference = all(
        recording.emg_reference is not None and recording.emg_reference.kind == "mvc"
        for recording in problem.inputs
    )
    adequacy = assessment.adequacy
    inadequate = ""
    worded = problem.options.anatomy.worded
    if adequacy.grade is Grade.INADEQUATE:
        inadequate = Message("alone/inadequate", reason=adequacy.reasons[0])
    timing = np.isin(known.names, _TIMING) & problem.has_unheard
    by_name: dict[str, Quantity] = {}
    wanted = tuple(p for p in points(angles, end) if not only or p.definition.name in only)
    for evaluated, m in judged_measures(fit, wanted):
        alone = evaluated.point.definition.alone
        common = m.name in LEADING and math.isfinite(end)
        if common or (alone == ELECTRODES and has_reference):
            alone = ""
        if m.basis == "rest":
            by_name[m.name] = _of_rest(evaluated, m, alone, fit)
            continue
        if m.value is None or m.ci95 is None:
            deviations = _NONE
            why = inadequate or m.note
            between = False
        else:
            deviations = known.deviations(evaluated.gradient)
            # where the measure bends too much for the covariance, draws are wider or narrower
            total, session, model = deviations
            bent = max(standard_error_of(m.ci95) / total if total > 0.0 else 1.0, 1.0)
            deviations = bent * total, bent * session, bent * model
            reason = Message(alone, worded) if alone else ""
            unheard = _UNHEARD if np.any(evaluated.gradient[timing]) else ""
            doubt = disputed(evaluated, fit)
            why = inadequate or doubt or reason or unheard or extrapolated(evaluated, result) or ""
            between = alone not in ("", ELECTRODES) and why is reason
        by_name[m.name] = Quantity(
            m.name,
            m.unit,
            m.meaning,
            "measure",
            m.value,
            *deviations,
            why,
            from_deg=m.from_deg,
            to_deg=m.to_deg,
            is_comparable_between_legs=between,
            rests_on=tuple(sorted(rests_on(evaluated, fit))),
        )
    if not only:
        by_name |= _parameters(fit, inadequate, has_reference=has_reference)
    options = {n: v for n, v in problem.options.as_dict().items() if n not in ("emg_ref", "tissue")}
    return Quantities(
        problem.spec.name,
        FrozenDict(options),
        adequacy,
        tuple(recording.name for recording in problem.inputs),
        FrozenDict(by_name),
    )


def _parameters(fit: AssessedFit, inadequate: str, *, has_reference: bool) -> dict[str, Quantity]:
    """The leg's parameters of a fit, whose EMG may have a reference in contractions."""
    problem = fit.result.problem
    assessment = fit.assessment
    known = assessment.uncertainty
    by_name: dict[str, Quantity] = {}
    for name in known.names:
        if group_of(name) is not None or name not in assessment.parameters:
            continue
        p = assessment.parameters[name]
        why = ""
        if p.at_bound:
            why = Message("alone/bound")
        elif p.ci95 is None:
            why = p.note
        elif name in problem.spec.weights and not has_reference:
            why = Message(ELECTRODES)
        elif name in _TIMING and problem.has_unheard:
            why = _UNHEARD
        deviations = _NONE if p.ci95 is None else known.deviations(known.along(name))
        by_name[name] = Quantity(
            name,
            p.unit,
            p.meaning,
            "parameter",
            p.value,
            *deviations,
            inadequate or why,
            p.at_bound,
            (p.lower, p.upper),
            rests_on=tuple(sorted(scopes_of([(name, p.group, 1.0)]))),
        )
    return by_name


def _of_rest(evaluated: Evaluated, m: Measure, alone: str, fit: AssessedFit) -> Quantity:
    """A measure by rest alone: no parameter and no doubt of the fit is in it."""
    assert evaluated.deviations is not None
    curve = rest_of_fit(fit)
    doubt = ""
    if isinstance(curve, RelaxedCurve) and curve.grade is not Grade.ADEQUATE:
        doubt = Message("change/rest-doubtful", reason=curve.findings[0])
    total, session = evaluated.deviations
    worded = fit.result.problem.options.anatomy.worded
    return Quantity(
        m.name,
        m.unit,
        m.meaning,
        "measure",
        m.value,
        total,
        session,
        0.0,
        Message(alone, worded) if alone else "",
        from_deg=m.from_deg,
        to_deg=m.to_deg,
        is_comparable_between_legs=bool(alone),
        basis=m.basis,
        doubt=doubt,
    )
