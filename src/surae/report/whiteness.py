"""Whether residuals are white noise, which the confidence intervals take for granted."""

import math
from dataclasses import dataclass

import numpy as np

from surae.assessment import autocorrelation
from surae.units import FloatArray

#: Widening of the intervals from which it is worth a word.
_NOTABLE = 1.05


@dataclass(frozen=True, slots=True)
class Whiteness:
    """The autocorrelation of a residual.

    Attributes
    ----------
    rate_hz : float
        Sampling rate [Hz].
    correlation : ndarray, shape (lags + 1,)
        Autocorrelation from lag 0; as many lags as are worth showing.
    band : float
        Half-width of the band that holds 95 % of the values if the residual is white, 1.96/√n.
    fall_s : float
        Time after which the autocorrelation is within the band for the first time [s].
    widening : float
        Rough factor by which intervals computed for white residuals are too narrow, at least 1.
    """

    rate_hz: float
    correlation: FloatArray
    band: float
    fall_s: float
    widening: float

    @property
    def lag1(self) -> float:
        """Autocorrelation of neighbouring samples."""
        return float(self.correlation[1])

    @property
    def coloured(self) -> bool:
        """Whether the autocorrelation makes the intervals notably too narrow."""
        return self.lag1 > self.band and self.widening > _NOTABLE


def whiteness(residual: FloatArray, rate_hz: float) -> Whiteness:
    """Describe the autocorrelation of a residual.

    The widening is √(1 + 2Σρ), summed up to where ρ enters the band for the first time: the ratio
    of the residual's spectral density at low frequencies to that of white noise of the same
    variance. It holds for sensitivities that vary slowly against the residual, and is a rough
    guide for all others.

    Parameters
    ----------
    residual : ndarray, shape (n,)
        Residual [Nm], n at least 2.
    rate_hz : float
        Sampling rate [Hz].
    """
    n = len(residual)
    full = autocorrelation(residual, n - 1)
    band = 1.96 / math.sqrt(n)
    within = np.flatnonzero(np.abs(full) <= band)
    fall = int(within[0]) if len(within) else n - 1
    widening = math.sqrt(max(1.0, 1.0 + 2.0 * float(full[1:fall].sum())))
    shown = min(max(3 * fall, 40), n - 1)
    return Whiteness(rate_hz, full[: shown + 1], band, fall / rate_hz, widening)
