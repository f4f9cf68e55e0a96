"""What a fit's parameters may be: profiles, a posterior, a bootstrap, the bias by EMG noise."""

from collections.abc import Mapping, Sequence

from surae.api.fitted import Fit
from surae.assessment.assess import variance_inflation as inflation_of
from surae.assessment.likelihood.profiles import Profiles, profiles
from surae.assessment.posterior.sample import CHAINS, DRAWS, TUNE, Posterior, sample
from surae.assessment.resampling.bootstrap import REPLICATES, Bootstrap
from surae.assessment.resampling.bootstrap import bootstrap as bootstrap_fit
from surae.assessment.resampling.emg_bias import PAIRS, EmgBias
from surae.assessment.resampling.emg_bias import emg_bias as emg_bias_of
from surae.files import PathLike
from surae.progress import NamedProgress, Progress


def profile(
    fitted: Fit,
    names: str | Sequence[str] | None = None,
    *,
    variance_inflation: float | Mapping[str, float] | None = None,
    workers: int | None = None,
    store: PathLike | None = None,
    progress: NamedProgress | None = None,
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
        correlated over time, and 1 otherwise; see `surae.assessment.assess`.
    workers : int, optional
        Profiles at a time; by default one for each processor. The numbers do not depend on it.
    store : path, optional
        File that profiles are added to as they come, and from which stopped ones go on.
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
        inflation = inflation_of(fitted.assessment)
        reason = inflation.reason
        variance_inflation = {n: factor for n, factor in inflation.factors.items() if n in wanted}
    return profiles(
        fitted.result,
        wanted,
        variance_inflation=variance_inflation,
        inflation_reason=reason,
        workers=workers,
        store=store,
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
    progress: Progress | None = None,
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
        correlated over time, and 1 otherwise; see `surae.assessment.assess`. One number, since
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
        inflation = inflation_of(fitted.assessment)
        variance_inflation = inflation.common
        reason = inflation.reason
        if inflation.common != 1.0:
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
    progress: Progress | None = None,
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
    progress: Progress | None = None,
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
