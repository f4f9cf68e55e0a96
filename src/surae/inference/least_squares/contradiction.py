"""Whether the data contradict a model that was named: the family's imperfections, one step away.

A fit of a named model leaves out a torque zero, a delay, crosstalk, or of tendons. Its
residual does: at its solution the posterior of the same leg with these, under their priors, is a
quadratic. Its evidence says whether the data ask for them, and its mode where the parameters would
go (a score test with a one-step estimate). Samples count for as little as the residual's slow part
says, since what a model leaves out is slow. What filters did to a fast movement is no part of a leg
either, and is let free in both.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.units import FloatArray
from surae.inference.coordinates import is_straight
from surae.inference.evidence import LaplaceApproximation, subsets
from surae.inference.noise import NoiseModel, noise_behind, whitened
from surae.inference.posterior.linearised import measured
from surae.inference.problem import FitProblem
from surae.inference.result import FitResult, LeastSquares, is_at_bound
from surae.model import get_model, with_optional
from surae.model.laboratory import COMPLIANT, RIGID, group_of, laboratory
from surae.model.source import Gaussian
from surae.signals import ModelInputs
from surae.signals.prepare import sharpened, smoothed

#: Groups of nuisances that a named model is held against.
_HELD_AGAINST = ("zero", "delay", "crosstalk")
#: What is known of the tendons, as they are searched.
_STRAINS = {"dlt_tri": Gaussian(np.log(0.025), 1.0), "dlt_tib": Gaussian(np.log(0.010), 1.0)}
#: Not on a logarithm either: none is no contradiction.
_TOES = ("pt_tri", "pt_tib")
#: Standard deviation of what has no prior: of the logarithm, or in parts of its bounds' distance.
_VAGUE = 3.0
#: Largest order of the noise's autoregression, and what is slow of it [Hz].
_ORDER = 30
_SLOW = 2.0
#: Gain of −2 ln Z from which an alternative is supported: odds of 150 to 1 ("very strong", Kass and
#: Raftery 1995). Legs of the model itself have −60 to −7, richer ones 3 to 290.
_SUPPORTED = 10.0
#: How much of what filtering once more does, and of what it does less than that when done again,
#: has been done already.
_BLUR = (Gaussian(1.0, 1.0), Gaussian(1.0, 1.0))


@dataclass(frozen=True, slots=True)
class Contradiction:
    """What a named model leaves out although the data ask for it."""

    #: What the better model has and the named one has not, all or some of it: groups of nuisances,
    #: ``"tendons"``.
    missing: tuple[str, ...]
    gain: float  #: By how much its −2 ln Z is less.
    shift: Mapping[str, float]  #: By how much it moves each estimate, in the parameter's unit.


def contradiction(result: FitResult) -> Contradiction | None:
    """What contradicts a fit of a named model; None where nothing does, or that is unknown.

    A fit of a family has been held against the rest of it already.
    """
    problem = result.problem
    named = isinstance(result.solution, LeastSquares) and problem.settings.loss is None
    if not named or result.status == "failed":
        return None
    try:
        richer = _richer(result)
    except ValueError:  # a parameter of a plugin's model that the family has not
        return None
    sharp = replace(problem, inputs=richer.problem.inputs)
    with np.errstate(all="ignore"):  # a damaged file may hold anything; it is found out below
        gain, better, target = _weighed(sharp, result.values, richer)
    if not (gain > _SUPPORTED and np.isfinite(better).all()):
        return None
    free = richer.problem.free
    away = (better[: len(free)] - target.z) * target.scale
    shift = {n: float(d) for n, d in zip(free, away, strict=True) if n in problem.free}
    missing = [g for g in _HELD_AGAINST if any(group_of(n) == g for n in richer.nuisances)]
    if richer.problem.spec.name != problem.spec.name:
        missing.append("tendons")
    return Contradiction(tuple(missing), gain, FrozenDict(shift))


@dataclass(frozen=True, slots=True)
class _Richer:
    """The model that a named one is held against, at the named one's solution."""

    problem: FitProblem  #: Of recordings that are as sharp as before their filters.
    values: Mapping[str, float]  #: Of all parameters; those that are added do next to nothing.
    nuisances: Mapping[str, Gaussian]  #: What is added of the laboratory, and its priors.
    tendons: Mapping[str, Gaussian]  #: Priors of the tendons' strains.
    added: tuple[int, ...]  #: Which of the free parameters are added.


def _richer(result: FitResult) -> _Richer:
    """A compliant model with what the laboratory cannot rule out, but for what is known or free."""
    problem = result.problem
    anatomy = problem.options.anatomy
    known = {n for trial in problem.inputs for n in trial.fixed} | problem.settings.mentioned
    nuisances = {
        n: belief
        for n, belief in laboratory(joint=anatomy).items()
        if group_of(n) in _HELD_AGAINST and n not in problem.free and n not in known
    }
    compliant = COMPLIANT if problem.spec.name == RIGID else problem.spec.name
    spec = with_optional(get_model(compliant), [*nuisances, *problem.spec.optional])
    table = problem.table_of(spec, problem.options)
    values = {n: result.values.get(n, belief.off) for n, belief in nuisances.items()}
    values |= {n: value for n, value in result.values.items() if n in spec.names}
    free = tuple(
        n for n in spec.names if n in problem.free or n in nuisances or n not in result.values
    )
    tendons = {n: b for n, b in _STRAINS.items() if n in spec.names and n not in known}
    for strain in tendons.keys() & anatomy.parameters.keys():
        tendons[strain] = replace(tendons[strain], mean=float(np.log(table[strain].start)))
    for strain in tendons.keys() - result.values.keys():  # none so far: as stiff as the model goes
        stiff = table[strain].lower
        values[strain] = stiff
        sd = float(np.exp(tendons[strain].mean)) / stiff
        tendons[strain] = Gaussian(float(np.log(stiff)), sd)
    inputs = tuple(sharpened(trial) for trial in problem.inputs)
    richer = replace(problem, inputs=inputs).of_model(spec, free, values, problem.limits)
    added = tuple(j for j, n in enumerate(free) if n in nuisances or n not in result.values)
    return _Richer(richer, values, nuisances, tendons, added)


def _weighed(
    problem: FitProblem, values: Mapping[str, float], richer: _Richer
) -> tuple[float, FloatArray, "_Linear"]:
    """Gain of evidence by what is added, where the searched coordinates would go, and the model.

    The gain is not a number where that cannot be computed.
    """
    target = _Linear(richer.problem, richer.values, {**richer.nuisances, **richer.tendons})
    off = {j: float(target.z[j]) for j in richer.added}
    several = len(problem.inputs) > 1 and "torque_zero" in richer.nuisances
    zeros = [richer.nuisances["torque_zero"]] * len(problem.inputs) if several else []
    first = len(target.z)
    off |= dict.fromkeys(range(first, first + len(zeros)), 0.0)
    try:
        noise = _Linear(problem, values, {}).noise()
        laplace = _quadratic(target, noise, zeros)
        sets = {s.groups: s for s in subsets(laplace, {"all": [*off]}, off)}
    except np.linalg.LinAlgError:  # the model overflows
        return np.nan, target.z, target
    better = sets["all",]
    return sets[()].evidence - better.evidence, better.mode, target


class _Linear:
    """A model at a point: its rows of derivatives and residual, and its priors, as searched.

    What is positive by nature is on a logarithm; a nuisance, which may be none, as it is.
    """

    def __init__(
        self, problem: FitProblem, values: Mapping[str, float], priors: Mapping[str, Gaussian]
    ) -> None:
        self.problem = problem
        named = problem.by_name(problem.start)
        self.values = np.array([values.get(n, start) for n, start in named.items()])
        start = self.values[problem.columns]
        log = np.array([n in _STRAINS or not (n in _TOES or is_straight(n)) for n in problem.free])
        self.scale = np.where(log, start, 1.0)
        self.z = np.where(log, np.log(np.maximum(start, 1e-300)), start)
        vague = np.where(log, _VAGUE, _VAGUE * (problem.upper - problem.lower))
        given = [
            priors.get(n, Gaussian(float(z), float(sd)))
            for n, z, sd in zip(problem.free, self.z, vague, strict=True)
        ]
        self.mean = np.array([belief.mean for belief in given])
        self.weight = np.array([1.0 / belief.sd for belief in given])
        for j, (x, low, high) in enumerate(zip(start, problem.lower, problem.upper, strict=True)):
            if group_of(problem.free[j]) is None and is_at_bound(float(x), low, high):
                width = np.log(high / max(low, 1e-2 * x)) if log[j] else high - low
                self.weight[j] = max(self.weight[j], np.sqrt(12.0) / width)

    def rows(self, recording: ModelInputs) -> FloatArray:
        """Derivatives by the searched coordinates and, last, the torque [Nm], shape (q + 1, n)."""
        problem = self.problem
        simulator = problem.spec.simulator(recording, problem.options)
        torque, jacobian = simulator.torque_jacobian(self.values, problem.columns)
        return np.concatenate([jacobian * self.scale[:, None], torque[None]])

    def torque(self, recording: ModelInputs) -> FloatArray:
        """The model's torque [Nm] of a recording."""
        problem = self.problem
        return problem.spec.simulator(recording, problem.options).torque(self.values)

    def noise(self) -> list[tuple[FloatArray, NoiseModel]]:
        """Residual of each recording, and noise as strong as its slow part."""
        blocks = []
        for recording in self.problem.inputs:
            rows = self.rows(recording)
            rows[-1] -= measured(recording)
            counted = recording.counts
            root = 1.0 if recording.weight is None else np.sqrt(recording.weight)
            blocks.append((rows[-1], (rows * root)[:, counted], recording))
        total = sum(rows.shape[1] for _, rows, _ in blocks)
        lost = total / max(total - len(self.z), 1)
        sd = [max(float(np.mean(rows[-1] ** 2)) * lost, 1e-30) for _, rows, _ in blocks]
        information = np.diag(self.weight**2)
        for (_, rows, _), variance in zip(blocks, sd, strict=True):
            information = information + rows[:-1] @ rows[:-1].T / variance
        if not np.isfinite(information).all():
            raise np.linalg.LinAlgError
        scale = 1.0 / np.sqrt(np.diag(information))
        values, vectors = np.linalg.eigh(information * scale * scale[:, None])
        known = values > len(values) * np.finfo(float).eps * values[-1]
        back = (vectors[:, known] / np.sqrt(values[known])).T * scale
        models = []
        for (e, rows, recording), variance in zip(blocks, sd, strict=True):
            taken = back @ rows[:-1] / np.sqrt(variance)
            behind = noise_behind(rows[-1], taken, min(_ORDER, rows.shape[1] // 10))
            models.append((e, behind.slow(_SLOW / recording.rate_hz)))
        return models


def _quadratic(
    target: _Linear, residuals: list[tuple[FloatArray, NoiseModel]], zeros: list[Gaussian]
) -> LaplaceApproximation:
    """What data say around the named model: its own residual, and what the richer one can do."""
    # the richer one's residual is another there: its stiffest tendons are none that are rigid
    more = [*zeros, *_BLUR]
    q = len(target.z) + len(more)
    information = np.zeros((q, q))
    gradient = np.zeros(q)
    cost = 0.0
    for number, (recording, (e, noise)) in enumerate(
        zip(target.problem.inputs, residuals, strict=True)
    ):
        rows = target.rows(recording)
        again = smoothed(recording)
        blurred = _blurred(target, recording, rows[-1])
        twice = _blurred(target, again, target.torque(again))
        lifts = [np.full(recording.n, float(number == i)) for i in range(len(zeros))]
        block = np.stack([*rows[:-1], *lifts, -blurred, twice - blurred, e])
        if recording.weight is not None:
            block *= np.sqrt(recording.weight)
        block = whitened(block, noise)
        information += block[:-1] @ block[:-1].T
        gradient += block[:-1] @ block[-1]
        cost += float(block[-1] @ block[-1])
    z = np.append(target.z, np.zeros(len(more)))
    mean = np.append(target.mean, [belief.mean for belief in more])
    weight = np.append(target.weight, [1.0 / belief.sd for belief in more])
    return LaplaceApproximation(information, gradient, cost, z, mean, weight)


def _blurred(target: _Linear, recording: ModelInputs, torque: FloatArray) -> FloatArray:
    """What filtering changes of the torque that it does not change of the model's [Nm].

    A fast movement's torque is not the one at what filters leave of the movement, though that was
    sharpened. Filtering once more shows by how much; filtering twice more, how that grows.
    """
    again = sharpened(smoothed(replace(recording, torque=torque)))
    error: FloatArray = target.torque(again) - measured(again)
    return error if np.isfinite(error).all() else np.zeros(recording.n)
