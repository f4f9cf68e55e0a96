"""What drives the muscles of a recording when EMG as it is does not: delays and a stretch reflex.

Active states (14) with both drives, of which either may be off:

    E_tri(t) = g2·e2(t − emd) + g3·e3(t − emd) + g4·e4(t − emd) + reflex_tri·v_tri(t − reflex_delay)
    E_tib(t) = g1·e1(t − emd) + reflex_tib·v_tib(t − reflex_delay)
    v        = max(d lmt/dt, 0)                                                   [m/s]

lmt is the muscle-tendon unit's length: with it lengthens the muscle on a rigid tendon, and what a
compliant tendon leaves to the muscle is not known before the force is. v is taken as linear between
samples, as EMG is. `reflex_delay` is all of the time from stretch to the filter's input, the loop's
and the muscle's own; `emd` is not added to it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.model.delayed import BY_BETA, BY_DELAY, BY_F0, OUT, delayed
from surae.model.stages import GROUPS
from surae.units import FloatArray

#: Which EMG channels drive which muscle group.
_DRIVEN = np.array([[float(channel in group) for channel in range(4)] for group in GROUPS])


@dataclass(frozen=True, slots=True)
class DrivenActivation:
    """Active states and their derivatives, n samples with L instants each.

    Attributes
    ----------
    signals : ndarray, shape (10, n, L)
        As from `surae.model.stages.staged_activation`.
    by_drive : ndarray, shape (2, D, n, L)
        Per muscle group the derivatives by the parameters of the drives.
    reflex : ndarray, shape (2, n, L), or None
        The part of both active states that the reflex makes [N]; None without one.
    """

    signals: FloatArray
    by_drive: FloatArray
    reflex: FloatArray | None


class Drives:
    """Drives of one recording; whatever no parameter touches is computed here, once.

    Parameters
    ----------
    emg : ndarray, shape (4, n)
        EMG envelopes TA, GL, SOL, GM [V].
    speeds : ndarray, shape (2, n)
        Lengthening speeds d lmt/dt of triceps and tibialis [m/s].
    dt : float
        Sample time [s].
    names : sequence of str
        Parameters of the drives, in the order of `DRIVE_PARAMETERS`.
    lags : tuple of float
        Active states are wanted so long before each sample [s].
    """

    def __init__(
        self,
        emg: FloatArray,
        speeds: FloatArray,
        dt: float,
        names: Sequence[str],
        lags: tuple[float, ...],
    ) -> None:
        self._emg, self._stretch = emg, np.maximum(speeds, 0.0)
        self._dt, self._names, self._lags = dt, tuple(names), lags

    def activation(
        self, values: FloatArray, weights: FloatArray, f0: float, beta: float
    ) -> DrivenActivation:
        """Active states at these parameters.

        Parameters
        ----------
        values : ndarray, shape (D,)
            Of the drives.
        weights : ndarray, shape (4,)
            g1 … g4 [N/V].
        f0, beta : float
            Cut-off [Hz] and relative damping of the filter.
        """
        given = dict(zip(self._names, values.tolist(), strict=True))
        channels = delayed(self._emg, f0, beta, self._dt, given.get("emd", 0.0), self._lags)
        groups = np.einsum("mc,kcnl->kmnl", _DRIVEN * weights, channels)
        by_drive = np.zeros((2, len(self._names), *groups.shape[2:]))
        reflex = None
        if "emd" in given:
            by_drive[:, self._names.index("emd")] = groups[BY_DELAY]
        if "reflex_delay" in given:
            stretch = delayed(self._stretch, f0, beta, self._dt, given["reflex_delay"], self._lags)
            for muscle, name in enumerate(("reflex_tri", "reflex_tib")):
                by_drive[muscle, self._names.index(name)] = stretch[OUT, muscle]
                stretch[:, muscle] *= given[name]
            by_drive[:, self._names.index("reflex_delay")] = stretch[BY_DELAY]
            reflex = stretch[OUT]
            groups += stretch
        signals = np.concatenate([groups[OUT], channels[OUT], groups[BY_F0], groups[BY_BETA]])
        return DrivenActivation(signals, by_drive, reflex)
