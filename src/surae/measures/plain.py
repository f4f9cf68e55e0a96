"""What measures are called where there is no room for their definition."""

from surae.base.words import N_, Message

PLAIN = {
    "curve_size": N_("Torque at rest over the whole curve"),
    "end_stiffness": N_("Stiffness at the end of the range"),
    "end_torque": N_("Torque at the end of the range"),
    "torque_rise": N_("Rise of the torque over the range"),
    "shortest_length_tri": N_("Shortest calf length in the range, of the optimal one"),
    "longest_length_tri": N_("Longest calf length in the range, of the optimal one"),
    "passive_exponent_tri": N_("Rise of the calf’s stiffness with the angle"),
    "active_width_tri": N_("Width of the calf’s active range"),
    "tendon_rotational_stiffness_tri": N_("Stiffness of the calf’s tendon, {at}"),
    "maximal_torque_tri": N_("Most torque of the calf"),
    "voluntary_torque_tri": N_("Strength of the calf"),
    "voluntary_torque_tib": N_("Strength of the tibialis"),
    "passive_torque": N_("Torque at rest, {at}"),
    "passive_stiffness": N_("Stiffness at rest, {at}"),
    "slow_torque": N_("Torque in a slow stretch, {at}"),
    "slow_stiffness": N_("Stiffness in a slow stretch, {at}"),
    "range_at_torque": N_("Angle reached with {at}"),
    "stiffness_at_torque": N_("Stiffness at rest, with {at}"),
    "curve_shift": N_("Shift of the curve towards dorsiflexion"),
    "hysteresis": N_("Part of the work that a stretch and its return take"),
    "neutral_angle": N_("Resting angle"),
    "relaxed_share": N_("Part that relaxes within {at}"),
    "active_torque_max_tri": N_("Calf strength used, {at}"),
    "active_torque_max_tib": N_("Tibialis strength used, {at}"),
    "working_point_tri": N_("Calf at 0°, beyond its optimal length"),
    "optimal_angle_tri": N_("Best angle of the calf"),
    "activation_half_time": N_("Time to half of the force"),
    "delay": N_("Delay from EMG to force"),
}
_UNITS = (("deg", "°"), ("Nm", " Nm"), ("s", " s"))


def plain_name(name: str) -> str:
    """A measure's plain name as a `Message`; its own name where it has none."""
    base, _, point = name.partition("@")
    if base not in PLAIN:
        return name
    for ending, unit in _UNITS:
        if point.endswith(ending):
            return Message(PLAIN[base], at=point.removesuffix(ending).replace("-", "−") + unit)
    return Message(PLAIN[base])
