"""The ankle in somebody's OpenSim model: its angle, heads of the leg's muscles, and its foot."""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.base.formatting import nearest
from surae.base.units import FloatArray
from surae.exchange import by_opensim
from surae.exchange.kinematics import Skeleton
from surae.exchange.paths import StringPath, path_of
from surae.exchange.xml_tree import Node, read_xml

#: What models call the heads of the triceps surae and the tibialis anterior, without a side.
_HEADS = {
    "tri": {
        "sol": r"sol(?:eus)?",
        "gm": r"gas_?med(?:ialis)?|med_?gas|gastroc(?:nemius)?_?m\w*|gm",
        "gl": r"gas_?lat(?:eralis)?|lat_?gas|gastroc(?:nemius)?_?l\w*|gl",
        "gas": r"gas|gastroc|gastrocnemius",
    },
    "tib": {"ta": r"tib_?ant(?:erior)?|tibialis_?ant(?:erior)?|ta"},
}
_ANKLE = r"ankle(?:_?angle|_?flexion|_?dorsiflexion|_?fe)?"
SIDES = {"right": "r", "left": "l"}
#: A step by which a path's slope is found [rad], and the least arm that a muscle has [m].
_STEP = 1e-4
_LEAST = 1e-3
_OLDEST = 40000


def _sided(name: str, stem: str, side: str) -> bool:
    """Whether a name is a stem with the letter of a side."""
    return re.fullmatch(rf"(?:{stem})_?{side}|{side}_(?:{stem})", name, re.IGNORECASE) is not None


@dataclass(frozen=True, slots=True)
class Head:
    """A muscle of a group in somebody's model."""

    group: str  #: "tri" or "tib".
    kind: str  #: "sol", "gm", "gl", "gas" or "ta".
    node: Node
    path: StringPath
    share: float  #: Its part of the group's largest force in that model.

    @property
    def name(self) -> str:
        """Its name there."""
        return self.node.name

    def value(self, *names: str) -> float:
        """A number that it must have."""
        number = self.node.number(*names)
        if number is None or not number > 0.0:
            raise InputError(f"muscle {self.name!r} has no {names[0]} above 0")
        return number

    @property
    def fibre(self) -> float:
        """Its optimal fibre length [m]."""
        return self.value("optimal_fiber_length")

    @property
    def pennation(self) -> float:
        """Angle of its fibres to the tendon at that length [rad]."""
        return self.node.number("pennation_angle_at_optimal", "pennation_angle") or 0.0


@dataclass(frozen=True, slots=True)
class LegInModel:
    """One leg of somebody's model."""

    where: str  #: How messages call its file.
    path: str  #: The file.
    data: bytes  #: Its content.
    version: int  #: Its format.
    root: Node
    skeleton: Skeleton
    side: str  #: "right" or "left".
    coordinate: str  #: The ankle's angle there.
    component: str  #: Its path among the model's components.
    sign: float  #: 1 where dorsiflexion is positive there, else −1.
    heads: tuple[Head, ...]
    pose: Mapping[str, float]  #: Of every other coordinate [rad, m].
    others: tuple[str, ...]  #: Other muscles that cross the ankle.

    @property
    def model(self) -> Node:
        """The element ``<Model>``."""
        return _model(self.root, self.where)

    def posed(self, angle: float) -> dict[str, float]:
        """The pose with the ankle at an angle of ours [rad]."""
        return {**self.pose, self.coordinate: self.sign * angle}

    def length(self, head: Head, angle: FloatArray) -> FloatArray:
        """Length of a head's path at angles of ours [m]."""
        return np.array([head.path.length(self.skeleton, self.posed(at)) for at in angle.tolist()])

    def arm(self, head: Head, angle: FloatArray) -> FloatArray:
        """Its slope by our angle, the moment arm signed as our torque is [m]."""
        apart = self.length(head, angle + _STEP) - self.length(head, angle - _STEP)
        return np.asarray(apart / (2.0 * _STEP))

    def foot(self, angle: float) -> tuple[float, FloatArray, float, FloatArray]:
        """The foot about the ankle at an angle of ours [rad].

        Mass [kg], its centre from the axis [m, in the ground's frame], inertia about the axis
        [kg·m²] and the axis itself, along which our angle grows.
        """
        at = {b: self.skeleton.place(b, self.posed(angle)) for b in self._moving}
        more = {b: self.skeleton.place(b, self.posed(angle + _STEP)) for b in self._moving}
        first = self._moving[0]
        turned = (more[first][:3, :3] - at[first][:3, :3]) @ at[first][:3, :3].T / _STEP
        axis = np.array([turned[2, 1], turned[0, 2], turned[1, 0]])
        axis /= np.linalg.norm(axis)
        moved = (more[first][:3, 3] - at[first][:3, 3]) / _STEP
        on = at[first][:3, 3] + np.cross(axis, moved)  # the axis' nearest point, of a hinge
        mass = 0.0
        centre = np.zeros(3)
        inertia = 0.0
        for name in self._moving:
            body = self.skeleton.bodies[name]
            where = (at[name] @ np.array([*body.centre, 1.0]))[:3] - on
            about_centre = at[name][:3, :3] @ body.inertia @ at[name][:3, :3].T
            across = where - (where @ axis) * axis
            mass += body.mass
            centre += body.mass * where
            inertia += float(axis @ about_centre @ axis) + body.mass * float(across @ across)
        return mass, centre / max(mass, 1e-12), inertia, axis

    def length_there(self, head: Head, angle: FloatArray) -> FloatArray:
        """Length of a head's path at angles of ours as OpenSim itself states it [m].

        Ours where it lies on one cylinder at most, or where OpenSim is not installed.
        """
        ours = self.length(head, angle)
        if self.winds(head, angle):
            pose = {n: v for n, v in self.pose.items() if n != self.coordinate}
            turned = self.sign * angle
            there = by_opensim.lengths(self.path, head.name, self.coordinate, turned, pose)
            return ours if there is None else there
        return ours

    def winds(self, head: Head, angle: FloatArray) -> bool:
        """Whether a head's path lies on two cylinders at once, at angles of ours [rad]."""
        return len(head.path.cylinders) > 1 and any(
            head.path.touches(self.skeleton, self.posed(at)) > 1
            for at in (float(angle[0]), float(angle[-1]))
        )

    @property
    def shank(self) -> str:
        """The body above the ankle."""
        joints = self.skeleton.joints.values()
        return next(joint.parent for joint in joints if self.coordinate in joint.coordinates)

    @property
    def _moving(self) -> tuple[str, ...]:
        return self.skeleton.beyond(self.coordinate)


def _model(root: Node, where: str) -> Node:
    model = root.find("Model")
    if root.tag != "OpenSimDocument" or model is None:
        raise InputError(
            f"{where}: no model of OpenSim: it has no <OpenSimDocument> with a <Model>"
        )
    return model


def muscles_of(root: Node, where: str) -> list[Node]:
    """Elements of a model's muscles."""
    forces = _model(root, where).find("ForceSet")
    objects = None if forces is None else forces.find("objects")
    listed = [] if objects is None else objects.children
    return [node for node in listed if node.find("max_isometric_force") is not None and node.name]


def leg_in_model(
    path: PathLike, *, side: str = "right", pose: Mapping[str, float] | None = None
) -> LegInModel:
    """The leg of one side in a model's file, other coordinates in a `pose` [rad, m].

    A coordinate that `pose` does not name has the model's default.
    """
    root, data = read_xml(path)
    where = shown(path)
    model = _model(root, where)
    text = root.attributes.get("Version", "")
    version = int(text) if text.isdigit() else 0
    if side not in SIDES:
        raise InputError(f"side is {side!r}; use one of: {', '.join(SIDES)}")
    skeleton = Skeleton.of(model)
    letter = SIDES[side]
    coordinate = _ankle(skeleton, letter, where)
    posed = _posed(skeleton, pose or {}, where)
    heads = _heads(muscles_of(root, where), skeleton, letter, where)
    joint = next(
        (
            j.name
            for j in model.all()
            if j.tag.endswith("Joint") and any(c.name == coordinate for c in j.all("Coordinate"))
        ),
        "",
    )
    leg = LegInModel(
        where,
        os.fspath(path),
        data,
        version,
        root,
        skeleton,
        side,
        coordinate,
        f"/jointset/{joint}/{coordinate}",
        1.0,
        heads,
        posed,
        (),
    )
    here = np.zeros(1)
    soleus = float(leg.arm(next(h for h in heads if h.group == "tri"), here)[0])
    sign = 1.0 if soleus > 0.0 else -1.0
    for head in heads:
        arm = float(leg.arm(head, here)[0]) * sign * (1.0 if head.group == "tri" else -1.0)
        if arm < _LEAST:
            raise InputError(
                f"{where}: muscle {head.name!r} pulls the ankle the wrong way, or not: its moment "
                f"arm at 0° is {1e3 * arm:.3g} mm"
            )
    return replace(leg, sign=sign, others=_crossing(leg, muscles_of(root, where)))


def _ankle(skeleton: Skeleton, letter: str, where: str) -> str:
    named = [name for name in skeleton.rests if _sided(name, _ANKLE, letter)]
    if not named:
        some = ", ".join(list(skeleton.rests)[:12]) or "none"
        raise InputError(
            f"{where}: no coordinate is the ankle's angle of this side (ankle_angle_{letter}); "
            f"coordinates: {some}"
        )
    return named[0]


def _posed(skeleton: Skeleton, pose: Mapping[str, float], where: str) -> dict[str, float]:
    for name in pose:
        if name not in skeleton.rests:
            raise InputError(
                f"{where}: there is no coordinate {name!r}{nearest(name, skeleton.rests)}"
            )
    return {**skeleton.rests, **pose}


def _heads(muscles: list[Node], skeleton: Skeleton, letter: str, where: str) -> tuple[Head, ...]:
    made = []
    for group, kinds in _HEADS.items():
        nodes = {
            kind: node
            for kind, stem in kinds.items()
            for node in muscles
            if _sided(node.name, stem, letter)
        }
        if not nodes or (group == "tri" and "sol" not in nodes):
            what = "tibialis anterior" if group == "tib" else "soleus"
            some = ", ".join(n.name for n in muscles[:12]) or "none"
            raise InputError(f"{where}: no muscle is the {what} of this side; muscles: {some}")
        heads = [Head(group, k, n, path_of(n, skeleton), 0.0) for k, n in nodes.items()]
        whole = sum(h.value("max_isometric_force") for h in heads)
        made += [
            Head(group, h.kind, h.node, h.path, h.value("max_isometric_force") / whole)
            for h in heads
        ]
    return tuple(made)


def _crossing(leg: LegInModel, muscles: list[Node]) -> tuple[str, ...]:
    """Muscles beside the leg's own whose path goes from before the ankle to beyond it."""
    beyond = set(leg.skeleton.beyond(leg.coordinate))
    heads = {head.name for head in leg.heads}
    crossing = []
    for node in muscles:
        geometry = node.find("GeometryPath")
        if node.name in heads or geometry is None:
            continue
        frames = [
            p.said("socket_parent_frame", "body")
            for p in geometry.all("PathPoint", "ConditionalPathPoint", "MovingPathPoint")
        ]
        sides = {leg.skeleton.body_of(frame)[0] in beyond for frame in frames if frame}
        if len(sides) == 2:
            crossing.append(node.name)
    return tuple(crossing)
