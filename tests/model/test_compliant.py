"""Muscle-tendon model, implicit: references, accuracy, sensitivities, structure."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from test_rigid import HEALTHY as RIGID
from test_rigid import LONGER, rms

from surae.model import ModelOptions, adapted, get_model
from surae.model.muscle_tendon import MuscleTendonSimulator
from surae.signals import ModelInputs

SPEC = get_model("muscle-tendon")
NAMES = list(SPEC.names)
ALL = range(len(NAMES))
HEALTHY = {**RIGID, "x0_tib": 0.065}
SLACK_LENGTH = {"tendon_strain": "slack-length"}
CASES = {
    "thesis": ({}, {}, 256.0),
    "slack length": ({}, SLACK_LENGTH, 128.0),
    "virtual work": (LONGER, {"geometry": "virtual-work"}, 256.0),
    "both": (
        {**LONGER, "k_rel": 1.5, "beta": 0.7, "kt_tri": 2.0, "pt_tib": 0.1},
        {**SLACK_LENGTH, "geometry": "virtual-work", "vmax_factor": 10.0, "theta_foot": 0.3},
        125.0,
    ),
}
SEED = 4
every_case = pytest.mark.parametrize("case", CASES)


def vector(options: ModelOptions | None = None, **changes: float) -> np.ndarray:
    return SPEC.vector({**HEALTHY, **changes}, options or ModelOptions())


@pytest.fixture
def setup(case, make_inputs) -> tuple[MuscleTendonSimulator, np.ndarray, ModelInputs]:
    changes, given, rate = CASES[case]
    options = ModelOptions.of(**given)
    inputs = make_inputs(SEED, rate_hz=rate)
    return MuscleTendonSimulator(inputs, options), vector(options, **changes), inputs


def sampled(inputs: ModelInputs, rate_hz: float, emg: np.ndarray | None = None) -> ModelInputs:
    """The same movement at another rate: angle by quintic spline, EMG linear."""
    start, end = inputs.time[[0, -1]]
    t = start + np.arange(int((end - start) * rate_hz + 1e-6) + 1) / rate_hz
    angle = make_interp_spline(inputs.time, inputs.angle, k=5)
    emg = inputs.emg if emg is None else emg
    return replace(
        inputs,
        rate_hz=rate_hz,
        time=t,
        angle=angle(t),
        velocity=angle.derivative(1)(t),
        acceleration=angle.derivative(2)(t),
        torque=None,
        emg=np.column_stack([np.interp(t, inputs.time, channel) for channel in emg.T]),
    )


def reference(folder: Path, name: str) -> tuple[ModelInputs, ModelOptions, np.ndarray]:
    case = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    table = np.loadtxt(folder / f"{name}.csv", delimiter=",", skiprows=1)
    time, zero = table[:, 0], np.zeros(len(table))
    recorded = ModelInputs(
        name=name,
        rate_hz=1 / (time[1] - time[0]),
        time=time,
        angle=table[:, 1],
        velocity=zero,
        acceleration=zero,
        emg=table[:, 3:7],
        emg_unit="V",
        torque=None,
    )
    options = ModelOptions.of(**case["options"])
    p = SPEC.vector(case["parameters"], options)
    inputs = replace(sampled(recorded, recorded.rate_hz), torque=table[:, 2])
    return inputs, options, p


@pytest.mark.parametrize("name", ["tendon_thesis", "tendon_slack_length"])
def test_reference_solution(references, name) -> None:
    inputs, options, p = reference(references, name)
    assert inputs.torque is not None
    size = rms(inputs.torque)
    error = MuscleTendonSimulator(inputs, options).torque(p) - inputs.torque
    assert rms(error) < 0.001 * size
    # At 128 Hz each EMG sample is the mean of its surroundings: of this EMG, every second sample
    # alone would alias 0.25 % into the torque, however exact the integration.
    smooth = inputs.emg.copy()
    smooth[1:-1] = (inputs.emg[:-2] + 2 * inputs.emg[1:-1] + inputs.emg[2:]) / 4
    coarse = sampled(inputs, 128.0, smooth)
    error = MuscleTendonSimulator(coarse, options).torque(p) - inputs.torque[::2]
    assert rms(error) < 0.001 * size


@every_case
def test_second_order_and_accurate(case, make_inputs) -> None:
    changes, given, _ = CASES[case]
    options = ModelOptions.of(**given)
    p = vector(options, **changes)
    coarse = make_inputs(5, rate_hz=64.0)

    def torque(factor: int) -> np.ndarray:
        inputs = sampled(coarse, 64.0 * factor)
        return MuscleTendonSimulator(inputs, options).torque(p)[::factor]

    fine = torque(64)
    errors = [rms(torque(factor) - fine) / rms(fine) for factor in (1, 2, 4, 8)]
    assert errors[1] < 5e-4  # 128 Hz
    assert errors[2] < 1.5e-4  # 256 Hz
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders.min() > 1.7


@every_case
def test_jacobian_against_richardson(setup) -> None:
    simulator, p, _ = setup
    for j, (name, exact) in enumerate(
        zip(NAMES, simulator.torque_jacobian(p, ALL)[1], strict=True)
    ):

        def central(h: float, j: int = j) -> np.ndarray:
            up, down = p.copy(), p.copy()
            up[j] += h
            down[j] -= h
            return (simulator.torque(up) - simulator.torque(down)) / (up[j] - down[j])

        errors = []
        for relative in (1e-4, 2e-5, 4e-6):  # one of them moves no sample across the corner of (17)
            h = relative * p[j]
            numeric = (4 * central(h) - central(2 * h)) / 3
            errors.append(rms(exact - numeric) / rms(exact))
        assert rms(exact) * p[j] > 1e-3, name  # the parameter matters here, in Nm
        assert min(errors) < 1e-6, name


@every_case
def test_columns_parts_and_states_are_of_one_solution(setup) -> None:
    simulator, p, inputs = setup
    torque, everything = simulator.torque_jacobian(p, ALL)
    assert np.array_equal(torque, simulator.torque(p))
    chosen = simulator.torque_jacobian(p, [16, 0, 4, 13])[1]
    assert chosen == pytest.approx(everything[[16, 0, 4, 13]], rel=1e-12, abs=1e-12)
    assert simulator.torque_jacobian(p, [])[1].shape == (0, inputs.n)
    parts, state = simulator.parts(p), simulator.tendon(p)
    assert parts.total == pytest.approx(torque, abs=1e-12 * rms(torque))
    arms = 0.0480 - 0.0104 * inputs.angle, -(0.0393 + 0.0171 * inputs.angle)
    pulled = [parts.tissue_tri + parts.neural_tri, parts.tissue_tib + parts.neural_tib]
    for group in range(2):
        assert pulled[group] == pytest.approx(arms[group] * state.tendon_force[group], abs=1e-9)
    assert state.unsolved == (None, None)
    assert state.tendon_length - state.elongation == pytest.approx(
        np.repeat([[0.415], [0.216]], inputs.n, axis=1)
    )


def test_2_0_2_1_and_2_2_are_one_model_with_other_parameters_free() -> None:
    strain, toe = get_model("muscle-tendon-strain"), get_model("muscle-tendon-toe")
    tendon = ["dlt_tri", "dlt_tib", "pt_tri", "pt_tib", "kt_tri", "kt_tib", "fmax_tri", "fmax_tib"]
    assert [*HEALTHY, *tendon] == NAMES
    assert SPEC.parameters == strain.parameters == toe.parameters
    assert SPEC.tie == strain.tie == toe.tie
    assert list(SPEC.free) == [*HEALTHY]
    assert list(strain.free) == [*HEALTHY, "dlt_tri", "dlt_tib"]
    assert list(toe.free) == [*HEALTHY, "pt_tri", "pt_tib"]
    thesis = [0.04, 0.04, 0.3, 0.3, 4.0, 4.0, 8000.0, 1400.0]
    assert vector()[15:].tolist() == thesis
    slack_length = ModelOptions(tendon_strain="slack-length")
    assert vector(slack_length)[15:].tolist() == [0.10, 0.035, *thesis[2:]]
    assert adapted(SPEC.parameters, ModelOptions())["dlt_tri"].unit == "m"
    assert adapted(SPEC.parameters, slack_length)["dlt_tri"].unit == "-"


def test_strain_modes_differ_by_the_slack_length(make_inputs) -> None:
    inputs = make_inputs(1)
    metres = MuscleTendonSimulator(inputs, ModelOptions())
    strain = MuscleTendonSimulator(inputs, ModelOptions(tendon_strain="slack-length"))
    p, columns = vector(dlt_tri=0.0415, dlt_tib=0.0108), [15, 16]
    q = vector(dlt_tri=0.1, dlt_tib=0.05)
    torque, jacobian = metres.torque_jacobian(p, columns)
    same, scaled = strain.torque_jacobian(q, columns)
    assert same == pytest.approx(torque, rel=1e-10)
    expected = jacobian * np.array([[0.415], [0.216]])
    assert scaled == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())
