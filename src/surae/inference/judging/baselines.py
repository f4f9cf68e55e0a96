"""What is predicted of a recording without any model: beside these a prediction is worth something.

A share of the variance says little of a torque that the mean of other strides follows as well, or a
regression that knows no muscle.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference.judging.goodness import counted, vaf
from surae.signals import ModelInputs
from surae.signals.cycles import find_cycles

#: Part of the angle's variance that the mean movement of others must explain to be the same one.
_SAME = 0.9
#: Delays of the EMG that a regression is given [s].
_LAGS = (0.0, 0.04, 0.08, 0.12, 0.16, 0.2)
#: Penalties that are tried, in parts of the mean square of a feature.
_PENALTIES = np.logspace(-8.0, 1.0, 19)
#: Samples that a regression learns from, about.
_SAMPLES = 4000
#: Parts of a single trial, one of which is left out at a time.
_PARTS = 4

#: Why there is nothing to compare with.
OWN = "it is a recording of the fit"
NO_OTHERS = "the fit has no other recording with a torque"
NOT_CYCLIC = "the movement is not that of the fit’s recordings, cycle by cycle or as a whole"
TOO_FEW = "the fit’s recordings have too few samples, or nothing in them changes"


@dataclass(frozen=True, slots=True)
class Baselines:
    """Variance accounted for by what knows no muscle [%]; None where there is nothing to go by."""

    template: float | None = None  #: Mean torque of other recordings at the same phase.
    ridge: float | None = None  #: Regression on angle, speed and delayed EMG of others.
    #: `template_reason`, `ridge_reason`: why there is none; empty where there is one, or where it
    #: was not asked.
    template_reason: str = ""
    ridge_reason: str = ""

    @property
    def best(self) -> float | None:
        """The better of both [%]."""
        there = [share for share in (self.template, self.ridge) if share is not None]
        return max(there, default=None)


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
    if recording in learned:
        return Baselines(template_reason=OWN, ridge_reason=OWN)
    if not learned or recording.torque is None:
        return Baselines(template_reason=NO_OTHERS, ridge_reason=NO_OTHERS)
    template = template_torque(learned, recording)
    ridge = ridge_torque(learned, recording)
    return Baselines(
        None if template is None else _vaf(recording, template),
        None if ridge is None else _vaf(recording, ridge),
        NOT_CYCLIC if template is None else "",
        TOO_FEW if ridge is None else "",
    )


def _vaf(recording: ModelInputs, torque: FloatArray) -> float:
    assert recording.torque is not None
    return vaf(*counted(recording, recording.torque - torque))


def template_torque(others: Sequence[ModelInputs], recording: ModelInputs) -> FloatArray | None:
    """The mean torque of others at the same phase [Nm], shape (n,).

    Phase is that within a cycle where all of them repeat themselves, else the part of the
    recording. None where the mean angle at the same phase is another movement.
    """
    for phase_of in (_of_cycle, _of_whole):
        phase_here = phase_of(recording)
        phases = [phase_of(each) for each in others]
        if phase_here is None or any(phase is None for phase in phases):
            continue
        phase_here = np.where(
            phase_here < 0.0, phase_here + 1.0, phase_here
        )  # what stands before is its own end
        angle, torque = (
            _mean_at(phase_here, phases, [getattr(each, name) for each in others])
            for name in ("angle", "torque")
        )
        away = recording.angle - recording.angle.mean()
        missed = recording.angle - angle
        if np.sum((missed - missed.mean()) ** 2) <= (1.0 - _SAME) * float(away @ away):
            return torque
    return None


#: Points of a phase at which others are averaged.
_POINTS = 201


def _of_whole(recording: ModelInputs) -> FloatArray | None:
    """Time as a part of the recording, 0 … 1, shape (n,); below 0 in what stands before it."""
    time = recording.time - recording.time[0] - recording.lead_in
    return np.asarray(time / max(float(time[-1]), 1e-12))


def _of_cycle(recording: ModelInputs) -> FloatArray | None:
    """Part of the cycle, shape (n,), NaN outside of one; None where nothing repeats itself."""
    cycles = find_cycles(recording.angle, recording.rate_hz, recording.counts)
    if cycles is None:
        return None
    phase = np.full(recording.n, np.nan)
    for first, past in cycles.spans:
        phase[first:past] = np.arange(past - first) / (past - first)
    # what is before the first and after the last goes on as the cycle beside it
    (first, past) = cycles.spans[0]
    before = np.arange(first)
    phase[:first] = ((before - first) / (past - first)) % 1.0
    (first, past) = cycles.spans[-1]
    after = np.arange(past, recording.n)
    phase[past:] = ((after - past) / (past - first)) % 1.0
    known = ~np.isnan(phase)
    at = np.arange(recording.n)
    return np.where(known, phase, np.interp(at, at[known], phase[known]))


def _mean_at(
    at: FloatArray, phases: Sequence[FloatArray | None], signals: Sequence[FloatArray]
) -> FloatArray:
    """The mean of others' signals at phases, shape (n,); each of them counts alike."""
    if all(phase is not None and np.all(np.diff(phase) >= 0.0) for phase in phases):
        pairs = zip(phases, signals, strict=True)  # each phase but once
        return np.asarray(np.mean([np.interp(at, p, s) for p, s in pairs if p is not None], axis=0))
    edges = np.linspace(0.0, 1.0, _POINTS)
    middle = 0.5 * (edges[1:] + edges[:-1])
    means = []
    for phase, signal in zip(phases, signals, strict=True):
        assert phase is not None
        bins = np.clip(np.searchsorted(edges, phase, side="right") - 1, 0, len(middle) - 1)
        count = np.bincount(bins, minlength=len(middle))
        total = np.bincount(bins, weights=signal, minlength=len(middle))
        there = count > 0
        means.append(np.interp(middle, middle[there], total[there] / count[there]))
    return np.asarray(np.interp(at, middle, np.mean(means, axis=0)))


def ridge_torque(others: Sequence[ModelInputs], recording: ModelInputs) -> FloatArray | None:
    """The torque by a ridge regression [Nm], its penalty chosen by leaving out a trial at a time.

    Of a single trial a quarter is left out at a time. None where there is too little to learn from.
    """
    parts = _parts(others)
    X = np.concatenate([x for x, _ in parts])
    y = np.concatenate([torque for _, torque in parts])
    mean, sd = X.mean(axis=0), X.std(axis=0)
    varies = sd > 1e-9 * max(float(sd.max()), 1e-12)
    if len(y) <= X.shape[1] or not varies.any():
        return None
    mean, sd = mean[varies], sd[varies]
    level = float(y.mean())
    products = []
    for x, torque in parts:
        z = np.column_stack([(x[:, varies] - mean) / sd, np.ones(len(x))])
        products.append((z.T @ z, z.T @ (torque - level), z, torque - level))
    gram = np.sum([each[0] for each in products], axis=0)
    along = np.sum([each[1] for each in products], axis=0)

    def score(penalty: float) -> float:
        missed = 0.0
        for gram_of, by, z, torque in products:
            weights = _solved(gram - gram_of, along - by, penalty * (len(y) - len(torque)))
            missed += float(np.sum((torque - z @ weights) ** 2))
        return missed

    weights = _solved(gram, along, min(_PENALTIES, key=score) * len(y))
    features = (_features(recording)[:, varies] - mean) / sd
    return np.asarray(level + features @ weights[:-1] + weights[-1])


def _parts(others: Sequence[ModelInputs]) -> list[tuple[FloatArray, FloatArray]]:
    """Features and torque of each trial, or of the parts of a single one."""
    step = max(sum(each.counted for each in others) // _SAMPLES, 1)
    made = []
    for each in others:
        assert each.torque is not None
        made.append((_features(each)[each.counts][::step], each.torque[each.counts][::step]))
    if len(made) > 1:
        return made
    (x, y), *_ = made
    return list(zip(np.array_split(x, _PARTS), np.array_split(y, _PARTS), strict=True))


def _solved(gram: FloatArray, along: FloatArray, penalty: float) -> FloatArray:
    """Weights of standardised features, which are penalised, and of the level, which is not."""
    held = np.full(len(gram), penalty)
    held[-1] = 1e-9 * max(float(gram[-1, -1]), 1.0)
    return np.asarray(np.linalg.lstsq(gram + np.diag(held), along, rcond=None)[0])


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
