"""One log-posterior for all that a leg's recordings and what is known of legs say.

    −2 ln p = Σ |W(T(z, c) − T_measured)|² + Σ ((z − mean)/sd)² + Σ cᵀ·P·c

z are the parameters of leg and laboratory, those that are positive by nature on a logarithm; c are
the latent values of each recording (`surae.estimation.latent`); W whitens the noise of the torque.
Given z the latents are nearly linear: every step eliminates them, recording by recording, so that
its cost grows with the samples and not with their square.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import (
    cho_factor,
    cho_solve,
    cho_solve_banded,
    cholesky_banded,
    solve_triangular,
)

from surae.estimation.banded import (
    band_products,
    border_products,
    lifted,
    solve_band_transposed,
)
from surae.estimation.evidence import Quadratic, root
from surae.estimation.film import noise_of_film, seen_by
from surae.estimation.interrupt import checkpoint
from surae.estimation.latent import SOURCES, TAIL_S, Latents
from surae.estimation.least_squares import box_quadratic
from surae.estimation.noise import NoiseModel, level_above, noise_behind, whitened
from surae.estimation.problem import FitProblem
from surae.estimation.residuals import simulators, stiffness_valleys
from surae.model.activation import IntArray
from surae.model.laboratory import Gaussian
from surae.model.parameters import PARAMETERS
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Parameters that are searched as they are; all others on a logarithm.
STRAIGHT = {name for name, p in PARAMETERS.items() if p.straight}
#: Least value of a parameter on a logarithm whose bound is zero, as a part of its prior's median.
_FLOOR = 1e-2
#: Largest order of the autoregression that tells the noise's slow part, and what is slow [Hz].
_ORDER, _COUNTED = 30, 2.0
#: Part of the torque's changes below which no noise is taken: sensors and integrator err as much.
_EXACT = 5e-3
#: Draws that show what fast gains take of the noise.
_DRAWS = 16
#: Slow frequencies [Hz], efforts that are rest and effort, as parts of the greatest, and samples
#: below which nothing is said of either.
_SLOW, _EFFORT, _FEWEST = (0.3, 5.0), (0.1, 0.3), 50
_ZERO = "torque_zero"


@dataclass(frozen=True, slots=True)
class Point:
    """A point of the posterior: searched coordinates, and the latents of each recording."""

    z: FloatArray
    c: tuple[FloatArray, ...]
    w: tuple[FloatArray, ...]  #: Fast gains of each recording; empty where they are left out.
    cost: float  #: −2 ln p there, but for a constant.


@dataclass(frozen=True, slots=True)
class Block:
    """One recording's part of the normal equations, its latents eliminated."""

    A: FloatArray
    B: FloatArray
    g: FloatArray
    gc: FloatArray
    factor: tuple[FloatArray, bool]
    solved: FloatArray  #: D⁻¹·Bᵀ
    cost: float
    #: Of the fast gains: their factor, D⁻¹·(derivatives by z and c), D⁻¹·gradient, and their part
    #: of the gain; None without them.
    band: FloatArray | None = None
    fast: FloatArray | None = None
    step: FloatArray | None = None
    gain: float = 0.0

    def moved(self, w: FloatArray, by: FloatArray) -> FloatArray:
        """Fast gains where parameters and slow latents are moved so."""
        if self.step is None or self.fast is None:
            return w
        return np.asarray(w - self.step - self.fast @ by)

    @property
    def latent_gain(self) -> float:
        """By how much latents alone lower the cost."""
        return self.gain + float(self.gc @ cho_solve(self.factor, self.gc))


#: Derivatives by parameters and latents, the residual, and those by the fast gains with their first
#: samples.
_Rows = tuple[FloatArray, FloatArray, FloatArray, tuple[FloatArray, IntArray] | None]


class LogPosterior:
    """The posterior of a problem."""

    def __init__(
        self,
        problem: FitProblem,
        priors: Mapping[str, Gaussian],
        noise: Sequence[NoiseModel],
        latents: Sequence[Latents],
        sizes: Mapping[str, float],
        fast: float | None = None,
        *,
        beliefs: Mapping[str, Gaussian] | None = None,
        rate_hz: float = 0.0,
    ) -> None:
        self.fast, self.rate_hz = fast, rate_hz
        self.beliefs = dict(beliefs or {})
        self._fast = [] if fast is None else [each.fast.precision(fast) for each in latents]
        self.problem, self.priors, self.noise = problem, priors, tuple(noise)
        self.latents, self.sizes = tuple(latents), dict(sizes)
        several = len(problem.inputs) > 1 and _ZERO in problem.free
        self.zeros = len(problem.inputs) if several else 0
        self.names = tuple(n for n in problem.free if not (several and n == _ZERO))
        self._simulators = simulators(problem)
        self._columns = [problem.spec.names.index(n) for n in self.names]
        own = [problem.free.index(n) for n in self.names]
        self._lower, self._upper = problem.lower[own], problem.upper[own]
        self.log = np.array([n not in STRAIGHT for n in self.names])
        low, high = self._lower.copy(), self._upper.copy()
        mean, weight = np.zeros(len(own)), np.zeros(len(own))
        for j, name in enumerate(self.names):
            mean[j], weight[j] = priors[name].mean, 1.0 / priors[name].sd
            if self.log[j]:
                low[j] = np.log(max(low[j], _FLOOR * np.exp(mean[j])))
                high[j] = np.log(high[j])
        if several:
            j, zero = problem.free.index(_ZERO), priors[_ZERO]
            low = np.append(low, np.full(self.zeros, problem.lower[j]))
            high = np.append(high, np.full(self.zeros, problem.upper[j]))
            mean = np.append(mean, np.full(self.zeros, zero.mean))
            weight = np.append(weight, np.full(self.zeros, 1.0 / zero.sd))
        self.lower, self.upper, self.mean, self.weight = low, high, mean, weight
        self._precisions = [each.precision(self.sizes) for each in self.latents]
        self._valleys = [
            (self.names.index(k), self.names.index(x0), longest)
            for k, x0, longest in stiffness_valleys(problem)
            if k in self.names and x0 in self.names
        ]

    def start(self, values: Mapping[str, float]) -> FloatArray:
        """Searched coordinates of values by name, of the prior's mean where there is none."""
        z = self.mean.copy()
        for j, name in enumerate(self.names):
            if name in values:
                value = values[name]
                z[j] = np.log(max(value, 1e-300)) if self.log[j] else value
        if self.zeros and _ZERO in values:
            z[len(self.names) :] = values[_ZERO]
        return np.asarray(np.clip(z, self.lower, self.upper))

    def values(self, z: FloatArray, number: int | None = None) -> FloatArray:
        """The whole parameter vector; of one recording, or with the mean of their zeros."""
        own, values = z[: len(self.names)], self.problem.base.copy()
        with np.errstate(over="ignore"):
            natural = np.where(self.log, np.exp(own), own)
        values[self._columns] = np.clip(natural, self._lower, self._upper)
        if self.zeros:
            zeros = z[len(self.names) :]
            at = self.problem.spec.names.index(_ZERO)
            values[at] = zeros.mean() if number is None else zeros[number]
        return values

    def by_name(self, z: FloatArray) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.problem.spec.names, self.values(z).tolist(), strict=True))

    def scale(self, z: FloatArray) -> FloatArray:
        """∂value/∂z of the parameters, shape (len(names),)."""
        return np.asarray(np.exp(np.where(self.log, z[: len(self.names)], 0.0)))

    def still(self) -> tuple[FloatArray, ...]:
        """Latents of which nothing is known yet."""
        return tuple(np.zeros(each.size) for each in self.latents)

    def expected(self) -> tuple[FloatArray, ...]:
        """Fast gains as the envelopes alone say."""
        if self.fast is None:
            return tuple(np.zeros(0) for _ in self.latents)
        return tuple(mean.copy() for _, mean in self._fast)

    def _set(
        self, z: FloatArray, c: FloatArray, w: FloatArray, number: int
    ) -> tuple[Any, ModelInputs, Latents, FloatArray]:
        """The simulator of a recording at a point, and its parameter vector."""
        simulator, recording, latents = self._of(number)
        values = self.values(z, number)
        gain = latents.log_gain(c) if c.any() else None
        if self.fast is not None:
            quick = latents.fast.log_gain(w, latents.muscles)
            gain = quick if gain is None else gain + quick
        simulator.with_log_gain(gain)
        if "plate_give" in self.problem.spec.names:
            simulator.pulled_by(_measured(recording))
            with np.errstate(over="ignore", invalid="ignore"):
                simulator.pulled_by(simulator.torque(values))
        return simulator, recording, latents, values

    def residual(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> FloatArray:
        """Modelled minus measured torque of a recording [Nm]."""
        simulator, recording, latents, values = self._set(z, c, w, number)
        torque = simulator.torque(values)
        lift = c[latents.slices["drift"]] @ latents.drift
        misfit = c[latents.slices["misfit"]]
        if misfit.any():
            parts = simulator.parts(values)
            bend = misfit.reshape(2, -1) @ latents.misfit
            lift = lift + bend[0] * parts.neural_tri + bend[1] * parts.neural_tib
        return np.asarray(torque + lift - _measured(recording))

    def plain_residual(self, z: FloatArray, recording: ModelInputs, number: int) -> FloatArray:
        """Modelled minus measured torque by the parameters alone [Nm], shape (n,)."""
        simulator: Any = self.problem.spec.simulator(recording, self.problem.options)
        values = self.values(z, number)
        if "plate_give" in self.problem.spec.names:
            simulator.pulled_by(simulator.torque(values))
        return np.asarray(simulator.torque(values) - _measured(recording))

    def effort_ratio(self, point: Point) -> float:
        """Size of the slow residual under effort over that at rest; 0 where one of them is rare.

        Of legs whose EMG errs at the muscles' own frequencies it is 2.5 to 7, of others below 1.5.
        """
        from scipy.signal import butter, sosfiltfilt

        strong, weak = [], []
        for number, recording in enumerate(self.problem.inputs):
            e = self.residual(point.z, point.c[number], point.w[number], number)
            high = min(_SLOW[1], 0.4 * recording.rate_hz)
            sos = butter(2, [_SLOW[0], high], "bandpass", fs=recording.rate_hz, output="sos")
            if recording.n < 60:
                return 0.0
            e = sosfiltfilt(sos, e)
            states = self._simulators[number].active_states(self.values(point.z, number))
            effort = states.sum(axis=0)
            level = effort / max(float(np.percentile(effort, 99.0)), 1e-300)
            strong.append(e[level > _EFFORT[1]])
            weak.append(e[level < _EFFORT[0]])
        under, at_rest = np.concatenate(strong), np.concatenate(weak)
        if min(len(under), len(at_rest)) < _FEWEST:
            return 0.0
        return float(np.sqrt(np.mean(under**2) / max(np.mean(at_rest**2), 1e-300)))

    def evidence(self, point: Point) -> float:
        """−2 ln Z of a mode, all that is latent integrated over, but for a constant."""
        blocks = self.blocks(point.z, point.c, point.w)
        H, _ = self.reduced(point.z, blocks)
        total = point.cost + np.linalg.slogdet(H + np.diag(self.weight**2))[1]
        total -= float(np.sum(np.log(self.weight**2)))
        for number, (b, noise) in enumerate(zip(blocks, self.noise, strict=True)):
            total += self.problem.inputs[number].n * float(np.log(noise.variance))
            total += 2.0 * float(np.log(np.abs(np.diag(b.factor[0]))).sum())
            total -= np.linalg.slogdet(self._precisions[number])[1]
            for film in self.latents[number].films:
                total += len(film.length) * float(np.log(film.noise.variance))
            if b.band is not None:
                prior = cholesky_banded(self._fast[number][0], lower=True)
                total += 2.0 * float(np.log(b.band[0]).sum() - np.log(prior[0]).sum())
        return float(total)

    def _of(self, number: int) -> tuple[Any, ModelInputs, Latents]:
        return self._simulators[number], self.problem.inputs[number], self.latents[number]

    def rows(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> _Rows:
        """Derivatives by z, (q, n), by c, (m, n), and residual (n,) of a recording; whitened.

        Then those by the fast gains, each from its first sample on, (k, l) and (k,).
        """
        checkpoint()
        simulator, recording, latents, values = self._set(z, c, w, number)
        with np.errstate(over="ignore", invalid="ignore"):
            torque, jacobian = simulator.torque_jacobian(values, self._columns)
        q, n = len(self.names), recording.n
        rows = np.zeros((len(z) + latents.size + 1, n))
        rows[:q] = jacobian * self.scale(z)[:, None]
        if self.zeros:
            rows[q + number] = 1.0
        own = rows[len(z) : -1]
        parts = simulator.parts(values)
        neural = parts.neural_tri, parts.neural_tib
        half = len(latents.misfit)
        at = latents.slices["misfit"].start
        for group in range(2):
            own[at + group * half : at + (group + 1) * half] = latents.misfit * neural[group]
        own[latents.slices["drift"]] = latents.drift
        response = simulator.drive_response(values)
        self._gain_rows(response, recording, latents, own)
        rows[-1] = (
            torque
            - _measured(recording)
            + c[latents.slices["drift"].start :] @ own[latents.slices["drift"].start :]
        )
        if recording.weight is not None:
            rows *= np.sqrt(recording.weight)
        rows = whitened(rows, self.noise[number])
        quick = None if self.fast is None else self._fast_columns(response, values, number)
        return rows[: len(z)], rows[len(z) : -1], rows[-1], quick

    def _fast_columns(
        self, response: Any, values: FloatArray, number: int
    ) -> tuple[FloatArray, IntArray]:
        """Derivatives by the fast gains, whitened, (k, l), and their first samples, (k,)."""
        _, recording, latents = self._of(number)
        fast, m = latents.fast, len(latents.muscles)
        order = self.noise[number].order
        size = fast.shapes.shape[1] + int(self._tail(values) * recording.rate_hz)
        columns = np.zeros((len(fast.first), m, size + order))
        for at, muscle in enumerate(latents.muscles):
            columns[:, at, :size] = response.columns(muscle, fast.shapes, fast.first, size)
        columns = columns.reshape(-1, size + order)
        first = np.repeat(fast.first, m)
        if recording.weight is not None:
            samples = np.minimum(first[:, None] + np.arange(size + order), recording.n - 1)
            columns *= np.sqrt(recording.weight)[samples]
        columns = whitened(columns, self.noise[number])
        past = first[:, None] + np.arange(size + order) >= recording.n
        columns[past] = 0.0
        return np.ascontiguousarray(columns), first

    def film_rows(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> list[_Rows]:
        """The same as `rows`, of the fascicles' lengths in each of a recording's films."""
        if not self.latents[number].films:
            return []
        simulator, recording, latents, values = self._set(z, c, w, number)
        with np.errstate(over="ignore", invalid="ignore"):
            lengths, jacobians = simulator.length_jacobian(values, self._columns)
        response = simulator.drive_response(values)
        by_name = dict(zip(self.problem.spec.names, values.tolist(), strict=True))
        q, each = len(self.names), []
        for film, at in zip(latents.films, latents.own_of_films(), strict=True):
            grown = 1.0 + by_name.get(film.names[0], 0.0)
            rows = np.zeros((len(z) + latents.size + 1, recording.n))
            rows[:q] = jacobians[film.group] * self.scale(z)[:, None]
            self._gain_rows(response, recording, latents, rows[len(z) : -1], film.group)
            rows = grown * film.at_frames(rows)
            length = film.at_frames(lengths[film.group])
            for name, by in zip(film.names, (length, 1.0), strict=True):
                if name in self.names:
                    rows[self.names.index(name)] = by
            rows[len(z) + at.start : len(z) + at.stop] = film.drift
            rows[-1] = seen_by(film.channel, by_name, length) + c[at] @ film.drift - film.length
            rows = whitened(rows, film.noise)
            quick = None
            if self.fast is not None:
                short, first = self._fast_lengths(response, values, number, film.group)
                quick = film.short(grown * short, first)
            each.append((rows[: len(z)], rows[len(z) : -1], rows[-1], quick))
        return each

    def _fast_lengths(
        self, response: Any, values: FloatArray, number: int, group: int
    ) -> tuple[FloatArray, IntArray]:
        """Derivatives of a group's length by the fast gains, (k, l), and first samples, (k,)."""
        _, recording, latents = self._of(number)
        fast, m = latents.fast, len(latents.muscles)
        size = fast.shapes.shape[1] + int(self._tail(values) * recording.rate_hz)
        columns = np.zeros((len(fast.first), m, size))
        for at, muscle in enumerate(latents.muscles):
            if group == int(muscle == 0):
                columns[:, at] = response.columns(
                    muscle, fast.shapes, fast.first, size, lengths=True
                )
        return columns.reshape(-1, size), np.repeat(fast.first, m)

    def _tail(self, values: FloatArray) -> float:
        """How long a fast gain is followed [s]."""
        f0 = float(values[self.problem.spec.names.index("f0")])
        return min(TAIL_S, 0.25 + 1.2 / f0)

    def _gain_rows(
        self,
        response: Any,
        recording: ModelInputs,
        latents: Latents,
        own: FloatArray,
        group: int | None = None,
    ) -> None:
        """Derivatives by the slow gains, each followed for as long as it changes anything.

        Of the torque, or of the length of a muscle `group`.
        """
        hats = latents.gain
        k, n = hats.shape
        spacing = int(np.ceil(n / (k - 1)))
        first = np.array([max(0, np.flatnonzero(hat)[0]) for hat in hats], dtype=np.int64)
        width = min(n, 2 * spacing + 1)
        shapes = np.zeros((k, width))
        for j in range(k):
            piece = hats[j, first[j] : first[j] + width]
            shapes[j, : len(piece)] = piece
        size = min(n, width + int(TAIL_S * recording.rate_hz))
        for at, muscle in enumerate(latents.muscles):
            if group not in (None, int(muscle == 0)):
                continue
            columns = response.columns(muscle, shapes, first, size, lengths=group is not None)
            for j in range(k):
                end = min(n, first[j] + size)
                own[at * k + j, first[j] : end] = columns[j, : end - first[j]]

    def block(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> Block:
        """A recording's normal equations, its latents eliminated, the fast ones first."""
        seen = [self.rows(z, c, w, number), *self.film_rows(z, c, w, number)]
        P = self._precisions[number]
        each = [np.concatenate([Jz, Jc, e[None]]) for Jz, Jc, e, _ in seen]
        with np.errstate(over="ignore", invalid="ignore"):
            H = np.sum([both @ both.T for both in each], axis=0)
        if not np.isfinite(H).all():
            raise FloatingPointError
        q, m, quick = len(z), len(c), seen[0][3]
        H[q : q + m, q : q + m] += P
        H[q : q + m, -1] += P @ c
        cost = float(H[-1, -1] + c @ P @ c)
        band = fast = step = None
        gain = 0.0
        if quick is not None:
            columns, first = quick
            prior, mean = self._fast[number]
            muscles = len(self.latents[number].muscles)
            spacing = float(first[-1]) / (len(first) // muscles - 1)
            reach = muscles * (int(np.ceil(columns.shape[1] / spacing)) + 2)
            band = np.zeros((min(reach, len(first) - 1) + 1, len(first)))
            border = np.zeros((len(first), len(H)))
            for both, (*_, short) in zip(each, seen, strict=True):
                assert short is not None
                band_products(*short, band)
                border_products(*short, np.ascontiguousarray(both.T), border)
            band[0] += prior[0]
            band[muscles] += prior[muscles]
            away = w - mean
            pull = self.fast_product(number, away[:, None])[:, 0]
            cost += float(away @ pull)
            border[:, -1] += pull
            band = cholesky_banded(band, lower=True, check_finite=False)
            solved_w = cho_solve_banded((band, True), border, check_finite=False)
            H -= border.T @ solved_w
            fast, step = solved_w[:, :-1], solved_w[:, -1]
            gain = float(border[:, -1] @ step)
        D = H[q : q + m, q : q + m]
        factor = cho_factor(D + 1e-12 * np.diag(np.diag(D)), check_finite=False)
        B, gc = H[:q, q : q + m], H[q : q + m, -1]
        solved = cho_solve(factor, B.T, check_finite=False)
        return Block(H[:q, :q], B, H[:q, -1], gc, factor, solved, cost, band, fast, step, gain)

    def precision(self, number: int) -> FloatArray:
        """Inverse covariance of a recording's slow latents beforehand, shape (m, m)."""
        return self._precisions[number]

    def fast_product(self, number: int, moved: FloatArray) -> FloatArray:
        """Inverse covariance of a recording's fast gains times these columns, shape (k, q)."""
        band, _ = self._fast[number]
        m = len(band) - 1
        out = band[0][:, None] * moved
        if band[m].any():
            out[m:] += band[m, :-m, None] * moved[:-m]
            out[:-m] += band[m, :-m, None] * moved[m:]
        return np.asarray(out)

    def blocks(
        self, z: FloatArray, c: Sequence[FloatArray], w: Sequence[FloatArray]
    ) -> list[Block]:
        """Normal equations of all recordings."""
        return [
            self.block(z, own, quick, number)
            for number, (own, quick) in enumerate(zip(c, w, strict=True))
        ]

    def prior_cost(self, z: FloatArray) -> float:
        """−2 ln of the priors of z."""
        return float(np.sum((self.weight * (z - self.mean)) ** 2))

    def reduced(self, z: FloatArray, blocks: Sequence[Block]) -> tuple[FloatArray, FloatArray]:
        """Hessian and gradient of −½·2 ln p by z of the data, latents eliminated."""
        H, g = np.zeros((len(z), len(z))), np.zeros(len(z))
        for b in blocks:
            H += b.A - b.B @ b.solved
            g += b.g - b.solved.T @ b.gc
        return H, g

    def descend(
        self, z: FloatArray, c: Sequence[FloatArray] | None = None,
        w: Sequence[FloatArray] | None = None, *, evaluations: int, tolerance: float,
    ) -> Point:  # fmt: skip
        """The mode that a point leads to; it ends where less than `tolerance` is to be gained."""
        z = np.clip(z, self.lower, self.upper)
        c = self.still() if c is None else tuple(c)
        w = self.expected() if w is None or self.fast is None else tuple(w)
        if self.fast is not None and not len(w[0]):
            w = self.expected()
        blocks = self.blocks(z, c, w)
        cost = sum(b.cost for b in blocks) + self.prior_cost(z)
        damping, growth = 1e-3, 2.0
        for _ in range(evaluations):
            H, g = self.reduced(z, blocks)
            H = H + np.diag(self.weight**2)
            g = g + self.weight**2 * (z - self.mean)
            scale = np.sqrt(np.diag(H))
            A, b = H / np.outer(scale, scale), g / scale
            room = (self.lower - z) * scale, (self.upper - z) * scale
            d = box_quadratic(A + damping * np.eye(len(z)), b, *room)
            gain = -float(d @ (2.0 * b + A @ d))
            latent_gain = sum(x.latent_gain for x in blocks)
            if gain + latent_gain < tolerance:
                break
            step = d / scale
            new = np.clip(self._curved(z, step), self.lower, self.upper)
            moved = new - z
            trial_c = tuple(
                own - cho_solve(x.factor, x.gc, check_finite=False) - x.solved @ moved
                for own, x in zip(c, blocks, strict=True)
            )
            trial_w = w
            if self.fast is not None:
                trial_w = tuple(
                    x.moved(own, np.concatenate([moved, after_c - before_c]))
                    for own, x, after_c, before_c in zip(w, blocks, trial_c, c, strict=True)
                )
            try:
                trial = self.blocks(new, trial_c, trial_w)
                after = sum(x.cost for x in trial) + self.prior_cost(new)
            except FloatingPointError:
                after = np.inf
            if after < cost:
                ratio = (cost - after) / max(gain + latent_gain, 1e-300)
                z, c, w, blocks, cost = new, trial_c, trial_w, trial, after
                damping = max(damping * np.clip(1 - (2 * ratio - 1) ** 3, 0.1, 10.0), 1e-12)
                growth = 2.0
            else:
                damping, growth = damping * growth, growth * 2.0
                if damping > 1e8:
                    break
        return Point(z, c, w, cost)

    def _curved(self, z: FloatArray, step: FloatArray) -> FloatArray:
        """A step along the valley of k and x0, in which φ = k·(x_ref − x0) moves straight."""
        moved = z + step
        for j_k, j_x0, x_ref in self._valleys:
            k, reach = np.exp(z[j_k]), x_ref - z[j_x0]
            phi = k * (reach + reach * step[j_k] - step[j_x0])
            moved[j_x0] = x_ref - phi / np.exp(min(moved[j_k], z[j_k] + 2.0))
        return np.asarray(moved)

    def quadratic(self, point: Point) -> Quadratic:
        """What the data say around a point, latents eliminated."""
        blocks = self.blocks(point.z, point.c, point.w)
        H, g = self.reduced(point.z, blocks)
        cost = sum(b.cost - b.latent_gain for b in blocks)
        return Quadratic(H, g, cost, point.z, self.mean, self.weight)

    def learnt_sizes(self, point: Point) -> dict[str, float]:
        """Standard deviations of the latents that the data ask for, one step of expectation."""
        squares, counts = dict.fromkeys(SOURCES, 0.0), dict.fromkeys(SOURCES, 0.0)
        blocks = self.blocks(point.z, point.c, point.w)
        H, _ = self.reduced(point.z, blocks)
        V = np.linalg.inv(H + np.diag(self.weight**2))
        for c, b, latents in zip(point.c, blocks, self.latents, strict=True):
            cov = cho_solve(b.factor, np.eye(len(c))) + b.solved @ V @ b.solved.T
            for source in SOURCES:
                at, K = latents.slices[source], latents.inverses[source]
                squares[source] += float(c[at] @ K @ c[at] + np.sum(K * cov[at, at]))
                counts[source] += len(K)
        return {s: float(np.sqrt(squares[s] / max(counts[s], 1.0))) for s in SOURCES}

    def learnt_films(self, point: Point) -> tuple[Latents, ...]:
        """The latents with what residuals say of the noise of each film."""
        if not any(latents.films for latents in self.latents):
            return self.latents
        blocks = self.blocks(point.z, point.c, point.w)
        H, _ = self.reduced(point.z, blocks)
        root = np.linalg.cholesky(np.linalg.inv(H + np.diag(self.weight**2)))
        learnt = []
        for number, (c, w, b) in enumerate(zip(point.c, point.w, blocks, strict=True)):
            latents, films = self.latents[number], []
            lower = np.linalg.cholesky(cho_solve(b.factor, np.eye(len(c))))
            rows = self.film_rows(point.z, c, w, number)
            simulator, _, _, values = self._set(point.z, c, w, number)
            lengths = simulator.tendon(values).muscle_length
            for film, at, (Jz, Jc, _, _) in zip(
                latents.films, latents.own_of_films(), rows, strict=True
            ):
                taken = np.concatenate([root.T @ (Jz - b.solved.T @ Jc), lower.T @ Jc])
                seen = seen_by(
                    film.channel, self.by_name(point.z), film.at_frames(lengths[film.group])
                )
                e = seen + c[at] @ film.drift - film.length
                films.append(replace(film, noise=noise_of_film(e, taken)))
            learnt.append(replace(latents, films=tuple(films)))
        return tuple(learnt)

    def learnt_noise(self, point: Point, *, white: bool = False) -> tuple[NoiseModel, ...]:
        """The noise of each recording, of its residual and what estimates have taken of it.

        Fast gains can follow nearly all that is slow. What is seen of the EMG's noise leaves the
        torque's as it is, which counts some of it twice; of greater errors the noise is white.
        """
        if self.fast == 0.0:
            return self.noise
        blocks = self.blocks(point.z, point.c, point.w)
        H, _ = self.reduced(point.z, blocks)
        V = np.linalg.inv(H + np.diag(self.weight**2))
        models = []
        for number, (c, w, b) in enumerate(zip(point.c, point.w, blocks, strict=True)):
            Jz, Jc, _, quick = self.rows(point.z, c, w, number)
            recording = self.problem.inputs[number]
            e = self.residual(point.z, c, w, number)
            if recording.weight is not None:
                e = e * np.sqrt(recording.weight)
            # U with UᵀU = the hat matrix: of z after latents, and of the latents
            Uz = root(np.asarray(V)) @ (Jz - b.solved.T @ Jc)
            U = np.concatenate([Uz, solve_triangular(b.factor[0], Jc, trans="T", lower=False)])
            if quick is not None:
                U = np.concatenate([U, self._drawn(quick, b, len(e))])
            model = noise_behind(e, U, 0 if white or self.fast else min(_ORDER, len(e) // 10))
            # samples count for as little as the slow part says, in which parameters act: a noise
            # model that is correlated itself lets the torque go where the model is wrong
            slow = level_where_filtered(model, recording).below(_COUNTED / recording.rate_hz)
            least = (_EXACT * float(np.std(_measured(recording)))) ** 2
            level = max(slow, model.variance, least, 1e-30)
            models.append(replace(model, coefficients=np.zeros(0), variance=level))
        return tuple(models)

    def _drawn(self, quick: tuple[FloatArray, IntArray], b: Block, n: int) -> FloatArray:
        """Rows whose products are on average those of what fast gains take of the noise."""
        columns, first = quick
        rng = np.random.default_rng(0)
        white = rng.standard_normal((len(first), _DRAWS)) / np.sqrt(_DRAWS)
        # L·Lᵀ = D, so that L⁻ᵀ·white has the covariance D⁻¹
        assert b.band is not None
        drawn = solve_band_transposed(b.band, white)
        taken = np.zeros((n, _DRAWS))
        lifted(columns, first, drawn, taken)
        return np.ascontiguousarray(taken.T)

    def having(self, **changes: Any) -> "LogPosterior":
        """The posterior with other noise or sizes."""
        given: dict[str, Any] = {
            "problem": self.problem, "priors": self.priors, "noise": self.noise,
            "latents": self.latents, "sizes": self.sizes, "fast": self.fast,
            "beliefs": self.beliefs, "rate_hz": self.rate_hz,
        }  # fmt: skip
        return LogPosterior(**{**given, **changes})


def _measured(recording: ModelInputs) -> FloatArray:
    return np.zeros(recording.n) if recording.torque is None else recording.torque


def straight(names: Sequence[str]) -> npt.NDArray[np.bool_]:
    """Which parameters are searched as they are."""
    return np.array([name in STRAIGHT for name in names])


def level_where_filtered(noise: NoiseModel, recording: ModelInputs) -> NoiseModel:
    """The noise without what the preparation's low-pass took from it.

    A noise model trusts most the frequencies with the least residual. Those that a filter emptied
    of noise hold the model's own errors still. At half of the cut-off the torque, sharpened, has
    lost 1 % of its power.
    """
    if recording.lowpass is None:
        return noise
    return level_above(noise, 0.5 * recording.lowpass[0] / recording.rate_hz)
