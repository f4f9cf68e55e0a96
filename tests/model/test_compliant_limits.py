"""Muscle-tendon model, implicit: it is always solved, and its limits are the ones physics asks."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from test_rigid import rms

from surae.model import ModelOptions, adapted, get_model
from surae.model.activation import ActivationFilter, Drive
from surae.model.contraction import force_length, force_velocity
from surae.model.equilibrium import TOLERANCE
from surae.model.muscle import MuscleSimulator
from surae.model.muscle_tendon import MuscleTendonSimulator
from surae.model.tendon import tendon_curve, tendon_force
from surae.signals import ModelInputs

G, L0, F0, BETA = 7, 11, 13, 14

SPEC = get_model("muscle-tendon")
NAMES = list(SPEC.names)
ALL = range(len(NAMES))
STARTS = {p.name: p.start for p in SPEC.parameters}


def vector(**changes: float) -> np.ndarray:
    return SPEC.vector({**STARTS, "k_tri": 200.0, "x0_tri": 0.018, **changes}, ModelOptions())


def residual(
    simulator: MuscleTendonSimulator, p: np.ndarray, inputs: ModelInputs, options: ModelOptions
) -> float:
    """Largest force the balance (25)(26) misses, beside the forces in it."""
    state = simulator.tendon(p)
    step = ActivationFilter(f0=p[F0], beta=p[BETA], dt=1 / inputs.rate_hz, lags=(0.0,))
    weighted = inputs.emg * p[G : G + 4]
    excitations = weighted[:, 1:].sum(axis=1), weighted[:, 0].copy()
    alpha = np.stack([step.active_state([Drive(signal)]).alpha[0] for signal in excitations])
    q = dict(zip(NAMES, p, strict=True))
    worst = 0.0
    for group, (muscle, slack) in enumerate((("tri", 0.415), ("tib", 0.216))):
        metres = 1.0 if options.tendon_strain == "thesis" else slack
        curve = tendon_curve(
            q[f"dlt_{muscle}"] * metres, *(q[f"{part}_{muscle}"] for part in ("pt", "kt", "fmax"))
        )
        l0 = p[L0 + group]
        for i in range(inputs.n):
            pull = tendon_force(state.elongation[group, i], curve)[0]
            x, speed = state.muscle_length[group, i], state.muscle_velocity[group, i]
            fv = force_velocity(speed, options.vmax_factor * l0)[0]
            active = max(alpha[group, i], 0.0) * force_length(x, l0)[0] * fv
            missing = pull - state.tissue_force[group, i] - active
            worst = max(worst, abs(missing) / (1.0 + pull + abs(active)))
    return worst


@pytest.mark.parametrize(
    "block", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in range(1, 8))]
)
def test_always_solved_anywhere_in_the_bounds(block, make_inputs) -> None:
    for seed in range(25 * block, 25 * block + 25):
        rng = np.random.default_rng(seed)
        options = ModelOptions(
            geometry=["thesis", "virtual-work"][seed % 2],
            tendon_strain=["thesis", "slack-length"][seed // 2 % 2],
        )
        table = adapted(SPEC.parameters, options).values()
        p = np.array([rng.uniform(q.lower, q.upper) for q in table])
        rate = rng.choice([64.0, 128.0, 256.0])
        inputs = make_inputs(seed, rate_hz=rate, emg_scale=rng.uniform(0, 1e-3), seconds=2.0)
        simulator = MuscleTendonSimulator(inputs, options)
        torque, jacobian = simulator.torque_jacobian(p, ALL)
        assert simulator.tendon(p).unsolved == (None, None), seed
        assert np.isfinite(torque).all(), seed
        assert np.isfinite(jacobian).all(), seed
        assert residual(simulator, p, inputs, options) <= TOLERANCE, seed


def test_passive_muscle_is_in_equilibrium_with_its_tendon(make_inputs) -> None:
    inputs = replace(make_inputs(2, rate_hz=128.0, seconds=3.0), emg=np.zeros((384, 4)))
    p = vector(k_rel=0.0)
    state = MuscleTendonSimulator(inputs, ModelOptions()).tendon(p)
    curve = tendon_curve(0.04, 0.3, 4.0, 8000.0)
    rigid = 0.118 - 1.67 * (0.0480 - 0.0104 * inputs.angle)
    expected = [
        brentq(
            lambda e, r=r: tendon_force(e, curve)[0] - np.exp(200 * (r - e - 0.018)),
            0,
            0.1,
            xtol=1e-16,
        )
        for r in rigid
    ]
    assert state.elongation[0] == pytest.approx(expected, rel=1e-9)


def test_without_activity_nothing_oscillates(make_inputs) -> None:
    inputs = make_inputs(2, seconds=4.0)
    ramp = 0.6 * np.clip((inputs.time - 0.5) / 3.0, 0, 1)
    speed = np.where((ramp > 0) & (ramp < 0.6), 0.2, 0.0)
    zero = np.zeros(inputs.n)
    inputs = replace(inputs, angle=ramp - 0.3, velocity=speed, acceleration=zero)
    for scale in (0.0, 1e-9, 1e-4, 1.0):  # from none to full activity, switched on at 2 s
        emg = np.outer((inputs.time > 2.0) * scale * 6e-4, np.ones(4))
        simulator = MuscleTendonSimulator(replace(inputs, emg=emg), ModelOptions())
        state = simulator.tendon(vector())
        before = (inputs.time > 0.6) & (inputs.time < 1.9)
        # stretched at a constant speed: the muscle's speed changes slowly and in one direction
        change = np.diff(state.muscle_velocity[0, before])
        assert state.muscle_velocity[0, before].min() > 0
        assert np.abs(change).max() < 1e-3 * state.muscle_velocity[0, before].max() + 1e-6
        assert np.all(change <= 1e-9) or np.all(change >= -1e-9)
        assert np.isfinite(simulator.torque_jacobian(vector(), ALL)[1]).all()


def test_both_slack_after_a_fast_release() -> None:
    n, rate = 1024, 256.0
    time = np.arange(n) / rate
    s = np.clip((time - 2.0) / 0.15, 0, 1)
    inputs = ModelInputs(
        name="released",
        rate_hz=rate,
        time=time,
        angle=0.5 - 1.2 * s**2 * (3 - 2 * s),
        velocity=-7.2 * s * (1 - s) / 0.15,
        acceleration=np.zeros(n),
        emg=np.zeros((n, 4)),
        emg_unit="V",
        torque=None,
    )
    simulator = MuscleTendonSimulator(inputs, ModelOptions())
    p = vector(k_rel=1.5)
    state = simulator.tendon(p)
    slack = state.tendon_force[0] < 1e-9
    assert 50 < slack.sum() < 500
    assert state.elongation[0, slack] == pytest.approx(0.0, abs=1e-12)
    jacobian = simulator.torque_jacobian(p, [NAMES.index("k_tri"), NAMES.index("dlt_tri")])[1]
    assert np.abs(jacobian[:, slack]).max() < 1e-9
    assert np.isfinite(jacobian).all()


def test_a_stiff_tendon_is_model_1(make_inputs) -> None:
    def distance(dlt: float, rate: float) -> float:
        inputs = make_inputs(1, rate_hz=rate, seconds=3.0)
        rigid = MuscleSimulator(inputs, ModelOptions()).torque(vector()[:15])
        p = vector(dlt_tri=dlt, dlt_tib=dlt)
        return rms(MuscleTendonSimulator(inputs, ModelOptions()).torque(p) - rigid) / rms(rigid)

    ever_stiffer = [distance(dlt, 8192.0) for dlt in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)]
    assert ever_stiffer == sorted(ever_stiffer, reverse=True)
    assert ever_stiffer[-1] < 1e-4
    # the muscle has the unit's own speed, not a difference of lengths: few samples do as well
    assert distance(1e-6, 64.0) < 1e-3


def test_an_underdamped_filter_does_not_make_a_muscle_push(make_inputs) -> None:
    inputs = make_inputs(1)
    emg = inputs.emg * (inputs.time[:, None] < 3.0)
    simulator = MuscleTendonSimulator(replace(inputs, emg=emg), ModelOptions())
    state = simulator.tendon(vector(beta=0.2))
    assert state.unsolved == (None, None)
    assert state.tendon_force.min() > 0
    assert np.isfinite(simulator.torque_jacobian(vector(beta=0.2), ALL)[1]).all()


def test_a_sample_that_cannot_be_solved_is_named(make_inputs) -> None:
    inputs = make_inputs(1)
    angle = inputs.angle.copy()
    angle[500] = np.nan
    simulator = MuscleTendonSimulator(replace(inputs, angle=angle), ModelOptions())
    state = simulator.tendon(vector())
    assert state.unsolved == (500, 500)
    assert np.isfinite(simulator.torque(vector())[:500]).all()
    assert np.isnan(simulator.torque(vector())[500:]).all()
