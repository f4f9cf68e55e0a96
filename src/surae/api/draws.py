"""The posterior of a fit, as users ask for it."""

from dataclasses import asdict, replace
from statistics import median
from typing import Any

from surae.api import Fit
from surae.base.progress import Progress
from surae.base.setting import renamed, takes
from surae.inference.judging.assessed import variance_inflation
from surae.sampling.sample import Posterior, sample
from surae.sampling.settings import PosteriorSettings


@renamed(fitted="fit", cores="workers")
@takes(PosteriorSettings)
def posterior(fit: Fit, *, progress: Progress | None = None, **settings: Any) -> Posterior:
    """Draws from the posterior of a named model: what recordings and priors say together.

    A fit of ``auto`` is a posterior already. Draws of the Laplace approximation are weighted by the
    posterior itself. Where the weights show that this does not do, `status` is ``"not reliable"``
    and there are no intervals: see `profile`.
    The same seed gives the same draws on any number of cores.

    Parameters
    ----------
    fit : Fit
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
        A setting or prior is impossible, or the fit is of ``auto`` or has no residual.

    Examples
    --------
    >>> surae.posterior(surae.load("fit.json"), draws=100, seed=1)["f0"].ci95
    """
    request = PosteriorSettings(**settings)
    reason = "given"
    if request.variance_inflation is None:
        common = median(variance_inflation(fit.assessment).values())
        request = replace(request, variance_inflation=common)
        reason = fit.assessment.interval_note
        if common != 1.0:
            reason = f"{reason}; the median over the parameters"
    drawn = sample(fit.result, **asdict(request), progress=progress)
    return replace(drawn, inflation_reason=reason)
