"""Perturbations and stretch series keep a device's limits, and tell what they are for."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from perturbed_ankle import Ankle
from surae.api.requested import as_trajectory
from surae.base.errors import InputError
from surae.base.names import TELLING
from surae.nerve.expected import _of_perturbation, series
from surae.nerve.made import USUAL
from surae.nerve.movements import PERTURBATIONS, REPEATS, telling
from surae.planning.ready import ready_protocols
from surae.protocol import Protocol, generate, named_device, write_protocol
from surae.protocol.device import Device
from surae.quality.position import perturbing


@pytest.mark.parametrize("name", TELLING)
def test_limits_are_kept_and_a_seed_repeats_it(name) -> None:
    device = named_device("achilles")
    one, same, other = (telling(name, device, (-0.7, 0.5), 256.0, seed) for seed in (1, 1, 2))
    assert np.abs(one.velocity).max() <= device.max_velocity
    assert one.angle.min() >= -0.7
    assert one.angle.max() <= 0.5
    assert np.array_equal(one.angle, same.angle)
    assert not np.array_equal(one.angle[:5000], other.angle[:5000])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["prbs", "stretches"])
def test_a_slow_device_is_asked_for_less(name) -> None:
    slower = Device("slow", 0.5, 10.0, 80.0)
    slow = telling(name, slower, (-0.7, 0.5), 256.0)
    assert np.abs(slow.velocity).max() <= 0.5 * 1.001
    assert np.abs(slow.acceleration).max() <= 10.0 * 1.01


@pytest.mark.parametrize("name", PERTURBATIONS)
def test_a_perturbation_is_known_as_one_and_no_muscles_are_expected_of_it(name, tmp_path) -> None:
    movement = telling(name, None, (-0.5, 0.5), 256.0)
    assert perturbing(movement.angle, 256.0)
    write_protocol(movement, tmp_path / "p.csv", without_limits="a test")
    for given in (tmp_path / "p.csv", movement):
        with pytest.raises(InputError, match="leave model out"):
            surae.expect(given, "muscle")
        with pytest.raises(InputError, match="leave legs out"):
            surae.expect(given, legs=3)
        with pytest.raises(InputError, match="surae impedance"):
            surae.expect(given, fit=tmp_path / "none.json")


def test_series_of_stretches_are_known_and_other_ramps_are_not() -> None:
    movement = telling("stretches", None, (-0.5, 0.5), 256.0)
    assert series(movement)
    assert not series(replace(movement, effort=np.ones_like(movement.effort)))
    for profile in ("multiple-holds", "sine"):
        assert not series(generate(Protocol(profile=profile, task="passive", duration=60.0)))


@pytest.mark.slow
def test_designed_protocols_are_no_series_of_stretches() -> None:
    assert not any(series(as_trajectory(name)) for name in ready_protocols())


def test_stretches_are_of_several_speeds_slow_ones_first() -> None:
    movement = telling("stretches", None, (-0.5, 0.5), 256.0)
    moving = movement.velocity > 0.05
    starts = np.flatnonzero(np.diff(moving.astype(int)) == 1)
    assert len(starts) == 5 * REPEATS
    ends = np.flatnonzero(np.diff(moving.astype(int)) == -1)
    speeds = [np.median(movement.velocity[a + 1 : b]) for a, b in zip(starts, ends, strict=True)]
    assert np.allclose(speeds[:REPEATS], np.deg2rad(10.0), rtol=0.02)
    assert np.ptp(np.diff(starts)[REPEATS:] / 256.0) > 1.0  # nobody can foresee the next
    with pytest.raises(InputError, match="too slow"):
        telling("stretches", Device("still", 0.1, 10.0, 80.0), (-0.5, 0.5), 256.0)


def test_stretches_are_expected_to_show_what_noise_does_not_hide() -> None:
    movement = telling("stretches", named_device("achilles"), (-0.7, 0.5), 256.0)
    done = list[tuple[int, int]]()
    told = surae.expect(movement, progress=lambda *news: done.append(news))
    noisy = surae.expect(movement, noise=8.0)
    assert done == [(0, 3), (1, 3), (2, 3)]
    assert all(each.seen == each.of > 0 for each in told.reflexes)
    assert noisy.reflexes[0].seen < noisy.reflexes[0].of
    assert all(each.without_emg == 0 for each in told.reflexes)  # it ends with the stretch
    widths = [np.ptp(e.measures["neural_torque"].ci95) for e in (told, noisy)]
    assert widths[0] < widths[1]
    assert told.as_table().text().count("would be seen") == 3
    with pytest.raises(InputError, match="usual leg"):
        surae.expect(movement, fit="i.json")


def test_a_reflex_in_too_much_noise_is_not_expected_to_be_seen() -> None:
    movement = telling("multisine", None, (-0.5, 0.5), 256.0)
    told = surae.expect(movement, noise=6.0)
    assert told.reflexes[0].seen == 0


@pytest.mark.slow
def test_promised_widths_are_those_of_recordings_that_others_made() -> None:
    """An ankle simulated apart: promised half-widths hold its errors, and are its intervals'."""
    ankle = Ankle(seconds=60.0, rate=1000.0, branch=40.0, time=0.01, noise=0.15)
    angle = ankle.moved(1)["angle"]
    time = np.arange(len(angle)) / 1000.0
    plain = telling("prbs", None, (-0.5, 0.5), 1000.0)
    speed = np.gradient(angle, time)
    movement = replace(
        plain,
        time=time,
        angle=angle,
        velocity=speed,
        acceleration=speed,
        effort=np.zeros((len(time), 4)),
    )
    own = {"stiffness": 60.0, "viscosity": 0.8, "inertia": 0.015}
    measures, _ = _of_perturbation(movement, {**USUAL, **own}, 0.15, None)
    names = {"intrinsic_stiffness": 60.0, "intrinsic_viscosity": 1.2, "inertia": 0.015}
    found = [surae.impedance(ankle.recording(seed)).measures for seed in range(1, 6)]
    for name, true in names.items():
        promised = np.ptp(measures[name].ci95) / 2.0
        real = np.median([np.ptp(each[name].ci95) / 2.0 for each in found])
        assert 0.4 < promised / real < 2.5
        errors = np.array([each[name].value - true for each in found])
        assert np.abs(errors).max() < 1.5 * promised
