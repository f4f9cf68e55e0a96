"""Whether model inputs can tell anything about the parameters at all."""

import numpy as np

from surae.errors import InputError
from surae.signals.inputs import ModelInputs

#: An angle [rad] or torque [Nm] that stays within this range never changes.
_STILL = 1e-6
#: No ankle turns half a circle [rad]: such an angle is in degrees, or another channel.
_FAR = np.pi


def check_estimable(inputs: ModelInputs) -> None:
    """Refuse inputs from which no parameter can be estimated.

    Raises
    ------
    InputError
        There is no torque, the angle or the torque never changes, or the angle is no ankle's.
    """
    if inputs.torque is None:
        raise InputError(
            f"{inputs.where}: there is no torque, so nothing can be estimated; add its column, or "
            f"simulate instead"
        )
    highest = float(np.abs(inputs.angle).max())
    if highest > _FAR:
        raise InputError(
            f"{inputs.where}: the angle reaches {highest:.3g} rad, which no ankle does; if it is "
            f'in degrees, name the column angle_deg (or write unit = "deg" in the TOML)'
        )
    if np.ptp(inputs.angle) < _STILL:
        raise InputError(
            f"{inputs.where}: the angle never changes ({inputs.angle[0]:.4g} rad): nothing can be "
            f"estimated; check the channel mapped to angle"
        )
    if np.ptp(inputs.torque) < _STILL:
        raise InputError(
            f"{inputs.where}: the torque never changes ({inputs.torque[0]:.4g} Nm): nothing can be "
            f"estimated; check the channel mapped to torque"
        )
