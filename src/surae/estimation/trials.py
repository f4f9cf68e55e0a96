"""How much more recordings of one leg differ than their noise makes them: random effects.

What recording i pulls an estimate by is V·Jᵢᵀeᵢ. Noise gives that the variance V·JᵢᵀJᵢ·V; what the
pulls have beyond it is the leg, or the model, being another in each trial (the cluster-robust
covariance of Liang and Zeger 1986, as far as it exceeds the model's).
"""

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target


def between_trials(target: Target, mode: Mode, quadratic: Quadratic) -> dict[str, float]:
    """Standard deviation that differences between recordings add to each parameter, in its unit.

    Parameters
    ----------
    target : Target
        What was minimised.
    mode : Mode
        Its minimum.
    quadratic : Quadratic
        Around it.

    Returns
    -------
    dict of str to float
        Empty for a single recording.
    """
    count = len(target.problem.inputs)
    if count < 2:
        return {}
    covariance = quadratic.solved({})[2]
    pulls, expected = [], np.zeros(len(mode.z))
    for rows in target.data_rows(mode.z):
        pulls.append(covariance @ (rows[:-1] @ rows[-1]))
        expected += np.einsum("ij,ij->i", covariance @ rows[:-1], covariance @ rows[:-1])
    between = np.var(np.stack(pulls), axis=0, ddof=1) * count
    more = np.sqrt(np.maximum(between - expected, 0.0))[: len(target.names)]
    return dict(zip(target.names, (more * target.scale(mode.z)).tolist(), strict=True))
