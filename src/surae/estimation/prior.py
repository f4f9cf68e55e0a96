"""What is known of a parameter beforehand."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError


@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of a parameter beforehand: a Gaussian on its logarithm.

    Attributes
    ----------
    median : float
        Expected value, in the parameter's unit.
    spread : float
        Standard deviation of the logarithm; for small ones, the relative standard deviation.
    """

    median: float
    spread: float


def checked_prior(name: str, pair: object, free: Sequence[str]) -> Prior:
    """The prior that a median and a spread make, of one of the free parameters.

    Raises
    ------
    InputError
        The parameter is not free, or the pair is not two numbers above zero.
    """
    if name not in free:
        raise InputError(
            f"prior of {name}: it is not estimated; free parameters: {', '.join(free)}"
        )
    if not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
        raise InputError(f"prior of {name} is {pair!r}; give its median and its spread")
    median, spread = pair
    for value in (median, spread):
        number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        if not number or not 0 < value < np.inf:
            raise InputError(f"prior of {name} is {pair!r}; median and spread must be above zero")
    return Prior(float(median), float(spread))
