"""What of a measure was not measured."""

import math

from surae.base.words import Message
from surae.inference import FitResult
from surae.measures.fitted_leg import leg_of, measured_range
from surae.measures.points import Evaluated
from surae.measures.table import Definition

#: Degrees beyond the measured range that still count as measured.
_BEYOND = 0.5


def extrapolated(evaluated: Evaluated, result: FitResult) -> Message | None:
    """What of a measure was not measured; None where all was."""
    definition = evaluated.point.definition
    at = evaluated.point.at
    shown = definition.is_angle and not definition.name.startswith("working_point")
    if definition.at == "deg" or shown or definition.span:
        degrees = evaluated.value if definition.is_angle else at
        low, high = measured_range(result)
        if definition.span and definition.is_angle:  # how far before the range's end
            low, high = 0.0, high - low
        if degrees is None or degrees == math.inf or low - _BEYOND <= degrees <= high + _BEYOND:
            return None
        return Message("beyond/angle", degrees=degrees, low=low, high=high)
    if definition.at == "s":
        longest = max(float(i.time[-1] - i.time[0]) for i in result.problem.inputs)
        return None if at <= longest else Message("beyond/time", seconds=longest)
    if definition.at not in ("N", "Nm") or definition.name == "stiffness_at_torque":
        return None
    return _stronger(definition, at, result)


def _stronger(definition: Definition, at: float, result: FitResult) -> Message | None:
    """Whether a pull is stronger than those in the recordings."""
    leg = leg_of(result)
    group = "tib" if definition.name.endswith("_tib") else "tri"
    alpha = max(leg.largest_activity[group], 0.0)
    pulls = [leg.hold(group, angle, alpha) for angle in (*measured_range(result), 0.0)]
    if definition.at == "N":
        most = max(pull.force for pull in pulls)
        return None if at <= most else Message("beyond/force", force=most)
    if definition.name.startswith("tendon_"):
        most = max(abs(pull.torque) for pull in pulls)
        return None if at <= most else Message("beyond/pull", torque=most)
    most = leg.active_torque(group, 0.0, alpha)
    return None if at <= most else Message("beyond/torque", torque=most)
