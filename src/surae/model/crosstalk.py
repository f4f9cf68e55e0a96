"""What each muscle shows its own electrode, of what electrodes hear of all of them.

Signals of two muscles have nothing in common, so that in raw EMG their powers add up:
e² = (M∘M)·u², e and u the envelopes of electrodes and muscles, M the amplitudes that electrodes
hear, 1 on its diagonal. Over a strong muscle an electrode shows next to nothing of a neighbour that
it hears with 8 %, over a muscle at rest all of it. Envelopes that were made elsewhere are taken to
add up themselves, e = M·u.
"""

from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.model.parameters import CROSSTALK

#: Noise of the part of an electrode's power that is its own muscle's, over which the root of that
#: part goes through zero: 2·√(S/T), S of rectified EMG at 1024 Hz and T of the smooth envelopes.
SILENT = 0.2


@dataclass(frozen=True, slots=True)
class OfEnvelopes:
    """Muscles' envelopes u = M⁻¹·e, shape (4, n)."""

    envelopes: FloatArray
    inverse: FloatArray

    @classmethod
    def of(cls, heard: FloatArray, mixing: FloatArray) -> "OfEnvelopes":
        """Of what electrodes hear, shape (4, n)."""
        inverse = np.asarray(np.linalg.inv(mixing), dtype=np.float64)
        return cls(np.einsum("ij,jn->in", inverse, heard), inverse)

    def by_electrode(self, by_own: FloatArray, muscles: slice) -> FloatArray:
        """Derivatives by what each electrode hears, shape (4, n), of those by some muscles' u."""
        return np.asarray(np.einsum("ci,cn->in", self.inverse[muscles], by_own))

    def by_crosstalk(self, by_own: FloatArray, muscles: slice) -> dict[tuple[int, int], FloatArray]:
        """Derivatives by what electrode i hears of muscle j, shape (n,) each."""
        heard = self.by_electrode(by_own, muscles)
        return {(i, j): -heard[i] * self.envelopes[j] for i, j in CROSSTALK}


@dataclass(frozen=True, slots=True)
class OfPowers:
    """Muscles' envelopes u = e·√(p/s²), p = (M∘M)⁻¹·s², shape (4, n); s are smooth envelopes."""

    envelopes: FloatArray
    inverse: FloatArray  #: (M∘M)⁻¹.
    mixing: FloatArray
    powers: FloatArray  #: p.
    by_heard: FloatArray  #: ∂u/∂e.
    by_power: FloatArray  #: ∂u/∂p.

    @classmethod
    def of(cls, heard: FloatArray, smooth: FloatArray, mixing: FloatArray) -> "OfPowers":
        """Of what electrodes hear, shape (4, n), and as smooth as effort is."""
        inverse = np.asarray(np.linalg.inv(mixing**2), dtype=np.float64)
        power = smooth**2 + 1e-300
        powers = np.einsum("ij,jn->in", inverse, power)
        part = powers / power  # negative by noise
        size = part**2 + SILENT**2
        root = ((1.0 + SILENT**2) / size) ** 0.25
        kept = part * root
        by_part = root * (1.0 - 0.5 * part**2 / size)
        return cls(heard * kept, inverse, mixing, powers, kept, heard * by_part / power)

    def by_electrode(self, by_own: FloatArray, muscles: slice) -> FloatArray:
        """Derivatives by what each electrode hears, shape (4, n), of those by some muscles' u."""
        heard = np.zeros_like(self.envelopes)
        heard[muscles] = by_own * self.by_heard[muscles]
        return heard

    def by_crosstalk(self, by_own: FloatArray, muscles: slice) -> dict[tuple[int, int], FloatArray]:
        """Derivatives by what electrode i hears of muscle j, shape (n,) each."""
        heard = np.einsum("ci,cn->in", self.inverse[muscles], by_own * self.by_power[muscles])
        return {(i, j): -2.0 * self.mixing[i, j] * heard[i] * self.powers[j] for i, j in CROSSTALK}
