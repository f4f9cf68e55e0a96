"""The kernel of a drive's chain: its logarithm climbs, turns now and then, and wanders."""

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import jit

#: Probability of any jump.
_JUMP = 1e-9


@jit
def forward(
    fits: FloatArray,
    slopes: IntArray,
    turns: float,
    half: float,
    told: FloatArray,
    share: FloatArray,
) -> None:
    """Probabilities of slopes after each sample and of levels, by those before and itself.

    `fits` has the likelihood of each level, shape (n, m); `turns` is the probability that a slope
    changes, `half` the part that wanders to either side; `told` is filled, (n, k, m). With room in
    `share`, (n, m), samples come the other way round, and it is what all say of the levels.
    """
    k = len(slopes)
    (n, m) = fits.shape
    back = len(share) > 0
    edge = int(np.abs(slopes).max()) + 1
    often = np.where(slopes == 0, 0.5, 0.5 / (k - 1))
    here = np.empty((k, m))
    turned = np.zeros((k, m + 2 * edge))
    came = np.empty(m)
    for i in range(n):
        level = np.zeros(m)
        for v in range(k):
            below = turned[v, edge - slopes[v] - 1 :]
            for x in range(m):
                came[x] = (1.0 - 2.0 * half) * below[x + 1] + half * (below[x] + below[x + 2])
                came[x] += _JUMP * often[v]
                here[v, x] = came[x] * fits[i, x]
                level[x] += here[v, x]
            if back:  # slopes are probabilities by how often there are
                for x in range(m):
                    share[n - 1 - i, x] += told[n - 1 - i, v, x] * came[x] / often[v]
        total = level.sum()
        for v in range(k):
            for x in range(m):
                goes = (1.0 - turns) * here[v, x] + turns * often[v] * level[x]
                turned[v, x + edge] = goes / total
                if not back:
                    told[i, v, x] = goes
