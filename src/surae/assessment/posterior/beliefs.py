"""What is known of every free parameter before a posterior is drawn, in place of bounds.

A prior is a Gaussian on a parameter's logarithm; on the parameter itself where it may be negative.
Given ones come first, then those of the fit, then the wide defaults of
`surae.estimation.population`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.estimation import FitProblem
from surae.estimation.population import wide_priors
from surae.estimation.prior import Prior, checked_prior
from surae.model import adapted
from surae.model.laboratory import laboratory


@dataclass(frozen=True, slots=True)
class Belief:
    """What is known of one parameter beforehand."""

    #: `median`, `spread`: median, and standard deviation of the logarithm; of the parameter itself,
    #: in its unit, where it may be negative.
    median: float
    spread: float
    log: bool  #: Whether it is on the logarithm.
    #: "population", "fit", "given": Whether it is a default, was a prior of the fit, or was given
    #: for the posterior.
    origin: str


def beliefs(
    problem: FitProblem, given: Mapping[str, tuple[float, float]] | None = None
) -> dict[str, Belief]:
    """The prior of every free parameter: given now, else the fit's, else the wide default.

    `given` holds (median, spread) by parameter.
    """
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    wide = wide_priors(problem.options, problem.inputs[0].emg_unit)
    beliefs = {}
    for name in problem.free:
        p = table[name]
        if p.signed:
            # Its bounds as two standard deviations to either side.
            beliefs[name] = Belief((p.lower + p.upper) / 2, (p.upper - p.lower) / 4, False,
                                 "population")  # fmt: skip
        elif name in wide:
            beliefs[name] = Belief(*wide[name], True, "population")
        else:
            known = laboratory()[name]
            beliefs[name] = _told(Prior(known.mean, known.sd, straight=True), "population")
    for name, prior in problem.priors.items():
        beliefs[name] = _told(prior, "fit", signed=table[name].signed)
    for name, pair in (given or {}).items():
        prior = checked_prior(name, pair, problem.free)
        if table[name].signed:
            raise InputError(f"prior of {name}: it is on a logarithm, and {name} may be negative")
        beliefs[name] = Belief(prior.median, prior.spread, True, "given")
    return beliefs


def _told(prior: Prior, origin: str, *, signed: bool = False) -> Belief:
    """A prior as a belief; one on the value itself as a logarithm where it may not be negative."""
    if not prior.straight or signed or not prior.median > 0.0:
        return Belief(prior.median, prior.spread, not prior.straight, origin)
    variance = float(np.log1p((prior.spread / prior.median) ** 2))  # of the same mean and deviation
    return Belief(prior.median * float(np.exp(-0.5 * variance)), variance**0.5, True, origin)
