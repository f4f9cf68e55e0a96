"""Perturbations and stretch series keep a device's limits, and tell what they are for."""

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.names import TELLING
from surae.protocol import named_device, write_protocol
from surae.protocol.device import Device
from surae.quality.position import perturbing
from surae_nerve.expected import USUAL, expected
from surae_nerve.movements import PERTURBATIONS, REPEATS, telling


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
def test_a_perturbation_is_known_as_one_and_a_fit_is_not_expected_of_it(name, tmp_path) -> None:
    movement = telling(name, None, (-0.5, 0.5), 256.0)
    assert perturbing(movement.angle, 256.0)
    write_protocol(movement, tmp_path / "p.csv", without_limits="a test")
    with pytest.raises(InputError, match=f"{name}.* says"):  # a file does not say which it is
        surae.expect(tmp_path / "p.csv")
    with pytest.raises(InputError, match=f"surae protocol {name} says"):
        surae.expect(movement)


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


def test_what_is_expected_grows_with_the_noise_of_time() -> None:
    """Half of the record tells about 1.4 times less."""
    movement = telling("prbs", None, (-0.5, 0.5), 256.0)
    whole = expected(movement.time, movement.angle)
    n = len(movement.time) // 2
    half = expected(movement.time[:n], movement.angle[:n])
    for name, value in (("intrinsic_stiffness", "stiffness"), ("reflex_gain", "gain")):
        assert whole[name].value == USUAL[value]
        ratio = np.ptp((half[name].low, half[name].high)) / np.ptp(
            (whole[name].low, whole[name].high)
        )
        assert 1.0 < ratio < 2.2
