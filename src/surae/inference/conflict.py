"""What was stated beforehand against what the torque says of it by itself.

A statement is a narrow prior, which the mode hardly leaves however wrong it is. So each group is
estimated anew with the prior of a laboratory that knows nothing of it, from the quadratic around
the mode, and its estimate is held against the statement: both have their uncertainty, and the
square of their distance in these is χ² with as many degrees of freedom as numbers were stated
(Evans and Moshonov 2006, Bayesian Analysis 1:893-914). Where it is above what is expected, one of
both is less sure than it says: what they make together is widened by Birge's ratio, √(χ²/n) (Birge
1932, Physical Review 40:207-227; JCGM 100:2008, F.1.2.3), and what hangs on it alike.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.units import FloatArray
from surae.inference.evidence import LaplaceApproximation
from surae.model.laboratory import group_of
from surae.model.sources import Gaussian

#: Probability of a statement that is right to look as wrong, from which on it is doubted. Five
#: groups are tested, so that one right session in twenty is doubted; below it intervals are wider.
_RARE = 0.01
#: Standard deviation, in parts of that of a laboratory that knows nothing, below which the torque
#: has something of its own to say.
_TOLD = 0.7


@dataclass(frozen=True, slots=True)
class Conflict:
    """What was stated of a group, and what the torque says of it."""

    at: tuple[int, ...]  #: Places of the numbers that were compared.
    probability: float  #: Of a right statement to be as far off, or farther.
    ratio: float  #: Birge's; below 1 where both agree better than is expected.

    @property
    def doubted(self) -> bool:
        """Whether a right statement is rarely so far off."""
        return self.probability < _RARE

    def widened(self, V: FloatArray) -> FloatArray:
        """Shifts, shape (r, q), by which the covariance of these numbers in V is ratio² times it.

        All else is shifted as V has it vary with them.
        """
        at = list(self.at)
        if self.ratio <= 1.0:
            return np.zeros((0, len(V)))
        factor = np.linalg.cholesky(V[np.ix_(at, at)])
        return np.asarray(np.sqrt(self.ratio**2 - 1.0) * np.linalg.solve(factor, V[at]))


def conflicts(
    laplace: LaplaceApproximation, names: tuple[str, ...], stated: Mapping[str, Gaussian],
    wide: Mapping[str, Gaussian], groups: Collection[str],
) -> dict[str, Conflict]:  # fmt: skip
    """By group of which the torque says something by itself, how far that is from the statement.

    `names` are what is searched; `stated` and `wide` are priors with and without the statements.
    """
    from scipy.special import gammaincc

    found: dict[str, Conflict] = {}
    for group in sorted(groups):
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
        found[group] = Conflict(tuple(told), probability, float(np.sqrt(square / len(told))))
    return found
