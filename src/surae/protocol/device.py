"""What a robot can follow (thesis 4.1.5 and 4.4)."""

import math
from dataclasses import dataclass

from surae.errors import InputError


@dataclass(frozen=True, slots=True)
class Device:
    """A manipulator; None is a limit that isn't known.

    Attributes
    ----------
    name : str
        Name in settings and files.
    max_velocity : float or None
        Highest velocity that it follows [rad/s].
    max_acceleration : float or None
        Highest acceleration [rad/s²].
    max_torque : float or None
        Highest torque [Nm].
    bandwidth : float or None
        Highest frequency that it follows [Hz].
    inertia : float
        Heaviest foot and footplate [kg m²]: moving it alone must not take more than `max_torque`.
        Default 3 kg at 0.15 m, the upper bound of the models' mass.
    chirp_amplitudes : tuple of (str, float)
        Largest chirp amplitude [rad] of profiles that have one of their own.
    """

    name: str
    max_velocity: float | None = None
    max_acceleration: float | None = None
    max_torque: float | None = None
    bandwidth: float | None = None
    inertia: float = 3.0 * 0.15**2
    chirp_amplitudes: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        """Check that every limit is above zero."""
        for name in ("max_velocity", "max_acceleration", "max_torque", "bandwidth", "inertia"):
            value = getattr(self, name)
            if value is not None and not value > 0.0:
                raise InputError(f"device {self.name!r}: {name} is {value}; use more than 0")

    @property
    def velocity_limit(self) -> float:
        """Highest velocity [rad/s], infinite if unknown."""
        return math.inf if self.max_velocity is None else self.max_velocity

    @property
    def acceleration_limit(self) -> float:
        """Highest acceleration [rad/s²] by its own limit and by the torque, infinite if unknown."""
        own = math.inf if self.max_acceleration is None else self.max_acceleration
        by_torque = math.inf if self.max_torque is None else self.max_torque / self.inertia
        return min(own, by_torque)

    @property
    def frequency_limit(self) -> float:
        """Highest frequency [Hz], infinite if unknown."""
        return math.inf if self.bandwidth is None else self.bandwidth

    def chirp_amplitude(self, profile: str, amplitude: float) -> float:
        """The amplitude [rad], lowered to the largest that goes with `profile` on this device."""
        return min(amplitude, dict(self.chirp_amplitudes).get(profile, math.inf))


#: Achilles (MOOG): overshoots from 1.5 rad/s on; 80 Nm; chirp of the multiple holds at 0.1 rad.
DEVICES: dict[str, Device] = {
    device.name: device
    for device in (
        Device(
            "achilles",
            max_velocity=1.5,
            max_torque=80.0,
            chirp_amplitudes=(("multiple-holds", 0.1),),
        ),
    )
}


def named_device(name: str) -> Device:
    """The device of that name.

    Raises
    ------
    InputError
        There is none.
    """
    if name not in DEVICES:
        raise InputError(f"device {name!r} is not known; use one of: {', '.join(DEVICES)}")
    return DEVICES[name]
