"""What makes the estimates of a posterior unsure, source by source, as shifts of all of them.

With the rows J of what data say and the priors' precision P, the covariance of a mode is
V = (JᵀJ + P)⁻¹, and V = V·JᵀJ·V + Σ V·P_k·V exactly: the first is what noise makes of the
estimates, the others what is not known of each prior k. Latent values are eliminated, so that
theirs reach the parameters by −D⁻¹·Bᵀ. Every source is rows of shifts, whose outer products add up
to its covariance.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.linalg import cho_solve

from surae.base.units import FloatArray
from surae.inference.evidence import Subset, root
from surae.inference.posterior.banded import border_products, solve_band
from surae.inference.posterior.latent import SOURCES
from surae.inference.posterior.log_posterior import Block, LogPosterior, Point
from surae.model.laboratory import group_of
from surae.model.source_table import source_of

#: By how much a filter of the second order is not what excites a muscle, on the logarithm of f0, β
#: and bandwidth; the same where force falls later than it rises, and where muscles have no
#: electrode. Bandwidth is 1.4 % off (root mean square) on 30 virtual legs whose sensors, cables and
#: muscles are as these, 8 to 22 % where they are not (5 % held), 13 % where muscles let go slowly.
DYNAMICS = ("f0", "beta")
ORDER = 0.05
_RELEASED = 0.10
_UNHEARD = 0.10
#: Standard deviations of f0, β or bandwidth by which another filter would be seen.
_TELLS = 2.0
#: How far one head of a group is from the share of its force that EMG and weight give it, on a
#: logarithm. Optimal lengths of soleus and gastrocnemii are 44, 51 and 59 mm (Ward et al. 2009) and
#: the knee turns two of them: where their optima are 12° apart, on curves 22° wide, a head has 0.7
#: to 1.3 of that share. Assumed.
HEADS = 0.20
#: What the latents are called among the sources.
_CALLED = {
    "gain": "emg_gain",
    "drift": "torque_drift",
    "misfit": "left_out",
    "softening": "softening",
    "film": "film_drift",
}
#: Weight below which a set of departures is not looked at; rounding of a matrix's eigenvalues.
UNSUPPORTED = 0.005
_ROUNDING = 1e-10


def shifts_by_source(
    posterior: LogPosterior, blocks: Sequence[Block], V: FloatArray
) -> dict[str, FloatArray]:
    """Shifts of the searched coordinates, shape (r, q) each, by source."""
    rows: dict[str, list[FloatArray]] = {}
    for j, (name, weight) in enumerate(zip(posterior.of, posterior.weight, strict=True)):
        of = source_of(name) if group_of(name) is not None else None
        rows.setdefault("population" if of is None else of.name, []).append(V[j] * weight)
    shifts = {source: np.stack(each) for source, each in rows.items()}
    total = sum((by.T @ by for by in shifts.values()), np.zeros_like(V))
    latent = {source: np.zeros_like(V) for source in (*SOURCES, "fast", "film")}
    for number, b in enumerate(blocks):
        P = posterior.precisions[number]
        for source, at in posterior.latents[number].slices.items():
            moved = b.solved[at] @ V
            latent[source] += moved.T @ P[at, at] @ moved
        if len(b.fast):
            moved = b.followed(np.concatenate([V[b.at], -b.solved @ V, np.zeros((1, len(V)))]))
            latent["fast"] += moved.T @ posterior.fast_product(number, moved)
    sd = np.sqrt(np.diag(V))
    for source, C in latent.items():
        if C.any():
            shifts[_CALLED.get(source, "emg_noise")] = root(C, sd)
            total = total + C
    shifts["noise"] = root(V - total, sd)
    return shifts


def softened(posterior: LogPosterior, point: Point, V: FloatArray) -> list[tuple[float, float]]:
    """How much stiffer tissue was as each recording began, and its standard deviation.

    Of the muscle group that tells it best, as a part of its torque.
    """
    softening = []
    for c, b, latents in zip(point.c, point.blocks, posterior.latents, strict=True):
        at = latents.slices["softening"]
        covariance = cho_solve(b.factor, np.eye(len(c)))[at, at] + b.solved[at] @ V @ b.solved[at].T
        groups = np.repeat(np.eye(2), len(latents.softening), axis=1)  # all of it at no travel
        size = groups @ c[at]
        sd = np.sqrt(np.diag(groups @ covariance @ groups.T))
        best = int(np.argmax(size / sd))
        softening.append((float(size[best]), float(sd[best])))
    return softening


def between_subsets(
    scored: tuple[Subset, ...], names: tuple[str, ...], posterior: LogPosterior, V: FloatArray
) -> FloatArray:
    """Shifts that other sets of departures add, shape (r, q)."""
    chosen = scored[0]
    others = [s for s in scored[1:] if s.weight >= UNSUPPORTED]
    mine = [j for j, name in enumerate(posterior.names) if name in names]
    its = [names.index(posterior.names[j]) for j in mine]
    moved = np.zeros((len(others), len(V)))
    wider = np.zeros(len(its))
    for row, s in zip(moved, others, strict=True):
        row[mine] = np.sqrt(s.weight) * (s.mode - chosen.mode)[its]
        wider += s.weight * (s.variance - chosen.variance)[its]
    more = np.zeros(len(V))
    more[mine] = np.sqrt(np.maximum(wider, 0.0))
    sd = np.sqrt(np.diag(V))
    return np.concatenate([moved, root(V, sd) * np.where(more > 0.0, more / sd, 0.0)])


def dynamics(posterior: LogPosterior, V: FloatArray, beta: float, *, unheard: bool) -> FloatArray:
    """Shifts by what the activation filter cannot express, or by muscles `unheard`, shape (r, q).

    No residual tells that from another filter; the other values follow along their valleys, of what
    electrodes hear as far as no residual tells: two standard deviations of what is moved, one of
    their own. f0 and β may both be moved and their bandwidth not, which has a shift of its own.
    Where nothing says that force falls later than it rises, neither of the two follows it, or the
    other, farther than it may go by itself.
    """
    size = _UNHEARD if unheard else ORDER
    if "release" in posterior.names and not posterior.problem.has_unheard:  # else the same twice
        size = _RELEASED
    at = [posterior.names.index(name) for name in DYNAMICS if name in posterior.names]
    ways = list(np.eye(len(V))[at])
    if len(at) == len(DYNAMICS):
        # ∂ ln bandwidth/∂ ln β of f0·√(b + √(b² + 1)), b = 1 − 2β²
        slope = -2.0 * beta**2 / np.hypot(1.0 - 2.0 * beta**2, 1.0)
        ways.append(ways[0] + slope * ways[1])
    moved = np.zeros((len(ways), len(V)))
    sd = np.sqrt(np.diag(V))
    most = np.inf if unheard else sd
    farthest = np.inf if unheard or size == _RELEASED else np.maximum(size, sd[at])
    for row, way in zip(moved, ways, strict=True):
        along = V @ way
        variance = float(way @ V @ way)
        reach = size if unheard else min(size, _TELLS * variance**0.5)
        row[:] = np.clip(reach * along / variance, -most, most)
        row[at] = np.clip(size * along[at] / variance, -farthest, farthest)
    return moved


def between_heads(posterior: LogPosterior, values: Mapping[str, float]) -> FloatArray:
    """Shifts of the weights of a group's heads, which the model has on one length, shape (h, q).

    What one head pulls more another pulls less: the group's force is what the torque tells. On
    w = g·rms(EMG) of each, ln g has the covariance HEADS²·(1 − w·wᵀ/|w|²).
    """
    problem = posterior.problem
    weights = problem.spec.weights
    heads = [i for i, name in enumerate(weights) if i and name in posterior.names]
    emg = np.concatenate([recording.emg for recording in problem.inputs])
    force = np.sqrt(np.mean(emg[:, heads] ** 2, axis=0))
    names = [weights[i] for i in heads]
    force = force * np.array([values[name] for name in names])
    rows = np.zeros((len(heads), len(posterior.mean)))
    if len(heads) > 1 and force.any():
        share = force / np.linalg.norm(force)
        at = [posterior.names.index(name) for name in names]
        rows[:, at] = HEADS * (np.eye(len(heads)) - np.outer(share, share))
    return rows


def between_trials(blocks: Sequence[Block], V: FloatArray) -> FloatArray:
    """Shifts by which trials of a joint fit disagree beyond what else makes them unsure, (r, q).

    What recording i pulls the common estimate by is V·gᵢ, of which the posterior expects the
    variance V·Hᵢ·V (Liang and Zeger 1986); few recordings tell the excess badly, so that it has the
    factor n/(n − 1). It is told along the principal axes of what is expected: stiffness and slack
    length of tissue may both disagree where its torque does not.
    """
    n = len(blocks)
    if n < 2:
        return np.zeros((0, len(V)))
    scale = np.sqrt(np.diag(V))
    expected = V @ np.sum([b.H for b in blocks], axis=0) @ V / np.outer(scale, scale)
    sizes, axes = np.linalg.eigh(expected)
    seen_axes = sizes > _ROUNDING * sizes[-1]
    back = (axes[:, seen_axes] * np.sqrt(sizes[seen_axes])).T * scale
    rows = np.stack([V @ b.g for b in blocks]) * np.sqrt(n / (n - 1.0)) / scale
    rows = rows @ axes[:, seen_axes] / np.sqrt(sizes[seen_axes])
    seen = np.sum(rows**2, axis=0)
    return np.asarray(rows * np.sqrt(np.maximum(seen - 1.0, 0.0) / np.maximum(seen, 1.0)) @ back)


def by_torque(
    posterior: LogPosterior, point: Point, V: FloatArray, moved: Sequence[FloatArray]
) -> FloatArray:
    """Shifts of the searched coordinates, (r, q), where the model's torque is other than it is.

    Of each recording by so much [Nm], `moved`, shape (n, r); its latents follow.
    """
    shifts = np.zeros((moved[0].shape[1], len(V)))
    for number, (torque_of, b) in enumerate(zip(moved, point.blocks, strict=True)):
        rows = posterior.rows(point, number)[0]
        weight = posterior.problem.inputs[number].weight
        torque = torque_of if weight is None else torque_of * np.sqrt(weight)[:, None]
        variance = posterior.variances(number)[0]
        pull = rows.whole[:-1] @ torque / variance
        if len(b.fast):
            border = border_products(rows.fast, rows.first, np.ascontiguousarray(torque))
            pull -= b.fast[:, :-1].T @ solve_band(b.band, border / variance)
        q = len(b.at)
        shifts -= (pull[:q] - b.solved[:, b.at].T @ pull[q:]).T @ V[b.at]
    return shifts
