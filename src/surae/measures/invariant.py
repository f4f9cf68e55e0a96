"""What torque tells of the muscles whatever arms and paths are: measures that these do not move.

Stiffness coefficients and lengths are known only as well as the assumed arm and path are
(`surae.model.symmetry`); their products with these are known as well as the recordings tell.
"""

import math

from surae.measures.leg import Leg, NotDefinedError
from surae.measures.muscle import elongation
from surae.model.contraction import CF
from surae.model.tendon import tendon_force

#: Channel of each muscle's EMG, and the group it is of.
_CHANNELS = {"ta": (0, "tib"), "gl": (1, "tri"), "sol": (2, "tri"), "gm": (3, "tri")}


def passive_exponent(leg: Leg, _: float, group: str) -> float:
    """How steeply the passive force of the {muscles} grows with the angle, at 0°.

    κ = k·|dx/dθ|, of equations (8) and (9): by κ·Δθ the logarithm of the force grows where the
    tendon does not give way.
    """
    name = f"k_{group}"
    if name not in leg.values:
        raise NotDefinedError("none/tissue")
    return leg.values[name] * abs(leg.hold(group, 0.0).slope)


def active_width(leg: Leg, _: float, group: str) -> float:
    """Angle from the optimum at which the active force of the {muscles} is down to 37 %.

    √cf·l0/|dx/dθ| at 0°, cf = 0.1 of equation (16), times the mean of what widths on both sides are
    over it.
    """
    if f"l0_{group}" not in leg.values:
        raise NotDefinedError("none/optimal-length")
    (short, long, _, _) = leg.curves(group)
    wide = 0.5 * (math.exp(short) + math.exp(long))
    reach = math.sqrt(CF) * wide * leg.optimal_length(group)
    return math.degrees(reach / abs(leg.hold(group, 0.0).slope))


def tendon_rotational_stiffness(leg: Leg, at: float, group: str) -> float:
    """Stiffness by which the {tendon} resists a turn of the ankle, at a torque and 0°.

    r·|dx/dθ|·dF_t/de, of equation (18) at the force F_t = T/r.
    """
    curve = leg.tendon(group)
    hold = leg.hold(group, 0.0)
    arm = abs(hold.arm)
    _, slope = tendon_force(elongation(curve, at / arm), curve)
    return math.radians(arm * abs(hold.slope) * slope)


def torque_gain(leg: Leg, _: float, muscle: str) -> float:
    """Torque of the {muscle} for each unit of its EMG, at 0° and its optimal length.

    r·g, of equations (2), (12) and (13).
    """
    channel, group = _CHANNELS[muscle]
    return abs(leg.hold(group, 0.0).arm) * leg.values[leg.spec.weights[channel]]


def maximal_torque(leg: Leg, _: float, group: str) -> float:
    """Most torque that the {short} would add within the range, at the session's largest activity.

    The greatest T(α) − T(0) over the angles that were moved through, α the 99th percentile of the
    active state.
    """
    from scipy.optimize import minimize_scalar

    alpha = max(leg.largest_activity[group], 0.0)
    low, high = map(leg.turned, leg.range_to(math.inf))
    if not low <= high:  # an angle that is no number: the fit failed there
        raise NotDefinedError("none/range")
    best = minimize_scalar(
        lambda angle: -leg.active_torque(group, float(angle), alpha),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 0.2},
    )
    return -float(best.fun)


def shortest_length(leg: Leg, end: float, group: str) -> float:
    """Least length of the relaxed {muscles} within the range that was moved, of the optimal one.

    100·x/l0, x of equation (9) less what the tendon takes, at the 99th or 1st percentile of the
    angle: below 100 % on the ascending limb of the force–length curve.
    """
    return min(_lengths(leg, end, group))


def longest_length(leg: Leg, end: float, group: str) -> float:
    """Greatest length of the relaxed {muscles} within the range that was moved, of the optimal one.

    As shortest_length_{group}, at the other end: above 100 % on the descending limb.
    """
    return max(_lengths(leg, end, group))


def _lengths(leg: Leg, end: float, group: str) -> list[float]:
    """Lengths of a relaxed group at both ends of the range [% of the optimal one]."""
    if f"l0_{group}" not in leg.values:
        raise NotDefinedError("none/optimal-length")
    whole = leg.optimal_length(group)
    at_ends = [leg.hold(group, leg.turned(degrees)).length for degrees in leg.range_to(end)]
    return [100.0 * length / whole for length in at_ends]


def working_point(leg: Leg, _: float, group: str) -> float:
    """Where the relaxed {short} {work} on the force–length curve at 0°, beyond the optimum.

    (x − l0)/|dx/dθ| as an angle, x at 0°; below 0 the muscle is shorter than its optimal length.
    By the angle that the device shows it is surer (`ci95_device`) than by the ankle's own, whose
    zero is not known.
    """
    if f"l0_{group}" not in leg.values:
        raise NotDefinedError("none/optimal-length")
    hold = leg.hold(group, 0.0)
    return math.degrees((hold.length - leg.optimal_length(group)) / abs(hold.slope))
