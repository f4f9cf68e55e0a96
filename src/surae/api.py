"""The public functions: what the command line and Python code all call."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, overload

import numpy as np

from surae.assessment.assess import Assessment, ParameterEstimate, assess
from surae.assessment.baseline_json import load_baseline
from surae.assessment.bootstrap import REPLICATES, Bootstrap
from surae.assessment.bootstrap import Told as BootstrapTold
from surae.assessment.bootstrap import bootstrap as bootstrap_fit
from surae.assessment.chains import Told as ChainsTold
from surae.assessment.compare import COMPARED, FEW_STARTS, Told, compare_models
from surae.assessment.comparison import Comparison
from surae.assessment.emg_bias import PAIRS, EmgBias
from surae.assessment.emg_bias import emg_bias as emg_bias_of
from surae.assessment.fit_json import load_saved, save_fit
from surae.assessment.inflation import variance_inflation as inflation_of
from surae.assessment.leave_one_out import LeaveOneOut
from surae.assessment.leave_one_out import Told as LeaveOneOutTold
from surae.assessment.leave_one_out import leave_one_out as leave_one_out_of
from surae.assessment.posterior import CHAINS, DRAWS, TUNE, Posterior, sample
from surae.assessment.profiles import Profiles, profiles
from surae.assessment.profiles import Told as ProfileTold
from surae.assessment.snsem import Baseline, check_baseline
from surae.assessment.uncertainty import Covariance
from surae.assessment.validation import Prediction, predict_others
from surae.errors import InputError
from surae.estimation import STARTS, FitResult, fit_problem, fit_robust, make_problem
from surae.estimation.fit import Progress
from surae.files import PathLike
from surae.model import (
    MODELS,
    ModelOptions,
    ModelSpec,
    Simulator,
    TendonState,
    TorqueParts,
    check_finite_torque,
    get_model,
)
from surae.recording import Recording, read
from surae.signals import ModelInputs, Weighting, prepare, weighted
from surae.units import FloatArray

#: A recording in any form: read, prepared, or the path of its file.
AnyRecording = Recording | ModelInputs | PathLike
#: Median and spread of a parameter's prior by name.
Priors = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, slots=True)
class Fit:
    """A fit and what it is worth.

    Attributes
    ----------
    result : FitResult
        What was found: values, residuals, every start.
    assessment : Assessment
        What it is worth: intervals, correlations, verdicts.
    """

    result: FitResult
    assessment: Assessment

    @property
    def parameters(self) -> Mapping[str, ParameterEstimate]:
        """Every parameter of the model by name: value, sem, ci95, verdict and more."""
        return self.assessment.parameters

    @property
    def values(self) -> Mapping[str, float]:
        """Every parameter's value by name, ready for `simulate`."""
        return self.result.values

    @property
    def status(self) -> str:
        """``"converged"``, ``"at-bounds"`` or ``"failed"``."""
        return self.result.status

    @property
    def message(self) -> str:
        """What happened, with advice where it failed."""
        return self.result.message

    @property
    def vaf(self) -> float:
        """Variance accounted for over all recordings, equation (31) [%]."""
        return self.assessment.vaf

    @property
    def vaf_weighted(self) -> float | None:
        """VAF with the samples counted as the fit did; None where all count alike [%]."""
        return self.assessment.vaf_weighted

    @property
    def snsem(self) -> Mapping[str, float | None]:
        """Standard errors over those of simulations; empty without a baseline."""
        return self.assessment.snsem

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the estimates named in `covariance.names`, shape (k, k)."""
        return self.assessment.covariance.correlation

    @property
    def covariance(self) -> Covariance:
        """Names and covariance matrix of the estimates that have one, equation (33)."""
        return self.assessment.covariance

    @property
    def ipde(self) -> float | None:
        """Inter-parameter dependency, equation (35); None where there is none."""
        return self.assessment.ipde

    def parts(self, recording: int = 0) -> TorqueParts:
        """The modelled torque of the fit's first, second, … recording, split into its parts.

        Raises
        ------
        InputError
            The fit has no such recording.
        ComputationError
            The torque is not finite, as in a fit that failed at its start.
        """
        problem = self.result.problem
        inputs = self._recording(recording)
        return _parts(problem.spec, self.values, inputs, problem.options)

    def tendon(self, recording: int = 0) -> TendonState:
        """What muscles and tendons do in the fit's first, second, … recording.

        Raises
        ------
        InputError
            The fit has no such recording, or its model has rigid tendons.
        """
        problem = self.result.problem
        inputs = self._recording(recording)
        return _tendon(problem.spec, self.values, inputs, problem.options)

    def _recording(self, number: int) -> ModelInputs:
        inputs = self.result.problem.inputs
        if number not in range(len(inputs)):
            known = "only 0" if len(inputs) == 1 else f"0 … {len(inputs) - 1}"
            raise InputError(f"the fit has no recording {number!r}; they are numbered {known}")
        return inputs[number]

    def predict(self, recording: AnyRecording, *, prepared: bool | None = None) -> Prediction:
        """Predict the torque of another recording, and how well it does (thesis 2.7).

        Parameters
        ----------
        recording : Recording, ModelInputs or path
            With its measured torque.
        prepared : bool, optional
            Whether its signals are used as they are; by default as they were in the fit.
        """
        return validate(self, [recording], prepared=prepared)[0]

    def save(self, path: PathLike) -> None:
        """Write FIT.json; `load` reads it back without loss."""
        save_fit(path, self.result, self.assessment)

    def report(self, path: PathLike, *, validation: Sequence[Prediction] = ()) -> None:
        """Write the report, one self-contained HTML file.

        Parameters
        ----------
        path : path
            Where to.
        validation : sequence of Prediction, optional
            Predictions of other recordings to show, as `validate` makes them.
        """
        from datetime import datetime

        from surae.report import write_report

        now = datetime.now().astimezone()
        write_report(
            path,
            self.result,
            self.assessment,
            versions=self.result.versions,
            created=now,
            predictions=validation,
        )


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
    starts: int = STARTS,
    seed: int = 0,
    progress: Progress | None = None,
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
    starts : int
        Number of starts; the first from the default, the others random within the bounds.
    seed : int
        Seed of the random starts.
    progress : callable, optional
        Called after every start with (done, starts, best sum of squares).
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
    inputs: Sequence[ModelInputs] = [_inputs(one, prepared) for one in _several(recordings)]
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
        result = fit_problem(problem, starts=starts, seed=seed, progress=progress)
    else:
        result = fit_robust(problem, loss, starts=starts, seed=seed, progress=progress)
    return Fit(result, assess(result, compared))


def compare(
    recordings: AnyRecording | Sequence[AnyRecording],
    models: Sequence[str] = COMPARED,
    *,
    fixed: Mapping[str, float] | None = None,
    prepared: bool = False,
    starts: int = FEW_STARTS,
    seed: int = 0,
    progress: Told | None = None,
    **options: Any,
) -> Comparison:
    """Rigid or elastic: whether the data need tendons that give way, and what it changes.

    Every model is fitted to all data, and again without each recording in turn (of a single one:
    each quarter in turn), which it then predicts. `Comparison.rule` says how the finding follows.

    Parameters
    ----------
    recordings : Recording, ModelInputs, path, or a sequence of them
        Several share all parameters.
    models : sequence of str
        At least one without tendons and one with.
    fixed : mapping of str to float, optional
        Parameters that are not estimated, by every model that has them.
    prepared : bool
        The signals are filtered and at the model's rate already: use them as they are.
    starts : int
        Number of starts of each fit to all data.
    seed : int
        Seed of the random starts.
    progress : callable, optional
        Called before every fit with (what it is, fits done, all fits).
    **options
        Model options, see `surae.model.ModelOptions`, e.g. ``tendon_strain="slack-length"``.

    Returns
    -------
    Comparison
        Ctrl-C keeps the fits that are complete; `missing` names the others.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    return compare_models(
        [_inputs(one, prepared) for one in _several(recordings)],
        models,
        fixed=fixed,
        options=ModelOptions.of(**options),
        starts=starts,
        seed=seed,
        progress=progress,
    )


def profile(
    fitted: Fit,
    names: str | Sequence[str] | None = None,
    *,
    variance_inflation: float | Mapping[str, float] | None = None,
    workers: int | None = None,
    progress: ProfileTold | None = None,
) -> Profiles:
    """Profile likelihood: intervals that need not be symmetric, nor end where the data set no end.

    Parameters
    ----------
    fitted : Fit
        The fit.
    names : str or sequence of str, optional
        Parameters that it estimated; all of them by default.
    variance_inflation : float or mapping of str to float, optional
        Divides Δχ², of all or of each parameter. By default what the assessment asks for: each
        parameter's own (sem_robust/sem)² where its interval is robust, as for a residual that is
        correlated over time, and 1 otherwise; see `surae.assessment.inflation`.
    workers : int, optional
        Profiles at a time; by default one for each processor. The numbers do not depend on it.
    progress : callable, optional
        Called after every profile with (parameter, profiles done, all profiles).

    Returns
    -------
    Profiles
        Ctrl-C keeps the profiles that are complete; `missing` names the others.

    Raises
    ------
    InputError
        A parameter is unknown, fixed or given twice, or the fit has nothing to profile.
    """
    wanted = fitted.result.problem.free if names is None else names
    wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    reason = "given"
    if variance_inflation is None:
        found = inflation_of(fitted.assessment)
        reason = found.reason
        variance_inflation = {n: factor for n, factor in found.factors.items() if n in wanted}
    return profiles(
        fitted.result,
        wanted,
        variance_inflation=variance_inflation,
        inflation_reason=reason,
        workers=workers,
        progress=progress,
    )


def posterior(
    fitted: Fit,
    *,
    draws: int = DRAWS,
    tune: int = TUNE,
    chains: int = CHAINS,
    seed: int = 0,
    priors: Mapping[str, tuple[float, float]] | None = None,
    variance_inflation: float | None = None,
    cores: int | None = None,
    progress: ChainsTold | None = None,
) -> Posterior:
    """Draws from the posterior: what recordings and prior knowledge say together.

    Needs the extra: ``pip install "surae[bayes]"``.

    Parameters
    ----------
    fitted : Fit
        The fit.
    draws, tune : int
        Draws of each chain that are kept, and that tune the sampler before.
    chains : int
        Number of chains.
    seed : int
        The same seed gives the same draws on any number of cores.
    priors : mapping of str to (median, spread), optional
        Priors in place of the fit's own, which stand in place of the wide defaults of
        `surae.estimation.population`.
    variance_inflation : float, optional
        Divides the weight of the data. By default what the assessment asks for: the median over
        the parameters of (sem_robust/sem)² where intervals are robust, as for a residual that is
        correlated over time, and 1 otherwise; see `surae.assessment.inflation`. One number, since
        the likelihood has one noise: parameters for which the correlation matters more than for
        most get too narrow an interval, which their profile or `ci95` does not.
    cores : int, optional
        Chains at a time; by default one for each processor.
    progress : callable, optional
        Called now and then with (iterations done, all iterations).

    Returns
    -------
    Posterior
        Ctrl-C keeps what is drawn; `message` says so.

    Raises
    ------
    InputError
        The sampler is not installed, a setting or prior is impossible, or the fit has no residual
        to draw from.
    """
    reason = "given"
    if variance_inflation is None:
        found = inflation_of(fitted.assessment)
        variance_inflation = found.common
        reason = found.reason
        if found.common != 1.0:
            reason = f"{reason}; the median over the parameters"
    return sample(
        fitted.result,
        draws=draws,
        tune=tune,
        chains=chains,
        seed=seed,
        priors=priors,
        variance_inflation=variance_inflation,
        inflation_reason=reason,
        cores=cores,
        progress=progress,
    )


def bootstrap(
    fitted: Fit,
    *,
    replicates: int = REPLICATES,
    seed: int = 0,
    block_s: float | None = None,
    workers: int | None = None,
    store: PathLike | None = None,
    progress: BootstrapTold | None = None,
) -> Bootstrap:
    """Percentile intervals from fits to random blocks of the residual; no formula is trusted.

    Parameters
    ----------
    fitted : Fit
        The fit.
    replicates : int
        Fits to make.
    seed : int
        Of the random blocks; the numbers depend on nothing else.
    block_s : float, optional
        Length of the blocks [s]; by default from the residual's autocorrelation.
    workers : int, optional
        Fits at a time; by default one for each processor.
    store : path, optional
        File that replicates are added to as they come, and from which a bootstrap goes on.
    progress : callable, optional
        Called after every replicate with (done, all).

    Returns
    -------
    Bootstrap
        Ctrl-C keeps the replicates that are complete; `missing` counts the others.

    Raises
    ------
    InputError
        A number is out of range, or the file is of another bootstrap.
    """
    return bootstrap_fit(
        fitted.result,
        replicates=replicates,
        seed=seed,
        block_s=block_s,
        workers=workers,
        store=store,
        progress=progress,
    )


def emg_bias(
    fitted: Fit,
    *,
    level: float | None = None,
    pairs: int = PAIRS,
    seed: int = 0,
    workers: int | None = None,
    progress: BootstrapTold | None = None,
) -> EmgBias:
    """How far noise of the EMG has shifted each parameter, by simulation and extrapolation.

    Parameters
    ----------
    fitted : Fit
        The fit.
    level : float, optional
        Standard deviation of white EMG noise as a part of each channel's mean; by default the
        noise is that of the EMG's quiet part.
    pairs : int
        Pairs of noise realisations, 8 fits each.
    seed : int
        Of the random noise; the numbers depend on nothing else.
    workers : int, optional
        Fits at a time; by default one for each processor.
    progress : callable, optional
        Called after every pair with (done, all).

    Returns
    -------
    EmgBias
        Ctrl-C keeps the pairs that are complete; `missing` counts the others.

    Raises
    ------
    InputError
        A number is out of range, or an EMG is too short to have a quiet part.
    """
    return emg_bias_of(
        fitted.result, level=level, pairs=pairs, seed=seed, workers=workers, progress=progress
    )


def load(path: PathLike) -> Fit:
    """Read a fit that was saved; equal to the one saved.

    Raises
    ------
    InputError
        The file is missing, damaged, or of a newer surae.
    """
    result, baseline = load_saved(path)
    return Fit(result, assess(result, baseline))


@overload
def simulate(
    model: str,
    parameters: Mapping[str, float],
    recording: AnyRecording,
    *,
    jacobian: Literal[False] = False,
    **options: Any,
) -> FloatArray: ...


@overload
def simulate(
    model: str,
    parameters: Mapping[str, float],
    recording: AnyRecording,
    *,
    jacobian: Literal[True],
    **options: Any,
) -> tuple[FloatArray, FloatArray]: ...


def simulate(
    model: str,
    parameters: Mapping[str, float],
    recording: AnyRecording,
    *,
    jacobian: bool = False,
    **options: Any,
) -> FloatArray | tuple[FloatArray, FloatArray]:
    """Torque that a model gives for the angle and EMG of a recording, used as they are.

    Parameters
    ----------
    model : str
        Name of the model.
    parameters : mapping of str to float
        Its parameters; those it does not free by default may be left out.
    recording : Recording, ModelInputs or path
        Angle and EMG on one uniform time axis.
    jacobian : bool
        Also return the derivatives of the torque.
    **options
        Model options, see `surae.model.ModelOptions`.

    Returns
    -------
    torque : ndarray, shape (n,)
        Modelled torque [Nm].
    jacobian : ndarray, shape (n, p)
        Its derivatives by the parameters that the model frees by default, in its order; only
        with ``jacobian=True``.

    Raises
    ------
    InputError
        Something given is unknown, missing or unusable.
    ComputationError
        The torque is not finite; the message names the first such sample.
    """
    spec, chosen = get_model(model), ModelOptions.of(**options)
    inputs = _inputs(recording, prepared=True)
    simulator, values = _tied(spec, parameters, inputs, chosen)
    columns = [spec.names.index(name) for name in spec.free]
    with _quietly():
        if not jacobian:
            torque = simulator.torque(values)
            check_finite_torque(torque, inputs)
            return torque
        torque, rows = simulator.torque_jacobian(values, columns)
        check_finite_torque(torque, inputs)
        return torque, rows.T


def simulate_parts(
    model: str, parameters: Mapping[str, float], recording: AnyRecording, **options: Any
) -> TorqueParts:
    """The torque of `simulate`, split into its parts; arguments and errors are the same."""
    inputs = _inputs(recording, prepared=True)
    return _parts(get_model(model), parameters, inputs, ModelOptions.of(**options))


def simulate_tendon(
    model: str, parameters: Mapping[str, float], recording: AnyRecording, **options: Any
) -> TendonState:
    """Lengths, velocities and forces of muscles and tendons over time.

    The arguments are those of `simulate`. Where the model has no finite state, the result says so
    itself, in `TendonState.unsolved`.

    Raises
    ------
    InputError
        The model's tendons are rigid, or something given is unknown, missing or unusable.
    """
    inputs = _inputs(recording, prepared=True)
    return _tendon(get_model(model), parameters, inputs, ModelOptions.of(**options))


def validate(
    fitted: Fit,
    recordings: Sequence[AnyRecording],
    *,
    prepared: bool | None = None,
    weights: Weighting | Sequence[Weighting] | None = None,
) -> tuple[Prediction, ...]:
    """Predict recordings with the parameters of a fit to others (thesis 2.7).

    Parameters
    ----------
    fitted : Fit
        Where the parameters come from.
    recordings : sequence of Recording, ModelInputs or path
        With their measured torque.
    prepared : bool, optional
        Whether their signals are used as they are; by default as they were in the fit.
    weights : Weighting, or sequence of Weighting, optional
        Its windows of weight 0 are left out of the figures.

    Returns
    -------
    tuple of Prediction
        One for each recording: VAF, RMSE, bias and the predicted torque.
    """
    problem = fitted.result.problem
    as_they_are = problem.inputs[0].prepared if prepared is None else prepared
    inputs = [_inputs(one, as_they_are) for one in recordings]
    return predict_others(fitted.result, inputs if weights is None else weighted(inputs, weights))


def leave_one_out(
    recordings: Sequence[AnyRecording],
    model: str = "muscle",
    *,
    prepared: bool = False,
    weights: Weighting | Sequence[Weighting] | None = None,
    progress: LeaveOneOutTold | None = None,
    **settings: Any,
) -> LeaveOneOut:
    """Predict every recording with the parameters of a fit of all the others (thesis 2.7).

    Parameters
    ----------
    recordings : sequence of Recording, ModelInputs or path
        At least two recordings of one leg; they may be of different protocols.
    model : str
        Name of the model.
    prepared : bool
        The signals are filtered and at the model's rate already: use them as they are.
    weights : Weighting, or sequence of Weighting, optional
        What samples count in the fits; those of weight 0 are in no prediction's figures either.
    progress : callable, optional
        Called before every fit with (the recording left out, fits done, all fits).
    **settings
        Other keywords of `fit`: ``fixed``, ``priors``, ``loss``, ``starts``, model options, …

    Returns
    -------
    LeaveOneOut
        A prediction and a fit for each recording, and the figures of all predictions together.
    """
    inputs: Sequence[ModelInputs] = [_inputs(one, prepared) for one in recordings]
    if weights is not None:
        inputs = weighted(inputs, weights)
    return leave_one_out_of(inputs, lambda some: fit(some, model, **settings).result, progress)


def _quietly() -> np.errstate:
    """No warnings of numbers that overflow: a torque that is not finite is refused in words."""
    return np.errstate(over="ignore", invalid="ignore")


def _tied(
    spec: ModelSpec, given: Mapping[str, float], inputs: ModelInputs, options: ModelOptions
) -> tuple[Simulator, FloatArray]:
    """The model tied to a recording, and its parameter vector."""
    return spec.simulator(inputs, options), spec.vector(given, options)


def _parts(
    spec: ModelSpec, given: Mapping[str, float], inputs: ModelInputs, options: ModelOptions
) -> TorqueParts:
    simulator, values = _tied(spec, given, inputs, options)
    with _quietly():
        parts = simulator.parts(values)
        check_finite_torque(parts.total, inputs)
    return parts


def _tendon(
    spec: ModelSpec, given: Mapping[str, float], inputs: ModelInputs, options: ModelOptions
) -> TendonState:
    simulator, values = _tied(spec, given, inputs, options)
    with _quietly():
        state = simulator.tendon(values)
    if state is None:
        others = [m.name for m in MODELS.values() if any(p.group == "tendon" for p in m.parameters)]
        raise InputError(
            f"model {spec.name!r} has rigid tendons; models whose tendons give way: "
            f"{', '.join(others)}"
        )
    return state


def _several(recordings: AnyRecording | Sequence[AnyRecording]) -> Sequence[AnyRecording]:
    one = isinstance(recordings, Recording | ModelInputs | str) or hasattr(recordings, "__fspath__")
    return [recordings] if one else recordings  # type: ignore[list-item,return-value]


def _inputs(recording: AnyRecording, prepared: bool) -> ModelInputs:
    if isinstance(recording, ModelInputs):
        return recording
    if not isinstance(recording, Recording):
        recording = read(recording)
    return prepare(recording, prepared=prepared)
