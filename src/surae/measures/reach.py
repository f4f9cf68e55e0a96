"""How far a leg was moved."""

import numpy as np

from surae.estimation import FitResult


def measured_range(result: FitResult) -> tuple[float, float]:
    """Lowest and highest angle of the samples that count [deg]."""
    angles = [
        recording.angle if recording.weight is None else recording.angle[recording.weight > 0]
        for recording in result.problem.inputs
    ]
    low, high = np.degrees(np.percentile(np.concatenate(angles), [0.5, 99.5]))
    return float(low), float(high)
