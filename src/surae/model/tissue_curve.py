"""Torque of tissue over the ankle's angle as a table: what exponentials of muscles do not have."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from surae.base.errors import InputError

if TYPE_CHECKING:  # help reads options, which need no NumPy
    from surae.base.units import FloatArray
    from surae.signals import ModelInputs


@dataclass(frozen=True, slots=True)
class TissueCurve:
    """A torque beside that of the muscles, by the angle that the device shows.

        T = E(θ) + Σ γᵢ·HP_τᵢ[E(θ(t))],  HP_τ[x] = x − x̄,  τ·dx̄/dt = x − x̄,  x̄(0) = x(0)

    E is straight between its knots and constant beyond; what has not relaxed is quasi-linear
    (Fung 1993, Biomechanics, 7.6).

    Raises
    ------
    InputError
        Columns differ in length, or angles do not rise.
    """

    degrees: tuple[float, ...]  #: Knots [deg].
    torque: tuple[float, ...]  #: Fully relaxed, at the knots [Nm].
    shares: tuple[float, ...] = ()  #: γ: part that relaxes with each time.
    seconds: tuple[float, ...] = ()  #: τ [s].

    def __post_init__(self) -> None:
        """Refuse what is no table."""
        if len(self.degrees) != len(self.torque) or len(self.degrees) < 2:
            raise InputError("a tissue’s curve needs a torque at each of two or more angles")
        if not all(before < after for before, after in pairwise(self.degrees)):
            raise InputError("a tissue’s curve needs angles that rise")
        if len(self.shares) != len(self.seconds) or any(s <= 0.0 for s in self.seconds):
            raise InputError("a tissue’s curve needs a time above 0 s for each share that relaxes")

    def relaxed(self, degrees: float) -> float:
        """Torque at an angle [deg] when all has relaxed [Nm]."""
        import numpy as np

        return float(np.interp(degrees, self.degrees, self.torque))

    def slope(self, degrees: float) -> float:
        """Stiffness at an angle [deg], over 1° [Nm/deg]."""
        return self.relaxed(degrees + 0.5) - self.relaxed(degrees - 0.5)

    def along(self, degrees: "FloatArray", rate_hz: float) -> "FloatArray":
        """Torque while the ankle is moved so, shape (n,) [deg] and [Nm]."""
        import numpy as np
        from scipy.signal import lfilter

        elastic = np.interp(degrees, self.degrees, self.torque)
        beyond = elastic - elastic[0]
        torque = elastic.copy()
        for share, tau in zip(self.shares, self.seconds, strict=True):
            stays = math.exp(-1.0 / (rate_hz * tau))
            torque += share * (beyond - lfilter([1.0 - stays], [1.0, -stays], beyond))
        return np.asarray(torque)

    def of(self, inputs: "ModelInputs") -> "FloatArray":
        """Torque in a recording [Nm], shape (n,)."""
        import numpy as np

        return self.along(np.degrees(inputs.angle), inputs.rate_hz)
