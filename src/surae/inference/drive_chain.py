"""The kernel of a drive's chain: its logarithm climbs, turns now and then, and wanders."""

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import jit

#: Probability of any jump.
_JUMP = 1e-9


@jit
def forward(
    fits: FloatArray, slopes: IntArray, turns: float, half: float, after: bool
) -> FloatArray:
    """Probabilities of slopes and levels at each sample, by those before; by itself too, `after`.

    `fits` has the likelihood of each level, shape (n, m); `turns` is the probability that a slope
    changes, `half` the part that wanders to either side. Slopes are those before a sample, or after
    it. Of shape (n, k, m).
    """
    k, (n, m) = len(slopes), fits.shape
    edge, often = int(np.abs(slopes).max()) + 1, np.where(slopes == 0, 0.5, 0.5 / (k - 1))
    here, turned, told = np.empty((k, m)), np.zeros((k, m + 2 * edge)), np.empty((n, k, m))
    for i in range(n):
        level = np.zeros(m)
        for v in range(k):
            below = turned[v, edge - slopes[v] - 1 :]
            for x in range(m):
                wandered = half * (below[x] + below[x + 2])
                came = (1.0 - 2.0 * half) * below[x + 1] + wandered + _JUMP * often[v]
                told[i, v, x], here[v, x] = came, came * fits[i, x]
                level[x] += here[v, x]
        total = level.sum()
        for v in range(k):
            for x in range(m):
                goes = (1.0 - turns) * here[v, x] + turns * often[v] * level[x]
                turned[v, x + edge] = goes / total
                if after:
                    told[i, v, x] = goes
    return told
