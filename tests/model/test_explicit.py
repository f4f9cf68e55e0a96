"""The thesis's explicit scheme: the inverse of (17), convergence, clamps and chatter."""

from dataclasses import replace

import numpy as np
import pytest
from test_rigid import rms

from surae.model import ModelOptions, get_model
from surae.model.contraction import force_velocity
from surae.model.euler import speed_of
from surae.model.explicit import ThesisSimulator
from surae.model.integrators import muscle_tendon_simulator
from surae.model.muscle_tendon import MuscleTendonSimulator

SPEC = get_model("muscle-tendon")
NAMES = list(SPEC.names)
THESIS = ModelOptions(integrator="explicit-euler")
STARTS = {p.name: p.start for p in SPEC.parameters}
P = SPEC.vector({**STARTS, "k_tri": 200.0, "x0_tri": 0.018}, THESIS)
VMAX = 8 * P[[NAMES.index("l0_tri"), NAMES.index("l0_tib")]]


@pytest.mark.parametrize("speed", [-0.359, -0.2, -1e-6, 0.0, 1e-6, 0.1, 0.359])
def test_speed_is_the_inverse_of_force_velocity(speed) -> None:
    assert speed_of(force_velocity(speed, 0.36)[0], 0.36) == pytest.approx(speed, abs=1e-12)


def test_speed_is_clamped() -> None:
    assert speed_of(1.5, 0.36) == pytest.approx(0.36)
    assert speed_of(1.0, 0.36) == 0.0
    for factor in (1.5001, 2.0, 1e300, np.inf):  # α → 0 with a force left over
        assert speed_of(factor, 0.36) == 0.36
    for factor in (0.0, -0.2, -0.25, -3.0, -np.inf):
        assert speed_of(factor, 0.36) == -0.36
    assert speed_of(np.nan, 0.36) == 0.0  # 0/0: no active state and no force left over


def test_it_is_chosen_by_the_option(make_inputs) -> None:
    inputs = make_inputs(1)
    assert isinstance(muscle_tendon_simulator(inputs, THESIS), ThesisSimulator)
    assert not isinstance(muscle_tendon_simulator(inputs, ModelOptions()), ThesisSimulator)


@pytest.mark.parametrize("strain", ["thesis", "slack-length"])
def test_both_integrators_solve_the_same_equations(make_inputs, strain) -> None:
    options = replace(THESIS, tendon_strain=strain)
    p = SPEC.vector({name: STARTS[name] for name in SPEC.free}, options)
    errors = []
    for rate in (128.0, 1024.0, 32768.0):
        inputs = make_inputs(1, rate_hz=rate, seconds=4.0)
        explicit = ThesisSimulator(inputs, options).torque(p)
        implicit = MuscleTendonSimulator(inputs, options).torque(p)
        errors.append(rms(explicit - implicit) / rms(implicit))
    assert errors[0] > 0.01  # too coarse for the scheme, as the thesis found
    assert 0.001 < errors[1] < errors[0]
    assert errors[2] < 5e-4


def test_a_hardly_active_muscle_chatters_between_the_clamps(make_inputs) -> None:
    inputs = make_inputs(1, rate_hz=128.0)
    quiet = replace(inputs, emg=1e-3 * inputs.emg)
    clamped, reversals = [], []
    for signals in (quiet, inputs):
        state = muscle_tendon_simulator(signals, THESIS).tendon(P)
        assert state.unsolved == (None, None)
        speed = state.muscle_velocity / VMAX[:, None]
        assert np.abs(speed).max() <= 1 + 1e-12
        clamped.append(np.mean(np.abs(speed) > 0.999))
        reversals.append(np.mean(speed[:, 1:] * speed[:, :-1] < 0))
    assert clamped[0] > 0.5
    assert reversals[0] > 0.3
    implicit = MuscleTendonSimulator(quiet, ModelOptions()).tendon(P).muscle_velocity
    assert np.mean(implicit[:, 1:] * implicit[:, :-1] < 0) < 0.05


def test_it_keeps_to_the_iteration_of_the_thesis(make_inputs) -> None:
    inputs = make_inputs(1, rate_hz=1024.0)
    state = ThesisSimulator(inputs, THESIS).tendon(P)
    x, dt = state.muscle_length, 1 / 1024
    assert x[:, 1:] == pytest.approx(x[:, :-1] + dt * state.muscle_velocity[:, :-1])  # (28)
    lmt = 0.415 + 0.118 - 1.67 * (0.0480 - 0.0104 * inputs.angle)
    assert state.tendon_length[0] == pytest.approx(lmt - x[0])  # (22)
    assert state.active_force == pytest.approx(state.tendon_force - state.tissue_force)  # (25)


def test_derivatives_are_those_of_the_model_at_a_high_rate(make_inputs) -> None:
    inputs = make_inputs(1, rate_hz=16384.0, seconds=2.0)
    columns = [NAMES.index(name) for name in ("m", "g3", "l0_tri", "dlt_tri")]
    simulator = ThesisSimulator(inputs, THESIS)
    torque, numeric = simulator.torque_jacobian(P, columns)
    exact = MuscleTendonSimulator(inputs, ModelOptions()).torque_jacobian(P, columns)[1]
    assert np.array_equal(torque, simulator.torque(P))
    settled = slice(8192, None)  # from rest, the active state is too small for the scheme
    for ours, theirs in zip(numeric[:, settled], exact[:, settled], strict=True):
        assert rms(ours - theirs) < 0.01 * rms(theirs)
