"""How well a protocol determines parameters, before anybody is measured."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from surae.api.fitted import Fit
from surae.errors import InputError
from surae.files import PathLike
from surae.model import ModelOptions
from surae.model.laboratory import AUTO
from surae.protocol import (
    PROFILES,
    Device,
    Protocol,
    Trajectory,
    allowed_range,
    generate,
    named_device,
    read_protocol,
)
from surae.protocol.planning.expectation import NOISE, Expectation, expected
from surae.protocol.planning.filming import filmed
from surae.protocol.planning.legs import Legs, fit_legs, population_legs
from surae.protocol.planning.ready import ready_protocols
from surae.requests import ExpectSettings, LegSettings
from surae.setting import settings_of, takes

#: Legs by which the torque of a ready protocol is held to a device's.
_CHECKED = 40
#: More samples than this, ten minutes at 2 kHz, are a slip of the keyboard.
_MOST_SAMPLES = 1_200_000
#: The motion is shaped at this rate at least [Hz], whatever rate is asked for.
_SHAPED_HZ = 2000.0
S = TypeVar("S", bound=LegSettings)


@takes(ExpectSettings, ModelOptions)
def expect(
    protocol: str | PathLike | Trajectory,
    model: str = AUTO,
    *,
    fit: Fit | None = None,
    **keywords: Any,
) -> Expectation:
    """Standard errors, intervals and verdicts that a protocol will give, over many legs.

    They come from the information matrix (the bound of Cramér and Rao), by exact sensitivities of
    the torque at virtual legs; no fit is made. What no model can describe is not in them.

    Parameters
    ----------
    protocol : path, name or Trajectory
        A protocol as CSV, as `surae protocol` writes it; or the name of one: its movement as it is,
        without the limits of a device (a designed one: on Achilles).
    model : str
        Name of a model; ``"auto"``: muscles on compliant tendons with all that the laboratory
        cannot rule out, under its priors.
    fit : Fit, optional
        Instead of a population: one leg, as far as this fit knows it; model and noise are then the
        fit's too.
    {settings}

    Returns
    -------
    Expectation
        By parameter, and in all.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    trajectory = as_trajectory(protocol)
    settings, options = parted(ExpectSettings, {"model": model, **keywords})
    rate_hz = trajectory.settings.rate_hz
    who, level = requested_legs(settings, fit, settings.legs, options, rate_hz)
    return expected(trajectory, filmed(who, muscles_of(settings.film)), level)


def muscles_of(film: str | Sequence[str]) -> tuple[str, ...]:
    """Names of muscles, one or several, or with commas between."""
    return tuple(filter(None, film.split(","))) if isinstance(film, str) else tuple(film)


def parted(kind: type[S], keywords: Mapping[str, Any]) -> tuple[S, ModelOptions]:
    """Settings and switches of the model, of keywords for both."""
    own = {each.name for each, _ in settings_of(kind)}
    switches = {name: value for name, value in keywords.items() if name not in own}
    return kind(**{k: v for k, v in keywords.items() if k in own}), ModelOptions.of(**switches)


def as_trajectory(protocol: str | PathLike | Trajectory) -> Trajectory:
    """The trajectory of a file or a name."""
    if isinstance(protocol, Trajectory):
        return protocol
    if isinstance(protocol, str) and protocol in ready_protocols():
        device = named_device("achilles")
        return ready_trajectory(protocol, device, allowed_range(device), 256.0)
    if isinstance(protocol, str) and protocol in PROFILES:
        passive = PROFILES[protocol].duration <= 11.0
        return generate(Protocol(profile=protocol, task="passive" if passive else "part-passive"))
    return read_protocol(protocol)


def protocol_trajectory(settings: Protocol) -> Trajectory:
    """The movement and the effort of a protocol, unless it is longer than anybody can mean.

    Parameters
    ----------
    settings : Protocol
        The requested protocol.

    Raises
    ------
    InputError
        It has too many samples, or the device cannot follow it.
    """
    longest = _MOST_SAMPLES / max(settings.rate_hz, _SHAPED_HZ)
    if settings.seconds > longest:
        raise InputError(
            f"{settings.seconds:g} s at {settings.rate_hz:g} Hz are too many samples; use at most "
            f"{longest:g} s at that rate"
        )
    return generate(settings)


def ready_trajectory(
    name: str, device: Device | None, range_of_motion: tuple[float, float], rate_hz: float
) -> Trajectory:
    """A designed protocol that comes with surae, on a device whose torque no leg exceeds."""
    ready = ready_protocols()[name]
    legs = population_legs(ready.model, None, _CHECKED)
    return ready.trajectory(device, range_of_motion, rate_hz, legs)


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
            settings.model, settings.population, count, first=first, nuisances=settings.nuisances,
            options=options,
        )  # fmt: skip
        return who, settings.noise or NOISE
    if settings.population is not None:
        raise InputError("give a population or a fit, not both")
    who = fit_legs(fit.result, fit.assessment, count, seed=first)
    return who, settings.noise or fit_noise(fit, rate_hz)


def fit_noise(fit: Fit, rate_hz: float) -> float:
    """White noise [Nm], sample by sample at a rate, that would tell as little as a fit's residual.

    A residual that is correlated over time tells less than its size says: what counts is its
    spectral density at the frequencies of the movement, which the believed intervals know.
    """
    result = fit.result
    density = 0.0
    for residual, inputs in zip(result.residuals, result.problem.inputs, strict=True):
        density += _slow_density(residual, inputs.rate_hz) * len(residual)
    density /= sum(len(residual) for residual in result.residuals)
    return float((density * rate_hz) ** 0.5)


def _slow_density(residual: Any, rate_hz: float) -> float:
    """Variance per Hz of sampling rate, over the frequencies below 3 Hz [Nm²/Hz]."""
    import numpy as np

    n = len(residual)
    power = np.abs(np.fft.rfft(residual - residual.mean())) ** 2 / n
    slow = np.fft.rfftfreq(n, 1.0 / rate_hz) <= 3.0
    slow[0] = False
    level = float(power[slow].mean()) if slow.any() else float(np.var(residual))
    return max(level, 1e-12) / rate_hz
