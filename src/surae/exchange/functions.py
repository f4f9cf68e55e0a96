"""Functions of a coordinate as OpenSim's files have them."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from surae.base.errors import InputError
from surae.exchange.xml_tree import Node

#: A number in a pose: the values of coordinates by name.
Function = Callable[[Mapping[str, float]], float]
_KINDS = (
    "LinearFunction",
    "Constant",
    "SimmSpline",
    "NaturalCubicSpline",
    "GCVSpline",
    "PiecewiseLinearFunction",
    "PolynomialFunction",
    "MultiplierFunction",
)


def function_of(node: Node, coordinates: Sequence[str]) -> Function:
    """The function in an element, of coordinates."""
    within = node.find("function")
    places = [*node.children, *(within.children if within is not None else ())]
    given = next((each for each in places if each.tag in _KINDS), None)
    if given is None:
        if coordinates:
            raise InputError(f"{node.name or node.tag} has a function that is not read")
        return lambda pose: 0.0  # noqa: ARG005, of every pose
    return _made(given, coordinates)


def _made(node: Node, coordinates: Sequence[str]) -> Function:
    if node.tag == "Constant":
        value = node.number("value") or 0.0
        return lambda pose: value  # noqa: ARG005, of every pose
    if node.tag == "MultiplierFunction":
        inner = function_of(node, coordinates)
        scale = node.number("scale")
        factor = 1.0 if scale is None else scale
        return lambda pose: factor * inner(pose)
    if node.tag == "LinearFunction":
        *slopes, offset = node.numbers("coefficients")
        return lambda pose: (
            offset
            + sum(
                slope * pose.get(name, 0.0)
                for slope, name in zip(slopes, coordinates, strict=False)
            )
        )
    if len(coordinates) != 1:
        raise InputError(f"a {node.tag} of {len(coordinates)} coordinates is not read")
    (name,) = coordinates
    curve = _curve(node)
    return lambda pose: float(curve(pose.get(name, 0.0)))


def _curve(node: Node) -> Callable[[float], float]:
    """A curve of one coordinate."""
    if node.tag == "PolynomialFunction":
        coefficients = node.numbers("coefficients")
        return lambda at: float(np.polyval(coefficients, at))
    x = np.array(node.numbers("x"))
    y = np.array(node.numbers("y"))
    if len(x) != len(y) or len(x) < 2 or np.any(np.diff(x) <= 0.0):
        raise InputError(f"a {node.tag} needs two points at least, its x increasing")
    if node.tag == "PiecewiseLinearFunction" or len(x) < 4:
        return lambda at: float(np.interp(at, x, y))
    # OpenSim goes on straight beyond the ends
    spline = CubicSpline(x, y, bc_type="natural")
    slope = spline.derivative()

    def value(at: float) -> float:
        inside = min(max(at, x[0]), x[-1])
        return float(spline(inside) + slope(inside) * (at - inside))

    return value
