"""A leg with known parameters and what clinicians want to know: its muscles at an angle.

Everything here is statics in the ankle's own angle; zeros, delays and axes of a laboratory have no
part in it. Lengths, arms and the balance of muscle and tendon are those of `surae.model`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from surae.base.errors import ComputationError
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.result import LARGEST
from surae.inference.uncertainty.combined import ZERO
from surae.measures.muscle import Muscle, MuscleHold, MusclePlace, elongation, series
from surae.measures.turned import held_still, tied_to_angles
from surae.model import GeometryTable, ModelOptions, ModelSpec, Simulator, TorqueParts
from surae.model.contraction import FECC, MVSH
from surae.model.equilibrium import FREE, solve
from surae.model.geometry import JointAxis, paths
from surae.model.movement import OWN_PATH
from surae.model.parameters import JOINT_RESTS, OPTIONAL
from surae.model.tendon import TendonCurve, tendon_curve
from surae.signals import ModelInputs

#: Triceps surae and tibialis anterior, in the order of everything that has two groups.
GROUPS = ("tri", "tib")
#: Degrees of movement that are no range.
_LITTLE = 2.0
#: The slow stretch: from, beyond the end of, and by [deg]; its speed [deg/s].
_STRETCH = (-30.0, 40.1, 0.2)
_STRETCHING = 5.0
#: 1/h of an implicit step so long that nothing moves [1/s].
_STILL = 1e-9
_DEGREE = np.pi / 180.0
#: How parameters begin that are the paths and curves of a leg.
_OF_LEG = ("arm_", "path_", "length_", "fl_", "fv_", "joint_")
#: Angles between which a length is looked for [deg].
_ENDS = (-150.0, 150.0)


class NotDefinedError(Exception):
    """A measure that a leg does not have: the code of the reason, or a sentence, and its values."""

    def __init__(self, code: str, **values: object) -> None:
        super().__init__(Message(code, **values))
        self.code = code
        self.values = values


@dataclass(frozen=True)
class Leg:
    """A leg of one model with one set of parameters, and the recordings it was measured in."""

    #: `spec`, `options`: the model.
    spec: ModelSpec
    options: ModelOptions
    values: Mapping[str, float]  #: Every parameter of the model.
    inputs: tuple[ModelInputs, ...] = ()  #: Recordings; empty where only the leg itself is asked.
    #: Ends of the range that was moved, by the angle of the fit [deg]; None without recordings.
    moved: tuple[float, float] | None = None
    #: By how much the torque says that EMG was stronger than it shows, of each group.
    gained: tuple[float, ...] = (1.0, 1.0)
    #: The recordings at a rate that tells how sums over them change with the leg; empty where those
    #: are of every sample.
    thin: tuple[ModelInputs, ...] = ()
    _holds: dict[tuple[str, float, float], MuscleHold] = field(default_factory=dict, compare=False)
    _muscles: dict[str, Muscle] = field(default_factory=dict, compare=False)
    _angles: dict[tuple[str, float], float] = field(default_factory=dict, compare=False)
    # What all legs of these recordings and options share:
    _ties: dict[str, list[Simulator]] = field(default_factory=dict, compare=False)
    _geometry: dict[tuple[float, float | None], tuple[MusclePlace, MusclePlace]] = field(
        default_factory=dict, compare=False
    )

    def with_values(self, values: Mapping[str, float]) -> "Leg":
        """The leg with other values of some parameters, in the same recordings."""
        together = {**self.values, **values}
        return replace(self, values=together, _holds={}, _muscles={}, _angles={})

    @property
    def is_compliant(self) -> bool:
        """Whether its tendons give way."""
        return "dlt_tri" in self.values

    @property
    def has_normalised_emg(self) -> bool:
        """Whether its EMG is a part of a reference and not in volts."""
        return bool(self.inputs) and self.inputs[0].emg_unit == "1"

    @property
    def relaxed(self) -> float:
        """Part of the elastic force that is left when all has relaxed, 1/(1 + k_rel) of (10)."""
        return 1.0 / (1.0 + self.values.get("k_rel", 0.0))

    def optimal_length(self, group: str) -> float:
        """l0 [m]; of a model without one the length at 0 rad."""
        length = self.values.get(f"l0_{group}")
        return self.rigid_length(group, 0.0) if length is None else length

    def rigid_length(self, group: str, degrees: float) -> float:
        """Length of muscle and tendon together beyond the tendon's slack length [m]."""
        return self._path(group, degrees * _DEGREE).length

    def _path(self, group: str, angle: float) -> MusclePlace:
        """Path of a group at an angle, as of `surae.model.movement` where the leg has its own."""
        scale, bent, bend, longer, turn, zero = self._own_path[GROUPS.index(group)]
        angle += self.values.get(ZERO, 0.0)
        length, slope, arm, arm_slope = self._assumed(group, angle, self._second)
        rest = self._assumed(group, 0.0, None).length
        grown = math.exp(scale)
        stretch = math.exp(longer)
        factor = 1.0 + (bent + bend * angle) * angle
        turned = arm_slope * factor + arm * (bent + 2.0 * bend * angle)
        return MusclePlace(
            rest + zero + stretch * (length - rest) + turn * angle**2,
            stretch * slope + 2.0 * turn * angle,
            grown * arm * factor,
            grown * turned,
        )

    @cached_property
    def _own_path(self) -> list[list[float]]:
        return [[self.values.get(f"{name}_{g}", 0.0) for name in OWN_PATH] for g in GROUPS]

    def _assumed(self, group: str, angle: float, second: float | None) -> MusclePlace:
        """Path of a group as the geometry assumes it, with a second joint at an angle [rad]."""
        key = angle, second
        if key not in self._geometry:
            # without a table: a number without a dimension takes half the time of one sample
            shape = (1,) if isinstance(self.options.geometry, GeometryTable) else ()
            at = np.full(shape, angle)
            still = held_still(second, 1)
            both = paths(angle=at, velocity=np.zeros(shape), options=self.options, second=still)
            tri, tib = (
                MusclePlace(
                    *(
                        of.item() if isinstance(of, np.ndarray) else float(of)
                        for of in (path.length, path.slope, path.arm, path.arm_slope)
                    )
                )
                for path in both
            )
            self._geometry[key] = tri, tib
        return self._geometry[key][GROUPS.index(group)]

    @cached_property
    def _second(self) -> float | None:
        """Angle at which a second joint holds still: its mean in the recordings [rad]."""
        means = [float(inputs.second[0].mean()) for inputs in self.inputs if inputs.second]
        return sum(means) / len(means) if means else None

    def range_to(self, end: float) -> tuple[float, float]:
        """The range that was moved [deg], to a stated end or, of infinity, to its own."""
        if self.moved is None:
            raise NotDefinedError("none/range")
        low, high = (each - self.values.get(ZERO, 0.0) / _DEGREE for each in self.moved)
        if min(high, end) - low < _LITTLE:
            raise NotDefinedError("none/moved")
        return low, high if end == math.inf else end

    def turned(self, degrees: float) -> float:
        """Angle of the ankle [deg] at one of the movement, whose axis lies beside the device's.

        Where the ankle was at the device's end its torque was measured, wherever the axis is.
        """
        forward, up = (self.values.get(name, 0.0) for name in OPTIONAL["axis"])
        if not (forward or up):
            return degrees
        off = self.values.get(ZERO, 0.0)
        axis = JointAxis(
            angle=np.array(degrees * _DEGREE + off),
            forward=forward,
            up=up,
            strap=self.options.anatomy.distance,
        )
        return float(axis.joint.angle - off) / _DEGREE

    def joint_torque(self, degrees: float) -> float:
        """Torque of the joint's own tissue at an angle [Nm]."""
        of = self.values.get
        turned = degrees * _DEGREE - JOINT_RESTS + self._off
        torque = of("joint_stiffness", 0.0) * turned + of("joint_torque", 0.0)
        if self.options.tissue is not None:
            torque += self.options.tissue.relaxed(degrees + self._off / _DEGREE)
        return torque

    def joint_slope(self, degrees: float) -> float:
        """Stiffness of the joint's own tissue at an angle [Nm/deg]."""
        slope = self.values.get("joint_stiffness", 0.0) * _DEGREE
        if self.options.tissue is not None:
            slope += self.options.tissue.slope(degrees + self._off / _DEGREE)
        return slope

    @property
    def _off(self) -> float:
        """What the device shows where the ankle has its own zero [rad]."""
        return self.values.get(ZERO, 0.0) - self.values.get("angle_zero", 0.0)

    def angle_of(self, group: str, length: float) -> float:
        """Angle [deg] at which muscle and tendon, but for its slack length, are so long."""
        from scipy.optimize import brentq

        def missing(degrees: float) -> float:
            return self.rigid_length(group, degrees) - length

        if (group, length) not in self._angles:
            if not missing(_ENDS[0]) * missing(_ENDS[1]) < 0.0:
                raise NotDefinedError("none/long")
            self._angles[group, length] = float(brentq(missing, *_ENDS, xtol=1e-12))
        return self._angles[group, length]

    def tendon(self, group: str) -> TendonCurve:
        """The tendon's curve, as `surae.model.tendon.tendon_force` takes it."""
        curve = self._muscle(group).curve
        if curve is None:
            raise NotDefinedError("none/rigid")
        return curve

    def _muscle(self, group: str) -> Muscle:
        if group not in self._muscles:
            v = self.values
            curve = None
            if self.is_compliant:
                eps0 = v[f"dlt_{group}"]
                if self.options.tendon_strain != "thesis":
                    eps0 *= self.options.anatomy.slack[GROUPS.index(group)]
                curve = tendon_curve(eps0, v[f"pt_{group}"], v[f"kt_{group}"], v[f"fmax_{group}"])
            k = 0.0
            x0 = math.inf
            shift = 0.0
            if f"k_{group}" in v:
                k = v[f"k_{group}"]
                x0 = v[f"x0_{group}"]
                shift = v.get("F0", 0.0)
            l0 = self.optimal_length(group)
            shape = self.curves(group)
            self._muscles[group] = Muscle(k, x0, l0, self.relaxed, shift, shape, curve)
        return self._muscles[group]

    def curves(self, group: str) -> tuple[float, float, float, float]:
        """What shapes (16) and (17), as of `surae.model.equilibrium`: widths, mvsh, fecc − 1."""
        of = self.values.get
        bend = math.exp(of("fv_curve", 0.0))
        gain = math.exp(of("fv_stretch", 0.0))
        widths = of(f"fl_short_{group}", 0.0), of(f"fl_long_{group}", 0.0)
        return *widths, MVSH * bend, (FECC - 1.0) * gain

    def greatest_speed(self, group: str) -> float:
        """Greatest speed of shortening, vmax of (17) [m/s]."""
        factor = self.options.vmax_factor * math.exp(self.values.get("fv_speed", 0.0))
        return factor * self.optimal_length(group)

    def hold(self, group: str, degrees: float, alpha: float = 0.0) -> MuscleHold:
        """A muscle group at an angle with an active state α [N], tissue fully relaxed."""
        key = (group, degrees, alpha)
        if key not in self._holds:
            self._holds[key] = self._computed_hold(*key)
        return self._holds[key]

    def _computed_hold(self, group: str, degrees: float, alpha: float) -> MuscleHold:
        k, x0, l0, relaxed, shift, shape, curve = muscle = self._muscle(group)
        x, slope, arm, arm_slope = self._path(group, degrees * _DEGREE)
        if curve is None:
            elastic = muscle.elastic(x)
            (lift, lift_slope) = muscle.lift(x)
            bridges = alpha * lift_slope
            force = relaxed * elastic + shift + alpha * lift
            slow = relaxed * k * elastic + bridges
            quick = k * elastic + bridges
            return MuscleHold(force, slow, quick, x, 1.0, arm, slope, arm_slope, lift)
        step = (x, x, _STILL, relaxed, 0.0, alpha, 0.0)
        unit = (k, x0, l0, self.greatest_speed(group), *shape)
        solved, e, here = solve(0.0, unit, curve, step, FREE)
        if not solved:
            raise ComputationError("muscle and tendon have no finite balance with these parameters")
        force = here[2]
        stiff = here[3]
        elastic = muscle.elastic(x - e)
        lift, lift_slope = muscle.lift(x - e)
        bridges = alpha * lift_slope
        slow = relaxed * k * elastic + bridges
        quick = k * elastic + bridges
        return MuscleHold(
            force,
            series(stiff, slow),
            series(stiff, quick),
            x - e,
            stiff / (stiff + slow),
            arm,
            slope,
            arm_slope,
            lift,
        )

    def active_torque(self, group: str, degrees: float, alpha: float) -> float:
        """What an active state α [N] adds to the pull at an angle [Nm]; never below zero."""
        pull = self.hold(group, degrees, alpha).torque - self.hold(group, degrees).torque
        return abs(pull)

    def active_state(self, group: str, degrees: float, torque: float) -> float:
        """The active state α [N] that adds a torque [Nm] to the pull at an angle."""
        rest = self.hold(group, degrees)
        muscle = self._muscle(group)
        force = rest.force + torque / abs(rest.arm)
        x = rest.length
        tissue = rest.force
        if muscle.curve is not None:
            x = self.rigid_length(group, degrees) - elongation(muscle.curve, force)
            tissue = self.relaxed * muscle.elastic(x)
        return (force - tissue) / muscle.lift(x)[0]

    @cached_property
    def largest_activity(self) -> Mapping[str, float]:
        """Largest active state α of each group in the recordings [N]: its 99th percentile.

        Where an electrode's gain drifts, it is the state that the torque tells.
        """
        if not self.inputs:
            raise NotDefinedError("none/activity")
        largest = _largest(self.active_states)
        return {g: by * largest[g] for g, by in zip(GROUPS, self.gained, strict=True)}

    @cached_property
    def largest_force(self) -> Mapping[str, float]:
        """Largest force on each tendon in the recordings [N]: its 99th percentile."""
        if not self.inputs:
            raise NotDefinedError("none/pull")
        return _largest([force for _, force, _ in self.split])

    @cached_property
    def active_states(self) -> list[FloatArray]:
        """Active states α of both groups in each recording [N], shape (2, n) each."""
        return self._of_each("activity", self.inputs)

    @property
    def summed(self) -> tuple[ModelInputs, ...]:
        """The recordings that torque is split in."""
        return self.thin or self.inputs

    @cached_property
    def split(self) -> list[tuple[TorqueParts, FloatArray, FloatArray]]:
        """What the torque of each of `summed` is made of, as of `Simulator.split`."""
        return self._of_each("split", self.summed, "summed")

    @cached_property
    def split_whole(self) -> list[tuple[TorqueParts, FloatArray, FloatArray]]:
        """The same of all samples of each recording."""
        return self._of_each("split", self.inputs) if self.thin else self.split

    def _of_each(
        self, what: str, recordings: Sequence[ModelInputs], kept: str = "whole"
    ) -> list[Any]:
        values = np.array([self.values[name] for name in self.spec.names])
        if kept not in self._ties:
            self._ties[kept] = [self.spec.simulator(each, self.options) for each in recordings]
        return [getattr(tie, what)(values) for tie in self._ties[kept]]

    @cached_property
    def shares(self) -> Mapping[str, tuple[float, float]]:
        """Sums over the recordings of the size of each part's torque [Nm·s], and of its power."""
        sums = dict.fromkeys(("tissue", "neural", "inertial", "gravitational"), (0.0, 0.0))
        for (parts, *_), inputs in zip(self.split, self.summed, strict=True):
            speed = np.abs(inputs.velocity)
            for part, before in sums.items():
                size = np.abs(getattr(parts, part))
                torque, power = (float(np.sum(of)) / inputs.rate_hz for of in (size, speed * size))
                sums[part] = before[0] + torque, before[1] + power
        return sums

    def passive_torque(self, degrees: Sequence[float], rate_hz: float) -> FloatArray:
        """Passive torque [Nm] of a leg without activity that is turned so, shape (n,)."""
        optional = (*(n for n in self.spec.optional if n.startswith(_OF_LEG)), "angle_zero")
        tissue = self.options.tissue
        bare = self.options if tissue is None else replace(self.options, tissue=None)
        names, simulator = tied_to_angles(
            self.spec.name, optional, bare, tuple(degrees), rate_hz, self._second
        )
        values = {**self.values, "m": 0.0, "angle_zero": self.values.get(ZERO, 0.0)}  # no limb
        torque = simulator.torque(np.array([values[name] for name in names]))
        if tissue is not None:
            torque += tissue.along(np.array(degrees) + self._off / _DEGREE, rate_hz)
        return torque + self.values.get("joint_stiffness", 0.0) * self._off

    @cached_property
    def slow_stretch(self) -> tuple[FloatArray, FloatArray]:
        """Angles [deg] and passive torque [Nm] of a stretch from −30° to 40° at 5°/s."""
        degrees = np.arange(*_STRETCH)
        return degrees, self.passive_torque(degrees.tolist(), _STRETCHING / _STRETCH[2])


def _largest(of: Sequence[FloatArray]) -> dict[str, float]:
    """By group, the 99th percentile of what all recordings have of both, shape (2, n) each."""
    most = np.percentile(np.concatenate(of, axis=1), LARGEST, axis=1)
    return dict(zip(GROUPS, most.tolist(), strict=True))
