"""Lengths of muscles' paths in a pose of an OpenSim model.

A path is the shortest string through its points: straight, and round the cylinders that it has. On
a cylinder the string is straight once it is unrolled, so that its length is the hypotenuse of the
way round and the way along.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.exchange.functions import Function, function_of
from surae.exchange.kinematics import Skeleton, last, placed
from surae.exchange.xml_tree import Node

#: Points of a path by their elements' names.
_POINTS = ("PathPoint", "ConditionalPathPoint", "MovingPathPoint")
#: Rounds in which a string that goes round two cylinders is drawn tight.
_ROUNDS = 60
_TIGHT = 1e-10
#: Sides by the name of a wrap object's quadrant.
_SIDES = {"x": (0, 1.0), "+x": (0, 1.0), "-x": (0, -1.0), "y": (1, 1.0), "+y": (1, 1.0)}
_SIDES["-y"] = (1, -1.0)


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder that a path goes round."""

    body: str
    placed: FloatArray  #: On the body, its axis the frame's z, shape (4, 4).
    radius: float  #: [m]
    #: Axis (0 or 1) and sign of the side on which a path goes round; None where either will do.
    side: tuple[int, float] | None

    def between(self, start: FloatArray, stop: FloatArray) -> tuple[FloatArray, ...]:
        """Where a string between two points touches it, all in the cylinder's frame.

        Empty where it touches nothing.
        """
        (ax, ay, _), (bx, by, _) = start, stop
        if math.hypot(ax, ay) <= self.radius or math.hypot(bx, by) <= self.radius:
            return ()
        nearest = _nearest(ax, ay, bx, by)
        touches = math.hypot(*nearest) < self.radius
        if self.side is None:
            if not touches:
                return ()
            return self._round(start, stop, 1.0 if ax * by - ay * bx > 0.0 else -1.0)
        axis, sign = self.side
        if not touches and nearest[axis] * sign > 0.0:
            return ()
        ways = [self._round(start, stop, turn) for turn in (1.0, -1.0)]
        right = [w for w in ways if _middle(w, self.radius)[axis] * sign > 0.0]
        if not right:
            return ()
        return min(right, key=lambda way: float(way[2][1]))

    def _round(self, start: FloatArray, stop: FloatArray, turn: float) -> tuple[FloatArray, ...]:
        """Tangent points of the string that goes round with this sense, and the sense."""
        radius = self.radius
        flat = []
        for point, sense in ((start, turn), (stop, -turn)):
            away = math.hypot(point[0], point[1])
            at = math.atan2(point[1], point[0]) + sense * math.acos(radius / away)
            flat.append(np.array([radius * math.cos(at), radius * math.sin(at)]))
        first, second = flat
        turned = math.atan2(second[1], second[0]) - math.atan2(first[1], first[0])
        turned = (turn * turned) % (2.0 * math.pi)
        ways = (
            math.dist(start[:2], first),
            radius * turned,
            math.dist(second, stop[:2]),
        )
        whole = sum(ways)
        rise = stop[2] - start[2]
        heights = start[2] + rise * ways[0] / whole, stop[2] - rise * ways[2] / whole
        return (
            np.array([*first, heights[0]]),
            np.array([*second, heights[1]]),
            np.array([turn, turned]),
        )


def _nearest(ax: float, ay: float, bx: float, by: float) -> tuple[float, float]:
    """The point of a line's piece that is nearest to the axis."""
    dx = bx - ax
    dy = by - ay
    square = dx * dx + dy * dy
    part = 0.0 if square == 0.0 else min(max(-(ax * dx + ay * dy) / square, 0.0), 1.0)
    return ax + part * dx, ay + part * dy


def _middle(way: tuple[FloatArray, ...], radius: float) -> FloatArray:
    """The middle of what of a string lies on a cylinder."""
    first, _, (turn, turned) = way
    at = math.atan2(first[1], first[0]) + 0.5 * turn * turned
    return radius * np.array([math.cos(at), math.sin(at)])


@dataclass(frozen=True, slots=True)
class PathPoint:
    """A point of a path."""

    body: str
    place: tuple[Function, Function, Function]  #: On the body [m].
    #: The coordinate and its range in which the path goes through it; None where it always does.
    only: tuple[str, float, float] | None = None

    def in_use(self, pose: Mapping[str, float]) -> bool:
        """Whether the path goes through it in a pose."""
        if self.only is None:
            return True
        name, low, high = self.only
        return low - 1e-9 <= pose.get(name, 0.0) <= high + 1e-9


@dataclass(frozen=True, slots=True)
class StringPath:
    """The path of a muscle."""

    points: tuple[PathPoint, ...]
    cylinders: tuple[Cylinder, ...] = ()

    @property
    def bodies(self) -> frozenset[str]:
        """Bodies that it holds on to."""
        return frozenset(point.body for point in self.points)

    def length(self, skeleton: Skeleton, pose: Mapping[str, float]) -> float:
        """Its length in a pose [m]."""
        return self._drawn(skeleton, pose)[0]

    def touches(self, skeleton: Skeleton, pose: Mapping[str, float]) -> int:
        """How many cylinders it lies on in a pose, of one piece the most."""
        return self._drawn(skeleton, pose)[1]

    def _drawn(self, skeleton: Skeleton, pose: Mapping[str, float]) -> tuple[float, int]:
        at = {
            body: skeleton.place(body, pose)
            for body in {*self.bodies, *(c.body for c in self.cylinders)}
        }
        corners = [
            at[p.body] @ np.array([*(f(pose) for f in p.place), 1.0])
            for p in self.points
            if p.in_use(pose)
        ]
        round_what = [(at[c.body] @ c.placed, c) for c in self.cylinders]
        pieces = [_string(start, stop, round_what) for start, stop in pairwise(corners)]
        return sum(length for length, _ in pieces), max(touched for _, touched in pieces)


def _string(
    start: FloatArray, stop: FloatArray, cylinders: Sequence[tuple[FloatArray, Cylinder]]
) -> tuple[float, int]:
    """Length of a string from point to point, drawn tight round cylinders [m], and how many."""
    along = stop - start
    order = sorted(cylinders, key=lambda c: float((c[0][:, 3] - start) @ along))
    touched: list[tuple[FloatArray, FloatArray, float] | None] = [None] * len(order)
    before = math.inf
    for _ in range(_ROUNDS):
        length = 0.0
        here = start
        for place, (frame, cylinder) in enumerate(order):
            following = next((t[0] for t in touched[place + 1 :] if t is not None), stop)
            touched[place] = _touching(here, following, frame, cylinder)
            if (touch := touched[place]) is not None:
                length += float(np.linalg.norm(touch[0] - here)) + touch[2]
                here = touch[1]
        length += float(np.linalg.norm(stop - here))
        if abs(length - before) < _TIGHT:
            break
        before = length
    return length, sum(touch is not None for touch in touched)


def _touching(
    start: FloatArray, stop: FloatArray, frame: FloatArray, cylinder: Cylinder
) -> tuple[FloatArray, FloatArray, float] | None:
    """Where a string first and last touches a cylinder, and its length between the two [m]."""
    inverse = np.linalg.inv(frame)
    way = cylinder.between((inverse @ start)[:3], (inverse @ stop)[:3])
    if not way:
        return None
    first, second, (_, turned) = way
    on = math.hypot(cylinder.radius * turned, second[2] - first[2])
    return frame @ np.array([*first, 1.0]), frame @ np.array([*second, 1.0]), on


def path_of(muscle: Node, skeleton: Skeleton) -> StringPath:
    """The path of a muscle's element."""
    geometry = next(
        (
            c
            for c in muscle.children
            if c.tag == "GeometryPath" or c.name in ("path", "geometrypath")
        ),
        None,
    )
    if geometry is None or geometry.tag != "GeometryPath":
        kind = "none" if geometry is None else f"a {geometry.tag}"
        raise InputError(f"muscle {muscle.name!r} has {kind} for a path; a GeometryPath is read")
    listed = geometry.find("PathPointSet")
    points = tuple(_point(p, skeleton) for p in (listed.all(*_POINTS) if listed else ()))
    if len(points) < 2:
        raise InputError(f"muscle {muscle.name!r} has no path of two points or more")
    wraps = geometry.find("PathWrapSet")
    names = [w.said("wrap_object") for w in (wraps.all("PathWrap") if wraps else ())]
    return StringPath(points, tuple(_cylinder(last(n), muscle, skeleton) for n in names if n))


def _point(node: Node, skeleton: Skeleton) -> PathPoint:
    body, offset = skeleton.body_of(node.said("socket_parent_frame", "body"))
    if node.tag == "MovingPathPoint":
        place = tuple(_moving(node, axis) for axis in "xyz")
    else:
        numbers = node.numbers("location")
        if len(numbers) != 3:
            raise InputError(f"path point {node.name!r} has no location of three numbers")
        put = (offset @ np.array([*numbers, 1.0]))[:3].tolist()
        place = tuple(_still(number) for number in put)
    only = None
    if node.tag == "ConditionalPathPoint":
        ends = node.numbers("range")
        if len(ends) == 2:
            only = last(node.said("socket_coordinate", "coordinate")), *ends
    return PathPoint(body, (place[0], place[1], place[2]), only)


def _still(number: float) -> Function:
    return lambda pose: number  # noqa: ARG005, of every pose


def _moving(node: Node, axis: str) -> Function:
    """A number of a moving point's place."""
    within = node.find(f"{axis}_location")
    name = last(node.said(f"socket_{axis}_coordinate", f"{axis}_coordinate"))
    if within is None:  # format 4: the function itself, by its name
        location = next((c for c in node.children if c.name == f"{axis}_location"), None)
        if location is None:
            raise InputError(f"moving path point {node.name!r} has no {axis}_location")
        within = Node("", {}, 0, children=[location])
    return function_of(within, (name,))


def _cylinder(name: str, muscle: Node, skeleton: Skeleton) -> Cylinder:
    body, node = skeleton.objects.get(name, ("", None))
    if node is None:
        raise InputError(f"muscle {muscle.name!r} goes round {name!r}, which the model has not")
    if node.tag != "WrapCylinder":
        raise InputError(
            f"muscle {muscle.name!r} goes round {name!r}, a {node.tag}; cylinders are read"
        )
    frame = placed(node.numbers("translation"), node.numbers("xyz_body_rotation"))
    radius = node.number("radius")
    if radius is None or not radius > 0.0:
        raise InputError(f"{name!r} has no radius")
    return Cylinder(body, frame, radius, _SIDES.get(node.said("quadrant")))
