"""What no torque tells: force against arm and metre against path, to rounding, in every model."""

from dataclasses import replace

import numpy as np
import pytest

from richer_legs import richer_leg
from surae.model import ModelOptions, get_model, with_optional
from surae.model.geometry import paths
from surae.model.laboratory import COMPLIANT
from surae.model.registry import OWN
from surae.model.symmetry import (
    ARM,
    GROUPS,
    PATH,
    assumed_gear,
    bend_of_work,
    generator,
    has_symmetry,
    moved,
    tied_to_geometry,
    toe_reach,
    with_paths,
)
from surae.model.tendon import tendon_curve

#: What `auto` may take in beside model 2.1, at values that matter.
BESIDE = {
    "emd": 0.03,
    "reflex_tri": 2e3,
    "reflex_force_tri": 0.3,
    "emg_shape": -1.0,
    "emg_power": 0.2,
    "release": 0.02,
    "joint_stiffness": 2.0,
    "fl_short_tri": 0.2,
    "fv_curve": 0.3,
    "bridge_stiffness": 23.0,
    "axis_forward": 0.01,
    "angle_zero": 0.05,
    "plate_give": 1e-3,
    "torque_zero": 3.0,
    "arm_scale_tri": 0.1,
    "arm_slope_tri": 0.2,
    "path_scale_tib": -0.2,
    "path_bend_tri": 0.004,
    "length_zero_tri": 0.003,
    "xt_gl_sol": 0.05,
}
FAR = {"k_tri": 60.0, "k_tib": 70.0, "x0_tri": 0.03, "x0_tib": 0.075, "l0_tri": 0.08}
STEPS = ({"arm": 0.2}, {"path": 0.5}, {"arm": -0.15, "path": -0.6})


@pytest.fixture(scope="module")
def inputs():
    return richer_leg(0, rate_hz=64.0, duration=20.0).inputs


def leg(model: str, geometry: str, beside: dict[str, float]):
    """A model whose arms and paths may be others, and values of all its parameters."""
    spec = with_paths(with_optional(get_model(model), beside))
    values = {p.name: p.start for p in spec.parameters} | beside
    if geometry == "virtual-work":
        values |= FAR
    options = ModelOptions(geometry=geometry, emg_ref=(1e-4,) * 4)
    return spec, {name: values[name] for name in spec.names}, options


#: Models whose muscles are not tied to the assumed path.
FREE = [name for name in OWN if name != "muscle-2010"]


def torque(spec, values, options, inputs):
    vector = np.array([values[name] for name in spec.names])
    return spec.simulator(inputs, options).torque(vector)


@pytest.mark.parametrize("geometry", ["thesis", "virtual-work"])
@pytest.mark.parametrize("model", [*FREE, "auto"])
def test_the_group_leaves_every_torque_as_it_is(inputs, model, geometry) -> None:
    beside = BESIDE if model == "auto" else {}
    spec, values, options = leg(COMPLIANT if model == "auto" else model, geometry, beside)
    before = torque(spec, values, options, inputs)
    assert np.ptp(before) > 1.0
    for group in GROUPS:
        for step in STEPS:
            changed = moved(values, spec, options, group, **step)
            after = torque(spec, values | changed, options, inputs)
            assert np.abs(after - before).max() <= 1e-12 * np.abs(before).max(), (group, step)


@pytest.mark.parametrize("without", ["x0_tri", "dlt_tri", "length_zero_tri"])
def test_a_part_of_it_does_not(inputs, without) -> None:
    spec, values, options = leg("muscle-tendon-strain", "thesis", {})
    before = torque(spec, values, options, inputs)
    changed = moved(values, spec, options, "tri", arm=0.2, path=0.5)
    del changed[without]
    after = torque(spec, values | changed, options, inputs)
    assert np.abs(after - before).max() > 1e-3 * np.abs(before).max()


@pytest.mark.parametrize("scale", [ARM, PATH])
@pytest.mark.parametrize("group", GROUPS)
def test_generators_against_differences(group, scale) -> None:
    spec, values, options = leg(COMPLIANT, "thesis", BESIDE | {"film_scale_tib": 0.05})
    step = 1e-5
    name = "arm" if scale == ARM else "path"
    ends = (moved(values, spec, options, group, **{name: by}) for by in (-step, step))
    low, high = ends
    found = generator(values, spec, options, group, scale)
    for parameter in low:
        slope = (high[parameter] - low[parameter]) / (2.0 * step)
        told = found.get(parameter, 0.0)
        assert told == pytest.approx(slope, rel=1e-8, abs=1e-9 * (1.0 + abs(values[parameter])))


def test_it_is_a_group_and_takes_arrays() -> None:
    spec, values, options = leg("muscle-tendon-toe", "thesis", {})
    once = moved(values, spec, options, "tri", arm=0.3, path=-0.2)
    half = moved(values, spec, options, "tri", arm=0.1, path=0.3)
    whole = moved(values | half, spec, options, "tri", arm=0.2, path=-0.5)
    assert once == pytest.approx(whole, rel=1e-12)
    many = moved(values, spec, options, "tri", arm=np.array([0.0, 0.3]), path=-0.2)
    for name, value in once.items():
        assert np.broadcast_to(many[name], 2)[1] == pytest.approx(value, rel=1e-12)


def test_the_toe_is_that_of_the_tendon() -> None:
    for toe in (0.1, 0.3, 0.8):
        for shape in (1.0, 4.0, 9.0):
            curve = tendon_curve(0.04, toe, shape, 8e3)
            assert 0.04 * toe_reach(toe, shape) == pytest.approx(curve[0], rel=1e-14)


def test_gears_of_the_geometries() -> None:
    assert assumed_gear(ModelOptions(), "tri") == pytest.approx(1.67 * 0.0104 / 0.0480)
    assert assumed_gear(ModelOptions(), "tib") == pytest.approx(1.56 * 0.0171 / 0.0393)
    for group in GROUPS:
        assert assumed_gear(ModelOptions(geometry="virtual-work"), group) == pytest.approx(1.0)


def test_a_model_whose_muscle_is_tied_to_the_assumed_path_says_so() -> None:
    old = get_model("muscle-2010")
    assert not any(has_symmetry(old, group) for group in GROUPS)
    assert {"k_tri", "x0_tri", "b_tri", "F0", "e1", "e4"} == tied_to_geometry(old) - {"e2", "e3"}
    for spec in map(get_model, FREE):
        assert all(has_symmetry(spec, group) for group in GROUPS)
        assert not tied_to_geometry(spec)
    alone = replace(old, parameters=(*old.parameters, *get_model("muscle").parameters))
    assert has_symmetry(alone, "tri")


@pytest.mark.parametrize("group", GROUPS)
def test_a_path_with_the_bend_of_work_travels_a_steady_share_of_its_arm(group) -> None:
    options = ModelOptions()
    angle = np.array([-1e-3, 0.0, 1e-3])
    own = paths(angle=angle, velocity=0.0 * angle, options=options)[GROUPS.index(group)]
    slope = own.slope + 2.0 * bend_of_work(options, group) * angle
    gear = slope / own.arm
    assert gear[1] == pytest.approx(assumed_gear(options, group))
    assert gear[2] - gear[0] == pytest.approx(0.0, abs=2e-6)  # equation (9)'s differs by 1e-4
    assert abs(np.ptp(own.slope / own.arm)) > 1e-4
    assert bend_of_work(replace(options, geometry="virtual-work"), group) == 0.0
