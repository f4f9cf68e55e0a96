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
from surae.inference.posterior.log_posterior import LogPosterior, Point
from surae.model import with_optional
from surae.model.laboratory import group_of
from surae.model.source import Gaussian

#: Probability of a right statement to look as wrong, from which on that is said; from `RARE` on it
#: is doubted: of five that are tested, in one right session in five and in one in twenty.
SAID = 0.05
#: Standard deviation, in parts of that of a laboratory that knows nothing, below which the torque
#: has something of its own to say.
_TOLD = 0.7
#: 1/sd of no prior, in parts of that of a laboratory that knows nothing.
_NO_PRIOR = 1e-3
#: Groups that one statement is about, and parameters of a shape that nobody states.
_PART_OF = {"length": "arm", "bend": "arm"}
_SHAPES = ("arm_slope", "arm_bend", "path_bend")
#: The zero of the angle, and how far it is off where nobody looked, twice as far as assumed [rad].
ZERO_NAME = "angle_zero"
FAR_ZERO = float(np.radians(5.0))


@dataclass(frozen=True, slots=True)
class Conflict:
    """What was stated of a group, and what the torque says of it."""

    at: tuple[int, ...]  #: Places of the numbers that were compared.
    probability: float  #: Of a right statement to be as far off, or farther.
    ratio: float  #: Birge's; below 1 where both agree better than is expected.

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
    laplace: LaplaceApproximation,
    names: tuple[str, ...],
    stated: Mapping[str, Gaussian],
    wide: Mapping[str, Gaussian],
    groups: Collection[str],
) -> dict[str, Conflict]:
    """By group of which the torque says something by itself, how far that is from the statement.

    `names` are what is searched; `stated` and `wide` are priors with and without the statements;
    Birge's ratio is of what the torque tells without either.
    """
    from scipy.special import gammaincc

    by_statement: dict[str, Conflict] = {}
    of = [
        group if (group := group_of(name) or name) in groups and name in wide else ""
        for name in names
    ]
    for statement in sorted({_PART_OF.get(group, group) for group in groups}):
        freed = [j for j, group in enumerate(of) if _PART_OF.get(group, group) == statement]
        said = [
            j
            for j in freed
            if not names[j].startswith(_SHAPES) and stated[names[j]].sd < wide[names[j]].sd
        ]
        mean = laplace.mean.copy()
        weight = laplace.weight.copy()
        mean[freed] = [wide[names[j]].mean for j in freed]
        weight[freed] = [1.0 / wide[names[j]].sd for j in freed]
        _, _, V = replace(laplace, mean=mean, weight=weight).solved()
        informed = [j for j in said if V[j, j] < (_TOLD * wide[names[j]].sd) ** 2]
        if not informed:
            continue
        prior_covariance = np.diag([stated[names[j]].sd ** 2 for j in informed])
        square = []
        for prior in (1.0, _NO_PRIOR):
            weight[informed] *= prior
            _, mode, V = replace(laplace, mean=mean, weight=weight).solved()
            apart = mode[informed] - np.array([stated[names[j]].mean for j in informed])
            square.append(
                float(
                    apart @ np.linalg.solve(V[np.ix_(informed, informed)] + prior_covariance, apart)
                )
            )
        probability = float(gammaincc(0.5 * len(informed), 0.5 * square[0]))
        by_statement[statement] = Conflict(
            tuple(informed), probability, float(np.sqrt(square[1] / len(informed)))
        )
    return by_statement


def with_zero(post: LogPosterior, point: Point, said: Gaussian) -> tuple[LogPosterior, Point]:
    """The posterior with the angle's zero [rad] in it too, which a fit holds, at the same point."""
    spec = with_optional(post.problem.spec, (ZERO_NAME,))
    free = (*post.problem.free, ZERO_NAME)
    more = post.problem.of_model(spec, free, post.by_name(point.z), post.problem.limits)
    other = LogPosterior(
        more,
        {**post.priors, ZERO_NAME: said},
        post.noise,
        post.latents,
        post.sizes,
        beliefs={**post.beliefs, ZERO_NAME: said},
        rate_hz=post.rate_hz,
        rest=post.rest,
    ).having(fast=post.fast)
    z = other.like(post, point.z)
    return other, replace(point, z=z, blocks=other.blocks(z, point.c, point.w))
