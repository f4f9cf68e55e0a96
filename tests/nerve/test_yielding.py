"""A device that yields, of another simulator: said, or told apart by its recorded command."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import surae
from ankle_legs import perturbed
from ankle_legs.joint import FINE, Servo
from ankle_legs.leg import generator
from surae.nerve.impedance import samples_of
from surae.nerve.judged import Number
from surae.nerve.measures import number_of
from surae.nerve.turned import turned
from surae.nerve.yielding import (
    COMMAND,
    YIELDS,
    comes_again,
    following,
    loop_of,
    moved_after,
)


def yielding(tmp_path, seed=4, family="qf", soft=0.05, noise=4.0):
    """A record in a small motor, with its command, and what is true of it."""
    ankle = perturbed.ankle(family, seed)
    servo = Servo(8.0, 0.7, soft)
    ankle = replace(ankle, servo=servo, noise=noise * ankle.noise, command="prbs")
    made = perturbed.simulate(ankle, generator(family, seed, 1))
    n = round((60.0 + perturbed.WARM_UP) * FINE)
    command = perturbed.perturbation(generator(family, seed, 1), "prbs", n, ankle.amplitude)
    told = command[round(perturbed.WARM_UP * FINE) :: FINE // perturbed.RATE]
    columns = {**made.columns, "commanded_angle_deg": np.rad2deg(told + ankle.channels.angle)}
    paths = []
    for name, own in (("alone", made.columns), ("told", columns)):
        paths.append(tmp_path / f"{name}.csv")
        np.savetxt(
            paths[-1],
            np.column_stack(list(own.values())),
            "%.8g",
            ",",
            header=",".join(own),
            comments="",
        )
    return *paths, made.truth["measures"]


@pytest.mark.slow
def test_without_its_command_a_device_that_yields_tells_nothing_and_says_so(tmp_path) -> None:
    alone, told, truth = yielding(tmp_path)
    said = surae.impedance(alone)
    assert said.reflex.verdict == "cannot tell"
    assert "the device yields" in said.reflex.reason
    assert all(m.value is None for m in said.measures.values())
    assert surae.read(told).channels[COMMAND].unit == "rad"
    by_command = surae.impedance(told)
    for name in ("intrinsic_stiffness", "inertia"):
        low, high = by_command.measures[name].ci95
        assert low <= truth[name] <= high
        assert high - low < truth[name]
    assert any("follows its recorded command" in note for note in by_command.recordings[0].notes)


def test_a_stiff_device_does_not_yield_whether_its_command_is_known_or_not(ankle) -> None:
    recording = ankle().recording()
    samples, pieces = turned(samples_of(recording))
    assert moved_after(pieces) < YIELDS
    assert not loop_of(recording, samples, pieces).yields
    channel = replace(recording.channels["angle"], role=COMMAND)
    told = replace(recording, channels={**recording.channels, COMMAND: channel})
    loop = loop_of(told, samples, pieces)
    assert (loop.yields, loop.samples, loop.told) == (False, None, True)


def test_the_part_that_follows_a_command_is_found_beside_movement_of_its_own() -> None:
    rate, n = 500.0, 20000
    draw = np.random.default_rng(3)
    command = np.repeat(draw.choice([-0.02, 0.02], n // 100), 100)
    b = 1.0 - np.exp(-1.0 / (0.03 * rate))
    followed = lfilter([b], [1.0, b - 1.0], lfilter([b], [1.0, b - 1.0], command))
    own = lfilter([0.02], [1.0, -0.98], draw.standard_normal(n)) * 0.05
    found = following(command, followed + own, rate)
    error = found - followed
    assert np.std(error) < 0.25 * np.std(own)
    assert np.std(error - error.mean()) < 0.1 * np.std(followed)


def test_a_movement_that_comes_again_is_a_commanded_one() -> None:
    rate = 500.0
    draw = np.random.default_rng(4)
    period = lfilter([0.1], [1.0, -0.9], draw.standard_normal(4000))
    whole = np.tile(period, 5)
    assert comes_again(whole, rate) > 0.999
    apart = lfilter([0.1], [1.0, -0.9], draw.standard_normal(20000))
    assert comes_again(apart, rate) < 0.4
    assert 0.6 < comes_again(whole + 0.3 * apart, rate) < 0.99


def test_no_interval_reaches_below_what_a_leg_can_have() -> None:
    wide = number_of("reflex_gain", Number(2.0, -6.0, 14.0))
    assert wide.ci95 == (0.0, 14.0)
    assert wide.verdict == number_of("reflex_gain", Number(2.0, -8.0, 12.0)).verdict
    assert number_of("intrinsic_viscosity", Number(-0.1, -0.3, 0.2)).ci95 == (-0.1, 0.2)
