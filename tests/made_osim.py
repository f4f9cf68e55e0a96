"""OpenSim models of a few bodies, in the layouts of two public families, and results of programs.

Everything here is made up: only the names of elements are those of the programs.
"""

import numpy as np

#: Muscles of a side: body and place of each point, fibre, tendon, pennation, force.
HEADS = {
    "gait": {
        "med_gas": (
            (("femur", (-0.019, -0.393, -0.024)), ("calcn", (0.0, 0.031, -0.005))),
            (0.055, 0.385, 0.297, 1500.0),
        ),
        "lat_gas": (
            (("femur", (-0.022, -0.395, 0.027)), ("calcn", (0.0, 0.031, -0.005))),
            (0.059, 0.372, 0.14, 650.0),
        ),
        "soleus": (
            (("tibia", (-0.0024, -0.1533, 0.007)), ("calcn", (0.0, 0.031, -0.005))),
            (0.047, 0.255, 0.436, 3400.0),
        ),
        "tib_ant": (
            (
                ("tibia", (0.018, -0.162, 0.011)),
                ("tibia", (0.033, -0.395, -0.018)),
                ("calcn", (0.117, 0.018, -0.03)),
            ),
            (0.095, 0.22, 0.087, 900.0),
        ),
        "tib_post": (
            (("tibia", (-0.01, -0.135, 0.002)), ("calcn", (0.042, 0.033, -0.029))),
            (0.031, 0.31, 0.21, 1500.0),
        ),
    }
}
HEADS["rajagopal"] = {
    "gasmed": (
        (("femur", (0.004, -0.379, -0.021)), ("calcn", (0.0, 0.031, -0.005))),
        (0.055, 0.385, 0.297, 1500.0),
    ),
    "gaslat": (
        (("femur", (0.004, -0.379, 0.027)), ("calcn", (0.0, 0.031, -0.005))),
        (0.059, 0.372, 0.14, 650.0),
    ),
    "soleus": HEADS["gait"]["soleus"],
    "tibant": HEADS["gait"]["tib_ant"],
}
HEADS["reduced"] = {
    "gas": HEADS["gait"]["med_gas"],
    "sol": HEADS["gait"]["soleus"],
    "ta": HEADS["gait"]["tib_ant"],
}
_BODIES = {
    "femur": (8.5, (0.0, -0.17, 0.0)),
    "tibia": (3.4, (0.0, -0.187, 0.0)),
    "talus": (0.1, (0.0, 0.0, 0.0)),
    "calcn": (1.2, (0.1, 0.03, 0.0)),
}
_KIND = {"gait": "Thelen2003Muscle", "rajagopal": "Millard2012EquilibriumMuscle"}


def row(numbers) -> str:
    return " ".join(f"{number:.9g}" for number in numbers)


def _body(name: str, wraps: str = "") -> str:
    mass, centre = _BODIES[name[:-2]]
    return (
        f'<Body name="{name}"><mass>{mass}</mass><mass_center>{row(centre)}</mass_center>'
        f"<inertia>{row((0.002, 0.004, 0.004, 0, 0, 0))}</inertia>{wraps}</Body>"
    )


def _joint(kind: str, name: str, parent: str, child: str, at, coordinate: str, inner: str) -> str:
    frames = "".join(
        f'<PhysicalOffsetFrame name="{body}_offset"><socket_parent>{path}</socket_parent>'
        f"<translation>{row(place)}</translation><orientation>0 0 0</orientation>"
        "</PhysicalOffsetFrame>"
        for body, path, place in (
            (parent, "/ground" if parent == "ground" else f"/bodyset/{parent}", at),
            (child, f"/bodyset/{child}", (0, 0, 0)),
        )
    )
    angle = (
        f'<coordinates><Coordinate name="{coordinate}"><default_value>0</default_value>'
        "<range>-2 2</range></Coordinate></coordinates>"
        if coordinate
        else ""
    )
    return (
        f'<{kind} name="{name}"><socket_parent_frame>{parent}_offset</socket_parent_frame>'
        f"<socket_child_frame>{child}_offset</socket_child_frame>{angle}"
        f"<frames>{frames}</frames>{inner}</{kind}>"
    )


def _spatial(coordinate: str, axis) -> str:
    made = (
        f'<TransformAxis name="rotation1"><coordinates>{coordinate}</coordinates>'
        f'<axis>{row(axis)}</axis><LinearFunction name="function">'
        "<coefficients>1 0</coefficients></LinearFunction></TransformAxis>"
    )
    for place, along in enumerate(((0, 1, 0), (1, 0, 0)), start=2):
        made += (
            f'<TransformAxis name="rotation{place}"><coordinates></coordinates>'
            f'<axis>{row(along)}</axis><Constant name="function"><value>0</value></Constant>'
            "</TransformAxis>"
        )
    for place, along in enumerate(np.eye(3, dtype=int), start=1):
        made += (
            f'<TransformAxis name="translation{place}"><coordinates></coordinates>'
            f'<axis>{row(along)}</axis><Constant name="function"><value>0</value></Constant>'
            "</TransformAxis>"
        )
    return f"<SpatialTransform>{made}</SpatialTransform>"


def _muscle(family: str, name: str, points, numbers, side: str) -> str:
    mirror = 1.0 if side == "r" else -1.0
    fibre, tendon, pennation, force = numbers
    placed = "".join(
        f'<PathPoint name="{name}-P{place}">'
        f"<socket_parent_frame>/bodyset/{body}_{side}</socket_parent_frame>"
        f"<location>{row((x, y, mirror * z))}</location></PathPoint>"
        for place, (body, (x, y, z)) in enumerate(points, start=1)
    )
    wraps = ""
    if family == "rajagopal" and name.startswith("gas"):
        wraps = (
            '<PathWrapSet><objects><PathWrap name="condyles">'
            f"<wrap_object>condyles_{side}</wrap_object><method>hybrid</method>"
            "<range>-1 -1</range></PathWrap></objects><groups/></PathWrapSet>"
        )
    kind = _KIND.get(family, "DeGrooteFregly2016Muscle")
    return f"""
\t\t\t\t<{kind} name="{name}">
\t\t\t\t\t<!--kept as it is: {name}-->
\t\t\t\t\t<GeometryPath name="geometrypath">
\t\t\t\t\t\t<PathPointSet><objects>{placed}</objects><groups/></PathPointSet>{wraps}
\t\t\t\t\t</GeometryPath>
\t\t\t\t\t<max_isometric_force>{force:.9g}</max_isometric_force>
\t\t\t\t\t<optimal_fiber_length>{fibre:.9g}</optimal_fiber_length>
\t\t\t\t\t<tendon_slack_length>{tendon:.9g}</tendon_slack_length>
\t\t\t\t\t<pennation_angle_at_optimal>{pennation:.9g}</pennation_angle_at_optimal>
\t\t\t\t\t<max_contraction_velocity>10</max_contraction_velocity>
\t\t\t\t</{kind}>"""


def osim_text(family: str = "gait", sides: str = "rl", *, version: int = 40000) -> str:
    """A model with two legs and a pelvis, of a family's layout."""
    bodies = joints = muscles = ""
    for side in sides:
        wrap = (
            "<WrapObjectSet><objects>"
            f'<WrapCylinder name="condyles_{side}"><active>true</active>'
            "<xyz_body_rotation>0 0 0</xyz_body_rotation><translation>0.005 -0.41 0</translation>"
            "<quadrant>all</quadrant><radius>0.025</radius><length>0.1</length></WrapCylinder>"
            "</objects><groups/></WrapObjectSet>"
        )
        bodies += "".join(
            _body(f"{n}_{side}", wrap if n == "femur" and family == "rajagopal" else "")
            for n in _BODIES
        )
        z = 0.08 if side == "r" else -0.08
        knee = f"knee_angle_{side}"
        ankle = f"ankle_angle_{side}"
        joints += _joint("WeldJoint", f"hip_{side}", "ground", f"femur_{side}", (0, 0.9, z), "", "")
        joints += _joint(
            "PinJoint", f"knee_{side}", f"femur_{side}", f"tibia_{side}", (0, -0.4, 0), knee, ""
        )
        tilt = 0.1 if side == "r" else -0.1
        if family == "gait":
            joints += _joint(
                "CustomJoint",
                f"ankle_{side}",
                f"tibia_{side}",
                f"talus_{side}",
                (0, -0.43, 0),
                ankle,
                _spatial(ankle, (-tilt, -1.7 * tilt, 0.979)),
            )
        else:
            joints += _joint(
                "PinJoint",
                f"ankle_{side}",
                f"tibia_{side}",
                f"talus_{side}",
                (-0.01, -0.42, 0),
                ankle,
                "",
            )
        joints += _joint(
            "WeldJoint",
            f"subtalar_{side}",
            f"talus_{side}",
            f"calcn_{side}",
            (-0.049, -0.042, 0.1 * z),
            "",
            "",
        )
        muscles += "".join(
            _muscle(family, f"{name}_{side}", points, numbers, side)
            for name, (points, numbers) in HEADS[family].items()
        )
    return f"""<?xml version="1.0" encoding="UTF-8" ?>
<OpenSimDocument Version="{version}">
\t<Model name="made">
\t\t<Ground name="ground"/>
\t\t<gravity>0 -9.80665 0</gravity>
\t\t<BodySet><objects>{bodies}</objects><groups/></BodySet>
\t\t<JointSet><objects>{joints}</objects><groups/></JointSet>
\t\t<ForceSet name="forceset">
\t\t\t<objects>{muscles}
\t\t\t</objects>
\t\t\t<groups/>
\t\t</ForceSet>
\t\t<MarkerSet><objects><Marker name="heel_r">
\t\t\t<socket_parent_frame>/bodyset/calcn_r</socket_parent_frame></Marker></objects></MarkerSet>
\t</Model>
</OpenSimDocument>
"""
