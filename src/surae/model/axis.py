"""An ankle whose axis is not the device's: its angle, and how much of its torque is measured.

The foot is pinned at the ankle and strapped to the plate at R = `STRAP` from the device's axis,
where it may slide along the sole. With the ankle at a = (forward, up), the foot points to the
strap:

    θ_joint(θ) = ∠(R·(cos θ, sin θ) − a) − ∠((R, 0) − a)

No work is lost, so that the device measures the ankle's torque times dθ_joint/dθ; foot and plate
count as turning together. Two centimetres forward change the torque by more than a tenth; the 5 to
9 % that Arampatzis et al. (2007) measured are an offset of about one.

References
----------
A. Arampatzis, G. De Monte, G. Morey-Klapsing (2007). Effect of contraction form and contraction
velocity on the differences between resultant and measured ankle joint moments. Journal of
Biomechanics 40(7):1622-1628.
"""

from dataclasses import dataclass

import numpy as np

from surae.units import FloatArray

#: R, from the device's axis to where the foot is strapped to the plate [m], as `ARM_LIMB` of (6).
STRAP = 0.15


@dataclass(frozen=True, slots=True)
class JointAngle:
    """Angle of the joint θ_joint [rad], and its first and second derivative by the device's angle.

    Arrays of shape (n,); or the derivatives of all three by something.
    """

    angle: FloatArray
    factor: FloatArray
    bend: FloatArray


class AnkleAxis:
    """An ankle at a place beside the device's axis, while the device is at some angles.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Of the device [rad].
    forward, up : float
        Position of the ankle's axis [m].
    """

    def __init__(self, *, angle: FloatArray, forward: float, up: float) -> None:
        self._cos, self._sin = np.cos(angle), np.sin(angle)
        self._x, self._y = STRAP * self._cos - forward, STRAP * self._sin - up
        self._x0, self._y0 = STRAP - forward, -up
        self._along = forward * self._cos + up * self._sin
        self._across = up * self._cos - forward * self._sin
        self._at, self._inside = (forward, up), STRAP**2 - forward**2 - up**2
        self._square = self._x**2 + self._y**2  # of the distance from ankle to strap
        self.joint = JointAngle(
            np.arctan2(self._y, self._x) - np.arctan2(self._y0, self._x0),
            STRAP * (STRAP - self._along) / self._square,
            STRAP * self._across * self._inside / self._square**2,
        )

    def slope(self, name: str) -> JointAngle:
        """Derivatives of `joint` by ``"angle"``, ``"forward"`` or ``"up"``."""
        joint, (forward, up) = self.joint, self._at
        if name == "angle":
            turned, along, across, inside = joint.factor, self._across, -self._along, 0.0
        else:
            square = self._x0**2 + self._y0**2
            if name == "forward":
                turned = self._y / self._square - self._y0 / square
                along, across, inside = self._cos, -self._sin, -2.0 * forward
            else:
                turned = self._x0 / square - self._x / self._square
                along, across, inside = self._sin, self._cos, -2.0 * up
        farther = -(inside + 2.0 * STRAP * along) / self._square  # of the square's logarithm
        bend = STRAP * (across * self._inside + self._across * inside) / self._square**2
        return JointAngle(
            turned,
            -STRAP * along / self._square - joint.factor * farther,
            bend - 2.0 * joint.bend * farther,
        )
