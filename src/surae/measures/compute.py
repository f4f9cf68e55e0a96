"""From a fit to its measures: values, intervals through the whole covariance, verdicts."""

import math
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache

from surae.base.frozen import FrozenDict
from surae.inference import AssessedFit
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.at_rest import measures_at, rest_of_fit, rest_said
from surae.measures.by_model import measures_by_model
from surae.measures.by_rest import claimed_by_rest, doubted_by_rest, two_tissues
from surae.measures.leg import Leg
from surae.measures.measure import Measure, Measures
from surae.measures.points import ANGLES, Evaluated, MeasurePoint, points
from surae.model import ModelOptions, get_model, with_optional


def measures_of_values(
    values: Mapping[str, float],
    model: str,
    options: ModelOptions | None = None,
    angles: Sequence[float] = ANGLES,
    only: Collection[str] = (),
) -> dict[str, float]:
    """Measures of a leg with known parameters: a pure function, those without recordings.

    Parameters
    ----------
    values : mapping of str to float
        Every free parameter of the model; tendon parameters that are left out take their starts.
    model : str
        Its name.
    options : ModelOptions, optional
        Its switches.
    angles : sequence of float
        Where [deg].
    only : collection of str
        Names of the measures to compute; empty computes all.

    Returns
    -------
    dict of str to float
        By name; what such a leg does not have is left out.

    Raises
    ------
    InputError
        The model, a parameter or an angle is not known.
    """
    options = options or ModelOptions()
    spec = with_optional(get_model(model), values)
    vector = spec.vector(values, options)
    leg = Leg(spec, options, dict(zip(spec.names, vector.tolist(), strict=True)))
    wanted = [
        point
        for point in points(angles)
        if not point.definition.of_recordings and (not only or point.name in only)
    ]
    values_by_name = {point.name: point.value(leg)[0] for point in wanted}
    return {name: value for name, value in values_by_name.items() if math.isfinite(value)}


def measures(fit: AssessedFit, angles: Sequence[float] = ANGLES) -> Measures:
    """All measures of a fit, those of angles at these [deg]; what it lacks has a reason instead."""
    judged = judged_measures(fit, points(angles))
    by_name = FrozenDict((measure.name, measure) for _, measure in judged)
    rest = rest_said(rest_of_fit(fit), two_tissues(fit))
    return Measures(fit.result.problem.spec.name, fit.assessment.adequacy, by_name, rest)


@lru_cache(maxsize=4)  # pages, comparisons and answers are often of the same fit
def judged_measures(
    fit: AssessedFit, wanted: tuple[MeasurePoint, ...]
) -> tuple[tuple[Evaluated, Measure], ...]:
    """All these measures of a fit: by rest alone what its rest tells, the others by its model."""
    curve = rest_of_fit(fit)
    if not isinstance(curve, RelaxedCurve):
        return measures_by_model(fit, wanted)
    angles = tuple(dict.fromkeys(p.at for p in wanted if p.definition.at == "deg"))
    end = next((p.at for p in wanted if p.definition.span), math.inf)
    by_name = {each.measure.name: each for each in measures_at(curve, fit.result, angles, end)}
    others = tuple(point for point in wanted if point.name not in by_name)
    why = two_tissues(fit)
    modelled = {
        each.point: (each, doubted_by_rest(m, why)) for each, m in measures_by_model(fit, others)
    }
    size = len(fit.assessment.uncertainty.names)
    assumed = curve.is_declared
    return tuple(
        modelled.get(p) or claimed_by_rest(p, by_name[p.name], size, assumed=assumed)
        for p in wanted
    )
