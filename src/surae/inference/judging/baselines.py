"""What is predicted of a recording without any model: beside these a prediction is worth something.

A share of the variance says little of a torque that any mean of other strides follows as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference.judging.goodness import counted, vaf
from surae.signals import ModelInputs

#: Part of the angle's variance that the mean movement of others must explain to be the same one.
_SAME = 0.9
#: Delays of the EMG that a regression is given [s].
_LAGS = (0.0, 0.04, 0.08, 0.12)
#: Penalties that are tried, in parts of the largest eigenvalue.
_PENALTIES = np.logspace(-8.0, 0.0, 17)
#: Samples that a regression learns from, about.
_SAMPLES = 4000


@dataclass(frozen=True, slots=True)
class Baselines:
    """Variance accounted for by what knows no muscle [%]; None where there is nothing to go by."""

    template: float | None = None  #: Mean torque of other recordings of the same movement.
    ridge: float | None = None  #: Regression on angle, speed and delayed EMG of others.


def baselines(others: Sequence[ModelInputs], recording: ModelInputs) -> Baselines:
    """Predict a recording by others of the leg, without a model.

    Parameters
    ----------
    others : sequence of ModelInputs
        Those that a fit is of, with their torques.
    recording : ModelInputs
        With its torque; nothing is told where it is one of the others.
    """
    learned = [each for each in others if each.torque is not None]
    if not learned or recording.torque is None or recording in learned:
        return Baselines()
    ridge = _ridge(learned, recording)
    by_regression = None if ridge is None else _vaf(recording, ridge)
    return Baselines(_template(learned, recording), by_regression)


def _vaf(recording: ModelInputs, torque: FloatArray) -> float:
    assert recording.torque is not None
    return vaf(*counted(recording, recording.torque - torque))


def _template(others: Sequence[ModelInputs], recording: ModelInputs) -> float | None:
    """The mean torque of the same movement, each from its beginning to its end."""
    place = _part(recording)
    movement = np.mean([np.interp(place, _part(each), each.angle) for each in others], axis=0)
    away = recording.angle - recording.angle.mean()
    missed = recording.angle - movement
    if not np.sum((missed - missed.mean()) ** 2) <= (1.0 - _SAME) * float(away @ away):
        return None
    torques = [np.interp(place, _part(e), e.torque) for e in others if e.torque is not None]
    return _vaf(recording, np.mean(torques, axis=0))


def _part(recording: ModelInputs) -> FloatArray:
    """Time as a part of the recording, 0 … 1, shape (n,)."""
    time = recording.time - recording.time[0]
    return np.asarray(time / max(float(time[-1]), 1e-12))


def _ridge(others: Sequence[ModelInputs], recording: ModelInputs) -> FloatArray | None:
    """The torque by a penalised regression whose penalty is chosen by cross-validation (GCV)."""
    X = np.concatenate([_features(each)[each.counts] for each in others])
    y = np.concatenate([each.torque[each.counts] for each in others if each.torque is not None])
    step = max(len(y) // _SAMPLES, 1)
    X, y = X[::step], y[::step]
    mean, sd = X.mean(axis=0), X.std(axis=0)
    varies = sd > 1e-9 * max(float(sd.max()), 1e-12)
    if len(y) <= X.shape[1] or not varies.any():
        return None
    mean, sd = mean[varies], sd[varies]
    u, s, vt = np.linalg.svd((X[:, varies] - mean) / sd, full_matrices=False)
    along = u.T @ (y - y.mean())
    outside = float(np.sum((y - y.mean()) ** 2) - along @ along)

    def score(penalty: float) -> float:
        shrunk = s**2 / (s**2 + penalty)
        missed = outside + float(np.sum(((1.0 - shrunk) * along) ** 2))
        return missed / (1.0 - (float(shrunk.sum()) + 1.0) / len(y)) ** 2

    best = min(_PENALTIES * float(s[0] ** 2), key=score)
    weights = vt.T @ (s / (s**2 + best) * along)
    return np.asarray(y.mean() + (_features(recording)[:, varies] - mean) / sd @ weights)


def _features(recording: ModelInputs) -> FloatArray:
    """Angle to its third power, speed, and each EMG with its delays, shape (n, k)."""
    columns = [recording.angle**power for power in (1, 2, 3)]
    columns.append(recording.velocity)
    for channel in recording.emg.T:
        columns += [
            np.interp(recording.time - lag, recording.time, channel, left=channel[0])
            for lag in _LAGS
        ]
    return np.stack(columns, axis=1)
