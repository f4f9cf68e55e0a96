"""What a model tied to a recording gives: its torque's parts, its muscles and tendons."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.base.errors import ComputationError
from surae.base.frozen import Comparable
from surae.base.units import FloatArray
from surae.recording.table import sample
from surae.signals import ModelInputs


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
    """What muscle and tendon of both groups do over time; arrays (2, n), triceps surae first."""

    #: `muscle_length`, `muscle_velocity`: length x [m] and lengthening velocity x' [m/s] of the
    #: muscle. The implicit integrator starts at rest, in equilibrium without active force: its
    #: first velocity is zero.
    muscle_length: FloatArray
    muscle_velocity: FloatArray
    #: `tendon_length`, `elongation`, `tendon_velocity`: length lt and elongation lt − lt0 of the
    #: tendon [m], negative where it is slack, and lengthening velocity lmt' − x' [m/s].
    tendon_length: FloatArray
    elongation: FloatArray
    tendon_velocity: FloatArray
    #: `tendon_force`, `tissue_force`, `active_force`: force in the tendon, and the passive and
    #: active forces of the muscle that make it up [N].
    tendon_force: FloatArray
    tissue_force: FloatArray
    active_force: FloatArray
    laws: tuple[TendonLaw, TendonLaw]  #: Force against elongation of both tendons.
    #: Index of the first sample of each group that has no finite state: its force balance could not
    #: be solved, which takes a number that is not finite; from there on everything is NaN.
    unsolved: tuple[int | None, int | None]

    def columns(self) -> Mapping[str, FloatArray]:
        """The states under the names they have in files, triceps (tri) before tibialis (tib)."""
        units = {
            "muscle_length": "m",
            "muscle_velocity": "m_s",
            "tendon_length": "m",
            "tendon_elongation": "m",
            "tendon_velocity": "m_s",
            "tendon_force": "N",
            "tissue_force": "N",
            "active_force": "N",
        }
        arrays = {"tendon_elongation": self.elongation}
        return {
            f"{name}_{group}_{unit}": (arrays[name] if name in arrays else getattr(self, name))[row]
            for name, unit in units.items()
            for row, group in enumerate(("tri", "tib"))
        }


@dataclass(frozen=True, slots=True, eq=False)
class TorqueParts(Comparable):
    """A modelled torque split into its parts, each of shape (n,) in Nm; they add up to `total`.

    What the reflex makes of the neural parts is no further part of the sum.
    """

    #: `tissue_tri`, `tissue_tib`: passive tissue of triceps surae and tibialis anterior, signed as
    #: in equation (1).
    tissue_tri: FloatArray
    tissue_tib: FloatArray
    #: `neural_tri`, `neural_tib`: active contraction of the two groups, signed as in equation (1).
    neural_tri: FloatArray
    neural_tib: FloatArray
    #: `inertial`, `gravitational`: foot and footplate.
    inertial: FloatArray
    gravitational: FloatArray
    #: `reflex_tri`, `reflex_tib`: of `neural_tri` and `neural_tib`, what the reflex drives; None
    #: from a model without one.
    reflex_tri: FloatArray | None = None
    reflex_tib: FloatArray | None = None
    zero: FloatArray | None = None  #: Zero of the torque; None from a model without one.
    joint: FloatArray | None = None  #: The joint's own tissue; None from a model without it.

    @property
    def tissue(self) -> FloatArray:
        """Passive tissue of both muscle groups, and of the joint [Nm]."""
        tissue = self.tissue_tri + self.tissue_tib
        return tissue if self.joint is None else tissue + self.joint

    @property
    def neural(self) -> FloatArray:
        """Active contraction of both muscle groups [Nm]."""
        return self.neural_tri + self.neural_tib

    @property
    def reflex(self) -> FloatArray | None:
        """What the reflex drives of both muscle groups [Nm]; None from a model without one."""
        if self.reflex_tri is None or self.reflex_tib is None:
            return None
        return self.reflex_tri + self.reflex_tib

    @property
    def total(self) -> FloatArray:
        """The whole torque [Nm], equation (1)."""
        total = self.tissue + self.neural + self.inertial + self.gravitational
        return total if self.zero is None else total + self.zero

    def columns(self) -> Mapping[str, FloatArray]:
        """The parts under the names they have in files, sums first, optional ones last."""
        names = (
            "tissue",
            "neural",
            "inertial",
            "gravitational",
            "tissue_tri",
            "tissue_tib",
            "neural_tri",
            "neural_tib",
            "joint",
            "zero",
            "reflex",
            "reflex_tri",
            "reflex_tib",
        )
        parts = {name: getattr(self, name) for name in names}
        called = {"zero": "torque_zero"}
        return {f"{called.get(n, n)}_Nm": part for n, part in parts.items() if part is not None}


def check_finite_torque(torque: FloatArray, inputs: ModelInputs) -> None:
    """Refuse a modelled torque that is not finite everywhere, naming its first such sample.

    Raises
    ------
    ComputationError
        Some sample is infinite or not a number.
    """
    wrong = np.flatnonzero(~np.isfinite(torque))
    if wrong.size:
        first = int(wrong[0])
        raise ComputationError(
            f"{inputs.where}: the model overflows with these parameters, its torque is not finite, "
            f"first at {sample(first)} ({inputs.time[first]:.6g} s); check their units and that of "
            "the EMG"
        )
