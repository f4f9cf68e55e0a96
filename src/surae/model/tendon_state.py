"""What muscles and tendons do over time, as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.frozen import Comparable
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class TendonLaw:
    """Force of one tendon against its elongation, equation (18)."""

    slack_length: float  #: lt0, length without force [m].
    #: What `surae.model.tendon.tendon_curve` makes of the parameters.
    curve: tuple[float, float, float, float, float]

    @property
    def toe_elongation(self) -> float:
        """Elongation at which the toe ends, equation (20) [m]."""
        return self.curve[0]

    @property
    def toe_force(self) -> float:
        """Force at which the toe ends, equation (19) [N]."""
        return float(self.force(np.array([self.toe_elongation]))[0])

    @property
    def stiffness(self) -> float:
        """Slope beyond the toe, equation (21) [N/m]."""
        return self.curve[3]

    def force(self, elongation: FloatArray) -> FloatArray:
        """Force [N] at elongations [m] of shape (n,)."""
        from surae.model.tendon import tendon_force  # numba, only when it is used

        return np.array([tendon_force(float(e), self.curve)[0] for e in elongation])


@dataclass(frozen=True, slots=True, eq=False)
class TendonState(Comparable):
    """What muscle and tendon of both groups do over time; arrays (2, n), triceps surae first.

    Attributes
    ----------
    muscle_length, muscle_velocity : ndarray
        Length x [m] and lengthening velocity x' [m/s] of the muscle. The implicit integrator
        starts at rest, in equilibrium without active force: its first velocity is zero.
    tendon_length, elongation, tendon_velocity : ndarray
        Length lt and elongation lt − lt0 of the tendon [m], negative where it is slack, and
        lengthening velocity lmt' − x' [m/s].
    tendon_force, tissue_force, active_force : ndarray
        Force in the tendon, and the passive and active forces of the muscle that make it up [N].
    laws : tuple of TendonLaw
        Force against elongation of both tendons.
    unsolved : tuple of int or None
        Index of the first sample of each group that has no finite state: its force balance could
        not be solved, which takes a number that is not finite; from there on everything is NaN.
    """

    muscle_length: FloatArray
    muscle_velocity: FloatArray
    tendon_length: FloatArray
    elongation: FloatArray
    tendon_velocity: FloatArray
    tendon_force: FloatArray
    tissue_force: FloatArray
    active_force: FloatArray
    laws: tuple[TendonLaw, TendonLaw]
    unsolved: tuple[int | None, int | None]

    def columns(self) -> Mapping[str, FloatArray]:
        """The states under the names they have in files, triceps (tri) before tibialis (tib)."""
        named = {
            ("muscle_length", "m"): self.muscle_length,
            ("muscle_velocity", "m_s"): self.muscle_velocity,
            ("tendon_length", "m"): self.tendon_length,
            ("tendon_elongation", "m"): self.elongation,
            ("tendon_velocity", "m_s"): self.tendon_velocity,
            ("tendon_force", "N"): self.tendon_force,
            ("tissue_force", "N"): self.tissue_force,
            ("active_force", "N"): self.active_force,
        }
        return {
            f"{quantity}_{group}_{unit}": values[row]
            for (quantity, unit), values in named.items()
            for row, group in enumerate(("tri", "tib"))
        }
