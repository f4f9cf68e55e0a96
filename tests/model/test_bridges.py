"""Short-range stiffness: bridges hold a muscle, and yield; reflexes answer length and force."""

import numpy as np
import pytest
from test_reflex import ramp

from surae.model import ModelOptions, get_model, with_optional
from surae.model.contraction import bridge_strain
from surae.model.parameters import OPTIONAL
from surae.recording import MUSCLES

SPEC = get_model("muscle-tendon-strain")
BRIDGES = {"bridge_stiffness": 23.0, "bridge_reach": 0.01}


def tied(inputs, **values: float):
    spec = with_optional(SPEC, values)
    starts = {p.name: p.start for p in SPEC.parameters}
    options = ModelOptions()
    return spec.simulator(inputs, options), spec.vector(starts | values, options)


def test_the_strain_follows_its_equation_and_never_leaves_its_reach() -> None:
    """ds/dx = 1 − sgn(dx)·s/ρ, in many small steps."""
    reach, draw = 4e-4, np.random.default_rng(1)
    exact = fine = 0.0
    for moved in draw.uniform(-1.5, 1.5, 40) * reach:
        exact = bridge_strain(moved, exact, reach)[0]
        for _ in range(400):
            step = moved / 400
            fine += step * (1.0 - np.sign(step) * fine / reach)
        assert abs(exact) <= reach
        assert exact == pytest.approx(fine, abs=5e-3 * reach)
    assert bridge_strain(1.0, -reach, reach)[0] == reach
    assert bridge_strain(0.0, 1e-4, reach)[:3] == pytest.approx((1e-4, 1.25, 1.0))


@pytest.mark.parametrize("moved", [3e-4, -1e-4, 1e-6])
def test_derivatives_of_the_strain(moved) -> None:
    at = np.array([moved, 1.5e-4, 4e-4])
    for j, exact in enumerate(bridge_strain(*at)[1:]):
        h = np.zeros(3)
        h[j] = 1e-9
        numeric = (bridge_strain(*(at + h))[0] - bridge_strain(*(at - h))[0]) / 2e-9
        assert exact == pytest.approx(numeric, rel=1e-5)


def test_without_stiffness_it_is_the_model_as_it_is(make_inputs) -> None:
    inputs = make_inputs(3, rate_hz=128.0, seconds=3.0)
    plain, p = tied(inputs)
    none, q = tied(inputs, bridge_stiffness=0.0, bridge_reach=0.01)
    assert np.array_equal(plain.torque(p), none.torque(q))


def test_what_they_add_is_their_reach_times_their_stiffness_at_most(make_inputs) -> None:
    """F = α·f_l·(f_v + K·s/l0): K·ρ/l0 of the isometric force at most."""
    inputs = make_inputs(3, rate_hz=512.0, seconds=3.0)
    stiff = {"dlt_tri": 1e-5, "dlt_tib": 1e-5}
    held, p = tied(inputs, **BRIDGES, **stiff)
    free, q = tied(inputs, **stiff)
    state = free.tendon(q)
    more = held.tendon(p).tendon_force[0] - state.tendon_force[0]
    l0 = SPEC.parameters[SPEC.names.index("l0_tri")].start
    isometric = free.split(q)[2][0] * np.exp(-(((state.muscle_length[0] - l0) / l0) ** 2) / 0.1)
    share = np.divide(more, isometric, out=np.zeros_like(more), where=isometric > 1.0)
    assert np.abs(share).max() == pytest.approx(23.0 * 0.01, rel=0.02)


def test_gains_of_the_drives_move_the_torque_as_told(make_inputs) -> None:
    inputs = make_inputs(3, rate_hz=128.0, seconds=3.0)
    simulator, p = tied(inputs, **BRIDGES)
    response = simulator.tangent(p, [0]).response
    hat = np.maximum(1.0 - np.abs(np.arange(25) - 12) / 12.0, 0.0)
    for first, muscle in ((60, MUSCLES.index("sol")), (150, 0)):
        told = response.columns(muscle, hat[None], np.array([first]), inputs.n - first)[0]
        gain = np.zeros((4, inputs.n))
        gain[muscle, first : first + 25] = 1e-5 * hat
        either = []
        for sign in (1.0, -1.0):
            simulator.with_log_gain(sign * gain)
            either.append(simulator.torque(p)[first:])
        simulator.with_log_gain(None)
        numeric = (either[0] - either[1]) / 2e-5
        assert np.quantile(np.abs(told - numeric), 0.97) < 1e-4 * np.abs(numeric).max()


def test_a_finer_clock_tells_the_same(make_inputs) -> None:
    from test_compliant import sampled

    coarse = make_inputs(5, rate_hz=64.0)
    torque = []
    for factor in (1, 2, 8):
        simulator, p = tied(sampled(coarse, 64.0 * factor), **BRIDGES)
        torque.append(simulator.torque(p)[::factor])
    first, second = (np.std(each - torque[2]) / np.std(torque[2]) for each in torque[:2])
    assert second < 0.01
    assert second < 0.6 * first


@pytest.mark.parametrize("law", ["reflex_length", "reflex_force"])
def test_a_held_stretch_is_answered_after_the_delay_while_it_lasts(law) -> None:
    inputs = ramp(3.0)
    gains = {f"{law}_tri": {"reflex_length": 2e4, "reflex_force": 0.3}[law]}
    simulator, p = tied(inputs, **gains, **dict.fromkeys(OPTIONAL[law][1:], 0.0))
    reflex = simulator.parts(p).reflex_tri
    assert reflex is not None
    held = inputs.time > 1.7
    assert reflex[held].min() > 1.0
    assert np.ptp(reflex[held]) < 0.1 * reflex[held].max()
    assert reflex[inputs.time < 0.55].max() < 0.6 * reflex[held].max()
