"""A leg as a model of OpenSim and MuJoCo: its torque there is the one that the file speaks of."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from richer_legs import richer_leg
from surae.exchange.joint import joint_of
from surae.exchange.mjcf import mjcf
from surae.exchange.osim import osim
from surae.measures.leg import Leg
from surae.model import ModelOptions, get_model, with_optional
from surae.model.tissue_curve import TissueCurve
from surae.signals import Film
from surae.studies import virtual_subject

MOVED = (-30.0, 20.0)
#: A tendon of OpenSim finds no balance at exactly 0.
ACTIVE = ((0.01, 0.01), (0.4, 0.01), (0.01, 0.4), (0.2, 0.2))
ANGLES = np.radians(np.linspace(*MOVED, 7))


def leg_of(seed: int, model: str = "muscle") -> Leg:
    drawn = virtual_subject(seed, "patient" if seed % 2 else "healthy", tendons=True)
    known = {**drawn.parameters, **drawn.tendons}
    spec = get_model(model)
    starts = {p.name: p.start for p in spec.parameters}
    return Leg(spec, ModelOptions(theta_foot=0.2), {n: known.get(n, starts[n]) for n in spec.names})


def torque(joint) -> np.ndarray:
    """What the joint's closed form says that a manipulator measures, held still."""
    still = np.zeros_like(ANGLES)
    weight = joint.mass * 9.81 * 0.15 * np.cos(ANGLES - joint.theta_foot)
    return np.array(
        [
            sum(
                m.torque(ANGLES, still, still + a) for m, a in zip(joint.muscles, both, strict=True)
            )
            + weight
            for both in ACTIVE
        ]
    )


@pytest.mark.parametrize("springs", [False, True])
def test_muscles_keep_the_torque_and_an_arm_is_the_derivative_of_its_length(springs):
    joint = joint_of(leg_of(1), MOVED, springs=springs)
    assert 0.0 < joint.rms < 0.015 * joint.largest
    write = mjcf if springs else osim
    ElementTree.fromstring(write(joint, ["two -- hyphens"]).encode())
    for muscle in joint.muscles:
        step = 1e-6
        slope = muscle.path.length(ANGLES + step) - muscle.path.length(ANGLES - step)
        np.testing.assert_allclose(slope / (2.0 * step), muscle.path.arm(ANGLES), rtol=1e-6)


def test_departures_of_the_leg_are_in_the_file_and_the_laboratorys_are_named():
    plain = leg_of(3, "muscle-tendon")
    own = {"arm_scale_tri": 0.2, "length_zero_tri": 0.004, "fl_long_tri": -0.8}
    spec = with_optional(plain.spec, [*own, "plate_cos"])
    leg = Leg(spec, plain.options, {**plain.values, **own, "plate_cos": 3.0})
    joint, without = (joint_of(of, MOVED, springs=False) for of in (leg, plain))
    grown = joint.muscles[0].path.arm(ANGLES) / without.muscles[0].path.arm(ANGLES)
    np.testing.assert_allclose(grown, np.exp(0.2), rtol=1e-3)
    assert joint.muscles[0].muscle != without.muscles[0].muscle
    assert joint.missing == ("plate_cos",)
    narrower = joint_of(leg.with_values({"fl_long_tri": 0.0}), MOVED, springs=False)
    assert joint.muscles[0].muscle != narrower.muscles[0].muscle


@pytest.mark.parametrize(
    ("seed", "model", "share", "limits"),
    [
        (1, "muscle", 0.015, ()),
        # 0.010 would need a fibre of −1.2 to −0.2 optimal lengths: OpenSim turns its force round
        (2, "muscle", 0.045, ("optimum",)),
        (1, "muscle-tendon", 0.04, ("optimum", "peak force")),
    ],
)
def test_a_fibre_is_as_long_as_fitted_and_its_curve_is_wider_instead(
    seed, model, share, limits
) -> None:
    leg = leg_of(seed, model)
    joint = joint_of(leg, MOVED, springs=False)
    assert joint.rms < share * joint.largest
    for of, group in zip(joint.muscles, ("tri", "tib"), strict=True):
        assert of.muscle.optimal == leg.values[f"l0_{group}"]
        assert of.muscle.width >= 1.0
        assert f"{of.name} {of.muscle.width:.3g}" in joint.widths
    # the thesis's triceps travels 17 mm/rad under an arm of 48
    triceps = joint.muscles[0].muscle
    assert triceps.width > 1.5
    assert triceps.at_limit == limits
    said = " ".join(each for each in joint.warnings if each.startswith("triceps_surae: "))
    assert ("times as wide as the standard one" in said) == (triceps.width > 2.0)
    assert ("possible there: " + ", ".join(limits) in said) == bool(limits)
    assert ("its tendon stretches by" in said) == (triceps.strain > 0.15)
    assert (triceps.strain > 0.15) == (model == "muscle-tendon")
    told = [float(e.text) for e in root_of(osim(joint, [])).iter("active_force_width_scale")]
    assert told == [pytest.approx(of.muscle.width) for of in joint.muscles]


def test_a_limit_that_is_met_is_said() -> None:
    joint = joint_of(leg_of(2), MOVED, springs=False)
    assert joint.muscles[1].muscle.at_limit == ("width",)
    assert joint.warnings[-1] == "tibialis_anterior: at the end of what is possible there: width."


def test_a_triceps_that_travels_by_its_arm_has_the_usual_curve() -> None:
    """Its fibre has room there: the printed path's, which has none, is nearly twice as wide."""
    leg = leg_of(2)
    own = {"x0_tri": 0.03, "k_tri": 60.0, "l0_tri": 0.06, "l0_tib": 0.11, "k_tib": 70.0}
    options = ModelOptions(geometry="virtual-work")
    leg = Leg(leg.spec, options, {**leg.values, **own, "x0_tib": 0.075})
    joint = joint_of(leg, MOVED, springs=False)
    printed = joint_of(leg_of(2), MOVED, springs=False)
    triceps = joint.muscles[0].muscle
    assert "optimum" not in triceps.at_limit
    assert 1.0 <= triceps.width < 0.6 * printed.muscles[0].muscle.width
    assert joint.rms / joint.largest < 0.03 < printed.rms / printed.largest


def filmed(leg: Leg, thickness: float) -> Leg:
    """The leg with a recording in which its tibialis was filmed, so thick [m]."""
    plain = richer_leg(0, rate_hz=64.0, duration=15.0).inputs
    time = np.linspace(1.0, 14.0, 200)
    film = Film("fascicle_tib", time, np.full(200, 0.06), thickness)
    return replace(leg, inputs=(replace(plain, films=(film,)),))


def test_a_filmed_pennation_is_the_exported_fibres() -> None:
    leg = leg_of(1)
    plain, slanted = (
        joint_of(filmed(leg, thickness), MOVED, springs=False) for thickness in (0.0, 0.013)
    )
    expected = np.arcsin(0.013 / leg.values["l0_tib"])
    assert [m.muscle.pennation for m in slanted.muscles] == pytest.approx([0.0, expected])
    assert not any(m.muscle.pennation for m in plain.muscles)
    # a muscle that stays as thick: the torque is followed as well
    assert slanted.rms < plain.rms + 0.01 * plain.largest
    told = root_of(osim(slanted, [])).iter("pennation_angle_at_optimal")
    assert [float(e.text) for e in told] == pytest.approx([0.0, expected])


def root_of(text: str) -> ElementTree.Element:
    return ElementTree.fromstring(text.encode())


@pytest.mark.parametrize("springs", [False, True])
def test_what_holds_the_joint_beside_its_muscles_is_in_the_file(springs) -> None:
    plain = leg_of(3)
    spec = with_optional(plain.spec, ["joint_stiffness", "joint_damping"])
    own = {"joint_stiffness": 2.0, "joint_torque": 0.3, "joint_damping": 0.1}
    leg = Leg(spec, plain.options, {**plain.values, **own})
    joint = joint_of(leg, MOVED, springs=springs)
    assert joint.missing == ()
    assert joint.tissue.torque == pytest.approx(0.3 + 2.0 * 0.26)
    root = ElementTree.fromstring((mjcf if springs else osim)(joint, []).encode())
    if springs:
        (hinge,) = (each for each in root.iter("joint") if each.get("type") == "hinge")
        assert float(hinge.get("stiffness")) == 2.0
        assert 2.0 * float(hinge.get("springref")) == pytest.approx(-joint.tissue.torque)
        assert float(hinge.get("damping")) == 0.1
        loose = leg.with_values({"joint_stiffness": 0.0})
        assert joint_of(loose, MOVED, springs=True).missing == ("joint_torque",)
        assert joint_of(loose, MOVED, springs=False).missing == ()
    else:
        (force,) = root.iter("ExpressionBasedCoordinateForce")
        # a torque of ours resists dorsiflexion, a force there drives it
        expression = force.findtext("expression")
        for q in (-0.3, 0.0, 0.2):
            told = eval(expression, {"q": q, "qdot": 0.5})
            assert told == pytest.approx(-(leg.joint_torque(np.degrees(q)) + 0.1 * 0.5))


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "model"), [(1, "muscle"), (2, "muscle"), (3, "muscle-tendon")])
def test_mujoco_has_this_torque(seed, model):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed (extra `simulators`)")
    joint = joint_of(leg_of(seed, model), MOVED, springs=True)
    simulated = mujoco.MjModel.from_xml_string(mjcf(joint, []))
    state, found = mujoco.MjData(simulated), []
    for both in ACTIVE:
        for angle in ANGLES:
            state.qpos[0], state.qvel[0], state.act[:], state.ctrl[:] = angle, 0.0, both, both
            mujoco.mj_forward(simulated, state)
            state.qacc[0] = 0.0
            mujoco.mj_inverse(simulated, state)
            found.append(state.qfrc_inverse[0] - state.qfrc_actuator[0])
    np.testing.assert_allclose(np.reshape(found, (len(ACTIVE), -1)), torque(joint), atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [0.0, 0.013])
@pytest.mark.parametrize(("seed", "model"), [(1, "muscle"), (2, "muscle"), (3, "muscle-tendon")])
def test_opensim_has_this_torque(seed, model, thickness, tmp_path):
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed (extra `simulators`)")
    opensim.Logger.setLevelString("off")
    joint, path = (
        joint_of(filmed(leg_of(seed, model), thickness), MOVED, springs=False),
        tmp_path / "leg.osim",
    )
    path.write_text(osim(joint, []), encoding="utf-8")
    simulated = opensim.Model(str(path))
    state = simulated.initSystem()
    ankle, found = simulated.getCoordinateSet().get(0), []
    inertia = joint.mass * 0.15**2 + 1e-6
    for both in ACTIVE:
        for angle in ANGLES:
            ankle.setValue(state, angle)
            for muscle, active in enumerate(both):
                simulated.getMuscles().get(muscle).setActivation(state, active)
            simulated.equilibrateMuscles(state)
            simulated.realizeAcceleration(state)
            found.append(-ankle.getAccelerationValue(state) * inertia)
    np.testing.assert_allclose(np.reshape(found, (len(ACTIVE), -1)), torque(joint), atol=0.01)


def test_a_curve_of_relaxed_tissue_is_in_the_file():
    """OpenSim has it as a polynomial of the angle; MuJoCo's joint a line, and the rest is named."""
    plain = leg_of(2)
    at = np.linspace(-35.0, 25.0, 61)
    curve = TissueCurve(tuple(at.tolist()), tuple((3.0 * np.tanh(at / 12.0)).tolist()))
    leg = Leg(plain.spec, replace(plain.options, tissue=curve), plain.values)
    shown = joint_of(leg, MOVED, springs=False)
    text = osim(shown, [])
    force = ElementTree.fromstring(text.encode()).find(".//*[@name='joint_tissue']/expression")
    expression = force.text.replace("^", "**")
    for q in ANGLES:
        pull = -eval(expression, {"q": q, "qdot": 0.0})
        assert pull == pytest.approx(curve.relaxed(np.degrees(q)), abs=0.05)
    assert shown.missing == ()
    line = joint_of(leg, MOVED, springs=True)
    assert line.missing == ("bends of the relaxed curve",)
    assert line.tissue.bends == ()
    assert line.tissue.stiffness > 0.0


@pytest.mark.parametrize("seed", [1, 2, 4])
def test_a_fibre_stays_as_long_as_opensim_knows_fibres(seed) -> None:
    """One of no length turned its force round there, and a tendon found no balance."""
    for of in joint_of(leg_of(seed), MOVED, springs=False).muscles:
        fibre = (of.path.length(ANGLES) - of.muscle.slack) / of.muscle.optimal
        assert fibre.min() > 0.249
        assert fibre.max() < 1.751


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("active", [0.01, 0.4, 1.0])
def test_a_fibre_has_a_length_under_a_tendon_that_stretches(seed, active) -> None:
    """A fibre that pulls is what the path leaves of tendon and stretch; none is turned round."""
    still = np.zeros_like(ANGLES)
    for of in joint_of(leg_of(seed, "muscle-tendon"), MOVED, springs=False).muscles:
        muscle, length = of.muscle, of.path.length(ANGLES)
        part = muscle.force(length, still, still + active) / muscle.peak
        stretch = muscle.strain * np.log1p(part / 0.2) / np.log1p(5.0)
        fibre = (length - muscle.slack * (1.0 + stretch)) / muscle.optimal
        assert fibre.min() > 0.1
