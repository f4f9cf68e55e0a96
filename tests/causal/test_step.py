"""A step beside the simulator: of the same signals both give the same torque, whatever is in."""

from dataclasses import replace

import numpy as np
import pytest
from made_signals import signals

from surae.base.errors import InputError
from surae.causal.kernel import ROWS, run
from surae.causal.layout import DOUBT
from surae.causal.numbers import angle_gains, check_supported, numbers_of
from surae.model import ModelOptions, get_model, with_optional
from surae.model.geometry_table import GeometryTable
from surae.model.tissue_curve import TissueCurve
from surae.signals import Preparation, SmoothEffort, inputs_as_given, prepare

RATE = 500.0
REFLEX = {"reflex_tri": 1500.0, "reflex_tib": 700.0, "reflex_delay": 0.047}
LABORATORY = {
    "emd": 0.0213,
    "emg_lag": 0.01,
    "emg_rest_ta": 1e-5,
    "emg_rest_gm": 2e-5,
    "xt_ta_gl": 0.1,
    "xt_sol_gm": 0.12,
    "release": 0.03,
    "angle_zero": 0.05,
    "axis_forward": 0.01,
    "axis_up": -0.012,
    "torque_zero": 1.2,
    "plate_inertia": 0.01,
    "plate_cos": 1.0,
    "plate_sin": -0.5,
    "joint_stiffness": 2.0,
    "joint_torque": 0.5,
    "joint_damping": 0.3,
    "arm_scale_tri": 0.1,
    "arm_slope_tri": 0.2,
    "arm_bend_tib": -0.3,
    "path_scale_tri": 0.1,
    "path_bend_tri": 0.002,
    "length_zero_tib": 0.003,
}
CURVED = {"emg_shape": -1.2, "emg_power": 0.2}
LEG = {
    "fl_short_tri": 0.2,
    "fl_long_tib": -0.1,
    "fv_curve": 0.1,
    "fv_speed": 0.1,
    "fv_stretch": -0.2,
    "bridge_stiffness": 30.0,
    "bridge_reach": 0.01,
    "reflex_length_tri": 3000.0,
    "reflex_force_tri": 0.3,
}
FAR = {"x0_tri": 0.07, "k_tri": 60.0, "l0_tri": 0.08, "x0_tib": 0.09, "l0_tib": 0.1}
LEVELS = (3e-4, 3e-4, 3e-4, 3e-4)
TISSUE = TissueCurve((-40.0, -10.0, 0.0, 30.0), (-3.0, 0.0, 1.0, 8.0), (0.3, 0.1), (0.2, 2.0))


def table() -> GeometryTable:
    """Lengths and arms by virtual work, as a table that the movement leaves."""
    angle = np.linspace(-0.6, 0.1, 9)
    tri = (0.048 - 0.0104 * angle, 0.048 * angle - 0.0052 * angle**2)
    tib = (-(0.0393 + 0.0171 * angle), -(0.0393 * angle + 0.00855 * angle**2))
    lengths = (tuple((tri[1] + 0.3).tolist()), tuple((tib[1] + 0.25).tolist()))
    arms = (tuple(tri[0].tolist()), tuple(tib[0].tolist()))
    return GeometryTable("made", tuple(angle.tolist()), lengths, arms)


CASES = {
    "muscle": ("muscle", {}, ModelOptions(), False),
    "muscle, late and with a reflex": ("muscle", {"emd": 0.0373, **REFLEX}, ModelOptions(), False),
    "muscle-tendon": ("muscle-tendon", {}, ModelOptions(), False),
    "all, envelopes add up": (
        "muscle-tendon-strain",
        LABORATORY | CURVED | LEG | REFLEX,
        ModelOptions(emg_ref=LEVELS, theta_foot=0.1),
        False,
    ),
    "all, powers add up": (
        "muscle-tendon-strain",
        LABORATORY | CURVED | LEG | REFLEX,
        ModelOptions(emg_ref=LEVELS),
        True,
    ),
    "virtual work and a tissue's curve": (
        "muscle-tendon-strain",
        LABORATORY | LEG | FAR,
        ModelOptions(geometry="virtual-work", tendon_strain="slack-length", tissue=TISSUE),
        True,
    ),
    "a table": ("muscle-tendon-toe", LABORATORY | FAR, ModelOptions(geometry=table()), False),
}


@pytest.mark.parametrize("case", CASES)
def test_a_step_gives_the_simulators_torque(case) -> None:
    model, given, options, own = CASES[case]
    spec = with_optional(get_model(model), given)
    values = {p.name: p.start for p in spec.parameters} | given
    angle, emg = signals()
    motion = (angle, 0.0 * angle, 0.0 * angle)
    time = np.arange(len(angle)) / RATE
    like = replace(inputs_as_given("made", RATE, time, motion, emg), own_envelopes=own)
    numbers = numbers_of(spec, options, values, like, RATE, None)
    state, late = numbers.state()
    out = np.zeros((ROWS, len(angle)))
    room = (late, np.zeros(2), np.zeros(DOUBT))
    run(
        numbers.record,
        numbers.path,
        (numbers.curve, numbers.relaxing),
        state,
        room,
        (angle, emg),
        out,
    )
    inputs = replace(
        like,
        angle=out[2],
        velocity=out[3],
        acceleration=out[4],
        emg=out[6:10].T.copy(),
        effort=SmoothEffort(out[14:18], out[10:14], out[18:22]),
    )
    simulator = spec.simulator(inputs, options, beyond=True)
    torque = simulator.torque(spec.vector(values, options))
    assert np.ptp(torque) > 5.0
    np.testing.assert_allclose(out[0], torque, rtol=0.0, atol=1e-9)


def test_the_angles_filter_has_no_delay_where_the_acceleration_stays() -> None:
    dt = 1e-3
    g, h, k = angle_gains(dt)
    t = dt * np.arange(400)
    true = 0.1 + 0.5 * t - 2.0 * t**2
    x, v, a = true[0], 0.0, 0.0
    for measured in true[1:]:
        x, v = x + dt * (v + 0.5 * dt * a), v + dt * a
        beyond = measured - x
        x, v, a = x + g * beyond, v + h * beyond, a + k * beyond
    np.testing.assert_allclose([x, v, a], [true[-1], 0.5 - 4.0 * t[-1], -4.0], atol=1e-6)


def test_raw_emg_becomes_an_envelope_of_the_same_size_as_without_causality() -> None:
    """Two passes forward have the gain of one forward and one back."""
    from surae import example
    from surae.model import MODELS

    recording = example()
    rate = recording.channels["emg_sol"].rate_hz
    ahead = prepare(recording)
    spec = MODELS["muscle"]
    values = {p.name: p.start for p in spec.parameters}
    numbers = numbers_of(spec, ModelOptions(), values, ahead, rate, Preparation())
    emg = np.stack([recording.channels[f"emg_{m}"].values for m in ("ta", "gl", "sol", "gm")], 1)
    state, late = numbers.state()
    out = np.zeros((ROWS, len(emg)))
    room = (late, np.zeros(2), np.zeros(DOUBT))
    angle = recording.channels["angle"].values.copy()
    run(
        numbers.record,
        numbers.path,
        (numbers.curve, numbers.relaxing),
        state,
        room,
        (angle, emg),
        out,
    )
    np.testing.assert_allclose(out[6:10].mean(axis=1), ahead.emg.mean(axis=0), rtol=0.01)


@pytest.mark.parametrize(
    ("model", "options", "words"),
    [
        ("muscle-2010", ModelOptions(), "has no causal predictor"),
        ("muscle-tendon", ModelOptions(integrator="explicit-euler"), "integrator explicit-euler"),
    ],
)
def test_other_models_are_refused_in_one_line(model, options, words) -> None:
    with pytest.raises(InputError, match=words):
        check_supported(get_model(model), options)
