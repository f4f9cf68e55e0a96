"""How well fits of the same samples follow them for the parameters that each has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.inference.judging.goodness import akaike, bayesian
from surae.inference.posterior.linearised import measured
from surae.inference.result import FitResult
from surae.signals import ModelInputs


@dataclass(frozen=True, slots=True)
class Criteria:
    """A fit's samples, parameters, and what they are worth."""

    n: int  #: Samples that count.
    free: int  #: Estimated parameters, of the leg and of the laboratory.
    sse: float  #: Weighted sum of squared residuals, without priors [Nm²].
    aic: float | None  #: Akaike's criterion; None where the fit has no finite residual.
    bic: float | None  #: Bayes' criterion; as `aic`.


def criteria_of(result: FitResult) -> Criteria:
    """Count and criteria of a fit, followed by its parameters alone."""
    inputs = result.problem.inputs
    n = sum(int((recording.weights > 0.0).sum()) for recording in inputs)
    free = len(result.problem.free)
    sse = sum(
        float((recording.weights * residual) @ residual)
        for recording, residual in zip(inputs, result.residuals, strict=True)
    )
    return Criteria(n, free, sse, akaike(n, sse, free), bayesian(n, sse, free))


def is_same_torque(some: Sequence[ModelInputs], others: Sequence[ModelInputs]) -> bool:
    """Whether both are the same measured torque, sample by sample, and count alike."""
    return len(some) == len(others) and all(
        one.n == other.n
        and np.array_equal(measured(one), measured(other))
        and np.array_equal(one.weights, other.weights)
        for one, other in zip(some, others, strict=True)
    )
