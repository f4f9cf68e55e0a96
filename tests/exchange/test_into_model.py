"""A fit's muscles in somebody's OpenSim model: all else stays, and the torque is the fit's."""

from pathlib import Path

import numpy as np
import pytest

import surae
from made_osim import HEADS, osim_text
from surae.base.errors import InputError
from surae.exchange.edited import edited
from surae.exchange.into import leg_for_model
from surae.exchange.leg_in_model import leg_in_model
from surae.exchange.xml_tree import LARGEST, parse_xml
from surae.measures.fitted_leg import measured_range
from surae.measures.leg import Leg
from surae.model import ModelOptions, get_model
from surae.studies import virtual_subject

MOVED = (-25.0, 20.0)
ANGLES = np.radians(np.linspace(*MOVED, 7))
FAMILIES = ("gait", "rajagopal", "reduced")


def human_leg(**values: float) -> Leg:
    """A leg whose lengths change by its arms, as muscles of such models do."""
    drawn = virtual_subject(2)
    own = {"x0_tri": 0.03, "k_tri": 60.0, "l0_tri": 0.06, "l0_tib": 0.11, "k_tib": 70.0}
    spec = get_model("muscle")
    options = ModelOptions(geometry="virtual-work")
    return Leg(spec, options, {**drawn.parameters, **own, "x0_tib": 0.075, **values})


@pytest.fixture
def model(tmp_path):
    def written(family: str = "gait", **how) -> Path:
        path = tmp_path / f"{family}.osim"
        path.write_text(osim_text(family, **how), encoding="utf-8")
        return path

    return written


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("side", ["right", "left"])
def test_the_heads_together_pull_as_the_fit_does(model, family, side) -> None:
    leg = human_leg()
    made = leg_for_model(leg, MOVED, leg_in_model(model(family), side=side))
    assert {of.head.name for of in made.heads} == {
        f"{name}_{side[0]}" for name in HEADS[family] if name != "tib_post"
    }
    assert made.rms < 0.03 * made.largest
    still = np.zeros_like(ANGLES)
    for group in ("tri", "tib"):
        for part in (0.0, 0.6):
            there = sum(
                of.torque(ANGLES, still, still + part)
                for of in made.heads
                if of.head.group == group
            )
            ours = [
                leg.hold(group, at, part * made.peaks[group]).torque
                for at in np.degrees(ANGLES).tolist()
            ]
            np.testing.assert_allclose(there, ours, atol=0.06 * np.abs(ours).max() + 0.05)


def test_fibres_pennation_and_strength_stay_the_models_own(model) -> None:
    path = model()
    made = leg_for_model(human_leg(), MOVED, leg_in_model(path))
    own = {f"{name}_r": numbers for name, (_, numbers) in HEADS["gait"].items()}
    for of in made.heads:
        fibre, _, pennation, _ = own[of.head.name]
        assert (of.muscle.optimal, of.muscle.pennation) == (fibre, pennation)
    whole = {"tri": 1500.0 + 650.0 + 3400.0, "tib": 900.0}
    for group, force in whole.items():
        total = sum(of.muscle.peak for of in made.heads if of.head.group == group)
        assert total == pytest.approx(force)
    measured = leg_for_model(human_leg(), MOVED, leg_in_model(path), "measured")
    assert measured.peaks["tri"] == pytest.approx(1000.0)  # no recording: the default
    assert sum(of.muscle.peak for of in measured.heads) < sum(whole.values())


@pytest.mark.parametrize("family", FAMILIES)
def test_nothing_else_of_the_file_changes(model, family) -> None:
    path = model(family)
    leg = human_leg()
    made = leg_for_model(leg, MOVED, leg_in_model(path))
    text = edited(made, ["two -- hyphens, 5° and a ’"])
    before, after = (t.decode().splitlines() for t in (text.before, text.after))
    assert text.before == path.read_bytes()
    gone, new = _applied(text.difference, before)
    assert new == after
    names = {of.head.name for of in made.heads}
    root = parse_xml(text.after, "after")
    for node in parse_xml(text.before, "before").find("Model").find("ForceSet").all():
        if node.name and node.name not in names and node.find("max_isometric_force"):
            own = text.before[node.start : node.end]
            assert text.after.count(own) == 1
    # muscles of the leg keep their paths
    muscles = {m.name: m for m in root.all("DeGrooteFregly2016Muscle")}
    assert names <= muscles.keys()
    old = {m.name: m for m in parse_xml(text.before, "b").all() if m.name in names}
    for name in names:
        paths = [
            data[m.find("GeometryPath").start : m.find("GeometryPath").end]
            for m, data in ((old[name], text.before), (muscles[name], text.after))
        ]
        assert paths[0] == paths[1]
    assert gone  # something did change


def _applied(difference: str, lines: list[str]) -> tuple[int, list[str]]:
    """Lines with a difference applied, as `patch` does it, and how many went."""
    made: list[str] = []
    here = gone = 0
    for line in difference.splitlines()[2:]:
        if line.startswith("@@"):
            start = int(line.split()[1].split(",")[0][1:]) - 1
            made += lines[here:start]
            here = start
        elif line.startswith("+"):
            made.append(line[1:])
        else:
            assert lines[here] == line[1:]
            here += 1
            if line.startswith("-"):
                gone += 1
            else:
                made.append(line[1:])
    return gone, made + lines[here:]


def test_a_coordinate_that_grows_in_plantarflexion_is_turned_round(tmp_path) -> None:
    text = osim_text("rajagopal")
    turned = text.replace(
        '<PhysicalOffsetFrame name="tibia_r_offset"><socket_parent>/bodyset/tibia_r</socket_parent>'
        "<translation>-0.01 -0.42 0</translation><orientation>0 0 0</orientation>",
        '<PhysicalOffsetFrame name="tibia_r_offset"><socket_parent>/bodyset/tibia_r</socket_parent>'
        "<translation>-0.01 -0.42 0</translation><orientation>0 3.14159265358979 0</orientation>",
    ).replace(
        '<PhysicalOffsetFrame name="talus_r_offset"><socket_parent>/bodyset/talus_r</socket_parent>'
        "<translation>0 0 0</translation><orientation>0 0 0</orientation>",
        '<PhysicalOffsetFrame name="talus_r_offset"><socket_parent>/bodyset/talus_r</socket_parent>'
        "<translation>0 0 0</translation><orientation>0 3.14159265358979 0</orientation>",
        1,
    )
    assert turned != text
    plain, other = tmp_path / "plain.osim", tmp_path / "turned.osim"
    plain.write_text(text, encoding="utf-8")
    other.write_text(turned, encoding="utf-8")
    one, two = (leg_in_model(path) for path in (plain, other))
    assert (one.sign, two.sign) == (1.0, -1.0)
    for first, second in zip(one.heads, two.heads, strict=True):
        np.testing.assert_allclose(one.length(first, ANGLES), two.length(second, ANGLES), atol=1e-9)
    mass, _, inertia, axis = one.foot(0.1)
    other_foot = two.foot(0.1)
    assert other_foot[0] == mass
    assert other_foot[2] == pytest.approx(inertia)
    np.testing.assert_allclose(other_foot[3], axis, atol=1e-6)


def test_other_muscles_that_cross_the_ankle_are_named(model) -> None:
    made = leg_for_model(human_leg(), MOVED, leg_in_model(model()))
    assert made.into.others == ("tib_post_r",)
    assert "tib_post_r" in made.warnings[-1]
    assert leg_in_model(model("reduced")).others == ()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("ankle_angle_r", "foot_turn_r"), "no coordinate is the ankle's angle of this side"),
        (('"soleus_r"', '"sl_r"'), "no muscle is the soleus of this side"),
        (("<OpenSimDocument", "<!DOCTYPE x [<!ENTITY a 'b'>]><OpenSimDocument"), "document type"),
        (("</Model>", ""), "not XML"),
        (('Version="40000"', 'Version="30000"'), "older format"),
        (("<optimal_fiber_length>0.047", "<optimal_fiber_length>-1"), "no optimal_fiber_length"),
        (("<location>0 0.031 -0.005", "<location>0 0.031"), "no location of three numbers"),
    ],
)
def test_a_wrong_model_is_refused_in_a_line(tmp_path, change, said) -> None:
    path = tmp_path / "wrong.osim"
    path.write_text(osim_text().replace(*change), encoding="utf-8")
    with pytest.raises(InputError, match=said) as refused:
        edited(leg_for_model(human_leg(), MOVED, leg_in_model(path)), [])
    assert "\n" not in str(refused.value)


def test_elements_too_deep_and_files_too_large_are_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="more elements than a model has"):
        parse_xml(b"<a>" * 5000 + b"</a>" * 5000, "deep.osim")
    large = tmp_path / "large.osim"
    with large.open("wb") as file:
        file.truncate(LARGEST + 1)
    with pytest.raises(InputError, match="larger than"):
        leg_in_model(large)


@pytest.fixture(scope="module")
def fit(trial_csv):
    return surae.fit(trial_csv, model="muscle", prepared=True, geometry="virtual-work")


def test_it_is_saved_beside_and_never_over_the_model(fit, model, tmp_path) -> None:
    path = model()
    before = path.read_bytes()
    made = surae.export(fit, to="osim", into=path, side="left", pose={"knee_angle_l": -20.0})
    files = made.save(tmp_path / "leg.osim")
    assert sorted(files) == ["bounds", "difference", "model"]
    assert path.read_bytes() == before
    link = tmp_path / "link.osim"
    link.symlink_to(path)
    for wrong in (path, link):
        with pytest.raises(InputError, match="stays as it is"):
            made.save(wrong)
    assert path.read_bytes() == before
    table = Path(files["bounds"]).read_text(encoding="utf-8").splitlines()
    assert table[0].startswith("component_path,property,nominal,min_value,max_value")
    rows = {tuple(line.split(",")[:2]): line.split(",") for line in table[1:]}
    for (_, name), (*_, nominal, low, high, _, _, _, _) in (
        (key, ["", *cells]) for key, cells in rows.items() if "," not in key[1]
    ):
        if low and name == "tendon_slack_length":
            assert float(low) < float(nominal) < float(high)
    assert ("/forceset/soleus_l", "tendon_slack_length") in rows
    with pytest.raises(InputError, match="already"):
        surae.export(fit, to="osim", into=tmp_path / "leg.osim", side="left")
    with pytest.raises(InputError, match="there is no coordinate"):
        surae.export(fit, to="osim", into=path, pose={"knee_angel_l": 1.0})
    with pytest.raises(InputError, match="give to='osim'"):
        surae.export(fit, to="mjcf", into=path)


def test_a_path_round_two_cylinders_is_said_where_opensim_is_not_there(model, monkeypatch) -> None:
    monkeypatch.setattr("surae.exchange.by_opensim.is_there", lambda: False)
    into = leg_in_model(model("wound"))
    made = leg_for_model(human_leg(), MOVED, into)
    assert made.warnings[-1].startswith("gasmed_r, gaslat_r: OpenSim states a length")
    bent = leg_in_model(model("wound"), pose={"knee_angle_r": -1.2})
    assert bent.heads[1].path.touches(bent.skeleton, bent.posed(0.0)) < 2
    said = " ".join(leg_for_model(human_leg(), MOVED, bent).warnings)
    assert "two cylinders" not in said


@pytest.mark.slow
@pytest.mark.parametrize("family", [*FAMILIES, "wound"])
@pytest.mark.parametrize("side", ["right", "left"])
def test_opensim_moves_it_with_this_torque(fit, model, tmp_path, family, side) -> None:
    """Over the recording: muscles, tissue and joint, at its angles, speeds and activity."""
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed (extra `simulators`)")
    opensim.Logger.setLevelString("off")
    result = fit.result
    leg = Leg(result.problem.spec, result.problem.options, result.values, result.problem.inputs)
    bend = 0.0 if family == "wound" else np.radians(-40.0)
    knee = {f"knee_angle_{side[0]}": bend}
    into = leg_in_model(model(family), side=side, pose=knee)
    moved = measured_range(result)
    made = leg_for_model(leg, moved, into)
    path = tmp_path / "leg.osim"
    path.write_bytes(edited(made, []).after)
    simulated = opensim.Model(str(path))
    state = simulated.initSystem()
    coordinates = simulated.getCoordinateSet()
    ankle = coordinates.get(into.coordinate)
    coordinates.get(f"knee_angle_{side[0]}").setValue(state, bend, False)
    inputs = leg.inputs[0]
    within = (inputs.angle > made.moved[0]) & (inputs.angle < made.moved[1])
    some = np.flatnonzero(within)[::25]
    angle, speed = inputs.angle[some], inputs.velocity[some]
    alpha = leg.active_states[0][:, some]
    ours = made.tissue.along(angle, speed)
    for of in made.heads:
        active = alpha[("tri", "tib").index(of.head.group)] / made.peaks[of.head.group]
        ours = ours + of.torque(angle, speed, active)
    found = []
    forces = simulated.getForceSet()
    for at, (q, u) in enumerate(zip(angle.tolist(), speed.tolist(), strict=True)):
        ankle.setValue(state, into.sign * q, False)
        ankle.setSpeedValue(state, into.sign * u)
        for of in made.heads:
            active = alpha[("tri", "tib").index(of.head.group), at] / made.peaks[of.head.group]
            simulated.getMuscles().get(of.head.name).setActivation(state, float(active))
        simulated.equilibrateMuscles(state)
        simulated.realizeDynamics(state)
        torque = 0.0
        for of in made.heads:
            muscle = simulated.getMuscles().get(of.head.name)
            tissue = forces.get(f"surae_{of.head.name}_tissue")
            tissue = opensim.ExpressionBasedPathForce.safeDownCast(tissue)
            for force in (muscle, tissue):
                tension = muscle.getActuation(state) if force is muscle else force.getTension(state)
                torque -= into.sign * tension * force.computeMomentArm(state, ankle)
        found.append(torque)
    found = np.array(found) + made.tissue.along(angle, speed)
    np.testing.assert_allclose(found, ours, atol=0.02 + 1e-3 * np.abs(ours).max())
