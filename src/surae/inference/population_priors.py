"""What is known of the parameters before a measurement: priors of a population, with sources.

A prior is a Gaussian on the logarithm: two thirds of the population are believed to lie between
median/exp(spread) and median·exp(spread). Medians lie in the middle of the ranges from which
virtual subjects are drawn. Spreads are at least as wide as those ranges, and wider where people are
known to differ more, since a default must not decide what the data should.

A fit with a population takes its priors from the records of `surae.model.parameters`. The EMG
weights have none there: they depend on electrodes and skin as much as on the muscle. The length
parameters and stiffnesses hold for equation (9) as printed, not for virtual work.

A posterior, which has no bounds, needs a prior of every parameter and has no population. It takes
that of health with its spread `WIDENED`, so that patients lie within it and it reaches about as far
as a fit's bounds, or the parameter's own wide prior.
"""

from collections.abc import Sequence

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import check_known
from surae.base.names import POPULATIONS
from surae.base.setting import is_number
from surae.model import ModelOptions
from surae.model.parameter import adapted
from surae.model.prior import Prior
from surae.model.registry import PARAMETERS


def checked_prior(name: str, pair: object, free: Sequence[str], source: str = "") -> Prior:
    """The prior that a median and a spread make, of one of the free parameters."""
    if name not in free:
        raise InputError(
            f"prior of {name}: it is not estimated; free parameters: {', '.join(free)}"
        )
    if not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
        raise InputError(f"prior of {name} is {pair!r}; give its median and its spread")
    median, spread = pair
    for value in (median, spread):
        if not is_number(value) or not 0 < value < np.inf:
            raise InputError(f"prior of {name} is {pair!r}; median and spread must be above zero")
    return Prior(float(median), float(spread), source)


#: By how much the spread of health is widened for a leg of which nothing is known.
WIDENED = 1.5


def population_priors(
    population: str, options: ModelOptions | None = None
) -> dict[str, tuple[float, float]]:
    """Median and spread of every parameter that has a prior under these options, by name.

    Parameters
    ----------
    population : str
        One of `surae.base.names.POPULATIONS`.
    options : ModelOptions, optional
        Virtual work leaves out lengths and stiffnesses; ε0 is a strain where it is to be read so.

    Raises
    ------
    InputError
        The population is not known.
    """
    check_known("population", POPULATIONS, population)
    table = adapted(PARAMETERS.values(), options or ModelOptions())
    believed = {name: p.known[population] for name, p in table.items() if p.known}
    return {name: (belief.median, belief.spread) for name, belief in believed.items()}


def wide_priors(
    options: ModelOptions | None = None,
    emg_unit: str = "V",
    emg_sizes: Sequence[float] = (1.0, 1.0, 1.0, 1.0),
) -> dict[str, tuple[float, float]]:
    """Median and spread of every parameter that is above zero, of a leg nothing is known of."""
    priors = {}
    table = adapted(PARAMETERS.values(), options or ModelOptions(), emg_unit, emg_sizes)
    for name, p in table.items():
        if p.wide is not None:
            priors[name] = p.wide.median, p.wide.spread
        elif p.known:
            priors[name] = p.known["healthy"].median, WIDENED * p.known["healthy"].spread
    return priors
