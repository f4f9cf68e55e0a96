"""What torque, angle and EMG have to do with each other: a linear regression, made once.

A crude model serves to tell sign and lag: two exponentials of the triceps' length, now and as
they were in the last seconds, one of the tibialis's, a constant, the acceleration, and each
muscle's activation (equation 14 with f0 = 2 Hz, beta = 1) alone and times angle, angle squared and
velocity, all averaged over 80 ms and compared at 25 Hz.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.model.geometry import moment_arm
from surae.quality.numeric import IndexArray, quantile, responded, smooth

#: Of the activation filter [Hz], which virtual subjects have between 1.6 and 2.4.
_F0 = 2.0
#: Part of what the angle leaves that EMG must explain, and what lags 0.2 s away must leave more.
_GAINED = 0.3
_SHARP = 0.15
#: Shorter trials [s] say too little of sixteen coefficients.
SHORTEST = 10.0
#: Comparison rate [Hz].
_RATE = 25.0
#: Lags that are tried [s], and the most instants at which they are: seven minutes show a lag.
LONGEST = 0.6
_STEP = 0.06
_MOST = 10_000


@dataclass(frozen=True, slots=True)
class TorqueModel:
    """Outcome of the regression."""

    #: By how much the EMG is late for the torque [s], negative where it is early; None without EMG
    #: that matters.
    lag: float | None
    group_lag: dict[str, float]  #: The same for ``"triceps"`` and ``"ta"`` on their own.
    #: What the group's own lag leaves less than the common one, as a part of what is left.
    group_gain: dict[str, float]
    #: Mean torque of each group where it is active [Nm]: positive for the triceps, negative for TA,
    #: if the signs are right.
    part: dict[str, float]
    gained: float  #: Part of what the angle alone leaves that the EMG explains, 0…1.
    #: Part of what the best lag leaves that lags 0.2 s away leave more: how well it is known.
    sharpness: float
    #: `time`, `unexplained`: times at which the torque was compared [s], and what EMG and angle
    #: leave of it [Nm], shape (k,).
    time: FloatArray
    unexplained: FloatArray

    @property
    def known(self) -> bool:
        """Whether the EMG explains enough of the torque, chance explaining 0.05, at a known lag."""
        return self.gained > _GAINED and self.sharpness > _SHARP


def activation(envelope: FloatArray, rate: float) -> FloatArray:
    """Critically damped second-order response of a muscle to an envelope."""
    omega = 2.0 * np.pi * _F0
    t = np.arange(int(0.8 * rate) + 1) / rate
    response = omega**2 * t * np.exp(-omega * t)
    return responded(envelope, response / response.sum())


def passive_columns(angle: FloatArray) -> list[FloatArray]:
    """Shapes of passive torque over the angle: the triceps twice, the tibialis, the constant."""
    tri, tib = (moment_arm(angle, group) for group in (0, 1))
    x_tri = 0.118 - 1.67 * tri
    x_tib = 0.136 - 1.56 * tib
    return [
        np.exp(160.0 * (x_tri - 0.05)) * tri,
        np.exp(240.0 * (x_tri - 0.05)) * tri,
        -np.exp(120.0 * (x_tib - 0.09)) * tib,
        np.ones_like(angle),
    ]


def relaxing(column: FloatArray, rate: float) -> FloatArray:
    """A shape of passive torque as tissue that relaxes within 3 s remembers it, from rest."""
    t = np.arange(int(9.0 * rate) + 1) / rate
    response = np.exp(-t / 3.0)
    start = float(column[0])
    return start + responded(column - start, response / response.sum())


def torque_model(
    time: FloatArray,
    rate: float,
    angle: FloatArray,
    torque: FloatArray,
    envelopes: dict[str, FloatArray],
) -> TorqueModel | None:
    """Regress the torque on angle and EMG; None where there is too little of them.

    The signals are uniform, at `rate` [Hz]: s, rad, Nm.
    """
    if len(time) < SHORTEST * rate:
        return None
    # One step in four, averaged over twice as much; the ends, without history, are left out.
    width = round(2.0 * rate / _RATE)
    stride = max(1, round(rate / _RATE))
    margin = round(0.5 * rate)
    keep = np.arange(margin, len(time) - margin, stride)

    def coarse(values: FloatArray) -> FloatArray:
        return smooth(values, width)[keep]

    y = coarse(torque)
    shapes = passive_columns(angle)
    shapes += [relaxing(shape, rate) for shape in shapes[:2]]
    # Fast chirps take most of the torque to turn the foot.
    shapes.append(np.gradient(np.gradient(angle, 1.0 / rate), 1.0 / rate))
    passive = [coarse(column) for column in shapes]
    alone = _solve(passive, y)[1]
    total = float(((y - y.mean()) ** 2).sum())
    speed = np.tanh(np.gradient(smooth(angle, width), 1.0 / rate))
    groups = _groups(envelopes, rate)
    if not groups or total <= 0.0:
        unexplained = y - np.column_stack(passive) @ _solve(passive, y)[0]
        return TorqueModel(None, {}, {}, {}, 0.0, 0.0, time[keep], unexplained)
    tables = {
        name: [*each, *(np.mean(each, axis=0) * shape for shape in (angle, angle**2, speed))]
        for name, each in groups.items()
    }
    lags = np.arange(-LONGEST, LONGEST + 1e-9, _STEP)
    # EMG that is late by a lag is in time again when it is advanced by it.
    at = np.clip(keep + np.round(lags * rate).astype(np.intp)[:, None], 0, len(time) - 1)
    smoothed = {n: np.array([smooth(c, width) for c in columns]) for n, columns in tables.items()}
    some = slice(None, None, -(-len(keep) // _MOST))
    late = {name: columns[:, at[:, some]] for name, columns in smoothed.items()}
    squares = _lagging(np.array([column[some] for column in passive]), late, y[some])
    every = np.arange(len(lags))
    together = squares(dict.fromkeys(groups, every))
    best = int(np.argmin(together))
    group_lag = {}
    group_gain = {}
    for name in groups if len(groups) > 1 else ():
        others = {other: np.full(len(lags), best) for other in groups if other != name}
        alone_at = squares({name: every, **others})
        group_lag[name] = _vertex(lags, alone_at)
        least = float(alone_at.min())
        group_gain[name] = float(together[best]) / least - 1.0 if least > 0.0 else 0.0
    moved = {name: columns[:, at[best]] for name, columns in smoothed.items()}
    columns = [*passive, *(c for name in groups for c in moved[name])]
    weights, rest = _solve(columns, y)
    sizes = {name: len(each) for name, each in groups.items()}
    part = _torque_parts(moved, weights[len(passive) :], sizes)
    away = round(0.18 / _STEP)
    beside = min(together[max(best - away, 0)], together[min(best + away, len(lags) - 1)])
    least = float(together[best])
    gained = 1.0 - rest / alone if alone > 0.0 else 0.0
    sharpness = float(beside / least - 1.0) if least > 0.0 else np.inf
    return TorqueModel(
        _vertex(lags, together),
        group_lag,
        group_gain,
        part,
        gained,
        sharpness,
        time[keep],
        y - weights @ np.array(columns),
    )


def _groups(envelopes: dict[str, FloatArray], rate: float) -> dict[str, list[FloatArray]]:
    """Active states of the muscles of each group, each as a part of its greatest."""
    groups: dict[str, list[FloatArray]] = {}
    for muscle, envelope in envelopes.items():
        # What an electrode shows at rest moves nothing.
        active = activation(np.maximum(envelope - quantile(envelope, 0.05), 0.0), rate)
        top = float(active.max())
        if top > 0.0:
            groups.setdefault("ta" if muscle == "ta" else "triceps", []).append(active / top)
    return groups


def _torque_parts(
    moved: dict[str, FloatArray], weights: FloatArray, sizes: dict[str, int]
) -> dict[str, float]:
    """Mean torque [Nm] of each group, weighed by its activity; its first rows are its muscles."""
    parts = {}
    first = 0
    for name, rows in moved.items():
        torque_of = weights[first : first + len(rows)] @ rows
        level = np.mean(rows[: sizes[name]], axis=0)
        parts[name] = float((level * torque_of).sum() / max(float(level.sum()), 1e-300))
        first += len(rows)
    return parts


def _lagging(
    passive: FloatArray, moved: dict[str, FloatArray], y: FloatArray
) -> Callable[[dict[str, IndexArray]], FloatArray]:
    """Sums of squares with each group at its lags, which are equally many.

    What is passive is taken out of everything first.
    """
    basis = np.linalg.qr(_scaled(passive).T)[0]
    rest = y - basis @ (basis.T @ y)
    active = {}
    for name, columns in moved.items():
        scaled = _scaled(columns)
        active[name] = np.swapaxes(scaled - scaled @ basis @ basis.T, 0, 1)

    def squares(lags: dict[str, IndexArray]) -> FloatArray:
        matrix = np.concatenate([active[name][at] for name, at in lags.items()], axis=1)
        gram = matrix @ np.swapaxes(matrix, 1, 2)
        gram += 1e-8 * np.eye(matrix.shape[1])
        right = matrix @ rest
        weights = np.linalg.solve(gram, right[:, :, None])[:, :, 0]
        return np.asarray(float(rest @ rest) - (weights * right).sum(axis=1))

    return squares


def _scaled(columns: FloatArray) -> FloatArray:
    norm = np.sqrt((columns**2).sum(axis=-1, keepdims=True))
    return columns / np.where(norm > 0.0, norm, 1.0)


def _solve(columns: list[FloatArray], y: FloatArray) -> tuple[FloatArray, float]:
    """Least squares by slightly damped normal equations, and the sum of squares that is left."""
    matrix = np.array(columns)
    gram = matrix @ matrix.T
    scale = np.sqrt(np.diag(gram))
    scale[scale == 0.0] = 1.0
    gram = gram / np.outer(scale, scale)
    gram[np.diag_indices_from(gram)] += 1e-8
    weights = np.linalg.solve(gram, matrix @ y / scale) / scale
    return weights, float(((y - weights @ matrix) ** 2).sum())


def _vertex(at: FloatArray, values: FloatArray) -> float:
    """Find where a sampled curve is lowest, by a parabola through its lowest three samples."""
    k = int(np.argmin(values))
    if k in (0, len(values) - 1):
        return float(at[k])
    before, here, after = values[k - 1 : k + 2]
    bend = before - 2.0 * here + after
    return float(at[k] + (0.5 * (before - after) / bend if bend > 0.0 else 0.0) * (at[1] - at[0]))
