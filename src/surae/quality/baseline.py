"""The torque of a leg that does nothing at an angle where nothing is stretched."""

from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.model.geometry import moment_arm
from surae.quality.numeric import BoolArray, IndexArray, quantile, smooth
from surae.quality.torque_model import SHORTEST, activation
from surae.recording import MUSCLES

#: Stiffness coefficients k of equation (8) that are tried [1/m]: healthy legs have 170 to 230 and
#: 90 to 130, patients up to 235 and 160.
_K_TRI = np.arange(120.0, 281.0, 20.0)
_K_TIB = np.arange(70.0, 191.0, 20.0)
#: A muscle whose activation is below this part of its largest is at rest.
_RESTING = 0.03
#: Rest that is needed [s], and the part of its range that the angle then goes through [rad].
_SECONDS = 3.0
_SPAN = 0.35


@dataclass(frozen=True, slots=True)
class RestLevel:
    """The constant part of a torque at θ = 0, and the root mean square of what is left [Nm]."""

    level: float
    spread: float


def resting(rate: float, envelopes: dict[str, FloatArray], n: int) -> BoolArray:
    """Samples at which no muscle pulls, nor has just pulled."""
    quiet = np.ones(n, dtype=bool)
    for envelope in envelopes.values():
        active = activation(np.maximum(envelope - quantile(envelope, 0.05), 0.0), rate)
        top = quantile(active, 0.99)
        # Where the EMG hardly varies there is no activity to leave out.
        if top > 2.0 * quantile(envelope, 0.05):
            quiet &= active < _RESTING * top
    return quiet


def baseline(
    rate: float, angle: FloatArray, torque: FloatArray, envelopes: dict[str, FloatArray]
) -> RestLevel | None:
    """The constant part of the torque, as it is at θ = 0 [Nm].

    Exponentials of both muscles' lengths and c·cos θ are fitted to the torque at rest; where the
    leg is never at rest, together with what the EMG explains. c is m·g·la and whatever offset the
    sensor has: the two cannot be told apart in a leg that only turns about its ankle.

    None where too little of the range is gone through to tell it from the passive torque.
    """
    n = len(angle)
    quiet = resting(rate, envelopes, n)
    enough = quiet.sum() >= _SECONDS * rate and float(np.ptp(angle[quiet])) >= _SPAN
    tells = enough or (len(envelopes) == len(MUSCLES) and float(np.ptp(angle)) >= _SPAN)
    if n < SHORTEST * rate or not tells:
        return None
    stride = max(1, round(rate / 25.0))
    width = round(0.12 * rate)
    rows = np.zeros(n, dtype=bool)
    rows[round(0.2 * rate) :: stride] = True
    if enough:
        rows &= quiet

    def coarse(values: FloatArray) -> FloatArray:
        return smooth(values, width)[rows]

    tri, tib = (moment_arm(angle, group) for group in (0, 1))
    columns = [coarse(np.exp(k * (0.068 - 1.67 * tri)) * tri) for k in _K_TRI]
    columns += [coarse(-np.exp(k * (0.046 - 1.56 * tib)) * tib) for k in _K_TIB]
    columns.append(coarse(np.cos(angle)))
    # Fast chirps take most of the torque to turn the foot.
    columns.append(coarse(np.gradient(np.gradient(angle, 1.0 / rate), 1.0 / rate)))
    if not enough:
        speed = np.tanh(np.gradient(smooth(angle, width), 1.0 / rate))
        for name in ("ta", "triceps"):
            heads = [
                activation(np.maximum(e - quantile(e, 0.05), 0.0), rate)
                for m, e in envelopes.items()
                if (m == "ta") == (name == "ta")
            ]
            together = np.mean(heads, axis=0)
            shapes = (angle, angle**2, speed, speed * angle)
            columns += [coarse(head) for head in heads]
            columns += [coarse(together * shape) for shape in shapes]
    return _constant(np.column_stack(columns), coarse(torque))


def _constant(matrix: FloatArray, y: FloatArray) -> RestLevel:
    """The coefficient of the cosine in the best of the fits, one for each pair of stiffnesses."""
    scale = np.sqrt((matrix**2).sum(axis=0))
    scale[scale == 0.0] = 1.0
    gram = (matrix / scale).T @ (matrix / scale)
    right = (matrix / scale).T @ y
    first = len(_K_TRI)
    second = len(_K_TRI) + len(_K_TIB)
    pairs = np.array([(i, j) for i in range(first) for j in range(first, second)])
    rest = np.arange(second, matrix.shape[1])
    best = -np.inf
    level = 0.0
    # A muscle that pushes is left out: then only the other is there, or neither.
    weights, gains = _solved(gram, right, pairs, rest)
    pulling = weights[:, :2] > 0.0
    both = np.all(pulling, axis=1)
    alone = np.unique(pairs[pulling & ~both[:, None]])[:, None]
    fits = [(weights[both], gains[both])]
    if len(alone):
        fits.append(_solved(gram, right, alone, rest))
    if not np.any(pulling, axis=1).all():
        fits.append(_solved(gram, right, np.empty((1, 0), dtype=np.intp), rest))
    for weights, gains in fits:
        if len(gains) and float(gains.max()) > best:
            k = int(np.argmax(gains))
            best = float(gains[k])
            level = float(weights[k, weights.shape[1] - len(rest)] / scale[second])
    rest_power = max(float(y @ y) - best, 0.0)
    return RestLevel(level, float(np.sqrt(rest_power / len(y))))


def _solved(
    gram: FloatArray, right: FloatArray, own: IndexArray, rest: IndexArray
) -> tuple[FloatArray, FloatArray]:
    """A fit for each row of `own`, of those columns and the `rest`: weights, and what it explains.

    Shapes are (k, c) and (k,).
    """
    chosen = np.concatenate([own, np.tile(rest, (len(own), 1))], axis=1)
    square = gram[chosen[:, :, None], chosen[:, None, :]] + 1e-9 * np.eye(chosen.shape[1])
    weights = np.linalg.solve(square, right[chosen][:, :, None])[:, :, 0]
    return weights, (weights * right[chosen]).sum(axis=1)
