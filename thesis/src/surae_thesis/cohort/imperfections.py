"""What the cohort's measurements have beside the imperfections of any virtual trial."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.recording import MUSCLES
from surae.studies import Imperfections

#: Coefficient of variation of the activity of muscles without electrodes over that of the muscles
#: that they help; no source.
UNMEASURED_VARIATION = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class CohortImperfections(Imperfections):
    """Imperfections, and a drive of the torque that the EMG does not show."""

    #: Coefficient of variation of the force that a muscle makes of its EMG: a gain of mean 1,
    #: log-normal, that wanders within seconds and differs from trial to trial, as by fatigue or an
    #: electrode that sees a part of the muscle.
    gain_variation: float = 0.0
    #: Torque of muscles without electrodes (deep plantarflexors, toe extensors), as a part of that
    #: of the measured muscles that they help; it is in the torque and in no EMG.
    unmeasured: float = 0.0

    def drive(
        self, envelopes: FloatArray, gains: Callable[[str, float, int], FloatArray]
    ) -> FloatArray:
        """What drives the torque, shape (n, 4) [V]: envelopes, and muscles without electrodes.

        Those that help the triceps, and those that help the tibialis, each do a share of its
        activity that wanders about its mean within seconds, log-normal (`UNMEASURED_VARIATION`).
        """
        if self.gain_variation > 0.0:
            envelopes = envelopes * gains("gain", self.gain_variation, len(MUSCLES))
        if self.unmeasured == 0.0:
            return envelopes
        share = self.unmeasured * gains("unmeasured", UNMEASURED_VARIATION, 2)
        helped = [int(muscle == "ta") for muscle in MUSCLES]
        return np.asarray(envelopes * (1.0 + share[:, helped]))
