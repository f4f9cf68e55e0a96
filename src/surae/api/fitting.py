"""Fits: made from recordings, read from a file."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Unpack

from surae.api.fitted import Fit
from surae.api.given import AnyRecording, contraction_in, each_in, several
from surae.api.recordings import checks_for, explained, left_out
from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.base.progress import SearchProgress, line_of_progress
from surae.base.setting import takes
from surae.inference import make_problem, solve
from surae.inference.judging.assessed import outdated
from surae.inference.judging.assessment import assess
from surae.inference.least_squares.starts import Follow
from surae.inference.saved.fit_json import load_saved
from surae.model.kernel_cache import on_compilation
from surae.model.laboratory import AUTO
from surae.quality import Quality
from surae.quality.maximum import with_maximum
from surae.quality.position import is_perturbed
from surae.quality.used import used
from surae.recording import Recording
from surae.settings import FIT_RECORDS, FitSettings
from surae.signals import ModelInputs, Weighting
from surae.signals.windows import prepared_parts

if TYPE_CHECKING:
    from surae.api.keywords import FitKeywords

#: Has a function's ``**keywords`` stand for all settings of a fit.
asks_as_fit = takes(*FIT_RECORDS, defaults=False)

#: What is said while a fit is judged, once its search has ended.
JUDGING = "judging what it is worth"


@asks_as_fit
def fit(
    recordings: AnyRecording | Sequence[AnyRecording],
    model: str | FitSettings = AUTO,
    *,
    mvc: AnyRecording | Sequence[AnyRecording] = (),
    quality: Sequence[Quality] | None = None,
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
    exclude: Sequence[tuple[float, float]] = (),
    **keywords: "Unpack[FitKeywords]",
) -> Fit:
    """Estimate a model's parameters from one recording, or from several together.

    ``surae.fit("trial.csv")`` is all that most need; its `summary` says what was found.

    >>> fit = surae.fit("trial.csv")  # any supported format
    >>> fit["l0_tri"].ci95, fit.measures()["end_stiffness"]
    >>> together = surae.fit(["a.csv", "b.csv"], model="muscle", fixed={"beta": 1.0})

    Parameters
    ----------
    recordings : Recording, ModelInputs, path, or a sequence of them
        Several are one joint fit with shared parameters.
    model : str or FitSettings
        ``"auto"``: muscles on compliant tendons with the laboratory's imperfections, and the
        departures of real legs that the data ask for. Or the name of one model;
        `surae.model.MODELS` lists them. Or all settings, as ``other.settings`` of
        another fit; keywords that are given too go before it.
    mvc : Recording, ModelInputs, path, or a sequence of them
        Maximum voluntary contractions, for ``normalise="mvc"``.
    quality : sequence of Quality, optional
        What `surae.check` found in the recordings; by default they are checked here.
    progress : callable, optional
        Called after every start with (done, starts, best sum of squares). Without it and `follow`,
        a line of a terminal or notebook says how far it is.
    follow : callable, optional
        Called with every better point on the way: (model, all its parameters, what is made small).
        That is the sum of squares [Nm²]; of auto −2 ln p but for a constant, which is another one
        at every stage of its search.
    exclude : sequence of (float, float), optional
        Starts and ends [s, of each recording's own time axis] of stretches that do not count, as
        ``--exclude`` of the command line: ``[(2.0, 5.5)]``.
    {settings}

    Returns
    -------
    Fit
        Ctrl-C keeps the best so far; `status` and `message` say so.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    settings = without(FitSettings.of(model, **keywords), exclude)
    measured = [one for recording in several(recordings) for one in each_in(recording)]
    inputs = inputs_for(settings, measured, [contraction_in(each) for each in several(mvc)])
    if quality is None:
        quality = checks_for(settings, measured)
    if progress is not None or follow is not None:
        return fit_inputs(inputs, settings, tuple(quality), progress, follow)
    with (
        line_of_progress("fitting") as tell,
        on_compilation(lambda: tell("compiling the model, once for this installation")),
    ):
        return fit_inputs(
            inputs, settings, tuple(quality), tell, lambda *_: tell(), judging=lambda: tell(JUDGING)
        )


def without(settings: FitSettings, exclude: Sequence[tuple[float, float]]) -> FitSettings:
    """Settings in which these stretches [s] do not count, beside what they have of weights."""
    if not exclude:
        return settings
    weights = Weighting() if settings.weights is None else settings.weights
    if isinstance(weights, Weighting):
        return replace(settings, weights=weights.excluding(exclude))
    return replace(settings, weights=tuple(each.excluding(exclude) for each in weights))


def inputs_for(
    settings: FitSettings,
    recordings: Sequence[Recording | ModelInputs],
    mvc: Sequence[Recording | ModelInputs] = (),
) -> Sequence[ModelInputs]:
    """What settings make of recordings; an error says too what is wrong with their units.

    One with gaps is fitted in parts, each of them inputs of its own, and one that lasts very long
    is thinned to windows, which stay one; see `surae.signals.windows`.

    Raises
    ------
    InputError
        A recording cannot be prepared as the settings ask.
    """
    for each in recordings:
        if isinstance(each, Recording) and is_perturbed(used(each, left_out(settings))[0]):
            raise InputError(
                f"{each.where}: small random perturbations, from which no model of muscles is "
                "fitted; use surae impedance, which tells tissue from reflex"
            )
    try:
        return prepared_parts(
            recordings,
            lambda parts: _met(settings, recordings, parts).inputs(parts, mvc),
            family=settings.model == AUTO,
        )
    except InputError as error:
        raise explained(error, recordings) from None


def _met(
    settings: FitSettings,
    recordings: Sequence[Recording | ModelInputs],
    parts: Sequence[Recording | ModelInputs],
) -> FitSettings:
    """The settings without what is asked of stretches between windows of long recordings."""
    weights = settings.weights
    if not isinstance(weights, Weighting) or len(parts) == len(recordings):
        return settings

    def in_any(stretch: tuple[float, float, float], of: Sequence[Recording | ModelInputs]) -> bool:
        return any(stretch[0] <= last and stretch[1] >= first for first, last in map(_span, of))

    met = tuple(w for w in weights.windows if in_any(w, parts) or not in_any(w, recordings))
    return replace(settings, weights=replace(weights, windows=met))


def _span(recording: Recording | ModelInputs) -> tuple[float, float]:
    """First and last time [s]."""
    if isinstance(recording, Recording):
        return recording.shared
    return float(recording.time[0]), float(recording.time[-1])


def fit_inputs(
    inputs: Sequence[ModelInputs],
    settings: FitSettings,
    quality: Sequence[Quality] = (),
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
    *,
    judging: Callable[[], object] | None = None,
) -> Fit:
    """The fit of recordings that `inputs_for` has prepared; all else is as of `fit`.

    `judging` is called once the search has ended and the fit is judged, which takes its time too.
    """
    quality = with_maximum(quality, inputs)
    problem = make_problem(inputs, settings)
    result = solve(problem, progress=progress, follow=follow)
    if judging is not None:
        judging()
    return Fit(result, assess(result, alternatives=True, quality=quality), tuple(quality))


def load(path: PathLike) -> Fit:
    """Read a fit that was saved; equal to the one saved, its verdicts as they were given.

    Where this version would judge otherwise, a warning and `Assessment.differs` say so;
    `Fit.reassess` renews the verdicts.

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

    Examples
    --------
    >>> surae.load("fit.json").values["l0_tri"]
    """
    saved = load_saved(path)
    if saved.assessment.differs:
        text = f"{shown(path)}: {outdated(saved.assessment)}"
        warnings.warn(text, stacklevel=2)
    return Fit(saved.result, saved.assessment, saved.quality)
