"""Minima with one parameter held: the points that a profile is made of."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.base.units import FloatArray
from surae.inference import FitResult, PosteriorMode, fit_problem
from surae.inference.least_squares.minimise import (
    Ends,
    Outcome,
    column_norms,
    minimise,
    sum_of_squares,
)
from surae.inference.least_squares.residuals import Residuals, curved_move
from surae.inference.metres import moved_by_film
from surae.inference.posterior.log_posterior import LogPosterior, Point
from surae.sampling.resumed import resumed

#: A failed step ends the iteration when no more than this many noise variances are to be gained.
_STALL = 0.01
#: Relative ridge under which the others' answer to a step is predicted.
_RIDGE = 1e-8
#: Evaluations of one minimum at most.
_MOST = 100
#: Of a posterior, with what is to be gained by the last one.
_SHORT: Any = {"evaluations": 15, "tolerance": 0.01}


@dataclass(frozen=True, slots=True)
class ConditionalMinimum:
    """The minimum over the other parameters with one parameter at `value`."""

    value: float  #: Of the held parameter.
    x: FloatArray  #: All free parameters, the held one included, shape (p,).
    sse: float  #: Sum of squared residuals, weighted and with priors [Nm²], or −2 ln p.
    #: What predicts the others: triangular factor of the Jacobian by all, (p, p); a posterior's
    #: point.
    local: Any
    converged: bool = True  #: False where the iteration limit came first.


class Conditional:
    """Finds minima of a fit's problem with one of its free parameters held.

    The parameter stays in the problem with equal bounds, so that the derivative by it predicts the
    others' answer to a step. `noise` is the standard deviation of the residual [Nm] that priors are
    weighed against; `stopped` ends the work with KeyboardInterrupt before an evaluation.
    """

    def __init__(
        self, result: FitResult, noise: float, name: str, stopped: Callable[[], bool]
    ) -> None:
        self._problem = problem = result.problem
        self._j = problem.free.index(name)
        self._residuals = Residuals(problem, noise)
        self._stopped = stopped
        self._move = curved_move(problem)
        self.limits = float(problem.lower[self._j]), float(problem.upper[self._j])
        self.evaluations = 0
        x = np.array([result.values[parameter] for parameter in problem.free])
        x = np.clip(x, problem.lower, problem.upper)
        self.fit = ConditionalMinimum(float(x[self._j]), x, self._sse(x), result.R)

    def at(self, value: float, near: ConditionalMinimum) -> ConditionalMinimum | None:
        """The minimum with the parameter at `value`; None where there is no finite torque."""
        lower = self._problem.lower.copy()
        upper = self._problem.upper.copy()
        lower[self._j] = upper[self._j] = value
        plain = np.clip(near.x, lower, upper)
        if value == near.value:
            return self._minimum(plain, lower, upper)
        # What is predicted can leave a narrow valley.
        predicted = np.clip(self._move(near.x, self._answer(value, near)), lower, upper)
        return self._minimum(min(predicted, plain, key=self._sse), lower, upper)

    def free(self, near: ConditionalMinimum) -> ConditionalMinimum | None:
        """The minimum over all parameters, the held one too, from a point nearby."""
        return self._minimum(near.x, self._problem.lower, self._problem.upper)

    def _answer(self, value: float, near: ConditionalMinimum) -> FloatArray:
        """The step that the linear problem takes with the held one; what is at a bound stays."""
        problem = self._problem
        step = np.zeros(len(near.x))
        moving = (near.x > problem.lower) & (near.x < problem.upper)
        moving[self._j] = True
        norms = column_norms(near.local[:, moving])
        scale = np.where(norms > 0, norms, 1.0)
        A = near.local[:, moving] / scale
        at = int(moving[: self._j].sum())
        ridge = _RIDGE * np.eye(len(scale))
        along = np.linalg.solve(A.T @ A + ridge, np.eye(len(scale))[at]) / scale
        step[moving] = along / along[at] * (value - near.value)
        return step

    def _sse(self, x: FloatArray) -> float:
        """Sum of squared residuals at a point [Nm²]; infinite where there is no finite torque."""
        self.evaluations += 1
        sse = sum_of_squares(self._rows(x)[-1])
        return sse if np.isfinite(sse) else np.inf

    def _minimum(
        self, x: FloatArray, lower: FloatArray, upper: FloatArray
    ) -> ConditionalMinimum | None:
        solution = minimise(
            self._rows,
            x,
            lower,
            upper,
            move=self._move,
            ends=Ends(_MOST, stall=_STALL / self._problem.n),
        )
        self.evaluations += solution.iterations
        if solution.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if solution.outcome is Outcome.NOT_FINITE:
            return None
        converged = solution.outcome is Outcome.CONVERGED
        return ConditionalMinimum(
            float(solution.x[self._j]), solution.x, solution.sse, solution.R, converged
        )

    def _rows(self, x: FloatArray) -> FloatArray:
        if self._stopped():
            raise KeyboardInterrupt
        with np.errstate(over="ignore", invalid="ignore"):
            return self._residuals.rows(x)


class ConditionalPosterior:
    """Modes of a family's posterior with one of its parameters held; as `Conditional`."""

    def __init__(
        self,
        result: FitResult,
        posterior: LogPosterior,
        mode: Point,
        name: str,
        stopped: Callable[[], bool],
    ) -> None:
        self._posterior = posterior.apart()
        self._stopped = stopped
        self._j = posterior.names.index(name)
        self._name = name
        #: The path that a film tells, at which lengths that go with it are profiled.
        self._path = dict[str, float]()
        if path := moved_by_film(posterior.problem, name):
            self._path[path] = result.values[path]
            at = posterior.names.index(path)
            lower = posterior.lower.copy()
            upper = posterior.upper.copy()
            lower[at] = upper[at] = mode.z[at]
            self._posterior = self._posterior.having(lower=lower, upper=upper)
        self.evaluations = 0
        ends = self._posterior.lower, self._posterior.upper
        low, high = sorted(map(self._value, ends))
        self.limits = low, high
        self.fit = replace(self._minimum(mode), value=result.values[name])

    def at(self, value: float, near: ConditionalMinimum) -> ConditionalMinimum | None:
        """The mode with the parameter at `value`, from a point of the posterior nearby."""
        at = self._posterior.start({**self._path, self._name: value})[self._j]
        return self._searched(lambda: self._posterior.mode_at(self._j, at, near.local, **_SHORT))

    def free(self, near: ConditionalMinimum) -> ConditionalMinimum | None:
        """The mode over all parameters, from a point nearby."""
        at = near.local
        return self._searched(lambda: self._posterior.descend(at.z, at.c, at.w, **_SHORT))

    def _searched(self, find: Callable[[], Point]) -> ConditionalMinimum | None:
        if self._stopped():
            raise KeyboardInterrupt
        observed = self._posterior.observed
        before = observed.calls[0]
        try:
            return self._minimum(find())
        except FloatingPointError:
            return None
        finally:
            self.evaluations += observed.calls[0] - before

    def _minimum(self, mode: Point) -> ConditionalMinimum:
        x = self._posterior.values(mode.z)[self._posterior.problem.columns]
        return ConditionalMinimum(self._value(mode.z), x, mode.cost, mode)

    def _value(self, z: FloatArray) -> float:
        return self._posterior.by_name(z)[self._name]


#: Finds the minima of a fit with the parameter of this name held, until it is stopped.
Surface = Callable[[str, Callable[[], bool]], Conditional | ConditionalPosterior]


def surface_of(result: FitResult) -> Surface:
    """What profiles of a fit go over: its sum of squares, or the posterior of its family."""
    if isinstance(result.solution, PosteriorMode):
        posterior, mode = resumed(result)
        return lambda name, stopped: ConditionalPosterior(result, posterior, mode, name, stopped)
    problem = result.problem
    noise = 0.0
    if problem.priors:  # they are weighed against what a fit without them leaves
        plain = fit_problem(replace(problem, priors={}), starts=1)
        if plain.solution.is_interrupted:
            raise KeyboardInterrupt
        noise = float(np.sqrt(plain.sse / (problem.n - len(problem.free))))
    return lambda name, stopped: Conditional(result, noise, name, stopped)
