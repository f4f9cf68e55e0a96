"""Protocols designed for a device, sessions planned, and what to measure after a fit."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from surae.api.fitted import Fit
from surae.api.requested import as_device, muscles_of, parted, range_of, requested_legs
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.formatting import check_known
from surae.base.names import EFFORTS
from surae.base.progress import SearchProgress
from surae.base.requests import DesignSettings, LegSettings
from surae.base.setting import Setting, checked, renamed, takes
from surae.model import ModelOptions
from surae.model.laboratory import AUTO
from surae.planning.design import Asked, Design, Judges, make_design
from surae.planning.information import filmed
from surae.planning.next import NextTrial, fit_precision, measure_next_of
from surae.planning.ready import ready_protocols, start_for
from surae.planning.search import SearchBudget, make_aim
from surae.planning.session import SessionPlan, best_session
from surae.protocol import Device

#: Legs that a design is searched for, of a rigid and of a compliant model, and those that it is
#: judged by.
_SEARCHED = 8
_SEARCHED_COMPLIANT = 5
_JUDGED = 40
#: Plans that are judged in a search, likewise; with all that the laboratory cannot rule out a plan
#: takes eight times as long as of the rigid model, and the search as long as of that.
_EVALUATIONS = 8000
_EVALUATIONS_COMPLIANT = 10_000
_EVALUATIONS_AUTO = 1000
#: Seeds of the legs of the search come before those of every expectation.
_SEARCH_SEEDS = -500_000


@renamed(range="angle_range")
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

    Examples
    --------
    >>> surae.design(20.0, seed=1, evaluations=20).write("p.csv")
    """
    settings, options = parted(DesignSettings, {"duration": duration, **keywords})
    if fit is not None and after is not None:
        raise InputError("give fit or after, not both: after counts what the fit knows, too")
    who = fit if after is None else after
    chosen = settings.model if who is None else who.result.problem.spec.name
    rigid = chosen == "muscle"
    count = _SEARCHED if rigid else _SEARCHED_COMPLIANT
    first = _SEARCH_SEEDS if who is None else 1
    rate_hz = settings.rate_hz
    effort = settings.effort == "levels"
    legs, level = requested_legs(settings, who, count, options, rate_hz, first=first)
    unseen, _ = requested_legs(settings, who, _JUDGED, options, rate_hz)
    legs, unseen = (filmed(each, muscles_of(settings.film)) for each in (legs, unseen))
    limits = as_device(device)
    precision = {} if who is None else fit_precision(who, unseen)
    asked = Asked(
        f"design of {duration:g} s",
        float(duration),
        rate_hz,
        limits,
        range_of(limits, settings.angle_range, settings.population, who),
        effort,
        settings.aim,
    )
    known = None if after is None else precision["known"]
    usual = _EVALUATIONS if rigid else _EVALUATIONS_COMPLIANT
    most = settings.evaluations or (_EVALUATIONS_AUTO if chosen == AUTO else usual)
    return make_design(
        asked,
        Judges(legs, unseen, level, known, precision),
        SearchBudget(most, settings.seed, progress),
        start_for(duration, AUTO if chosen == AUTO else chosen, settings.aim, effort),
    )


#: Trials of a session that are planned, and legs that it is planned by.
_TRIALS = {"active": "compliant-35", "passive": "relaxed-35"}
_PLANNED = 8


@renamed(range="angle_range")
def plan_session(
    minutes: float = 10.0,
    *,
    device: str | PathLike | Device | None = "achilles",
    population: str | None = None,
    angle_range: tuple[float, float] | None = None,
    effort: str = EFFORTS[0],
    noise: float | None = None,
    aim: str = "",
) -> SessionPlan:
    """Plan steps and trials that make most of a leg known in so many minutes.

    Steps are those that a ``session.toml`` may state: the empty device, the axis, the leg's own
    geometry, one muscle at a time; trials are designed ones that come with surae. What is expected
    is the bound of Cramér and Rao, as `expect` has it, with the nuisances of ``model="auto"``.

    Parameters
    ----------
    minutes : float
        Of the leg's time.
    device : str, path, Device or None
        What is to move the leg.
    population : {"healthy", "patient"}, optional
        Whose legs; by default as many of each.
    angle_range : (float, float), optional
        The subject's full plantarflexion and dorsiflexion [rad]; required for patients.
    effort : {"levels", "none"}
        What the subject can do.
    noise : float, optional
        Of the torque [Nm], sample by sample at 256 Hz; by default 0.5.
    aim : str
        Names of parameters and measures with commas between, or ``"change in NAME"``: what is to
        be known best; by default as many parameters as can be.

    Returns
    -------
    SessionPlan
        Steps in their order, what each adds, and what leaving it out costs.

    Raises
    ------
    InputError
        Something given is unusable, or no trial fits into the time.

    Examples
    --------
    >>> surae.plan_session(6.0).steps[0].name
    """
    minutes = checked("minutes", minutes, Setting(meaning="", above=0.0, most=240.0), whole=False)
    check_known("effort", EFFORTS, effort)
    asked = LegSettings(population=population, noise=noise)
    legs, level = requested_legs(asked, None, _PLANNED, ModelOptions(), 256.0)
    limits = as_device(device)
    through = range_of(limits, angle_range, population, None)
    trials = {
        kind: ready_protocols()[name].trajectory(limits, through, 256.0, legs)
        for kind, name in _TRIALS.items()
        if effort == EFFORTS[0] or kind == "passive"
    }
    ends = np.degrees(next(iter(trials.values())).angle)
    moved = float(np.quantile(ends, 0.01)), float(np.quantile(ends, 0.99))
    return best_session(trials, legs, level, minutes, make_aim(aim, legs, moved) if aim else None)


@renamed(range="angle_range")
def measure_next(
    fit: Fit,
    *,
    device: str | PathLike | Device | None = "achilles",
    duration: float = 60.0,
    angle_range: tuple[float, float] | None = None,
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
    angle_range : (float, float), optional
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

    Examples
    --------
    >>> surae.measure_next(surae.load("fit.json")).sentences[0]
    """
    legs, level = requested_legs(LegSettings(noise=noise), fit, _SEARCHED, ModelOptions(), 256.0)
    limits = as_device(device)
    return measure_next_of(
        fit,
        legs,
        noise=level,
        device=limits,
        angle_range=range_of(limits, angle_range, None, fit),
        longest=duration,
        wanted=wanted,
    )
