"""What of an OpenSim model moves with a joint: bodies, joints, and lengths of muscles' paths.

Formats 2 to 4 of ``.osim`` are read. A path is straight between its points and round cylinders
(`wrapping.py`); what goes round anything else has no length here, which is said.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.exchange.functions import Function, function_of
from surae.exchange.xml_tree import Node

_GROUND = "ground"
_JOINT = "Joint"
#: Bodies between one and the ground.
_LONGEST = 200


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body."""

    mass: float  #: [kg]
    centre: FloatArray  #: Of its mass, from its origin [m], shape (3,).
    inertia: FloatArray  #: About that [kg·m²], shape (3, 3).


@dataclass(frozen=True, slots=True)
class ModelJoint:
    """How a body hangs on another."""

    parent: str
    before: FloatArray  #: From the parent to the joint's frame there, shape (4, 4).
    after: FloatArray  #: From the joint's frame in the body to the body, shape (4, 4).
    #: Axes of rotation, in their order, then of translation, each with its amount.
    turns: tuple[tuple[FloatArray, Function], ...]
    shifts: tuple[tuple[FloatArray, Function], ...]
    coordinates: tuple[str, ...]

    def transform(self, pose: Mapping[str, float]) -> FloatArray:
        """From the parent to the body in a pose, shape (4, 4)."""
        moved = np.eye(4)
        for axis, amount in self.turns:
            moved[:3, :3] = moved[:3, :3] @ turn(axis, amount(pose))
        for axis, amount in self.shifts:
            moved[:3, 3] += axis * amount(pose)
        return np.asarray(self.before @ moved @ self.after)


def turn(axis: FloatArray, angle: float) -> FloatArray:
    """Rotation about an axis by an angle [rad], shape (3, 3): Rodrigues' formula."""
    norm = float(np.linalg.norm(axis))
    if norm == 0.0:
        return np.eye(3)
    x, y, z = axis / norm
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across)


def placed(location: Sequence[float], orientation: Sequence[float]) -> FloatArray:
    """A frame at a location [m], turned about its own x, y and z [rad], shape (4, 4)."""
    made = np.eye(4)
    for axis, angle in zip(np.eye(3), orientation or (0.0,) * 3, strict=False):
        made[:3, :3] = made[:3, :3] @ turn(axis, angle)
    if len(location) == 3:
        made[:3, 3] = location
    return made


def last(path: str) -> str:
    """The last part of a component's path, such as ``/bodyset/tibia_r``."""
    return path.strip().rstrip("/").rpartition("/")[2]


@dataclass(frozen=True)
class Skeleton:
    """Bodies and joints of a model."""

    bodies: Mapping[str, RigidBody]
    joints: Mapping[str, ModelJoint]  #: By the body that hangs on it.
    rests: Mapping[str, float]  #: Default value of every coordinate.
    #: Frames beside a body's own, by name: the body, and where on it, shape (4, 4).
    frames: Mapping[str, tuple[str, FloatArray]]
    objects: Mapping[str, tuple[str, Node]] = field(default_factory=dict)  #: To wrap, with body.

    @classmethod
    def of(cls, model: Node) -> "Skeleton":
        """What a ``<Model>`` has."""
        bodies: dict[str, RigidBody] = {}
        frames: dict[str, tuple[str, FloatArray]] = {}
        objects: dict[str, tuple[str, Node]] = {}
        listed = model.find("BodySet")
        everybody = [] if listed is None else list(listed.all("Body"))
        ground = model.find("Ground")
        for node in [*everybody, *([ground] if ground is not None else [])]:
            bodies[node.name] = _body(node)
            for wrap in (w for s in node.all("WrapObjectSet") for w in s.all() if w.name):
                objects[wrap.name] = node.name, wrap
        for frame in model.all("PhysicalOffsetFrame"):
            frames.setdefault(frame.name, (last(frame.said("socket_parent")), _frame(frame)))
        joints: dict[str, ModelJoint] = {}
        rests: dict[str, float] = {}
        for node, owner in _joints(model, everybody):
            child, joint = _joint(node, owner, frames)
            joints[child] = joint
        for node in model.all("Coordinate"):
            rests[node.name] = node.number("default_value") or 0.0
        return cls(bodies, joints, rests, frames, objects)

    def body_of(self, frame: str) -> tuple[str, FloatArray]:
        """The body that a frame of this name lies on, and where, shape (4, 4)."""
        name = last(frame)
        at = np.eye(4)
        for _ in range(_LONGEST):
            if name in self.bodies or name == _GROUND or name not in self.frames:
                break
            name, placed = self.frames[name]
            at = placed @ at
        return name, at

    def chain(self, body: str) -> tuple[str, ...]:
        """Bodies from this one to the ground."""
        named = [body]
        while named[-1] in self.joints:
            named.append(self.joints[named[-1]].parent)
            if len(named) > _LONGEST:
                raise InputError(f"body {body!r} hangs on itself")
        return tuple(named)

    def place(self, body: str, pose: Mapping[str, float]) -> FloatArray:
        """Where a body is in a pose, shape (4, 4)."""
        at = np.eye(4)
        for each in self.chain(body):
            if each in self.joints:
                at = self.joints[each].transform(pose) @ at
        return at

    def beyond(self, coordinate: str) -> tuple[str, ...]:
        """Bodies that move with a coordinate."""
        moved = [child for child, j in self.joints.items() if coordinate in j.coordinates]
        return tuple(b for b in self.bodies if set(moved) & set(self.chain(b)))

    @cached_property
    def mass(self) -> float:
        """Of all bodies [kg]."""
        return sum(body.mass for body in self.bodies.values())


def _body(node: Node) -> RigidBody:
    centre = node.numbers("mass_center")
    six = node.numbers("inertia") or tuple(
        node.number(f"inertia_{part}") or 0.0 for part in ("xx", "yy", "zz", "xy", "xz", "yz")
    )
    xx, yy, zz, xy, xz, yz = six if len(six) == 6 else (0.0,) * 6
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return RigidBody(
        node.number("mass") or 0.0, np.array(centre if len(centre) == 3 else (0.0,) * 3), inertia
    )


def _frame(node: Node) -> FloatArray:
    return placed(node.numbers("translation"), node.numbers("orientation"))


def _joints(model: Node, bodies: Sequence[Node]) -> list[tuple[Node, str]]:
    """Joints, each with the body that it stands in; empty in format 4."""
    listed = model.find("JointSet")
    joints = [
        (joint, "")
        for joint in (() if listed is None else listed.all())
        if joint.tag.endswith(_JOINT) and joint.find("socket_parent_frame") is not None
    ]
    for body in bodies:
        within = body.find(_JOINT)
        joints += [(joint, body.name) for joint in (within.children if within else ())]
    return joints


def _joint(
    node: Node, owner: str, frames: Mapping[str, tuple[str, FloatArray]]
) -> tuple[str, ModelJoint]:
    """The body that hangs on a joint, and the joint."""
    if node.said("reverse") == "true":
        raise InputError(f"joint {node.name!r} is reversed, which is not read")
    if owner:
        child = owner
        parent = node.said("parent_body")
        before = placed(node.numbers("location_in_parent"), node.numbers("orientation_in_parent"))
        after = placed(node.numbers("location"), node.numbers("orientation"))
    else:
        parent, before = _socket(node, "socket_parent_frame", frames)
        child, after = _socket(node, "socket_child_frame", frames)
    names = tuple(each.name for each in node.all("Coordinate"))
    turns, shifts = _freedom(node, names)
    return child, ModelJoint(
        parent, before, np.asarray(np.linalg.inv(after), dtype=np.float64), turns, shifts, names
    )


def _socket(
    node: Node, socket: str, frames: Mapping[str, tuple[str, FloatArray]]
) -> tuple[str, FloatArray]:
    """The body that a joint's frame lies on, and where."""
    name = last(node.said(socket))
    offsets = {
        f.name: (last(f.said("socket_parent")), _frame(f)) for f in node.all("PhysicalOffsetFrame")
    }
    return offsets.get(name) or frames.get(name) or (name, np.eye(4))


_Amounts = tuple[tuple[FloatArray, Function], ...]


def _freedom(node: Node, names: Sequence[str]) -> tuple[_Amounts, _Amounts]:
    """Axes about and along which a joint moves."""
    axes = np.eye(3)

    def coordinate(place: int) -> Function:
        return lambda pose: pose.get(names[place], 0.0)

    def several(which: Sequence[int], first: int) -> _Amounts:
        return tuple((axes[axis], coordinate(first + at)) for at, axis in enumerate(which))

    simple: dict[str, Callable[[], tuple[_Amounts, _Amounts]]] = {
        "PinJoint": lambda: (several((2,), 0), ()),
        "UniversalJoint": lambda: (several((0, 1), 0), ()),
        "GimbalJoint": lambda: (several((0, 1, 2), 0), ()),
        "BallJoint": lambda: (several((0, 1, 2), 0), ()),
        "FreeJoint": lambda: (several((0, 1, 2), 0), several((0, 1, 2), 3)),
        "SliderJoint": lambda: ((), several((0,), 0)),
        "PlanarJoint": lambda: (several((2,), 0), several((0, 1), 1)),
        "WeldJoint": lambda: ((), ()),
    }
    if node.tag in simple:
        try:
            return simple[node.tag]()
        except IndexError:
            raise InputError(f"joint {node.name!r} has too few coordinates") from None
    if node.tag != "CustomJoint":
        raise InputError(f"joint {node.name!r} is a {node.tag}, which is not read")
    turns: list[tuple[FloatArray, Function]] = []
    shifts: list[tuple[FloatArray, Function]] = []
    spatial = node.find("SpatialTransform")
    for axis in () if spatial is None else spatial.all("TransformAxis"):
        along = np.array(axis.numbers("axis"))
        amount = function_of(axis, tuple(axis.said("coordinates").split()))
        (turns if axis.name.startswith("rotation") else shifts).append((along, amount))
    return tuple(turns), tuple(shifts)
