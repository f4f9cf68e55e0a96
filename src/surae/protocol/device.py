"""What a robot can follow (thesis 4.1.5 and 4.4): limits that are data, a TOML file each."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import PathLike, shown
from surae.base.formatting import named
from surae.base.plugins import Extended, plugins
from surae.base.records import OrInfinite, from_file, read_toml
from surae.base.setting import renamed


@renamed(range_of_motion="angle_range")
@filed(
    strict=True,
    max_velocity="max_velocity_rad_s",
    max_acceleration="max_acceleration_rad_s2",
    max_torque="max_torque_Nm",
    bandwidth="bandwidth_Hz",
    inertia="inertia_kg_m2",
    chirp_amplitudes="chirp_amplitudes_rad",
    angle_range="range_rad",
)
@dataclass(frozen=True, slots=True)
class Device:
    """A manipulator; a limit that isn't known is infinite, and missing or null in files."""

    name: str  #: Name in settings and files.
    max_velocity: OrInfinite = math.inf  #: Highest velocity that it follows [rad/s].
    max_acceleration: OrInfinite = math.inf  #: Highest acceleration [rad/s²].
    max_torque: OrInfinite = math.inf  #: Highest torque [Nm].
    bandwidth: OrInfinite = math.inf  #: Highest frequency that it follows [Hz].
    #: Heaviest foot and footplate [kg m²]: moving it alone must not take more than `max_torque`.
    #: Default 3 kg at 0.15 m, the upper bound of the models' mass.
    inertia: float = 3.0 * 0.15**2
    #: Largest chirp amplitude [rad] of profiles that have one of their own.
    chirp_amplitudes: tuple[tuple[str, float], ...] = ()
    angle_range: tuple[float, float] | None = None  #: Angles that it can reach [rad].
    sources: tuple[str, ...] = ()  #: Where the limits are from.

    def __post_init__(self) -> None:
        """Check that every limit is above zero."""
        for name in ("max_velocity", "max_acceleration", "max_torque", "bandwidth", "inertia"):
            value = getattr(self, name)
            if not value > 0.0:
                raise InputError(f"device {self.name!r}: {name} is {value}; use more than 0")

    @property
    def acceleration_limit(self) -> float:
        """Highest acceleration [rad/s²], by its own limit and by the torque."""
        return min(self.max_acceleration, self.max_torque / self.inertia)

    def chirp_amplitude(self, profile: str, amplitude: float) -> float:
        """The amplitude [rad], lowered to the largest that goes with `profile` on this device."""
        return min(amplitude, dict(self.chirp_amplitudes).get(profile, math.inf))


def read_device(path: PathLike) -> Device:
    """Read a device's limits from a TOML file.

    Parameters
    ----------
    path : path
        With ``name``, some of ``max_velocity_rad_s``, ``max_acceleration_rad_s2``,
        ``max_torque_Nm``, ``bandwidth_Hz``, ``inertia_kg_m2``, ``range_rad`` (low and high), and
        ``sources``: where they are from. Angles may be in degrees: ``range_deg``,
        ``max_velocity_deg_s``.

    Raises
    ------
    InputError
        The file cannot be read, or something in it is unknown, no number, or missing.
    """
    where = shown(path)
    toml = read_toml(path)
    if not toml.get("name"):
        raise InputError(f'{where}: give the device a name, e.g. name = "my robot"')
    toml = _in_radians(toml, where)
    amplitudes = toml.get("chirp_amplitudes_rad", {})
    if not isinstance(amplitudes, dict):
        raise InputError(f"{where}: chirp_amplitudes_rad must be a table of profile = rad")
    plain = {**toml, "chirp_amplitudes_rad": list(amplitudes.items())}
    device = from_file(Device, path, plain)
    span = device.angle_range
    if span is not None and not span[0] < span[1]:
        raise InputError(f"{where}: range_rad: low must be below high")
    return device


def _in_radians(toml: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The table with what it gives in degrees (``range_deg``, ``max_velocity_deg_s``) in rad."""
    made: dict[str, Any] = {}
    for key, value in toml.items():
        name = re.sub(r"_deg(?=$|_s2?$)", "_rad", key)
        if name != key and name in toml:
            raise InputError(f"{where}: {key} and {name} say the same; give one of them")
        made[name] = value if name == key else _radians(value, f"{where}: {key}")
    return made


def _radians(value: Any, where: str) -> Any:
    if isinstance(value, Mapping):
        return {key: _radians(each, where) for key, each in value.items()}
    if isinstance(value, list):
        return [_radians(each, where) for each in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{where}: {value!r} is not a number")
    return math.radians(value)


#: Full plantarflexion and dorsiflexion [rad] of a healthy leg.
TYPICAL_RANGE = (-0.9, 0.6)


def allowed_range(
    device: Device | None, requested: tuple[float, float] | None = None
) -> tuple[float, float]:
    """Angles between which a trial moves.

    Parameters
    ----------
    device : Device or None
        What is to move the leg.
    requested : (float, float), optional
        The subject's full plantarflexion and dorsiflexion [rad]; by default those of a healthy leg,
        as far as the device reaches.

    Returns
    -------
    (float, float)
        The requested range, or that default [rad].

    Raises
    ------
    InputError
        The requested range is none of an ankle, or beyond the device's.
    """
    reach = None if device is None else device.angle_range
    if requested is None:
        low, high = TYPICAL_RANGE
        if reach is not None:
            low = max(low, reach[0])
            high = min(high, reach[1])
            low, high = (low, high) if low < high else reach
        return low, high
    low, high = requested
    if not -3.0 <= low < high <= 3.0:
        raise InputError(
            f"range of motion {low:g} … {high:g} rad: full plantarflexion must be below "
            "dorsiflexion, both within ±3 rad"
        )
    if device is not None and reach is not None and not reach[0] <= low < high <= reach[1]:
        inside = max(low, reach[0]), min(high, reach[1])
        inside = inside if inside[0] < inside[1] else reach
        raise InputError(
            f"{device.name} reaches {reach[0]:g} … {reach[1]:g} rad, not {low:g} … {high:g} rad; "
            f"give up what is beyond: --range {inside[0]:g}:{inside[1]:g}"
        )
    return low, high


_FILES = Path(__file__).parent / "devices"
#: The devices that come with surae, and those of plugins, by name.
DEVICES: Mapping[str, Device] = Extended(
    {device.name: device for device in map(read_device, sorted(_FILES.glob("*.toml")))},
    lambda: plugins("devices", Device),
)


def named_device(name: str) -> Device:
    """The device of that name.

    Raises
    ------
    InputError
        There is none.
    """
    return named("device", DEVICES, name)
