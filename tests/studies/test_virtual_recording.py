"""Recordings of virtual subjects: raw EMG that goes through the whole chain, as a file too."""

import numpy as np
import pytest

from surae import read
from surae.base.errors import InputError
from surae.protocol import Protocol, generate, named_device
from surae.recording import csv_columns, write_csv
from surae.signals import prepare
from surae.studies import Imperfections, virtual_recording, virtual_subject, virtual_trial

SUBJECT = virtual_subject(2)


def motion(rate_hz: float):
    return generate(
        Protocol(
            profile="multi-sine-holds",
            chirp_amplitude=0.1,
            chirp_rate=0.1,
            rate_hz=rate_hz,
            device=named_device("achilles"),
        )
    )


@pytest.fixture(scope="module")
def trajectory():
    return motion(2048.0)


@pytest.fixture(scope="module")
def recording(trajectory):
    return virtual_recording(SUBJECT, trajectory)


def test_it_is_raw_at_the_rate_of_the_trajectory(recording, trajectory):
    assert recording.emg == "raw"
    assert [*recording.channels] == ["angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm"]
    assert {channel.rate_hz for channel in recording.channels.values()} == {2048.0}
    np.testing.assert_array_equal(recording.channels["angle"].values, trajectory.angle)
    for muscle in ("ta", "gl", "sol", "gm"):
        emg = recording.channels[f"emg_{muscle}"].values
        assert abs(emg.mean()) < 0.01 * emg.std()
        assert 1e-3 < np.abs(emg).max() < 5e-3  # millivolts, as from an amplifier's input


def test_the_chain_gives_back_what_the_torque_was_simulated_from(recording):
    prepared = prepare(recording)
    truth = virtual_trial(SUBJECT, motion(256.0), noise=0.0)
    n = prepared.n
    assert prepared.rate_hz == 256.0
    np.testing.assert_allclose(prepared.angle, truth.angle[:n], atol=2e-3)
    assert np.std(prepared.torque - truth.torque[:n]) < 0.1
    slope = (prepared.emg * truth.emg[:n]).sum(axis=0) / (truth.emg[:n] ** 2).sum(axis=0)
    assert slope == pytest.approx(np.ones(4), rel=0.05)
    passive = prepared.time < 10.5
    assert prepared.emg[passive].mean(axis=0) == pytest.approx(np.full(4, 1e-6), rel=0.05)


def test_the_model_explains_it_but_for_the_fluctuation_of_emg(recording):
    from surae import simulate

    prepared = prepare(recording)
    error = simulate("muscle", SUBJECT.parameters, prepared) - prepared.torque
    assert 97.0 < 100 * (1 - (error**2).sum() / (prepared.torque**2).sum()) < 100.0


def test_raw_emg_has_draws_of_its_own_for_each_trial(recording, trajectory):
    again = virtual_recording(SUBJECT, trajectory)
    noisy = virtual_recording(SUBJECT, trajectory, imperfections=Imperfections(torque_noise=1.0))
    other = virtual_recording(SUBJECT, trajectory, seed=1)
    first = recording.channels["emg_sol"].values
    np.testing.assert_array_equal(again.channels["emg_sol"].values, first)
    np.testing.assert_array_equal(noisy.channels["emg_sol"].values, first)
    assert abs(np.corrcoef(other.channels["emg_sol"].values, first)[0, 1]) < 0.05


def test_as_a_file_it_reads_back_the_same(tmp_path):
    short = generate(Protocol(profile="ramp-and-hold", rate_hz=1000.0))
    recording = virtual_recording(SUBJECT, short)
    write_csv(tmp_path / "raw.csv", csv_columns(recording), ["emg: raw"])
    back = read(tmp_path / "raw.csv")
    assert back.emg == "raw"
    np.testing.assert_array_equal(prepare(back).emg, prepare(recording).emg)


def test_raw_emg_needs_a_high_rate():
    with pytest.raises(InputError, match=r"raw EMG at 256 Hz .* 1000 Hz or more, .* 2048 Hz"):
        virtual_recording(SUBJECT, motion(256.0))
