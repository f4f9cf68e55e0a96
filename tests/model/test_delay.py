"""The electromechanical delay: exact between samples, smooth, and nothing where it is off."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.model import MODELS, ModelOptions, check_value, get_model, with_optional
from surae.model.activation import ActivationFilter, Drive
from surae.model.compliant_stage import GAMMA
from surae.model.parameters import COMPLIANT_ALONE, OPTIONAL, OPTIONAL_PARAMETERS

OPTIONS = ModelOptions()
DT = 1 / 128
F0, BETA = 2.3, 0.8
#: One of each class; those of compliant tendons differ in what is free (test_compliant.py).
DRIVEN = ("muscle", "muscle-tendon", "muscle-2010")
every_model = pytest.mark.parametrize("name", DRIVEN)


#: Rows of what `delayed` gives: the output, and its derivatives by delay, f0 and beta.
OUT, BY_DELAY, BY_F0, BY_BETA = 0, 1, 2, 3


def channels(n: int = 200, seed: int = 0, first: float | None = None) -> np.ndarray:
    emg = np.random.default_rng(seed).random((2, n))
    if first is not None:
        emg[:, 0] = first
    return emg


def delayed(inputs, f0, beta, dt, delay, lags) -> np.ndarray:
    """Output for each input, and its derivatives, shape (4, k, L, n)."""
    step = ActivationFilter(f0=f0, beta=beta, dt=dt, lags=lags, columns=(1, 2))
    active = [step.active_state([Drive(signal, delay=delay, delay_column=0)]) for signal in inputs]
    assert [state.columns.tolist() for state in active] == [[0, 1, 2]] * len(inputs)
    rows = [np.concatenate([state.alpha[None], state.slopes]) for state in active]
    return np.stack(rows, axis=1)


def output(inputs: np.ndarray, delay: float, *, dt: float = DT, lag: float = 0.0) -> np.ndarray:
    return delayed(inputs, F0, BETA, dt, delay, (lag,))[OUT, :, 0]


def driven(name: str, inputs, **values: float):
    """The model at its starts with drives, and its vector."""
    spec = with_optional(get_model(name), values)
    p = spec.vector({q.name: q.start for q in MODELS[name].parameters} | values, OPTIONS)
    return spec.simulator(inputs, OPTIONS), p


@pytest.mark.parametrize("sixteenths", [1, 5, 16, 27, 40])
@pytest.mark.parametrize("lag", [0.0, 0.7 * DT])
def test_between_samples_it_is_that_of_a_rate_at_which_it_falls_on_one(sixteenths, lag) -> None:
    emg = channels()
    n = emg.shape[1]
    fine_time = np.arange(16 * (n - 1) + 1) / 16
    fine = np.stack([np.interp(fine_time, np.arange(n), channel) for channel in emg])
    late = output(emg, sixteenths * DT / 16, lag=lag)
    exact = output(fine, sixteenths * DT / 16, dt=DT / 16, lag=lag)[:, ::16]
    np.testing.assert_allclose(late, exact, rtol=0, atol=1e-12)


def test_longer_than_the_recording_only_the_start_is_left() -> None:
    emg = channels(50, first=0.4)
    late = output(emg, 50.3 * DT)
    np.testing.assert_allclose(late, output(np.full((2, 50), 0.4), 0.0), rtol=0, atol=1e-14)


@pytest.mark.parametrize("delay", [0.0, 0.3 * DT, 3 * DT, 0.0777])
def test_derivatives_of_the_filter(delay) -> None:
    emg = channels()
    lags = ((1 - GAMMA) * DT, 0.0)
    rows = delayed(emg, F0, BETA, DT, delay, lags)
    for row, at in ((BY_DELAY, 3), (BY_F0, 0), (BY_BETA, 1)):
        given = [F0, BETA, DT, delay]
        step = 1e-6 * (given[at] or 0.01)
        sides = []
        for sign in (1, -1):
            moved = list(given)
            moved[at] = max(moved[at] + sign * step, 0.0)
            sides.append((moved[at], delayed(emg, *moved, lags)[OUT]))
        (above, late), (below, early) = sides
        slope = (late - early) / (above - below)
        size = np.abs(slope).max()
        np.testing.assert_allclose(rows[row], slope, rtol=0, atol=2e-5 * size)


def test_two_derivatives_by_the_delay_are_continuous_across_samples() -> None:
    emg = channels()
    around = 5 * DT
    near = 1e-7 * DT
    left, right = (delayed(emg, F0, BETA, DT, around + s, (0.0,))[:, :, 0] for s in (-near, near))
    size = np.abs(left).max(axis=(1, 2))
    assert np.abs(left - right).max(axis=(1, 2))[[OUT, BY_DELAY]] == pytest.approx(
        [0, 0], abs=1e-6 * size[BY_DELAY]
    )
    # The curvature on either side, from the exact first derivative over a thousandth of a sample;
    # EMG interpolated anew would have a kink, which is a jump in the first derivative already.
    far = 1e-3 * DT
    at = [delayed(emg, F0, BETA, DT, around + s * far, (0.0,))[BY_DELAY, :, 0] for s in (-1, 0, 1)]
    before, after = (at[1] - at[0]) / far, (at[2] - at[1]) / far
    assert np.abs(before - after).max() < 0.01 * np.abs(before).max()


def test_rounding_never_leaves_a_step_of_no_length() -> None:
    emg = channels()
    for rate in (125.0, 128.0, 256.0, 1000.0, 1234.5):
        for samples in range(1, 60):
            for nudge in (-1, 0, 1):
                delay = samples / rate
                delay = np.nextafter(delay, delay + nudge) if nudge else delay
                assert np.isfinite(output(emg, float(delay), dt=1 / rate)).all()


@every_model
def test_off_is_the_model_as_it_is(name, make_inputs) -> None:
    chosen = ModelOptions.of(geometry="virtual-work")
    inputs = make_inputs(1, rate_hz=128.0, seconds=3.0)
    spec = MODELS[name]
    off = with_optional(spec, {"emd", "reflex_tri"})
    starts = {q.name: q.start for q in spec.parameters}
    plain = spec.simulator(inputs, chosen)
    drives = off.simulator(inputs, chosen)
    p, q = spec.vector(starts, chosen), off.vector(starts, chosen)
    assert q[: len(p)].tolist() == p.tolist()
    assert q[len(p) :].tolist() == [0.0, 0.0, 0.0, 0.05]
    torque, rows = plain.torque_jacobian(p, range(len(p)))
    late, more = drives.torque_jacobian(q, range(len(q)))
    np.testing.assert_allclose(late, torque, rtol=0, atol=1e-10)
    np.testing.assert_allclose(drives.torque(q), torque, rtol=0, atol=1e-10)
    size = np.abs(rows).max(axis=1, keepdims=True) + 1e-300
    np.testing.assert_allclose(more[: len(p)] / size, rows / size, rtol=0, atol=1e-9)
    parts, same = plain.parts(p), drives.parts(q)
    assert parts.reflex is None
    assert not np.any(same.reflex)
    for column, values in parts.columns().items():
        np.testing.assert_allclose(same.columns()[column], values, rtol=0, atol=1e-10)


# Not that of 2010: its low-pass is not causal, and EMG recorded later ends earlier.
@pytest.mark.parametrize("name", DRIVEN[:2])
def test_a_delay_of_whole_samples_is_emg_recorded_later(name, make_inputs) -> None:
    inputs = make_inputs(3, rate_hz=128.0, seconds=3.0)
    late = np.concatenate([np.repeat(inputs.emg[:1], 6, axis=0), inputs.emg[:-6]])
    simulator, p = driven(name, inputs, emd=6 / 128)
    spec = MODELS[name]
    same = spec.simulator(replace(inputs, emg=late), OPTIONS)
    torque = same.torque(p[: len(spec.names)])
    np.testing.assert_allclose(simulator.torque(p), torque, rtol=0, atol=1e-9)
    if simulator.tendon(p) is not None:
        forces = (state.tendon_force for state in (simulator.tendon(p), same.tendon(p[:-1])))
        np.testing.assert_allclose(*forces, rtol=0, atol=1e-7)


def test_the_explicit_scheme_takes_it_too(make_inputs) -> None:
    inputs = make_inputs(1, rate_hz=1000.0, seconds=1.0)
    spec = with_optional(get_model("muscle-tendon"), ("emd",))
    options = ModelOptions(integrator="explicit-euler")
    p = spec.vector({q.name: q.start for q in spec.parameters} | {"emd": 0.03}, options)
    late = spec.simulator(inputs, options)
    implicit = spec.simulator(inputs, OPTIONS)
    error = late.torque(p)[200:] - implicit.torque(p)[200:]
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.sqrt(np.mean(late.torque(p) ** 2))
    p[-1] = 0.0
    row = late.torque_jacobian(p, [len(p) - 1])[1][0]
    exact = implicit.torque_jacobian(p, [len(p) - 1])[1][0]
    assert np.corrcoef(row[200:], exact[200:])[0, 1] > 0.99


@every_model
def test_drives_are_data_of_the_model(name) -> None:
    spec = MODELS[name]
    both = with_optional(spec, ("reflex_delay", "emd"))
    drives = (*OPTIONAL["emd"], *OPTIONAL["reflex"])
    assert both.optional == drives
    assert both.names == (*spec.names, *drives)
    assert both.free == spec.free
    assert with_optional(both, ("m",)) is both
    assert with_optional(with_optional(spec, ("emd",)), ("reflex_tib",)) == both
    assert pickle.loads(pickle.dumps(both)) == both
    added = ("reflex_tri", "reflex_tib") if spec.linear else ()
    assert both.linear == (*spec.linear, *added)
    assert with_optional(spec, ("emd",)).names == (*spec.names, "emd")
    everything = with_optional(spec, [group[0] for group in OPTIONAL.values()])
    alone = {n for group in COMPLIANT_ALONE for n in OPTIONAL[group]}
    own = [p for p in OPTIONAL_PARAMETERS if spec.parent or p.name not in alone]
    assert everything.parameters == (*spec.parameters, *own)
    linear = (*added, *(p.name for p in own if p.torque)) if spec.linear else ()
    assert not spec.linear or {"torque_zero", "joint_damping", "plate_inertia"} <= {*linear}
    assert everything.linear == (*spec.linear, *linear)


def test_every_drive_parameter_belongs_to_one_drive() -> None:
    members = [name for group in OPTIONAL.values() for name in group]
    assert [p.name for p in OPTIONAL_PARAMETERS] == members
    for p in OPTIONAL_PARAMETERS:
        assert p.lower <= p.start < p.upper
    for name in ("emd", "reflex_tri", "reflex_tib"):  # off
        assert next(p.start for p in OPTIONAL_PARAMETERS if p.name == name) == 0.0


def test_no_negative_delay() -> None:
    spec = with_optional(get_model("muscle"), ("emd",))
    with pytest.raises(InputError, match=r"^muscle: emd is -0.01 s; it must be zero or more$"):
        check_value(spec.parameters[-1], -0.01, spec)
