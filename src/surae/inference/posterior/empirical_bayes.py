"""What residuals at a mode tell of noise and sizes of the latents; the mode in turn with both."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.linalg import cho_solve, solve_triangular

from surae.base.units import FloatArray
from surae.inference.evidence import root
from surae.inference.noise import NoiseModel, level_above, noise_behind
from surae.inference.posterior.banded import solve_band_transposed
from surae.inference.posterior.film import noise_of_film
from surae.inference.posterior.latent import SOURCES, Latents
from surae.inference.posterior.linearised import SensorRows, measured
from surae.inference.posterior.log_posterior import Block, LogPosterior, Point
from surae.signals import ModelInputs

#: Largest order of the autoregression that tells the noise's slow part, and what is slow [Hz].
_ORDER = 30
_COUNTED = 2.0
#: Part of the torque's changes below which no noise is taken: sensors and integrator err as much.
_EXACT = 5e-3
#: Values that the size of latents beforehand counts for.
_BELIEVED = 2.0
#: Least and greatest size of the drives' errors, and how far its logarithm goes at once; assumed.
ERRORS = (0.03, 0.4)
_STEP = (-0.5, 0.5)
#: Draws that show what fast gains take of the noise.
_DRAWS = 16
#: Standard deviations of the latents before anything is learnt, those above which parameters have
#: to explain the torque, and those of none.
BEGIN = {"gain": 0.03, "drift": 0.1, "misfit": 0.01, "softening": 0.05}
_MOST = {"gain": 0.15, "drift": 1.0, "misfit": 0.06, "softening": 0.5}
NEARLY_NONE = {"gain": 1e-3, "drift": 1e-2, "misfit": 1e-3, "softening": 1e-3}
#: Rounds in which noise and sizes are learnt at most, and the part of each standard deviation below
#: which the mode rests.
_ROUNDS = 5
_AT_REST = 0.1
#: Rounds of a search's end at most; what is to be gained in −2 ln p there, the square of 0.03
#: standard deviations; and the part of a standard deviation, of the noise and of the sizes by which
#: nothing moves any more where it rests; and what a logarithm of noise or sizes counts for, which
#: move values and intervals to second order.
_LAST = 8
_ENDS = 3e-4
RESTS = 0.02
_WIDTHS = 0.4

#: Where a search has come to.
Reached = tuple[LogPosterior, Point]


def learnt(
    post: LogPosterior,
    point: Point,
    rounds: int = _ROUNDS,
    *,
    white: bool = False,
    tolerance: float = 0.1,
) -> Reached:
    """Noise, sizes of the latents and of the drives' errors in turn with the mode, until it rests.

    Latents of which nearly nothing is to be stay so.
    """
    for _ in range(rounds):
        sizes = post.sizes
        if sizes != NEARLY_NONE:
            sizes = {s: min(n, _MOST[s]) for s, n in learnt_sizes(post, point, BEGIN).items()}
        noise = learnt_noise(post, point, white=white)
        latents = learnt_films(post, point)
        fast = learnt_errors(post, point) if post.fast else post.fast
        post = post.having(noise=noise, sizes=sizes, latents=latents, fast=fast)
        moved = post.descend(point.z, point.c, point.w, tolerance=tolerance, damping=point.damping)
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
        before = post
        at = point
        sd = np.sqrt(np.diag(post.covariance(point)))
        post, point = learnt(post, point, 1, tolerance=_ENDS)
        sizes = [post.sizes[s] / before.sizes[s] for s in SOURCES]
        both = zip(post.noise, before.noise, strict=True)
        sizes += [np.sqrt(new.variance / old.variance) for new, old in both]
        sizes += [post.fast / before.fast] if post.fast and before.fast else []
        moved = float(max(*(np.abs(point.z - at.z) / sd), *(_WIDTHS * np.abs(np.log(sizes)))))
        if point.rested and moved < RESTS:
            return post, point, moved
    return post, point, max(moved, RESTS)


def learnt_sizes(
    posterior: LogPosterior, point: Point, beforehand: Mapping[str, float]
) -> dict[str, float]:
    """Standard deviations of the latents that the data ask for (MacKay 1992).

    σ² = (cᵀ·K·c + ν·σ₀²)/(γ + ν), γ the number of latents that the data determine, σ₀ the size
    `beforehand`, which counts for ν values: what the data do not tell stays at it.
    """
    squares = dict.fromkeys(SOURCES, 0.0)
    counts = dict.fromkeys(SOURCES, 0.0)
    V = posterior.covariance(point)
    for c, b, latents in zip(point.c, point.blocks, posterior.latents, strict=True):
        cov = cho_solve(b.factor, np.eye(len(c))) + b.solved @ V @ b.solved.T
        for source in SOURCES:
            at = latents.slices[source]
            K = latents.inverses[source]
            squares[source] += float(c[at] @ K @ c[at])
            open_part = float(np.sum(K * cov[at, at])) / posterior.sizes[source] ** 2
            counts[source] += max(len(K) - open_part, 0.0)
    return {
        s: float(np.sqrt((squares[s] + _BELIEVED * size**2) / (counts[s] + _BELIEVED)))
        for s, size in beforehand.items()
    }


def learnt_errors(posterior: LogPosterior, point: Point) -> float:
    """Standard deviation of the drives' errors by which −2 ln Z is least, as the point has it."""
    from scipy.optimize import minimize_scalar

    def lost(log: float) -> float:
        other = posterior.with_errors(float(np.exp(log)))
        return other.evidence(other.again(point))

    low, high = (np.clip(np.log(posterior.fast or 1.0) + by, *np.log(ERRORS)) for by in _STEP)
    best = minimize_scalar(lost, bounds=(low, high), method="bounded", options={"xatol": 1e-3})
    return float(np.exp(best.x))


def learnt_films(posterior: LogPosterior, point: Point) -> tuple[Latents, ...]:
    """The latents with what residuals say of the noise of each film."""
    if not any(latents.films for latents in posterior.latents):
        return posterior.latents
    V = _root_of(posterior, point)
    learnt = []
    for number, (latents, b) in enumerate(zip(posterior.latents, point.blocks, strict=True)):
        films = [
            replace(film, noise=noise_of_film(rows.residual, _taken(V, b, rows, film.noise)))
            for film, rows in zip(latents.films, posterior.rows(point, number)[1:], strict=True)
        ]
        learnt.append(replace(latents, films=tuple(films)))
    return tuple(learnt)


def learnt_noise(
    posterior: LogPosterior, point: Point, *, white: bool = False, anew: bool = False
) -> tuple[NoiseModel, ...]:
    """The noise of each recording, of its residual and what estimates have taken of it.

    Fast gains can follow nearly all that is slow. What is seen of the EMG's noise, and not known,
    leaves the torque's as it is, which counts some of it twice, unless it is learnt `anew`, for
    evidence; of greater errors the noise is white.
    """
    if posterior.fast == 0.0 and not anew and not posterior.rectified:
        return posterior.noise
    V = _root_of(posterior, point)
    models = []
    for number, (noise, b) in enumerate(zip(posterior.noise, point.blocks, strict=True)):
        rows = posterior.rows(point, number)[0]
        recording = posterior.problem.inputs[number]
        e = rows.residual
        U = _taken(V, b, rows, noise)
        if len(b.fast):
            U = np.concatenate([U, _drawn(rows, b.band) / np.sqrt(noise.variance)])
        if recording.weight is not None:  # what does not count has no residual, and is no noise
            e = e[recording.counts]
            U = U[:, recording.counts]
        model = noise_behind(e, U, 0 if white or posterior.fast else min(_ORDER, len(e) // 10))
        # samples count for as little as the slow part says, in which parameters act: a noise
        # model that is correlated itself lets the torque go where the model is wrong
        model = level_where_filtered(model, recording)
        least = (_EXACT * float(np.std(measured(recording)))) ** 2
        models.append(model.slow(_COUNTED / recording.rate_hz, least=max(least, 1e-30)))
    return tuple(models)


def _root_of(posterior: LogPosterior, point: Point) -> FloatArray:
    """Root of the covariance of the searched coordinates, shape (r, q)."""
    V = posterior.covariance(point)
    return root(V, np.sqrt(np.diag(V)))


def _taken(V: FloatArray, b: Block, rows: SensorRows, noise: NoiseModel) -> FloatArray:
    """U with UᵀU = the hat matrix of z after all latents, and of the slow ones after the fast.

    V is the root of z's covariance.
    """
    by_z = rows.by_z
    by_c = rows.by_c
    if len(b.fast):
        moved = rows.lifted(b.followed(np.eye(b.fast.shape[1])[:, :-1])).T
        by_z, by_c = by_z - moved[: len(by_z)], by_c - moved[len(by_z) :]
    of_z = V[:, b.at] @ (by_z - b.solved[:, b.at].T @ by_c)
    of_c = solve_triangular(b.factor[0], by_c, trans="T", lower=False)
    return np.asarray(np.concatenate([of_z, of_c]) / np.sqrt(noise.variance))


def _drawn(rows: SensorRows, band: FloatArray) -> FloatArray:
    """Rows whose products are on average those of what fast gains take of the noise."""
    white = np.random.default_rng(0).standard_normal((len(band), _DRAWS)) / np.sqrt(_DRAWS)
    # L·Lᵀ = D, so that L⁻ᵀ·white has the covariance D⁻¹
    return np.ascontiguousarray(rows.lifted(solve_band_transposed(band, white)).T)


def level_where_filtered(noise: NoiseModel, recording: ModelInputs) -> NoiseModel:
    """The noise without what the preparation's low-pass took from it.

    A noise model trusts most the frequencies with the least residual. Those that a filter emptied
    of noise hold the model's own errors still. At half of the cut-off the torque, sharpened, has
    lost 1 % of its power.
    """
    if recording.lowpass is None:
        return noise
    return level_above(noise, 0.5 * recording.lowpass[0] / recording.rate_hz)
