"""What a family's member is worth of a recording that the fit has not seen.

Departures are chosen by what they explain of the fit's own movement: how the torque goes with speed
and angle there. Nothing says that they go on so elsewhere, and the simplest member, which has none,
may be right. How far both are apart therefore widens the interval.

A device's departures (its plate, its zeros, the foot on it) are there in the next movement too. Of
inverse dynamics there is no device: what speed and angle explain there are also the errors of that
movement's forces and masses. Where such a fit is not adequate and the movement is another one, both
are averaged, each by what it leaves of the fit's own torque, as linear combinations of forecasts
are (Bates and Granger 1969).

J. M. Bates, C. W. J. Granger (1969). The combination of forecasts. Operational Research Quarterly
20(4):451-468.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.judging.goodness import counted
from surae.model import get_model
from surae.model.laboratory import RIGID
from surae.signals import ModelInputs

#: A movement is the fit's where its angle and its speed scatter by up to so many times as much.
_ALIKE = 1.1


@dataclass(frozen=True, slots=True)
class BesideSimplest:
    """A torque beside that of the family's simplest member."""

    torque: FloatArray  #: What is predicted [Nm], shape (n,).
    share: float  #: Weight of the simplest member in it, 0 … 1.
    row: FloatArray  #: By how much they are apart, as a shift of the torque [Nm], shape (n,).
    simplest: FloatArray  #: The simplest member's torque [Nm], shape (n,).


def moves_otherwise(others: Sequence[ModelInputs], recording: ModelInputs) -> bool:
    """Whether a recording's angle and speed scatter otherwise than those of all of the others."""

    def scatters(of: ModelInputs) -> FloatArray:
        spread = np.stack([of.angle, of.velocity])[:, of.counts]
        return np.asarray(np.maximum(spread.std(axis=1), 1e-6))

    spread = scatters(recording)
    apart = [np.abs(np.log(spread / scatters(each))).max() for each in others]
    return bool(min(apart) > np.log(_ALIKE))


def beside_simplest(
    result: FitResult, recording: ModelInputs, torque: FloatArray, *, adequate: bool
) -> BesideSimplest | None:
    """The torque of a family's fit beside its simplest member's; None where that is not known.

    Parameters
    ----------
    result : FitResult
        A fit of the family, which knows its simplest member.
    recording : ModelInputs
        What is predicted. Signals that a causal filter made are of a predictor, which has one
        model.
    torque : ndarray, shape (n,)
        By the fit's own parameters [Nm].
    adequate : bool
        Whether the fit is; else, of inverse dynamics, the two are averaged where the movement is
        another one.

    Returns
    -------
    BesideSimplest or None
        None of a named model, and where the simplest member has no torque.
    """
    problem = result.problem
    known = result.posterior
    if known is None or not known.simplest or recording.effort is not None:
        return None
    spec = get_model(RIGID)
    vector = spec.vector(known.simplest, problem.options)

    def simplest(of: ModelInputs) -> FloatArray:
        with np.errstate(over="ignore", invalid="ignore"):
            return np.asarray(spec.simulator(of, problem.options).torque(vector))

    plain = simplest(recording)
    by_fit = [counted(r, e)[1] for r, e in zip(problem.inputs, result.residuals, strict=True)]
    left = [counted(r, r.torque - simplest(r))[1] for r in problem.inputs if r.torque is not None]
    mine, its = (float(np.mean(np.concatenate(each) ** 2)) for each in (by_fit, left))
    if not (np.isfinite(plain).all() and np.isfinite(its) and mine + its > 0.0):
        return None
    weight = mine / (mine + its)
    apart = plain - torque
    shared = adequate or not problem.of_inverse_dynamics
    if shared or not moves_otherwise(problem.inputs, recording):
        return BesideSimplest(torque, 0.0, np.sqrt(weight) * apart, plain)
    both = torque + weight * apart
    return BesideSimplest(both, weight, np.sqrt(weight * (1.0 - weight)) * apart, plain)
