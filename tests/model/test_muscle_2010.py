"""The model of 2010: an independent formulation, hand values, derivatives, structure, refusals."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import StateSpace, butter, lsim, sosfiltfilt
from test_rigid import rms

from surae.base.errors import InputError
from surae.model import ModelOptions, adapted, check_value, get_model
from surae.model.muscle_2010 import Muscle2010Simulator, integrated
from surae.signals import ModelInputs

SPEC = get_model("muscle-2010")
TEN = ["m", "k_tri", "x0_tri", "e1", "e2", "e3", "e4", "f", "b_tri", "F0"]
ALL = range(10)
THESIS = ModelOptions()

HEALTHY = {
    "m": 2.0,
    "k_tri": 200.0,
    "x0_tri": 0.018,
    "e1": 0.6e6,
    "e2": 0.9e6,
    "e3": 1.3e6,
    "e4": 1.0e6,
    "f": 2.0,
    "b_tri": 400.0,
    "F0": -8.0,
}
NO_MUSCLE = {"e1": 0.0, "e2": 0.0, "e3": 0.0, "e4": 0.0, "b_tri": 0.0, "F0": 0.0}
VIRTUAL_WORK = {"geometry": "virtual-work"}
CASES = {
    "healthy": ({}, {}, 256.0),
    "fast filter, coarse": ({"f": 12.0, "F0": 30.0}, {}, 50.0),
    "switches": ({}, {"vmax_factor": 10.0, "theta_foot": 0.5}, 125.0),
    "virtual work": (
        {"k_tri": 60.0, "x0_tri": 0.03},
        {**VIRTUAL_WORK, "x_ref_tri": 0.085, "x_ref_tib": 0.095},
        256.0,
    ),
}
every_case = pytest.mark.parametrize("case", CASES)


def vector(**changes: float) -> np.ndarray:
    return SPEC.vector({**HEALTHY, **changes}, THESIS)


@pytest.fixture
def setup(case, make_inputs) -> tuple[ModelInputs, ModelOptions, np.ndarray]:
    changes, options, rate = CASES[case]
    return make_inputs(3, rate_hz=rate), ModelOptions.of(**options), vector(**changes)


def still(seconds: float = 4.0, angle: float = 0.0, speed: float = 0.0, **emg: float):
    """A joint at one angle, as if moving at one speed, with constant EMG."""
    n, zero = int(100 * seconds), np.zeros(int(100 * seconds))
    levels = [emg.get(muscle, 0.0) for muscle in ("ta", "gl", "sol", "gm")]
    return ModelInputs(
        "still",
        100.0,
        np.arange(n) / 100,
        zero + angle,
        zero + speed,
        zero,
        np.tile(levels, (n, 1)),
        "V",
        None,
    )


def integrated_textbook(emg: np.ndarray, rate: float) -> np.ndarray:
    """Butterworth of order 2 forward and backward whose squared gain is ½ at 3 Hz."""
    # |H|² of one pass, 1/(1 + u⁴), is to be √½ at 3 Hz; u is on the axis of the bilinear transform
    warped = np.tan(np.pi * 3.0 / rate) / (np.sqrt(2.0) - 1.0) ** 0.25
    corner = rate / np.pi * np.arctan(warped)
    filtered = sosfiltfilt(
        butter(2, corner, fs=rate, output="sos"), emg, axis=0, padtype="even", padlen=int(rate)
    )
    return np.asarray(filtered)


def textbook(inputs: ModelInputs, options: ModelOptions, p: np.ndarray) -> np.ndarray:
    """The equations in plain numpy and scipy."""
    v = dict(zip(TEN, p, strict=True))
    angle, velocity = inputs.angle, inputs.velocity
    arms = 0.0480 - 0.0104 * angle, 0.0393 + 0.0171 * angle
    if options.geometry == "thesis":
        lengths = 0.118 - 1.67 * arms[0], 0.136 - 1.56 * arms[1]
        slopes = 1.67 * 0.0104, -1.56 * 0.0171
        optimal = 0.118 - 1.67 * 0.0480, 0.136 - 1.56 * 0.0393
    else:
        lengths = (
            options.x_ref_tri + 0.0480 * angle - 0.0052 * angle**2,
            options.x_ref_tib - 0.0393 * angle - 0.00855 * angle**2,
        )
        slopes = arms[0], -arms[1]
        optimal = options.x_ref_tri, options.x_ref_tib
    iemg = integrated_textbook(inputs.emg, inputs.rate_hz)
    drive = iemg[:, 1:] @ [v["e2"], v["e3"], v["e4"]], v["e1"] * iemg[:, 0]
    w = 2 * np.pi * v["f"]
    system = StateSpace([[0, 1], [-w * w, -2 * w]], [[0], [w * w]], [[1, 0]], [[0]])
    torque = v["m"] * 0.15**2 * inputs.acceleration
    torque += v["m"] * 9.81 * 0.15 * np.cos(angle - options.theta_foot)
    for sign, arm, x, slope, l0, e in zip((1, -1), arms, lengths, slopes, optimal, drive):  # noqa: B905
        speed, vmax = slope * velocity, options.vmax_factor * l0
        alpha = lsim(system, e, inputs.time)[1]
        f_l = np.exp(-((x - l0) ** 2) / (0.1 * l0**2))
        shortening = (speed + vmax) / (vmax - speed / 0.25)
        lengthening = 1 + 1.125 * 0.5 * speed / (0.125 * vmax + speed)
        force = f_l * np.where(speed < 0, shortening, lengthening) * alpha
        if sign > 0:
            force += np.exp(v["k_tri"] * (x - v["x0_tri"])) + v["b_tri"] * speed + v["F0"]
        torque += sign * arm * force
    return torque


def test_the_model_has_the_ten_parameters_in_order() -> None:
    assert list(SPEC.names) == list(SPEC.free) == TEN
    assert [SPEC.parameters[i].unit for i in (8, 9)] == ["N·s/m", "N"]
    assert [p.group for p in SPEC.parameters] == [
        "limb",
        "passive",
        "passive",
        *["active"] * 5,
        "passive",
        "passive",
    ]


def test_its_title_says_what_it_is() -> None:
    assert "reconstructed" in SPEC.title


@every_case
def test_torque_is_the_reconstruction(setup) -> None:
    inputs, options, p = setup
    expected = textbook(inputs, options, p)
    error = Muscle2010Simulator(inputs, options).torque(p) - expected
    # beyond a second from the ends, where it matters how the signal is continued
    inner = slice(round(inputs.rate_hz), -round(inputs.rate_hz))
    assert np.abs(error[inner]).max() < 1e-4 * rms(expected)
    assert rms(error) < 1e-4 * rms(expected)


@every_case
def test_jacobian_against_richardson(setup) -> None:
    inputs, options, p = setup
    simulator = Muscle2010Simulator(inputs, options)
    for j, (name, exact) in enumerate(zip(TEN, simulator.torque_jacobian(p, ALL)[1], strict=True)):

        def central(h: float, j: int = j) -> np.ndarray:
            up, down = p.copy(), p.copy()
            up[j] += h
            down[j] -= h
            return (simulator.torque(up) - simulator.torque(down)) / (2 * h)

        h = 1e-3 * abs(p[j])
        numeric = (4 * central(h) - central(2 * h)) / 3
        assert np.abs(exact).max() * abs(p[j]) > 0.01, name  # it matters here, in Nm
        assert np.abs(exact - numeric).max() < 1e-7 * np.abs(exact).max(), name


@every_case
def test_parts_add_up(setup) -> None:
    inputs, options, p = setup
    simulator = Muscle2010Simulator(inputs, options)
    parts, torque = simulator.parts(p), simulator.torque(p)
    assert parts.total == pytest.approx(torque, abs=1e-12 * rms(torque))
    assert not parts.tissue_tib.any()  # passive: triceps only
    assert parts.neural_tri.max() > 1
    assert parts.neural_tib.min() < -1
    assert parts.neural_tri.min() > -0.02 * parts.neural_tri.max()  # the low-pass rings a little
    assert simulator.tendon(p) is None


def test_passive_force_by_hand() -> None:
    # 0.2 rad: r = 0.04592, x = 0.0413136, x' = 0.017368·2 = 0.034736 m/s
    p = vector(m=0.0, e1=0.0, e2=0.0, e3=0.0, e4=0.0, x0_tri=0.0313136, k_tri=100.0)
    torque = Muscle2010Simulator(still(angle=0.2, speed=2.0), THESIS).torque(p)
    assert torque == pytest.approx(0.04592 * (np.e + 400 * 0.034736 - 8.0), rel=1e-12)


def test_the_passive_force_may_push() -> None:
    p = vector(m=0.0, e1=0.0, e2=0.0, e3=0.0, e4=0.0, x0_tri=0.06)
    still_, short = (still(angle=-0.5, speed=s) for s in (0.0, -3.0))
    shifted = Muscle2010Simulator(still_, THESIS).torque(p)
    assert shifted == pytest.approx(-8.0 * (0.0480 + 0.0052), rel=1e-3)
    assert Muscle2010Simulator(short, THESIS).torque(p).max() < shifted.max()


@pytest.mark.parametrize("options", [{}, VIRTUAL_WORK, {**VIRTUAL_WORK, "x_ref_tri": 0.07}])
def test_at_neutral_each_muscle_has_its_optimal_length(options) -> None:
    emg = {"ta": 1e-4, "gl": 2e-4, "sol": 3e-4, "gm": 4e-4}
    parts = Muscle2010Simulator(still(**emg), ModelOptions.of(**options)).parts(vector())
    # isometric at the optimal length: weights times EMG, once the filter has settled
    assert parts.neural_tri[-1] == pytest.approx(0.0480 * (180 + 390 + 400), rel=1e-9)
    assert parts.neural_tib[-1] == pytest.approx(-0.0393 * 60, rel=1e-9)


@pytest.mark.parametrize(
    ("frequency", "least", "most"), [(0.0, 1.0, 1.0), (3.0, 0.5**0.5, 0.5**0.5), (12.0, 0, 0.0094)]
)
def test_integrated_emg_has_lost_three_decibels_at_three_hertz(frequency, least, most) -> None:
    inputs = still(seconds=20.0)
    turn = np.exp(-2j * np.pi * frequency * inputs.time)
    emg = np.repeat(1e-4 * turn.real[:, None], 4, axis=1)
    inner = slice(400, 1600)  # whole periods
    iemg = integrated(replace(inputs, emg=emg))
    assert iemg.shape == (4, inputs.n)
    for channel in iemg:
        passed = channel[inner] @ turn[inner] / (emg[inner, 0] @ turn[inner])
        assert least - 1e-6 <= passed.real <= most + 1e-6
        assert passed.imag == pytest.approx(0.0, abs=1e-6)  # zero phase


def test_without_shift_and_viscosity_passive_torque_is_that_of_model_1_0(make_inputs) -> None:
    # without relaxation, and with a tibialis that has next to no tissue
    inputs = make_inputs(1)
    plain = get_model("muscle")
    table = {p.name: p.start for p in plain.parameters}
    common = {"m": 2.0, "k_tri": 180.0, "x0_tri": 0.017}
    given = table | common | {"k_rel": 0.0, "x0_tib": 5.0, "g1": 0, "g2": 0, "g3": 0, "g4": 0}
    old = Muscle2010Simulator(inputs, THESIS).torque(vector(**NO_MUSCLE, **common))
    new = plain.simulator(inputs, THESIS).torque(plain.vector(given, THESIS))
    assert old == pytest.approx(new, rel=1e-12)


def test_the_shift_alone_may_be_negative() -> None:
    for name in TEN:
        p = SPEC.parameters[TEN.index(name)]
        if name == "F0":
            check_value(p, -5.0, SPEC)
            check_value(p, 0.0, SPEC)
        else:
            with pytest.raises(InputError, match=f"{name} is -5"):
                check_value(p, -5.0, SPEC)
    with pytest.raises(InputError, match="F0 is nan; give a finite number"):
        vector(F0=float("nan"))


def test_weights_of_a_normalised_envelope_are_forces() -> None:
    normalised = adapted(SPEC.parameters, THESIS, "1")
    plain = adapted(SPEC.parameters, THESIS)
    assert [n for n in TEN if normalised[n] != plain[n]] == ["e1", "e2", "e3", "e4"]
    assert {normalised[n].unit for n in ("e1", "e2", "e3", "e4")} == {"N"}


@pytest.mark.parametrize(
    ("rate", "seconds", "message"),
    [
        (
            6.0,
            60.0,
            "slow: 6 Hz is too slow for the model of 2010, which integrates EMG by a "
            "low-pass at 3 Hz; sample above 6.67 Hz",
        ),
        (128.0, 0.3, "slow: integrated EMG: 38 samples (0.297 s) are too few for a filter at 3 Hz"),
    ],
)
def test_a_recording_that_cannot_be_integrated(make_inputs, rate, seconds, message) -> None:
    inputs = replace(make_inputs(0, rate_hz=rate, seconds=seconds), name="slow")
    with pytest.raises(InputError, match=f"^{re.escape(message)}"):
        Muscle2010Simulator(inputs, THESIS)


def test_overflow_shows_in_the_torque_and_in_the_jacobian(make_inputs) -> None:
    torque, jacobian = Muscle2010Simulator(make_inputs(0), THESIS).torque_jacobian(
        vector(k_tri=1e6), ALL
    )
    assert not np.isfinite(torque).all()
    assert not np.isfinite(jacobian).all()
