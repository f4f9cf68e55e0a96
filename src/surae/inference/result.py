"""What a fit found, as plain data: no optimiser, no function, nothing that refers back."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from surae.base.filed import filed
from surae.base.frozen import Comparable, FrozenDict
from surae.base.records import OrInfinite
from surae.base.units import FloatArray
from surae.inference.noise import NoiseModel
from surae.inference.problem import FitProblem
from surae.model.sources import Gaussian

#: Stretches of tendons.
TENDONS = ("dlt_tri", "dlt_tib")


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

    name: str  #: What was searched, in words.
    evaluations: int  #: Of the model and its derivatives, over all recordings.
    cost: float  #: −2 ln p where it ended, but for a constant of the stage.


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


@filed(beliefs="priors")
@dataclass(frozen=True, slots=True, eq=False)
class Family(Comparable):
    """How a model was chosen among the family, and what that leaves unsure."""

    candidates: tuple[Candidate, ...]  #: Models that were fitted, the chosen one first.
    beliefs: Mapping[str, Gaussian]  #: Priors of the nuisances that are in the chosen model.
    noise: tuple[NoiseModel, ...]  #: Of each recording's torque.
    #: What each recording has for itself, by parameter: the torque's zero [Nm] and EMG at rest;
    #: empty where there is one recording.
    each: Mapping[str, tuple[float, ...]]
    covariance: FloatArray  #: Of the problem's free parameters, everything included, shape (p, p).
    #: What makes it, by source: rows of shifts of all of them together, in their units, whose outer
    #: products add up to the source's covariance, shape (r, p).
    spread: Mapping[str, FloatArray] = field(default_factory=FrozenDict)
    #: Standard deviations of what differs from moment to moment, as they were learnt: of gains
    #: [-], the torque's drift [Nm], what no model has [-] and the drive's error [-].
    sizes: Mapping[str, float] = field(default_factory=FrozenDict)
    #: Priors of the leg's free parameters, on a logarithm where they are searched on one.
    population: Mapping[str, Gaussian] = field(default_factory=FrozenDict)
    #: Of each recording, in the order of the problem's; empty for a single one.
    recordings: tuple[OfRecording, ...] = ()
    films: tuple[NoiseModel, ...] = ()  #: Noise of the films, recording after recording.
    stages: tuple[Stage, ...] = ()  #: How the mode was found; empty in files of before.
    #: Groups of nuisances of which what was stated contradicts the torque, with the probability of
    #: a right statement to look so wrong.
    contradicted: Mapping[str, float] = field(default_factory=FrozenDict)


@filed("problem", "values", "residuals")
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
    starts: tuple[Start, ...]  #: Every start, the default one first.
    agreeing: int  #: Number of starts that ended at the best minimum.
    seed: int  #: Seed of the random starts.
    seconds: float  #: Wall time.
    versions: Mapping[str, str]  #: Versions of surae and of what its numbers depend on.
    outliers: Outliers | None = None  #: How outliers were let count less; None for least squares.
    #: How the model was chosen, and what is not known of the laboratory; None for a named model.
    family: Family | None = None

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Free parameters that lie at a bound."""
        return at_bounds(self.problem, self.values, of_family=self.family is not None)

    @property
    def bounded(self) -> dict[str, float]:
        """Those at a bound have the standard deviation of a value anywhere between the bounds."""
        limits = self.problem.limits
        return {n: float((limits[n][1] - limits[n][0]) / np.sqrt(12.0)) for n in self.at_bound}


def at_bounds(
    problem: FitProblem, values: Mapping[str, float], *, of_family: bool
) -> tuple[str, ...]:
    """Free parameters that lie at a bound.

    A tendon that hardly stretches is a limit that a family reaches, and no end of its search.
    """
    return tuple(
        name
        for name, (low, high) in problem.limits.items()
        if is_at_bound(values[name], -np.inf if of_family and name in TENDONS else low, high)
    )


def is_at_bound(value: float, lower: float, upper: float) -> bool:
    """Whether a value lies at one of its bounds, to a millionth of their distance."""
    margin = 1e-6 * (upper - lower) if np.isfinite(lower) else 0.0
    return value <= lower + margin or value >= upper - margin
