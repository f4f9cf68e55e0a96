"""The muscle model (1.0) tied to a recording: passive tissue and gain times active state."""

from collections.abc import Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import ActiveState
from surae.model.movement import MusclePath
from surae.model.options import ModelOptions
from surae.model.parameters import MUSCLE_PARAMETERS
from surae.model.recorded_model import Simulator, Sums
from surae.model.rigid import exponentials, rigid_forces, rigid_torque
from surae.signals import ModelInputs

_NAMES = tuple(p.name for p in MUSCLE_PARAMETERS)
#: Columns of each group's own parameters, in the order of `surae.model.rigid`.
GROUP_COLUMNS = tuple(
    np.array([_NAMES.index(n) for n in (f"k_{g}", f"x0_{g}", f"l0_{g}", "tau_rel", "k_rel")])
    for g in ("tri", "tib")
)


class MuscleSimulator(Simulator):
    """Model 1.0 on one recording."""

    def __init__(
        self, inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
    ) -> None:
        super().__init__(inputs, options, names=_NAMES, optional=optional)

    def _forces(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        parameters = p[GROUP_COLUMNS[group]]
        curves = exponentials(parameters, muscle.length)
        return rigid_forces(
            parameters, *curves, muscle.speed, active.alpha[0], self._factor, self._dt
        )

    def _contract(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState, into: Sums
    ) -> None:
        columns = GROUP_COLUMNS[group]
        parameters = p[columns]
        rigid_torque(
            parameters,
            into.slots[columns],
            (self._factor, self._dt),
            (
                np.stack([muscle.arm, muscle.length, muscle.speed]),
                np.stack([muscle.arm_slopes, muscle.length_slopes, muscle.speed_slopes]),
                into.turned,
            ),
            exponentials(parameters, muscle.length),
            (active.alpha[0], active.slopes[:, 0], into.slots[active.columns]),
            into.torque,
            into.jacobian,
        )
