"""The thesis's integrator, `explicit-euler`, and `explicit-damped`, its remedy (appendix B)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.model import ModelOptions
from surae.model.activation import ActiveState
from surae.model.euler import explicit_states
from surae.model.movement import LegMovement, MusclePath
from surae.model.muscle_tendon import COLUMNS, MuscleTendonSimulator
from surae.model.parameters import (
    MUSCLE_PARAMETERS,
    OPTIONAL,
    OPTIONAL_PARAMETERS,
    TENDON_PARAMETERS,
)
from surae.model.recorded_model import Sums
from surae.signals import ModelInputs

#: Relative step of the central differences that its derivatives are made of.
DIFFERENCE = 1e-6
#: What such a step is relative to where a parameter is 0: of an optional one a part of its range.
_SCALES = {p.name: p.start for p in MUSCLE_PARAMETERS + TENDON_PARAMETERS} | {
    p.name: 0.1 * p.upper for p in OPTIONAL_PARAMETERS
}
#: Nothing comes before it is caused.
_DELAYS = (*OPTIONAL["emd"], "reflex_delay")


class ThesisSimulator(MuscleTendonSimulator):
    """The muscle-tendon models by the thesis's explicit Euler scheme, at the recording's rate.

    Its derivatives are central differences with a relative step of `DIFFERENCE`. Where the scheme
    chatters between its clamps, the torque jumps with the parameters and no derivative is of use.
    """

    #: A part of the tendon's largest force, at the muscle's largest speed.
    damping = 0.0

    def __init__(
        self, inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
    ) -> None:
        if {*OPTIONAL["curves"], *OPTIONAL["bridges"]}.intersection(optional):
            raise InputError(
                "integrator explicit-euler has no fl_, fv_ and bridge_ parameters; use implicit"
            )
        super().__init__(inputs, options, optional)

    def _summed(
        self,
        p: FloatArray,
        columns: Sequence[int],
        leg: LegMovement,
        linear: FloatArray | None = None,
        seen: FloatArray | None = None,
    ) -> Sums:
        """The torque and its derivatives; the drives' response is the implicit scheme's."""
        none = np.zeros(0, dtype=np.int64)
        into = Sums(p[:0], p[:0], none, none)
        if linear is not None:
            into = super()._summed(p, columns, leg, linear, seen)
        torque = self.torque(p)
        names = list(self._at)
        values = p
        jacobian = np.empty((len(columns) + 1, len(torque)))
        for row, j in zip(jacobian, columns, strict=False):
            step = DIFFERENCE * (abs(values[j]) or _SCALES[names[j]])
            below = np.array(values)
            above = np.array(values)
            below[j] -= step
            above[j] += step
            if names[j] in _DELAYS:
                below[j] = max(below[j], 0.0)
            row[:] = (self.torque(above) - self.torque(below)) / (above[j] - below[j])
        return replace(into, torque=torque, jacobian=jacobian)

    def _states(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        states = np.full((5, len(muscle.length)), np.nan)
        explicit_states(
            p[COLUMNS[group]],
            float(self._strain_lengths[group]),
            muscle.length,
            active.alpha[-1],
            self._factor,
            self._dt,
            self.damping,
            states,
        )
        return states


class DampedSimulator(ThesisSimulator):
    """The explicit scheme with the remedy of appendix B: "adding more damping to the system".

    A damper beside the active force, `damping` times the tendon's Fmax at vmax, keeps the speed
    from the clamps where the muscle is hardly active. At 1000 Hz the multiple holds then reverse 6
    instead of 380 times a second, as solved implicitly; the price is a force that no muscle has, 5
    % of the torque's RMS.
    """

    damping = 0.02


#: By the value of the option `integrator`.
EXPLICIT: dict[str, type[MuscleTendonSimulator]] = {
    "explicit-euler": ThesisSimulator,
    "explicit-damped": DampedSimulator,
}
