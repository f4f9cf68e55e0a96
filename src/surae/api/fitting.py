"""Fits: made from recordings, read from a file."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from inspect import Parameter, signature
from typing import Any, TypeVar

from surae.api.fitted import Fit
from surae.api.quality import check, explained
from surae.api.recordings import AnyRecording, read_in, several
from surae.assessment.assess import assess
from surae.assessment.saved.fit_json import load_saved
from surae.assessment.uncertainty.snsem import Baseline, check_baseline, load_baseline
from surae.errors import InputError
from surae.estimation import FitSettings, make_problem, solve
from surae.estimation.starts import Follow
from surae.files import PathLike
from surae.model import ModelOptions
from surae.model.laboratory import AUTO
from surae.progress import SearchProgress
from surae.quality import Quality
from surae.recording import Recording
from surae.signals import ModelInputs, Weighting

#: Median and spread of a parameter's prior by name.
Priors = Mapping[str, tuple[float, float]]
F = TypeVar("F", bound=Callable[..., Any])
#: Keywords of `fit` that are settings.
_ASKED = {field.name for kind in (FitSettings, ModelOptions) for field in fields(kind)} - {"model"}


def fit(
    recordings: AnyRecording | Sequence[AnyRecording],
    model: str | FitSettings = AUTO,
    *,
    fixed: Mapping[str, float] | None = None,
    free: Sequence[str] | None = None,
    start: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    priors: Priors | str | tuple[str, Priors] | None = None,
    population: str | None = None,
    weights: Weighting | Sequence[Weighting] | None = None,
    loss: str | None = None,
    baseline: Baseline | PathLike | None = None,
    body_mass: float | None = None,
    footplate_mass: float | None = None,
    foot_share: str | None = None,
    prepared: bool | None = None,
    preparation: Mapping[str, Any] | None = None,
    normalise: str | None = None,
    mvc: AnyRecording | Sequence[AnyRecording] = (),
    nuisances: str | Mapping[str, tuple[float, float]] | None = None,
    starts: int | None = None,
    seed: int | None = None,
    geometry: str | None = None,
    tendon_strain: str | None = None,
    integrator: str | None = None,
    theta_foot: float | None = None,
    vmax_factor: float | None = None,
    x_ref_tri: float | None = None,
    x_ref_tib: float | None = None,
    emg_ref: Sequence[float] | None = None,
    options: ModelOptions | None = None,
    quality: Sequence[Quality] | None = None,
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
    **unknown: Any,
) -> Fit:
    """Estimate a model's parameters from one recording, or from several together.

    Parameters
    ----------
    recordings : Recording, ModelInputs, path, or a sequence of them
        Several are one joint fit with shared parameters.
    model : str or FitSettings
        ``"auto"``: the family of rigid and compliant tendons with the laboratory's imperfections,
        chosen by the evidence. Or the name of one model; `surae.model.MODELS` lists them. Or
        everything that is asked, as ``other.settings`` of another fit; keywords that are given too
        go before it.
    fixed : mapping of str to float, optional
        Parameters that are not estimated, e.g. ``{"beta": 1.0}``.
    free : sequence of str, optional
        Parameters to estimate beside those the model frees by itself.
    start : mapping of str to float, optional
        Where the first start begins, instead of the defaults.
    bounds : mapping of str to (float, float), optional
        Bounds instead of the defaults.
    priors : mapping of str to (float, float), str, or both as a pair, optional
        What is known of a parameter beforehand: its median, and the standard deviation of its
        logarithm (about its relative standard deviation), e.g. ``{"dlt_tib": (0.04, 0.2)}``.
        ``"healthy"`` or ``"patient"``: defaults of a population, for the parameters that have one;
        ``("healthy", {"tau_rel": (2.0, 0.5)})``: such defaults but for those given.
    population : {"healthy", "patient"}, optional
        Whose default priors stand for the parameters that `priors` does not name.
    weights : Weighting, or sequence of Weighting, optional
        What samples count, for all recordings or one for each, e.g. ``Weighting(peaks=9)``.
    loss : {"huber", "soft-l1", "tukey"}, optional
        Let outliers count less than their square; see `surae.estimation.fit_robust`.
    baseline : Baseline or path, optional
        Simulations to compare the standard errors with (snSEM, thesis 2.7).
    body_mass : float, optional
        Fixes m at the foot's share of this mass [kg]; see `surae.foot_mass`.
    footplate_mass : float, optional
        What moves with the foot [kg]; by default nothing.
    foot_share : {"winter", "de-leva-female", "de-leva-male"}, optional
        Whose share of the body's mass a foot has; by default Winter's.
    prepared : bool, optional
        True: the signals are filtered and at the model's rate already, use them as they are.
    preparation : mapping of str to object, optional
        Settings of the preparation that differ from those of `surae.Preparation`, e.g.
        ``{"bessel_hz": 10.0}``; False switches a filter off.
    normalise : {"session", "mvc"}, optional
        Divide EMG by one number for each muscle, so that weights g come out in N: by the largest
        envelope of all recordings, or of `mvc`. `validate` and `Fit.predict` use it again.
    mvc : Recording, ModelInputs, path, or a sequence of them
        Maximum voluntary contractions, for ``normalise="mvc"``.
    nuisances : {"all", "none"}, or mapping of str to (float, float), optional
        What the laboratory cannot rule out, for ``model="auto"``; a mapping gives other priors,
        mean and standard deviation, of groups or parameters, e.g. ``{"zero": (0.0, 1.0)}``.
    starts : int, optional
        Number of starts, by default 8; the first from the default, the others random within the
        bounds.
    seed : int, optional
        Seed of the random starts, by default 0.
    geometry : {"thesis", "virtual-work"}, optional
        Muscle length: equation (9) as printed, or the integral of the moment arm.
    tendon_strain : {"thesis", "slack-length"}, optional
        ε0 in metres as the printed equations take it, or a strain times the slack length.
    integrator : {"implicit", "explicit-euler"}, optional
        Of the muscle-tendon models; the explicit one is the thesis's.
    theta_foot : float, optional
        Angle of the foot to the horizontal at θ = 0 [rad], by default 0.
    vmax_factor : float, optional
        Maximum shortening speed in optimal lengths per second, by default 8.
    x_ref_tri, x_ref_tib : float, optional
        Muscle lengths at θ = 0 of the virtual-work geometry [m].
    emg_ref : four floats, optional
        EMG levels of TA, GL, SOL, GM [V] at which `emg_shape` changes nothing.
    options : ModelOptions, optional
        All of these switches at once, as ``other.settings.options``.
    quality : sequence of Quality, optional
        What `surae.check` found in the recordings; by default they are checked here.
    progress : callable, optional
        Called after every start with (done, starts, best sum of squares).
    follow : callable, optional
        Called with every better point on the way: (model, all its parameters, sum of squares).
    **unknown
        Refused, with the keywords that are known.

    Returns
    -------
    Fit
        Ctrl-C keeps the best so far; `status` and `message` say so.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    every = locals()
    keywords = {name: every[name] for name in _ASKED} | unknown
    settings = FitSettings.of(model, **keywords)
    measured = [read_in(recording) for recording in several(recordings)]
    inputs = inputs_for(settings, measured, [read_in(recording) for recording in several(mvc)])
    if quality is None:
        quality = [check(each, prepared=settings.prepared) for each in measured]
    return fit_inputs(inputs, settings, tuple(quality), baseline, progress, follow)


def asks_as_fit(function: F) -> F:
    """Have a function's ``**asked`` stand, for help and completion, for all that `fit` is asked."""
    own = signature(function)
    shared = [p for p in signature(fit).parameters.values()
              if p.name in _ASKED and p.name not in own.parameters]  # fmt: skip
    first = [p for p in own.parameters.values() if p.kind is not Parameter.VAR_KEYWORD]
    vars(function)["__signature__"] = own.replace(parameters=[*first, *shared])
    return function


def inputs_for(
    settings: FitSettings,
    recordings: Sequence[Recording | ModelInputs],
    mvc: Sequence[Recording | ModelInputs] = (),
) -> Sequence[ModelInputs]:
    """What settings make of recordings; an error says too what is wrong with their units.

    Raises
    ------
    InputError
        A recording cannot be prepared as the settings ask.
    """
    try:
        return settings.inputs(recordings, mvc)
    except InputError as error:
        raise explained(error, recordings) from None


def fit_inputs(
    inputs: Sequence[ModelInputs],
    settings: FitSettings,
    quality: Sequence[Quality] = (),
    baseline: Baseline | PathLike | None = None,
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
) -> Fit:
    """The fit of recordings that have been prepared as its settings ask.

    Parameters
    ----------
    inputs : sequence of ModelInputs
        As `FitSettings.inputs` gives them.
    settings : FitSettings
        What is asked.
    quality, baseline, progress, follow
        As of `fit`.
    """
    problem = make_problem(inputs, settings)
    compared = baseline if isinstance(baseline, Baseline | None) else load_baseline(baseline)
    if compared is not None:
        check_baseline(compared, problem)
    result = solve(problem, progress=progress, follow=follow)
    return Fit(result, assess(result, compared, alternatives=True), tuple(quality))


def load(path: PathLike) -> Fit:
    """Read a fit that was saved; equal to the one saved.

    Parameters
    ----------
    path : path
        A FIT.json.

    Returns
    -------
    Fit
        The same fit.

    Raises
    ------
    InputError
        The file is missing, damaged, or of a newer surae.
    """
    saved = load_saved(path)
    return Fit(saved.result, assess(saved.result, saved.baseline, alternatives=True), saved.quality)
