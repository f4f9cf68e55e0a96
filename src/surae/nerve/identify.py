"""One recording's cascade: structure, direction, and what the others say of every number."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from surae.base.units import FloatArray
from surae.nerve.cascade import Structure
from surae.nerve.fitting import Fitted, Noise, Problem, noise_of, solved
from surae.nerve.judged import INTRINSIC, REFLEX, Judged, Number, parameter, share
from surae.nerve.other_structures import BETTER, PLAIN, RELAXING, OtherStructures
from surae.nerve.piece import Piece
from surae.nerve.presence import Weighed, bound, first_shape, shapes, weigh
from surae.nerve.response import free_noise, lagged

#: z of a trend, and of the scatter over tens of seconds, from which stiffness is said to change.
CHANGING = 3.0
#: What filters of the channels, which no equation has, may do over the band, as parts of the value:
#: of a torque that is filtered, inertia was off by 1 to 1.6 %, viscosity by 2 % (`legs`, qd to qf);
#: gain and share by 1 to 2 % with intervals that were narrower (qb, qf; seeds 1201 to 1205, whose
#: ql legs had been looked at by then as well).
CHANNELS = {
    "intrinsic_stiffness": 0.01,
    "intrinsic_viscosity": 0.02,
    "inertia": 0.02,
    "reflex_gain": 0.02,
    "reflex_share": 0.02,
}
#: Length of the parts whose stiffness is compared [s].
PART = 10.0
#: Thresholds at which its search begins [rad/s].
SEARCHED = (0.03, 0.15, 0.4)


@dataclass(frozen=True, slots=True)
class Cascade:
    """What one recording says of both paths."""

    fitted: Fitted  #: The structure that describes it best, and its values.
    noise: Noise  #: Of what is left.
    numbers: Mapping[str, Number]  #: Measures that could be estimated.
    structures: Mapping[str, Number]  #: Stiffness of every structure that has its say.
    weighed: Mapping[int, Weighed]  #: Each direction on torque that was not fitted.
    direction: int  #: That which describes the torque better, whether present or not.
    share: Number  #: The reflex's share of the torque [%] in that direction.
    unseen: tuple[float, float]  #: Greatest share [%] and gain that may be hidden.
    halves: tuple[Number, Number]  #: Stiffness of both halves.
    parts: FloatArray  #: Stiffness of every ten seconds: time [s], value, standard error; (n, 3).
    trend: float  #: z of a stiffness that changes in proportion to time.
    scattered: bool  #: Whether the parts differ by more than chance.
    misfit: float  #: z of what responses without equations explain beyond the equations.


#: Says whether a reflex is present: of a direction, its weight on torque that was not fitted, the
#: reflex's share, the fit, and the greatest share and gain that may be hidden.
Judge = Callable[[int, Weighed, Number, Fitted, tuple[float, float]], bool]


def identify(
    pieces: Sequence[Piece], halves: Sequence[Sequence[Piece]], floor: float, judge: Judge
) -> Cascade:
    """Estimate everything; `judge` says whether a reflex is present."""
    free = Problem(pieces, free_noise(pieces))
    first = _first(free)
    direction = first.direction
    problem = Problem(pieces, noise_of(pieces, [first.fitted.residual(p) for p in pieces]))
    starts = {d: problem.fit(replace(first.base, direction=d), first.values[d]) for d in (0, 1, -1)}
    trained = {d: fitted.values for d, fitted in starts.items()}
    weighed, folds = weigh(halves, problem, first.base, trained)
    full = _with_threshold(problem, first.base, direction, starts[direction])
    its_share = Judged(problem, full).number("reflex_share", lambda f: share(pieces, f))
    present = judge(direction, weighed[direction], its_share, full, first.unseen)

    chosen = full if present else starts[0]
    noise = noise_of(pieces, [chosen.residual(p) for p in pieces])
    problem = Problem(pieces, noise)
    chosen = _filtered(problem, problem.fit(chosen.structure, chosen.values))
    judged = Judged(problem, chosen, floor)
    misfit = _misfit(free, chosen, first)
    numbers, structures = OtherStructures(
        problem, chosen, _numbers(judged, pieces, present), starts[direction], misfit
    ).weighed()
    if present:
        beyond = numbers["reflex_threshold"]
        numbers["reflex_threshold"] = replace(beyond, low=max(beyond.low, 0.0))

    parts = _parts(problem, judged)
    scattered = _scattered(parts)
    if scattered:
        freedom = len(parts) - 1
        half = float(stdtrit(freedom, 0.975) * parts[:, 1].std(ddof=1) / np.sqrt(len(parts)))
        k = numbers["intrinsic_stiffness"]
        numbers["intrinsic_stiffness"] = k.with_(k.value - half, k.value + half)
    again = replace(chosen.structure, threshold=False)
    one, other = (
        _stiffness(Problem(half_of, noise), again, fold[direction].values)
        for half_of, fold in zip((halves[0], halves[1]), folds, strict=True)
    )
    return Cascade(
        chosen,
        noise,
        numbers,
        structures,
        weighed,
        direction,
        its_share,
        first.unseen,
        (one, other),
        parts,
        _trend(problem, chosen),
        scattered,
        misfit,
    )


@dataclass(frozen=True, slots=True)
class _First:
    """What the torque says with noise that needs no equations."""

    base: Structure  #: With tissue that relaxes only where that is clearly better.
    direction: int  #: In which a reflex describes the torque better.
    fitted: Fitted  #: The base with a reflex in that direction.
    values: Mapping[int, Mapping[str, float]]  #: Of the base in each direction, 0 without reflex.
    unseen: tuple[float, float]  #: Greatest share [%] and gain that may be hidden.


def _first(free: Problem) -> _First:
    """Fit both tissues, without a reflex and in each direction."""
    fits: dict[tuple[Structure, int], Fitted] = {}
    grids = {}
    for structure in (PLAIN, RELAXING):
        fits[structure, 0] = free.fit(structure, {})
        for d in (1, -1):
            grids[d] = shapes(free, fits[structure, 0], d)
            start = {**fits[structure, 0].values, **first_shape(grids[d])}
            fits[structure, d] = free.fit(replace(structure, direction=d), start)

    def loss(structure: Structure) -> float:
        return min(fits[structure, d].loss for d in (0, 1, -1))

    base = RELAXING if loss(PLAIN) - loss(RELAXING) > BETTER else PLAIN
    direction = min((1, -1), key=lambda d: fits[base, d].loss)
    share_, gain = (max(pair) for pair in zip(*(bound(of) for of in grids.values()), strict=True))
    values = {d: fits[base, d].values for d in (0, 1, -1)}
    return _First(base, direction, fits[base, direction], values, (share_, gain))


def _with_threshold(problem: Problem, base: Structure, direction: int, start: Fitted) -> Fitted:
    """The best reflex that answers beyond a velocity."""
    asked = replace(base, direction=direction, threshold=True)
    tried = [problem.fit(asked, {**start.values, "threshold": v}) for v in SEARCHED]
    return min(tried, key=lambda fitted: fitted.loss)


def _numbers(judged: Judged, pieces: Sequence[Piece], present: bool) -> dict[str, Number]:
    """Measures of the chosen structure, with what channels may do in their intervals."""
    numbers = {name: judged.number(name, of) for name, of in INTRINSIC.items()}
    if present:
        numbers |= {name: judged.number(name, of) for name, of in REFLEX.items()}
        numbers["reflex_share"] = judged.number("reflex_share", lambda f: share(pieces, f))
    return {name: each.allowing(CHANNELS.get(name, 0.0)) for name, each in numbers.items()}


def _misfit(free: Problem, chosen: Fitted, first: _First) -> float:
    """The z of what responses without equations explain beyond the equations."""
    rate = free.pieces[0].rate
    rows = free.whitened(
        [np.concatenate([lagged(p, first.direction, rate), p.squared[None]]) for p in free.pieces]
    )
    left = free.y - solved(rows, free.y) @ rows
    extra = len(rows) - len(first.fitted.structure.names)
    check = free.fit(chosen.structure, chosen.values)
    return float((check.loss - float(left @ left) - extra) / np.sqrt(2.0 * extra))


def _trend(problem: Problem, chosen: Fitted) -> float:
    """The z of a stiffness that changes in proportion to time."""
    trend = Judged(problem, problem.fit(replace(chosen.structure, trend=True), chosen.values))
    drift = trend.number("", parameter("trend"))
    return float(drift.value / max((drift.high - drift.value) / trend.quantile, 1e-12))


def _scattered(parts: FloatArray) -> bool:
    """Whether the stiffness of parts differs by more than chance."""
    mean = np.average(parts[:, 1], weights=parts[:, 2] ** -2.0)
    scatter = float(np.sum(((parts[:, 1] - mean) / parts[:, 2]) ** 2))
    freedom = len(parts) - 1
    return bool(freedom > 1 and scatter > freedom + CHANGING * np.sqrt(2.0 * freedom))


def _stiffness(problem: Problem, structure: Structure, start: Mapping[str, float]) -> Number:
    """The stiffness of a part of the recording."""
    again = problem.fit(structure, {**start})
    return Judged(problem, again).number("", INTRINSIC["intrinsic_stiffness"])


def _filtered(problem: Problem, plain: Fitted) -> Fitted:
    """The fit, or, where it is clearly better, that with a filter of the torque's channel."""
    tried = [problem.fit(replace(plain.structure, order=k), plain.values) for k in (1, 2)]
    best = min(tried, key=lambda fitted: fitted.loss)
    clear = plain.loss - best.loss > BETTER and "cutoff" not in best.at_bound
    return best if clear else plain


def _parts(problem: Problem, judged: Judged) -> FloatArray:
    """Stiffness of every ten seconds, everything but stiffness and viscosity held: one step."""
    fitted = judged.fitted
    names = judged.fitted.structure.names
    stretches = []
    e, j = problem.jacobian(fitted.structure, fitted.values)
    kept = [names.index(name) for name in ("stiffness", "viscosity")]
    half = len(e) // 2
    first = 0
    for piece in problem.pieces:
        rows_of = slice(first, first + len(piece.f))
        first = rows_of.stop
        left, rows = (
            piece.in_time(v[..., :half][..., rows_of] + 1j * v[..., half:][..., rows_of])
            for v in (e, j.T[kept])
        )
        length = round(PART * piece.rate)
        for i in range(max(len(left) // length, 1)):
            part = slice(i * length, (i + 1) * length)
            x = rows[:, part]
            y = left[part]
            inverse = np.linalg.pinv(x @ x.T)
            step = inverse @ (x @ y)
            blocks = x.shape[1] // round(piece.rate)
            scores = (x * (y - step @ x))[:, : blocks * round(piece.rate)]
            sums = scores.reshape(2, blocks, -1).sum(axis=2)
            variance = inverse @ (sums @ sums.T * blocks / max(blocks - 2, 1)) @ inverse
            sd = np.sqrt(max(variance[0, 0], inverse[0, 0]))
            middle = float(piece.times[part].mean())
            stretches.append((middle, fitted.values["stiffness"] + step[0], sd))
    return np.array(stretches)
