"""How much a fit is worth against the parameters it took: AICc, and what n really is."""

import math
from collections.abc import Iterable

from surae.assessment.residual.quality import autocorrelation
from surae.units import FloatArray


def aicc(mean_square: float, samples: float, parameters: int) -> float | None:
    """Akaike's information criterion of a least-squares fit, corrected for small samples.

    n·ln σ² + 2K + 2K(K + 1)/(n − K − 1), with σ² = `mean_square` the maximum-likelihood variance
    of the residual and K = `parameters` + 1, as the variance is estimated too (Hurvich & Tsai
    1989; Burnham & Anderson 2002). Only differences between models of the same data mean anything.

    `mean_square` is in Nm²; `samples` counts independent ones, not necessarily a whole number. None
    where n is too small for K, or the residual has no variance to take a logarithm of.
    """
    k = parameters + 1
    if samples <= k + 1 or not 0 < mean_square < math.inf:
        return None
    return samples * math.log(mean_square) + 2 * k + 2 * k * (k + 1) / (samples - k - 1)


def effective_samples(residuals: Iterable[FloatArray]) -> float:
    """Independent samples that autocorrelated residuals are worth, n/(1 + 2Σρ) of each recording.

    The sum ends by Geyer's initial positive sequence (1992): pairs ρ(2k) + ρ(2k + 1) are added
    while they are positive; what follows is taken for noise. Anticorrelated residuals, which would
    be worth more than n, count as n.
    """
    return sum(len(e) / _correlation_time(e) for e in residuals)


def _correlation_time(residual: FloatArray) -> float:
    """1 + 2Σρ over the initial positive sequence, at least 1 [samples]."""
    rho = autocorrelation(residual, len(residual) - 1)
    even = len(rho) // 2 * 2
    pairs = rho[0:even:2] + rho[1:even:2]
    ends = (pairs <= 0).nonzero()[0]
    kept = pairs[: ends[0]] if len(ends) else pairs
    return max(1.0, 2.0 * float(kept.sum()) - 1.0)
