"""The mode in turn with the noise and the sizes of the latents, which its residuals tell."""

import numpy as np

from surae.inference.latent import SOURCES
from surae.inference.learning import learnt_films, learnt_noise, learnt_sizes
from surae.inference.posterior import LogPosterior, Point

#: Standard deviations of the latents before anything is learnt, those above which parameters have
#: to explain the torque, and those of none.
BEGIN = {"gain": 0.03, "drift": 0.1, "misfit": 0.01}
_MOST = {"gain": 0.15, "drift": 1.0, "misfit": 0.06}
NEARLY_NONE = {"gain": 1e-3, "drift": 1e-2, "misfit": 1e-3}
#: Rounds in which noise and sizes are learnt at most, and the part of each standard deviation below
#: which the mode rests.
ROUNDS, _AT_REST = 5, 0.1
#: Rounds of a search's end at most; what is to be gained in −2 ln p there, the square of 0.03
#: standard deviations; and the part of a standard deviation, of the noise and of the sizes by which
#: nothing moves any more where it rests.
_LAST, _ENDS, RESTS = 8, 1e-3, 0.02

#: Where a search has come to.
Reached = tuple[LogPosterior, Point]


def learnt(
    post: LogPosterior, point: Point, rounds: int = ROUNDS, *, white: bool = False,
    evaluations: int = 10, tolerance: float = 0.1,
) -> Reached:  # fmt: skip
    """Noise and sizes of the latents in turn with the mode, until it rests.

    Latents of which nearly nothing is to be stay so.
    """
    for _ in range(rounds):
        sizes = post.sizes
        if sizes != NEARLY_NONE:
            told = learnt_sizes(post, point, BEGIN)
            sizes = {source: min(told[source], _MOST[source]) for source in SOURCES}
        noise, latents = learnt_noise(post, point, white=white), learnt_films(post, point)
        post = post.having(noise=noise, sizes=sizes, latents=latents)
        moved = post.descend(
            point.z, point.c, point.w, evaluations=evaluations, tolerance=tolerance,
            damping=point.damping,
        )  # fmt: skip
        sd = np.sqrt(np.diag(post.covariance(moved)))
        if np.all(np.abs(moved.z - point.z) < _AT_REST * sd):
            return post, moved
        point = moved
    return post, point


def rested(post: LogPosterior, point: Point) -> tuple[LogPosterior, Point, float]:
    """The fixed point of noise, sizes and mode, and how far the last round went to it.

    In standard deviations; below `RESTS` of what is at rest.
    """
    for _ in range(_LAST):
        before, at, sd = post, point, np.sqrt(np.diag(post.covariance(point)))
        post, point = learnt(post, point, 1, evaluations=20, tolerance=_ENDS)
        sizes = [post.sizes[s] / before.sizes[s] for s in SOURCES]
        both = zip(post.noise, before.noise, strict=True)
        sizes += [np.sqrt(new.variance / old.variance) for new, old in both]
        moved = float(max(*(np.abs(point.z - at.z) / sd), *np.abs(np.log(sizes))))
        if point.rested and moved < RESTS:
            return post, point, moved
    return post, point, max(moved, RESTS)
