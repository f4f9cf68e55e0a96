"""How unsure a torque is at a moment, of what a step knows: a quadratic form of its parts.

What a torque's interval is made of are shifts of the parameters (`surae.inference.judging.
predicted`), each of which changes the torque over time. A change goes with the parts of the torque
and with how the angle turns them; so each is regressed on these, over the fit's own recordings, and
what the regression leaves is added to the noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.causal.layout import FIRST_TORQUE
from surae.inference import FitResult
from surae.inference.judging.predicted import torque_doubt
from surae.inference.uncertainty.combined import Uncertainty

#: Samples of each recording that a regression is given, about.
_SAMPLES = 2000
#: What is left out of the terms, as a part of the largest: directions that would cancel others, and
#: torques that the recordings hardly have, of which they tell nothing.
_SMALLEST = 1e-3


@dataclass(frozen=True, slots=True)
class Doubt:
    """The standard deviation of a torque: √(noise² + |form·terms|²) [Nm]."""

    form: FloatArray  #: Shape (k, k).
    noise: float  #: What no parameter has a part in [Nm].
    #: How far the form is from the standard deviation that it stands for, by root mean square
    #: over the fit's recordings, as a part of it.
    error: float


def doubt_of(
    result: FitResult, known: Uncertainty, terms: Sequence[FloatArray], errors: Sequence[FloatArray]
) -> Doubt:
    """The doubt of a fit's torque.

    Parameters
    ----------
    result : FitResult
        The fit.
    known : Uncertainty
        What is known of its parameters.
    terms : sequence of ndarray, shape (k, n)
        What the form is of, in each recording of the fit.
    errors : sequence of ndarray, shape (n,)
        Measured minus causally predicted torque of each [Nm].

    Returns
    -------
    Doubt
        Of a torque at one moment.
    """
    X: list[FloatArray] = []
    Y: list[FloatArray] = []
    left = []
    for recording, of_terms, error in zip(result.problem.inputs, terms, errors, strict=True):
        rows = torque_doubt(result, known, recording).rows
        counts = recording.counts
        every = max(rows.shape[1] // _SAMPLES, 1)
        X.append(of_terms[:, counts][:, ::every].T)
        Y.append(rows[:, ::every].T)
        left.append(error[counts] - error[counts].mean())
    count = max(y.shape[1] for y in Y)
    x = np.concatenate(X)
    y = np.concatenate([np.pad(each, ((0, 0), (0, count - each.shape[1]))) for each in Y])
    size = np.sqrt(np.mean(x**2, axis=0))
    size[FIRST_TORQUE:][size[FIRST_TORQUE:] < _SMALLEST * size[FIRST_TORQUE:].max()] = np.inf
    size = np.maximum(size, 1e-12)
    weights = np.linalg.lstsq(x / size, y, rcond=_SMALLEST)[0] / size[:, None]
    # |Wᵀx|² is xᵀWWᵀx: of as many rows as there are terms, whatever the number of shifts
    form = np.linalg.qr(weights.T, mode="r") if weights.shape[1] >= len(size) else weights.T
    form = np.pad(form, ((0, len(size) - len(form)), (0, 0)))
    whole = np.sum(y**2, axis=1)
    approximate = np.sum((x @ weights) ** 2, axis=1)
    missed = max(float(np.mean(whole - approximate)), 0.0)
    noise = float(np.hypot(np.std(np.concatenate(left)), np.sqrt(missed)))
    true, formed = (np.sqrt(noise**2 + each) for each in (whole - missed, approximate))
    apart = float(np.sqrt(np.mean((np.nan_to_num(true) - formed) ** 2)) / np.sqrt(np.mean(true**2)))
    return Doubt(form, noise, apart)
