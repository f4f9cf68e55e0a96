"""What a fit found, as plain data: no optimiser, no function, nothing that refers back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from surae.base.file_form import filed
from surae.base.frozen import Comparable, FrozenDict
from surae.base.records import OrInfinite
from surae.base.units import FloatArray
from surae.inference.noise import NoiseModel
from surae.inference.problem import FitProblem
from surae.model.source import Gaussian

#: Stretches of tendons.
TENDONS = ("dlt_tri", "dlt_tib")
#: Percentile of active state and force that counts as the largest of the recordings.
LARGEST = 99.0


@dataclass(frozen=True, slots=True, eq=False)
class Start(Comparable):
    """One start of a multi-start fit and where it ended."""

    #: `initial`, `values`: free parameters at the start and at the end.
    initial: Mapping[str, float]
    values: Mapping[str, float]
    #: Sum of squared residuals at the end, weighted and with priors [Nm²]; of `auto`, of thinned
    #: recordings and the parameters alone.
    sse: OrInfinite
    outcome: str  #: Why the iteration ended.
    iterations: int  #: Evaluations of the model and its Jacobian.


@dataclass(frozen=True, slots=True)
class Stage:
    """One stage of a search."""

    name: str  #: The model and the rate, or which part of the search of `auto`.
    evaluations: int  #: Of the model and its derivatives, over all recordings.
    #: −2 ln p where it ended, but for a constant; of least squares the least sum [Nm²].
    cost: OrInfinite
    capped: int = 0  #: Descents that ended at a cap; the next one went on from there.


@filed(scale="scale_Nm", share="share_below_half")
@dataclass(frozen=True, slots=True, eq=False)
class Outliers(Comparable):
    """How a fit let outliers count less."""

    loss: str  #: Name of the loss.
    tuning: float  #: Where it leaves the square, in standard deviations.
    #: Standard deviation σ of the noise, from the median of the absolute residual [Nm].
    scale: float
    #: What the loss lets each sample of each recording count at the solution, in (0, 1].
    weights: tuple[FloatArray, ...]
    #: By how much JᵀWJ overstates the curvature of the loss: the mean of the weights ψ(u)/u over
    #: the mean of ψ′. Standard errors made with JᵀWJ are too small by it.
    widening: float
    rounds: int  #: Rounds until the weights rested.

    @property
    def share(self) -> float:
        """Part of the samples that count less than half."""
        count = sum(int((w < 0.5).sum()) for w in self.weights)
        return count / sum(len(w) for w in self.weights)


@filed(groups="nuisances")
@dataclass(frozen=True, slots=True)
class Candidate:
    """A model of the family that was fitted."""

    model: str  #: Name of the model.
    groups: tuple[str, ...]  #: Groups of nuisances that are in it.
    evidence: float  #: −2 ln Z, but for a constant that all share.
    weight: float  #: Probability that the data give it among all, alike beforehand.
    values: Mapping[str, float]  #: All its parameters.


@dataclass(frozen=True, slots=True)
class OfRecording:
    """What one recording of a joint fit says by itself of the leg's free parameters.

    What no trial of a session has for itself, such as crosstalk, is as the joint fit has it.
    """

    values: Mapping[str, float]  #: By parameter, in its unit.
    sem: Mapping[str, float]  #: Their standard errors: noise, and what each trial has anew.


@dataclass(frozen=True, slots=True, eq=False)
class _Solution(Comparable):
    """How a minimum was found."""

    starts: tuple[Start, ...]  #: Every start, the default one first.
    agreeing: int  #: Number of starts that ended at the best minimum.
    stages: tuple[Stage, ...]  #: Parts of the search; empty in files of before.
    outcome: str  #: Why the search ended.

    @property
    def evaluations(self) -> int:
        """Evaluations of the model and its derivatives, over all recordings."""
        return sum(stage.evaluations for stage in self.stages)

    @property
    def is_interrupted(self) -> bool:
        """Whether the user stopped it."""
        return self.outcome == "interrupted"


@dataclass(frozen=True, slots=True, eq=False)
class LeastSquares(_Solution):
    """A named model's least squares: of the laboratory nothing is asked and nothing said."""

    outliers: Outliers | None = None  #: How outliers were let count less; None where all count.
    #: What intervals and measures of both kinds are made with; what else a posterior has is in
    #: `FitResult.posterior`.
    beliefs: ClassVar[Mapping[str, Gaussian]] = FrozenDict()
    gained: ClassVar[tuple[float, ...]] = (1.0, 1.0)
    zero_wider: ClassVar[float] = 1.0
    turned: ClassVar[Mapping[str, float]] = FrozenDict()
    #: Parameters that may lie at their lower bound without being held by it.
    may_vanish: ClassVar[tuple[str, ...]] = ()

    @property
    def is_alone(self) -> bool:
        """Whether only one of several starts came to the best minimum."""
        return self.agreeing == 1 < len(self.starts)

    @property
    def one_start(self) -> str:
        """Why a lower minimum may not have been seen, a message's code; empty where it would."""
        if len(self.starts) == 1:
            return "note/no-other-start"
        return "note/one-start" if self.is_alone else ""


@dataclass(frozen=True, slots=True)
class Mounting:
    """How far the foot of one recording of a joint fit is turned against that of all others."""

    trial: str  #: Its name.
    turned: float  #: What the ankle's angle is beyond the device's, less that of the others [deg].
    sd: float  #: Its standard deviation, what a foot does between trials included [deg].
    #: How rarely the recordings differ so much where the foot stayed (χ², Cochran's Q).
    probability: float


@filed("starts", "agreeing", "stages", "outcome", beliefs="priors", covariance="covariance")
@dataclass(frozen=True, slots=True, eq=False)
class PosteriorMode(_Solution):
    """The mode of a family's posterior: how a model was chosen, and what that leaves unsure."""

    candidates: tuple[Candidate, ...]  #: Models that were fitted, the chosen one first.
    beliefs: Mapping[str, Gaussian]  #: Priors of the nuisances that are in the chosen model.
    noise: tuple[NoiseModel, ...]  #: Of each recording's torque.
    #: What each recording has for itself, by parameter: the torque's zero [Nm] and EMG at rest;
    #: empty where there is one recording.
    each: Mapping[str, tuple[float, ...]]
    #: What makes the estimates unsure, by source: rows of shifts of all free parameters together,
    #: in their units, whose outer products add up to the source's covariance, shape (r, p).
    spread: Mapping[str, FloatArray]
    #: Standard deviations of what differs from moment to moment, as they were learnt: of gains
    #: [-], the torque's drift [Nm], what no model has [-] and the drive's error [-].
    sizes: Mapping[str, float] = field(default_factory=FrozenDict)
    #: Priors of the leg's free parameters, on a logarithm where they are searched on one.
    population: Mapping[str, Gaussian] = field(default_factory=FrozenDict)
    #: Of each recording, in the order of the problem's; empty for a single one.
    recordings: tuple[OfRecording, ...] = ()
    films: tuple[NoiseModel, ...] = ()  #: Noise of the films, recording after recording.
    #: Groups of nuisances of which what was stated fits the torque badly, with the probability of a
    #: right statement to look so wrong.
    contradicted: Mapping[str, float] = field(default_factory=FrozenDict)
    #: The largest active state of each group by the gains that the torque tells, over that of the
    #: EMG as it is (`LARGEST`).
    gained: tuple[float, ...] = (1.0, 1.0)
    #: By how much wider the stated zero of the angle is taken, for the torque says another.
    zero_wider: float = 1.0
    #: How far each free parameter moves with the zero of the angle, which no torque tells [1/rad].
    turned: Mapping[str, float] = field(default_factory=FrozenDict)
    #: How much stiffer tissue was when each recording began, as a part of its torque, and its
    #: standard deviation; of the muscle group that tells it best.
    softening: tuple[tuple[float, float], ...] = ()
    #: Of each recording that is long enough; empty where fewer than two are, or no zero is unsure.
    mountings: tuple[Mounting, ...] = ()
    #: Values of the simplest member, fitted to the same recordings; empty in files of before.
    simplest: Mapping[str, float] = field(default_factory=FrozenDict)
    outliers: ClassVar[None] = None  #: Its noise is learnt, and no loss is asked for.
    is_alone: ClassVar[bool] = False  #: The search goes on from the best start's end.
    one_start: ClassVar[str] = ""  #: It looks for other valleys itself.
    #: A tendon that hardly stretches is a limit that a family reaches, and no end of its search.
    may_vanish: ClassVar[tuple[str, ...]] = TENDONS

    @property
    def covariance(self) -> FloatArray:
        """Of the problem's free parameters, everything included, shape (p, p)."""
        return np.asarray(sum(by.T @ by for by in self.spread.values()))


@filed("problem", "values", "residuals", "solution")
@dataclass(frozen=True, slots=True, eq=False)
class FitResult(Comparable):
    """The best minimum found."""

    problem: FitProblem  #: The question: model, options, recordings, free parameters, bounds.
    #: Whether a minimum was reached, and whether some parameter lies at its bound there; one of
    #: "converged", "at-bounds", "failed".
    status: str
    message: str  #: What happened, in one or two sentences, with advice where it failed.
    values: Mapping[str, float]  #: All parameters of the model, fixed ones included.
    residuals: tuple[FloatArray, ...]  #: Measured minus modelled torque of each recording [Nm].
    sse: OrInfinite  #: Weighted sum of squared residuals, without priors [Nm²].
    #: Triangular factor of the weighted Jacobian by the free parameters: RᵀR = JᵀWJ, of a named
    #: model with what priors add to it, shape (p, p).
    R: FloatArray
    solution: LeastSquares | PosteriorMode  #: How it was found, and what only its kind knows.
    seed: int  #: Seed of the random starts.
    seconds: float  #: Wall time.
    versions: Mapping[str, str]  #: Versions of surae and of what its numbers depend on.

    @property
    def posterior(self) -> PosteriorMode | None:
        """How the family's mode was found; None of a named model's least squares."""
        return self.solution if isinstance(self.solution, PosteriorMode) else None

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Free parameters that lie at a bound."""
        return at_bounds(self.problem, self.values, self.solution.may_vanish)

    @property
    def bounded(self) -> dict[str, float]:
        """Those at a bound have the standard deviation of a value anywhere between the bounds."""
        limits = self.problem.limits
        return {n: float((limits[n][1] - limits[n][0]) / np.sqrt(12.0)) for n in self.at_bound}


def at_bounds(
    problem: FitProblem, values: Mapping[str, float], may_vanish: Sequence[str] = ()
) -> tuple[str, ...]:
    """Free parameters that lie at a bound; a lower one does not hold those that may vanish."""
    return tuple(
        name
        for name, (low, high) in problem.limits.items()
        if is_at_bound(values[name], -np.inf if name in may_vanish else low, high)
    )


def is_at_bound(value: float, lower: float, upper: float) -> bool:
    """Whether a value lies at one of its bounds, to a millionth of their distance."""
    margin = 1e-6 * (upper - lower) if np.isfinite(lower) else 0.0
    return value <= lower + margin or value >= upper - margin
