"""The joint as a model of MuJoCo (MJCF)."""

import math
from xml.etree.ElementTree import Element, SubElement

from surae.exchange.joint import JointModel, Springs
from surae.exchange.muscles import MujocoMuscle, WrappedPath
from surae.exchange.text import row, text_of
from surae.model.contraction import FECC
from surae.model.movement import GRAVITY

#: Inertia of a point mass about itself [kg·m²]; none may be zero.
_POINT = 1e-6
#: Lengths between which the muscle's own are measured [L0].
_RANGE = (0.5, 1.5)


def mjcf(joint: JointModel, comments: list[str]) -> str:
    """The file, with comments before the model."""
    anatomy = joint.anatomy
    model = Element("mujoco", model=anatomy.name)
    SubElement(model, "compiler", angle="radian")
    SubElement(model, "option", gravity=row(0.0, 0.0, -GRAVITY), integrator="implicitfast")
    world = SubElement(model, "worldbody")
    foot = SubElement(world, "body", name=anatomy.limb)
    # dorsiflexion turns x into z; the foot lies by θ_foot below the horizontal
    axis = {"name": f"{anatomy.name}_angle", "type": "hinge", "axis": "0 -1 0"}
    held = {}
    beside = joint.tissue
    if beside.stiffness:
        rest = -beside.torque / beside.stiffness
        held = {"stiffness": row(beside.stiffness), "springref": row(rest)}
    if beside.damping:
        held["damping"] = row(beside.damping)
    SubElement(foot, "joint", axis, limited="false", range=row(*joint.moved), **held)
    turned = joint.theta_foot
    distance = anatomy.distance
    at = distance * math.cos(turned), 0.0, -distance * math.sin(turned)
    inertia = row(_POINT, _POINT, _POINT)
    SubElement(foot, "inertial", pos=row(*at), mass=row(joint.mass), diaginertia=inertia)
    tendons = SubElement(model, "tendon")
    actuators = SubElement(model, "actuator")
    for of in joint.muscles:
        muscle = of.muscle
        springs = of.tissue
        name = of.name
        assert isinstance(muscle, MujocoMuscle)
        assert isinstance(springs, Springs)
        path = of.path
        assert isinstance(path, WrappedPath)
        SubElement(world, "site", name=f"{name}_origin", pos=row(0.0, 0.0, path.origin))
        for end, (forward, up) in (("insertion", path.insertion), ("side", path.side)):
            SubElement(foot, "site", name=f"{name}_{end}", pos=row(forward, 0.0, up))
        SubElement(
            foot,
            "geom",
            name=f"{name}_bone",
            type="cylinder",
            size=row(path.radius, 0.02),
            pos=row(path.forward, 0.0, path.up),
            euler=row(math.pi / 2.0, 0.0, 0.0),
            contype="0",
            conaffinity="0",
            mass="0",
        )
        pulls: list[tuple[str, dict[str, str]]] = [(name, {})]
        pulls += [
            (f"{name}_tissue_{i}", {"springlength": row(0.0, at), "stiffness": row(stiffness)})
            for i, (at, stiffness) in enumerate(
                zip(springs.lengths, springs.stiffness, strict=True)
            )
        ]
        for called, how in pulls:
            tendon = SubElement(tendons, "spatial", {"name": called, **how})
            SubElement(tendon, "site", site=f"{name}_origin")
            SubElement(tendon, "geom", geom=f"{name}_bone", sidesite=f"{name}_side")
            SubElement(tendon, "site", site=f"{name}_insertion")
        ends = (muscle.slack + at * muscle.optimal for at in _RANGE)
        gain = (*_RANGE, muscle.peak, 200.0, muscle.lmin, muscle.lmax, muscle.speed, 1.0, FECC)
        SubElement(
            actuators,
            "general",
            name=name,
            tendon=name,
            ctrlrange="0 1",
            ctrllimited="true",
            dyntype="filterexact",
            dynprm=row(muscle.lag),
            gaintype="muscle",
            gainprm=row(*gain),
            biastype="none",
            lengthrange=row(*ends),
        )
    return text_of(model, comments)
