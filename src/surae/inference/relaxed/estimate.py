"""From prepared recordings of one leg to its relaxed curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from surae.base.units import FloatArray
from surae.inference.relaxed.basis import Basis
from surae.inference.relaxed.changes import MOST, JumpColumn, likeliest_change, with_change
from surae.inference.relaxed.context import (
    Hypothesis,
    Laboratory,
    gaussians,
    hypotheses,
    plate_by_inertia,
)
from surae.inference.relaxed.noise import AUTOREGRESSIONS, MOVING
from surae.inference.relaxed.posterior import Mode, Whitened, mode_of
from surae.inference.relaxed.regressors import Blocks, Columns, blocks_of, columns_of
from surae.inference.relaxed.rest import Rest, rest_of
from surae.signals import ModelInputs

#: Sizes S [Nm] at the end of the range and bends D that are weighed by their evidence: from a
#: compliant to a spastic calf, from an exponential to a toe or a capsule.
SIZES = (0.5, 1.5, 5.0, 15.0)
BENDS = (0.03, 0.15, 0.5)
#: Readings of what is no tissue that are less likely than this, against the likeliest, are left
#: out, as are parts of the posterior.
_UNLIKELY = 0.01
_TINY = 1e-3
#: Ends of the relaxed range, as parts of its samples.
_ENDS = (0.005, 0.995)
#: The noise before anything is known [Nm].
_SIGMA = 0.1


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the posterior: one size, one bend, one reading of what is no tissue."""

    share: float  #: Its posterior probability.
    hypothesis: Hypothesis
    mode: Mode


@dataclass(frozen=True, slots=True)
class Estimate:
    """The posterior of one leg, and what it was made of."""

    rest: Rest
    trials: tuple[Blocks, ...]  #: All of them, those without rest too.
    columns: Columns
    data: Whitened
    changes: tuple[JumpColumn, ...]
    parts: tuple[Part, ...]
    hypotheses: tuple[tuple[Hypothesis, float], ...]  #: Each with its posterior probability.


def estimated(trials: Sequence[ModelInputs], laboratory: Laboratory) -> Estimate | None:
    """The posterior of the leg of these trials; None where none of them rests for a second."""
    rest = rest_of(trials)
    blocks = [blocks_of(*each) for each in zip(trials, rest.masks, rest.shares, strict=True)]
    resting = [each for each in blocks if each.pieces]
    if not resting:
        return None
    angles = np.concatenate([each.angle[i:j] for each in resting for i, j in each.pieces])
    low, high = np.quantile(angles, _ENDS)
    columns = columns_of(resting, Basis(float(low), float(high)))
    every = hypotheses(laboratory, len(resting))
    offset = float(columns.torque.mean())
    first = max(every, key=lambda each: each.odds)
    data, mode = _with_noise(columns, first, offset, None)
    changes: list[JumpColumn] = []
    while len(changes) < MOST and (change := likeliest_change(data, mode)) is not None:
        columns = with_change(columns, change, mode, len(changes))
        changes.append(change)
        begin = replace(mode, z=np.append(mode.z, 0.0))
        data, mode = _with_noise(columns, first, offset, begin)
    parts, weighed = _averaged(data, every, offset, mode)
    return Estimate(
        rest, tuple(blocks), columns, data, tuple(changes), tuple(parts), tuple(weighed)
    )


def _with_noise(
    columns: Columns, hypothesis: Hypothesis, offset: float, start: Mode | None
) -> tuple[Whitened, Mode]:
    """The likeliest noise for a middling curve, and the mode with it."""
    basis = columns.basis
    prior = gaussians(basis.spread(SIZES[1], BENDS[1]), columns.names, hypothesis, offset)
    z = prior.mean if start is None else start.z
    sigma = _SIGMA if start is None else start.sigma
    best: tuple[Whitened, Mode] | None = None
    for ar in AUTOREGRESSIONS:
        for white in MOVING:
            data = Whitened(columns, ar, -white * ar)
            mode = mode_of(data, prior, z, sigma, steps=2 if best is None else 1)
            if best is None or mode.evidence > best[1].evidence:
                best = data, mode
                z = mode.z
                sigma = mode.sigma
    assert best is not None
    return best[0], mode_of(best[0], prior, z, sigma)


def _averaged(
    data: Whitened, every: Sequence[Hypothesis], offset: float, start: Mode
) -> tuple[list[Part], list[tuple[Hypothesis, float]]]:
    """The posterior over sizes, bends and readings, each by its evidence."""
    columns = data.columns

    def at(size: float, bend: float, hypothesis: Hypothesis, begin: Mode) -> Mode:
        prior = gaussians(columns.basis.spread(size, bend), columns.names, hypothesis, offset)
        return mode_of(data, prior, begin.z, begin.sigma, steps=4)

    likeliest = max(every, key=lambda each: each.odds)
    grid = {pair: at(*pair, likeliest, start) for pair in product(SIZES, BENDS)}
    best = max(grid, key=lambda pair: grid[pair].evidence)
    alone = {each: at(*best, each, grid[best]) for each in every}
    heard = _plate_told(columns.names, alone[likeliest])
    wholes = _wholes(every, heard)
    shares = _shared(every, [alone[each] for each in every], wholes)
    parts: list[Part] = []
    for each, share in zip(every, shares, strict=True):
        if share < _UNLIKELY * shares.max():
            continue
        for pair, begin in grid.items():
            if begin.evidence < grid[best].evidence - 8.0:
                continue
            mode = begin if each is likeliest else at(*pair, each, alone[each])
            parts.append(Part(0.0, each, mode))
    weights = _shared([part.hypothesis for part in parts], [part.mode for part in parts], wholes)
    chosen = [
        replace(part, share=float(w)) for part, w in zip(parts, weights, strict=True) if w >= _TINY
    ]
    total = sum(part.share for part in chosen)
    chosen = [replace(part, share=part.share / total) for part in chosen]
    weighed = [
        (each, sum(part.share for part in chosen if part.hypothesis is each)) for each in every
    ]
    return chosen, weighed


def _plate_told(names: Sequence[str], foot: Mode) -> float:
    """What the inertia says for a plate, with a foot's posterior."""
    at = len(foot.z) - len(names) + names.index("inertia")
    return plate_by_inertia(float(foot.z[at]), float(foot.covariance()[at, at]))


def _wholes(every: Sequence[Hypothesis], told: float) -> dict[bool, float]:
    """Posterior probabilities of no plate and of one: prior odds, and what the inertia says."""
    odds = {False: 0.0, True: 0.0}
    for each in every:
        odds[each.plate] += each.odds
    odds[True] *= float(np.exp(np.clip(told, -50.0, 50.0)))
    total = sum(odds.values())
    return {plate: part / total for plate, part in odds.items()}


def _shared(
    readings: Sequence[Hypothesis], modes: Sequence[Mode], wholes: dict[bool, float]
) -> FloatArray:
    """Shares of parts: with and without a plate as these are, within each by evidence."""
    shares = np.zeros(len(modes))
    logs = np.array(
        [np.log(h.odds) + mode.evidence for h, mode in zip(readings, modes, strict=True)]
    )
    for plate, whole in wholes.items():
        of_plate = np.array([each.plate is plate for each in readings])
        if of_plate.any():
            shares[of_plate] = whole * _normalised(logs[of_plate])
    return np.asarray(shares / shares.sum())


def _normalised(logs: FloatArray) -> FloatArray:
    parts = np.exp(logs - logs.max())
    made: FloatArray = parts / parts.sum()
    return made
