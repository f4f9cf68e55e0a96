"""The most probable parameters under priors, whatever the noise's own correlation.

    −2 ln p = Σ |W(T_model − T)|²/σ² + Σ ((z − mean)/sd)²

W whitens the noise of each recording, an autoregressive process; z are the parameters, those that
are positive by nature on a logarithm, in which their valleys are straighter and no bound of zero is
in the way. A torque zero is each recording's own where there are several.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from surae.estimation.evidence import Quadratic
from surae.estimation.interrupt import checkpoint
from surae.estimation.least_squares import Minimum, Outcome, minimise
from surae.estimation.noise import NoiseModel, noise_behind, noise_of
from surae.estimation.problem import FitProblem
from surae.estimation.residuals import simulators, stiffness_valleys
from surae.estimation.result import is_at_bound
from surae.model.laboratory import EACH_TRIAL, Belief, group_of
from surae.model.parameters import OPTIONAL_PARAMETERS
from surae.model.simulator import TorqueParts
from surae.signals import ModelInputs, thinned
from surae.units import FloatArray

#: Parameters that are searched as they are; all others on a logarithm.
_STRAIGHT = {"m", "x0_tri", "x0_tib", "pt_tri", "pt_tib", *(p.name for p in OPTIONAL_PARAMETERS)}
#: Part of its start below which a parameter on a logarithm does not go, though its bound is zero.
_FLOOR = 1e-2
#: Standard deviation that keeps a parameter the data say nothing of from having none: of the
#: logarithm, and for the others as a part of their bounds' distance.
_VAGUE, _VAGUE_PART = 3.0, 3.0
#: Largest order of the noise's autoregression.
_ORDER = 30
_ZERO = "torque_zero"


@dataclass(frozen=True, slots=True)
class Mode:
    """A most probable point."""

    #: Parameters as they are searched, then the zeros of several recordings, shape (q,).
    z: FloatArray
    cost: float  #: −2 ln p there, but for a constant.


class Target:
    """What is minimised: residual rows of all recordings, whitened, and of all priors.

    `beliefs` are priors of the nuisances among the problem's free parameters, `noise` is that of
    each recording, `extra` are further priors, of parameters as they are searched.
    """

    def __init__(
        self,
        problem: FitProblem,
        beliefs: Mapping[str, Belief],
        noise: Sequence[NoiseModel],
        extra: Mapping[str, Belief] | None = None,
    ) -> None:
        self.problem, self.beliefs, self.noise = problem, beliefs, tuple(noise)
        self.extra = extra or {}
        self.own_zeros = len(problem.inputs) > 1 and _ZERO in problem.free and _ZERO in beliefs
        self.zeros = len(problem.inputs) if self.own_zeros else 0
        self.names = tuple(n for n in problem.free if not (self.own_zeros and n == _ZERO))
        self._simulators = simulators(problem)
        self._measured = [
            np.zeros(recording.n) if recording.torque is None else recording.torque
            for recording in problem.inputs
        ]
        self._columns = [problem.spec.names.index(name) for name in self.names]
        self._own = [problem.free.index(name) for name in self.names]
        self.log = np.array([name not in _STRAIGHT for name in self.names], dtype=bool)
        self._roots = [
            None if recording.weight is None else np.sqrt(recording.weight)
            for recording in problem.inputs
        ]
        low, high = problem.lower[self._own].copy(), problem.upper[self._own].copy()
        starts = problem.base[self._columns]
        low[self.log] = np.maximum(low[self.log], _FLOOR * starts[self.log])
        with np.errstate(divide="ignore"):
            low[self.log], high[self.log] = np.log(low[self.log]), np.log(high[self.log])
        mean, weight = np.zeros(len(low)), np.zeros(len(low))
        centre = self.coordinates(problem.base)
        for j, name in enumerate(self.names):
            belief = self.extra.get(name) or beliefs.get(name)
            if belief is None:
                vague = _VAGUE if self.log[j] else _VAGUE_PART * float(high[j] - low[j])
                belief = Belief(float(centre[j]), vague)
            mean[j], weight[j] = belief.mean, 1.0 / belief.sd
        if self.own_zeros:
            j, zero = problem.free.index(_ZERO), beliefs[_ZERO]
            low = np.append(low, np.full(self.zeros, problem.lower[j]))
            high = np.append(high, np.full(self.zeros, problem.upper[j]))
            mean = np.append(mean, np.full(self.zeros, zero.mean))
            weight = np.append(weight, np.full(self.zeros, 1.0 / zero.sd))
        self.lower, self.upper, self.mean, self.weight = low, high, mean, weight
        self._valleys = [
            (self.names.index(k), self.names.index(x0), longest)
            for k, x0, longest in stiffness_valleys(problem)
            if k in self.names and x0 in self.names
        ]

    def coordinates(self, values: FloatArray) -> FloatArray:
        """Searched coordinates, without zeros, of a whole parameter vector, shape (P,)."""
        x = values[self._columns]
        return np.asarray(np.where(self.log, np.log(np.maximum(x, 1e-300)), x))

    def start(self, values: Mapping[str, float]) -> FloatArray:
        """Searched coordinates, shape (q,), of values by name, moved within the bounds."""
        whole = np.array(
            [values.get(n, b) for n, b in zip(self.problem.spec.names, self.problem.base,
                                              strict=True)]
        )  # fmt: skip
        zeros = np.full(self.zeros, values.get(_ZERO, 0.0))
        z = np.append(self.coordinates(whole), zeros)
        return np.asarray(np.clip(z, self.lower, self.upper))

    def values(self, z: FloatArray) -> FloatArray:
        """The whole parameter vector, shape (P,); a zero of several recordings is their mean."""
        own, problem = z[: len(self.names)], self.problem
        values = problem.base.copy()
        with np.errstate(over="ignore"):
            values[self._columns] = np.clip(
                np.where(self.log, np.exp(own), own),
                problem.lower[self._own],
                problem.upper[self._own],
            )
        if self.own_zeros:
            values[problem.spec.names.index(_ZERO)] = z[len(self.names) :].mean()
        return values

    def scale(self, z: FloatArray) -> FloatArray:
        """∂value/∂z of the parameters, shape (len(names),)."""
        return np.asarray(np.exp(np.where(self.log, z[: len(self.names)], 0.0)))

    def residuals(self, z: FloatArray) -> tuple[FloatArray, ...]:
        """Modelled minus measured torque of each recording [Nm], as it is."""
        values, parts = self.values(z), []
        for number, (simulator, measured) in enumerate(
            zip(self._simulators, self._measured, strict=True)
        ):
            parts.append(simulator.torque(self.of_recording(values, z, number)) - measured)
        return tuple(parts)

    def of_recording(self, values: FloatArray, z: FloatArray, number: int) -> FloatArray:
        """The whole parameter vector of one recording, whose zero may be its own, shape (P,)."""
        if self.own_zeros:
            values = values.copy()
            values[self.problem.spec.names.index(_ZERO)] = z[len(self.names) + number]
        return values

    def parts(self, z: FloatArray, number: int) -> TorqueParts:
        """The modelled torque of one recording, split into its parts."""
        return self._simulators[number].parts(self.of_recording(self.values(z), z, number))

    def data_rows(self, z: FloatArray, *, raw: bool = False) -> list[FloatArray]:
        """Rows (q + 1, n) of each recording: derivatives by z and, last, residual.

        They are weighted and whitened, or `raw`.
        """
        checkpoint()
        values, scale, blocks = self.values(z), self.scale(z), []
        q = len(self.names)
        with np.errstate(over="ignore", invalid="ignore"):
            for number, (simulator, recording, root, noise) in enumerate(
                zip(self._simulators, self.problem.inputs, self._roots, self.noise, strict=True)
            ):
                torque, jacobian = simulator.torque_jacobian(
                    self.of_recording(values, z, number), self._columns
                )
                rows = np.zeros((q + self.zeros + 1, recording.n))
                rows[:q] = jacobian * scale[:, None]
                if self.own_zeros:
                    rows[q + number] = 1.0
                rows[-1] = torque - self._measured[number]
                if root is not None and not raw:
                    rows *= root
                blocks.append(rows if raw else whitened(rows, noise))
        return blocks

    def rows(self, z: FloatArray) -> FloatArray:
        """All rows, those of the priors last, shape (q + 1, N + q)."""
        prior = np.zeros((len(z) + 1, len(z)))
        prior[:-1] = np.diag(self.weight)
        prior[-1] = self.weight * (z - self.mean)
        return np.concatenate([*self.data_rows(z), prior], axis=1)

    def descend(self, z: FloatArray, *, evaluations: int, tolerance: float) -> Mode:
        """The mode that a point leads to; it ends where less than `tolerance` is to be gained."""
        size = max(self.problem.n, 1)
        there: Minimum = minimise(
            self.rows,
            np.clip(z, self.lower, self.upper),
            self.lower,
            self.upper,
            max_iterations=evaluations,
            move=self._curved,
            ftol=tolerance / size,
            stall=10.0 * tolerance / size,
        )
        if there.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        return Mode(there.x, there.sse)

    def _curved(self, z: FloatArray, step: FloatArray) -> FloatArray:
        """A step along the valley of stiffness and slack length, as `curved_move` takes it.

        Data know the passive force at the greatest length, φ = k·(x_ref − x0), and not k or x0.
        """
        moved = z + step
        for j_k, j_x0, x_ref in self._valleys:
            k, reach = np.exp(z[j_k]), x_ref - z[j_x0]
            phi = k * (reach + reach * step[j_k] - step[j_x0])
            moved[j_x0] = x_ref - phi / np.exp(min(moved[j_k], z[j_k] + 2.0))
        return np.asarray(moved)

    def quadratic(self, mode: Mode) -> Quadratic:
        """What data say around a mode; a value at a bound is as sure as the bounds are near."""
        q = len(mode.z)
        information, gradient, cost = np.zeros((q, q)), np.zeros(q), 0.0
        for rows in self.data_rows(mode.z):
            information += rows[:-1] @ rows[:-1].T
            gradient += rows[:-1] @ rows[-1]
            cost += float(rows[-1] @ rows[-1])
        return Quadratic(information, gradient, cost, mode.z, self.mean, self.weight_at(mode.z))

    def weight_at(self, z: FloatArray) -> FloatArray:
        """1/sd of the priors, shape (q,), and of what is at a bound at a point."""
        weight = self.weight.copy()
        for j, name in enumerate(self.names):
            low, high = self.lower[j], self.upper[j]
            if group_of(name) is None and is_at_bound(float(z[j]), float(low), float(high)):
                weight[j] = max(weight[j], np.sqrt(12.0) / (high - low))
        return weight

    def sum_of_squares(self, z: FloatArray) -> float:
        """Weighted sum of squared residuals [Nm²], whatever the noise."""
        total = 0.0
        for e, root in zip(self.residuals(z), self._roots, strict=True):
            total += float(np.sum((e if root is None else root * e) ** 2))
        return total

    def with_noise(self, noise: Sequence[NoiseModel]) -> "Target":
        """The posterior with other noise."""
        return Target(self.problem, self.beliefs, noise, self.extra)

    def of_inputs(self, inputs: tuple[ModelInputs, ...]) -> "Target":
        """The posterior of other recordings."""
        return Target(replace(self.problem, inputs=inputs), self.beliefs, self.noise, self.extra)

    def alone(self, z: FloatArray, number: int) -> tuple["Target", Mode]:
        """One recording of several by itself, and its mode.

        A recording alone knows crosstalk, delay and axis badly. They are the same in all trials, so
        they are held where they are; zero, drift and what electrodes show at rest are its own.
        """
        problem, values = self.problem, self.of_recording(self.values(z), z, number)
        own = [j for j, n in enumerate(problem.free) if group_of(n) in (None, *EACH_TRIAL)]
        free = tuple(problem.free[j] for j in own)
        target = Target(
            replace(
                problem,
                inputs=problem.inputs[number : number + 1],
                free=free,
                base=values,
                lower=problem.lower[own],
                upper=problem.upper[own],
            ),
            {name: belief for name, belief in self.beliefs.items() if name in free},
            self.noise[number : number + 1],
            {name: belief for name, belief in self.extra.items() if name in free},
        )
        return target, target.descend(target.start({}), evaluations=12, tolerance=0.03)

    def own_noise(self, z: FloatArray, *, white: bool = False) -> tuple[NoiseModel, ...]:
        """The noise of each recording, that of several as each by itself has it.

        What a trial differs by from the others is no noise of it, for which it would count less.
        """
        if len(self.problem.inputs) == 1:
            return self.noise_at(z, white=white)
        begin = self.with_noise(self.noise_at(z, white=True))
        each = (begin.alone(z, number) for number in range(len(self.problem.inputs)))
        return tuple(target.noise_at(mode.z, white=white)[0] for target, mode in each)

    def noise_at(self, z: FloatArray, *, white: bool = False) -> tuple[NoiseModel, ...]:
        """The noise of each recording that its residual at a point has.

        White noise is the residual's sum of squares over its degrees of freedom. Correlated noise
        is that whose residual would be as the residual is: estimated values have taken a part of
        it, most at the low frequencies in which they act (`noise_behind`).
        """
        counted = self.problem.n
        lost = counted / max(counted - len(z), 1)
        residuals, models = [], []
        for residual, root in zip(self.residuals(z), self._roots, strict=True):
            e = residual if root is None else root * residual
            e = e[root > 0] if root is not None else e
            residuals.append(e if np.isfinite(e).all() else np.ones(2))
            model = noise_of(residuals[-1], 0)
            models.append(replace(model, variance=max(model.variance * lost, 1e-30)))
        if white:
            return tuple(models)
        taken = self.with_noise(models)._taken(z)
        return tuple(
            noise_behind(e, rows, min(_ORDER, len(e) // 10))
            for e, rows in zip(residuals, taken, strict=True)
        )

    def _taken(self, z: FloatArray) -> list[FloatArray]:
        """Rows (q, n) of each recording in which estimated values have fitted its noise.

        With the Jacobian J of whitened rows and the priors' weight P their products are the matrix
        J(JᵀJ + P)⁻¹Jᵀ, by which least squares take noise into the modelled torque.
        """
        blocks = [rows[:-1] for rows in self.data_rows(z)]
        information = sum(rows @ rows.T for rows in blocks) + np.diag(self.weight**2)
        if not np.isfinite(information).all():
            return [np.zeros((0, rows.shape[1])) for rows in blocks]
        scale = 1.0 / np.sqrt(np.diag(information))
        values, vectors = np.linalg.eigh(information * scale * scale[:, None])
        known = values > len(values) * np.finfo(float).eps * values[-1]
        back = (vectors[:, known] / np.sqrt(values[known])).T * scale
        return [
            back @ (rows if root is None else rows[:, root > 0])
            for rows, root in zip(blocks, self._roots, strict=True)
        ]


def whitened(rows: FloatArray, noise: NoiseModel) -> FloatArray:
    """Rows behind the filter that makes their noise white and of variance 1."""
    from scipy.signal import lfilter

    if noise.order:
        rows = lfilter(np.concatenate([[1.0], -noise.coefficients]), [1.0], rows, axis=1)
    return np.asarray(rows / np.sqrt(noise.variance))


def white_noise(problem: FitProblem, part: float) -> tuple[NoiseModel, ...]:
    """White noise of a part of each recording's torque changes, for the beginning of a search."""
    models = []
    for recording in problem.inputs:
        deviation = part * float(np.std(recording.torque)) if recording.torque is not None else 1.0
        variance = max(deviation, 1e-9) ** 2
        models.append(NoiseModel(np.zeros(0), variance, np.array([variance]), float(recording.n)))
    return tuple(models)


def thinned_problem(problem: FitProblem, rate_hz: float, samples: int) -> FitProblem:
    """The problem on fewer samples: about `rate_hz`, but no fewer than `samples` of each."""
    factors = [
        max(1, min(int(recording.rate_hz // rate_hz), recording.n // samples))
        for recording in problem.inputs
    ]
    return replace(
        problem,
        inputs=tuple(
            thinned(recording, by) for recording, by in zip(problem.inputs, factors, strict=True)
        ),
    )


def straight(names: Sequence[str]) -> npt.NDArray[np.bool_]:
    """Which parameters are searched as they are."""
    return np.array([name in _STRAIGHT for name in names])
