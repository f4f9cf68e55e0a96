"""What a fit makes small: the torque's residual over all recordings, with its Jacobian."""

from collections.abc import Mapping, Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference.interrupt import checkpoint
from surae.inference.least_squares.minimise import Move, sum_of_squares
from surae.inference.problem import FitProblem
from surae.inference.result import Stage
from surae.model import Simulator
from surae.model.geometry import paths


def simulators(problem: FitProblem) -> tuple[Simulator, ...]:
    """The model tied to each recording."""
    return tuple(problem.spec.simulator(recording, problem.options) for recording in problem.inputs)


class Residuals:
    """Modelled minus measured torque of all recordings, with its Jacobian, weighted.

    Priors follow as further residuals, σ·(ln x − ln median)/spread (`Prior.row`), so that the sum
    of squares over σ², of the torque's `noise` [Nm], is −2 ln of the posterior, but for a constant.
    What is evaluated counts to a stage of the search, of which `within` is another part.
    """

    def __init__(
        self, problem: FitProblem, noise: float = 0.0, within: "Residuals | None" = None
    ) -> None:
        self._problem = problem
        self.noise = noise
        rate = max(recording.rate_hz for recording in problem.inputs)
        self._stage = f"{problem.spec.name} at {rate:.3g} Hz"
        self._stages: dict[str, Stage] = {} if within is None else within._stages
        self._simulators = simulators(problem)
        self._measured = [r.torque for r in problem.inputs if r.torque is not None]
        self._roots = [
            None if recording.weight is None else np.sqrt(recording.weight)
            for recording in problem.inputs
        ]
        self._columns = problem.columns
        self._values = problem.base.copy()
        self._samples = sum(recording.n for recording in problem.inputs)
        self._rows = np.empty((len(self._columns) + 1, self._samples + len(problem.priors)))

    def data_rows(self, x: FloatArray, wanted: Sequence[int] | None = None) -> FloatArray:
        """Jacobian rows and the residual [Nm] of the recordings alone, without priors.

        Of all parameters, which the next call overwrites, or of those that are `wanted`.
        """
        checkpoint()
        self._values[self._columns] = x
        begin = 0
        whole = self._rows
        columns = self._columns
        if wanted is not None:
            whole = np.empty((len(wanted) + 1, self._samples))
            columns = [self._columns[j] for j in wanted]
        for simulator, measured, root in zip(
            self._simulators, self._measured, self._roots, strict=True
        ):
            end = begin + len(measured)
            torque, jacobian = simulator.torque_jacobian(self._values, columns)
            whole[:-1, begin:end] = jacobian
            np.subtract(torque, measured, out=whole[-1, begin:end])
            if root is not None:
                whole[:, begin:end] *= root
            begin = end
        rows = whole[:, : self._samples]
        before = self._stages.get(self._stage, Stage(self._stage, 0, np.inf))
        sse = float(np.fmin(before.cost, sum_of_squares(rows[-1])))
        self._stages[self._stage] = Stage(self._stage, before.evaluations + 1, sse)
        return rows

    @property
    def stages(self) -> tuple[Stage, ...]:
        """What was evaluated so far, by model and rate."""
        return tuple(self._stages.values())

    def rows(self, x: FloatArray) -> FloatArray:
        """Jacobian rows and the residual [Nm], shape (p + 1, n); the next call overwrites them."""
        self.data_rows(x)
        self._rows[:-1, self._samples :] = 0.0
        for column, (name, prior) in enumerate(self._problem.priors.items(), self._samples):
            j = self._problem.free.index(name)
            slope, away = prior.row(float(x[j]))
            self._rows[j, column] = self.noise * slope
            self._rows[-1, column] = self.noise * away
        return self._rows

    def of(self, x: FloatArray) -> tuple[FloatArray, ...]:
        """Measured minus modelled torque of each recording [Nm], as it is, without weights."""
        values = self._problem.values(x)
        return tuple(
            measured - simulator.torque(values)
            for simulator, measured in zip(self._simulators, self._measured, strict=True)
        )

    def sse(self, residuals: Sequence[FloatArray]) -> float:
        """Weighted sum of squares of residuals as `of` gives them [Nm²]."""
        with np.errstate(over="ignore"):
            return sum(
                float(np.sum(residual**2 if root is None else (root * residual) ** 2))
                for residual, root in zip(residuals, self._roots, strict=True)
            )


def jacobian_root(problem: FitProblem, values: Mapping[str, float]) -> FloatArray:
    """Triangular R with RᵀR = JᵀWJ, J the torque's Jacobian at these values, shape (p, p)."""
    with np.errstate(over="ignore", invalid="ignore"):
        rows = Residuals(problem).data_rows(np.array([values[n] for n in problem.free]))[:-1]
    p = len(problem.free)
    if not np.isfinite(rows).all():
        return np.full((p, p), np.nan)
    return np.asarray(np.linalg.qr(rows.T, mode="r"))


_GROUPS = (("k_tri", "x0_tri"), ("k_tib", "x0_tib"))


def curved_move(problem: FitProblem) -> Move:
    """How a point moves along a step so that the passive forces change as predicted.

    The data determine the passive force where the muscle is long, exp(k·(x_ref − x0)), far better
    than k or x0 alone, so the valley of the minimum is the curve k·(x_ref − x0) = constant and a
    straight step leaves it. The step is therefore taken in φ = k·(x_ref − x0) and k: the same to
    first order, and a slack length held at a bound stays there.
    """
    groups = valleys_among(problem, problem.free)

    def move(x: FloatArray, step: FloatArray) -> FloatArray:
        moved = x + step
        for j_k, j_x0, x_ref in groups:
            reach = x_ref - x[j_x0]
            # A step that would turn the stiffness around is cut: bounds keep it positive.
            k = max(moved[j_k], 0.1 * x[j_k])
            phi = x[j_k] * reach + reach * (k - x[j_k]) - x[j_k] * step[j_x0]
            moved[j_k], moved[j_x0] = k, x_ref - phi / k
        return np.asarray(moved)

    return move


def valleys_among(problem: FitProblem, names: Sequence[str]) -> list[tuple[int, int, float]]:
    """Positions of a stiffness and a slack length that are both among the names, and x_ref [m]."""
    return [
        (names.index(k), names.index(x0), longest)
        for k, x0, longest in stiffness_valleys(problem)
        if k in names and x0 in names
    ]


def stiffness_valleys(problem: FitProblem) -> list[tuple[str, str, float]]:
    """Stiffness, slack length and x_ref [m], the greatest length, of each muscle group."""
    angle = np.concatenate([recording.angle for recording in problem.inputs])
    groups = paths(angle=angle, velocity=np.zeros_like(angle), options=problem.options)
    return [
        (k, x0, float(path.length.max())) for (k, x0), path in zip(_GROUPS, groups, strict=True)
    ]
