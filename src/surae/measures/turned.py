"""A leg without activity that is turned: its model, tied to angles."""

from functools import lru_cache

import numpy as np

from surae.base.units import FloatArray
from surae.model import ModelOptions, Simulator, get_model, with_optional
from surae.signals import ModelInputs


@lru_cache(maxsize=8)
def tied_to_angles(
    model: str,
    optional: tuple[str, ...],
    options: ModelOptions,
    degrees: tuple[float, ...],
    rate_hz: float,
    second: float | None,
) -> tuple[tuple[str, ...], Simulator]:
    """A model's parameters, and the model tied to a leg without activity that is turned so."""
    spec = with_optional(get_model(model), optional)
    angle = np.array(degrees) * (np.pi / 180.0)
    n = len(angle)
    velocity = np.gradient(angle, 1.0 / rate_hz)
    inputs = ModelInputs(
        "turned",
        rate_hz,
        np.arange(n) / rate_hz,
        angle,
        velocity,
        np.zeros(n),
        np.zeros((n, 4)),
        "V",
        None,
        prepared=True,
        second=held_still(second, n),
    )
    return spec.names, spec.simulator(inputs, options, beyond=True)


def held_still(second: float | None, n: int) -> tuple[FloatArray, ...]:
    """Angle and velocity of a second joint at an angle, of `ModelInputs`."""
    return () if second is None else (np.full(n, second), np.zeros(n))
