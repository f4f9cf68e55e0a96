"""Whether the foot was mounted alike in all recordings of a joint fit: the zeros of their angles.

One leg has one set of lengths, so that recordings in which the foot lies otherwise on its plate ask
for other zeros of the angle. Each recording i is given a zero δᵢ of its own in the quadratic around
the common mode, which costs no further simulation: its own normal equations have the row of the
zero already. What all share is solved with them,

    [Σ Hᵢ + P   hᵢ ] [θ ]      [Σ gᵢ + P·(θ − θ₀)]
    [hᵢᵀ        kᵢ ] [δᵢ]  = − [γᵢ               ],

so that whatever else may follow the torque (lengths, tissue, zeros of the torque) has had its say.
Away from the mode the equations bend, and a large shift is told too small.
"""

from collections.abc import Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference.evidence import inverse_of
from surae.inference.posterior.conflict import ZERO_NAME
from surae.inference.posterior.log_posterior import LogPosterior, Point
from surae.inference.relaxed.pair import REMOUNTED
from surae.inference.result import Mounting
from surae.quality.timing import TOO_SHORT

#: By how much the foot turns on its plate from trial to trial of one visit [deg], one standard
#: deviation: as much as if it were mounted anew.
STAYS = REMOUNTED
#: How far any zero may be, nothing being known of it [deg].
_ANY = 15.0


def mountings(post: LogPosterior, point: Point) -> tuple[Mounting, ...]:
    """Of each recording of a posterior that has the angle's zero in it; none of a single one.

    One that is too short to tell has the zero of all.
    """
    inputs = post.problem.inputs
    long_enough = [i for i, each in enumerate(inputs) if each.counted >= TOO_SHORT * each.rate_hz]
    if len(long_enough) < 2:
        return ()
    shift, covariance = _zeros(post, point, long_enough)
    known = covariance + np.radians(STAYS) ** 2 * np.eye(len(long_enough))
    probability = _alike(shift, known)
    made = []
    for row, number in enumerate(long_enough):
        # against the others' mean by their precision
        others = np.delete(np.arange(len(long_enough)), row)
        share = np.linalg.solve(known[np.ix_(others, others)], np.ones(len(others)))
        away = np.zeros(len(long_enough))
        away[others] = -share / share.sum()
        away[row] = 1.0
        turned, sd = np.degrees([away @ shift, np.sqrt(away @ known @ away)]).tolist()
        made.append(Mounting(inputs[number].name, turned, sd, probability))
    return tuple(made)


def _zeros(
    post: LogPosterior, point: Point, long_enough: Sequence[int]
) -> tuple[FloatArray, FloatArray]:
    """Zeros of these recordings’ angles [rad] and their covariance, all else solved with them."""
    at = post.of.index(ZERO_NAME)
    rest = np.delete(np.arange(len(point.z)), at)
    H, g = post.reduced(point.blocks)
    q = len(rest)
    whole = np.zeros((q + len(long_enough), q + len(long_enough)))
    pull = np.zeros(len(whole))
    whole[:q, :q] = H[np.ix_(rest, rest)] + np.diag(post.weight[rest] ** 2)
    pull[:q] = g[rest] + post.weight[rest] ** 2 * (point.z - post.mean)[rest]
    for row, number in enumerate(long_enough, q):
        b = point.blocks[number]
        whole[:q, row] = whole[row, :q] = b.H[rest, at]
        whole[row, row] = b.H[at, at] + np.radians(_ANY) ** -2
        pull[row] = b.g[at]
    inverse = inverse_of(whole)
    return -(inverse @ pull)[q:], inverse[q:, q:]


def _alike(shift: FloatArray, covariance: FloatArray) -> float:
    """Probability of zeros so far apart where all are one."""
    from scipy.special import gammaincc

    weight = np.linalg.inv(covariance)
    mean = float(weight.sum(axis=0) @ shift / weight.sum())
    away = shift - mean
    return float(gammaincc(0.5 * (len(shift) - 1), 0.5 * float(away @ weight @ away)))
