"""Steps in mid-trial: of the torque's zero, or of the foot on its plate, found by the evidence."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular

from surae.base.units import FloatArray
from surae.inference.relaxed.context import SLIP, STEP
from surae.inference.relaxed.noise import whitened
from surae.inference.relaxed.posterior import Mode, Whitened, jacobian, residual
from surae.inference.relaxed.regressors import Columns

#: Prior odds of a step at any time of a trial, so many seconds apart, as far from the ends of rest.
_ODDS = 0.02
_APART = 0.5
_FROM_END = 3.0
#: Logarithm of the posterior odds from which on a step is one: a step that is none takes what it
#: explains from the relaxation, and a slip that is none is the short-range stiffness at a start.
_SURE = {"step": 5.0, "slip": 40.0}
#: Blocks with the largest innovations of the noise, at which a step is tried too.
_JUMPS = 40
#: Steps that are tried at once: an hour has seven thousand, of as many samples each.
_AT_ONCE = 256
#: A slip is told by one curve at two places: on both sides of it rest moves over a common range at
#: least so wide [deg]. Where the foot only stood before, the curve itself is such a slip.
_IN_COMMON = 5.0
#: Columns of steps at most: one that falls within a block has two.
MOST = 6
#: What steps, and how large they are expected to be.
_SIZES = {"step": STEP, "slip": SLIP}


@dataclass(frozen=True, slots=True)
class JumpColumn:
    """A step in mid-trial."""

    kind: str  #: ``"step"`` of the torque's zero [Nm], ``"slip"`` of the angle [deg].
    trial: int  #: Number of the trial.
    time: float  #: When [s].
    log_odds: float  #: Logarithm of the posterior odds that there is one.


def likeliest_change(data: Whitened, mode: Mode) -> JumpColumn | None:
    """The step that the data speak most for; None where they rather speak for none.

    A column u beside those of the posterior, its size s ~ N(0, S²): the Bayes factor is that of
    linear Gaussian models, ½b²/d − ½ln(d·S²), with b = u'r/σ² and d = u'(I − JA⁻¹J'/σ²)u/σ² + S⁻².
    """
    columns = data.columns
    r = residual(data, mode.z)
    places = _places(columns, r)
    if not places:
        return None
    half = solve_triangular(mode.factor, jacobian(data, mode.z).T / mode.sigma, lower=True)
    best: JumpColumn | None = None
    for kind, size in _SIZES.items():
        tried = places if kind == "step" else _moved_on_both_sides(columns, places)
        if not tried:
            continue
        sums = []
        for first in range(0, len(tried), _AT_ONCE):
            some = tried[first : first + _AT_ONCE]
            steps = [column(columns, kind, *place, mode) for place in some]
            sums.append(_sums(data, half, steps, mode, r))
        b, d = np.hstack(sums)
        d += size**-2
        log_odds = (
            0.5 * b**2 / d - 0.5 * np.log(d * size**2) + np.log(_ODDS / len(places) / len(_SIZES))
        )
        at = int(np.argmax(log_odds))
        enough = log_odds[at] > _SURE[kind]
        if enough and (best is None or log_odds[at] > best.log_odds):
            best = JumpColumn(kind, *tried[at], float(log_odds[at]))
    return best


def with_change(columns: Columns, change: JumpColumn, mode: Mode, number: int) -> Columns:
    """The columns, and one of the step."""
    made = column(columns, change.kind, change.trial, change.time, mode)
    return replace(
        columns,
        context=np.column_stack([columns.context, made]),
        names=(*columns.names, f"{change.kind}_{number}"),
    )


def column(columns: Columns, kind: str, trial: int, time: float, mode: Mode) -> FloatArray:
    """Torque of a step by 1 Nm, or of a slip by 1° on the slope of the curve, shape (n,)."""
    after = (columns.trial == trial) & (columns.time >= time)
    if kind == "step":
        return np.asarray(after, dtype=float)
    weights = mode.z[: columns.basis.size]
    inside = np.clip(columns.angle, columns.basis.low, columns.basis.high)
    slope: FloatArray = columns.basis.slopes(inside) @ weights
    return np.asarray(after * slope)


def _sums(
    data: Whitened, half: FloatArray, steps: list[FloatArray], mode: Mode, r: FloatArray
) -> FloatArray:
    """What the residual r has along each step, and what the others leave of it, shape (2, k)."""
    white = whitened(np.column_stack(steps), data.columns.cuts, data.ar, data.ma)
    inner = half @ white / mode.sigma
    d = (white**2).sum(axis=0) / mode.sigma**2 - (inner**2).sum(axis=0)
    return np.stack([white.T @ r / mode.sigma**2, d])


def _places(columns: Columns, r: FloatArray) -> list[tuple[int, float]]:
    """Trials and times [s] at which a step is tried: at each half second, and where noise jumps."""
    jumps = set(np.argsort(-np.abs(r))[:_JUMPS].tolist())
    places = []
    for trial in np.unique(columns.trial):
        index = np.flatnonzero(columns.trial == trial)
        times = columns.time[index]
        step = max(round(_APART / max(float(np.median(np.diff(times))), 1e-3)), 1)
        inside = (times >= times[0] + _FROM_END) & (times <= times[-1] - _FROM_END)
        places += [
            (int(trial), float(times[k]))
            for k, i in enumerate(index.tolist())
            if inside[k] and (k % step == 0 or i in jumps or i - 1 in jumps)
        ]
    return places


def _moved_on_both_sides(
    columns: Columns, places: list[tuple[int, float]]
) -> list[tuple[int, float]]:
    """Those places on whose both sides the trial's rest moves over a range in common."""
    made = []
    for trial in np.unique(columns.trial):
        index = columns.trial == trial
        time, angle = columns.time[index], columns.angle[index]
        before = [of.accumulate(angle) for of in (np.minimum, np.maximum)]
        behind = [of.accumulate(angle[::-1])[::-1] for of in (np.minimum, np.maximum)]
        for place in (place for place in places if place[0] == trial):
            k = int(np.searchsorted(time, place[1]))
            low, high = max(before[0][k - 1], behind[0][k]), min(before[1][k - 1], behind[1][k])
            if high - low >= _IN_COMMON:
                made.append(place)
    return made
