"""What torque tells of muscles whatever their arms and paths are: true values.

Force against arm, and metre against path, leave every torque unchanged; k, x0, l0, dlt and g change
with them. These combinations do not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ankle_legs.muscle import Muscle, static_force, tendon_force
from ankle_legs.subject import ELECTRODES, GROUPS, Subject

TENDON_AT = {"tri": 25, "tib": 4}  # torques at which a tendon's stiffness is read [Nm]
GRID = 1.0  # over which the largest torque is sought [deg]

#: Invariants that a parameter makes, or a measure: without its truth they have none.
MADE_OF: dict[str, tuple[str, ...]] = {
    **{f"k_{g}": (f"passive_exponent_{g}",) for g in GROUPS},
    **{f"l0_{g}": (f"active_width_{g}", f"working_point_{g}") for g in GROUPS},
    **{f"dlt_{g}": (f"tendon_rotational_stiffness_{g}",) for g in GROUPS},
    **{f"g{i + 1}": (f"torque_gain_{name}",) for i, name in enumerate(ELECTRODES)},
    "active_torque_max": ("maximal_torque",),
    "optim": ("working_point",),
}


def unscored(reasons: dict[str, str]) -> dict[str, str]:
    """Return the invariants that have no truth either where these parameters have none, and why."""
    return {name: why for key, why in reasons.items() for name in MADE_OF.get(key, ())}


def invariants(
    subject: Subject,
    gains: Sequence[float],
    moved: tuple[float, float],
    active: tuple[float, float],
) -> dict[str, float | None]:
    """Return the invariants of a leg.

    ``gains`` are the force per volt that each electrode shows [N/V], ``moved`` the range that the
    ankle was moved in [rad], ``active`` the largest active states of triceps and tibialis [N].
    """
    zero = np.zeros(1)
    arms = subject.geometry.arm(zero)[:, 0]
    made: dict[str, float | None] = {}
    for i, (group, muscle) in enumerate(zip(GROUPS, subject.muscles(), strict=True)):
        slope = abs(_slope(subject, i))
        straight, even = muscle.width == 0, muscle.short_width == muscle.long_width
        length = static_force(muscle, float(subject.geometry.path(zero)[i, 0]), 0.0)[1]
        made[f"passive_exponent_{group}"] = muscle.k * slope if straight else None
        wide = math.sqrt(muscle.short_width) * muscle.l0 / slope
        made[f"active_width_{group}"] = math.degrees(wide) if straight and even else None
        away = math.degrees((length - muscle.l0) / slope)
        made[f"working_point_{group}"] = away if straight else None
        at = TENDON_AT[group]
        made[f"tendon_rotational_stiffness_{group}@{at}Nm"] = _tendon(
            muscle, at, float(arms[i]), slope
        )
        made[f"maximal_torque_{group}"] = _largest(subject, i, moved, active[i])
    for i, name in enumerate(ELECTRODES):
        made[f"torque_gain_{name}"] = float(gains[i] * arms[1 if i == 0 else 0])
    return made


def _slope(subject: Subject, i: int) -> float:
    """Return how far a group's path travels at 0 degrees [m/rad]."""
    near = np.array([-1e-5, 1e-5])
    return float(np.diff(subject.geometry.path(near)[i])[0] / 2e-5)


def _tendon(muscle: Muscle, torque: float, arm: float, slope: float) -> float | None:
    """Return a tendon's stiffness about the joint at a torque [Nm/deg]; None: it is rigid."""
    if not muscle.dlt:
        return None
    constants, low, high = muscle.constants(), 0.0, 0.5
    for _ in range(80):
        middle = 0.5 * (low + high)
        pull = tendon_force(middle, constants)[0]
        low, high = (middle, high) if pull * arm < torque else (low, middle)
    return math.radians(arm * slope * tendon_force(high, constants)[1])


def _largest(subject: Subject, i: int, moved: tuple[float, float], active: float) -> float | None:
    """Return what the largest active state adds to a held torque, at its best angle [Nm]."""
    if active <= 50:
        return None
    muscle = subject.muscles()[i]
    count = max(round(math.degrees(moved[1] - moved[0]) / GRID), 1) + 1
    angles = np.linspace(*moved, count)
    paths, arms = subject.geometry.path(angles)[i], subject.geometry.arm(angles)[i]
    return max(
        float(arm * (static_force(muscle, path, active)[0] - static_force(muscle, path, 0.0)[0]))
        for path, arm in zip(paths, arms, strict=True)
    )
