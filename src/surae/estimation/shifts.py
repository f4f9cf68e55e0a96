"""How a systematic error moves all estimates together.

Rows of shifts, one for each way in which it may go, whose outer products add up to its covariance:
a wrong stiffness comes with the slack length that makes up for it, and what both make stays known.
There are two sources, in this order.

What a model leaves out, and how far that may have moved the estimates.

A leg has another force-length curve than the model, antagonists that no electrode hears, tissue
that stiffens otherwise. Such errors repeat with every movement: they are functions of angle,
velocity and force, and no noise. Where the residual follows such functions, c·φ(t), their size s is
known from it,

    Φᵀe ~ N(0, G·S·G + G + N),   G = Φᵀ(1 − J·V·Jᵀ)Φ,   S = diag(s²),

all whitened, N what noise of the EMG makes of it, by maximum of the posterior, one s for each
muscle's active force and one for what is passive. What they do to the estimates is −V·JᵀΦ·c: where
data show c, as far as they do, and where it hides behind the parameters, as far as s lets it. Where
nothing is left out, s is zero and so is this (Kennedy and O'Hagan 2001 on models that are wrong;
here the discrepancy is linear).

What else shakes an estimate, beside the torque's noise: noise of the EMG
(`surae.estimation.noisy_emg`), and the integrator. Both are known errors of the modelled torque;
what they do to the parameters is linear, δz = V·JᵀWᵀW·δT.
"""

from collections.abc import Sequence

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target, whitened
from surae.estimation.noisy_emg import NoisyEmg
from surae.model.simulator import TorqueParts
from surae.signals import ModelInputs, thinned
from surae.units import FloatArray


def sized(shifts: FloatArray, deviations: FloatArray) -> FloatArray:
    """Shifts in these directions, shape (r, q), of these standard deviations, shape (q,)."""
    own = np.sqrt(np.sum(shifts**2, axis=0))
    return np.asarray(shifts * np.where(own > 0.0, deviations / np.where(own > 0.0, own, 1.0), 0.0))


def along(deviations: FloatArray, covariance: FloatArray) -> FloatArray:
    """Shifts of these standard deviations along the valleys of a covariance, shape (q, q)."""
    return sized(root(covariance), deviations)


def root(covariance: FloatArray) -> FloatArray:
    """Shifts whose outer products add up to a covariance, shape (q, q)."""
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    return np.asarray((vectors * np.sqrt(np.maximum(values, 0.0))).T)


#: What hides may be so many times what shows: legs of other muscles than the model's (decision 16).
_HIDDEN = 4.0
#: By how much muscles without an electrode move the logarithm of what EMG is filtered by: set on
#: twelve virtual legs with two electrodes (decision 16).
_DYNAMICS, _UNHEARD = ("f0", "beta"), 0.10
#: Gain of ln L that sizes which are sought bring by chance: as much speaks against them beforehand.
_AGAINST = 2.0
#: Scale of s, in noise's standard deviations of a whole trial, before anything is seen.
_USUAL = 10.0
#: Range of ln s² that is searched, and where its search begins.
_RANGE, _BEGIN = (-12.0, 16.0), (-2.0, 4.0)
#: Share of the largest eigenvalue below which there is none.
_NOTHING = 1e-9


def left_out(
    target: Target,
    mode: Mode,
    quadratic: Quadratic,
    noisy: NoisyEmg,
    owns: Sequence[tuple[Target, Mode, Quadratic]],
) -> FloatArray:
    """Shifts by what the model leaves out, as they are searched; see `Family.spread`.

    `owns` are the recordings each by itself: what they differ by is not what the model leaves out.
    """
    covariance = quadratic.solved({})[2]
    gram = bent = lever = by_emg = np.zeros((1, 1))
    score = groups = np.zeros(1)
    blocks = zip(target.problem.inputs, target.data_rows(mode.z), target.noise, owns, strict=True)
    for number, (recording, rows, noise, (own, there, around)) in enumerate(blocks):
        counts = 1.0 if recording.weight is None else np.sqrt(recording.weight)
        features, groups = _features(recording, target.parts(mode.z, number))
        features = whitened(features * counts, noise)
        noise_rows = whitened(np.stack([draw[number] for draw in noisy.changes]) * counts, noise)
        (alone,) = own.data_rows(there.z)
        own_lever = alone[:-1] @ features.T
        moved = around.solved({})[2] @ own_lever
        # the mode is beside the minimum where EMG is noisy
        gradient = alone[:-1] @ alone[-1] + around.weight**2 * (there.z - around.mean)
        gram = gram + features @ features.T
        bent = bent + own_lever.T @ moved
        lever = lever + rows[:-1] @ features.T
        score = score + features @ alone[-1] - moved.T @ gradient
        by_emg = by_emg + noise_rows @ features.T - noise_rows @ alone[:-1].T @ moved
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    moved = covariance @ lever / size
    score, by_emg = score / size, by_emg / size
    variance, directions = np.linalg.eigh((gram - bent) / np.outer(size, size))
    varied = variance > _NOTHING * variance[-1]
    view = np.sqrt(variance[varied])[:, None] * directions[:, varied].T
    to_view = directions[:, varied].T / np.sqrt(variance[varied])[:, None]
    emg_seen = to_view @ (by_emg.T @ by_emg) @ to_view.T / len(noisy.changes)
    noise_seen = np.eye(len(view)) + emg_seen
    score = to_view @ score
    logs, gain = _sizes(view, score, noise_seen, groups)
    prior = np.exp(logs)[groups]
    taken = prior[:, None] * view.T @ np.linalg.inv((view * prior) @ view.T + noise_seen)
    known = np.diag(prior) - taken @ (view * prior)
    shown = taken @ score
    likely = 1.0 / (1.0 + np.exp(min(_AGAINST - gain, 500.0)))
    ways = root(known + np.outer(shown, shown))
    return np.asarray(_HIDDEN * np.sqrt(likely) * ways @ moved.T)


def _sizes(
    view: FloatArray, score: FloatArray, noise: FloatArray, groups: FloatArray
) -> tuple[FloatArray, float]:
    """The most likely ln s² of each group of functions, and what ln L gains by them."""
    from scipy.optimize import minimize

    def unlikely(logs: FloatArray) -> float:
        whole = (view * np.exp(logs)[groups]) @ view.T + noise
        return float(np.linalg.slogdet(whole)[1] + score @ np.linalg.solve(whole, score))

    def believed(logs: FloatArray) -> float:
        # half-Cauchy beforehand, so that a size of which nothing is seen stays finite (Gelman 2006)
        return unlikely(logs) + 2.0 * float(np.log1p(np.exp(logs) / _USUAL**2).sum())

    count = int(groups.max()) + 1
    ends = [
        minimize(believed, np.full(count, begin), bounds=[_RANGE] * count, method="L-BFGS-B")
        for begin in _BEGIN
    ]
    best = min(ends, key=lambda end: end.fun)
    none = float(np.linalg.slogdet(noise)[1] + score @ np.linalg.solve(noise, score))
    return np.asarray(best.x), 0.5 * (none - float(best.fun))


def _features(recording: ModelInputs, parts: TorqueParts) -> tuple[FloatArray, FloatArray]:
    """Functions that a residual should not follow, shape (k, n), and the group of each."""
    low, high = np.percentile(recording.angle, [1.0, 99.0])
    angle = np.clip(2.0 * (recording.angle - low) / max(high - low, 1e-9) - 1.0, -1.2, 1.2)
    velocity = recording.velocity / max(np.percentile(np.abs(recording.velocity), 99.0), 1e-9)
    features, groups = [], []
    for group, torque in enumerate((parts.neural_tri, parts.neural_tib)):
        active = np.abs(torque) / max(np.percentile(np.abs(torque), 99.0), 1e-9)
        bends = (angle, angle**2, angle**3, velocity, velocity * angle, active, active * angle)
        features += [active * bend for bend in bends]
        groups += [group] * len(bends)
    passive = (
        angle**2, angle**3, angle**4, velocity, velocity * np.abs(velocity),
        np.tanh(10.0 * velocity), velocity * angle,
    )  # fmt: skip
    return np.stack([*features, *passive]), np.array([*groups, *[2] * len(passive)])


def shaken(
    target: Target, mode: Mode, quadratic: Quadratic, noisy: NoisyEmg
) -> dict[str, FloatArray]:
    """Shifts as they are searched, by source; see `Family.spread`."""
    covariance = quadratic.solved({})[2]
    levers = []
    for rows, noise, recording in zip(
        target.data_rows(mode.z), target.noise, target.problem.inputs, strict=True
    ):
        # W twice: forwards on the error, which is backwards on the rows
        lever = covariance @ whitened(rows[:-1, ::-1], noise)[:, ::-1]
        levers.append(lever if recording.weight is None else lever * np.sqrt(recording.weight))
    values = target.values(mode.z)
    step = sum(
        lever @ _halved(target, values, recording)
        for lever, recording in zip(levers, target.problem.inputs, strict=True)
    )
    emg = [
        sum(lever @ change for lever, change in zip(levers, draw, strict=True))
        for draw in noisy.changes
    ]
    return {
        "emg_noise": np.nan_to_num(np.stack(emg) / np.sqrt(len(emg))),
        "integration": np.nan_to_num(step)[None],
    }


def unheard(target: Target, mode: Mode, quadratic: Quadratic) -> FloatArray:
    """Shifts by muscles that no electrode hears, as they are searched, shape (r, q).

    The EMG of others stands for theirs, and they act a little earlier or later: by what no residual
    tells apart from another filter. The other values follow along their valleys.
    """
    if not any(recording.missing_emg for recording in target.problem.inputs):
        return np.zeros((0, len(mode.z)))
    covariance = quadratic.solved({})[2]
    ways = [target.names.index(name) for name in _DYNAMICS if name in target.names]
    return np.asarray([_UNHEARD * covariance[j] / covariance[j, j] for j in ways]).reshape(
        len(ways), len(mode.z)
    )


def _halved(target: Target, values: FloatArray, recording: ModelInputs) -> FloatArray:
    """Error of the torque by the size of the steps [Nm]: a third of what steps of twice it add."""
    spec, options = target.problem.spec, target.problem.options
    coarse_inputs = thinned(recording, 2)
    fine = spec.simulator(recording, options).torque(values)
    coarse = spec.simulator(coarse_inputs, options).torque(values)
    there = np.interp(coarse_inputs.time, recording.time, fine)
    error: FloatArray = np.interp(recording.time, coarse_inputs.time, coarse - there) / 3.0
    return error if np.isfinite(error).all() else np.zeros(recording.n)
