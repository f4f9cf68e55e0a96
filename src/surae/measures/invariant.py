"""What torque tells of the muscles whatever arms and paths are: measures that these do not move.

Stiffness coefficients and lengths are known only as well as the assumed arm and path are
(`surae.model.symmetry`); their products with these are known as well as the recordings tell.
"""

import math

import numpy as np

from surae.base.units import FloatArray
from surae.measures.leg import GROUPS, Leg, NotDefinedError
from surae.measures.muscle import elongation, elongations
from surae.model.contraction import CF
from surae.model.tendon import tendon_force

#: Channel of each muscle's EMG, and the group it is of.
_CHANNELS = {"ta": (0, "tib"), "gl": (1, "tri"), "sol": (2, "tri"), "gm": (3, "tri")}
#: Angles at which a path is looked up between the ends of a movement, and those between which the
#: strongest is looked for [deg].
_PLACES = 16
_STRONGEST = (-60.0, 45.0)


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
    """Most torque that the {short} would add at any angle, at the session's largest activity.

    The greatest T(α) − T(0) over the angle, α the 99th percentile of the active state.
    """
    from scipy.optimize import minimize_scalar

    alpha = max(leg.largest_activity[group], 0.0)
    best = minimize_scalar(
        lambda angle: -leg.active_torque(group, float(angle), alpha),
        bounds=_STRONGEST,
        method="bounded",
        options={"xatol": 0.2},
    )
    return -float(best.fun)


def working_point(leg: Leg, _: float, group: str) -> float:
    """Where the {short} {work} on the force–length curve: how far beyond the optimum, as an angle.

    Mean of (x − l0)/|dx/dθ|, dx/dθ at 0°, weighted by the active state; below 0 they are shorter.
    """
    if not leg.inputs:
        raise NotDefinedError("none/activity")
    index = GROUPS.index(group)
    l0 = leg.optimal_length(group)
    sums = np.zeros(2)
    for (_parts, forces, states), inputs in zip(leg.split, leg.inputs, strict=True):
        active = np.maximum(states[index], 0.0)
        lengths = _lengths(leg, group, np.degrees(inputs.angle), forces[index])
        sums += float(active @ (lengths - l0)) / inputs.rate_hz, active.sum() / inputs.rate_hz
    if not sums[1] > 0.0:
        raise NotDefinedError("none/activity")
    return math.degrees(sums[0] / sums[1] / abs(leg.hold(group, 0.0).slope))


def _lengths(leg: Leg, group: str, device: FloatArray, force: FloatArray) -> FloatArray:
    """Length of a muscle [m] while the device shows angles [deg], of the force on its tendon."""
    shown = device + math.degrees(leg.values.get("angle_zero", 0.0)) - leg.zero_deg
    places = np.linspace(shown.min(), shown.max(), _PLACES)
    own = [leg.rigid_length(group, leg.turned(float(at))) for at in places]
    whole = np.interp(shown, places, own)
    if not leg.is_compliant:
        return np.asarray(whole)
    return np.asarray(whole - elongations(leg.tendon(group), force))
