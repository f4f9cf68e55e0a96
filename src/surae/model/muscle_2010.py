"""The muscle model of 2010 tied to a recording: a reconstruction.

The thesis says by what model 1.0 differs from its predecessor (section 2.3, Table 1, left), not the
predecessor's equations. What follows from it, with the numbers of the thesis where they are shared:

    T        = I·θ'' + T_tri − T_tib + T_grav(θ)                                   (1)
    T_tri    = (F_elas + F_act,tri)·r_ach(θ),   T_tib = F_act,tib·r_tib(θ)         (2)(3)
    F_elas   = exp(k_tri·(x_tri − x0_tri)) + b_tri·x_tri' + F0     triceps alone
    IEMG_i   = low-pass, 3 Hz, of the EMG envelope of muscle i
    E_tib    = e1·IEMG_1,   E_tri = e2·IEMG_2 + e3·IEMG_3 + e4·IEMG_4              (12)(13)
    α        = ω0²/(s + ω0)² · E,   ω0 = 2π·f          critically damped           (14)
    F_act    = f_l(x)·f_v(x')·α,   l0 = x(θ = 0),   vmax = 8·l0                    (15)-(17)

F_elas stands for all that is passive in the joint, the tibialis included, so it may be negative:
equation (11) does not apply. The torque is therefore linear in all but k_tri and f, once x0_tri is
replaced by exp(−k_tri·x0_tri).

References
----------
E. de Vlugt, J. H. de Groot, K. E. Schenkeveld, J. H. Arendzen, F. C. T. van der Helm, C. G. M.
Meskers (2010). The relation between neuromechanical parameters and Ashworth score in stroke
patients. Journal of NeuroEngineering and Rehabilitation 7:35. doi:10.1186/1743-0003-7-35.
"""

from collections.abc import Sequence

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.model.activation import ActiveState
from surae.model.contraction import length_velocity_factor
from surae.model.geometry import paths
from surae.model.model_2010 import PARAMETERS_2010
from surae.model.movement import MusclePath
from surae.model.options import ModelOptions
from surae.model.recorded_model import Simulator, Sums
from surae.signals import ModelInputs
from surae.signals.filters import HIGHEST_CUTOFF, zero_phase

_NAMES = tuple(p.name for p in PARAMETERS_2010)
_K, _X0, _B, _F0 = (_NAMES.index(name) for name in ("k_tri", "x0_tri", "b_tri", "F0"))

#: What makes an EMG envelope an integrated EMG: −3 dB [Hz] of both passes of a zero-phase
#: Butterworth low-pass, and the order of one. Zero-phase, so that all delay between EMG and force
#: is that of the activation filter, as in model 1.0.
IEMG_HZ = 3.0
IEMG_ORDER = 2


class Muscle2010Simulator(Simulator):
    """The model of 2010 on one recording; its EMG, the envelopes of model 1.0, is integrated once.

    Raises
    ------
    InputError
        The recording is too slow or too short for the low-pass of the EMG.
    """

    def __init__(
        self, inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
    ) -> None:
        super().__init__(
            inputs,
            options,
            names=_NAMES,
            optional=optional,
            weights=("e1", "e2", "e3", "e4"),
            emg=integrated(inputs),
            filtered=("f", ""),
        )
        neutral = np.zeros(1)
        rest = paths(angle=neutral, velocity=neutral, options=options)
        self._l0 = [float(path.length[0]) for path in rest]
        self._contractions: dict[int, tuple[MusclePath, FloatArray]] = {}

    def _forces(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        active_force = self._contraction(group, muscle)[0] * active.alpha[0]
        return np.stack([self._passive(p, group, muscle)[0], active_force])

    def _contraction(self, group: int, muscle: MusclePath) -> FloatArray:
        """Give the factor f_l·f_v, which is made once where no parameter touches the movement."""
        if group not in self._contractions or self._contractions[group][0] is not muscle:
            made = length_velocity_factor(
                muscle.length, muscle.speed, self._l0[group], self._factor
            )
            self._contractions[group] = muscle, made
        return self._contractions[group][1]

    def _passive(
        self, p: FloatArray, group: int, muscle: MusclePath
    ) -> tuple[FloatArray, FloatArray]:
        """Passive force [N] and what of it is elastic; the tibialis has no tissue of its own."""
        if group == 1:
            return np.zeros_like(muscle.length), np.zeros_like(muscle.length)
        with np.errstate(over="ignore"):  # the torque is then not finite, which is told
            elastic = np.exp(p[_K] * (muscle.length - p[_X0]))
        return elastic + p[_B] * muscle.speed + p[_F0], elastic

    def _contract(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState, into: Sums
    ) -> None:
        alpha = active.alpha[0]
        arm = muscle.arm
        jacobian = into.jacobian
        slots = into.slots
        factor, by_length, by_speed = self._contraction(group, muscle)
        passive, elastic = self._passive(p, group, muscle)
        force = passive + factor * alpha
        gain = arm * factor
        into.torque[:] += arm * force
        if group == 0:
            jacobian[slots[_K]] = (muscle.length - p[_X0]) * elastic * arm
            jacobian[slots[_X0]] = -p[_K] * elastic * arm
            jacobian[slots[_B]], jacobian[slots[_F0]] = arm * muscle.speed, arm
        for column, slope in zip(active.columns, active.slopes[:, 0], strict=True):
            jacobian[slots[column]] += gain * slope
        tissue = group == 0
        for row, slot in enumerate(into.turned):
            longer = muscle.length_slopes[row]
            faster = muscle.speed_slopes[row]
            change = tissue * (p[_K] * elastic * longer + p[_B] * faster)
            change += alpha * (by_length * longer + by_speed * faster)
            jacobian[slot] += muscle.arm_slopes[row] * force + arm * change


def integrated(inputs: ModelInputs) -> FloatArray:
    """Integrated EMG of TA, GL, SOL and GM, shape (4, n), in the unit of the envelopes."""
    lowest = IEMG_HZ / HIGHEST_CUTOFF
    if inputs.rate_hz <= lowest:
        raise InputError(
            f"{inputs.where}: {inputs.rate_hz:g} Hz is too slow for the model of 2010, which "
            f"integrates EMG by a low-pass at {IEMG_HZ:g} Hz; sample above {lowest:.3g} Hz"
        )
    where = f"{inputs.where}: integrated EMG"
    return np.stack(
        [
            zero_phase(
                "lowpass", channel, inputs.rate_hz, IEMG_HZ, IEMG_ORDER, ends="even", where=where
            )
            for channel in inputs.emg.T
        ]
    )
