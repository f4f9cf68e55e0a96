"""The empty device: what its plate weighs, drags and rubs, from a recording without a foot.

    T = I·θ'' + c·cos θ + s·sin θ + d·θ' + f·tanh(θ'/ω₀) + z

Rigid body on a hinge with viscous and dry friction (Armstrong-Hélouvry et al. 1994, Automatica
30:1083-1138); the zero z of the sensor goes with it.
"""

import math
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.model.knowledge import Plate
from surae.signals import ModelInputs

#: Speed at which dry friction has three quarters of its size [rad/s].
_SLIDES = 0.02
#: What terms may be at most before anything is recorded: kg·m², Nm, Nm, Nm·s/rad, Nm, Nm. Over a
#: small range cos θ is nearly constant, and goes with the zero.
_WIDE = (0.1, 10.0, 10.0, 2.0, 3.0, 30.0)
#: Part of the torque's changes that a plate has to explain [%] where they are more than noise [Nm].
_EXPLAINED = 90.0
_NOISE = 0.3
#: An empty device has to move this far [rad].
_MOVES = math.radians(5.0)


def _terms(inputs: ModelInputs) -> FloatArray:
    """Torque of each term at 1, shape (n, 6)."""
    angle = inputs.angle
    speed = inputs.velocity
    each = (
        inputs.acceleration,
        np.cos(angle),
        np.sin(angle),
        speed,
        np.tanh(speed / _SLIDES),
        np.ones(inputs.n),
    )
    return np.stack(each, axis=1)


def tared(inputs: ModelInputs) -> Plate:
    """The plate by the recording of an empty device."""
    if inputs.torque is None:
        raise InputError(f"{inputs.where}: there is no torque of an empty device")
    low, high = (float(np.quantile(inputs.angle, share)) for share in (0.005, 0.995))
    if high - low < _MOVES:
        raise InputError(
            f"{inputs.where}: the empty device moves {math.degrees(high - low):.2g}°; move it "
            "through the range of the trials"
        )
    X = _terms(inputs)
    y = inputs.torque
    weight = np.diag(1.0 / np.array(_WIDE) ** 2)
    variance = 1.0
    for _ in range(3):
        covariance = np.linalg.inv(X.T @ X / variance + weight)
        values = covariance @ (X.T @ y) / variance
        left = y - X @ values
        # noise that is slower than the samples: 2 π f(0) of an autoregression of the first order
        slow = float(np.clip(left[1:] @ left[:-1] / max(float(left @ left), 1e-300), 0.0, 0.999))
        variance = max(float(left @ left) / inputs.n, 1e-12) * (1.0 + slow) / (1.0 - slow)
    rest = float(np.std(left))
    r2 = 100.0 * (1.0 - np.var(left) / max(float(np.var(y)), 1e-300))
    if rest > _NOISE and r2 < _EXPLAINED:
        raise InputError(
            f"{inputs.where}: a plate explains {r2:.0f} % of this torque, {rest:.2g} Nm are left: "
            "this is no empty device; record it without a foot"
        )
    sds = np.sqrt(np.diag(covariance))
    name = inputs.files[0].name if inputs.files else inputs.name
    return Plate(name, tuple(map(float, values)), tuple(map(float, sds)), (low, high), rest)


def without(plate: Plate, inputs: ModelInputs) -> ModelInputs:
    """A recording without the torque of the empty device."""
    if not plate.file or inputs.torque is None:
        return inputs
    step = f"The empty device ({plate.file}) was taken away from the torque."
    left = read_only(inputs.torque - _terms(inputs) @ np.array(plate.values))
    return replace(inputs, torque=left, steps=(*inputs.steps, step))
