"""A leg with known parameters, asked what a clinician asks: its muscles at an angle.

Everything here is statics in the ankle's own angle; zeros, delays and axes of a laboratory have no
part in it. Lengths, arms and the balance of muscle and tendon are those of `surae.model`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from surae.errors import ComputationError
from surae.estimation import FitResult
from surae.model import ModelOptions, ModelSpec, Simulator, TorqueParts, get_model
from surae.model.contraction import force_length_partials
from surae.model.equilibrium import solve
from surae.model.geometry import paths
from surae.model.tendon import SLACK_TIB, SLACK_TRI, TendonCurve, tendon_curve, tendon_force
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Triceps surae and tibialis anterior, in the order of everything that has two groups.
GROUPS = ("tri", "tib")
#: Percentile of the active state that counts as the largest activity of a recording.
_LARGEST = 99.0
#: The slow stretch: from, beyond the end of, and by [deg]; its speed [deg/s].
_STRETCH, _STRETCHING = (-30.0, 40.1, 0.2), 5.0
#: 1/h of an implicit step so long that nothing moves [1/s].
_STILL = 1e-9
_DEGREE = np.pi / 180.0
#: Angles beyond which no length is looked for [deg].
_TURN = 150.0


class NotDefinedError(Exception):
    """A measure that a leg does not have, with the reason as a sentence."""


@dataclass(frozen=True, slots=True)
class Hold:
    """A muscle group that holds still at an angle."""

    force: float  #: On its tendon [N].
    #: Of muscle and tendon in series, by the length of both together, tissue fully relaxed [N/m].
    stiffness: float
    quick: float  #: The same before tissue relaxes [N/m].
    length: float  #: Of the muscle [m].
    #: By how much the muscle lengthens of what both together do, slowly [-]; 1 on a rigid tendon.
    given: float
    #: `arm`, `slope`: moment arm [m], and length of both together by the angle [m/rad].
    arm: float
    slope: float
    arm_slope: float  #: Moment arm by the angle [m/rad].

    @property
    def torque(self) -> float:
        """Torque of the muscle on the ankle, positive where the triceps pulls [Nm]."""
        return self.arm * self.force

    def torque_slope(self, stiffness: float) -> float:
        """Torque by the angle for a stiffness of this muscle [Nm/deg]."""
        return (self.arm_slope * self.force + self.arm * stiffness * self.slope) * _DEGREE


@dataclass(frozen=True)
class Leg:
    """A leg of one model with one set of parameters, and the recordings it was measured in."""

    #: `spec`, `options`: the model.
    spec: ModelSpec
    options: ModelOptions
    values: Mapping[str, float]  #: Every parameter of the model.
    inputs: tuple[ModelInputs, ...] = ()  #: Recordings; empty where only the leg itself is asked.
    _holds: dict[tuple[str, float, float], Hold] = field(default_factory=dict, compare=False)

    @property
    def is_of_2010(self) -> bool:
        """Whether it is the model of 2010, which has neither relaxation nor a passive tibialis."""
        return "F0" in self.values

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
        """l0 [m]; of the model of 2010 the length at 0 rad."""
        if self.is_of_2010:
            return self.rigid_length(group, 0.0)
        return self.values[f"l0_{group}"]

    def rigid_length(self, group: str, degrees: float) -> float:
        """Length of muscle and tendon together beyond the tendon's slack length [m]."""
        return _path(group, degrees, self.options)[0]

    def angle_of(self, group: str, length: float) -> float:
        """Angle [deg] at which muscle and tendon, but for its slack length, are so long."""
        from scipy.optimize import brentq

        def beyond(degrees: float) -> float:
            return self.rigid_length(group, degrees) - length

        if not beyond(-_TURN) * beyond(_TURN) < 0.0:
            raise NotDefinedError("no angle of the ankle makes the muscle so long")
        return float(brentq(beyond, -_TURN, _TURN, xtol=1e-8))

    def tendon(self, group: str) -> TendonCurve:
        """The tendon's curve, as `surae.model.tendon.tendon_force` takes it."""
        if not self.is_compliant:
            raise NotDefinedError("the tendons of this model are rigid")
        v = self.values
        eps0 = v[f"dlt_{group}"]
        if self.options.tendon_strain == "slack-length":
            eps0 *= slack_length(group)
        return tendon_curve(eps0, v[f"pt_{group}"], v[f"kt_{group}"], v[f"fmax_{group}"])

    def hold(self, group: str, degrees: float, alpha: float = 0.0) -> Hold:
        """A muscle group at an angle with an active state α [N], tissue fully relaxed."""
        key = (group, degrees, alpha)
        if key not in self._holds:
            self._holds[key] = self._held(*key)
        return self._holds[key]

    def _held(self, group: str, degrees: float, alpha: float) -> Hold:
        x, slope, arm, arm_slope = _path(group, degrees, self.options)
        l0, v = self.optimal_length(group), self.values
        if self.is_of_2010 and group == "tib":
            k, elastic, shift = 0.0, 0.0, 0.0
        else:
            k, shift = v[f"k_{group}"], v.get("F0", 0.0)
            elastic = float(np.exp(k * (x - v[f"x0_{group}"])))
        if not self.is_compliant:
            lift, lift_slope = _force_length(x, l0)
            own = alpha * lift_slope
            force = self.relaxed * elastic + shift + alpha * lift
            slow = self.relaxed * k * elastic + own
            quick = k * elastic + own
            return Hold(force, slow, quick, x, 1.0, arm, slope, arm_slope)
        muscle = (k, v[f"x0_{group}"], l0, self.options.vmax_factor * l0)
        step = (x, x, _STILL, self.relaxed, 0.0, alpha)
        solved, e, here = solve(0.0, muscle, self.tendon(group), step)
        if not solved:
            raise ComputationError("muscle and tendon have no finite balance with these parameters")
        force, stiff = here[2], here[3]
        elastic = float(np.exp(k * (x - e - v[f"x0_{group}"])))
        own = alpha * _force_length(x - e, l0)[1]
        slow, quick = self.relaxed * k * elastic + own, k * elastic + own
        return Hold(
            force, _series(stiff, slow), _series(stiff, quick), x - e, stiff / (stiff + slow), arm,
            slope, arm_slope,
        )  # fmt: skip

    def active_torque(self, group: str, degrees: float, alpha: float) -> float:
        """What an active state α [N] adds to the pull at an angle [Nm]; never below zero."""
        pull = self.hold(group, degrees, alpha).torque - self.hold(group, degrees).torque
        return abs(pull)

    @cached_property
    def largest_activity(self) -> Mapping[str, float]:
        """Largest active state α of each group in the recordings [N]: its 99th percentile."""
        if not self.inputs:
            raise NotDefinedError("no recording says how active the muscles were")
        states = [self._simulator(inputs).active_states(self._vector) for inputs in self.inputs]
        alpha = np.concatenate(states, axis=1)
        return dict(zip(GROUPS, np.percentile(alpha, _LARGEST, axis=1).tolist(), strict=True))

    @cached_property
    def parts(self) -> tuple[TorqueParts, ...]:
        """What the modelled torque of each recording is made of."""
        return tuple(self._simulator(inputs).parts(self._vector) for inputs in self.inputs)

    def passive_torque(self, degrees: FloatArray, rate_hz: float) -> FloatArray:
        """Passive torque [Nm] of a leg without activity that is turned so, shape (n,)."""
        spec, angle = get_model(self.spec.name), degrees * _DEGREE
        velocity = np.gradient(angle, 1.0 / rate_hz)
        still = np.zeros((len(angle), 4))
        turned = ModelInputs(
            "turned", rate_hz, np.arange(len(angle)) / rate_hz, angle, velocity,
            np.zeros_like(angle), still, "V", None, prepared=True,
        )  # fmt: skip
        values = np.array([self.values[name] for name in spec.names])
        return spec.simulator(turned, self.options).parts(values).tissue

    @cached_property
    def slow_stretch(self) -> tuple[FloatArray, FloatArray]:
        """Angles [deg] and passive torque [Nm] of a stretch from −30° to 40° at 5°/s."""
        degrees = np.arange(*_STRETCH)
        return degrees, self.passive_torque(degrees, _STRETCHING / _STRETCH[2])

    @property
    def _vector(self) -> FloatArray:
        return np.array([self.values[name] for name in self.spec.names])

    def _simulator(self, inputs: ModelInputs) -> Simulator:
        return self.spec.simulator(inputs, self.options)


@lru_cache(maxsize=4096)
def _path(group: str, degrees: float, options: ModelOptions) -> tuple[float, float, float, float]:
    """Length [m], its slope [m/rad], moment arm [m] and its slope [m/rad] at an angle."""
    angle = np.array([degrees * _DEGREE])
    path = paths(angle=angle, velocity=np.zeros(1), options=options)[GROUPS.index(group)]
    return float(path.length[0]), float(path.slope[0]), float(path.arm[0]), path.arm_slope


def slack_length(group: str) -> float:
    """Slack length of a tendon [m] (thesis Table 2)."""
    return SLACK_TRI if group == "tri" else SLACK_TIB


def elongation(curve: TendonCurve, force: float) -> float:
    """Elongation of a tendon at a force [m]: equation (18) turned round."""
    e_toe, bend, scale, k_lin, offset = curve
    if force <= tendon_force(e_toe, curve)[0]:
        return float(np.log1p(force / scale) / bend)
    return (force - offset) / k_lin


def _force_length(x: float, l0: float) -> tuple[float, float]:
    value, slope, _ = force_length_partials(x, l0)
    return value, slope


def _series(a: float, b: float) -> float:
    return a * b / (a + b) if a + b else 0.0


def measured_range(result: FitResult) -> tuple[float, float]:
    """Lowest and highest angle of the samples that count [deg]."""
    angles = [
        recording.angle if recording.weight is None else recording.angle[recording.weight > 0]
        for recording in result.problem.inputs
    ]
    low, high = np.degrees(np.percentile(np.concatenate(angles), [0.5, 99.5]))
    return float(low), float(high)
