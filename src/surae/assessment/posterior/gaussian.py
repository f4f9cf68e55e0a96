"""Draws from the Gaussian of a fit itself, for tools that read draws."""

from typing import Any

import numpy as np

from surae.assessment.assess import Assessment
from surae.assessment.posterior.sample import inference_data
from surae.errors import InputError
from surae.estimation import FitResult
from surae.normal import NORMAL


def gaussian_data(result: FitResult, assessment: Assessment, draws: int, seed: int) -> Any:
    """Draws whose marginals have the estimates as medians and `ci95` as 95 % intervals.

    An interval that is not symmetric is that of a shifted logarithm, as parameters are searched on:
    x = value + c·(exp(k·z) − 1), z standard normal.
    """
    if result.family is None:
        names, matrix = assessment.covariance.names, assessment.covariance.matrix
    else:
        names, matrix = result.problem.free, result.family.covariance
    every = {**assessment.parameters, **assessment.nuisances}
    known = {name: every[name] for name in names if every[name].ci95 is not None}
    if not known:
        raise InputError("no parameter of this fit has an interval, so there is nothing to draw")
    at = [names.index(name) for name in known]
    block = matrix[np.ix_(at, at)]
    sd = np.sqrt(np.diag(block))
    z = np.random.default_rng(seed).multivariate_normal(
        np.zeros(len(at)), block / np.outer(sd, sd), size=draws, method="eigh"
    )
    for own, p in zip(z.T, known.values(), strict=True):
        assert p.ci95 is not None  # else it is not among them
        down, up = np.maximum((p.value - p.ci95[0], p.ci95[1] - p.value), 1e-6 * np.ptp(p.ci95))
        k = np.log(up / down) / NORMAL
        away = np.expm1(k * own) / np.expm1(k * NORMAL) if abs(k) > 1e-6 else own / NORMAL
        own[:] = p.value + up * away
    message = "Gaussian about the estimates, with the fit's intervals; `profile` follows valleys"
    if left := [p.name for p in every.values() if p.free and p.name not in known]:
        message += f"; without an interval, left out: {', '.join(left)}"
    units = {name: p.unit for name, p in known.items()}
    return inference_data(z, units, result.versions["surae"], "approximation", message)
