"""What the laboratory cannot rule out: crosstalk, rest, shape, zeros and a misaligned axis."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.model import MODELS, ModelOptions, adapted, with_optional
from surae.model.geometry import JointAxis
from surae.model.joint import ANKLE
from surae.model.parameters import COMPLIANT_ALONE, CROSSTALK, OPTIONAL, OPTIONAL_PARAMETERS
from surae.recording import MUSCLES
from surae.signals import emg_levels, smooth_effort

LEVELS = (3e-4, 2e-4, 4e-4, 3e-4)
OPTIONS = ModelOptions(emg_ref=LEVELS)
GROUPS = [name for name in OPTIONAL if name not in ("emd", "reflex")]
WITH_CURVES = ("muscle-tendon",)
CROSSTALK_VALUES = dict(zip(CROSSTALK.values(), np.linspace(0.01, 0.08, 12), strict=True))
RESTS = dict(zip(OPTIONAL["emg_rest"], (9e-6, -4e-6, 2e-6, 6e-6), strict=True))
VALUES = {
    "emd": 0.0312,
    "reflex_tri": 900.0,
    "reflex_tib": 500.0,
    "reflex_delay": 0.0431,
    **CROSSTALK_VALUES,
    **RESTS,
    "emg_shape": -1.3,
    "torque_zero": 2.0,
    "angle_zero": 0.04,
    "axis_forward": 0.011,
    "axis_up": -0.017,
    "plate_inertia": 0.03,
    "plate_cos": 2.0,
    "plate_sin": -3.0,
    "joint_stiffness": 2.1,
    "joint_torque": 0.4,
    "joint_damping": 0.25,
    "plate_give": 7e-4,
    "arm_scale_tri": 0.05,
    "arm_scale_tib": -0.06,
    "arm_slope_tri": 0.1,
    "arm_slope_tib": -0.2,
    "arm_bend_tri": 0.2,
    "arm_bend_tib": -0.1,
    "path_scale_tri": 0.1,
    "path_scale_tib": -0.05,
    "path_bend_tri": 0.004,
    "path_bend_tib": -0.003,
    "length_zero_tri": 0.002,
    "length_zero_tib": -0.004,
    "emg_power": -0.25,
    "release": 0.04,
    "emg_lag": 0.02,
    **{name: 0.01 for group in OPTIONAL if group.startswith("film_") for name in OPTIONAL[group]},
}
CURVES = {
    "fl_short_tri": 0.3,
    "fl_short_tib": -0.2,
    "fl_long_tri": 0.4,
    "fl_long_tib": 0.1,
    "fv_speed": 0.2,
    "fv_curve": -0.3,
    "fv_stretch": 0.25,
    "bridge_stiffness": 20.0,
    "bridge_reach": 0.01,
    "reflex_length_tri": 2e4,
    "reflex_length_tib": 1e4,
    "reflex_force_tri": 0.05,
    "reflex_force_tib": 0.02,
}
STARTS = {p.name: p.start for p in OPTIONAL_PARAMETERS}  # all are off there
ALONE = {name for group in COMPLIANT_ALONE for name in OPTIONAL[group]}
#: One of each class; those of compliant tendons differ in what is free (test_compliant.py).
KINDS = ("muscle", *WITH_CURVES, "muscle-2010")
every_model = pytest.mark.parametrize("name", KINDS)


def tied(name, inputs, options=OPTIONS, **values):
    """The model at its starts with these optional parameters, and its vector."""
    spec = with_optional(MODELS[name], values)
    starts = {p.name: p.start for p in MODELS[name].parameters}
    return spec.simulator(inputs, options), spec.vector(starts | values, options), spec


def torque(name, inputs, options=OPTIONS, **values):
    simulator, p, _ = tied(name, inputs, options, **values)
    return simulator.torque(p)


@pytest.fixture(scope="module")
def inputs(make_inputs):
    return make_inputs(2, rate_hz=128.0, seconds=3.0)


@every_model
def test_off_is_the_model_as_it_is(name, inputs) -> None:
    plain, p, spec = tied(name, inputs)
    size = len(spec.names)
    torque, rows = plain.torque_jacobian(p, range(size))
    scale = np.abs(rows).max(axis=1, keepdims=True) + 1e-300
    for group in GROUPS:
        if group in COMPLIANT_ALONE and name not in WITH_CURVES:
            continue  # its kernels have the curves as they are printed
        off, q, _ = tied(name, inputs, **{n: STARTS[n] for n in OPTIONAL[group]})
        other, more = off.torque_jacobian(q, range(size))
        np.testing.assert_allclose(other, torque, rtol=0, atol=1e-12, err_msg=group)
        np.testing.assert_allclose(off.torque(q), torque, rtol=0, atol=1e-12, err_msg=group)
        np.testing.assert_allclose(more / scale, rows / scale, rtol=0, atol=1e-11, err_msg=group)


OFF = dict.fromkeys(VALUES, 0.0) | {"reflex_delay": 0.05}


@pytest.mark.parametrize(
    ("name", "values", "geometry", "raw"),
    [
        *((name, VALUES, "thesis", False) for name in KINDS),
        *((name, OFF, "virtual-work", False) for name in KINDS),
        ("muscle", VALUES, "thesis", True),
    ],
)
def test_sensitivities(name, geometry, values, raw, inputs) -> None:
    inputs = replace(inputs, own_envelopes=raw)
    options = replace(OPTIONS, geometry=geometry)
    own = CURVES if name in WITH_CURVES else {}
    if not any(values[n] for n in ("emg_shape", "plate_give")):
        own = dict.fromkeys(own, 0.0) | ({"bridge_reach": 0.01} if own else {})
    simulator, p, spec = tied(name, inputs, options, **values, **own)
    assert spec.optional == tuple(p.name for p in OPTIONAL_PARAMETERS if own or p.name not in ALONE)
    columns = [
        j
        for j, parameter in enumerate(spec.names)
        if parameter in spec.optional + MODELS[name].free
    ]
    modelled, rows = simulator.torque_jacobian(p, columns)
    np.testing.assert_allclose(modelled, simulator.torque(p), rtol=0, atol=1e-11)
    np.testing.assert_allclose(modelled, simulator.parts(p).total, rtol=0, atol=1e-10)
    for row, j in zip(rows, columns, strict=True):
        if not p[j] and spec.names[j] in ("emd", "reflex_delay"):
            continue  # no difference across 0; test_delay has its slope there

        def central(h: float, j: int = j) -> np.ndarray:
            above, below = p.copy(), p.copy()
            above[j] += h
            below[j] -= h
            return (simulator.torque(above) - simulator.torque(below)) / (2 * h)

        step = 1e-5 * (abs(p[j]) or 0.1 * spec.parameters[j].upper)
        slope = (4 * central(step) - central(2 * step)) / 3
        rounding = 1e-12 * np.abs(modelled).max() / step
        error, size = np.abs(row - slope), np.abs(slope).max()
        # a difference that falls on a clamp (tissue or tendon gone slack) is no derivative
        assert np.quantile(error, 0.98) <= 1e-6 * size + rounding, spec.names[j]
        assert error.max() <= 1e-4 * size + rounding, spec.names[j]


@every_model
def test_rows_of_some_are_those_of_all(name, inputs) -> None:
    simulator, p, spec = tied(name, inputs, **VALUES)
    everything = simulator.torque_jacobian(p, range(len(p)))[1]
    for chosen in (
        ["axis_up"],
        ["xt_gl_sol", "emg_rest_ta", "m"],
        ["emg_shape", "f0", "angle_zero"],
    ):
        columns = [spec.names.index(model) for model in chosen if model in spec.names]
        rows = simulator.torque_jacobian(p, columns)[1]
        np.testing.assert_allclose(rows, everything[columns], rtol=1e-12, atol=1e-12)


@every_model
def test_tissue_of_the_joint_is_a_spring_and_a_damper_and_counts_as_tissue(name, inputs) -> None:
    values = {"joint_stiffness": 2.1, "joint_torque": 0.4, "joint_damping": 0.25}
    simulator, p, _ = tied(name, inputs, **values)
    by_hand = 2.1 * (inputs.angle + 0.26) + 0.4 + 0.25 * inputs.velocity
    np.testing.assert_allclose(simulator.torque(p) - torque(name, inputs), by_hand, atol=1e-10)
    parts = simulator.parts(p)
    np.testing.assert_allclose(parts.joint, by_hand, atol=1e-12)
    muscles = parts.tissue_tri + parts.tissue_tib
    np.testing.assert_allclose(parts.tissue, muscles + by_hand, atol=1e-10)
    assert "joint_Nm" in parts.columns()
    assert "joint_Nm" not in tied(name, inputs)[0].parts(tied(name, inputs)[1]).columns()


@every_model
def test_crosstalk_and_rest_are_taken_out_again(name, inputs) -> None:
    mixing = np.eye(4)
    for (hears, of), parameter in CROSSTALK.items():
        mixing[hears, of] = CROSSTALK_VALUES[parameter]
    heard = inputs.emg @ mixing.T + np.array(list(RESTS.values()))
    same = torque(name, replace(inputs, emg=heard), **CROSSTALK_VALUES, **RESTS)
    np.testing.assert_allclose(same, torque(name, inputs), rtol=0, atol=1e-9)
    assert mixing[MUSCLES.index("ta"), MUSCLES.index("gl")] == CROSSTALK_VALUES["xt_ta_gl"]


def test_powers_of_raw_emg_add_up(inputs) -> None:
    """An electrode over a strong muscle shows nothing of a neighbour, one over a weak one does."""
    mixing = np.eye(4)
    for (hears, of), parameter in CROSSTALK.items():
        mixing[hears, of] = CROSSTALK_VALUES[parameter]
    for levels in ((1.0, 1.0, 1.0, 1.0), (1.0, 0.3, 0.2, 0.5), (0.1, 0.0, 1.0, 0.3)):
        steady = replace(inputs, emg=np.tile(1e-4 * np.array(levels), (inputs.n, 1)))
        heard = np.sqrt(steady.emg**2 @ (mixing**2).T)
        raw = replace(steady, emg=heard, own_envelopes=True)
        same = torque("muscle", raw, **CROSSTALK_VALUES)
        np.testing.assert_allclose(same, torque("muscle", steady), rtol=0, atol=0.02)
        added = np.abs(torque("muscle", replace(raw, own_envelopes=False), **CROSSTALK_VALUES))
        assert np.abs(added - np.abs(same)).max() > 0.2
    nothing = torque("muscle", raw, **dict.fromkeys(CROSSTALK_VALUES, 0.0))
    np.testing.assert_allclose(nothing, torque("muscle", raw), rtol=0, atol=1e-12)


@pytest.mark.parametrize("shape", [-3.0, -1e-9, 1e-3, 0.7])
def test_shape_is_that_of_lloyd_and_besier(shape, inputs) -> None:
    level, smooth = np.array(LEVELS), smooth_effort(inputs.emg.T, inputs.rate_hz).T
    curved = level * np.expm1(shape * smooth / level) / np.expm1(shape)
    same = torque("muscle", replace(inputs, emg=inputs.emg / smooth * curved))
    np.testing.assert_allclose(torque("muscle", inputs, emg_shape=shape), same, rtol=0, atol=1e-9)


def test_noise_of_the_emg_is_not_curved(inputs) -> None:
    """A curve makes another mean of what fluctuates by as much as itself, as rectified EMG does."""
    steady = replace(inputs, emg=np.tile(0.5 * np.array(LEVELS), (inputs.n, 1)))
    rng = np.random.default_rng(1)
    speckled = np.abs(rng.standard_normal(steady.emg.shape)) * np.sqrt(np.pi / 2.0)
    noisy = replace(steady, emg=steady.emg * speckled)
    plain = torque("muscle", noisy).mean() - torque("muscle", steady).mean()
    curved = torque("muscle", noisy, emg_shape=-3.0).mean()
    curved -= torque("muscle", steady, emg_shape=-3.0).mean()
    assert abs(curved) < 2.0 * abs(plain)


def test_shape_needs_a_level_in_volts_only(inputs) -> None:
    with pytest.raises(InputError, match=r"emg_shape needs the EMG's reference level; give the op"):
        tied("muscle", inputs, ModelOptions(), emg_shape=-1.0)
    with pytest.raises(InputError, match=r"option emg_ref is 0 V for sol, which has EMG"):
        tied("muscle", inputs, ModelOptions(emg_ref=(1e-4, 1e-4, 0.0, 1e-4)), emg_shape=-1.0)
    normalised = replace(inputs, emg=inputs.emg / np.array(LEVELS), emg_unit="1")
    spec = with_optional(MODELS["muscle"], ("emg_shape",))
    starts = {p.name: p.start for p in spec.parameters} | {"emg_shape": -1.0}
    forces = {f"g{c + 1}": 1e6 * level for c, level in enumerate(LEVELS)}
    same = spec.simulator(normalised, ModelOptions()).torque(
        spec.vector(starts | forces, ModelOptions())
    )
    np.testing.assert_allclose(same, torque("muscle", inputs, emg_shape=-1.0), rtol=0, atol=1e-9)


def test_a_missing_muscle_hears_nothing_and_is_not_heard(inputs) -> None:
    emg = inputs.emg.copy()
    emg[:, 3] = 0.0
    missing = replace(inputs, emg=emg, missing_emg=("gm",))
    without = {name: 0.0 if "gm" in name else value for name, value in CROSSTALK_VALUES.items()}
    rest = {name: 0.0 if "gm" in name else value for name, value in RESTS.items()}
    options = ModelOptions(emg_ref=(*LEVELS[:3], 0.0))
    some = torque("muscle", missing, options, **CROSSTALK_VALUES, **RESTS, emg_shape=-1.0)
    same = torque("muscle", missing, options, **without, **rest, emg_shape=-1.0)
    np.testing.assert_array_equal(some, same)
    simulator, p, spec = tied("muscle", missing, options, **CROSSTALK_VALUES, **RESTS)
    columns = [j for j, name in enumerate(spec.names) if "gm" in name]
    assert len(columns) == 7  # its rest, and the crosstalk of and to it
    assert not simulator.torque_jacobian(p, columns)[1].any()


@every_model
def test_zeros_and_axis_are_of_the_sensors(name, inputs) -> None:
    higher = torque(name, inputs, torque_zero=3.5)
    np.testing.assert_allclose(higher, torque(name, inputs) + 3.5, rtol=0, atol=1e-12)
    shifted = replace(inputs, angle=inputs.angle + 0.07)
    turned = torque(name, inputs, angle_zero=0.07)
    np.testing.assert_allclose(turned, torque(name, shifted), rtol=0, atol=1e-9)


@pytest.mark.parametrize("geometry", ["thesis", "virtual-work"])
def test_a_misaligned_axis_loses_no_work(geometry, inputs) -> None:
    options = replace(OPTIONS, geometry=geometry)
    turned = torque("muscle", inputs, options, axis_forward=0.012, axis_up=0.02)
    joint = JointAxis(angle=inputs.angle, forward=0.012, up=0.02).joint
    ankle = replace(
        inputs,
        angle=joint.angle,
        velocity=joint.factor * inputs.velocity,
        acceleration=joint.factor * inputs.acceleration + joint.bend * inputs.velocity**2,
    )
    power = joint.factor * torque("muscle", ankle, options)
    np.testing.assert_allclose(turned, power, rtol=0, atol=1e-10)


def test_angle_of_an_ankle_beside_the_axis() -> None:
    angle = np.linspace(-1.0, 0.8, 50)
    for forward, up in ((0.0, 0.0), (0.02, 0.0), (-0.03, 0.03), (0.01, -0.02)):
        here = JointAxis(angle=angle, forward=forward, up=up)
        strap = ANKLE.distance * np.exp(1j * angle)
        pointing = np.angle(strap - complex(forward, up))
        at_zero = np.angle(ANKLE.distance - complex(forward, up))
        np.testing.assert_allclose(here.joint.angle, pointing - at_zero, rtol=0, atol=1e-15)
        h = 1e-5
        for name in ("angle", "forward", "up"):
            moved = [
                JointAxis(
                    angle=angle + s * h * (name == "angle"),
                    forward=forward + s * h * (name == "forward"),
                    up=up + s * h * (name == "up"),
                ).joint
                for s in (1, -1)
            ]
            slope = here.slope(name)
            for what in ("angle", "factor", "bend"):
                above, below = (getattr(leg, what) for leg in moved)
                numeric = (above - below) / (2 * h)
                np.testing.assert_allclose(getattr(slope, what), numeric, rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(here.slope("angle").angle, here.joint.factor)
        np.testing.assert_allclose(here.slope("angle").factor, here.joint.bend, atol=1e-15)


def test_levels_of_a_session(inputs) -> None:
    levels = emg_levels([inputs, replace(inputs, emg=2 * inputs.emg)])
    effort = smooth_effort(inputs.emg.T, inputs.rate_hz).T
    both = np.concatenate([effort, 2 * effort])
    assert np.allclose(levels, np.percentile(both, 99, axis=0), rtol=1e-12)
    assert tuple(ModelOptions(emg_ref=levels).as_dict()["emg_ref"]) == levels
    assert ModelOptions.of(emg_ref=list(levels)) == ModelOptions(emg_ref=levels)


@pytest.mark.parametrize("levels", [(1.0, 2.0), (1.0, 2.0, 3.0, -1.0), "1234", (1, 2, 3, True)])
def test_levels_are_four_numbers(levels) -> None:
    with pytest.raises(InputError, match=r"^emg_ref is .*; give four levels in V, of TA, "):
        ModelOptions(emg_ref=levels)


def test_a_normalised_rest_is_a_part_of_one() -> None:
    spec = with_optional(MODELS["muscle"], ("emg_rest_ta",))
    in_volts, normalised = (adapted(spec.parameters, OPTIONS, unit) for unit in ("V", "1"))
    assert (in_volts["emg_rest_ta"].unit, normalised["emg_rest_ta"].unit) == ("V", "-")
    assert normalised["emg_rest_ta"].upper == 0.2
