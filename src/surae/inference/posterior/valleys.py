"""The first stage of a search: which valley, from thinned recordings without departures.

Noise is taken for much greater than it is, so that a valley is wide, and then lowered to what the
residual says (continuation). The search begins at a fast and at a slow relaxation, for those are
two valleys.
"""

from collections.abc import Mapping

import numpy as np

from surae.base.units import FloatArray
from surae.inference.least_squares.minimise import Outcome
from surae.inference.noise import NoiseModel
from surae.inference.posterior.empirical_bayes import BEGIN, NEARLY_NONE, learnt_noise
from surae.inference.posterior.family import FIRST_HZ, Family
from surae.inference.posterior.log_posterior import LogPosterior, Point
from surae.inference.problem import FitProblem
from surae.inference.result import Start

#: Active state over which it reaches zero [N].
ROUNDED = 30.0
#: Relaxation times [s] and factor from which a search begins.
_RELAXATIONS = (0.4, 4.0)
_RELAXED = 0.3
#: Noise that it begins with, as a part of the torque's changes.
_TEMPER = 0.1
#: Standard deviations, noise taken for so much, within which two starts are in one valley.
_ALIKE = 1.0
#: By how much more −2 ln p, noise taken for so much, a start is left behind; damping far away.
_BEHIND = 10.0
_AFAR = 0.1


def first(
    family: Family,
) -> tuple[Mapping[str, float], tuple[NoiseModel, ...], list[tuple[float, Start]]]:
    """Values, the noise that they leave, and −2 ln p at each start's end with the start."""
    white = white_noise(family.original, _TEMPER)
    post = family.posterior((), FIRST_HZ, white, NEARLY_NONE, rest=ROUNDED)
    runs: list[tuple[FloatArray, Point, int]] = []
    for relaxation in _RELAXATIONS:
        given = {"tau_rel": relaxation, "k_rel": _RELAXED, **family.original.settings.start}
        near = post.by_name(runs[0][1].z) if runs else {}
        begin = post.start(near | given)
        before = family.evaluations
        end = post.descend(begin, tolerance=3.0, damping=_AFAR)
        runs.append((begin, end, family.evaluations - before))
    best = min((end for _, end, _ in runs), key=lambda end: end.cost)
    reach = _ALIKE * np.sqrt(np.diag(post.covariance(best)))
    before = family.evaluations
    lowest = quieter = _quieter(post, best)
    met = []
    for begin, end, spent in runs:
        quieter = lowest
        behind = end.cost - best.cost
        if np.any(np.abs(end.z - best.z) > reach):  # of another valley
            # at less noise what is far behind is farther behind
            doubtful = behind < _BEHIND
            quieter = _quieter(post, end) if doubtful else (lowest[0] + behind, post, end)
        total = spent + family.evaluations - before
        before = family.evaluations
        met.append((quieter[0], _started(quieter[1], begin, quieter[2], total)))
        lowest = min(lowest, quieter, key=lambda each: each[0])
    return lowest[1].by_name(lowest[2].z), lowest[1].noise, met


def white_noise(problem: FitProblem, part: float) -> tuple[NoiseModel, ...]:
    """White noise of a part of each recording's torque changes."""
    models = []
    for recording in problem.inputs:
        deviation = part * float(np.std(recording.torque)) if recording.torque is not None else 1.0
        models.append(NoiseModel.white(max(deviation, 1e-9) ** 2, float(recording.n)))
    return tuple(models)


def _quieter(post: LogPosterior, point: Point) -> tuple[float, LogPosterior, Point]:
    """The noise lowered to what the residual says, in turn with the mode; −2 ln p."""
    post = post.having(sizes=BEGIN)
    post = post.having(noise=learnt_noise(post, post.again(point), white=True))
    point = post.descend(point.z, point.c, tolerance=1.0)
    each = zip(post.problem.inputs, post.noise, strict=True)
    widths = sum(recording.n * np.log(noise.variance) for recording, noise in each)
    return float(point.cost + widths), post, point


def _started(post: LogPosterior, begin: FloatArray, point: Point, evaluations: int) -> Start:
    """What is told of a start: where it began and ended, and by how many evaluations."""
    initial, last = (
        {n: by[n] for n in post.problem.free} for by in map(post.by_name, (begin, point.z))
    )
    inputs = enumerate(post.problem.inputs)
    sse = sum(float(np.sum(post.observed.plain_residual(point.z, r, i) ** 2)) for i, r in inputs)
    outcome = Outcome.CONVERGED if point.rested else Outcome.ITERATIONS
    return Start(initial, last, sse, str(outcome), evaluations)
