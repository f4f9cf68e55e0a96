"""One recording's cascade: structure, direction, and what the others say of every number."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.special import stdtrit

from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.nerve.cascade import Structure, relaxing, relaxing_slope
from surae.nerve.fitting import Fitted, Noise, Problem, noise_of, regressors, slopes, solved
from surae.nerve.piece import Piece
from surae.nerve.presence import Weighed, bound, first_shape, shapes, weigh
from surae.nerve.response import faster, free_noise, lagged

#: Sums of whitened squares by which a structure must be better to be taken in (z of 4 or 3), and
#: by which one that is worse is still possible (z of 2).
BETTER = 8.0
POSSIBLE = 4.5
#: The same, of a structure with more in it: what chance gains by two parameters.
CHANCE = 2.0
#: z of the gain of responses without equations, from which the equations miss something.
MISFIT = 5.0
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
#: Blocks from which their scatter is told.
LEAST_BLOCKS = 5
#: Length of the parts whose stiffness is compared [s].
PART = 10.0
#: Length that a reflex may answer beside velocity [1/s]: in sines of 0.3, 0.8 and 2 Hz both then
#: weigh alike.
LENGTHS = (2.0, 5.0, 12.0)
#: Thresholds at which a reflex is held [rad/s]: gain trades off with them, and not in a line.
BEYOND = (0.0, 0.1, 0.2, 0.35, 0.5)
#: Thresholds at which its search begins [rad/s].
SEARCHED = (0.03, 0.15, 0.4)
PLAIN = Structure(N_("inertia, viscosity, stiffness"))
RELAXING = Structure(N_("tissue that relaxes (Zener)"), 1)
TWO = Structure(N_("tissue that relaxes at two rates"), 2)


@dataclass(frozen=True, slots=True)
class Number:
    """An estimate and its 95 % interval."""

    value: float
    low: float
    high: float

    def allowing(self, part: float) -> "Number":
        """The same, with an error of so great a part of it in its interval."""
        low = np.hypot(self.value - self.low, part * self.value)
        high = np.hypot(self.high - self.value, part * self.value)
        return replace(self, low=float(self.value - low), high=float(self.value + high))

    def with_(self, low: float, high: float) -> "Number":
        """The same value, with what another says in its interval."""
        return replace(self, low=min(self.low, low), high=max(self.high, high))


#: How another structure counts in an interval; see `_spread`.
Counts = Literal["whole", "shifted", "value"]
#: What is computed of the parameters of a fit: value, and its derivative by each parameter.
Of = Callable[[Fitted], tuple[float, Mapping[str, float]]]


def _viscosity(fitted: Fitted) -> tuple[float, Mapping[str, float]]:
    """Slope of the torque over the velocity when slow [Nm·s/rad]: B + Σ Kᵢτᵢ."""
    v = fitted.values
    value = fitted.values["viscosity"]
    by = {"viscosity": 1.0}
    for i in range(1, fitted.structure.branches + 1):
        value += v[f"branch_{i}"] * v[f"time_{i}"]
        by |= {f"branch_{i}": v[f"time_{i}"], f"time_{i}": v[f"branch_{i}"]}
    return value, by


def _own(name: str, factor: float = 1.0) -> Of:
    return lambda fitted: (factor * fitted.values[name], {name: factor})


INTRINSIC: dict[str, Of] = {
    "intrinsic_stiffness": _own("stiffness"),
    "intrinsic_viscosity": _viscosity,
    "inertia": _own("inertia"),
}
REFLEX: dict[str, Of] = {
    "reflex_gain": _own("gain"),
    "reflex_delay": _own("delay", 1e3),
    "reflex_frequency": _own("omega", 0.5 / np.pi),
    "reflex_damping": _own("zeta"),
    "reflex_threshold": _own("threshold", 180.0 / np.pi),
}
#: Of which the logarithm is estimated as if it were normal.
_RATIOS = ("reflex_gain", "reflex_frequency", "reflex_damping", "reflex_share")


def share(pieces: Sequence[Piece], fitted: Fitted) -> tuple[float, Mapping[str, float]]:
    """Variance of the reflex's torque in that of the torque [%], and its derivatives."""
    structure = fitted.structure
    v = fitted.values
    reflex = {"delay", "omega", "zeta", "threshold"} & set(structure.nonlinear)
    total = 0.0
    squares = 0.0
    by = dict.fromkeys(reflex, 0.0)
    for piece in pieces:
        x = regressors(piece, structure, v)
        own = faster(piece, v["gain"] * x[-1])
        total += piece.variance * len(own)
        squares += float(np.sum(own**2))
        for name, row in zip(structure.nonlinear, slopes(piece, structure, v, x), strict=True):
            if name in by:
                by[name] += 2.0 * float(own @ faster(piece, row))
    by["gain"] = 2.0 * squares / max(v["gain"], 1e-12)
    return 100.0 * squares / total, {name: 100.0 * each / total for name, each in by.items()}


class Judged:
    """A fit with its covariance: numbers with intervals."""

    def __init__(self, problem: Problem, fitted: Fitted, floor: float = 0.0) -> None:
        self.fitted = fitted
        self.covariance, self.freedom, self.pulls = problem.covariance(fitted)
        self.quantile = float(stdtrit(self.freedom, 0.975))
        self.biases = _biases(problem, fitted, floor) if floor else None

    def number(self, name: str, of: Of) -> Number:
        """The number that `of` computes, with its interval."""
        value, by = of(self.fitted)
        gradient = np.array([by.get(each, 0.0) for each in self.fitted.structure.names])
        half = self.quantile * float(np.sqrt(gradient @ self.covariance @ gradient))
        for pull in self.pulls:
            if (m := len(pull)) > LEAST_BLOCKS:
                scatter = float(np.sum((pull @ gradient) ** 2)) * m / (m - 1)
                half = max(half, float(stdtrit(m - 1, 0.975) * np.sqrt(scatter)))
        if self.biases is not None:
            noise, jumps = np.abs(self.biases @ gradient)
            half = float(np.hypot(half, noise) + jumps)
        if name in _RATIOS and value > 0.0:
            factor = float(np.exp(min(half / value, 20.0)))
            return Number(value, value / factor, value * factor)
        return Number(value, value - half, value + half)


def _biases(problem: Problem, fitted: Fitted, floor: float) -> FloatArray:
    """How far noise of the position and unknown times of jumps may move each parameter, (2, k).

    The noise has the power floor/f² [rad²/Hz]. Jumps of the torque may all be seen half a sample
    late, or early: movement and sampling often have one clock.
    """
    _, j = problem.jacobian(fitted.structure, fitted.values)
    names = fitted.structure.names
    pull = np.zeros((2, j.shape[1]))
    v = fitted.values
    for piece, w in zip(problem.pieces, problem.weights, strict=True):
        s = 2j * np.pi * np.asarray(piece.f, np.complex128)
        power = floor / np.maximum(piece.f, 0.3) ** 2 * np.abs(s) ** 2 * w**2 * 0.5
        by = {"stiffness": 1.0 + 0.0 * s, "viscosity": s, "inertia": s**2}
        for i in range(1, fitted.structure.branches + 1):
            by[f"branch_{i}"] = relaxing(s, v[f"time_{i}"])
        whole = sum(v[name] * row for name, row in by.items())
        for i in range(1, fitted.structure.branches + 1):
            by[f"time_{i}"] = v[f"branch_{i}"] * relaxing_slope(s, v[f"time_{i}"])
        for name, row in by.items():
            pull[0, names.index(name)] += float(np.sum(np.real(np.conj(row) * whole) * power))
    pull[1] = problem.whitened([piece.jumps for piece in problem.pieces]) @ j
    size = np.sqrt(np.sum(j**2, axis=0)) + 1e-100
    inverse = np.linalg.pinv((j / size).T @ (j / size), rcond=1e-12) / np.outer(size, size)
    return np.asarray(pull @ inverse)


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


def identify(
    pieces: Sequence[Piece],
    halves: Sequence[Sequence[Piece]],
    floor: float,
    judge: Callable[[int, Weighed, Number, Fitted, tuple[float, float]], bool],
) -> Cascade:
    """Estimate everything; `judge` says whether a reflex is present."""
    free = Problem(pieces, free_noise(pieces))
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
    unseen = tuple(max(pair) for pair in zip(*(bound(of) for of in grids.values()), strict=True))
    rows = free.whitened(
        [np.concatenate([lagged(p, direction, pieces[0].rate), p.squared[None]]) for p in pieces]
    )
    left = free.y - solved(rows, free.y) @ rows
    extra = len(rows) - len(fits[base, direction].structure.names)

    noise = noise_of(pieces, [fits[base, direction].residual(p) for p in pieces])
    problem = Problem(pieces, noise)
    starts = {d: problem.fit(replace(base, direction=d), fits[base, d].values) for d in (0, 1, -1)}
    weighed, folds = weigh(halves, problem, base, {d: f.values for d, f in starts.items()})
    asked = replace(base, direction=direction, threshold=True)
    tried = [problem.fit(asked, {**starts[direction].values, "threshold": v}) for v in SEARCHED]
    full = min(tried, key=lambda fitted: fitted.loss)
    reflex = Judged(problem, full)
    its_share = reflex.number("reflex_share", lambda f: share(pieces, f))
    present = judge(direction, weighed[direction], its_share, full, unseen)

    chosen = full if present else starts[0]
    noise = noise_of(pieces, [chosen.residual(p) for p in pieces])
    problem = Problem(pieces, noise)
    chosen = _filtered(problem, problem.fit(chosen.structure, chosen.values))
    judged = Judged(problem, chosen, floor)
    numbers = {name: judged.number(name, of) for name, of in INTRINSIC.items()}
    if present:
        numbers |= {name: judged.number(name, of) for name, of in REFLEX.items()}
        numbers["reflex_share"] = judged.number("reflex_share", lambda f: share(pieces, f))
    numbers = {name: each.allowing(CHANNELS.get(name, 0.0)) for name, each in numbers.items()}
    check = free.fit(chosen.structure, chosen.values)
    misfit = (check.loss - float(left @ left) - extra) / np.sqrt(2.0 * extra)
    numbers, structures = _spread(problem, chosen, numbers, starts[direction], misfit)
    if present:
        beyond = numbers["reflex_threshold"]
        numbers["reflex_threshold"] = replace(beyond, low=max(beyond.low, 0.0))

    trend = Judged(problem, problem.fit(replace(chosen.structure, trend=True), chosen.values))
    drift = trend.number("", _own("trend"))
    z = drift.value / max((drift.high - drift.value) / trend.quantile, 1e-12)
    parts = _parts(problem, judged)
    scatter = float(
        np.sum(
            ((parts[:, 1] - np.average(parts[:, 1], weights=parts[:, 2] ** -2.0)) / parts[:, 2])
            ** 2
        )
    )
    freedom = len(parts) - 1
    scattered = freedom > 1 and scatter > freedom + CHANGING * np.sqrt(2.0 * freedom)
    if scattered:
        half = float(stdtrit(freedom, 0.975) * parts[:, 1].std(ddof=1) / np.sqrt(len(parts)))
        k = numbers["intrinsic_stiffness"]
        numbers["intrinsic_stiffness"] = k.with_(k.value - half, k.value + half)
    in_halves = []
    for own, fold in zip((halves[0], halves[1]), folds, strict=True):
        mine = Problem(own, noise)
        again = mine.fit(replace(chosen.structure, threshold=False), {**fold[direction].values})
        in_halves.append(Judged(mine, again).number("", INTRINSIC["intrinsic_stiffness"]))
    return Cascade(
        chosen,
        noise,
        numbers,
        structures,
        weighed,
        direction,
        its_share,
        unseen,
        (in_halves[0], in_halves[1]),
        parts,
        float(z),
        bool(scattered),
        float(misfit),
    )


def _spread(
    problem: Problem, chosen: Fitted, numbers: Mapping[str, Number], rival: Fitted, misfit: float
) -> tuple[dict[str, Number], dict[str, Number]]:
    """Numbers with what other structures say in their intervals, and the stiffness of each.

    Simpler ones that describe the torque about as well count with their intervals, richer ones that
    describe it better than chance by their values with the interval of the chosen one: their own is
    endless where a branch is hardly seen. Where the equations are known to miss something, good
    description no longer tells which is true: then named ones count by their values alone.

    True equations give the same numbers however frequencies are weighed: by what they differ from
    those of equal weights, beyond chance, every number may be wrong to both sides (Hausman 1978).
    """
    widened = dict(numbers)
    said = {chosen.structure.name: numbers["intrinsic_stiffness"]}
    branches = chosen.structure.branches
    own = chosen.structure
    both = INTRINSIC | REFLEX | {"reflex_share": lambda f: share(problem.pieces, f)}

    def admit(fitted: Fitted, by: Problem, label: str, counts: Counts) -> None:
        judged = Judged(by, fitted)
        reflex = fitted.structure.direction and own.direction
        tables = both if reflex else INTRINSIC
        if reflex and not fitted.structure.threshold:
            tables = {name: of for name, of in both.items() if name != "reflex_threshold"}
            at = float(np.rad2deg(fitted.structure.beyond))
            widened["reflex_threshold"] = widened["reflex_threshold"].with_(at, at)
        # a slow branch that is hardly seen is viscosity of another frequency
        if fitted.structure.branches > 1 and chosen.loss - fitted.loss < BETTER:
            tables = {"intrinsic_stiffness": INTRINSIC["intrinsic_stiffness"]}
        for name, of in tables.items():
            other = judged.number(name, of)
            half = numbers[name].high - numbers[name].value
            low, high = {
                "whole": (other.low, other.high),
                "shifted": (other.value - half, other.value + half),
                "value": (other.value, other.value),
            }[counts]
            widened[name] = widened[name].with_(low, high)
            if name == "intrinsic_stiffness":
                said[label] = Number(other.value, low, high)

    others = [
        (replace(own, branches=b, name=n), n)
        for b, n in enumerate((PLAIN.name, RELAXING.name, TWO.name))
        if b != branches and b - branches < 2
    ]
    others.append((replace(own, late=False), N_("torque that is not late")))
    others += [
        (replace(own, order=order), filtered)
        for order, filtered in enumerate(
            (
                N_("a torque channel without a filter"),
                N_("a torque channel with one pole"),
                N_("a torque channel with two poles"),
            )
        )
        if order != own.order
    ]
    if own.direction:
        others.append((replace(own, third=True), N_("a reflex of third order")))
    for structure, label in others:
        fitted = problem.fit(structure, chosen.values)
        gain = chosen.loss - fitted.loss
        more = len(structure.names) - len(own.names)
        if more <= 0 and gain > -POSSIBLE:
            admit(fitted, problem, label, "whole")
        elif more > 0 and gain > CHANCE * more / 2:
            admit(fitted, problem, label, "shifted")
        elif misfit > MISFIT and structure.branches:
            admit(fitted, problem, label, "value")
    for beyond in BEYOND if own.direction else ():
        held = replace(own, threshold=False, beyond=beyond)
        fitted = problem.fit(held, chosen.values)
        if chosen.loss - fitted.loss > -POSSIBLE:
            admit(
                fitted,
                problem,
                Message(N_("a reflex beyond {speed:.0f} °/s"), speed=np.rad2deg(beyond)),
                "value",
            )
    for fitted, label in _other_laws(problem, chosen) if own.direction else ():
        if chosen.loss - fitted.loss > -POSSIBLE:
            admit(fitted, problem, label, "shifted")
        elif misfit > MISFIT:
            admit(fitted, problem, label, "value")
    if not own.direction:
        again = problem.fit(rival.structure, rival.values)
        if chosen.loss - again.loss > CHANCE and again.values["gain"] > 0.0:
            admit(again, problem, N_("with a reflex that is not shown"), "whole")
    alike = Problem(problem.pieces, Noise(problem.noise.f, problem.noise.f**2))
    again = alike.fit(own, chosen.values)
    if misfit > MISFIT:
        admit(again, alike, N_("all frequencies weighed alike"), "value")
    judged = Judged(alike, again)
    for name, number in numbers.items():
        other = judged.number(name, both[name])
        apart = abs(other.value - number.value)
        chance = 0.5 * (other.high - other.low)
        beyond = float(np.sqrt(max(apart**2 - chance**2, 0.0)))
        widened[name] = widened[name].allowing(beyond / max(abs(number.value), 1e-12))
    return widened, said


def _filtered(problem: Problem, plain: Fitted) -> Fitted:
    """The fit, or, where it is clearly better, that with a filter of the torque's channel."""
    tried = [problem.fit(replace(plain.structure, order=k), plain.values) for k in (1, 2)]
    best = min(tried, key=lambda fitted: fitted.loss)
    clear = plain.loss - best.loss > BETTER and "cutoff" not in best.at_bound
    return best if clear else plain


def _other_laws(problem: Problem, chosen: Fitted) -> list[tuple[Fitted, str]]:
    """The same with a reflex to velocity and length, and with one to force."""
    own = chosen.structure
    v = chosen.values
    lengths = [problem.fit(replace(own, length=each), v) for each in LENGTHS]
    lead = v["viscosity"] / max(v["stiffness"], 1e-9)
    return [
        (min(lengths, key=lambda fitted: fitted.loss), N_("a reflex to velocity and length")),
        (problem.fit(replace(own, lead=max(lead, 0.0)), v), N_("a reflex to force")),
    ]


def _parts(problem: Problem, judged: Judged) -> FloatArray:
    """Stiffness of every ten seconds, everything but stiffness and viscosity held: one step."""
    fitted = judged.fitted
    names = judged.fitted.structure.names
    found = []
    e, j = problem.jacobian(fitted.structure, fitted.values)
    kept = [names.index(name) for name in ("stiffness", "viscosity")]
    half = len(e) // 2
    first = 0
    for piece in problem.pieces:
        own = slice(first, first + len(piece.f))
        first = own.stop
        left, rows = (
            piece.in_time(v[..., :half][..., own] + 1j * v[..., half:][..., own])
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
            found.append((middle, fitted.values["stiffness"] + step[0], sd))
    return np.array(found)
