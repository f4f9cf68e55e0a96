"""The joint as a model of OpenSim (``.osim``)."""

import math
from xml.etree.ElementTree import Element, SubElement

from surae.exchange.joint import JointModel, JointMuscle, MuscleTissue
from surae.exchange.muscles import DeGrooteMuscle, PolynomialPath
from surae.exchange.text import row, text_of

#: The format of OpenSim 4.5, which the tissue's force needs.
_VERSION = "40500"
#: Inertia of a point mass about itself [kg·m²]; none may be zero.
_POINT = 1e-6
#: Activation below which a tendon of OpenSim that gives way finds no balance.
_LEAST = 0.01


def osim(joint: JointModel, comments: list[str]) -> str:
    """The file, with comments before the model."""
    document = Element("OpenSimDocument", Version=_VERSION)
    anatomy = joint.anatomy
    model = SubElement(document, "Model", name=anatomy.name)
    _set(model, "gravity", 0.0, -9.81, 0.0)
    foot = SubElement(_objects(model, "BodySet"), "Body", name=anatomy.limb)
    _set(foot, "mass", joint.mass)
    # dorsiflexion turns x into y; the foot lies by θ_foot below the horizontal
    forward, down = (anatomy.distance * turned(joint.theta_foot) for turned in (math.cos, math.sin))
    _set(foot, "mass_center", forward, -down, 0.0)
    _set(foot, "inertia", _POINT, _POINT, _POINT, 0.0, 0.0, 0.0)
    pin = SubElement(_objects(model, "JointSet"), "PinJoint", name=anatomy.name)
    _set(pin, "socket_parent_frame", "/ground")
    _set(pin, "socket_child_frame", f"/bodyset/{anatomy.limb}")
    angle = SubElement(SubElement(pin, "coordinates"), "Coordinate", name=f"{anatomy.name}_angle")
    _set(angle, "default_value", 0.0)
    _set(angle, "range", *joint.moved)
    forces = _objects(model, "ForceSet")
    for muscle in joint.muscles:
        _muscle(forces, muscle)
        _tissue(forces, muscle)
    if joint.tissue.pulls:
        of = joint.tissue
        beside = SubElement(forces, "ExpressionBasedCoordinateForce", name="joint_tissue")
        _set(beside, "coordinate", f"{anatomy.name}_angle")
        terms = f"{of.torque:.12g}+({of.stiffness:.12g})*q+({of.damping:.12g})*qdot"
        terms += "".join(f"+({c:.12g})*q^{power}" for power, c in enumerate(of.bends, start=2))
        _set(beside, "expression", f"-({terms})")
    return text_of(document, comments)


def _muscle(forces: Element, of: JointMuscle) -> None:
    muscle = of.muscle
    assert isinstance(muscle, DeGrooteMuscle)
    element = SubElement(forces, "DeGrooteFregly2016Muscle", name=of.name)
    _path(element, of)
    rigid = muscle.strain == 0.0
    values = {
        "min_control": 0.0 if rigid else _LEAST,
        "max_isometric_force": muscle.peak,
        "optimal_fiber_length": muscle.optimal,
        "tendon_slack_length": muscle.slack,
        "pennation_angle_at_optimal": muscle.pennation,
        "max_contraction_velocity": muscle.speed,
        "ignore_tendon_compliance": "true" if rigid else "false",
        "activation_time_constant": muscle.lag,
        "deactivation_time_constant": muscle.lag,
        "default_activation": _LEAST,
        "fiber_damping": 0.0,
        "active_force_width_scale": muscle.width,
        "ignore_passive_fiber_force": "true",  # the tissue is a force of its own
        "tendon_strain_at_one_norm_force": 0.049 if rigid else muscle.strain,
    }
    for name, value in values.items():
        _set(element, name, value)


def _tissue(forces: Element, of: JointMuscle) -> None:
    tissue = of.tissue
    assert isinstance(tissue, MuscleTissue)
    element = SubElement(forces, "ExpressionBasedPathForce", name=f"{of.name}_tissue")
    _path(element, of)
    terms = [f"({c:.12g})*s^{power}" for power, c in enumerate(tissue.coefficients) if power]
    _set(element, "resting_length", tissue.rest)
    _set(element, "expression", f"exp({'+'.join([f'{tissue.coefficients[0]:.12g}', *terms])})")
    _set(element, "clamp_stretch", "false")


def _path(element: Element, of: JointMuscle) -> None:
    assert isinstance(of.path, PolynomialPath)
    path = SubElement(element, "FunctionBasedPath", name="path")
    _set(path, "coordinate_paths", f"/jointset/{of.anatomy.name}/{of.anatomy.name}_angle")
    length = SubElement(SubElement(path, "length_function"), "PolynomialFunction")
    _set(length, "coefficients", *of.path.coefficients[::-1])


def _objects(parent: Element, name: str) -> Element:
    return SubElement(SubElement(parent, name), "objects")


def _set(parent: Element, name: str, *values: float | str) -> None:
    SubElement(parent, name).text = row(*values)
