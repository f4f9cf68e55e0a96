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

from surae.errors import InputError
from surae.model import limb
from surae.model.geometry import length_tib, length_tri, paths
from surae.model.options import ModelOptions
from surae.model.rigid_2010 import F0, X0, B, E, K, M, contraction_gain, torque_2010
from surae.model.simulator import TorqueParts
from surae.signals import ModelInputs
from surae.signals.filters import HIGHEST_CUTOFF, butterworth
from surae.units import FloatArray

#: What makes an EMG envelope an integrated EMG: −3 dB [Hz] of both passes of a zero-phase
#: Butterworth low-pass, and the order of one. Zero-phase, so that all delay between EMG and force
#: is that of the activation filter, as in model 1.0.
IEMG_HZ, IEMG_ORDER = 3.0, 2


class Muscle2010Simulator:
    """The model of 2010 on one recording; whatever no parameter touches is computed here, once.

    That includes the integration of the EMG: a recording's envelopes are those of model 1.0.

    Raises
    ------
    InputError
        The recording is too slow or too short for the low-pass of the EMG.
    """

    def __init__(self, inputs: ModelInputs, options: ModelOptions) -> None:
        tri, tib = paths(inputs.angle, inputs.velocity, options)
        neutral = np.zeros(1)
        l0_tri = float(length_tri(neutral, options)[0][0])
        l0_tib = float(length_tib(neutral, options)[0][0])
        factor = float(options.vmax_factor)
        self._inertia = limb.inertia_torque(inputs.acceleration)
        self._gravity = limb.gravity_torque(inputs.angle, options.theta_foot)
        self._limb = self._inertia + self._gravity
        self._arm, self._length, self._speed = tri.arm, tri.length, tri.speed
        gain_tri = contraction_gain(tri.arm, tri.length, tri.speed, l0_tri, factor)
        gain_tib = contraction_gain(tib.arm, tib.length, tib.speed, l0_tib, factor)
        self._gains = np.stack([gain_tib, gain_tri, gain_tri, gain_tri])
        self._iemg = integrated(inputs)
        self._dt = 1.0 / inputs.rate_hz

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        return self._run(values)[0]

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        torque, jacobian = self._run(values)
        return torque, jacobian[list(columns)]

    def parts(self, values: FloatArray) -> TorqueParts:
        """The torque split into its parts; the tibialis has no tissue of its own."""
        elastic = np.exp(values[K] * (self._length - values[X0]))
        active = self._run(values)[1][E : E + 4]
        active *= values[E : E + 4, None]
        return TorqueParts(
            tissue_tri=self._arm * (elastic + values[B] * self._speed + values[F0]),
            tissue_tib=np.zeros_like(elastic),
            neural_tri=active[1:].sum(axis=0),
            neural_tib=active[0],
            inertial=values[M] * self._inertia,
            gravitational=values[M] * self._gravity,
        )

    def tendon(self, values: FloatArray) -> None:
        """Nothing: the tendons are rigid."""

    def _run(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        # A copy: for a read-only or strided array numba would compile the kernel once more.
        p = np.array(values, dtype=np.float64)
        return torque_2010(
            p, self._limb, self._arm, self._length, self._speed, self._iemg, self._gains, self._dt
        )


def integrated(inputs: ModelInputs) -> FloatArray:
    """Integrated EMG of TA, GL, SOL and GM, shape (4, n), in the unit of the envelopes.

    Raises
    ------
    InputError
        The recording is too slow or too short for the low-pass.
    """
    lowest = IEMG_HZ / HIGHEST_CUTOFF
    if inputs.rate_hz <= lowest:
        raise InputError(
            f"{inputs.where}: {inputs.rate_hz:g} Hz is too slow for the model of 2010, which "
            f"integrates EMG by a low-pass at {IEMG_HZ:g} Hz; sample above {lowest:.3g} Hz"
        )
    where = f"{inputs.where}: integrated EMG"
    return np.stack(
        [
            butterworth(
                channel, inputs.rate_hz, IEMG_HZ, IEMG_ORDER, "lowpass", ends="even", where=where
            )
            for channel in inputs.emg.T
        ]
    )
