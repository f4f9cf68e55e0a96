"""Measures of a leg that is active, of how fast, and of what its torque is made of."""

import cmath
import math
from collections.abc import Mapping

import numpy as np

from surae.measures.leg import Leg, NotDefinedError
from surae.measures.muscle import elongation
from surae.measures.passive import before_end
from surae.model.contraction import MVSHL

#: Most that an active state is raised to for a stated torque [N].
_STRONGEST = 1e5


def active_torque_max(leg: Leg, at: float, group: str) -> float:
    """Torque that the {short} {add} at an angle, held still, at the session's largest activity.

    T(α) − T(0) of the group, α the 99th percentile of its active state; equations (15), (16).
    """
    return leg.active_torque(group, at, max(leg.largest_activity[group], 0.0))


def torque_per_emg(leg: Leg, at: float, group: str) -> float:
    """Torque of the {short} at an angle for each unit of EMG{in_all}.

    r·f_l(x)·g, x the length at rest, g the weight {weights}; equations (12), (13) and (16).
    """
    hold = leg.hold(group, at)
    weights = leg.spec.weights[1:] if group == "tri" else leg.spec.weights[:1]
    per_volt = abs(hold.arm) * hold.lift * sum(leg.values[name] for name in weights)
    return float(per_volt * (1e-3 if not leg.has_normalised_emg else 1.0))


def optimal_angle(leg: Leg, _: float, group: str) -> float:
    """Angle at which the relaxed {muscles} {have} {their} optimal length.

    x(θ) = l0 + e, the tendon stretched by e at the passive force of l0; equations (9), (16).
    """
    length = leg.optimal_length(group)
    if leg.is_compliant:
        stretch = leg.values[f"k_{group}"] * (length - leg.values[f"x0_{group}"])
        length += elongation(leg.tendon(group), leg.relaxed * float(np.exp(min(stretch, 50.0))))
    return leg.angle_of(group, length)


def optimum_before_end(leg: Leg, end: float, group: str) -> float:
    """How far before the end of the {direction_end} that was moved {their} optimal length lies.

    From optimal_angle_{group} to the {percentile} percentile of the angle; below 0 beyond it.
    """
    return before_end(leg, end, group, optimal_angle(leg, 0.0, group))


def active_stiffness(leg: Leg, at: float) -> float:
    """Stiffness of the calf muscles at 0° while they add a torque, for a slow movement.

    dT_tri/dθ at the active state whose torque it is, held; muscle and tendon in series.
    """
    hold = leg.hold("tri", 0.0, _alpha(leg, at))
    return hold.torque_slope(hold.stiffness)


def damping(leg: Leg, at: float) -> float:
    """Damping of the calf muscles at 0° while they add a torque, for a slow movement.

    r·α·f_l·f_v′(0)·s²·dx/dθ, s the muscle's share of the lengthening; the mean of both branches of
    equation (17).
    """
    alpha = _alpha(leg, at)
    hold = leg.hold("tri", 0.0, alpha)
    (_, _, bend, gain) = leg.curves("tri")
    a = bend * MVSHL
    branches = (1.0 + 1.0 / bend, (1.0 + a) * gain / a)
    slope = 0.5 * sum(branches) / leg.greatest_speed("tri")
    force = alpha * hold.lift * slope * hold.given**2
    return float(np.radians(hold.arm * force * hold.slope))


def activation_half_time(leg: Leg, _: float) -> float:
    """Time in which force comes to half of its end after a step of EMG, the delay not counted.

    Step response of equation (14).
    """
    from scipy.optimize import brentq

    f0, beta = _filter(leg)
    turns = float(brentq(lambda t: _step_response(t, beta) - 0.5, 0.0, 50.0 * (1.0 + beta)))
    return 1e3 * turns / (2.0 * np.pi * f0)


def bandwidth(leg: Leg, _: float) -> float:
    """Frequency up to which force follows EMG, to −3 dB.

    f0·√(1 − 2β² + √((1 − 2β²)² + 1)) of equation (14).
    """
    f0, beta = _filter(leg)
    b = 1.0 - 2.0 * beta**2
    return float(f0 * np.sqrt(b + np.sqrt(b**2 + 1.0)))


def delay(leg: Leg, _: float) -> float:
    """Time from EMG to the beginning of force.

    emd of equations (12) and (13).
    """
    if "emd" not in leg.values:
        raise NotDefinedError("none/delay")
    return 1e3 * leg.values["emd"]


def reflex_gain(leg: Leg, at: float) -> float:
    """Torque of the calf muscles at an angle for each degree a second of stretch, by reflex.

    r·f_l(x)·reflex_tri·dx/dθ, once the reflex's delay is over.
    """
    if "reflex_tri" not in leg.values:
        raise NotDefinedError("none/reflex")
    hold = leg.hold("tri", at)
    return float(np.radians(hold.arm * hold.lift * leg.values["reflex_tri"] * hold.slope))


def torque_share(leg: Leg, _: float, part: str) -> float:
    """Part of {part} in the torque of the recordings.

    Mean |torque of {part}| over the sum of the means of |tissue|, |neural|, |inertia|, |gravity|.
    """
    return _share({name: torque for name, (torque, _) in leg.shares.items()}, part)


def work_share(leg: Leg, _: float, part: str) -> float:
    """Part of {part} in the work of the recordings.

    As of tissue_share, of |torque·velocity|.
    """
    return _share({name: work for name, (_, work) in leg.shares.items()}, part)


def reflex_share(leg: Leg, _: float) -> float:
    """Part of the reflex in the active contraction of the recordings.

    Mean |torque by reflex| over mean |torque of active contraction|.
    """
    reflexes = [parts.reflex for parts, *_ in leg.split if parts.reflex is not None]
    if len(reflexes) < len(leg.split):
        raise NotDefinedError("none/reflex")
    reflex, neural = map(np.concatenate, (reflexes, [parts.neural for parts, *_ in leg.split]))
    return 100.0 * float(np.abs(reflex).mean() / np.abs(neural).mean())


def _share(sizes: Mapping[str, float], part: str) -> float:
    total = sum(sizes.values())
    if not total > 0.0:
        raise NotDefinedError("none/share")
    return 100.0 * sizes[part] / total


def _alpha(leg: Leg, torque: float) -> float:
    """Active state of the triceps [N] that adds a torque at 0° [Nm]."""
    from scipy.optimize import brentq

    if leg.active_torque("tri", 0.0, _STRONGEST) < torque:
        raise NotDefinedError("none/torque", torque=torque)
    # Where the muscle's force bends back, several states may make it: then the equation is solved.
    alpha = leg.active_state("tri", 0.0, torque)
    if abs(leg.active_torque("tri", 0.0, alpha) - torque) <= 1e-9 * torque:
        return alpha
    return float(
        brentq(
            lambda alpha: leg.active_torque("tri", 0.0, alpha) - torque, 0.0, _STRONGEST, xtol=1e-6
        )
    )


def _filter(leg: Leg) -> tuple[float, float]:
    if "f0" not in leg.values:
        return leg.values["f"], 1.0
    return leg.values["f0"], leg.values["beta"]


def _step_response(t: float, beta: float) -> float:
    """Step response of a second-order filter of natural frequency 1 and this damping."""
    root = cmath.sqrt(beta**2 - 1.0)
    if abs(root) < 1e-6:
        return 1.0 - (1.0 + t) * math.exp(-t)
    slow = -beta + root
    fast = -beta - root
    shape = (fast * cmath.exp(slow * t) - slow * cmath.exp(fast * t)) / (fast - slow)
    return 1.0 - shape.real
