"""Covariance of the estimates, and the directions in which the data say nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.file_form import filed
from surae.base.frozen import Comparable
from surae.base.records import Listed
from surae.base.units import FloatArray

#: A direction is singular when its information is below this part of the strongest one's, the
#: Jacobian's columns scaled to length 1: what is left there is rounding.
_SINGULAR = 1e-10
#: A parameter takes part in a singular direction of unit length when its share is at least this.
_PART = 0.01


@filed("matrix", "sigma2", "dof", correlation="matrix", directions="inseparable")
@dataclass(frozen=True, slots=True, eq=False)
class Covariance(Comparable):
    """Covariance of the estimates that have one."""

    names: tuple[str, ...]  #: Parameters with a variance.
    matrix: FloatArray  #: Covariance, equation (33), in the products of their units, shape (k, k).
    #: Normalised covariance, ones on the diagonal; also where nothing is left of the residual,
    #: shape (k, k).
    correlation: Listed
    #: Sets of parameters that trade off without changing the torque; a set of one has no influence
    #: at all.
    directions: tuple[tuple[str, ...], ...]
    sigma2: float  #: Variance of the residual [Nm²].
    dof: int  #: Degrees of freedom: samples minus estimated parameters.


def covariance(
    R: FloatArray,
    names: Sequence[str],
    sse: float,
    n: int,
    bounded: Mapping[str, float] | None = None,
) -> Covariance:
    """Covariance σ²(JᵀJ)⁻¹, equation (33) as decision 1 reads it.

    Parameters
    ----------
    R : ndarray, shape (p, p)
        Triangular factor of the Jacobian, RᵀR = JᵀJ.
    names : sequence of str
        Parameters of its columns.
    sse : float
        Sum of squared residuals [Nm²]; σ² = sse/(n − p).
    n : int
        Samples.
    bounded : mapping of str to float, optional
        Parameters that lie at a bound, with the standard deviation of what may be between their
        bounds: they have no variance of their own, and the others do not take them for known.

    Returns
    -------
    Covariance
        Parameters that take part in a singular direction have no variance and are left out; none
        has one where the model gave no finite numbers.
    """
    bounded = bounded or {}
    dof = n - len(names) + len(bounded)
    sigma2 = sse / dof
    if not np.isfinite(sse):
        return Covariance((), np.empty((0, 0)), np.empty((0, 0)), (), sigma2, dof)
    root = inverse_root(R, names, sigma2, bounded)
    known = [j for j in root.known if names[root.positions[j]] not in bounded]
    rows = root.matrix[known]
    inverse = rows @ rows.T
    norms = np.sqrt(np.diag(inverse))
    correlation = np.asarray(inverse / np.outer(norms, norms))
    estimated = tuple(names[root.positions[j]] for j in known)
    directions = tuple(tuple(names[root.positions[j]] for j in group) for group in root.groups)
    return Covariance(estimated, np.asarray(sigma2 * inverse), correlation, directions, sigma2, dof)


@dataclass(frozen=True, slots=True)
class InverseRoot:
    """A root C of the inverse information, (JᵀJ)⁻¹ = C·Cᵀ; the columns of J·C are orthonormal."""

    positions: tuple[int, ...]  #: Positions of its rows' parameters.
    #: C, one row for each of them; r of the k directions are not singular, shape (k, r).
    matrix: FloatArray
    groups: tuple[tuple[int, ...], ...]  #: Rows that a singular direction ties together.

    @property
    def known(self) -> list[int]:
        """Rows that no singular direction takes part in."""
        tied = {j for group in self.groups for j in group}
        return [j for j in range(len(self.matrix)) if j not in tied]


def inverse_root(
    R: FloatArray, names: Sequence[str], sigma2: float, bounded: Mapping[str, float]
) -> InverseRoot:
    """Root of the inverse of RᵀR, with a prior between its bounds for what lies at one of them."""
    # Without noise a prior has no weight beside the data: what lies at its bound is known then.
    kept = tuple(
        j for j, name in enumerate(names) if name not in bounded or (sigma2 > 0 < bounded[name])
    )
    if not kept or not np.isfinite(R).all():
        return InverseRoot(kept, np.empty((0, 0)), ())
    bounds = [np.sqrt(sigma2) / bounded.get(names[j], np.inf) for j in kept]
    A = np.vstack([R[:, kept], np.diag(bounds)])
    norms = np.linalg.norm(A, axis=0)
    scale = np.where(norms > 0, norms, 1.0)
    _, s, Vt = np.linalg.svd(A / scale, full_matrices=False)
    singular = s <= _SINGULAR * s[0]
    C = Vt[~singular].T / s[~singular] / scale[:, None]
    return InverseRoot(kept, np.asarray(C), _inseparable(Vt[singular]))


def _inseparable(directions: FloatArray) -> tuple[tuple[int, ...], ...]:
    """Sets of parameters that the singular directions, shape (k, p), tie together.

    Any mixture of them is as good a basis, but their projector, which links parameters, is unique.
    """
    linked = np.abs(directions.T @ directions) >= _PART**2
    part = np.flatnonzero(np.diag(linked))
    if not len(part):
        return ()
    from scipy.sparse.csgraph import connected_components

    count, group = connected_components(linked[np.ix_(part, part)], directed=False)
    return tuple(tuple(part[group == k].tolist()) for k in range(count))


def ipde(correlation: FloatArray) -> float:
    """Inter-parameter dependency estimator, equation (35): √Σ_{j>i} r_ij².

    Parameters
    ----------
    correlation : ndarray, shape (k, k)
        Normalised covariance.

    Returns
    -------
    float
        0 for independent parameters, at most √(k(k − 1)/2).
    """
    upper = correlation[np.triu_indices(len(correlation), 1)]
    return float(np.sqrt(np.sum(upper**2)))


def half_width(sem: float, dof: float) -> float:
    """Half the width of a 95 % interval: Student's t times the standard error."""
    from scipy.special import stdtrit

    return float(stdtrit(dof, 0.975)) * sem
