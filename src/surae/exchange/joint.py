"""A leg as a joint with two muscles of another simulator, and the distance of their torques."""

from dataclasses import dataclass, replace

import numpy as np

from surae.base.units import FloatArray
from surae.exchange.muscles import (
    DeGrooteMuscle,
    HeldMuscle,
    MujocoMuscle,
    PolynomialPath,
    WrappedPath,
)
from surae.measures.leg import GROUPS, Leg
from surae.measures.muscle import elongation
from surae.model import joint as anatomy
from surae.model.parameters import OPTIONAL_PARAMETERS
from surae.model.tissue_curve import TissueCurve

#: Angles, and parts of the largest activity, at which muscles are compared.
_ANGLES = 41
_PARTS = (0.25, 0.5, 0.75, 1.0)
#: Force that is the largest where no recording has one [N].
_NO_PEAK = 1000.0
#: Degree of the polynomial that is the curve of the joint's own tissue, where it has one.
_BENDS = 7
#: Degree of the polynomial that is the logarithm of the tissue's force over length.
_DEGREE = 3
#: How optional parameters begin that are in the file: the leg's own paths and force-length curve,
#: its own tissue beside the muscles, and in a comment the delay of its EMG.
_KEPT = ("arm_", "path_", "length_", "fl_", "joint_", "emd")
#: Scale of a force-length curve's width above which a muscle is no human one.
WIDEST = 2.0
#: Strain of a tendon at the largest force above which it is no human one.
STRAINED = 0.15
#: Sine of the largest pennation that is exported, at which fibres hardly pull along their tendon.
MOST_SLANTED = 0.7
#: Weights of the EMG of each group, and its channels.
GAINS = {"tri": ("g2", "g3", "g4"), "tib": ("g1",)}
_CHANNELS = {"tri": slice(1, 4), "tib": slice(0, 1)}


@dataclass(frozen=True, slots=True)
class MuscleTissue:
    """Relaxed tissue along a path: exp(c0 + c1·s + c2·s² + c3·s³) N at a stretch of s m."""

    rest: float  #: Length of the path at which s is 0 [m].
    coefficients: tuple[float, ...]

    @classmethod
    def fitted(cls, length: FloatArray, force: FloatArray) -> "MuscleTissue":
        """The tissue with a force [N] at lengths of its path [m]."""
        rest = float(np.mean(length))
        scaled = np.polynomial.Polynomial.fit(
            length - rest, np.log(force), _DEGREE, w=np.sqrt(force / force.max()) + 1e-3
        )
        return cls(rest, tuple(scaled.convert().coef.tolist()))

    def force(self, length: FloatArray) -> FloatArray:
        """Force at lengths of the path [N]."""
        return np.asarray(np.exp(np.polynomial.Polynomial(self.coefficients)(length - self.rest)))


@dataclass(frozen=True, slots=True)
class Springs:
    """Passive tissue as springs side by side, each from a length of its own on."""

    lengths: tuple[float, ...]  #: From where each pulls [m].
    stiffness: tuple[float, ...]  #: Of each [N/m].

    @classmethod
    def fitted(cls, length: FloatArray, force: FloatArray) -> "Springs":
        """Springs whose force [N] is that at lengths of the path [m], and straight in between."""
        order = np.argsort(length)[::2]
        length = length[order]
        force = force[order]
        slopes = np.diff(force) / np.diff(length)
        first = max(length[0] - force[0] / slopes[0], 0.0)
        return cls((first, *length[1:-1].tolist()), (slopes[0], *np.diff(slopes).tolist()))

    def force(self, length: FloatArray) -> FloatArray:
        """Force at lengths of the path [N]."""
        force = np.zeros_like(length)
        for start, stiffness in zip(self.lengths, self.stiffness, strict=True):
            force += stiffness * np.maximum(length - start, 0.0)
        return force


@dataclass(frozen=True, slots=True)
class JointMuscle:
    """A muscle group of the joint."""

    anatomy: anatomy.Joint
    group: str
    path: PolynomialPath | WrappedPath
    muscle: DeGrooteMuscle | MujocoMuscle
    tissue: MuscleTissue | Springs
    scale: float  #: Excitation (12), (13) that is 1 there [N].

    @property
    def name(self) -> str:
        """The group's name in files."""
        return self.anatomy.groups[GROUPS.index(self.group)].replace(" ", "_")

    def torque(self, angle: FloatArray, velocity: FloatArray, active: FloatArray) -> FloatArray:
        """Torque at angles [rad], their velocity [rad/s] and activation [Nm]."""
        length = self.path.length(angle)
        arm = self.path.arm(angle)
        pull = self.muscle.force(length, arm * velocity, active) + self.tissue.force(length)
        return np.asarray(arm * pull)


@dataclass(frozen=True, slots=True)
class JointTissue:
    """What holds and brakes the joint beside its muscles, against dorsiflexion."""

    torque: float  #: At 0 rad [Nm].
    stiffness: float  #: [Nm/rad]
    damping: float  #: [Nm·s/rad]
    #: Of a tissue that rest shows as a curve: of the square of the angle, its cube and so on
    #: [Nm/rad², …].
    bends: tuple[float, ...] = ()

    def along(self, angle: FloatArray, velocity: FloatArray) -> FloatArray:
        """Its torque in a movement [rad, rad/s → Nm]."""
        terms = self.torque, self.stiffness, *self.bends
        held = np.polynomial.polynomial.polyval(angle, terms)
        return np.asarray(held + self.damping * velocity)

    @property
    def pulls(self) -> bool:
        """Whether there is any."""
        return bool(self.torque or self.stiffness or self.damping)


@dataclass(frozen=True, slots=True)
class JointModel:
    """The ankle of a leg with both its muscle groups."""

    anatomy: anatomy.Joint  #: The joint that it is.
    mass: float  #: Foot and footplate [kg].
    theta_foot: float  #: Angle of the foot to the horizontal at 0 rad [rad].
    moved: tuple[float, float]  #: Range that was moved [rad].
    muscles: tuple[JointMuscle, JointMuscle]
    tissue: JointTissue
    rms: float  #: Of the difference of both torques, held still over the range [Nm].
    largest: float  #: Largest of our torques there [Nm].
    #: Optional parameters of the fit that are not here, and the torque that they make over the
    #: recordings, as root mean square [Nm].
    missing: tuple[str, ...]
    missing_rms: float

    @property
    def widths(self) -> str:
        """By how much force-length curves are wider than the standard one; empty where none is."""
        wide = [m for m in self.muscles if isinstance(m.muscle, DeGrooteMuscle)]
        return ", ".join(f"{m.name} {m.muscle.width:.3g}" for m in wide)  # type: ignore[union-attr]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What of the muscles is no longer anatomy, a sentence each."""
        return tuple(
            sentence
            for of in self.muscles
            if isinstance(of.muscle, DeGrooteMuscle)
            for sentence in said_of_muscle(of.name, of.muscle)
        )


def said_of_muscle(name: str, muscle: DeGrooteMuscle) -> list[str]:
    """What of a muscle is no longer anatomy, a sentence each."""
    said = []
    if muscle.width > WIDEST:
        said.append(
            f"{name}: its force-length curve is {muscle.width:.2g} times as wide as the "
            "standard one, because the path of the fit travels less than its arm: fit with "
            "geometry virtual-work or the leg’s own for a muscle of the usual width."
        )
    if muscle.strain > STRAINED:
        said.append(
            f"{name}: its tendon stretches by {100.0 * muscle.strain:.0f} % at the "
            "largest force, farther than a human one can, to make up for its path."
        )
    if muscle.at_limit:
        limits = ", ".join(muscle.at_limit)
        said.append(f"{name}: at the end of what is possible there: {limits}.")
    return said


def joint_of(leg: Leg, moved: tuple[float, float], *, springs: bool) -> JointModel:
    """A leg with muscles of OpenSim, or with those and the springs of MuJoCo.

    `moved` is the range that was moved [deg].
    """
    degrees = np.linspace(*moved, _ANGLES)
    angle = np.radians(degrees)
    still = np.zeros_like(angle)
    muscles = []
    ours = []
    theirs = []
    for group in GROUPS:
        arm = np.array([leg.hold(group, at).arm for at in degrees.tolist()])
        path = (WrappedPath if springs else PolynomialPath).through(angle, arm)
        held = held_group(leg, group, degrees, path.length(angle))
        kind: type[MujocoMuscle | DeGrooteMuscle] = MujocoMuscle if springs else DeGrooteMuscle
        tissue = (Springs if springs else MuscleTissue).fitted(held.length, held.tissue)
        muscle = JointMuscle(leg.options.anatomy, group, path, kind.fitted(held), tissue, held.peak)
        muscles.append(muscle)
        active = np.vstack([still, held.active])
        ours.append(arm * (held.tissue + active))
        shares = (0.0, *held.states / held.peak)
        theirs.append(np.stack([muscle.torque(angle, still, still + s) for s in shares]))
    together = ours[0][:, None] + ours[1][None]
    apart = together - theirs[0][:, None] - theirs[1][None]
    of = leg.values.get
    missing = tuple(
        p.name
        for p in OPTIONAL_PARAMETERS
        if of(p.name) and p.start == 0.0 and not p.name.startswith(_KEPT)
    )
    if springs and of("joint_torque") and not of("joint_stiffness"):  # no spring, no rest
        missing = (*missing, "joint_torque")
    bare = leg.with_values(dict.fromkeys(missing, 0.0))
    beside, shown = joint_tissue(leg, degrees, 1 if springs else _BENDS)
    if shown is not None:
        bare = replace(bare, options=replace(leg.options, tissue=shown), _ties={})
        missing = (*missing, *(["bends of the relaxed curve"] if springs else []))
    return JointModel(
        leg.options.anatomy,
        leg.values["m"],
        leg.options.theta_foot,
        (float(angle[0]), float(angle[-1])),
        (muscles[0], muscles[1]),
        beside,
        _rms(apart),
        float(np.abs(together).max()),
        missing,
        _apart(leg, bare) if missing and leg.inputs else 0.0,
    )


def joint_tissue(
    leg: Leg, degrees: FloatArray, degree: int = _BENDS
) -> tuple[JointTissue, TissueCurve | None]:
    """The joint's own tissue; a curve in it is a polynomial of the angle, which is the second."""
    beside = JointTissue(
        leg.joint_torque(0.0),
        leg.values.get("joint_stiffness", 0.0),
        leg.values.get("joint_damping", 0.0),
    )
    curve = leg.options.tissue
    if curve is None:
        return beside, None
    angle = np.radians(degrees)
    torque = np.array([leg.joint_torque(at) for at in degrees.tolist()])
    first, second, *more = np.polynomial.polynomial.polyfit(angle, torque, degree).tolist()
    made = replace(beside, torque=first, stiffness=second, bends=tuple(more))
    off = torque - np.array([curve.relaxed(at) for at in degrees.tolist()])
    shown = np.polynomial.polynomial.polyval(angle, [first, second, *more]) - off
    return made, TissueCurve(tuple(degrees.tolist()), tuple(shown.tolist()))


def held_group(leg: Leg, group: str, degrees: FloatArray, length: FloatArray) -> HeldMuscle:
    """A muscle group held still at angles, with lengths [m] of its path there."""
    every = degrees.tolist()
    largest = leg.largest_activity[group] if leg.inputs else 0.0
    peaks = [float(np.max(_excitation(leg, group, i))) for i in range(len(leg.inputs))]
    peak = max([*peaks, largest]) if largest > 0.0 else _NO_PEAK
    states = (largest or peak) * np.array(_PARTS)
    tissue = np.array([leg.hold(group, at).force for at in every])
    active = np.array([[leg.hold(group, at, s).force for at in every] for s in states.tolist()])
    # our lengths along the path: straight enough over the range
    x = np.array([leg.rigid_length(group, at) for at in every])
    ratio, offset = np.polyfit(x, length, 1).tolist()
    l0 = leg.optimal_length(group)
    values = leg.values
    stretch = ratio * elongation(leg.tendon(group), peak) if leg.is_compliant else 0.0
    return HeldMuscle(
        length,
        tissue,
        states,
        active - tissue,
        offset + ratio * l0,
        ratio * l0,
        peak,
        leg.options.vmax_factor,
        values["beta"] / (np.pi * values["f0"]),
        stretch,
        l0,
        _pennation(leg, group),
    )


def _pennation(leg: Leg, group: str) -> float:
    """Angle of a group's filmed fascicles to their tendon at the optimal length, mean [rad].

    A muscle stays as thick as it is while its fascicles turn; 0 where no pennation was filmed.
    """
    angles = []
    for recording in leg.inputs:
        for film in recording.films:
            muscle = film.channel.rpartition("_")[2]
            if film.thickness > 0.0 and muscle.startswith("tib") is (group == "tib"):
                grown = 1.0 + leg.values.get(f"film_scale_{muscle}", 0.0)
                seen = grown * leg.optimal_length(group) + leg.values.get(
                    f"film_zero_{muscle}", 0.0
                )
                angles.append(float(np.arcsin(min(film.thickness / max(seen, 1e-3), MOST_SLANTED))))
    return float(np.mean(angles)) if angles else 0.0


def _excitation(leg: Leg, group: str, recording: int) -> FloatArray:
    """Excitation (12), (13) of a recording as it was measured [N]."""
    gains = np.array([leg.values[name] for name in GAINS[group]])
    return np.asarray(leg.inputs[recording].emg[:, _CHANNELS[group]] @ gains)


def _apart(leg: Leg, other: Leg) -> float:
    """Difference of the torques of two legs over the same recordings [Nm]."""
    apart = []
    for inputs in leg.inputs:
        one, two = (
            leg.spec.simulator(inputs, of.options).torque(
                np.array([of.values[name] for name in leg.spec.names])
            )
            for of in (leg, other)
        )
        apart.append((one - two) if inputs.weight is None else (one - two)[inputs.weight > 0])
    return _rms(np.concatenate(apart))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
