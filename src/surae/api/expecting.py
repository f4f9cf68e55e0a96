"""What a protocol will tell, before it is measured."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from surae.api.fitted import Fit
from surae.api.fitting import load
from surae.api.requested import as_trajectory, muscles_of, parted, requested_legs
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.frozen import FrozenDict
from surae.base.progress import Progress
from surae.base.requests import ExpectSettings
from surae.base.setting import takes
from surae.model import ModelOptions
from surae.model.joint import ANKLE
from surae.model.laboratory import AUTO
from surae.nerve.expected import expects, series
from surae.planning.aimed import detectable
from surae.planning.at_rest import expected_at_rest
from surae.planning.expectation import ExpectedMeasure, expected
from surae.planning.information import filmed
from surae.planning.legs import Legs
from surae.planning.next import fit_precision
from surae.protocol import Trajectory
from surae.quality.position import perturbing


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
        by_name = detectable(trajectory, legs, level, precision.get("known"))
    except InputError:
        return FrozenDict()
    return FrozenDict({name: ExpectedMeasure(*each) for name, each in by_name.items()})
