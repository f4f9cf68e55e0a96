"""How a fit let outliers count less, as a part of FIT.json."""

import math
from collections.abc import Sequence
from typing import Any

from surae.assessment.saved.arrays import decode, encode
from surae.estimation import LOSSES, Outliers


def outliers_as_dict(outliers: Outliers | None) -> dict[str, Any] | None:
    """Plain data; None for least squares."""
    if outliers is None:
        return None
    return {
        "loss": outliers.loss,
        "tuning": outliers.tuning,
        "scale_Nm": outliers.scale,
        "share_below_half": outliers.share,
        "widening": outliers.widening,
        "rounds": outliers.rounds,
        "weights": [encode(weight) for weight in outliers.weights],
    }


def read_outliers(data: dict[str, Any] | None, samples: Sequence[int]) -> Outliers | None:
    """What `outliers_as_dict` made, for recordings of so many samples."""
    if data is None:
        return None
    weights = tuple(decode(w, (n,)) for w, n in zip(data["weights"], samples, strict=True))
    numbers = [float(data[name]) for name in ("tuning", "scale_Nm", "widening")]
    if data["loss"] not in LOSSES or not all(math.isfinite(x) and x > 0 for x in numbers):
        raise ValueError("outliers: an unknown loss, or a number that is none")
    if not all(weight.min() > 0 and weight.max() <= 1 for weight in weights):
        raise ValueError("outliers: a weight is not between 0 and 1")
    tuning, scale, widening = numbers
    return Outliers(str(data["loss"]), tuning, scale, weights, widening, int(data["rounds"]))
