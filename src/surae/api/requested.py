"""Legs, device, range and movement that a request names."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from surae.api.fitted import Fit
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.names import TELLING
from surae.base.requests import LegSettings
from surae.base.setting import settings_of
from surae.model import ModelOptions
from surae.nerve.movements import telling
from surae.planning.expectation import NOISE
from surae.planning.legs import Legs, fit_legs, noise_of, population_legs
from surae.planning.ready import ready_protocols
from surae.protocol import (
    DEVICES,
    PROFILES,
    Device,
    Protocol,
    Trajectory,
    allowed_range,
    generate,
    named_device,
    read_device,
    read_protocol,
)


def range_of(
    device: Device | None,
    wanted: tuple[float, float] | None,
    population: str | None,
    fit: Fit | None,
) -> tuple[float, float]:
    """Over which angles: the requested ones, or what the fitted leg was seen to reach."""
    if wanted is not None:
        return allowed_range(device, (float(wanted[0]), float(wanted[1])))
    if fit is not None:
        angles = [i.angle for i in fit.result.problem.inputs]
        low = min(float(a.min()) for a in angles)
        high = max(float(a.max()) for a in angles)
        reach = (low, high) if device is None else device.angle_range or (low, high)
        return allowed_range(device, (max(low, reach[0]), min(high, reach[1])))
    if population == "patient":
        raise InputError(
            "a patient's range is not that of a healthy leg: measure it, and give it as --range "
            "LOW:HIGH in rad (angle_range= in Python)"
        )
    return allowed_range(device)


def as_device(device: str | PathLike | Device | None) -> Device | None:
    """The device of a name or a TOML file; None is none."""
    if device is None or isinstance(device, Device):
        return device
    if str(device) in DEVICES or not str(device).lower().endswith(".toml"):
        return named_device(str(device))
    return read_device(device)


#: Legs by which the torque of a ready protocol is held to a device's.
_CHECKED = 40
S = TypeVar("S", bound=LegSettings)


def muscles_of(film: str | Sequence[str]) -> tuple[str, ...]:
    """Names of muscles, one or several, or with commas between."""
    return tuple(filter(None, film.split(","))) if isinstance(film, str) else tuple(film)


def parted(kind: type[S], keywords: Mapping[str, Any]) -> tuple[S, ModelOptions]:
    """Settings and switches of the model, of keywords for both."""
    settings = {each.name for each, _ in settings_of(kind)}
    switches = {name: value for name, value in keywords.items() if name not in settings}
    return kind(**{k: v for k, v in keywords.items() if k in settings}), ModelOptions.of(**switches)


def as_trajectory(protocol: str | PathLike | Trajectory) -> Trajectory:
    """The trajectory of a file or a name."""
    if isinstance(protocol, Trajectory):
        return protocol
    if isinstance(protocol, str) and (protocol in TELLING or protocol in ready_protocols()):
        device = named_device("achilles")
        made = telling if protocol in TELLING else ready_trajectory
        return made(protocol, device, allowed_range(device), 256.0)
    if isinstance(protocol, str) and protocol in PROFILES:
        passive = PROFILES[protocol].duration <= 11.0
        return generate(Protocol(profile=protocol, task="passive" if passive else "part-passive"))
    return read_protocol(protocol)


def ready_trajectory(
    name: str, device: Device | None, angle_range: tuple[float, float], rate_hz: float
) -> Trajectory:
    """A designed protocol that comes with surae, on a device whose torque no leg exceeds."""
    ready = ready_protocols()[name]
    legs = population_legs(ready.model, None, _CHECKED)
    return ready.trajectory(device, angle_range, rate_hz, legs)


def requested_legs(
    settings: LegSettings,
    fit: Fit | None,
    count: int,
    options: ModelOptions,
    rate_hz: float,
    *,
    first: int = 0,
) -> tuple[Legs, float]:
    """Whose legs are meant, so many of them, and the noise of their torque."""
    if fit is None:
        who = population_legs(
            settings.model,
            settings.population,
            count,
            first=first,
            nuisances=settings.nuisances,
            options=options,
        )
        return who, settings.noise or NOISE
    if settings.population is not None:
        raise InputError("give a population or a fit, not both")
    who = fit_legs(fit, count, seed=first)
    return who, settings.noise or noise_of(fit.result, rate_hz)
