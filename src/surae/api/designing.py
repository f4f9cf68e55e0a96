"""Protocols: what one will tell, designed for a device, and what to measure after a fit."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from surae.api.fitted import Fit
from surae.api.fitting import load
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.formatting import check_known
from surae.base.frozen import FrozenDict
from surae.base.names import EFFORTS, TELLING
from surae.base.progress import Progress, SearchProgress
from surae.base.requests import DesignSettings, ExpectSettings, LegSettings
from surae.base.setting import Setting, checked, renamed, settings_of, takes
from surae.model import ModelOptions
from surae.model.joint import ANKLE
from surae.model.laboratory import AUTO
from surae.nerve.expected import expects, series
from surae.nerve.movements import telling
from surae.planning.aimed import detectable
from surae.planning.at_rest import expected_at_rest
from surae.planning.design import Asked, Design, Judges, make_design
from surae.planning.expectation import NOISE, ExpectedMeasure, expected
from surae.planning.information import filmed
from surae.planning.legs import Legs, fit_legs, noise_of, population_legs
from surae.planning.next import NextTrial, fit_precision, measure_next_of
from surae.planning.ready import ready_protocols, start_for
from surae.planning.search import SearchBudget, make_aim
from surae.planning.session import SessionPlan, best_session
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
from surae.quality.position import perturbing

#: Legs that a design is searched for, of a rigid and of a compliant model, and those that it is
#: judged by.
_SEARCHED = 8
_SEARCHED_COMPLIANT = 5
_JUDGED = 40
#: Plans that are judged in a search, likewise.
_EVALUATIONS = 8000
_EVALUATIONS_COMPLIANT = 10_000
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
        _range_of(limits, settings.angle_range, settings.population, who),
        effort,
        settings.aim,
    )
    known = None if after is None else precision["known"]
    most = settings.evaluations or (_EVALUATIONS if rigid else _EVALUATIONS_COMPLIANT)
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
    through = _range_of(limits, angle_range, population, None)
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
        angle_range=_range_of(limits, angle_range, None, fit),
        longest=duration,
        wanted=wanted,
    )


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


@takes(ExpectSettings, ModelOptions)
def expect(
    protocol: str | PathLike | Trajectory,
    model: str = AUTO,
    *,
    fit: Fit | PathLike | None = None,
    progress: Progress | None = None,
    **keywords: Any,
) -> Any:
    """Standard errors, intervals and verdicts that a protocol will give, over many legs.

    They come from the information matrix (the bound of Cramér and Rao), by exact sensitivities of
    the torque at virtual legs; no fit is made. What no model can describe is not in them.

    Of small random perturbations, and of series of stretches where no model is named, it says what
    `surae.impedance` and `surae.stretches` will find, by estimates from made recordings.

    Parameters
    ----------
    protocol : path, name or Trajectory
        A protocol as CSV, as `surae protocol` writes it; or the name of one: its movement as it is,
        without the limits of a device (a designed one: on Achilles).
    model : str
        Name of a model; ``"auto"``: muscles on compliant tendons with all that the laboratory
        cannot rule out, under its priors.
    fit : Fit or path, optional
        Instead of a population: one leg, as far as this fit knows it, which counts too; model and
        noise are then the fit's. Of perturbations, what `surae.impedance` saved.
    progress : callable, optional
        Of perturbations and stretches: called with (done, total) made recordings.
    {settings}

    Returns
    -------
    Expectation or NerveExpectation
        By parameter, and in all; or by measure, and which reflexes would be seen.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.

    Examples
    --------
    >>> surae.expect("sine", "muscle", legs=4).parameters["k_tib"].relative_sem
    """
    trajectory = as_trajectory(protocol)
    small = perturbing(trajectory.angle, trajectory.settings.rate_hz)
    if small or (model == AUTO and series(trajectory)):
        if given := ["model"] * (model != AUTO) or sorted(keywords.keys() - {"noise"}):
            what = f"{trajectory.settings.profile}: from perturbations and stretches no model of"
            raise InputError(f"{what} muscles is expected; leave {given[0]} out")
        if isinstance(fit, Fit):
            raise InputError("of perturbations, give the I.json of surae impedance, not a fit")
        return expects(trajectory, fit, progress=progress, **keywords)
    fit = fit if fit is None or isinstance(fit, Fit) else load(fit)
    settings, options = parted(ExpectSettings, {"model": model, **keywords})
    who, level = requested_legs(settings, fit, settings.legs, options, trajectory.settings.rate_hz)
    legs = filmed(who, muscles_of(settings.film))
    precision = {} if fit is None else fit_precision(fit, legs)
    made = expected(trajectory, legs, level, **precision)
    return replace(
        made,
        at_rest=expected_at_rest(trajectory, legs, level),
        measures=_measures_expected(trajectory, legs, level, precision),
    )


def _measures_expected(
    trajectory: Trajectory, legs: Legs, level: float, precision: Mapping[str, Any]
) -> FrozenDict[str, ExpectedMeasure]:
    """What is expected of measures; nothing of a model, or another joint, that has none of them."""
    if legs.options.anatomy != ANKLE:
        return FrozenDict()
    try:
        told = detectable(trajectory, legs, level, precision.get("known"))
    except InputError:
        return FrozenDict()
    return FrozenDict({name: ExpectedMeasure(*each) for name, each in told.items()})


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
