"""What a recording's movement does to limb and muscles, as far as its sensors can be believed.

The angle that is measured is that of the device, and of its zero: the joint's is that of
`surae.model.geometry` at θ + angle_zero − plate_give·T, with the joint's axis at (axis_forward,
axis_up). T is the measured torque, or the model's own where that is given: the noise of the
measured one would be followed by the angle that it turns. Everything in the leg follows the joint,
and all its torque is felt by the device times dθ_joint/dθ.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.model.geometry import JointAngle, JointAxis, Path, paths
from surae.model.joint import ANKLE
from surae.model.options import ModelOptions
from surae.model.parameters import OPTIONAL
from surae.signals import ModelInputs, smooth_effort

GRAVITY = 9.81  #: Of the foot and the plate, as the thesis has it [m/s²].


def inertia_torque(*, acceleration: FloatArray, distance: float = ANKLE.distance) -> FloatArray:
    """Inertial torque of a mass of 1 kg, equations (1) and (6): la²·θ''.

    Parameters
    ----------
    acceleration : ndarray
        Angular acceleration [rad/s²].
    distance : float
        Of the point mass from the axis, la [m].

    Returns
    -------
    ndarray
        Torque per mass [Nm/kg].
    """
    return distance**2 * acceleration


def gravity_torque(
    *, angle: FloatArray, theta_foot: float, distance: float = ANKLE.distance
) -> tuple[FloatArray, FloatArray]:
    """Gravitational torque of a mass of 1 kg, equation (7): g·la·cos(θ − θ_foot), and its slope.

    Parameters
    ----------
    angle : ndarray
        Angle of the joint [rad].
    theta_foot : float
        Angle of foot or hand to the horizontal at θ = 0 [rad].
    distance : float
        Of the point mass from the axis, la [m].

    Returns
    -------
    torque, slope : ndarray
        Torque per mass [Nm/kg], and its derivative by the angle [Nm/(kg·rad)].
    """
    turned = angle - theta_foot
    return GRAVITY * distance * np.cos(turned), -GRAVITY * distance * np.sin(turned)


_AXIS = OPTIONAL["axis"]
_GIVE = "plate_give"
#: What turns the joint, and what it is to `JointAxis`.
_TURNING = {"angle_zero": "angle", **dict(zip(_AXIS, ("forward", "up"), strict=True)), _GIVE: ""}
#: What changes a muscle's path, and the same by group.
OWN_PATH = ("arm_scale", "arm_slope", "arm_bend", "path_scale", "path_bend", "length_zero")
_PATH = tuple(tuple(f"{of}_{group}" for of in OWN_PATH) for group in ("tri", "tib"))
_MOVING = (*_TURNING, *_PATH[0], *_PATH[1])


@dataclass(frozen=True, slots=True)
class MusclePath:
    """Path of one muscle group as the device's torque knows it."""

    #: `arm`, `length`, `speed`: signed moment arm [m], length [m] and lengthening speed [m/s] on a
    #: rigid tendon, shape (n,).
    arm: FloatArray
    length: FloatArray
    speed: FloatArray
    #: `arm_slopes`, `length_slopes`, `speed_slopes`: derivatives of the three by the parameters of
    #: `LegMovement.columns`, shape (s, n).
    arm_slopes: FloatArray
    length_slopes: FloatArray
    speed_slopes: FloatArray


@dataclass(frozen=True, slots=True)
class LegMovement:
    """Limb and muscles of a moving leg."""

    #: `inertia`, `gravity`: torques of 1 kg [Nm/kg], shape (n,).
    inertia: FloatArray
    gravity: FloatArray
    muscles: tuple[MusclePath, MusclePath]  #: Triceps surae and tibialis anterior.
    columns: tuple[int, ...]  #: Columns of the wanted parameters that touch it.
    #: Derivatives of inertia and gravity together by those parameters, shape (s, n).
    limb_slopes: FloatArray


class Movement:
    """The movement of one recording; computed anew where what touches it has changed.

    `at` holds the columns of the model's parameters.
    """

    def __init__(self, inputs: ModelInputs, options: ModelOptions, at: Mapping[str, int]) -> None:
        self._inputs = inputs
        self._options = options
        self._at = {name: at[name] for name in _MOVING if name in at}
        self._pull = self._pull_rate = np.zeros(inputs.n)
        self._made: tuple[object, LegMovement] | None = None  # the last one, and of what
        # who predicts while it is measured has no torque yet
        if _GIVE in at and inputs.torque is not None and inputs.effort is None:
            self.pulled_by(inputs.torque)

    def pulled_by(self, torque: FloatArray) -> None:
        """Let a plate that gives way be turned by this torque [Nm], as smooth as effort is."""
        self._pull = smooth_effort(torque[None], self._inputs.rate_hz)[0]
        self._pull_rate = np.gradient(self._pull, 1.0 / self._inputs.rate_hz)
        self._made = None

    def at(self, values: FloatArray, wanted: Collection[int] = ()) -> LegMovement:
        """The movement at these parameters, with its derivatives by the wanted columns."""
        turns = {name: float(values[column]) for name, column in self._at.items()}
        columns = {name: column for name, column in self._at.items() if column in wanted}
        key = (turns, columns)
        made = self._made
        if made is None or made[0] != key:
            made = self._made = key, self._moved(turns, columns)
        return made[1]

    def _moved(self, given: Mapping[str, float], columns: Mapping[str, int]) -> LegMovement:
        inputs = self._inputs
        options = self._options
        velocity = inputs.velocity
        acceleration = inputs.acceleration
        distance = options.anatomy.distance
        angle = inputs.angle + given.get("angle_zero", 0.0)
        if _GIVE in given:
            angle = angle - given[_GIVE] * self._pull
            velocity = velocity - given[_GIVE] * self._pull_rate
        still = np.zeros_like(angle)
        same = np.ones_like(angle)
        turning = [name for name in columns if name in _TURNING]
        joint = JointAngle(angle, same, still)
        slopes = [JointAngle(same, still, still)] * len(turning)
        if _AXIS[0] in given:
            axis = JointAxis(
                angle=angle, forward=given[_AXIS[0]], up=given[_AXIS[1]], strap=distance
            )
            joint = axis.joint
            slopes = [axis.slope(_TURNING[name] or "angle") for name in turning]
        rates = [still] * len(turning)  # what the device's own speed changes by
        if _GIVE in turning:
            at = turning.index(_GIVE)
            back = -self._pull
            by = slopes[at]
            slopes[at] = JointAngle(by.angle * back, by.factor * back, by.bend * back)
            rates[at] = -self._pull_rate
        swinging = joint.factor * acceleration + joint.bend * velocity**2
        inertia = inertia_torque(acceleration=swinging, distance=distance)
        gravity, falling = gravity_torque(
            angle=joint.angle, theta_foot=options.theta_foot, distance=distance
        )
        limb_slopes = np.zeros((len(columns), inputs.n))
        for name, by, rate in zip(turning, slopes, rates, strict=True):
            swung = by.factor * acceleration + by.bend * velocity**2
            swung = swung + 2.0 * joint.bend * velocity * rate
            row = limb_slopes[list(columns).index(name)]
            row += by.factor * (inertia + gravity)
            swung = inertia_torque(acceleration=swung, distance=distance)
            row += joint.factor * (swung + falling * by.angle)
        plain = paths(
            angle=joint.angle,
            velocity=joint.factor * velocity,
            options=options,
            second=inputs.second,
        )
        rest = paths(angle=np.zeros(1), velocity=np.zeros(1), options=options)
        turned = (joint.angle, joint.factor * velocity)
        moved = dict(zip(turning, zip(slopes, rates, strict=True), strict=True))
        muscles = []
        for group, path in enumerate(plain):
            bent, by_own = _own_path(path, float(rest[group].length[0]), *turned, given, group)
            slopes_of = _path_slopes(bent, by_own, list(columns), joint, moved, velocity)
            arm = joint.factor * bent.arm
            muscles.append(MusclePath(arm, bent.length, bent.speed, *slopes_of))
        return LegMovement(
            joint.factor * inertia,
            joint.factor * gravity,
            (muscles[0], muscles[1]),
            columns=tuple(columns.values()),
            limb_slopes=limb_slopes,
        )


def _path_slopes(
    path: Path,
    by_own: Mapping[str, Sequence[FloatArray]],
    columns: Sequence[str],
    joint: JointAngle,
    moved: Mapping[str, tuple[JointAngle, FloatArray]],
    velocity: FloatArray,
) -> FloatArray:
    """Derivatives of a group's arm, length and speed by columns, shape (3, c, n).

    `by_own` has those of the group's own path, `moved` what turns the joint, and by how much that
    changes the device's speed.
    """
    arm, length, speed = by = np.zeros((3, len(columns), len(velocity)))
    for row, name in enumerate(columns):
        if name in by_own:
            arm[row], length[row], speed[row] = by_own[name]
            arm[row] *= joint.factor
        elif name in moved:
            turn, rate = moved[name]
            arm[row] = turn.factor * path.arm + joint.factor * path.arm_slope * turn.angle
            length[row] = path.slope * turn.angle
            swept = path.bend * turn.angle * joint.factor + path.slope * turn.factor
            speed[row] = swept * velocity
            speed[row] += path.slope * joint.factor * rate + path.swept * turn.angle
    return by


def _own_path(
    path: Path,
    at_rest: float,
    angle: FloatArray,
    velocity: FloatArray,
    given: Mapping[str, float],
    group: int,
) -> tuple[Path, dict[str, tuple[FloatArray, FloatArray, FloatArray]]]:
    """A group's path with an arm and a length of its own, and its derivatives by what they are.

    r' = r·e^scale·(1 + slope·θ + bend·θ²),  x' = x(0) + length_zero + e^path·(x − x(0)) + turn·θ².

    Derivatives are of arm, length and speed.
    """
    names = _PATH[group]
    if not any(name in given for name in names):
        return path, {}
    scale, slope, bend, longer, turn, zero = (given.get(name, 0.0) for name in names)
    grown = np.exp(scale)
    still = np.zeros_like(angle)
    bent = grown * (1.0 + slope * angle + bend * angle**2)
    arm = bent * path.arm
    stretch = np.exp(longer)
    travel = stretch * (path.length - at_rest)
    speed = stretch * path.speed
    changed = Path(
        arm,
        at_rest + zero + travel + turn * angle**2,
        speed + 2.0 * turn * angle * velocity,
        stretch * path.slope + 2.0 * turn * angle,
        stretch * path.bend + 2.0 * turn,
        path.arm_slope * bent + grown * path.arm * (slope + 2.0 * bend * angle),
        stretch * path.swept,
    )
    by = (
        (arm, still, still),
        (grown * angle * path.arm, still, still),
        (grown * angle**2 * path.arm, still, still),
        (still, travel, speed),
        (still, angle**2, 2.0 * angle * velocity),
        (still, np.ones_like(angle), still),
    )
    return changed, {name: slopes for name, slopes in zip(names, by, strict=True) if name in given}
