"""What was stated beforehand against what the torque says of it by itself.

A statement is a narrow prior, which the mode hardly leaves however wrong it is. So each group is
estimated anew with the prior of a laboratory that knows nothing of it, from the quadratic around
the mode, and its estimate is held against the statement: both have their uncertainty, and the
square of their distance in these is χ² with as many degrees of freedom as numbers were stated
(Evans and Moshonov 2006, Bayesian Analysis 1:893-914).
"""

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from surae.inference.evidence import LaplaceApproximation
from surae.model.laboratory import group_of
from surae.model.sources import Gaussian

#: Probability of a statement that is right to look as wrong, from which on it is doubted: two
#: standard deviations. Five groups are tested, so that up to one right session in five is doubted;
#: what one statement carries is else wrong in many measures at once.
_RARE = 0.05
#: Standard deviation, in parts of that of a laboratory that knows nothing, below which the torque
#: has something of its own to say.
_TOLD = 0.7


def contradicted(
    laplace: LaplaceApproximation, names: tuple[str, ...], stated: Mapping[str, Gaussian],
    wide: Mapping[str, Gaussian], groups: Collection[str],
) -> dict[str, float]:  # fmt: skip
    """By group, probability that a right statement is as far from what the torque says.

    `names` are what is searched; `stated` and `wide` are priors with and without the statements.
    """
    from scipy.special import gammaincc

    odd: dict[str, float] = {}
    for group in groups:
        at = [j for j, name in enumerate(names) if group_of(name) == group and name in wide]
        if not at:
            continue
        mean, weight = laplace.mean.copy(), laplace.weight.copy()
        mean[at] = [wide[names[j]].mean for j in at]
        weight[at] = [1.0 / wide[names[j]].sd for j in at]
        _, mode, covariance = replace(laplace, mean=mean, weight=weight).solved({})
        told = [j for j in at if covariance[j, j] < (_TOLD * wide[names[j]].sd) ** 2]
        if not told:
            continue
        apart = mode[told] - np.array([stated[names[j]].mean for j in told])
        own = np.diag([stated[names[j]].sd ** 2 for j in told])
        square = float(apart @ np.linalg.solve(covariance[np.ix_(told, told)] + own, apart))
        probability = float(gammaincc(0.5 * len(told), 0.5 * square))
        if probability < _RARE:
            odd[group] = probability
    return odd
