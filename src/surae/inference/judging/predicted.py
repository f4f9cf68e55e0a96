"""The torque of a recording that a fit has not seen, with its interval.

What makes it unsure is what makes the parameters unsure, what each recording has for itself (the
zero of the sensor, the EMG at rest), and what the fit leaves of the torques that it has seen.
"""

import math
from dataclasses import dataclass

import numpy as np

from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.judging.goodness import counted
from surae.inference.uncertainty.combined import Uncertainty
from surae.signals import ModelInputs


@dataclass(frozen=True, slots=True, eq=False)
class TorqueDoubt:
    """How unsure a predicted torque is."""

    #: Shifts of the torque by what is not known [Nm], shape (r, n): the sum of the outer products
    #: of its rows is the covariance of the predicted torque.
    rows: FloatArray
    noise: float  #: Standard deviation of what the fit leaves of such a torque [Nm].

    @property
    def half_width(self) -> FloatArray:
        """Half of the 95 % interval of each sample of the measured torque [Nm], shape (n,)."""
        return np.asarray(NORMAL * np.sqrt(np.sum(self.rows**2, axis=0) + self.noise**2))

    def sd_of(self, weights: FloatArray) -> float:
        """Standard deviation of Σ wᵢ·Tᵢ without noise, `weights` of shape (n,)."""
        return float(np.linalg.norm(self.rows @ weights))

    @property
    def of_mean(self) -> float:
        """Standard deviation of the mean [Nm]; what a fit leaves may be of one sign throughout."""
        n = self.rows.shape[1]
        return math.hypot(self.sd_of(np.full(n, 1.0 / n)), self.noise)

    @property
    def of_changes(self) -> float:
        """Root mean square of the standard deviations of the torque less its mean [Nm]."""
        away = self.rows - self.rows.mean(axis=1, keepdims=True)
        return math.sqrt(float(np.mean(np.sum(away**2, axis=0))) + self.noise**2)


def torque_doubt(result: FitResult, known: Uncertainty, recording: ModelInputs) -> TorqueDoubt:
    """How unsure the torque is that a fit predicts of another recording.

    Parameters
    ----------
    result : FitResult
        The fit.
    known : Uncertainty
        What is known of its parameters.
    recording : ModelInputs
        The recording, with its measured torque: a fit leaves more of one that changes more.

    Returns
    -------
    TorqueDoubt
        Of the samples that count.
    """
    problem = result.problem
    free = problem.free
    known = known.at_assumed  # no arm or path matters to a torque
    vector = problem.spec.vector(result.values, problem.options)
    simulator = problem.spec.simulator(recording, problem.options)
    _, by = simulator.torque_jacobian(vector, problem.columns)
    by = by[:, recording.counts]
    at = [known.names.index(name) for name in free]
    shifts = [rows[:, at] for rows in known.rows.values()]
    shifts.append(known.shift[None, at] / NORMAL)
    shifts.append(np.diag([drawn_anew(result, name) for name in free]))
    rows = np.concatenate(shifts)
    rows = rows[np.any(rows != 0.0, axis=1)]
    return TorqueDoubt(rows @ by, _noise(result, recording))


def drawn_anew(result: FitResult, name: str) -> float:
    """Standard deviation of a parameter that each recording has for itself; 0 of all others.

    That of another value after n, of which mean and scatter are known: Student's t with n − 1
    degrees of freedom, as wide as a normal of 95 %; never more than was believed before any.
    """
    from scipy.special import stdtrit

    values = () if result.posterior is None else result.posterior.each.get(name, ())
    believed = result.solution.beliefs.get(name)
    if not values or believed is None:
        return 0.0
    n = len(values)
    if n < 2:
        return believed.sd
    scatter = float(np.std(values, ddof=1)) * math.sqrt(1.0 + 1.0 / n)
    return min(float(stdtrit(n - 1, 0.975)) / NORMAL * scatter, believed.sd)


def _noise(result: FitResult, recording: ModelInputs) -> float:
    """What a fit leaves of a torque [Nm], in proportion where it changes more than those seen."""
    pairs = zip(*map(counted, result.problem.inputs, result.residuals), strict=True)
    changes, residuals = (np.concatenate([part - part.mean() for part in each]) for each in pairs)
    assert recording.torque is not None
    changing = float(np.std(recording.torque[recording.counts]))
    return max(1.0, changing / max(float(np.std(changes)), 1e-12)) * float(np.std(residuals))
