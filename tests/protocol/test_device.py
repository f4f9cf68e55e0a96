"""Devices: limits hold after adaptation, what was lost is said, or the motion is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surae.base.errors import InputError
from surae.protocol import (
    DEVICES,
    PROFILES,
    Device,
    Protocol,
    allowed_range,
    generate,
    named_device,
)
from surae.protocol.adaptation import low_pass, spectrum_of

ACHILLES = DEVICES["achilles"]
EVERY = pytest.mark.parametrize("name", PROFILES)


@pytest.mark.slow
@settings(max_examples=20)
@given(
    name=st.sampled_from(sorted(PROFILES)),
    amplitude=st.floats(0.0, 0.6),
    rate=st.floats(0.02, 0.6),
    velocity=st.floats(0.05, 20.0),
    acceleration=st.floats(1.0, 1000.0),
)
def test_limits_hold_after_adaptation(name, amplitude, rate, velocity, acceleration):
    device = Device("bench", max_velocity=velocity, max_acceleration=acceleration)
    trajectory = generate(
        Protocol(
            profile=name,
            chirp_amplitude=amplitude,
            chirp_rate=rate,
            device=device,
            rate_hz=64.0,
            task="passive",
            duration=20.0,
        )
    )
    assert np.abs(trajectory.velocity).max() <= velocity * (1 + 1e-9)
    assert np.abs(trajectory.acceleration).max() <= acceleration * (1 + 1e-9)
    assert trajectory.angle.min() >= -0.9 - 1e-9
    assert trajectory.angle.max() <= 0.6 + 1e-9
    assert trajectory.adaptation is not None
    assert 0.0 < trajectory.adaptation.span <= 1.0 + 1e-9


SHORT = Device("short", angle_range=(-0.5, 0.3))


@pytest.mark.parametrize(
    ("device", "asked", "allowed"),
    [
        (None, None, (-0.9, 0.6)),
        (ACHILLES, None, (-0.9, 0.6)),
        (ACHILLES, (-1.2, 0.1), (-1.2, 0.1)),
        (SHORT, None, (-0.5, 0.3)),
        (SHORT, (-0.4, 0.2), (-0.4, 0.2)),
        (Device("up", angle_range=(0.7, 0.9)), None, (0.7, 0.9)),
    ],
)
def test_the_range_is_what_was_asked_for_or_what_the_device_reaches(device, asked, allowed):
    assert allowed_range(device, asked) == allowed


@pytest.mark.parametrize("asked", [(-0.9, 0.3), (-0.5, 0.6), (0.4, 0.5), (0.3, -0.3), (-4.0, 0.0)])
def test_a_range_beyond_the_device_s_is_refused(asked):
    with pytest.raises(InputError, match=r"reaches|must be below"):
        allowed_range(SHORT, asked)
    with pytest.raises(InputError, match=r"reaches|must be below"):
        Protocol(profile="sine", angle_range=asked, device=SHORT)


@EVERY
@pytest.mark.parametrize("amplitude", [pytest.param(0.0, marks=pytest.mark.slow), 0.2])
def test_achilles_follows_every_profile_over_the_whole_range(name, amplitude):
    trajectory = generate(
        Protocol(profile=name, chirp_amplitude=amplitude, device=ACHILLES, rate_hz=250.0)
    )
    assert np.abs(trajectory.velocity).max() <= 1.5
    assert np.ptp(trajectory.angle) == pytest.approx(1.5, abs=1e-3)
    assert trajectory.adaptation is not None
    assert trajectory.adaptation.span == pytest.approx(1.0, abs=1e-9)


def test_adapted_motion_has_its_own_derivatives():
    protocol = Protocol(
        profile="multi-sine-holds", chirp_amplitude=0.2, device=ACHILLES, rate_hz=4000.0
    )
    trajectory = generate(protocol)
    h, inner = 1 / 4000.0, slice(200, -200)
    np.testing.assert_allclose(
        trajectory.velocity[inner], np.gradient(trajectory.angle, h)[inner], atol=1e-3
    )
    np.testing.assert_allclose(
        trajectory.acceleration[inner], np.gradient(trajectory.velocity, h)[inner], atol=0.05
    )
    np.testing.assert_allclose(trajectory.velocity[[0, -1]], 0.0, atol=1e-9)


def test_holds_chirp_is_lowered_for_achilles_and_said():
    trajectory = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, device=ACHILLES))
    adaptation = trajectory.adaptation
    assert adaptation is not None
    assert adaptation.chirp_amplitude == (0.2, 0.1)
    assert adaptation.cutoff_hz is not None
    assert 0.0 < adaptation.chirp_end_amplitude < 0.1
    assert adaptation.peak_velocity[0] == pytest.approx(7.44, abs=0.005)
    assert adaptation.steps[0] == "Chirp lowered from 0.2 to 0.1 rad for achilles."
    assert "falls from 7.44 to 1.5 rad/s" in adaptation.steps[1]
    # The chirp keeps its velocity while its amplitude falls with its frequency (Figure 36): in a
    # hold, halfway, it is already what it is at the end.
    hold = trajectory.velocity[(trajectory.time > 21.8) & (trajectory.time < 22.0)]
    assert np.ptp(hold) / 2 == pytest.approx(
        2 * np.pi * 0.159 * 35.0 * adaptation.chirp_end_amplitude, rel=0.05
    )


def test_what_the_device_can_follow_is_left_as_it_is():
    on_device = generate(Protocol(profile="ramp-and-hold", device=ACHILLES))
    plain = generate(Protocol(profile="ramp-and-hold"))
    np.testing.assert_allclose(on_device.angle, plain.angle, atol=1e-12)
    assert on_device.adaptation is not None
    assert on_device.adaptation.steps == ()
    assert on_device.adaptation.cutoff_hz is None


def test_a_device_too_slow_for_the_range_gives_up_range_and_says_so():
    crawling = Device("crawler", max_velocity=0.05)
    trajectory = generate(Protocol(profile="scaled-chirp", device=crawling))
    assert trajectory.adaptation is not None
    assert trajectory.adaptation.span < 0.9
    assert "of the range of motion is reached" in trajectory.adaptation.steps[-1]
    assert np.ptp(trajectory.angle) == pytest.approx(1.5 * trajectory.adaptation.span, rel=1e-3)


def test_refusal_says_by_how_much_and_what_to_do():
    with pytest.raises(InputError) as refused:
        generate(
            Protocol(profile="multiple-holds", chirp_amplitude=0.2, device=ACHILLES, adapt=False)
        )
    message = str(refused.value)
    assert "multiple-holds with a chirp of 0.2 rad reaches 7.438 rad/s, " in message
    assert "4.96 times the 1.5 rad/s that achilles follows" in message
    assert "allow adaptation" in message
    assert "\n" not in message


def test_torque_limits_the_acceleration_of_foot_and_footplate():
    assert ACHILLES.acceleration_limit == pytest.approx(80.0 / (3.0 * 0.15**2))
    weak = Device("weak", max_torque=1.0)
    trajectory = generate(Protocol(profile="sine", chirp_amplitude=0.2, device=weak))
    assert np.abs(trajectory.acceleration).max() * weak.inertia <= 1.0


def test_a_chirp_beyond_the_bandwidth_is_filtered_at_it_or_refused():
    slow = Device("slow", bandwidth=2.0)
    trajectory = generate(Protocol(profile="sine", chirp_amplitude=0.1, device=slow))
    assert trajectory.adaptation is not None
    assert trajectory.adaptation.cutoff_hz == 2.0
    with pytest.raises(InputError, match=r"reaches 4\.77 Hz, 2\.39 times the 2 Hz that slow"):
        generate(Protocol(profile="sine", chirp_amplitude=0.1, device=slow, adapt=False))


def test_low_pass_has_its_gain_and_no_phase_shift():
    rate, cutoff, frequency = 500.0, 2.0, 3.0
    t = np.arange(0.0, 10.0 + 0.5 / rate, 1 / rate)
    wave = np.cos(2 * np.pi * frequency * t)
    filtered, velocity, _ = low_pass(spectrum_of(wave), cutoff, rate)
    gain = 1 / np.sqrt(1 + (frequency / cutoff) ** 2)
    np.testing.assert_allclose(filtered, gain * wave, atol=1e-9)
    omega = 2 * np.pi * frequency
    np.testing.assert_allclose(velocity, -gain * omega * np.sin(omega * t), atol=1e-7)


def test_unknown_or_impossible_device():
    with pytest.raises(InputError, match="device 'hercules' is not known; use one of: achilles"):
        named_device("hercules")
    with pytest.raises(InputError, match="device 'x': max_velocity is 0; use more than 0"):
        Device("x", max_velocity=0)
