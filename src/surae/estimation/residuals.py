"""What a fit makes small: the torque's residual over all recordings, with its Jacobian."""

from collections.abc import Sequence

import numpy as np

from surae.estimation.interrupt import checkpoint
from surae.estimation.problem import FitProblem
from surae.model.simulator import Simulator
from surae.units import FloatArray


def simulators(problem: FitProblem) -> tuple[Simulator, ...]:
    """The model tied to each recording."""
    return tuple(problem.spec.simulator(recording, problem.options) for recording in problem.inputs)


class Residuals:
    """Modelled minus measured torque of all recordings, with its Jacobian, weighted.

    Priors follow as further residuals, σ·(ln x − ln median)/spread (`Prior.row`), so that the sum
    of squares over σ² is minus twice the logarithm of the posterior, but for a constant.

    Parameters
    ----------
    problem : FitProblem
        The question.
    noise : float
        Standard deviation σ of the torque's noise [Nm], against which priors are weighed.
    """

    def __init__(self, problem: FitProblem, noise: float = 0.0) -> None:
        self._problem, self.noise = problem, noise
        self._simulators = simulators(problem)
        measured = [recording.torque for recording in problem.inputs]
        self._measured = [torque for torque in measured if torque is not None]
        self._roots = [
            None if recording.weight is None else np.sqrt(recording.weight)
            for recording in problem.inputs
        ]
        self._columns = problem.columns
        self._values = problem.base.copy()
        self._samples = sum(recording.n for recording in problem.inputs)
        self._rows = np.empty((len(self._columns) + 1, self._samples + len(problem.priors)))

    def data_rows(self, x: FloatArray) -> FloatArray:
        """Jacobian rows and the residual [Nm] of the recordings alone, without priors."""
        checkpoint()
        self._values[self._columns] = x
        begin = 0
        for simulator, measured, root in zip(
            self._simulators, self._measured, self._roots, strict=True
        ):
            end = begin + len(measured)
            torque, jacobian = simulator.torque_jacobian(self._values, self._columns)
            self._rows[:-1, begin:end] = jacobian
            np.subtract(torque, measured, out=self._rows[-1, begin:end])
            if root is not None:
                self._rows[:, begin:end] *= root
            begin = end
        return self._rows[:, : self._samples]

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
