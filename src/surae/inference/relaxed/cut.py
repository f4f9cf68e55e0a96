"""The tissue that the muscles' fit takes from rest: where no exponential describes the relaxed leg.

Rest tells a flexible curve (`surae.inference.relaxed.curve`). The muscles of the models have
exponentials; what these leave of it goes to the muscles' fit as a curve of its own, with the doubt
that rest leaves about it, and nothing of the effort comes back to it: a cut posterior (Plummer
2015, Statistics and Computing 25:37-43). Where exponentials describe rest, they stay alone.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import nnls
from scipy.special import chdtrc

from surae.base.units import FloatArray
from surae.inference.judging.grade import Grade
from surae.inference.problem import FitProblem
from surae.inference.relaxed.build import curve_of
from surae.inference.relaxed.context import Laboratory
from surae.inference.relaxed.curve import RelaxedCurve
from surae.inference.relaxed.regressors import TAUS
from surae.model.joint import ANKLE
from surae.model.tissue_curve import TissueCurve

#: Probability of a curve so far from every exponential below which it is none.
LEVEL = 0.01
#: Degrees between angles at which curves are compared, as far apart as the hinges of the curve are,
#: between which it says nothing more; and of the table.
_APART = 5.0
_KNOTS = 1.0
#: Degrees over which the muscles' exponentials may grow e-fold: k of 40 to 600 1/m, arms of 4 cm.
_CALF = np.geomspace(2.5, 40.0, 25)
_TIBIALIS = np.geomspace(4.0, 40.0, 8)
#: Rest has to be as long [s], to reach over so many degrees, and to rise by so many Nm.
_LONG = 12.0
_WIDE = 25.0
_RISES = 2.0
#: Directions of the curve's doubt that are followed: those with more than this part of the largest.
_MATTERS = 1e-3
_DIRECTIONS = 12
#: A variance that the curve has at least at each angle [Nm²].
_FLOOR = 0.02**2


def with_rest(problem: FitProblem) -> FitProblem:
    """The problem with what its recordings' rest has beside exponentials, where that is something.

    A tissue that is in its options already stays.
    """
    options = problem.options
    if options.tissue is not None or options.anatomy != ANKLE:
        return problem
    if any(trial.torque is None for trial in problem.inputs):
        return problem
    curve = curve_of(problem.inputs, Laboratory.of(problem.settings))
    if not isinstance(curve, RelaxedCurve) or not _tells(curve):
        return problem
    beside = tissue_beside(curve)
    if beside is None:
        return problem
    return replace(problem, options=replace(options, tissue=beside))


def doubts_of(problem: FitProblem) -> tuple[TissueCurve, ...]:
    """How the tissue that rest gave to a problem may be otherwise, one standard deviation each."""
    curve = curve_of(problem.inputs, Laboratory.of(problem.settings))
    return tuple(doubts(curve)) if isinstance(curve, RelaxedCurve) else ()


def _tells(curve: RelaxedCurve) -> bool:
    """Whether rest says enough of the curve's form."""
    rises = float(np.diff(curve.torque([curve.low, curve.high])[0])[0])
    return (
        curve.grade is Grade.ADEQUATE
        and not curve.is_declared
        and curve.seconds >= _LONG
        and curve.high - curve.low >= _WIDE
        and rises >= _RISES
    )


def tissue_beside(curve: RelaxedCurve) -> TissueCurve | None:
    """What the best exponentials leave of a relaxed curve; None where that may be nothing.

    Exponentials of calf and tibialis, a line and a constant, by least squares in the posterior's
    covariance C: χ² = dᵀ·C⁻¹·d of as many degrees of freedom as there are angles less seven.
    """
    angles = _passed(curve)
    free = 7  # two exponentials of two numbers each, a line of two, and one that was chosen by
    if len(angles) <= free:
        return None
    mean, covariance = curve.torque(angles)
    root = np.linalg.cholesky(covariance + _FLOOR * np.eye(len(angles)))
    chi2 = _best(angles, mean, np.linalg.inv(root))[0]
    if chdtrc(len(angles) - free, chi2) >= LEVEL:
        return None
    # of the split itself nothing hangs but how large what is left is
    _, calf, tibialis, weights = _best(angles, mean, np.eye(len(angles)))
    knots = np.arange(curve.low, curve.high + _KNOTS, _KNOTS)
    left = curve.torque(knots)[0] - _columns(knots, angles, calf, tibialis) @ weights
    return TissueCurve(tuple(knots.tolist()), tuple(left.tolist()), _shares(curve), TAUS)


def doubts(curve: RelaxedCurve) -> Iterator[TissueCurve]:
    """Directions in which rest leaves the curve unsure, one standard deviation each."""
    angles = np.linspace(curve.low, curve.high, _DIRECTIONS)
    _, covariance = curve.torque(angles)
    sizes, axes = np.linalg.eigh(covariance)
    for size, axis in zip(sizes, axes.T, strict=True):
        if size > _MATTERS * sizes[-1]:
            torque = tuple((np.sqrt(size) * axis).tolist())
            yield TissueCurve(tuple(angles.tolist()), torque, _shares(curve), TAUS)


def _shares(curve: RelaxedCurve) -> tuple[float, ...]:
    """Mean part that relaxes with each of `TAUS`."""
    gamma = np.exp(curve.mean[:, -len(TAUS) :])
    return tuple((np.asarray(curve.share) @ gamma).tolist())


def _passed(curve: RelaxedCurve) -> FloatArray:
    """Angles of the device at which rest tells the curve [deg]."""
    every = np.arange(np.ceil(curve.low), np.floor(curve.high) + 1.0, _APART)
    return np.array([at for at in every if curve.passed(float(at), held=True)])


def _columns(at: FloatArray, angles: FloatArray, calf: float, tibialis: float) -> FloatArray:
    """Exponentials of both sides, a line, and a constant of either sign, shape (n, 5)."""
    one = np.ones_like(at)
    return np.column_stack(
        [
            np.exp((at - angles[-1]) / calf),
            -np.exp(-(at - angles[0]) / tibialis),
            (at - angles.mean()) / 10.0,
            one,
            -one,
        ]
    )


def _best(
    angles: FloatArray, mean: FloatArray, whitening: FloatArray
) -> tuple[float, float, float, FloatArray]:
    """χ², e-folds [deg] and weights of the exponentials that are nearest to a curve."""
    made = []
    for calf in _CALF.tolist():
        for tibialis in _TIBIALIS.tolist():
            rows = whitening @ _columns(angles, angles, calf, tibialis)
            weights, norm = nnls(rows, whitening @ mean)
            made.append((float(norm**2), calf, tibialis, weights))
    return min(made, key=lambda each: each[0])
