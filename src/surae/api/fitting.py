"""Fits: made from recordings, read from a file."""

from collections.abc import Mapping, Sequence
from typing import Any

from surae.api.fitted import Fit
from surae.api.quality import check
from surae.api.recordings import AnyRecording, as_inputs, read_in, several
from surae.api.recordings import normalise as normalise_emg
from surae.assessment.assess import assess
from surae.assessment.saved.baseline_json import load_baseline
from surae.assessment.saved.fit_json import load_saved
from surae.assessment.uncertainty.snsem import Baseline, check_baseline
from surae.errors import InputError
from surae.estimation import STARTS, fit_problem, fit_robust, make_problem
from surae.estimation.fit import Progress
from surae.estimation.starts import Follow
from surae.files import PathLike
from surae.model import ModelOptions
from surae.quality import Quality
from surae.signals import ModelInputs, Weighting, weighted

#: Median and spread of a parameter's prior by name.
Priors = Mapping[str, tuple[float, float]]


def fit(
    recordings: AnyRecording | Sequence[AnyRecording],
    model: str = "muscle",
    *,
    fixed: Mapping[str, float] | None = None,
    free: Sequence[str] = (),
    start: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    priors: Priors | str | tuple[str, Priors] | None = None,
    weights: Weighting | Sequence[Weighting] | None = None,
    loss: str | None = None,
    baseline: Baseline | PathLike | None = None,
    prepared: bool = False,
    normalise: str | None = None,
    mvc: AnyRecording | Sequence[AnyRecording] = (),
    starts: int = STARTS,
    seed: int = 0,
    quality: Sequence[Quality] | None = None,
    progress: Progress | None = None,
    follow: Follow | None = None,
    **options: Any,
) -> Fit:
    """Estimate a model's parameters from one recording, or from several together.

    Parameters
    ----------
    recordings : Recording, ModelInputs, path, or a sequence of them
        Several are one joint fit with shared parameters.
    model : str
        Name of the model; `surae.model.MODELS` lists them.
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
    weights : Weighting, or sequence of Weighting, optional
        What samples count, for all recordings or one for each, e.g. ``Weighting(peaks=9)``.
    loss : {"huber", "soft-l1", "tukey"}, optional
        Let outliers count less than their square; see `surae.estimation.fit_robust`.
    baseline : Baseline or path, optional
        Simulations to compare the standard errors with (snSEM, thesis 2.7).
    prepared : bool
        The signals are filtered and at the model's rate already: use them as they are.
    normalise : {"session", "mvc"}, optional
        Divide EMG by one number for each muscle, so that weights g come out in N: by the largest
        envelope of all recordings, or of `mvc`. `validate` and `Fit.predict` use it again.
    mvc : Recording, ModelInputs, path, or a sequence of them
        Maximum voluntary contractions, for ``normalise="mvc"``.
    starts : int
        Number of starts; the first from the default, the others random within the bounds.
    seed : int
        Seed of the random starts.
    quality : sequence of Quality, optional
        What `surae.check` found in the recordings; by default they are checked here.
    progress : callable, optional
        Called after every start with (done, starts, best sum of squares).
    follow : callable, optional
        Called with every better point on the way: (model, all its parameters, sum of squares).
    **options
        Model options, see `surae.model.ModelOptions`, e.g. ``geometry="virtual-work"``.

    Returns
    -------
    Fit
        Ctrl-C keeps the best so far; `status` and `message` say so.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    given = [read_in(one) for one in several(recordings)]
    inputs: Sequence[ModelInputs] = [as_inputs(one, prepared) for one in given]
    if normalise is not None:
        inputs = normalise_emg(inputs, normalise, mvc=mvc, prepared=prepared)
    elif several(mvc):
        raise InputError("mvc has no effect without normalise='mvc'; give both")
    population, known = priors if isinstance(priors, tuple) else (None, priors)
    if isinstance(known, str):
        population, known = known, None
    problem = make_problem(
        inputs if weights is None else weighted(inputs, weights),
        model,
        fixed=fixed,
        free=free,
        start=start,
        bounds=bounds,
        priors=known,
        population=population,
        options=ModelOptions.of(**options),
    )
    compared = baseline if isinstance(baseline, Baseline | None) else load_baseline(baseline)
    if compared is not None:
        check_baseline(compared, problem)
    if loss is None:
        result = fit_problem(problem, starts=starts, seed=seed, progress=progress, follow=follow)
    else:
        result = fit_robust(
            problem, loss, starts=starts, seed=seed, progress=progress, follow=follow
        )
    found = tuple(check(one) for one in given) if quality is None else tuple(quality)
    return Fit(result, assess(result, compared), found)


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
    return Fit(saved.result, assess(saved.result, saved.baseline), saved.quality)
