"""Priors as text, and where they lie between the bounds."""

import math

from surae.estimation import Prior
from surae.report.formatting import short, significant

#: Spread up to which a logarithm's standard deviation reads as a percentage of the value.
_SMALL = 0.3
#: Part of the prior's spread from which the data are said to add little.
_LITTLE = 0.7


def prior_text(prior: Prior, unit: str = "") -> str:
    """A prior's median and spread, ``"0.04 m ± 20 %"``."""
    median = f"{short(prior.median)} {unit}".rstrip()
    if prior.spread <= _SMALL:
        return f"{median} ± {short(float(f'{100 * prior.spread:.3g}'))} %"
    return f"{median}, times or divided by {significant(math.exp(min(prior.spread, 700.0)), 3)}"


def prior_note(prior: Prior, value: float, sem: float | None) -> str:
    """The prior at its parameter, and whether the data say much beside it."""
    text = f"with prior {prior_text(prior)}"
    if sem is not None and sem > _LITTLE * prior.spread * value:
        text += ", to which the data add little"
    return text


def prior_span(prior: Prior) -> tuple[float, float, float]:
    """Lower end, median and upper end of a prior, one standard deviation to either side."""
    factor = math.exp(min(prior.spread, 700.0))
    return prior.median / factor, prior.median, prior.median * factor
