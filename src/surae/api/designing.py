"""Informative protocols: designed for a device, and what to measure after a fit."""

from collections.abc import Sequence
from typing import Any

from surae.api.expecting import muscles_of, parted, requested_legs
from surae.api.fitted import Fit
from surae.errors import InputError
from surae.files import PathLike
from surae.model import ModelOptions
from surae.model.laboratory import AUTO
from surae.progress import SearchProgress
from surae.protocol import DEVICES, Device, allowed_range, named_device, read_device
from surae.protocol.planning.design import Design, make_design
from surae.protocol.planning.filming import filmed
from surae.protocol.planning.next import NextTrial, known_from, measure_next_of
from surae.protocol.planning.ready import start_for
from surae.requests import DesignSettings, LegSettings
from surae.setting import takes

#: Legs that a design is searched for, of a rigid and of a compliant model, and those that it is
#: judged by.
_SEARCHED, _SEARCHED_COMPLIANT, _JUDGED = 8, 5, 40
#: Plans that are judged in a search, likewise.
_EVALUATIONS, _EVALUATIONS_COMPLIANT = 8000, 10_000
#: Seeds of the legs of the search come before those of every expectation.
_SEARCH_SEEDS = -500_000


@takes(DesignSettings, ModelOptions)
def design(
    duration: float = 35.0,
    *,
    device: str | PathLike | Device | None = "achilles",
    fit: Fit | None = None,
    after: Fit | None = None,
    progress: SearchProgress | None = None,
    **keywords: Any,
) -> Design:
    """Design the most informative protocol within the limits of a device and a subject.

    The same arguments give the same design. Ctrl-C keeps the best until then.

    Parameters
    ----------
    duration : float
        Of the trial [s], rests at both ends included.
    device : str, path, Device or None
        Whose limits hold: a name, a TOML file, or a `surae.protocol.Device`. None designs within
        moderate limits, and `Design.write` then asks for a reason.
    fit : Fit, optional
        Instead of a population: one leg, as far as this fit knows it.
    after : Fit, optional
        The same, and what the fit knows already counts: the trial that adds most.
    progress : callable, optional
        Called with (plans judged, of how many, best cost).
    {settings}

    Returns
    -------
    Design
        The protocol, what to expect of it, and what was given up for device and subject.

    Raises
    ------
    InputError
        Something given is unusable, or the device cannot do it: then what to give up.
    """
    settings, options = parted(DesignSettings, {"duration": duration, **keywords})
    who = _leg(fit, after)
    chosen = settings.model if who is None else who.result.problem.spec.name
    rigid = chosen == "muscle"
    count = _SEARCHED if rigid else _SEARCHED_COMPLIANT
    first = _SEARCH_SEEDS if who is None else 1
    rate_hz, effort = settings.rate_hz, settings.effort == "levels"
    legs, level = requested_legs(settings, who, count, options, rate_hz, first=first)
    unseen, _ = requested_legs(settings, who, _JUDGED, options, rate_hz)
    legs, unseen = (filmed(each, muscles_of(settings.film)) for each in (legs, unseen))
    limits = as_device(device)
    return make_design(
        name=f"design of {duration:g} s",
        seconds=float(duration),
        rate_hz=rate_hz,
        device=limits,
        range_of_motion=_range_of(limits, settings.range, settings.population, who),
        legs=legs,
        unseen=unseen,
        noise=level,
        aim=settings.aim,
        effort=effort,
        evaluations=settings.evaluations or (_EVALUATIONS if rigid else _EVALUATIONS_COMPLIANT),
        seed=settings.seed,
        known=None if after is None else known_from(after.result, after.assessment, legs),
        start=start_for(duration, AUTO if chosen == AUTO else chosen, settings.aim, effort),
        progress=progress,
    )


def measure_next(
    fit: Fit,
    *,
    device: str | PathLike | Device | None = "achilles",
    duration: float = 60.0,
    range: tuple[float, float] | None = None,
    wanted: Sequence[str] | None = None,
    noise: float | None = None,
) -> NextTrial:
    """The trial that would add most to what a fit knows, of those that come with surae.

    It takes seconds; `design` with ``after=fit`` searches a trial of its own, which takes minutes.

    Parameters
    ----------
    fit : Fit
        What is known so far.
    device : str, path, Device or None
        What is to move the leg.
    duration : float
        Longest trial that may be proposed [s].
    range : (float, float), optional
        The subject's full plantarflexion and dorsiflexion [rad]; by default what the fit's
        recordings reached.
    wanted : sequence of str, optional
        Parameters to know better; by default all that are not identified.
    noise : float, optional
        Of the torque [Nm], sample by sample at 256 Hz; by default what the residual comes to.

    Returns
    -------
    NextTrial
        In words and numbers.

    Raises
    ------
    InputError
        The fit failed, or something given is unusable.
    """
    legs, level = requested_legs(LegSettings(noise=noise), fit, _SEARCHED, ModelOptions(), 256.0)
    limits = as_device(device)
    return measure_next_of(
        fit.result, fit.assessment, legs, noise=level, device=limits,
        range_of_motion=_range_of(limits, range, None, fit), longest=duration, wanted=wanted,
    )  # fmt: skip


def _leg(fit: Fit | None, after: Fit | None) -> Fit | None:
    """The one leg that is meant; None where it is a population's."""
    if fit is not None and after is not None:
        raise InputError("give fit or after, not both: after counts what the fit knows, too")
    return fit if after is None else after


def _range_of(
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
        low, high = min(float(a.min()) for a in angles), max(float(a.max()) for a in angles)
        reach = (low, high) if device is None else device.range_of_motion or (low, high)
        return allowed_range(device, (max(low, reach[0]), min(high, reach[1])))
    if population == "patient":
        raise InputError(
            "a patient's range is not that of a healthy leg: measure it, and give it as --range "
            "LOW:HIGH in rad (range= in Python)"
        )
    return allowed_range(device)


def as_device(device: str | PathLike | Device | None) -> Device | None:
    """The device of a name or a TOML file; None is none.

    Parameters
    ----------
    device : str, path, Device or None
        Which.

    Raises
    ------
    InputError
        There is no such device, or its file cannot be read.
    """
    if device is None or isinstance(device, Device):
        return device
    if str(device) in DEVICES or not str(device).lower().endswith(".toml"):
        return named_device(str(device))
    return read_device(device)
