"""A flexible elastic curve over angle, linear in its weights, and what is expected of them."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surae.base.units import FloatArray

#: Degrees over which the calf's tissue grows e-fold, from compliant to stiff legs (k_tri of 80 to
#: 500 1/m on an arm of 4 to 5 cm), and the tibialis' towards plantarflexion.
_CALF = (6.0, 10.0, 16.0, 25.0, 40.0)
_TIBIALIS = (10.0, 20.0, 40.0)
#: Expected sizes, as parts of the size S at the end of the range: of the calf's terms (the longest
#: is nearly a line), of a straight line over 10°; the tibialis' have this many Nm at least.
_PARTS = (1.0, 1.0, 1.0, 1.0, 0.2)
_LINE = 0.1
_AGAINST = 0.3
#: Hinges, where the slope may bend: so many degrees apart, rounded over so many. What bends at all
#: bends more where tissue is stiff: e-fold over so many degrees.
_KNOTS = 5.0
_ROUNDED = 2.0
_STIFFER = 30.0
#: A hinge may always bend by so many Nm/deg.
_LEAST = 1e-4
#: Where the straight line has its zero [deg]: the foot at ease.
_EASE = -12.0


@dataclass(frozen=True, slots=True)
class Basis:
    """Features of torque over angle between the ends of a leg's relaxed range [deg]."""

    low: float
    high: float

    @property
    def knots(self) -> FloatArray:
        """Angles of the hinges [deg]."""
        return np.arange(self.low + 2.0, self.high - 1.0, _KNOTS)

    @property
    def size(self) -> int:
        """Number of features."""
        return len(_CALF) + len(_TIBIALIS) + 1 + len(self.knots)

    def features(self, degrees: npt.ArrayLike) -> FloatArray:
        """Features at angles [deg], shape (n, size); E = features · weights [Nm]."""
        a = np.atleast_1d(np.asarray(degrees, dtype=float))[:, None]
        calf = np.exp((a - self.high) / np.array(_CALF))
        tibialis = -np.exp(-(a - self.low) / np.array(_TIBIALIS))
        hinges = _ROUNDED * np.logaddexp(0.0, (a - self.knots) / _ROUNDED)
        return np.hstack([calf, tibialis, (a - _EASE) / 10.0, hinges])

    def slopes(self, degrees: npt.ArrayLike) -> FloatArray:
        """Derivatives of the features by the angle [1/deg], shape (n, size)."""
        a = np.atleast_1d(np.asarray(degrees, dtype=float))[:, None]
        calf = np.exp((a - self.high) / np.array(_CALF)) / np.array(_CALF)
        tibialis = np.exp(-(a - self.low) / np.array(_TIBIALIS)) / np.array(_TIBIALIS)
        hinges = 0.5 * (1.0 + np.tanh(0.5 * (a - self.knots) / _ROUNDED))
        return np.hstack([calf, tibialis, np.full_like(a, 0.1), hinges])

    def spread(self, size: float, bend: float) -> FloatArray:
        """Prior standard deviations of the weights [Nm].

        Parameters
        ----------
        size : float
            S, expected torque at the end of the range [Nm].
        bend : float
            D, part of S by which the slope may bend at each hinge, over 10°.
        """
        hinges = size * bend / 10.0 * np.exp((self.knots - self.high) / _STIFFER) + _LEAST
        against = np.full(len(_TIBIALIS), max(_AGAINST, _AGAINST * size))
        return np.concatenate([size * np.array(_PARTS), against, [_LINE * size], hinges])
