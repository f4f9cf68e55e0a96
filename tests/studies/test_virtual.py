"""Virtual subjects and trials: drawn alike every time, simulated from clean EMG, noise as asked."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.model import get_model
from surae.model.options import ModelOptions
from surae.model.parameters import MUSCLE_PARAMETERS
from surae.protocol import Protocol, generate
from surae.studies import POPULATIONS, virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def trajectory():
    return generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=64.0)
    )


@pytest.mark.parametrize("population", POPULATIONS)
def test_subjects_lie_within_their_population_and_the_bounds_of_a_fit(population):
    bounds = {p.name: (p.lower, p.upper) for p in MUSCLE_PARAMETERS}
    assert list(POPULATIONS[population]) == [p.name for p in MUSCLE_PARAMETERS]
    drawn = [virtual_subject(seed, population).parameters for seed in range(200)]
    for name, (low, high) in POPULATIONS[population].items():
        values = np.array([parameters[name] for parameters in drawn])
        assert bounds[name][0] < low <= values.min() < values.max() <= high < bounds[name][1]
        assert values.mean() == pytest.approx((low + high) / 2, abs=0.1 * (high - low))


def test_the_same_seed_is_the_same_subject():
    assert virtual_subject(5) == virtual_subject(5)
    assert virtual_subject(5).parameters != virtual_subject(6).parameters
    assert virtual_subject(5).parameters != virtual_subject(5, "patient").parameters


def test_passive_torque_of_the_population_is_that_of_the_literature():
    # Triceps at 10° dorsiflexion: healthy 6.2 ± 3.6 Nm, spastic 9.5 ± 4.8 Nm (Chung 2004).
    theta = np.deg2rad(10.0)
    arm = 0.0480 - 0.0104 * theta
    means = {}
    for population in POPULATIONS:
        torque = [
            np.exp(s["k_tri"] * (0.118 - 1.67 * arm - s["x0_tri"])) * arm
            for s in (virtual_subject(i, population).parameters for i in range(300))
        ]
        means[population] = np.mean(torque)
    assert means["healthy"] == pytest.approx(6.2, abs=3.6 / 2)
    assert means["patient"] == pytest.approx(9.5, abs=4.8 / 2)


def test_an_unknown_population():
    with pytest.raises(InputError, match=r"population 'old' is not known; .* healthy, patient"):
        virtual_subject(1, "old")


def test_without_noise_the_torque_is_the_model_s(trajectory):
    subject = virtual_subject(2)
    trial = virtual_trial(subject, trajectory, noise=0.0)
    spec, options = get_model("muscle"), ModelOptions()
    torque = spec.simulator(trial, options).torque(spec.vector(subject.parameters, options))
    np.testing.assert_array_equal(trial.torque, torque)
    assert trial.emg.min() == 1e-6
    assert trial.emg.max() <= 6e-4
    assert 20 < np.abs(trial.torque).max() < 250
    assert trial.prepared
    assert not trial.torque.flags.writeable
    assert not trial.emg.flags.writeable


def test_the_noise_is_that_part_of_each_signal_s_mean_magnitude(trajectory):
    subject = virtual_subject(2)
    clean = virtual_trial(subject, trajectory, noise=0.0)
    trial = virtual_trial(subject, trajectory, noise=0.05)
    for noisy, signal in [
        (trial.torque, clean.torque),
        *zip(trial.emg.T, clean.emg.T, strict=True),
    ]:
        error = noisy - signal
        assert error.std() == pytest.approx(0.05 * np.abs(signal).mean(), rel=0.06)
        assert abs(error.mean()) < 4 * error.std() / np.sqrt(len(error))
        assert abs(np.corrcoef(error[1:], error[:-1])[0, 1]) < 0.1


def test_the_torque_is_simulated_from_the_true_emg(trajectory):
    # Were it simulated from the noisy one, its noise would be in the torque as well.
    subject = virtual_subject(2)
    clean = virtual_trial(subject, trajectory, noise=0.0)
    trial = virtual_trial(subject, trajectory, noise=0.05)
    spec, options = get_model("muscle"), ModelOptions()
    values = spec.vector(subject.parameters, options)
    from_noisy_emg = spec.simulator(trial, options).torque(values)
    assert np.std(trial.torque - from_noisy_emg) > np.std(trial.torque - clean.torque)


def test_realisations(trajectory):
    first, same = (virtual_trial(virtual_subject(2), trajectory, seed=3) for _ in range(2))
    np.testing.assert_array_equal(first.torque, same.torque)
    np.testing.assert_array_equal(first.emg, same.emg)
    for other in (
        virtual_trial(virtual_subject(2), trajectory, seed=4),
        virtual_trial(virtual_subject(3), trajectory, seed=3),
    ):
        error, another = first.emg[:, 0] - other.emg[:, 0], first.torque - other.torque
        assert np.abs(error).max() > 0
        assert np.abs(another).max() > 0


def test_model_and_options_reach_the_simulation(trajectory):
    subject = virtual_subject(2)
    plain = virtual_trial(subject, trajectory, noise=0.0)
    compliant = virtual_trial(subject, trajectory, noise=0.0, model="muscle-tendon")
    tilted = virtual_trial(subject, trajectory, noise=0.0, options=ModelOptions(theta_foot=0.5))
    assert np.std(plain.torque - compliant.torque) > 0.1
    assert np.std(plain.torque - tilted.torque) > 0.1
    assert "muscle-tendon" in compliant.steps[0]
