"""Whether model inputs can tell anything about the parameters at all."""

import numpy as np

from surae.errors import InputError
from surae.signals.inputs import ModelInputs

#: An angle [rad] or torque [Nm] that stays within this range never changes.
_STILL = 1e-6


def check_estimable(inputs: ModelInputs) -> None:
    """Refuse inputs from which no parameter can be estimated.

    Raises
    ------
    InputError
        There is no torque, or the angle or the torque never changes.
    """
    if inputs.torque is None:
        raise InputError(
            f"{inputs.name}: there is no torque, so nothing can be estimated; add its column, or "
            f"simulate instead"
        )
    if np.ptp(inputs.angle) < _STILL:
        raise InputError(
            f"{inputs.name}: the angle never changes ({inputs.angle[0]:.4g} rad): nothing can be "
            f"estimated; check the channel mapped to angle"
        )
    if np.ptp(inputs.torque) < _STILL:
        raise InputError(
            f"{inputs.name}: the torque never changes ({inputs.torque[0]:.4g} Nm): nothing can be "
            f"estimated; check the channel mapped to torque"
        )
