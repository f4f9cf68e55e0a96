"""The reflex: stretch velocity, rectified and delayed, drives the muscle that is stretched."""

from dataclasses import replace

import numpy as np
import pytest

from surae.model import MODELS, ModelOptions, TorqueParts, get_model, with_optional
from surae.model.geometry import paths
from surae.signals import ModelInputs

OPTIONS = ModelOptions()
GAINS = {"reflex_tri": 6e3, "reflex_tib": 3e3, "reflex_delay": 0.0637}
#: One of each class; those of compliant tendons differ in what is free (test_compliant.py).
DRIVEN = ("muscle", "muscle-tendon", "muscle-2010")
every_model = pytest.mark.parametrize("name", DRIVEN)
EXACT = [name for name in DRIVEN if MODELS[name].parent is None]


def ramp(speed: float, *, start: float = 0.5, rate_hz: float = 256.0) -> ModelInputs:
    """A stretch of 0.6 rad at `speed` [rad/s] from rest at `start` [s], without EMG."""
    time = np.arange(round(2.0 * rate_hz)) / rate_hz
    angle = np.clip(speed * (time - start), -0.6, 0.6) * (time > start)
    moving = (time > start) & (np.abs(angle) < 0.6)
    return ModelInputs(
        name="ramp",
        rate_hz=rate_hz,
        time=time,
        angle=angle,
        velocity=np.where(moving, speed, 0.0),
        acceleration=np.zeros_like(time),
        emg=np.zeros((len(time), 4)),
        emg_unit="V",
        torque=None,
    )


def tied(name: str, inputs: ModelInputs, options: ModelOptions = OPTIONS, **values: float):
    spec = with_optional(get_model(name), GAINS)
    starts = {p.name: p.start for p in MODELS[name].parameters}
    return spec.simulator(inputs, options), spec.vector(starts | GAINS | values, options)


def parts_of(name: str, inputs: ModelInputs) -> TorqueParts:
    simulator, p = tied(name, inputs)
    return simulator.parts(p)


@every_model
def test_it_waits_for_the_delay(name) -> None:
    inputs = ramp(3.0)
    simulator, p = tied(name, inputs, reflex_tib=0.0)
    parts = simulator.parts(p)
    assert parts.reflex_tri is not None
    # Between the last sample at rest and the first of the ramp the velocity is linear.
    begin = 0.5 + GAINS["reflex_delay"]
    assert not parts.reflex_tri[inputs.time <= begin].any()
    assert (parts.reflex_tri[(inputs.time > begin + 0.01) & (inputs.time < begin + 0.3)] > 0).all()


@every_model
@pytest.mark.parametrize(("speed", "stretched"), [(3.0, "tri"), (-3.0, "tib")])
def test_only_the_muscle_that_lengthens_answers(name, speed, stretched) -> None:
    parts = parts_of(name, ramp(speed))
    answers = {"tri": parts.reflex_tri, "tib": parts.reflex_tib}
    sign = 1 if stretched == "tri" else -1
    assert (sign * answers.pop(stretched)).max() > 0.5
    (other,) = answers.values()
    assert not other.any()


@every_model
def test_it_grows_with_the_speed_of_the_stretch(name) -> None:
    peaks = [parts_of(name, ramp(speed)).reflex_tri.max() for speed in (0.5, 1.5, 3.0)]
    assert peaks[0] < peaks[1] < peaks[2]


@every_model
def test_parts_add_up_and_the_reflex_is_one_of_the_neural_ones(name, make_inputs) -> None:
    inputs = make_inputs(5, rate_hz=128.0, seconds=3.0)
    simulator, p = tied(name, inputs)
    parts = simulator.parts(p)
    np.testing.assert_allclose(parts.total, simulator.torque(p), rtol=0, atol=1e-10)
    assert (parts.reflex_tri >= 0).all()
    assert (parts.reflex_tri <= parts.neural_tri + 1e-12).all()
    assert (parts.reflex_tib <= 0).all()
    assert (parts.reflex_tib >= parts.neural_tib - 1e-12).all()
    columns = parts.columns()
    assert list(columns)[-3:] == ["reflex_Nm", "reflex_tri_Nm", "reflex_tib_Nm"]
    np.testing.assert_array_equal(columns["reflex_Nm"], parts.reflex_tri + parts.reflex_tib)
    # Without EMG all that is neural is the reflex.
    silent = replace(inputs, emg=np.zeros_like(inputs.emg))
    parts = parts_of(name, silent)
    np.testing.assert_allclose(parts.neural, parts.reflex, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", EXACT)
def test_on_rigid_tendons_it_is_what_the_gain_adds(name, make_inputs) -> None:
    inputs = make_inputs(5, rate_hz=128.0, seconds=3.0)
    simulator, p = tied(name, inputs)
    _, off = tied(name, inputs, reflex_tri=0.0, reflex_tib=0.0)
    added = simulator.torque(p) - simulator.torque(off)
    np.testing.assert_allclose(simulator.parts(p).reflex, added, rtol=0, atol=1e-10)
    names = with_optional(MODELS[name], GAINS).names
    columns = [names.index(name) for name in ("reflex_tri", "reflex_tib")]
    _, rows = simulator.torque_jacobian(off, columns)
    gains = np.array([GAINS["reflex_tri"], GAINS["reflex_tib"]])
    np.testing.assert_allclose(gains @ rows, added, rtol=0, atol=1e-10)


def test_the_stretch_is_that_of_the_whole_unit(make_inputs) -> None:
    # An EMG that is the rectified velocity of the unit, late by whole samples, is the reflex.
    inputs = make_inputs(6, rate_hz=128.0, seconds=3.0)
    tri, tib = paths(angle=inputs.angle, velocity=inputs.velocity, options=OPTIONS)
    late = 8
    emg = np.zeros((inputs.n, 4))
    for channel, path in ((0, tib), (2, tri)):
        stretch = np.maximum(path.speed, 0.0)
        emg[:, channel] = np.concatenate([np.repeat(stretch[:1], late), stretch[:-late]])
    for name in DRIVEN:
        if name == "muscle-2010":  # which integrates EMG, and not the reflex
            continue
        spec = MODELS[name]
        silent = replace(inputs, emg=np.zeros_like(emg))
        reflex, p = tied(name, silent, reflex_delay=late / 128)
        weights = {"g1": GAINS["reflex_tib"], "g2": 0.0, "g3": GAINS["reflex_tri"], "g4": 0.0}
        same = spec.vector({q.name: q.start for q in spec.parameters} | weights, OPTIONS)
        torque = spec.simulator(replace(inputs, emg=emg), OPTIONS).torque(same)
        np.testing.assert_allclose(reflex.torque(p), torque, rtol=0, atol=1e-9)


def test_a_gain_of_zero_has_a_slope_and_its_delay_none(make_inputs) -> None:
    inputs = make_inputs(4, rate_hz=128.0, seconds=3.0)
    simulator, p = tied("muscle-tendon", inputs, reflex_tri=0.0, reflex_tib=0.0)
    spec = with_optional(MODELS["muscle-tendon"], GAINS)
    columns = [spec.names.index(name) for name in spec.optional]
    gain_tri, gain_tib, delay = simulator.torque_jacobian(p, columns)[1]
    assert gain_tri.max() > 0 > gain_tib.min()
    assert not delay.any()
