"""Moment arms and muscle lengths from the ankle angle, and that from the device's.

Neither of the former, equations (4), (5) and (9), depends on an estimated parameter: they are
computed once per recording.
"""

from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.model.geometry_table import GeometryTable
from surae.model.joint import ANKLE
from surae.model.options import ModelOptions

#: Offset [m] and slope [m/rad] of the moment arms of triceps and tibialis, equations (4) and (5)
#: (Maganaris 1998, 1999).
ARMS = ((0.0480, -0.0104), (0.0393, 0.0171))
#: l_m [m] and factor of the arm in equation (9).
_LENGTHS = ((0.118, 1.67), (0.136, 1.56))
#: Whether dorsiflexion lengthens the group, and the sign of its torque.
_SIGNS = (1.0, -1.0)


def moment_arm(angle: FloatArray, group: int) -> FloatArray:
    """Moment arm of a tendon, equations (4) and (5).

    Achilles: r = 0.0480 − 0.0104·θ; tibialis: r = 0.0393 + 0.0171·θ.

    Parameters
    ----------
    angle : ndarray
        Ankle angle [rad], dorsiflexion positive.
    group : {0, 1}
        Triceps surae or tibialis anterior.

    Returns
    -------
    ndarray
        Arm [m], same shape.
    """
    offset, slope = ARMS[group]
    return offset + slope * angle


def muscle_length(
    angle: FloatArray, group: int, options: ModelOptions
) -> tuple[FloatArray, FloatArray]:
    """Length of a muscle and its slope, equation (9) or virtual work.

    ``"thesis"``: x = 0.118 − 1.67·r(θ) of the triceps, 0.136 − 1.56·r(θ) of the tibialis, the
    literal product; its slope is not the arm.
    ``"virtual-work"``: x = x_ref ± ∫r dθ, so that force times dx/dθ is the torque; the triceps
    lengthens with dorsiflexion, the tibialis shortens.

    Returns
    -------
    length : ndarray
        Muscle length x [m].
    slope : ndarray
        dx/dθ [m/rad].
    """
    arm = moment_arm(angle, group)
    (offset, bend) = ARMS[group]
    if options.geometry == "thesis":
        longest, factor = _LENGTHS[group]
        return longest - factor * arm, np.full_like(angle, -factor * bend)
    sign = _SIGNS[group]
    reference = (options.x_ref_tri, options.x_ref_tib)[group]
    return reference + sign * (offset * angle + 0.5 * bend * angle**2), sign * arm


@dataclass(frozen=True, slots=True)
class Path:
    """What an ankle angle does to one muscle group, arrays of shape (n,)."""

    #: Moment arm, signed as in equation (1): triceps positive, tibialis negative [m].
    arm: FloatArray
    #: `length`, `speed`: length [m] and lengthening speed [m/s] of the muscle with a rigid tendon.
    length: FloatArray
    speed: FloatArray
    slope: FloatArray  #: dx/dθ, lengthening with the angle [m/rad].
    #: `bend`, `arm_slope`: derivatives by the angle of `slope` [m/rad²] and of `arm` [m/rad].
    bend: FloatArray | float
    arm_slope: FloatArray | float
    #: Of `speed`, the derivative by the angle that a moving second joint makes [m/s/rad].
    swept: FloatArray | float = 0.0


def paths(
    *,
    angle: FloatArray,
    velocity: FloatArray,
    options: ModelOptions,
    second: tuple[FloatArray, ...] = (),
) -> tuple[Path, Path]:
    """Paths of both groups, triceps first; `second` is angle and velocity of a second joint."""
    if isinstance(options.geometry, GeometryTable):
        table = options.geometry
        tri, tib = (_of_table(options, table, g, angle, velocity, second) for g in (0, 1))
    else:
        tri, tib = (_assumed(options, g, angle, velocity) for g in (0, 1))
    return tri, tib


def _assumed(options: ModelOptions, group: int, angle: FloatArray, velocity: FloatArray) -> Path:
    length, slope = muscle_length(angle, group, options)
    sign = _SIGNS[group]
    arm_slope = sign * ARMS[group][1]
    # by virtual work the slope is the arm and bends with it; the printed product does not bend
    bends = options.geometry == "virtual-work"
    arm = sign * moment_arm(angle, group)
    return Path(arm, length, slope * velocity, slope, bends * arm_slope, arm_slope)


def _of_table(
    options: ModelOptions,
    table: GeometryTable,
    group: int,
    angle: FloatArray,
    velocity: FloatArray,
    second: tuple[FloatArray, ...],
) -> Path:
    """Path of a group by a table, whose lengths are those of muscle and tendon.

    Where it states no slack lengths, those of another joint's tendons are taken off; of the ankle's
    muscles the length at 0 rad is as assumed.
    """
    other, turning = second or (None, 0.0)
    length, slope, bend, arm, arm_slope, across, twist = table.at(group, angle, other)
    if not table.slack:
        joint = options.anatomy
        rest = (options.x_ref_tri, options.x_ref_tib)[group] - float(
            table.at(group, np.zeros(1))[0][0]
        )
        length = length + (rest if joint == ANKLE else -joint.slack[group])
    speed = slope * velocity + across * turning
    return Path(arm, length, speed, slope, bend, arm_slope, twist * turning)


@dataclass(frozen=True, slots=True)
class JointAngle:
    """θ_joint [rad] and two derivatives by the device's angle, (n,), or the slopes of all three."""

    angle: FloatArray
    factor: FloatArray
    bend: FloatArray


class JointAxis:
    """A joint (`forward`, `up`) [m] from the device's axis, with the device at an `angle` [rad].

    The foot is pinned at the ankle and strapped to the plate at R = `strap` [m] from the device's
    axis, where it may slide along the sole. With the ankle at a = (forward, up), the foot points to
    the strap:

        θ_joint(θ) = ∠(R·(cos θ, sin θ) − a) − ∠((R, 0) − a)

    No work is lost, so that the device measures the ankle's torque times dθ_joint/dθ; foot and
    plate count as turning together. Two centimetres forward change the torque by more than a tenth;
    the 5 to 9 % that Arampatzis et al. (2007) measured are an offset of about one.

    A. Arampatzis, G. De Monte, G. Morey-Klapsing (2007). Effect of contraction form and contraction
    velocity on the differences between resultant and measured ankle joint moments. Journal of
    Biomechanics 40(7):1622-1628.
    """

    def __init__(
        self, *, angle: FloatArray, forward: float, up: float, strap: float = ANKLE.distance
    ) -> None:
        self._strap = strap
        self._cos, self._sin = np.cos(angle), np.sin(angle)
        self._x = strap * self._cos - forward
        self._y = strap * self._sin - up
        self._x0 = strap - forward
        self._y0 = -up
        self._along = forward * self._cos + up * self._sin
        self._across = up * self._cos - forward * self._sin
        self._at = (forward, up)
        self._inside = strap**2 - forward**2 - up**2
        self._square = self._x**2 + self._y**2  # of the distance from ankle to strap
        self.joint = JointAngle(
            np.arctan2(self._y, self._x) - np.arctan2(self._y0, self._x0),
            strap * (strap - self._along) / self._square,
            strap * self._across * self._inside / self._square**2,
        )

    def slope(self, name: str) -> JointAngle:
        """Derivatives of `joint` by ``"angle"``, ``"forward"`` or ``"up"``."""
        joint = self.joint
        (forward, up) = self._at
        strap = self._strap
        if name == "angle":
            turned = joint.factor
            along = self._across
            across = -self._along
            inside = 0.0
        else:
            square = self._x0**2 + self._y0**2
            if name == "forward":
                turned = self._y / self._square - self._y0 / square
                along = self._cos
                across = -self._sin
                inside = -2.0 * forward
            else:
                turned = self._x0 / square - self._x / self._square
                along = self._sin
                across = self._cos
                inside = -2.0 * up
        farther = -(inside + 2.0 * strap * along) / self._square  # of the square's logarithm
        bend = strap * (across * self._inside + self._across * inside) / self._square**2
        return JointAngle(
            turned,
            -strap * along / self._square - joint.factor * farther,
            bend - 2.0 * joint.bend * farther,
        )
