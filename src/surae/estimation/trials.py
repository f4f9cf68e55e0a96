"""How much more recordings of one leg differ than their noise makes them: random effects.

What recording i pulls an estimate by is V·Jᵢᵀeᵢ. Noise gives that the variance V·JᵢᵀJᵢ·V; what the
pulls have beyond it is the leg, or the model, being another in each trial (the cluster-robust
covariance of Liang and Zeger 1986, as far as it exceeds the model's).
"""

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target
from surae.estimation.shifts import sized
from surae.units import FloatArray


def between_trials(target: Target, mode: Mode, quadratic: Quadratic) -> FloatArray:
    """What differences between recordings do to the estimates.

    Of shape (r, q), as they are searched, see `Family.spread`; none for a single recording.
    """
    count = len(target.problem.inputs)
    if count < 2:
        return np.zeros((0, len(mode.z)))
    covariance = quadratic.solved({})[2]
    pulls, expected = [], np.zeros(len(mode.z))
    for rows in target.data_rows(mode.z):
        pulls.append(covariance @ (rows[:-1] @ rows[-1]))
        expected += np.einsum("ij,ij->i", covariance @ rows[:-1], covariance @ rows[:-1])
    apart = (np.stack(pulls) - np.mean(pulls, axis=0)) * np.sqrt(count / (count - 1.0))
    more = np.sqrt(np.maximum(np.sum(apart**2, axis=0) - expected, 0.0))
    return sized(apart, more)
