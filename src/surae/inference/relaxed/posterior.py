"""Posterior of curve, relaxation and context by linear algebra: Gauss–Newton, Laplace, evidence.

Whitened columns enter through their products alone, so that a step costs the same for a minute and
for an hour of rest.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from surae.base.units import FloatArray
from surae.inference.relaxed.context import Gaussians
from surae.inference.relaxed.noise import variance, whitened
from surae.inference.relaxed.regressors import TAUS, Columns

#: ln γ stays within these: a part that does not matter, and one that cannot be.
_GAMMAS = (-7.0, 1.5)
#: A step is halved at most so often; a search ends where minus twice the log posterior falls by
#: less than this.
_HALVINGS = 5
_ENOUGH = 0.02


@dataclass(frozen=True)
class Whitened:
    """Products of all columns, whitened: of the curve, its lags, the context and the torque."""

    columns: Columns
    ar: float
    ma: float

    @cached_property
    def rows(self) -> FloatArray:
        """The whitened columns, shape (n, k + 1), torque last, less a constant mean."""
        raw = self.columns.everything
        return whitened(raw, self.columns.cuts, self.ar, self.ma)

    @cached_property
    def products(self) -> FloatArray:
        """Products of the columns with each other, shape (k + 1, k + 1)."""
        made: FloatArray = self.rows.T @ self.rows
        return made

    @property
    def log_start(self) -> float:
        """What the first samples of pieces add to the noise's log determinant."""
        return (len(self.columns.cuts) - 1) * 0.5 * float(np.log(variance(self.ar, self.ma)))


@dataclass(frozen=True, slots=True)
class Mode:
    """A posterior under one hypothesis: where it is highest, its curvature, its evidence."""

    z: FloatArray  #: Weights of the curve [Nm], ln γ, context; shape (k,).
    factor: FloatArray  #: Lower Cholesky factor of its precision, shape (k, k).
    sigma: float  #: Standard deviation of the noise's innovations [Nm].
    evidence: float  #: Logarithm of the marginal likelihood, but for a constant of the data.
    misfit: float  #: Sum of squares of the whitened residual, over σ².

    def covariance(self) -> FloatArray:
        """Covariance of all unknowns, shape (k, k)."""
        inverse = cho_solve((self.factor, True), np.eye(len(self.z)))
        return np.asarray(inverse)


def mode_of(
    data: Whitened,
    prior: Gaussians,
    start: FloatArray,
    sigma: float,
    *,
    steps: int = 6,
    noise: bool = True,
) -> Mode:
    """Where the posterior is highest, by Gauss–Newton; the noise's size by its evidence.

    Laplace's approximation: MacKay (1992), Neural Computation 4:415-447, whose effective number of
    parameters gives σ² = r'r/(n − k_eff).
    """
    n = len(data.columns.torque)
    z = start.copy()
    rr, gradient, hessian = _sums(data, z)
    cost = _cost(rr, z, prior, sigma)
    for _ in range(steps):
        precision = hessian / sigma**2 + prior.precision
        factor = cholesky(precision, lower=True)
        slope = gradient / sigma**2 - prior.precision @ (z - prior.mean)
        by = cho_solve((factor, True), slope)
        z, (rr, gradient, hessian), lower = _moved(data, prior, z, by, sigma, cost)
        gained = cost - lower
        cost = lower
        if noise:
            sigma = _size(rr, hessian, prior, sigma, n)
            cost = _cost(rr, z, prior, sigma)
        if gained < _ENOUGH:
            break
    factor = cholesky(hessian / sigma**2 + prior.precision, lower=True)
    evidence = (
        -0.5 * cost
        - float(np.log(np.diag(factor)).sum())
        - 0.5 * prior.log_det
        - n * float(np.log(sigma))
        - data.log_start
    )
    return Mode(z, factor, sigma, evidence, rr / sigma**2)


def _moved(
    data: Whitened, prior: Gaussians, z: FloatArray, by: FloatArray, sigma: float, cost: float
) -> tuple[FloatArray, tuple[float, FloatArray, FloatArray], float]:
    """A step, halved until it helps; where none does, where it was."""
    p = data.columns.elastic.shape[1]
    part = 1.0
    for _ in range(_HALVINGS):
        there = z + part * by
        there[p : p + len(TAUS)] = np.clip(there[p : p + len(TAUS)], *_GAMMAS)
        sums = _sums(data, there)
        reached = _cost(sums[0], there, prior, sigma)
        if reached <= cost + 1e-9:
            return there, sums, reached
        part *= 0.5
    return z, _sums(data, z), cost


def _cost(rr: float, z: FloatArray, prior: Gaussians, sigma: float) -> float:
    away = z - prior.mean
    return rr / sigma**2 + float(away @ prior.precision @ away)


def _size(rr: float, hessian: FloatArray, prior: Gaussians, sigma: float, n: int) -> float:
    """The noise's standard deviation, twice closer to where it agrees with itself."""
    for _ in range(2):
        factor = cholesky(hessian / sigma**2 + prior.precision, lower=True)
        inner = solve_triangular(factor, hessian / sigma, lower=True)
        inner = solve_triangular(factor, inner.T / sigma, lower=True)
        effective = float(np.trace(inner))
        sigma = float(np.sqrt(max(rr, 1e-12) / max(n - effective, 0.25 * n)))
    return sigma


def _sums(data: Whitened, z: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """r'r, J'r and J'J of the whitened residual r at z.

    r = y − (P + Σ γᵢHᵢ)·w − N·c is linear in the columns X, so that J = X·B with B below.
    """
    p = data.columns.elastic.shape[1]
    q = len(TAUS)
    w = z[:p]
    gamma = np.exp(z[p : p + q])
    products = data.products
    k = len(products) - 1
    context = k - p * (1 + q)
    B = np.zeros((k, p + q + context))
    B[:p, :p] = np.eye(p)
    for i in range(q):
        rows = slice(p * (1 + i), p * (2 + i))
        B[rows, :p] = gamma[i] * np.eye(p)
        B[rows, p + i] = gamma[i] * w
    B[p * (1 + q) :, p + q :] = np.eye(context)
    coefficients = np.concatenate([w, *(g * w for g in gamma), z[p + q :], [-1.0]])
    left = products @ coefficients  # columns times minus the residual
    rr = max(float(coefficients @ left), 0.0)
    return rr, -(B.T @ left[:k]), B.T @ products[:k, :k] @ B


def residual(data: Whitened, z: FloatArray) -> FloatArray:
    """The whitened residual at z, shape (n,)."""
    p = data.columns.elastic.shape[1]
    q = len(TAUS)
    gamma = np.exp(z[p : p + q])
    coefficients = np.concatenate([z[:p], *(g * z[:p] for g in gamma), z[p + q :], [-1.0]])
    return np.asarray(-(data.rows @ coefficients))


def jacobian(data: Whitened, z: FloatArray) -> FloatArray:
    """Derivative of what is predicted, whitened, by z; shape (n, k)."""
    p = data.columns.elastic.shape[1]
    q = len(TAUS)
    gamma = np.exp(z[p : p + q])
    rows = data.rows
    lagging = [rows[:, p * (1 + i) : p * (2 + i)] for i in range(q)]
    curve = rows[:, :p] + sum(g * h for g, h in zip(gamma, lagging, strict=True))
    along = np.stack([g * (h @ z[:p]) for g, h in zip(gamma, lagging, strict=True)], axis=1)
    return np.hstack([curve, along, rows[:, p * (1 + q) : -1]])
