"""What a recording says of muscles that another program has found.

Torque is made of these muscles on their paths in an OpenSim model. What no file says is chosen as
well as it can be: how strong each muscle is for its EMG, the lag of its activation, foot, plate
and the zero of the torque. So the share of the torque that is followed is the most that such
muscles allow. Then each length alone is changed: where torque is followed no less well, a recording
does not tell it, and where it is followed far better, it speaks against it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import lsq_linear

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.exchange.foreign_result import ForeignResult
from surae.exchange.leg_in_model import Head, LegInModel
from surae.exchange.muscles import DeGrooteMuscle, passive_fibre, tendon_strain
from surae.model.movement import GRAVITY
from surae.signals import ModelInputs

#: Samples that are looked at, and lags of the activation that are tried [s].
_SAMPLES = 400
_LAGS = (0.02, 0.05, 0.1, 0.16, 0.25)
#: Parts of a length that are tried, and the change of it that a recording should notice.
_PARTS = tuple(np.geomspace(0.6, 1.6, 13).tolist())
_CHANGE = 0.1
#: A fall of R² [%] below which a recording does not tell a length; what another length must gain,
#: and the part of what is not followed that it must take away, to be spoken for.
_UNTOLD = 0.5
_GAIN = 5.0
_TAKEN = 0.3
#: R² [%] below which muscles do not follow a recording, whatever their gains.
LEAST = 75.0
#: Steps in which a tendon's stretch and its force find each other.
_STEPS = 4
#: Least and most of what is no muscle: zero of the torque [Nm], mass of foot and plate times its
#: distance from the axis along and across the foot [kg·m], their inertia [kg·m²].
_BESIDE = ((-np.inf, 0.0, -0.5, 0.0), (np.inf, 1.0, 0.5, 0.5))
#: Strain of a tendon at the largest force where none is stated, as OpenSim's muscles have it.
_STRAIN = 0.049
_ANGLES = 60
_EMG = {"ta": (0,), "gl": (1,), "sol": (2,), "gm": (3,), "gas": (1, 3)}
_LENGTHS = ("optimal_fiber_length", "tendon_slack_length")
_RIGID = ("NMSM", "CEINMS")


@dataclass(frozen=True, slots=True)
class Told:
    """What a recording says of one length."""

    muscle: str
    parameter: str
    value: float  #: As the program has it [m].
    drop: float  #: By how much R² falls at least where it is a tenth shorter or longer [%].
    better: float  #: The value with the best R² where all else stays [m].
    gain: float  #: What R² gains there [%].

    def is_opposed(self, r2: float) -> bool:
        """Whether another length would be followed far better, where all have an R² [%]."""
        return self.gain >= max(_GAIN, _TAKEN * (100.0 - r2))


@dataclass(frozen=True, slots=True)
class AgainstRecording:
    """What one recording says of a result."""

    recording: str
    r2: float  #: The best that such muscles allow [%].
    lag: float  #: Of the activation, of those that were tried [s].
    told: tuple[Told, ...]

    def verdicts(self) -> dict[tuple[str, str], str]:
        """Verdict of each length by its muscle.

        ``"contradicted"`` where no other muscle could be meant, else ``"disputed"``;
        ``"confirmed"`` where a tenth more or less is followed less well, else ``"untold"``.
        """
        opposed = {t.muscle for t in self.told if t.is_opposed(self.r2)}
        against = "contradicted" if len(opposed) == 1 else "disputed"
        return {
            (t.muscle, t.parameter): against
            if t.is_opposed(self.r2)
            else "confirmed"
            if t.drop >= _UNTOLD
            else "untold"
            for t in self.told
        }


@dataclass(frozen=True, slots=True)
class _Numbers:
    """What a program has of one head."""

    fibre: float
    slack: float
    pennation: float
    force: float
    strain: float  #: Of the tendon at that force; 0 where it is rigid.


def against(result: ForeignResult, leg: LegInModel, inputs: ModelInputs) -> AgainstRecording:
    """What a recording says of a result whose muscles lie in a model.

    Raises
    ------
    InputError
        The recording has no torque or EMG, or the result none of the leg's muscles.
    """
    if inputs.torque is None:
        raise InputError(f"{inputs.where}: there is no torque, which the muscles could follow")
    if inputs.missing_emg:
        raise InputError(
            f"{inputs.where}: there is no EMG of {', '.join(inputs.missing_emg)}, without which "
            "the muscles cannot be judged"
        )
    numbers = _numbers(result, leg)
    place = np.linspace(0, inputs.n - 1, min(inputs.n, _SAMPLES)).round().astype(int)
    place = place[inputs.counts[place]]
    scenes = {lag: _Scene.of(leg, inputs, place, lag) for lag in _LAGS}
    reached = {lag: scene.r2(numbers) for lag, scene in scenes.items()}
    lag = max(reached, key=lambda each: reached[each])
    scene = scenes[lag]
    r2 = reached[lag]
    lengths = []
    for head in leg.heads:
        for parameter in _LENGTHS:
            lengths.append(_told(scene, numbers, head.name, parameter, r2))
    return AgainstRecording(inputs.where, r2, lag, tuple(lengths))


def _numbers(result: ForeignResult, leg: LegInModel) -> dict[str, _Numbers]:
    """Numbers of each head: the result's, and of what it has not, the model's."""
    given = {(v.muscle, v.parameter): v.value for v in result.values}
    parts = any(v.generic == 1.0 and v.parameter in _LENGTHS for v in result.values)
    numbers = {}
    for head in leg.heads:
        fibre = head.fibre
        slack = head.value("tendon_slack_length")
        scale = (fibre, slack) if parts else (1.0, 1.0)
        strain = given.get((head.name, "tendon_strain"), _STRAIN)
        if result.program in _RIGID or head.node.said("ignore_tendon_compliance") == "true":
            strain = 0.0
        numbers[head.name] = _Numbers(
            given.get((head.name, "optimal_fiber_length"), fibre / scale[0]) * scale[0],
            given.get((head.name, "tendon_slack_length"), slack / scale[1]) * scale[1],
            given.get((head.name, "pennation_angle"), head.pennation),
            given.get((head.name, "max_isometric_force"), head.value("max_isometric_force")),
            strain,
        )
    if not {muscle for muscle, _ in given} & numbers.keys():
        names = ", ".join(numbers)
        raise InputError(f"{result.path}: it has none of the leg's muscles ({names})")
    return numbers


@dataclass(frozen=True, slots=True, eq=False)
class _Scene:
    """A recording with the paths of a leg, ready for any numbers of its muscles."""

    heads: tuple[Head, ...]
    length: Mapping[str, FloatArray]  #: Of each head's path [m], shape (n,).
    arm: Mapping[str, FloatArray]  #: Signed as torque is [m], shape (n,).
    speed: FloatArray  #: Of the angle [rad/s], shape (n,).
    drive: FloatArray  #: Filtered EMG of TA, GL, SOL, GM, shape (4, n).
    beside: FloatArray  #: Torque of what is no muscle, for a unit of each, shape (k, n).
    torque: FloatArray  #: As it was measured [Nm], shape (n,).

    @classmethod
    def of(cls, leg: LegInModel, inputs: ModelInputs, place: FloatArray, lag: float) -> "_Scene":
        """A recording's samples at some places, its activation later by a lag [s]."""
        assert inputs.torque is not None
        angle = inputs.angle[place]
        grid = np.linspace(angle.min() - 1e-3, angle.max() + 1e-3, _ANGLES)
        length = {}
        arm = {}
        for head in leg.heads:
            path = CubicSpline(grid, leg.length(head, grid))
            length[head.name] = path(angle)
            arm[head.name] = path.derivative()(angle)
        drive = _later(inputs.emg, inputs.rate_hz, lag)[place].T
        acceleration = inputs.acceleration[place]
        beside = np.stack(
            [np.ones_like(angle), GRAVITY * np.cos(angle), GRAVITY * np.sin(angle), acceleration]
        )
        return cls(
            leg.heads,
            length,
            arm,
            inputs.velocity[place],
            drive,
            beside,
            inputs.torque[place],
        )

    def r2(self, numbers: Mapping[str, _Numbers]) -> float:
        """The best R² that muscles with these numbers allow [%]."""
        forces = {name: np.zeros_like(self.torque) for name in numbers}
        left = self.torque
        for _ in range(_STEPS if any(n.strain for n in numbers.values()) else 1):
            columns = []
            passive = np.zeros_like(self.torque)
            for head in self.heads:
                active, tissue = self._force(head.name, numbers[head.name], forces[head.name])
                arm = self.arm[head.name]
                passive += arm * tissue
                columns += [arm * active * self.drive[c] for c in _EMG[head.kind]]
            matrix = np.stack([*columns, *self.beside], axis=1)
            low = [*[0.0] * len(columns), *_BESIDE[0]]
            high = [*[np.inf] * len(columns), *_BESIDE[1]]
            size = np.linalg.norm(matrix, axis=0)
            size[size == 0.0] = 1.0
            ends = np.array([low, high]) * size
            solved = lsq_linear(matrix / size, self.torque - passive, tuple(ends)).x / size
            left = self.torque - passive - matrix @ solved
            forces = self._forces(solved, numbers, forces)
        spread = float(np.sum((self.torque - self.torque.mean()) ** 2))
        return 100.0 * (1.0 - float(np.sum(left**2)) / spread)

    def _force(self, name: str, of: _Numbers, force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force along the tendon at activation 1, and at rest, where it pulls with a force [N]."""
        stretch = 0.0 if of.strain == 0.0 else tendon_strain(force / of.force, of.strain)
        along = self.length[name] - of.slack * (1.0 + stretch)
        along = np.maximum(along, 0.01 * of.fibre)
        muscle = DeGrooteMuscle(of.force, of.fibre, 0.0, 0.0, 10.0, 0.0, pennation=of.pennation)
        speed = self.arm[name] * self.speed
        one = np.ones_like(along)
        fibre = np.hypot(along / of.fibre, np.sin(of.pennation))
        slant = along / of.fibre / fibre
        return muscle.force(along, speed, one), of.force * passive_fibre(fibre) * slant

    def _forces(
        self, solved: FloatArray, numbers: Mapping[str, _Numbers], before: Mapping[str, FloatArray]
    ) -> dict[str, FloatArray]:
        """Force of each tendon with these gains [N]; halfway from what it was before."""
        forces = {}
        column = 0
        for head in self.heads:
            active, passive = self._force(head.name, numbers[head.name], before[head.name])
            total = passive
            for channel in _EMG[head.kind]:
                total = total + solved[column] * self.drive[channel] * active
                column += 1
            forces[head.name] = 0.5 * (before[head.name] + total)
        return forces


def _told(
    scene: _Scene, numbers: Mapping[str, _Numbers], name: str, parameter: str, r2: float
) -> Told:
    """What the recording says of one length, all else as it is."""
    of = numbers[name]
    field = "fibre" if parameter == _LENGTHS[0] else "slack"
    value: float = getattr(of, field)
    # of a tendon the length of the fibre is the measure: it is much shorter
    unit = value if field == "fibre" else of.fibre

    def changed(part: float) -> float:
        moved = replace(of, **{field: value + (part - 1.0) * unit})
        return scene.r2({**numbers, name: moved})

    drop = r2 - max(changed(1.0 - _CHANGE), changed(1.0 + _CHANGE))
    tried: Sequence[tuple[float, float]] = [(changed(part), part) for part in _PARTS]
    best, part = max(tried)
    return Told(name, parameter, value, drop, value + (part - 1.0) * unit, max(best - r2, 0.0))


def _later(emg: FloatArray, rate_hz: float, lag: float) -> FloatArray:
    """EMG through a low-pass of first order with a lag [s], shape (n, 4)."""
    from scipy.signal import lfilter

    part = float(np.exp(-1.0 / (rate_hz * lag)))
    return np.asarray(lfilter([1.0 - part], [1.0, -part], emg, axis=0))
