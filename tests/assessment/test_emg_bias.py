"""Bias by EMG noise against the bias itself, measured on a virtual subject."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.assessment import assess
from surae.assessment.resampling.bootstrap import refit
from surae.assessment.resampling.emg_bias import emg_bias, quiet_noise
from surae.errors import InputError
from surae.estimation import fit_problem, make_problem
from surae.frozen import read_only

LEVEL = 0.2
#: What the EMG acts on; the rest is fixed at the truth, for speed.
ACTIVE = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
#: Known well enough to see a bias of hundredths of a percent.
CHECKED = ("g1", "l0_tri", "l0_tib")


def noisy_emg(clean, noise):
    return replace(clean, emg=read_only(clean.emg + noise))


def drawn(clean, seed, level=LEVEL):
    rng = np.random.default_rng([seed, 11])
    return level * clean.emg.mean(axis=0) * rng.standard_normal(clean.emg.shape)


@pytest.fixture(scope="module")
def fixed(subject):
    return {name: value for name, value in subject.parameters.items() if name not in ACTIVE}


@pytest.fixture(scope="module")
def fitted_noisy(clean, fixed):
    return fit_problem(make_problem([noisy_emg(clean, drawn(clean, 0))], fixed=fixed), starts=1)


@pytest.mark.slow
def test_the_bias_has_the_right_sign_and_size(clean, subject, fixed, fitted_noisy):
    # What 20 % of EMG noise does on average; opposite signs cancel what it does to first order.
    truth = np.array([subject.parameters[name] for name in ACTIVE])
    shifts = []
    for seed in range(1, 31):
        noise = drawn(clean, seed)
        both = [
            refit(make_problem([noisy_emg(clean, sign * noise)], fixed=fixed), truth, stall=1e-4)
            for sign in (1, -1)
        ]
        shifts.append(np.mean(both, axis=0) - truth)
    bias, error = np.mean(shifts, axis=0), np.std(shifts, axis=0) / np.sqrt(30)
    found = emg_bias(fitted_noisy, level=LEVEL, pairs=20)
    assert tuple(found.parameters) == ACTIVE
    for j, name in enumerate(ACTIVE):
        p = found.parameters[name]
        assert abs(p.bias - bias[j]) < 4 * np.hypot(p.error, error[j]) + 0.25 * abs(bias[j]), name
    for name in CHECKED:
        p, j = found.parameters[name], ACTIVE.index(name)
        assert p.bias < -4 * p.error, name  # told from zero
        assert p.bias == pytest.approx(bias[j], rel=0.5), name
        assert p.corrected == p.value - p.bias
    assert found.noise[0]["ta"] == pytest.approx(LEVEL * clean.emg[:, 0].mean(), rel=0.02)


def test_the_quiet_part_tells_the_noise(clean, fitted_noisy):
    known = LEVEL * clean.emg.mean(axis=0)
    found = emg_bias(fitted_noisy, pairs=1).noise[0]
    np.testing.assert_allclose(list(found.values()), known, rtol=0.15)


def test_correlated_noise_of_the_quiet_part_is_known_as_such():
    rng = np.random.default_rng(1)
    noise = np.convolve(rng.standard_normal(20_004), np.ones(5) / 5, "valid")
    emg = noise + np.where(np.arange(20_000) % 4000 < 1000, 0.0, 50.0)
    found = quiet_noise(emg, 100.0, "x")
    assert found.order >= 1
    # A lower limit: what is slower than a window counts as its mean.
    assert 0.75 * 0.2 < found.autocovariance[0] < 0.2
    rho = found.autocovariance / found.autocovariance[0]
    np.testing.assert_allclose(rho[:5], [1.0, 0.8, 0.6, 0.4, 0.2], atol=0.15)


def test_the_same_numbers_for_any_number_of_workers(fitted_noisy):
    one = emg_bias(fitted_noisy, level=0.1, pairs=3, seed=5, workers=1)
    two = emg_bias(fitted_noisy, level=0.1, pairs=3, seed=5, workers=2)
    assert one.parameters == two.parameters
    assert one.parameters != emg_bias(fitted_noisy, level=0.1, pairs=3, seed=6).parameters


def test_a_missing_muscle_has_no_noise(clean, subject):
    emg = clean.emg.copy()
    emg[:, 1] = 0.0
    trial = replace(clean, emg=read_only(emg), missing_emg=("gl",))
    result = fit_problem(make_problem([trial], fixed={"g2": 0.0}), starts=1)
    found = emg_bias(result, level=0.1, pairs=1)
    assert list(found.noise[0]) == ["ta", "sol", "gm"]
    assert "g2" not in found.parameters


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"level": 0.0}, "EMG noise of 0 times the mean"),
        ({"level": 1.5}, "at most 1"),
        ({"level": float("nan")}, "at most 1"),
        ({"pairs": 0}, "pairs is 0"),
        ({"workers": 0}, "workers is 0"),
    ],
)
def test_what_makes_no_sense_is_refused(fitted_noisy, changes, message):
    with pytest.raises(InputError, match=message):
        emg_bias(fitted_noisy, **changes)


def test_too_short_for_a_quiet_part():
    with pytest.raises(InputError, match="too short to find its quiet part"):
        quiet_noise(np.ones(150), 100.0, "trial.csv")


def test_ctrl_c_keeps_the_pairs_that_are_complete(fitted_noisy):
    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    found = emg_bias(fitted_noisy, level=0.1, pairs=6, workers=1, progress=stop)
    assert found.missing == 4
    assert found.parameters["g1"].bias is not None


def test_the_public_function_and_its_file(fitted_noisy, tmp_path):
    fit = surae.Fit(fitted_noisy, assess(fitted_noisy))
    found = surae.emg_bias(fit, level=0.05, pairs=2)
    found.save(tmp_path / "bias.json")
    assert found.source == "5 % of each mean"
    assert '"bias"' in (tmp_path / "bias.json").read_text(encoding="utf-8")
