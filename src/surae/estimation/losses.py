"""Losses that let an outlier count less than its square: weights of iterated least squares."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.units import FloatArray

#: Makes the median of the absolute residual an estimate of a Gaussian's standard deviation.
_MAD = 1.4826


@dataclass(frozen=True, slots=True)
class Loss:
    """A loss ρ of the standardised residual u = e/σ."""

    name: str  #: What it is called.
    #: Where it leaves the square, in standard deviations; chosen so that Gaussian noise costs 5 %
    #: of the efficiency of least squares.
    tuning: float
    #: ψ(u)/u with ψ = ρ′/2, from u/tuning: 1 at 0, less at an outlier.
    weight: Callable[[FloatArray], FloatArray]
    slope: Callable[[FloatArray], FloatArray]  #: ψ′(u), from u/tuning.


def _tukey(t: FloatArray) -> FloatArray:
    return np.asarray(np.maximum(1 - t * t, 0.0))


LOSSES: Mapping[str, Loss] = {
    loss.name: loss
    for loss in (
        # Huber 1964: a square that goes on as a straight line.
        Loss(
            "huber",
            1.345,
            lambda t: np.asarray(1 / np.maximum(np.abs(t), 1.0)),
            lambda t: np.asarray((np.abs(t) < 1).astype(float)),
        ),
        # 2·(√(1 + t²) − 1), its smooth relative.
        Loss(
            "soft-l1",
            1.2871,
            lambda t: np.asarray((1 + t * t) ** -0.5),
            lambda t: np.asarray((1 + t * t) ** -1.5),
        ),
        # Beaton and Tukey 1974: an outlier far away counts nothing.
        Loss(
            "tukey",
            4.685,
            lambda t: _tukey(t) ** 2,
            lambda t: np.asarray(np.where(np.abs(t) < 1, (1 - t * t) * (1 - 5 * t * t), 0.0)),
        ),
    )
}


def named_loss(name: str) -> Loss:
    """The loss of that name; an unknown one is an `InputError` that lists the known ones."""
    if name not in LOSSES:
        raise InputError(f"unknown loss {name!r}; known losses: {', '.join(LOSSES)}")
    return LOSSES[name]


def spread(residual: FloatArray) -> float:
    """Standard deviation of Gaussian noise with this median of |e|: outliers hardly move it."""
    return _MAD * float(np.median(np.abs(residual)))
