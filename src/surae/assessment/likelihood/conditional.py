"""Minima with one parameter held: the points that a profile is made of."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.estimation import FitProblem
from surae.estimation.least_squares import (
    Minimum,
    Outcome,
    box_quadratic,
    column_norms,
    minimise,
    sum_of_squares,
)
from surae.estimation.posterior import LogPosterior, Point
from surae.estimation.residuals import Residuals, curved_move
from surae.units import FloatArray

#: A failed step ends the iteration when no more than this many noise variances are to be gained.
_STALL = 0.01
#: Relative ridge under which the others' answer to a step is predicted.
_RIDGE = 1e-8
#: Evaluations of one minimum at most.
_MOST = 100
#: The same of a posterior, with what is to be gained by the last one.
_UNTIL: dict[str, Any] = {"evaluations": 15, "tolerance": 0.01}


@dataclass(frozen=True, slots=True)
class ConditionalMinimum:
    """The minimum over the other parameters with one parameter at `value`."""

    value: float  #: Of the held parameter.
    x: FloatArray  #: All free parameters, the held one included, shape (p,).
    sse: float  #: Sum of squared residuals, weighted and with priors [Nm²], or −2 ln p.
    #: What predicts the others: triangular factor of the Jacobian by all, (p, p); a posterior's
    #: point.
    local: "FloatArray | Point | None"
    converged: bool = True  #: False where the iteration limit came first.


class Conditional:
    """Finds minima of a problem with one of its free parameters held.

    The parameter stays in the problem with equal bounds: the set that is free to move is smaller
    by one, and the derivative by the held one is there to predict the others' answer to a step.

    `noise` is the standard deviation of the residual [Nm] that priors are weighed against;
    `stopped` is asked before every evaluation: True ends the work with KeyboardInterrupt.
    """

    def __init__(
        self,
        problem: FitProblem,
        noise: float,
        name: str,
        stopped: Callable[[], bool] | None = None,
    ) -> None:
        self._problem, self._stopped = problem, stopped
        self._j = problem.free.index(name)
        self._residuals = Residuals(problem, noise)
        self._move = curved_move(problem)
        self.limits = float(problem.lower[self._j]), float(problem.upper[self._j])
        self._stall = _STALL / problem.n
        self.evaluations = 0

    def at(self, value: float, near: FloatArray, R: Any = None) -> ConditionalMinimum | None:
        """The minimum with the parameter at `value`, from a point nearby.

        With the triangular factor R of the Jacobian there the others' change is predicted. None
        where the model gives no finite torque.
        """
        lower, upper = self._problem.lower.copy(), self._problem.upper.copy()
        lower[self._j] = upper[self._j] = value
        plain = near.copy()
        plain[self._j] = value
        starts = [plain]
        if R is not None:
            starts.append(self._predicted(value, near, R))
            starts.sort(key=self.sse)  # a prediction can leave a narrow valley
        best: Minimum | None = None
        for start in starts:
            minimum = self._minimise(start, lower, upper)
            if minimum is not None and (best is None or minimum.sse < best.sse):
                best = minimum
            if best is not None and best.outcome is Outcome.CONVERGED:
                break
        return (
            None
            if best is None
            else ConditionalMinimum(value, best.x, best.sse, best.R, _settled(best))
        )

    def sse(self, x: FloatArray) -> float:
        """Sum of squared residuals at a point [Nm²]; infinite where there is no finite torque."""
        self.evaluations += 1
        sse = sum_of_squares(self._rows(x)[-1])
        return sse if np.isfinite(sse) else np.inf

    def free(self, near: ConditionalMinimum) -> ConditionalMinimum | None:
        """The minimum over all parameters, the held one too, from a point nearby."""
        minimum = self._minimise(near.x, self._problem.lower, self._problem.upper)
        if minimum is None:
            return None
        return ConditionalMinimum(
            float(minimum.x[self._j]), minimum.x, minimum.sse, minimum.R, _settled(minimum)
        )

    def _minimise(self, x: FloatArray, lower: FloatArray, upper: FloatArray) -> Minimum | None:
        minimum = minimise(
            self._rows, x, lower, upper,
            move=self._move, max_iterations=_MOST, stall=self._stall,
        )  # fmt: skip
        self.evaluations += minimum.iterations
        if minimum.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        return None if minimum.outcome is Outcome.NOT_FINITE else minimum

    def _rows(self, x: FloatArray) -> FloatArray:
        if self._stopped is not None and self._stopped():
            raise KeyboardInterrupt
        with np.errstate(over="ignore", invalid="ignore"):
            return self._residuals.rows(x)

    def _predicted(self, value: float, near: FloatArray, R: FloatArray) -> FloatArray:
        """Predict where the linear problem at `near` puts the others, within their bounds."""
        norms = column_norms(R)
        scale = np.where(norms > 0, norms, 1.0)
        A = R / scale
        low = (self._problem.lower - near) * scale
        high = (self._problem.upper - near) * scale
        low[high <= 0] = high[low >= 0] = 0.0  # what lies at a bound stays there
        low[self._j] = high[self._j] = (value - near[self._j]) * scale[self._j]
        H = A.T @ A + _RIDGE * np.eye(len(near))
        d = box_quadratic(H, np.zeros(len(near)), low, high)
        x = np.clip(self._move(near, d / scale), self._problem.lower, self._problem.upper)
        x[self._j] = value
        return np.asarray(x)


def _settled(minimum: Minimum) -> bool:
    return minimum.outcome is Outcome.CONVERGED


class ConditionalPosterior:
    """Modes of a family's posterior with one of its parameters held; as `Conditional`."""

    def __init__(
        self, posterior: LogPosterior, mode: Point, name: str,
        stopped: Callable[[], bool] | None = None,
    ) -> None:  # fmt: skip
        self._posterior, self._mode, self._stopped = posterior.apart(), mode, stopped
        self._j, self._name = posterior.names.index(name), name
        self.evaluations = 0
        self.limits = self._value(posterior.lower), self._value(posterior.upper)

    def at(self, value: float, near: FloatArray, point: Any = None) -> ConditionalMinimum | None:
        """The mode with the parameter at `value`, from a point of the posterior nearby."""
        del near
        at = self._posterior.start({self._name: value})[self._j]
        return self._counted(
            lambda: self._posterior.held(self._j, at, point or self._mode, **_UNTIL)
        )

    def sse(self, x: FloatArray) -> float:
        """−2 ln p of the mode."""
        del x
        return self._mode.cost

    def free(self, near: ConditionalMinimum) -> ConditionalMinimum | None:
        """The mode over all parameters, from a point nearby."""
        local = near.local
        assert isinstance(local, Point)
        return self._counted(lambda: self._posterior.descend(local.z, local.c, local.w, **_UNTIL))

    def _counted(self, find: Callable[[], Point]) -> ConditionalMinimum | None:
        if self._stopped is not None and self._stopped():
            raise KeyboardInterrupt
        observed = self._posterior.observed
        before = observed.simulated
        try:
            mode = find()
        except FloatingPointError:
            return None
        finally:
            self.evaluations += observed.simulated - before
        x = self._posterior.values(mode.z)[self._posterior.problem.columns]
        return ConditionalMinimum(self._value(mode.z), x, mode.cost, mode)

    def _value(self, z: FloatArray) -> float:
        return self._posterior.by_name(z)[self._name]
