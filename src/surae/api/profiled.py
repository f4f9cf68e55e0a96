"""Profiles of a fit, as users ask for them."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

from surae.api import Fit
from surae.base.setting import renamed, takes
from surae.inference.judging.assessed import variance_inflation
from surae.sampling.one_profile import profiled
from surae.sampling.profiles import NamedProgress, Profiles, profiles
from surae.sampling.settings import ProfileSettings


@renamed(fitted="fit")
@takes(ProfileSettings)
def profile(
    fit: Fit,
    names: str | Sequence[str] | None = None,
    *,
    progress: NamedProgress | None = None,
    **settings: Any,
) -> Profiles:
    """Profile likelihood: intervals that need not be symmetric, nor end where the data set no end.

    Parameters
    ----------
    fit : Fit
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

    Examples
    --------
    >>> surae.profile(surae.load("fit.json"), "f0")["f0"].interval
    """
    request = ProfileSettings(**settings)
    wanted = profiled(fit.result) if names is None else names
    wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    reason = "given"
    if request.variance_inflation is None:
        reason = fit.assessment.interval_note
        factors = variance_inflation(fit.assessment)
        of_wanted = {n: factor for n, factor in factors.items() if n in wanted}
        request = replace(request, variance_inflation=of_wanted)
    return profiles(
        fit.result, wanted, **asdict(request), inflation_reason=reason, progress=progress
    )
