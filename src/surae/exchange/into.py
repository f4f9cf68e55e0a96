"""The muscles of a fitted leg in somebody's OpenSim model, on the paths that they have there.

Every head keeps its fibre, pennation and path. What the fit knows is in degrees and Nm: strength,
optimum angle, width and tissue of the group go over to its heads by their parts in the model's
largest force, so that the group's torque is the fit's at every angle.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.exchange import by_opensim
from surae.exchange.joint import (
    JointTissue,
    MuscleTissue,
    held_group,
    joint_tissue,
    said_of_muscle,
)
from surae.exchange.leg_in_model import Head, LegInModel
from surae.exchange.muscles import DeGrooteMuscle, HeldMuscle, tendon_share
from surae.measures.leg import GROUPS, Leg
from surae.model import TorqueParts
from surae.model.movement import GRAVITY

#: Angles at which muscles are compared, and those at which a path's length is looked up [deg].
_ANGLES = 41
_BEYOND = 12.0
#: Least range of the angle over which a foot's weight is looked up [rad].
_SLOWEST = 1e-6
#: What a state that the recordings do not meet counts, of one that they meet as often as the mean.
_SELDOM = 0.1
#: Part of the largest torque by which muscles may differ before another fit is advised.
_FAR = 0.05
#: Whose strength a model may have.
STRENGTHS = ("model", "measured")


@dataclass(frozen=True, slots=True)
class FittedHead:
    """A head with what the fit makes of it."""

    head: Head
    muscle: DeGrooteMuscle
    tissue: MuscleTissue
    length: CubicSpline  #: Of its path by our angle [rad → m].
    arm: CubicSpline  #: Its slope [m].

    def torque(self, angle: FloatArray, velocity: FloatArray, active: FloatArray) -> FloatArray:
        """Torque at angles [rad], their velocity [rad/s] and activation [Nm]."""
        arm = self.arm(angle)
        length = self.length(angle)
        pull = self.muscle.force(length, arm * velocity, active) + self.tissue.force(length)
        return np.asarray(arm * pull)


@dataclass(frozen=True, slots=True)
class Differences:
    """Differences of the torque there from ours over the recordings [Nm], root mean squares."""

    fit: float  #: Of our torque from the measured one.
    muscles: float  #: Of muscles and joint there from ours whose tissue is relaxed.
    relaxation: float  #: What tissue that has not relaxed yet makes of ours.
    foot: float  #: What the model's foot makes otherwise than the fit's foot and plate.
    largest: float  #: Largest of our torques, no difference.


@dataclass(frozen=True, slots=True)
class LegForModel:
    """What of a fit goes into somebody's model."""

    into: LegInModel
    heads: tuple[FittedHead, ...]
    tissue: JointTissue
    peaks: Mapping[str, float]  #: Excitation (12), (13) that is 1 there [N], by group.
    moved: tuple[float, float]  #: Range that was moved [rad].
    rms: float  #: Of the difference of both torques, held still over the range [Nm].
    largest: float  #: Largest of our torques there [Nm].
    over: Differences | None  #: Over the recordings; None without any.

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is no longer anatomy, or not the fit's, a sentence each."""
        said = [s for of in self.heads for s in said_of_muscle(of.head.name, of.muscle)]
        ends = np.array(self.moved)
        wound = [of.head.name for of in self.heads if self.into.winds(of.head, ends)]
        if wound and not by_opensim.is_there():
            said.append(
                f"{', '.join(wound)}: OpenSim states a length of a path round two cylinders that "
                "is some millimetres shorter than the path that it draws, and its tendon is by as "
                "much too long there: install the package opensim and export again, or bend the "
                "knee with --pose."
            )
        if self.over is not None and self.over.muscles > _FAR * self.over.largest:
            said.append(
                "Muscles with this model’s fibres, on its paths, do not follow the fit: a fit with "
                "the lengths and arms of these paths (geometry: OpenSim’s MuscleAnalysis of this "
                "model) may be followed better."
            )
        if self.into.others:
            names = ", ".join(self.into.others)
            said.append(
                f"Other muscles of the model cross the ankle ({names}): the fit has what they do "
                "in the triceps surae and the tibialis anterior, so leave them without activity; "
                "their passive force comes on top."
            )
        return tuple(said)


def leg_for_model(
    leg: Leg, moved: tuple[float, float], into: LegInModel, strength: str = "model"
) -> LegForModel:
    """What of a leg goes into a model; `moved` is the range that was moved [deg].

    The `strength` is that of the ``"model"``, or as ``"measured"``: the force of the largest
    activity in the recordings.
    """
    degrees = np.linspace(*moved, _ANGLES)
    heads: list[FittedHead] = []
    peaks = {}
    for group in GROUPS:
        made, peaks[group] = _fitted_group(leg, group, into, degrees, strength)
        heads += made
    tissue, _ = joint_tissue(leg, degrees)
    low, high = np.radians(degrees[[0, -1]]).tolist()
    rms, largest = _held_still(leg, degrees, heads, peaks)
    made_leg = LegForModel(into, tuple(heads), tissue, peaks, (low, high), rms, largest, None)
    return replace(made_leg, over=_over(leg, made_leg)) if leg.inputs else made_leg


def _fitted_group(
    leg: Leg, group: str, into: LegInModel, degrees: FloatArray, strength: str
) -> tuple[list[FittedHead], float]:
    """The heads of a group, and the excitation of ours that is 1 there [N]."""
    wide = np.radians(np.linspace(degrees[0] - _BEYOND, degrees[-1] + _BEYOND, 2 * _ANGLES))
    angle = np.radians(degrees)
    heads = [head for head in into.heads if head.group == group]
    arm = np.array([leg.hold(group, at).arm for at in degrees.tolist()])
    lengths = [CubicSpline(wide, into.length_there(head, wide)) for head in heads]
    arms = [length.derivative() for length in lengths]
    for head, arm_of in zip(heads, arms, strict=True):
        if np.any(arm_of(angle) * np.sign(arm) <= 0.0):
            raise InputError(
                f"{into.where}: muscle {head.name!r} turns its moment arm round within the range "
                "that was moved"
            )
    parts = [head.share * arm / arm_of(angle) for head, arm_of in zip(heads, arms, strict=True)]
    held = [held_group(leg, group, degrees, length(angle)) for length in lengths]
    peaks = [h.peak * float(np.mean(part)) for h, part in zip(held, parts, strict=True)]
    whole = sum(head.value("max_isometric_force") for head in heads)
    stronger = 1.0 if strength == "measured" else whole / sum(peaks)
    weight = _met(leg, group, degrees, held[0].states)
    muscles = []
    for head, of_group, part, peak in zip(heads, held, parts, peaks, strict=True):
        full = peak * stronger
        of_head: HeldMuscle = replace(
            of_group,
            tissue=of_group.tissue * part,
            active=of_group.active * part,
            states=of_group.states * (peak / of_group.peak),
            peak=full,
            stretch=of_group.stretch / tendon_share(1.0 / stronger),
            met=of_group.stretch,
            fibre=head.fibre,
            pennation=head.pennation,
            weight=weight,
        )
        muscles.append(DeGrooteMuscle.fitted(of_head))
    exact = whole / sum(m.peak for m in muscles) if strength == "model" else 1.0
    fitted = [
        FittedHead(
            head,
            replace(muscle, peak=muscle.peak * exact),
            MuscleTissue.fitted(length(angle), of_group.tissue * part),
            length,
            arm_of,
        )
        for head, muscle, of_group, part, length, arm_of in zip(
            heads, muscles, held, parts, lengths, arms, strict=True
        )
    ]
    return fitted, held[0].peak * stronger * exact


def _met(leg: Leg, group: str, degrees: FloatArray, states: FloatArray) -> FloatArray | None:
    """What each state at each angle counts: how often the recordings meet it, shape (k, n)."""
    if not leg.inputs:
        return None
    met = np.full((len(states), len(degrees)), 1e-9)
    for inputs, alpha in zip(leg.inputs, leg.active_states, strict=True):
        counts = inputs.counts
        angle = np.degrees(inputs.angle[counts] + leg.values.get("angle_zero", 0.0))
        place = np.abs(angle[:, None] - degrees).argmin(axis=1)
        state = np.abs(alpha[GROUPS.index(group), counts][:, None] - states).argmin(axis=1)
        used = alpha[GROUPS.index(group), counts] > 0.5 * states[0]
        np.add.at(met, (state[used], place[used]), 1.0)
    part = met / met.sum() * met.size
    return np.asarray(np.sqrt(_SELDOM + (1.0 - _SELDOM) * part))


def _held_still(
    leg: Leg, degrees: FloatArray, heads: list[FittedHead], peaks: Mapping[str, float]
) -> tuple[float, float]:
    """Root mean square of the difference held still, and the largest torque of ours [Nm]."""
    angle = np.radians(degrees)
    still = np.zeros_like(angle)
    ours = {}
    there = {}
    for group in GROUPS:
        states = np.linspace(0.0, min(_most(leg, group, peaks[group]), 1.0), 5)
        ours[group] = np.array(
            [
                [leg.hold(group, at, s * peaks[group]).torque for at in degrees.tolist()]
                for s in states.tolist()
            ]
        )
        there[group] = np.array(
            [
                sum(h.torque(angle, still, still + s) for h in heads if h.head.group == group)
                for s in states.tolist()
            ]
        )
    both = ours["tri"][:, None] + ours["tib"][None]
    apart = both - there["tri"][:, None] - there["tib"][None]
    return _rms(apart), float(np.abs(both).max())


def _most(leg: Leg, group: str, peak: float) -> float:
    """Largest activation that the recordings have, of one that is 1 at `peak` [N]."""
    return leg.largest_activity[group] / peak if leg.inputs else 1.0


def _over(leg: Leg, made: LegForModel) -> Differences:
    """How far the torque there is from ours over the recordings."""
    squares: dict[str, list[FloatArray]] = {}
    largest = 0.0
    tables = _relaxed(leg, made)
    for inputs, (parts, *_), alpha in zip(leg.inputs, leg.split, leg.active_states, strict=True):
        counts = inputs.counts
        angle = inputs.angle + leg.values.get("angle_zero", 0.0)
        there = _there(made, angle, inputs.velocity, alpha)
        relaxed = tables[0](angle) + tables[1](angle) + parts.neural
        ours = relaxed if parts.joint is None else relaxed + parts.joint
        foot = _foot(made, angle, inputs.acceleration, parts)
        differences = {
            "muscles": there - ours,
            "relaxation": parts.tissue_tri + parts.tissue_tib - tables[0](angle) - tables[1](angle),
            "foot": foot,
        }
        if inputs.torque is not None:
            differences["fit"] = inputs.torque - parts.total
        for name, difference in differences.items():
            squares.setdefault(name, []).append(difference[counts])
        largest = max(largest, float(np.abs(parts.total[counts]).max()))
    rms = {name: _rms(np.concatenate(each)) for name, each in squares.items()}
    return Differences(rms.get("fit", 0.0), rms["muscles"], rms["relaxation"], rms["foot"], largest)


def _there(
    made: LegForModel, angle: FloatArray, velocity: FloatArray, alpha: FloatArray
) -> FloatArray:
    """Torque of muscles and joint there in a movement, with active states (2, n) of ours [N]."""
    total = made.tissue.along(angle, velocity)
    for head in made.heads:
        group = head.head.group
        active = alpha[GROUPS.index(group)] / made.peaks[group]
        total = total + head.torque(angle, velocity, active)
    return total


def _relaxed(leg: Leg, made: LegForModel) -> tuple[CubicSpline, CubicSpline]:
    """Torque of the relaxed tissue of both groups by the angle [rad → Nm]."""
    low, high = np.degrees(made.moved)
    degrees = np.linspace(low - _BEYOND, high + _BEYOND, 2 * _ANGLES)
    tri, tib = (
        CubicSpline(np.radians(degrees), [leg.hold(g, at).torque for at in degrees.tolist()])
        for g in GROUPS
    )
    return tri, tib


def _foot(
    made: LegForModel, angle: FloatArray, acceleration: FloatArray, parts: TorqueParts
) -> FloatArray:
    """Inertia and weight of the model's foot less those of the fit [Nm].

    The shank is upright, as the fit's: its own y points up.
    """
    low, high = float(angle.min()), float(angle.max())
    at = np.linspace(low, high, 9) if high - low > _SLOWEST else np.array([low, low + 1e-3])
    shank = made.into.shank
    weights = []
    inertias = []
    for each in at.tolist():
        mass, centre, inertia, axis = made.into.foot(each)
        up = made.into.skeleton.place(shank, made.into.posed(each))[:3, 1]
        # the torque of weight about the axis drives our angle; the manipulator holds it
        weights.append(mass * GRAVITY * float(np.cross(centre, up) @ axis))
        inertias.append(inertia)
    weight = CubicSpline(at, weights)(angle)
    inertia = CubicSpline(at, inertias)(angle)
    return np.asarray(weight + inertia * acceleration - parts.gravitational - parts.inertial)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
