"""What a planned movement is expected to tell of the relaxed leg is what its recording tells."""

import numpy as np
import pytest

import surae
from surae.base.records import to_plain
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject, virtual_trial

RAMPS = Protocol(profile="multiple-holds", task="passive", rate_hz=64.0, duration=40.0)


@pytest.fixture(scope="module")
def expectation():
    return surae.expect(generate(RAMPS), "muscle", legs=4)


def test_half_widths_are_those_of_recordings(expectation, tmp_path) -> None:
    motion = generate(RAMPS)
    halves = []
    for seed in range(4):
        made = virtual_trial(virtual_subject(50 + seed), motion, noise=0.5, seed=seed)
        columns = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque}
        columns |= {f"emg_{m}_V": np.maximum(made.emg[:, i], 0.0) for i, m in enumerate(MUSCLES)}
        surae.write_csv(tmp_path / f"{seed}.csv", columns, ["emg: envelope"])
        m = surae.relaxed(tmp_path / f"{seed}.csv").measures["torque_rise"]
        halves.append(0.5 * (m.ci95[1] - m.ci95[0]) / m.value)
    told = expectation.at_rest["torque_rise"]
    assert told.unit == "Nm"
    assert told.half_width == pytest.approx(float(np.median(halves)), rel=0.6)


def test_the_devices_angle_is_known_better_than_the_ankles(expectation) -> None:
    both = [m for m in expectation.at_rest.values() if m.half_width_device is not None]
    assert both
    assert all(m.half_width_device <= m.half_width for m in both)
    assert "torque_rise ±" in str(expectation.rest_told)
    assert str(expectation.rest_told) in expectation.as_table().below
    assert to_plain(expectation)["at_rest"]["torque_rise"]["unit"] == "Nm"


def test_more_noise_tells_less(expectation) -> None:
    loud = surae.expect(generate(RAMPS), "muscle", legs=4, noise=3.0)
    assert loud.at_rest["torque_rise"].half_width > expectation.at_rest["torque_rise"].half_width
