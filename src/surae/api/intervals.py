"""What a fit's parameters may be: profiles and a posterior."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

from surae.api.fitted import Fit
from surae.assessment.assess import variance_inflation
from surae.assessment.likelihood.profile import profiled
from surae.assessment.likelihood.profiles import Profiles, profiles
from surae.assessment.posterior.sample import Posterior, sample
from surae.progress import NamedProgress, Progress
from surae.requests import PosteriorSettings, ProfileSettings
from surae.setting import takes


@takes(ProfileSettings)
def profile(
    fitted: Fit,
    names: str | Sequence[str] | None = None,
    *,
    progress: NamedProgress | None = None,
    **settings: Any,
) -> Profiles:
    """Profile likelihood: intervals that need not be symmetric, nor end where the data set no end.

    Parameters
    ----------
    fitted : Fit
        The fit.
    names : str or sequence of str, optional
        Parameters that it estimated; all of them by default.
    progress : callable, optional
        Called after every profile with (parameter, profiles done, all profiles).
    {settings}

    Returns
    -------
    Profiles
        Ctrl-C keeps the profiles that are complete; `missing` names the others.

    Raises
    ------
    InputError
        A parameter is unknown, fixed or given twice, or the fit has nothing to profile.
    """
    request = ProfileSettings(**settings)
    wanted = profiled(fitted.result) if names is None else names
    wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    reason = "given"
    if request.variance_inflation is None:
        inflation = variance_inflation(fitted.assessment)
        reason = inflation.reason
        factors = {n: factor for n, factor in inflation.factors.items() if n in wanted}
        request = replace(request, variance_inflation=factors)
    return profiles(
        fitted.result, wanted, **asdict(request), inflation_reason=reason, progress=progress
    )


@takes(PosteriorSettings)
def posterior(fitted: Fit, *, progress: Progress | None = None, **settings: Any) -> Posterior:
    """Draws from the posterior: what recordings and prior knowledge say together.

    Draws of the Laplace approximation, weighted by the posterior itself. Where the weights show
    that this does not do, `status` is ``"not reliable"`` and there are no intervals: see `profile`.
    The same seed gives the same draws on any number of cores.

    Parameters
    ----------
    fitted : Fit
        The fit.
    progress : callable, optional
        Called now and then with (evaluations done, all that are allowed).
    {settings}

    Returns
    -------
    Posterior
        Ctrl-C keeps what is drawn; `message` says so.

    Raises
    ------
    InputError
        A setting or prior is impossible, or the fit has no residual to draw from.
    """
    request, reason = PosteriorSettings(**settings), "given"
    if request.variance_inflation is None:
        inflation = variance_inflation(fitted.assessment)
        request = replace(request, variance_inflation=inflation.common)
        reason = inflation.reason
        if inflation.common != 1.0:
            reason = f"{reason}; the median over the parameters"
    return sample(fitted.result, **asdict(request), inflation_reason=reason, progress=progress)
