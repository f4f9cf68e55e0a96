"""One log-posterior for all that a leg's recordings and priors say.

    −2 ln p = Σ |(T(z, c) − T_measured)/σ|² + Σ ((z − mean)/sd)² + Σ cᵀ·P·c

z are the parameters of leg and laboratory (`surae.inference.coordinates`); c are the latent values
of each recording (`latent.py`). Given z the latents are nearly linear: every step
eliminates them, recording by recording, so that its cost grows with the samples and not with their
square.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky_banded

from surae.base.units import FloatArray
from surae.inference.coordinates import Coordinates
from surae.inference.evidence import LaplaceApproximation, inverse_of
from surae.inference.least_squares.minimise import box_quadratic, eased, predicted_gain
from surae.inference.least_squares.starts import Follow
from surae.inference.noise import NoiseModel
from surae.inference.posterior.banded import solve_band, solve_band_transposed
from surae.inference.posterior.descent import FAR, Secant, shorter
from surae.inference.posterior.latent import Latents
from surae.inference.posterior.linearised import REST, Observed, SensorRows
from surae.inference.problem import FitProblem
from surae.model.activation import IntArray
from surae.model.source import Gaussian

#: Ridge under which the whole step is judged, and the shortest part of a step that is tried.
_RIDGE = 1e-12
_SHORTEST = 1e-3
#: What a search's points are rounded to: in standard deviations of the priors, and of latents as
#: they are, parts of a torque or a gain.
_GRID = 1e-6
#: Damping of a descent's first step, and its evaluations at most, which few ever need.
DAMPING = 1e-3
MOST = 40
#: A descent also rests after so many steps that gained less than this part of its tolerance each:
#: on a kink, where tissue goes slack, less is to be gained than the normal equations promise.
_IDLE = 2
_LITTLE = 1.0


def _damped(damping: float, part: float, begun: float, ratio: float) -> float:
    """Damping after a step that gained so many times what was predicted, or had to be shortened."""
    if part < begun:
        return damping * 2.0
    return max(damping * eased(ratio), 1e-12) if part == 1.0 else damping


def _rounded(each: FloatArray) -> FloatArray:
    """Steps of a search end on a grid, so that rounding does not grow from one to the next.

    Far from a mode a step doubles what two paths differ by, and forty of them make another valley
    of the last digit: EMG in mV would be another leg than the same in V.
    """
    return np.asarray(np.round(each / _GRID) * _GRID)


@dataclass(frozen=True, slots=True)
class Block:
    """One recording's part of the normal equations, its latents eliminated."""

    H: FloatArray  #: Of z, shape (q, q).
    g: FloatArray  #: Its gradient, shape (q,).
    factor: tuple[FloatArray, bool]  #: Of D, the slow latents' part.
    solved: FloatArray  #: D⁻¹·Bᵀ, B the part of z and slow latents, shape (m, q).
    step_c: FloatArray  #: D⁻¹·gradient by the slow latents, shape (m,).
    cost: float
    latent_gain: float  #: By how much latents alone lower it.
    at: IntArray  #: Positions in z of what moves this recording, shape (p,).
    #: Of the k fast gains: their factor L, by columns, and L⁻¹·(derivatives by those p and c, then
    #: gradient), shape (k, p + m + 1).
    band: FloatArray
    fast: FloatArray

    @property
    def log_width(self) -> float:
        """Logarithm of the determinant of the latents' part, lost by integrating over them."""
        slow = np.log(np.abs(np.diag(self.factor[0]))).sum()
        return 2.0 * float(slow + np.log(self.band[:, 0]).sum())

    def followed(self, moved: FloatArray) -> FloatArray:
        """What fast gains go back by, (k, d), where columns, (p + m + 1, d), move the rest."""
        return solve_band_transposed(self.band, self.fast @ moved)


@dataclass(frozen=True, slots=True)
class Point:
    """A point of a posterior: searched coordinates, and the latents of each recording."""

    z: FloatArray
    c: tuple[FloatArray, ...]
    w: tuple[FloatArray, ...]  #: Fast gains of each recording; empty where they are left out.
    cost: float  #: −2 ln p there, but for a constant.
    blocks: tuple[Block, ...] = field(repr=False)  #: The normal equations there.
    damping: float = DAMPING  #: Of the next step.
    rested: bool = False  #: Whether a descent ended here because nothing was to be gained.

    def latents_at(
        self, z: FloatArray, part: float = 1.0
    ) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]:
        """Latents, then fast gains, as the normal equations have them where parameters are z.

        Of a `part` of a step they go the same part of what they would go alone.
        """
        moved = z - self.z
        slow = []
        fast = []
        for c, w, b in zip(self.c, self.w, self.blocks, strict=True):
            slow.append(_rounded(c - part * b.step_c - b.solved @ moved))
            both = np.concatenate([moved[b.at], slow[-1] - c, [part]])
            fast.append(_rounded(w - b.followed(both[:, None])[:, 0]))
        return tuple(slow), tuple(fast)


class LogPosterior(Coordinates):
    """The posterior of a problem."""

    def __init__(
        self,
        problem: FitProblem,
        priors: Mapping[str, Gaussian],
        noise: Sequence[NoiseModel],
        latents: Sequence[Latents],
        sizes: Mapping[str, float],
        *,
        beliefs: Mapping[str, Gaussian] | None = None,
        rate_hz: float = 0.0,
        rest: float = REST,
    ) -> None:
        super().__init__(problem, priors)
        self.noise, self.latents, self.sizes = tuple(noise), tuple(latents), dict(sizes)
        #: Told of every better point of a descent: the model, all its parameters, −2 ln p.
        self.follow: Follow | None = None
        self.fast: float | None = None  #: Size of the drives' errors; None where there are none.
        self.beliefs = dict(beliefs or {})
        self.rate_hz = rate_hz
        self.rest = rest
        self._prepare()
        self.observed = self._anew()

    def _prepare(self) -> None:
        fast = self.fast
        self._fast = [] if fast is None else [each.fast.precision(fast) for each in self.latents]
        #: By recording: products of its fast columns, their factor, what that makes of still rows.
        self._factored: dict[int, tuple[FloatArray, FloatArray, FloatArray]] = {}
        #: Inverse covariance of each recording's slow latents beforehand, shape (m, m).
        self.precisions = [each.precision(self.sizes) for each in self.latents]

    @property
    def rectified(self) -> bool:
        """Whether the noise of all envelopes is known: they were made of raw EMG here."""
        return all(recording.rectified for recording in self.problem.inputs)

    def having(self, **changes: Any) -> "LogPosterior":
        """The posterior with other values of attributes, films' noise being in `latents`."""
        other = copy(self)
        vars(other).update(changes)
        other._prepare()
        if other.fast != self.fast:
            other.observed = other._anew(self.observed.calls)
        return other

    def with_errors(self, size: float) -> "LogPosterior":
        """The posterior with errors of the drives of another size, to be judged at known points.

        Fast gains stay what they are beyond what was expected before; nothing is simulated anew.
        """
        other = copy(self)
        other.fast = size
        other._prepare()
        return other

    def _anew(self, calls: list[int] | None = None) -> Observed:
        """The recordings, nothing of them computed."""
        means = [mean for _, mean in self._fast]
        # coordinates of its own: with this posterior each would keep the other, and all its rows
        at = Coordinates(self.problem, self.priors)
        return Observed(at, self.latents, expected=means, rest=self.rest, calls=calls)

    def still(self) -> tuple[FloatArray, ...]:
        """Latents of which nothing is known yet."""
        return tuple(np.zeros(each.size) for each in self.latents)

    def expected(self) -> tuple[FloatArray, ...]:
        """Fast gains beyond what is expected of them by the envelopes alone: none."""
        none = [mean for _, mean in self._fast] or [np.zeros(0) for _ in self.latents]
        return tuple(map(np.zeros_like, none))

    def variances(self, number: int) -> list[float]:
        """Of the noise of a recording's torque, then of its films."""
        films = self.latents[number].films
        return [self.noise[number].variance, *(film.noise.variance for film in films)]

    def evidence(self, point: Point) -> float:
        """−2 ln Z of the mode near a point, all latent integrated over, but for a constant."""
        total = self.laplace(point).solved()[0]
        for number, b in enumerate(point.blocks):
            films = self.latents[number].films
            counts = self.problem.inputs[number].counted, *(len(film.length) for film in films)
            total += float(np.dot(counts, np.log(self.variances(number))))
            total += b.log_width
            total -= np.linalg.slogdet(self.precisions[number])[1]
            if self._fast:
                prior = cholesky_banded(self._fast[number][0], lower=True)
                total -= 2.0 * float(np.log(prior[0]).sum())
        return float(total)

    def rows(self, point: Point, number: int) -> list[SensorRows]:
        """What moves the torque of a recording, and its films."""
        return self.observed.rows(point.z, point.c[number], point.w[number], number)

    def block(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> Block:
        """A recording's normal equations, its latents eliminated, the fast ones first."""
        each = list(zip(self.observed.rows(z, c, w, number), self.variances(number), strict=True))
        P = self.precisions[number]
        H = np.sum([rows.products / variance for rows, variance in each], axis=0)
        if not np.isfinite(H).all():
            raise FloatingPointError
        at = self.of_recording(number)
        m = len(c)
        q = len(at)
        H[q : q + m, q : q + m] += P
        H[q : q + m, -1] += P @ c
        cost = float(H[-1, -1] + c @ P @ c)
        band = np.zeros((0, 1))
        fast = np.zeros((0, q + m + 1))
        gain = 0.0
        if len(w):
            band, fast, pulled = self._fast_eliminated(each, w, number)
            cost += pulled
            H -= fast.T @ fast
            gain = float(fast[:, -1] @ fast[:, -1])
        D = H[q : q + m, q : q + m]
        factor = cho_factor(D + 1e-12 * np.diag(np.diag(D)), check_finite=False)
        B = H[:q, q : q + m]
        gc = H[q : q + m, -1]
        solved = cho_solve(factor, B.T, check_finite=False)
        step_c = cho_solve(factor, gc, check_finite=False)
        gain += float(gc @ step_c)
        whole = np.zeros((len(z), len(z)))
        g = np.zeros(len(z))
        by_z = np.zeros((m, len(z)))
        whole[np.ix_(at, at)] = H[:q, :q] - B @ solved
        g[at] = H[:q, -1] - solved.T @ gc
        by_z[:, at] = solved
        return Block(whole, g, factor, by_z, step_c, cost, gain, at, band, fast)

    def _fast_eliminated(
        self, each: Sequence[tuple[SensorRows, float]], w: FloatArray, number: int
    ) -> tuple[FloatArray, FloatArray, float]:
        """Factor of a recording's fast gains, what they are solved to, and what they cost.

        The factor is banded, shape (k, b); the others are (k, q + m + 1), of all that is not fast.
        """
        prior, mean = self._fast[number]
        muscles = len(prior) - 1
        band_of = each[0][0].band
        at_c = each[0][0].still.start
        border = reduce(np.add, (rows.border / variance for rows, variance in each))
        away = w + self.observed.expected[number] - mean
        pull = self.fast_product(number, away[:, None])[:, 0]
        border[:, -1] += pull
        if number not in self._factored or self._factored[number][0] is not band_of:
            band = np.zeros((max(len(rows.band) for rows, _ in each), len(w)))
            for rows, variance in each:
                band[: len(rows.band)] += rows.band / variance
            band[0] += prior[0]
            band[muscles] += prior[muscles]
            band = cholesky_banded(band, lower=True, overwrite_ab=True, check_finite=False).T
            still = reduce(np.add, (rows.still_border / variance for rows, variance in each))
            self._factored[number] = band_of, band, solve_band(band, still)
        _, band, still = self._factored[number]
        solved = solve_band(band, border)
        fast = np.hstack([solved[:, :at_c], still, solved[:, at_c:]])
        return band, fast, float(away @ pull)

    def fast_product(self, number: int, moved: FloatArray) -> FloatArray:
        """Inverse covariance of a recording's fast gains times these columns, shape (k, q)."""
        band, _ = self._fast[number]
        m = len(band) - 1
        out = band[0][:, None] * moved
        out[m:] += band[m, :-m, None] * moved[:-m]
        out[:-m] += band[m, :-m, None] * moved[m:]
        return np.asarray(out)

    def blocks(
        self, z: FloatArray, c: Sequence[FloatArray], w: Sequence[FloatArray]
    ) -> tuple[Block, ...]:
        """Normal equations of all recordings."""
        return tuple(self.block(z, *latents, i) for i, latents in enumerate(zip(c, w, strict=True)))

    def reduced(self, blocks: Sequence[Block]) -> tuple[FloatArray, FloatArray]:
        """Hessian and gradient of −½·2 ln p by z of the data, latents eliminated."""
        q = len(self.mean)
        H = sum((b.H for b in blocks), np.zeros((q, q)))
        return H, sum((b.g for b in blocks), np.zeros(q))

    def covariance(self, point: Point) -> FloatArray:
        """Covariance of the searched coordinates, latents eliminated, shape (q, q)."""
        H, _ = self.reduced(point.blocks)
        return inverse_of(H + np.diag(self.weight**2))

    def descend(
        self,
        z: FloatArray,
        c: Sequence[FloatArray] | None = None,
        w: Sequence[FloatArray] | None = None,
        *,
        tolerance: float,
        evaluations: int = MOST,
        damping: float = DAMPING,
    ) -> Point:
        """The mode that a point leads to; it ends where less than `tolerance` is to be gained."""
        z = np.clip(z, self.lower, self.upper)
        c = self.still() if c is None else tuple(c)
        w = self.expected() if w is None or self.fast is None or not len(w[0]) else tuple(w)
        self.observed.anew()
        here = self._point(z, c, w)
        spent = 0
        idle = 0
        last = 1.0
        secant = Secant(len(z))
        eye = np.eye(len(z))
        while True:
            H, g = self._normal(here)
            scale = np.sqrt(np.diag(H))
            A = H / np.outer(scale, scale)
            b = g / scale
            room = (self.lower - here.z) * scale, (self.upper - here.z) * scale
            # damped, a step says nothing of directions that the data hardly tell
            whole = box_quadratic(A + _RIDGE * eye, b, *room)
            latent_gain = sum(x.latent_gain for x in here.blocks)
            left = predicted_gain(A, b, whole) + latent_gain
            rested = bool(left < tolerance) or idle == _IDLE
            if rested or spent >= evaluations:
                self.observed.calls[1] += not rested
                return replace(here, damping=damping, rested=rested)
            A = secant.added(A, scale)
            d = box_quadratic(A + damping * eye, b, *room)
            gain = predicted_gain(A, b, d)
            slope = 2.0 * (latent_gain - float(b @ d))
            begun = min(1.0, 2.0 * last)  # the one before may have had to be shortened
            part = begun
            better = False
            while not better and part > _SHORTEST and spent < evaluations:
                trial = self._trial(here, d / scale, part)
                spent += 1
                better = trial.cost < here.cost
                if np.isfinite(trial.cost):
                    there, turned = self._normal(trial)
                    secant.learn(trial.z - here.z, turned - g, there if better else H)
                if not better:
                    part = shorter(part, slope, trial.cost - here.cost)
            idle = 0 if here.cost - trial.cost > _LITTLE * tolerance else idle + 1
            if not better:
                damping *= 10.0
                continue
            if trial.cost < (1.0 - FAR) * here.cost:
                secant = Secant(len(z))
            last = part
            predicted = max(gain + latent_gain, 1e-300)
            damping = _damped(damping, part, begun, (here.cost - trial.cost) / predicted)
            here = trial
            self._tell(here)

    def _tell(self, point: Point) -> None:
        """Have a better point known."""
        if self.follow is not None:
            self.follow(self.problem.spec, self.values(point.z), float(point.cost))

    def _point(self, z: FloatArray, c: tuple[FloatArray, ...], w: tuple[FloatArray, ...]) -> Point:
        blocks = self.blocks(z, c, w)
        return Point(z, c, w, sum(b.cost for b in blocks) + self.prior_cost(z), blocks)

    def _trial(self, here: Point, step: FloatArray, part: float) -> Point:
        """The point a part of a step leads to; of infinite cost where nothing can be computed."""
        away = _rounded((self.curved(here.z, part * step) - self.mean) * self.weight)
        z = np.clip(self.mean + away / self.weight, self.lower, self.upper)
        try:
            return self._point(z, *here.latents_at(z, part))
        except FloatingPointError:
            return replace(here, cost=np.inf)

    def _normal(self, point: Point) -> tuple[FloatArray, FloatArray]:
        """Hessian and gradient of −½·2 ln p by z, latents eliminated."""
        H, g = self.reduced(point.blocks)
        return H + np.diag(self.weight**2), g + self.weight**2 * (point.z - self.mean)

    def mode_at(
        self, j: int, at: float, near: Point, *, evaluations: int, tolerance: float
    ) -> Point:
        """The mode where a coordinate has a value, from a point nearby that predicts the others."""
        along = self.covariance(near)[:, j]
        z = np.clip(near.z + along / along[j] * (at - near.z[j]), self.lower, self.upper)
        lower = self.lower.copy()
        upper = self.upper.copy()
        z[j] = lower[j] = upper[j] = at
        narrowed = self.having(lower=lower, upper=upper)
        return narrowed.descend(
            z, *near.latents_at(z), evaluations=evaluations, tolerance=tolerance
        )

    def apart(self) -> "LogPosterior":
        """The same posterior for another thread: what it keeps of points is its own."""
        return self.having(observed=self._anew())

    def again(self, point: Point) -> Point:
        """The point of another posterior with the normal equations of this one."""
        return replace(point, blocks=self.blocks(point.z, point.c, point.w))

    def laplace(self, point: Point) -> LaplaceApproximation:
        """What the data say around a point, latents eliminated."""
        H, g = self.reduced(point.blocks)
        cost = sum(b.cost - b.latent_gain for b in point.blocks)
        return LaplaceApproximation(H, g, cost, point.z, self.mean, self.weight)
