"""What a movement must keep, of a subject's range and of a device."""

from typing import NamedTuple

from surae.errors import InputError
from surae.protocol import Device, allowed_range

#: Rounding must not make a limit exceeded.
EXACT = 1.0 - 1e-9
#: Velocity [rad/s], acceleration [rad/s²] and frequency [Hz] that are not exceeded where a device's
#: own limit is not known.
UNKNOWN = (1.5, 100.0, 8.0)


class Limits(NamedTuple):
    """What a movement must keep: its range [rad], velocity [rad/s] and acceleration [rad/s²]."""

    low: float
    high: float
    velocity: float
    acceleration: float


def limits_of(device: Device | None, range_of_motion: tuple[float, float]) -> Limits:
    """What a movement over this range must keep on a device."""
    low, high = allowed_range(device, range_of_motion)
    if high - low < 0.05:
        raise InputError(f"range {low:g} … {high:g} rad is too narrow to move in; widen it")
    velocity, acceleration, _ = UNKNOWN
    if device is not None:
        velocity = device.velocity_limit if device.max_velocity is not None else velocity
        acceleration = min(device.acceleration_limit, 1e6)
        if device.max_acceleration is None and device.max_torque is None:
            acceleration = UNKNOWN[1]
    inside = (1.0 - EXACT) * (high - low)
    return Limits(low + inside, high - inside, velocity * EXACT, acceleration * EXACT)


def highest_hz(device: Device | None) -> float:
    """Highest frequency of a perturbation [Hz]."""
    return UNKNOWN[2] if device is None else min(device.frequency_limit, UNKNOWN[2])
