"""Measures of a leg at rest: what its tissue does when nothing is active."""

import math

import numpy as np

from surae.base.errors import ComputationError
from surae.base.units import FloatArray
from surae.measures.leg import GROUPS, Leg, NotDefinedError
from surae.measures.muscle import elongation
from surae.model.tendon import tendon_force
from surae.signals import steady_emg

#: Towards plantarflexion, and towards dorsiflexion.
SIGNS = {"tri": 1.0, "tib": -1.0}
#: The last of a range, over which its end is as stiff as its mean [deg].
_LAST = 10.0
#: Angles between which the neutral angle is looked for [deg].
_LOWEST = -70.0
_HIGHEST = 50.0
#: The slow stretch whose energy counts: from and to [deg], its speed [deg/s], samples a second.
_FROM = -20.0
_TO = 10.0
_SPEED = 10.0
_RATE = 50.0
#: The slow stretch to the end of the range and back: from [deg], degrees between two samples, and
#: its speed [deg/s].
_LOOP_FROM = -30.0
_LOOP_STEP = 0.5
_LOOP_SPEED = 5.0


def at_end(leg: Leg, end: float) -> tuple[float, float]:
    """Where `end_torque` is taken [deg]."""
    return (leg.range_to(end)[1],) * 2


def last_degrees(leg: Leg, end: float) -> tuple[float, float]:
    """What `end_stiffness` is taken over [deg]."""
    low, high = leg.range_to(end)
    return max(low, high - _LAST), high


def end_torque(leg: Leg, end: float) -> float:
    """Torque of the relaxed ankle at the end of the dorsiflexion that was moved.

    passive_torque at the 99th percentile of the angle.
    """
    return passive_torque(leg, leg.turned(leg.range_to(end)[1]))


def end_stiffness(leg: Leg, end: float) -> float:
    """Stiffness of the relaxed ankle over the last 10° of the dorsiflexion that was moved.

    Mean of passive_stiffness there: the rise of passive_torque to end_torque, by the angle.
    """
    low, high = map(leg.turned, last_degrees(leg, end))
    return (passive_torque(leg, high) - passive_torque(leg, low)) / (high - low)


def end_torque_of(leg: Leg, end: float, group: str) -> float:
    """Pull of the relaxed {muscles} at the end of the dorsiflexion that was moved.

    passive_torque_{group} there, towards {direction}: a part of end_torque.
    """
    return passive_torque_of(leg, leg.turned(leg.range_to(end)[1]), group)


def end_stiffness_of(leg: Leg, end: float, group: str) -> float:
    """Part of the {muscles} in the stiffness over the last 10° of dorsiflexion that were moved.

    Mean of passive_stiffness_{group} there: the two and joint_stiffness add up to end_stiffness.
    """
    low, high = map(leg.turned, last_degrees(leg, end))
    return (leg.hold(group, high).torque - leg.hold(group, low).torque) / (high - low)


def torque_rise(leg: Leg, end: float) -> float:
    """Rise of the relaxed ankle's torque over the whole range that was moved.

    passive_torque at the 99th less at the 1st percentile of the angle: no constant is in it.
    """
    low, high = map(leg.turned, leg.range_to(end))
    return passive_torque(leg, high) - passive_torque(leg, low)


def slack_before_end(leg: Leg, end: float, group: str) -> float:
    """How far before the end of the {direction_end} that was moved the {muscles} {begin} to pull.

    From slack_angle_{group} to the {percentile} percentile of the angle; below 0 beyond it.
    """
    return before_end(leg, end, group, slack_angle(leg, 0.0, group))


def before_end(leg: Leg, end: float, group: str, angle: float) -> float:
    """How far an angle lies before that end of the range which stretches a group [deg]."""
    low, high = map(leg.turned, leg.range_to(end))
    return high - angle if group == "tri" else angle - low


def passive_torque(leg: Leg, at: float) -> float:
    """Torque of the relaxed ankle at an angle, its tissue fully relaxed.

    T = r_tri·F_tri − r_tib·F_tib + T_joint, F = exp(k·(x − x0))/(1 + k_rel) in balance with the
    tendon; equations (2), (8) and (10). T_joint is of the joint's own tissue, where the data ask.
    """
    return sum(leg.hold(group, at).torque for group in GROUPS) + leg.joint_torque(at)


def passive_torque_of(leg: Leg, at: float, group: str) -> float:
    """Pull of the relaxed {muscles} at an angle, towards {direction}.

    T_{group} = r_{group}·F_{group}, as of passive_torque.
    """
    return SIGNS[group] * leg.hold(group, at).torque


def passive_stiffness(leg: Leg, at: float) -> float:
    """Stiffness of the relaxed ankle at an angle, for a movement so slow that tissue relaxes.

    dT/dθ of passive_torque, the change of the moment arms included; muscle and tendon in series.
    """
    return sum(_slow(leg, group, at) for group in GROUPS) + leg.joint_slope(at)


def passive_stiffness_of(leg: Leg, at: float, group: str) -> float:
    """Part of the {muscles} in the stiffness of the relaxed ankle.

    {sign}dT_{group}/dθ, as of passive_stiffness: the two and joint_stiffness add up.
    """
    return _slow(leg, group, at)


def joint_stiffness(leg: Leg, _: float) -> float:
    """Part of the joint's own tissue in the stiffness of the relaxed ankle, at any angle.

    joint_stiffness of the model: capsule, ligaments and skin beside the muscles.
    """
    if leg.options.tissue is not None:
        raise NotDefinedError("none/beside-curve")
    if "joint_stiffness" not in leg.values:
        raise NotDefinedError("none/beside")
    return leg.joint_slope(0.0)


def quick_stiffness(leg: Leg, at: float) -> float:
    """Stiffness of the relaxed ankle at an angle, for a stretch so quick that nothing relaxes.

    dT/dθ with dF = k·exp(k·(x − x0))·dx, the high-frequency gain of equation (10).
    """
    holds = [leg.hold(group, at) for group in GROUPS]
    return sum(hold.torque_slope(hold.quick) for hold in holds) + leg.joint_slope(at)


def slow_torque(leg: Leg, at: float) -> float:
    """Torque of the relaxed ankle as it passes an angle in a slow stretch, 5°/s from −30°.

    passive_torque before all has relaxed, by equation (10) and the model's own integrator.
    """
    return float(np.interp(at, *_stretch(leg, at)))


def slow_stiffness(leg: Leg, at: float) -> float:
    """Stiffness of the relaxed ankle as it passes an angle in a slow stretch, 5°/s from −30°.

    Slope of slow_torque over 2°.
    """
    angles, torque = _stretch(leg, at)
    low, high = np.interp([at - 1.0, at + 1.0], angles, torque)
    return float(high - low) / 2.0


def neutral_angle(leg: Leg, _: float) -> float:
    """Angle at which the relaxed ankle comes to rest but for gravity.

    passive_torque = 0; between −70° and 50°.
    """
    from scipy.optimize import brentq

    if "k_tib" not in leg.values:
        raise NotDefinedError("none/balancing")
    ends = [passive_torque(leg, angle) for angle in (_LOWEST, _HIGHEST)]
    if not (np.isfinite(ends).all() and ends[0] * ends[1] < 0.0):
        raise NotDefinedError("none/balance", low=_LOWEST, high=_HIGHEST)
    return float(brentq(lambda angle: passive_torque(leg, angle), _LOWEST, _HIGHEST, xtol=1e-8))


def range_at_torque(leg: Leg, at: float) -> float:
    """Angle of the ankle at which its relaxed torque is so large.

    passive_torque = T, within the range that was moved.
    """
    from scipy.optimize import brentq

    low, high = _LOWEST, _HIGHEST
    if leg.moved is not None:
        low, high = map(leg.turned, leg.range_to(math.inf))
    beyond = [passive_torque(leg, angle) - at for angle in (low, high)]
    if not beyond[0] < 0.0 < beyond[1]:
        raise NotDefinedError("none/torque-beyond", torque=at, low=low, high=high)
    return float(brentq(lambda angle: passive_torque(leg, angle) - at, low, high, xtol=1e-6))


def stiffness_at_torque(leg: Leg, at: float) -> float:
    """Stiffness of the relaxed ankle at the angle where its relaxed torque is so large.

    passive_stiffness at range_at_torque: no zero of the angle is in it.
    """
    return passive_stiffness(leg, range_at_torque(leg, at))


def slack_angle(leg: Leg, _: float, group: str) -> float:
    """Angle {beyond} which the {muscles} {begin} to pull: at {their} slack length.

    x(θ) = x0, where equation (8) gives 1 N; the tendon is not stretched there.
    """
    name = f"x0_{group}"
    if name not in leg.values:
        raise NotDefinedError("none/tissue")
    return leg.angle_of(group, leg.values[name])


def relaxed_share(leg: Leg, at: float) -> float:
    """Part of a sudden stretch's torque that has relaxed after some seconds.

    k_rel/(1 + k_rel)·(1 − exp(−(1 + k_rel)·t/τ_rel)), the step response of equation (10).
    """
    if "k_rel" not in leg.values:
        raise NotDefinedError("none/relaxes")
    k = leg.values["k_rel"]
    tau = leg.values["tau_rel"]
    return 100.0 * k / (1.0 + k) * -float(np.expm1(-(1.0 + k) * at / tau))


def slow_loop(leg: Leg, end: float) -> tuple[float, float]:
    """What `hysteresis` is taken over [deg]."""
    return _LOOP_FROM, leg.range_to(end)[1]


def hysteresis(leg: Leg, end: float) -> float:
    """Energy that the relaxed ankle takes from a slow stretch and its return, as part of the work.

    100·∮T dθ/∫(T − T₀) dθ of the way there, at 5°/s from −30° to the end of the dorsiflexion that
    was moved (to half a degree) and back, T₀ the torque at its start.
    """
    last = leg.turned(leg.range_to(end)[1])
    count = round((last - _LOOP_FROM) / _LOOP_STEP)
    if count * _LOOP_STEP < _LAST:
        raise NotDefinedError("none/stretch", low=_LOOP_FROM, high=last)
    there = _LOOP_FROM + _LOOP_STEP * np.arange(count + 1)
    angle = np.concatenate([there, there[-2::-1]])
    torque = leg.passive_torque(angle.tolist(), _LOOP_SPEED / _LOOP_STEP)
    between = 0.5 * (torque[1:] + torque[:-1]) - torque[0]
    steps = np.diff(angle)
    work = float(between @ np.maximum(steps, 0.0))
    return 100.0 * float(between @ steps) / work if work > 0.0 else math.nan


def dissipated_energy(leg: Leg, _: float) -> float:
    """Energy that the relaxed ankle takes from a slow stretch to 10° and back to −20°, at 10°/s.

    ∮ T dθ from rest at −20°, by equation (10) and the model's own integrator.
    """
    count = int((_TO - _FROM) / _SPEED * _RATE)
    there = np.linspace(_FROM, _TO, count + 1)
    angle = np.concatenate([there, there[-2::-1]])
    torque = leg.passive_torque(angle.tolist(), _RATE)
    between = 0.5 * (torque[1:] + torque[:-1])
    return 1e3 * float(np.sum(between * np.diff(np.radians(angle))))


def tendon_stiffness(leg: Leg, at: float, group: str) -> float:
    """Stiffness of the {tendon} at a force.

    dF_t/de of equation (18).
    """
    curve = leg.tendon(group)
    stiffness = tendon_force(elongation(curve, at), curve)[1]
    if not np.isfinite(stiffness):
        raise ComputationError("the tendon's curve is not finite with these parameters")
    return 1e-3 * stiffness


def tendon_secant(leg: Leg, _: float, group: str) -> float:
    """Stiffness of the {tendon} between 20 % and 80 % of the session's largest force.

    (F₈₀ − F₂₀)/(e₈₀ − e₂₀), e from equation (18), of the 99th percentile of the tendon's force. A
    tendon is softer at low force, so that stiffness goes with the range it is taken over (Seynnes
    et al. 2015, J. Appl. Physiol. 118).
    """
    curve = leg.tendon(group)
    low, high = (part * leg.largest_force[group] for part in (0.2, 0.8))
    stretched = elongation(curve, high) - elongation(curve, low)
    if not stretched > 0.0:
        raise NotDefinedError("none/unpulled")
    return 1e-3 * (high - low) / stretched


def tendon_strain(leg: Leg, at: float, group: str) -> float:
    """Strain of the {tendon} at a force.

    e/lt0, e from equation (18), lt0 of the thesis's Table 2.
    """
    slack = leg.options.anatomy.slack[GROUPS.index(group)]
    return 100.0 * elongation(leg.tendon(group), at) / slack


def optimal_fascicle_tib(leg: Leg, _: float) -> float:
    """Length that the filmed fascicle of the tibialis shows when the muscle has its optimal length.

    (1 + film_scale_tib)·l0_tib + film_zero_tib. It rests on the film, not on the assumed path.
    """
    if "film_scale_tib" not in leg.values:
        raise NotDefinedError("none/filmed")
    if leg.inputs and steady_emg(leg.inputs)[0]:
        raise NotDefinedError("none/optimum")
    scale, zero = (leg.values[f"film_{of}_tib"] for of in ("scale", "zero"))
    return 1e3 * ((1.0 + scale) * leg.optimal_length("tib") + zero)


def _slow(leg: Leg, group: str, at: float) -> float:
    hold = leg.hold(group, at)
    return hold.torque_slope(hold.stiffness)


def _stretch(leg: Leg, at: float) -> tuple[FloatArray, FloatArray]:
    angles, torque = leg.slow_stretch
    if not angles[0] + 10.0 <= at <= angles[-1] - 1.0:
        raise NotDefinedError("none/stretch", low=angles[0], high=angles[-1])
    return angles, torque
