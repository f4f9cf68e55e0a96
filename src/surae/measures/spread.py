"""How uncertain all estimates of a fit are together, and the legs that this leaves possible.

A measure is made of several parameters that trade off, so that their covariance matters more than
their intervals: stiffness and slack length apart are weak where the torque they make is well known.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from surae.base.frozen import Comparable
from surae.base.units import FloatArray
from surae.inference import Assessment, FitResult, Interval
from surae.inference.coordinates import straight
from surae.inference.marginal import drawn_anew
from surae.inference.uncertainty.covariance import inverse_root
from surae.measures.leg import ZERO

#: Part of what is not known of the angle's zero that another session, the foot mounted anew by the
#: same hands, draws anew; assumed.
_ANEW = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Spread(Comparable):
    """Covariance of the free parameters as they are searched: logarithms of what is positive."""

    names: tuple[str, ...]  #: Free parameters of the fit, those of the laboratory included.
    log: npt.NDArray[np.bool_]  #: Which of them are on a logarithm, shape (p,).
    #: `values`, `lower`, `upper`: estimates and bounds, in their units, shape (p,).
    values: FloatArray
    lower: FloatArray
    upper: FloatArray
    total: FloatArray  #: Everything that is not known, shape (p, p).
    repeat: FloatArray  #: What another trial of the session would draw anew, shape (p, p).
    #: What another session, electrodes and foot mounted anew, would draw anew, shape (p, p).
    session: FloatArray
    #: Of `total`, what models and sets of imperfections add that the data do not reject, shape (p,
    #: p).
    model: FloatArray
    at_bound: tuple[str, ...]  #: Those that lie at a bound.
    #: Those that the recordings cannot tell from others at all: they have no variance.
    lost: tuple[str, ...]

    def at(self, z: FloatArray) -> FloatArray:
        """Values within the bounds of searched coordinates relative to the estimate, (…, p)."""
        with np.errstate(over="ignore"):
            moved = np.where(self.log, self.values * np.exp(np.clip(z, -50, 50)), self.values + z)
        low, high = np.minimum(self.lower, self.values), np.maximum(self.upper, self.values)
        return np.asarray(np.clip(moved, low, high))

    def moved(self, j: int, by: float) -> float:
        """Value of one parameter, moved by so much as it is searched, bounds or not."""
        value = float(self.values[j])
        return value * float(np.exp(by)) if self.log[j] else value + by

    def sd(self, gradient: FloatArray, covariance: FloatArray | None = None) -> float:
        """Standard deviation along a gradient, shape (p,), by `total` or another covariance."""
        V = self.total if covariance is None else covariance
        return math.sqrt(max(float(gradient @ V @ gradient), 0.0))

    def deviations(self, gradient: FloatArray) -> tuple[float, float, float]:
        """The same in all, between sessions, and between models."""
        return self.sd(gradient), self.sd(gradient, self.session), self.sd(gradient, self.model)

    def draws(self, count: int, seed: int) -> FloatArray:
        """Values of possible legs, shape (count, p), each with its opposite."""
        w, vectors = np.linalg.eigh(self.total)
        root = vectors * np.sqrt(np.maximum(w, 0.0))
        half = np.random.default_rng(seed).standard_normal((count // 2, len(w))) @ root.T
        return self.at(np.concatenate([half, -half]))


def spread_of(result: FitResult, assessment: Assessment) -> Spread:
    """The uncertainty of a fit's free parameters together, and of the zero of its angle."""
    spread, zero = _estimated(result, assessment), np.radians(result.problem.settings.zero_sd)
    if not zero or "angle_zero" in spread.names:
        return spread

    def with_zero(matrix: FloatArray, sd: float) -> FloatArray:
        wider = np.pad(matrix, (0, 1))
        wider[-1, -1] = sd**2
        return wider

    lost = (*spread.lost, ZERO) if spread.lost == spread.names else spread.lost
    return replace(
        spread, names=(*spread.names, ZERO), log=np.append(spread.log, False), lost=lost,
        values=np.append(spread.values, 0.0), lower=np.append(spread.lower, -1.0),
        upper=np.append(spread.upper, 1.0), total=with_zero(spread.total, zero),
        repeat=with_zero(spread.repeat, 0.0), session=with_zero(spread.session, _ANEW * zero),
        model=with_zero(spread.model, 0.0),
    )  # fmt: skip


def _estimated(result: FitResult, assessment: Assessment) -> Spread:
    """The uncertainty of a fit's free parameters together."""
    problem = result.problem
    names = problem.free
    values = np.array([result.values[name] for name in names])
    log = ~straight(names) & (values > 0.0)
    scale = np.where(log, 1.0 / np.where(log, values, 1.0), 1.0)
    both = np.outer(scale, scale)
    bare = Spread(
        names, log, values, problem.lower, problem.upper, *(np.zeros((len(names),) * 2),) * 4,
        result.at_bound, (),
    )  # fmt: skip
    known = result.family is None or np.isfinite(result.family.covariance).all()
    if not (np.isfinite(result.sse) and known):
        return replace(bare, lost=names)
    if result.family is None:
        total, lost = _of_named(result, assessment)
        total = both * total
        return replace(bare, total=total, repeat=total, session=total, lost=lost)
    family = result.family
    by = family.spread.get("model", np.zeros((0, len(names))))
    return replace(
        bare, total=both * family.covariance, repeat=both * drawn_anew(family),
        session=both * drawn_anew(family, mounted=True), model=both * (by.T @ by),
    )  # fmt: skip


def _of_named(result: FitResult, assessment: Assessment) -> tuple[FloatArray, tuple[str, ...]]:
    """Covariance of a named model: its correlations, with the standard errors it believes.

    What lies at a bound may be anywhere between the bounds, and the others move with it.
    """
    names = result.problem.free
    sigma2 = assessment.covariance.sigma2
    root = inverse_root(result.R, names, sigma2, result.bounded)
    matrix = np.zeros((len(names), len(names)))
    if root.matrix.size:
        kept = list(root.kept)
        matrix[np.ix_(kept, kept)] = sigma2 * root.matrix @ root.matrix.T
    lost = tuple(names[root.kept[j]] for group in root.groups for j in group)
    factor = np.ones(len(names))
    if assessment.interval is Interval.ROBUST:
        for j, name in enumerate(names):
            p = assessment.parameters[name]
            if p.sem and p.sem_robust:
                factor[j] = p.sem_robust / p.sem
    return factor[:, None] * matrix * factor, lost
