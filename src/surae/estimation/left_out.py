"""What a model leaves out, and how far that may have moved the estimates.

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
"""

from collections.abc import Sequence

import numpy as np

from surae.estimation import shifts
from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target, whitened
from surae.model.simulator import TorqueParts
from surae.signals import ModelInputs
from surae.units import FloatArray

#: What hides may be so many times what shows: legs of other muscles than the model's (decision 16).
_HIDDEN = 3.0
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
    noisy: Sequence[Sequence[FloatArray]],
) -> FloatArray:
    """Shifts by what the model leaves out, as they are searched; see `Family.spread`.

    `noisy` is what draws of the EMG's noise change of the residual of each recording [Nm].
    """
    covariance = quadratic.solved({})[2]
    grams, seens, levers, felt, pulled, groups = [], [], [], [], [], np.zeros(0)
    gradient = quadratic.weight**2 * (mode.z - quadratic.mean)
    blocks = zip(target.problem.inputs, target.data_rows(mode.z), target.noise, strict=True)
    for number, (recording, rows, noise) in enumerate(blocks):
        root = 1.0 if recording.weight is None else np.sqrt(recording.weight)
        features, groups = _features(recording, target.parts(mode.z, number))
        features = whitened(features * root, noise)
        grams.append(features @ features.T)
        seens.append(features @ rows[-1])
        levers.append(rows[:-1] @ features.T)
        gradient = gradient + rows[:-1] @ rows[-1]
        shaken = whitened(np.stack([draw[number] for draw in noisy]) * root, noise)
        felt.append(shaken @ features.T)
        pulled.append(shaken @ rows[:-1].T)
    size = np.sqrt(np.maximum(np.diag(sum(grams)), 1e-300))
    gram, lever = sum(grams) / np.outer(size, size), sum(levers) / size
    moved = covariance @ lever
    # the mode is beside the minimum where EMG is noisy
    seen = sum(seens) / size - moved.T @ gradient
    by_emg = sum(felt) / size - sum(pulled) @ moved
    variance, directions = np.linalg.eigh(gram - lever.T @ moved)
    kept = variance > _NOTHING * variance[-1]
    view = np.sqrt(variance[kept])[:, None] * directions[:, kept].T
    to_view = directions[:, kept].T / np.sqrt(variance[kept])[:, None]
    noise_seen = np.eye(len(view)) + to_view @ (by_emg.T @ by_emg) @ to_view.T / len(noisy)
    seen = to_view @ seen
    logs, gain = _sizes(view, seen, noise_seen, groups)
    prior = np.exp(logs)[groups]
    taken = prior[:, None] * view.T @ np.linalg.inv((view * prior) @ view.T + noise_seen)
    known = np.diag(prior) - taken @ (view * prior)
    shown = taken @ seen
    likely = 1.0 / (1.0 + np.exp(min(_AGAINST - gain, 500.0)))
    ways = shifts.root(known + np.outer(shown, shown))
    return np.asarray(_HIDDEN * np.sqrt(likely) * ways @ moved.T)


def _sizes(
    view: FloatArray, seen: FloatArray, noise: FloatArray, groups: FloatArray
) -> tuple[FloatArray, float]:
    """The most likely ln s² of each group of functions, and what ln L gains by them."""
    from scipy.optimize import minimize

    def unlikely(logs: FloatArray) -> float:
        whole = (view * np.exp(logs)[groups]) @ view.T + noise
        return float(np.linalg.slogdet(whole)[1] + seen @ np.linalg.solve(whole, seen))

    def believed(logs: FloatArray) -> float:
        # half-Cauchy beforehand, so that a size of which nothing is seen stays finite (Gelman 2006)
        return unlikely(logs) + 2.0 * float(np.log1p(np.exp(logs) / _USUAL**2).sum())

    count = int(groups.max()) + 1
    ends = [
        minimize(believed, np.full(count, begin), bounds=[_RANGE] * count, method="L-BFGS-B")
        for begin in _BEGIN
    ]
    best = min(ends, key=lambda end: end.fun)
    none = float(np.linalg.slogdet(noise)[1] + seen @ np.linalg.solve(noise, seen))
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
