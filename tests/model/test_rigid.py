"""Model 1.0: torque against references and an independent formulation, derivatives, structure."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from surae.model import ModelOptions, activation, get_model, rigid
from surae.model.muscle import MuscleSimulator
from surae.signals import ModelInputs

SPEC = get_model("muscle")
NAMES = list(SPEC.names)
ALL = range(len(NAMES))

HEALTHY = {
    "m": 2.0,
    "k_tri": 200.0,
    "k_tib": 110.0,
    "x0_tri": 0.018,
    "x0_tib": 0.055,
    "tau_rel": 2.0,
    "k_rel": 0.4,
    "g1": 0.6e6,
    "g2": 0.9e6,
    "g3": 1.3e6,
    "g4": 1.0e6,
    "l0_tri": 0.045,
    "l0_tib": 0.075,
    "f0": 2.0,
    "beta": 1.0,
}
LONGER = {
    "k_tri": 60.0,
    "k_tib": 70.0,
    "x0_tri": 0.030,
    "x0_tib": 0.075,
    "l0_tri": 0.080,
    "l0_tib": 0.105,
}
VIRTUAL_WORK = {"geometry": "virtual-work"}
CASES = {
    "healthy": ({}, {}, 256.0),
    "underdamped": ({"beta": 0.5, "f0": 4.0}, {}, 256.0),
    "overdamped, coarse": ({"beta": 2.5, "f0": 15.0, "tau_rel": 0.3}, {}, 50.0),
    "switches": ({"k_rel": 1.5}, {"vmax_factor": 10.0, "theta_foot": 0.5}, 125.0),
    "virtual work": (LONGER, VIRTUAL_WORK, 256.0),
    "virtual work, slow muscle": (
        LONGER,
        {**VIRTUAL_WORK, "vmax_factor": 5.0, "x_ref_tri": 0.085, "x_ref_tib": 0.095},
        125.0,
    ),
}
every_case = pytest.mark.parametrize("case", CASES)


def vector(**changes: float) -> np.ndarray:
    return SPEC.vector({**HEALTHY, **changes}, ModelOptions())


def rms(signal: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(signal))))


@pytest.fixture
def setup(case, make_inputs) -> tuple[ModelInputs, ModelOptions, np.ndarray]:
    changes, options, rate = CASES[case]
    return make_inputs(3, rate_hz=rate), ModelOptions.of(**options), vector(**changes)


def reference(folder: Path, name: str, every: int) -> tuple[ModelInputs, ModelOptions, np.ndarray]:
    case = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    table = np.loadtxt(folder / f"{name}.csv", delimiter=",", skiprows=1)[::every]
    time, angle = table[:, 0], table[:, 1]
    velocity = np.gradient(angle, time)
    inputs = ModelInputs(
        name=name,
        rate_hz=1 / (time[1] - time[0]),
        time=time,
        angle=angle,
        velocity=velocity,
        acceleration=np.gradient(velocity, time),
        emg=table[:, 3:7],
        emg_unit="V",
        torque=table[:, 2],
    )
    options = ModelOptions.of(**case["options"])
    return inputs, options, SPEC.vector(case["parameters"], options)


@pytest.mark.parametrize("every", [1, 2], ids=["256 Hz", "128 Hz"])
@pytest.mark.parametrize("name", ["muscle_healthy", "muscle_patient"])
def test_reference_solution(references, name, every) -> None:
    inputs, options, p = reference(references, name, every)
    assert inputs.torque is not None
    error = rms(MuscleSimulator(inputs, options).torque(p) - inputs.torque)
    assert error < 0.005 * rms(inputs.torque)


def textbook(inputs: ModelInputs, options: ModelOptions, p: np.ndarray) -> np.ndarray:
    """The torque written once more from the specification, filters by scipy."""
    q = dict(zip(NAMES, p, strict=True))
    t, th, dth = inputs.time, inputs.angle, inputs.velocity
    r = {"tri": 0.0480 - 0.0104 * th, "tib": 0.0393 + 0.0171 * th}
    if options.geometry == "thesis":
        x = {"tri": 0.118 - 1.67 * r["tri"], "tib": 0.136 - 1.56 * r["tib"]}
        dx = {"tri": 1.67 * 0.0104 * dth, "tib": -1.56 * 0.0171 * dth}
    else:
        x = {
            "tri": options.x_ref_tri + 0.0480 * th - 0.0052 * th**2,
            "tib": options.x_ref_tib - 0.0393 * th - 0.00855 * th**2,
        }
        dx = {"tri": r["tri"] * dth, "tib": -r["tib"] * dth}
    e1, e2, e3, e4 = inputs.emg.T
    force = {"tri": q["g2"] * e2 + q["g3"] * e3 + q["g4"] * e4, "tib": q["g1"] * e1}
    w, k = 2 * np.pi * q["f0"], q["k_rel"]
    activation = StateSpace([[0, 1], [-(w**2), -2 * q["beta"] * w]], [[0], [w**2]], [[1, 0]], [[0]])
    relaxation = StateSpace([[-(1 + k) / q["tau_rel"]]], [[k / q["tau_rel"]]], [[-1]], [[1]])
    torque = q["m"] * 0.15**2 * inputs.acceleration
    torque += q["m"] * 9.81 * 0.15 * np.cos(th - options.theta_foot)
    for muscle, sign in (("tri", 1), ("tib", -1)):
        alpha = lsim(activation, force[muscle], t)[1]
        elastic = np.exp(q[f"k_{muscle}"] * (x[muscle] - q[f"x0_{muscle}"]))
        passive = lsim(relaxation, elastic, t, X0=[k / (1 + k) * elastic[0]])[1]
        l0, v = q[f"l0_{muscle}"], dx[muscle]
        vmax = options.vmax_factor * l0
        fl = np.exp(-((x[muscle] - l0) ** 2) / (0.1 * l0**2))
        fv = np.where(
            v < 0,
            (v + vmax) / (vmax - np.minimum(v, 0) / 0.25),
            1 + 1.125 * 0.5 * v / (0.125 * vmax + np.maximum(v, 0)),
        )
        torque += sign * r[muscle] * (np.maximum(passive, 0) + fl * fv * alpha)
    return torque


@every_case
def test_torque_is_the_specification(setup) -> None:
    inputs, options, p = setup
    expected = textbook(inputs, options, p)
    error = MuscleSimulator(inputs, options).torque(p) - expected
    assert np.abs(error).max() < 1e-10 * rms(expected)


@every_case
def test_parts_add_up(setup) -> None:
    inputs, options, p = setup
    simulator = MuscleSimulator(inputs, options)
    parts = simulator.parts(p)
    torque = simulator.torque(p)
    assert parts.total == pytest.approx(torque, abs=1e-12 * rms(torque))
    four = ("tissue_Nm", "neural_Nm", "inertial_Nm", "gravitational_Nm")
    summed = sum(parts.columns()[name] for name in four)
    assert summed == pytest.approx(torque, abs=1e-12 * rms(torque))
    # the triceps pulls one way, the tibialis the other; each of them plays a part
    pairs = [(parts.tissue_tri, parts.tissue_tib)]
    if p[NAMES.index("beta")] >= 1:  # an underdamped activation swings below zero
        pairs.append((parts.neural_tri, parts.neural_tib))
    for positive, negative in pairs:
        assert positive.min() >= 0
        assert negative.max() <= 0
        assert positive.max() > 0.1
        assert negative.min() < -0.1


@every_case
def test_jacobian_against_richardson(setup) -> None:
    inputs, options, p = setup
    simulator = MuscleSimulator(inputs, options)
    for j, (name, exact) in enumerate(
        zip(NAMES, simulator.torque_jacobian(p, ALL)[1], strict=True)
    ):

        def central(h: float, j: int = j) -> np.ndarray:
            up, down = p.copy(), p.copy()
            up[j] += h
            down[j] -= h
            return (simulator.torque(up) - simulator.torque(down)) / (2 * h)

        h = 1e-3 * p[j]
        numeric = (4 * central(h) - central(2 * h)) / 3
        assert np.abs(exact).max() * p[j] > 0.01, name  # it matters here, in Nm
        assert np.abs(exact - numeric).max() < 1e-7 * np.abs(exact).max(), name


def held(angle: float, seconds: float, rate_hz: float = 256.0) -> ModelInputs:
    n = round(seconds * rate_hz)
    zero = np.zeros(n)
    return ModelInputs(
        name="held",
        rate_hz=rate_hz,
        time=np.arange(n) / rate_hz,
        angle=np.full(n, angle),
        velocity=zero,
        acceleration=zero,
        emg=np.zeros((n, 4)),
        emg_unit="V",
        torque=None,
    )


def released(rate_hz: float = 256.0) -> ModelInputs:
    """Two seconds at 0.5 rad, 0.15 s down to −0.7 rad, and held there."""
    inputs = held(0.5, 6.0, rate_hz)
    s = np.clip((inputs.time - 2.0) / 0.15, 0, 1)
    angle = 0.5 - 1.2 * s**2 * (3 - 2 * s)
    velocity = -1.2 * 6 * s * (1 - s) / 0.15
    acceleration = np.where((s > 0) & (s < 1), -1.2 * 6 * (1 - 2 * s) / 0.15**2, 0.0)
    return replace(inputs, angle=angle, velocity=velocity, acceleration=acceleration)


def test_tissue_does_not_push_when_shortened_after_a_long_stretch() -> None:
    simulator = MuscleSimulator(released(), ModelOptions())
    p = vector(k_rel=1.5, tau_rel=2.0)
    parts = simulator.parts(p)
    slack = parts.tissue_tri == 0.0
    after = slice(round(2.15 * 256) + 1, round(2.5 * 256))
    assert slack[after].all()  # equation (11) is at work
    assert 50 < slack.sum() < 1200  # until the relaxation has died out
    assert not slack[: 2 * 256].any()
    assert not slack[-1]
    columns = [NAMES.index(name) for name in ("k_tri", "x0_tri", "tau_rel", "k_rel")]
    torque, jacobian = simulator.torque_jacobian(p, columns)
    assert np.all(jacobian[:2, slack] == 0.0)
    # the relaxation is shared: the rows of tau_rel and k_rel keep what the tibialis gives
    alone = vector(k_rel=1.5, tau_rel=2.0, x0_tri=10.0)
    assert jacobian[2:, slack] == pytest.approx(
        simulator.torque_jacobian(alone, columns)[1][2:, slack], rel=1e-12
    )
    assert np.abs(jacobian[2:, slack]).max() > 0
    assert torque == pytest.approx(simulator.torque(p), abs=1e-12 * rms(torque))


def test_jacobian_with_the_clamp_active_against_differences() -> None:
    simulator = MuscleSimulator(released(), ModelOptions())
    p = vector(k_rel=1.5, tau_rel=2.0)
    exact = simulator.torque_jacobian(p, ALL)[1]
    for column in (NAMES.index(name) for name in ("k_tri", "x0_tri", "tau_rel", "k_rel")):
        h = 1e-5 * p[column]
        up, down = p.copy(), p.copy()
        up[column] += h
        down[column] -= h
        sides = [simulator.parts(q).tissue_tri == 0.0 for q in (up, down)]
        same = sides[0] == sides[1]  # samples that the step moves across the corner are left out
        assert same.mean() > 0.99
        numeric = (simulator.torque(up) - simulator.torque(down)) / (2 * h)
        error = np.abs(exact[column] - numeric)[same]
        assert error.max() < 1e-6 * np.abs(exact[column]).max()


def test_without_emg_there_is_no_neural_torque(make_inputs) -> None:
    inputs = replace(make_inputs(2), emg=np.zeros((1536, 4)))
    simulator = MuscleSimulator(inputs, ModelOptions())
    assert not simulator.parts(vector()).neural.any()
    active = ["g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta"]
    columns = [NAMES.index(name) for name in active]
    assert not simulator.torque_jacobian(vector(), columns)[1].any()


def test_at_rest_the_torque_is_passive_and_gravity_by_hand() -> None:
    torque = MuscleSimulator(held(0.0, 0.1), ModelOptions()).torque(vector())
    tri = 0.048 * np.exp(200 * (0.03784 - 0.018)) / 1.4
    tib = 0.0393 * np.exp(110 * (0.074692 - 0.055)) / 1.4
    assert torque == pytest.approx(np.full(26, tri - tib + 2 * 9.81 * 0.15), rel=1e-12)


def test_overflow_shows_in_the_torque_and_in_the_jacobian(make_inputs) -> None:
    simulator = MuscleSimulator(make_inputs(1), ModelOptions())
    p = vector(k_tri=1e5)
    assert not np.isfinite(simulator.torque(p)).any()
    torque, jacobian = simulator.torque_jacobian(p, [NAMES.index("k_tri")])
    assert not np.isfinite(torque).any()
    assert not np.isfinite(jacobian).any()


def test_read_only_and_strided_arrays_do_not_compile_again(make_inputs) -> None:
    inputs = make_inputs(1)
    p = vector()
    expected = MuscleSimulator(inputs, ModelOptions()).torque_jacobian(p, ALL)
    MuscleSimulator(inputs, ModelOptions()).parts(p)
    MuscleSimulator(inputs, ModelOptions()).torque(p)
    used = (
        rigid.rigid_torque,
        rigid.rigid_forces,
        activation._respond,
        activation._respond_with_derivatives,
    )
    before = [len(kernel.signatures) for kernel in used]
    emg = np.asfortranarray(inputs.emg)
    emg.flags.writeable = False
    strided = np.column_stack([p, p])[:, 0]
    strided.flags.writeable = False
    simulator = MuscleSimulator(replace(inputs, emg=emg), ModelOptions())
    torque, jacobian = simulator.torque_jacobian(strided, ALL)
    simulator.torque(strided)
    simulator.parts(strided)
    assert [len(kernel.signatures) for kernel in used] == before
    assert np.array_equal(torque, expected[0])
    assert np.array_equal(jacobian, expected[1])


def test_inputs_and_parameters_are_left_alone(make_inputs) -> None:
    inputs = make_inputs(1)
    copies = [inputs.angle.copy(), inputs.velocity.copy(), inputs.emg.copy()]
    p = vector()
    simulator = MuscleSimulator(inputs, ModelOptions())
    first = simulator.torque_jacobian(p, ALL)
    second = simulator.torque_jacobian(p, ALL)
    assert np.array_equal(first[1], second[1])
    assert np.array_equal(p, vector())
    for now, then in zip((inputs.angle, inputs.velocity, inputs.emg), copies, strict=True):
        assert np.array_equal(now, then)
