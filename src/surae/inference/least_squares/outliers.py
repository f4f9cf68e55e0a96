"""Losses in which outliers count less, and fits weighted anew until the weights rest."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.base.formatting import check_known
from surae.base.frozen import read_only
from surae.base.progress import SearchProgress
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.estimators import STARTS
from surae.inference.interrupt import postponed_interrupt
from surae.inference.least_squares.fit import fit_problem
from surae.inference.least_squares.minimise import Ends, Outcome, minimise
from surae.inference.least_squares.residuals import Residuals
from surae.inference.least_squares.starts import Follow
from surae.inference.problem import FitProblem
from surae.inference.result import FitResult, LeastSquares, Outliers

#: Makes the median of the absolute residual an estimate of a Gaussian's standard deviation.
_MAD = 1.4826


@dataclass(frozen=True, slots=True)
class Loss:
    """A loss ρ of the standardised residual u = e/σ."""

    name: str  #: What it is called.
    #: Where it leaves the square, in standard deviations; chosen so that Gaussian noise costs 5 %
    #: of the efficiency of least squares.
    tuning: float
    #: ψ(u)/u with ψ = ρ′/2, from u/tuning: 1 at 0, less at an outlier.
    weight: Callable[[FloatArray], Any]
    slope: Callable[[FloatArray], Any]  #: ψ′(u), from u/tuning.


LOSSES: Mapping[str, Loss] = {
    loss.name: loss
    for loss in (
        # Huber 1964: a square that goes on as a straight line.
        Loss(
            "huber",
            1.345,
            lambda t: 1 / np.maximum(np.abs(t), 1.0),
            lambda t: 1.0 * (np.abs(t) < 1),
        ),
        # 2·(√(1 + t²) − 1), its smooth relative.
        Loss("soft-l1", 1.2871, lambda t: (1 + t * t) ** -0.5, lambda t: (1 + t * t) ** -1.5),
        # Beaton and Tukey 1974: an outlier far away counts nothing.
        Loss(
            "tukey",
            4.685,
            lambda t: np.maximum(1 - t * t, 0.0) ** 2,
            lambda t: np.where(np.abs(t) < 1, (1 - t * t) * (1 - 5 * t * t), 0.0),
        ),
    )
}


def spread(residual: FloatArray) -> float:
    """Standard deviation of Gaussian noise with this median of |e|: outliers hardly move it."""
    return _MAD * float(np.median(np.abs(residual)))


#: The weights rest when none has changed by more than this; so many rounds are tried.
_RESTS = 1e-3
_ROUNDS = 100
#: An outlier keeps this weight: it no longer matters to the estimates, and VAF still counts it.
_LEAST = 1e-6
#: The scale is at least this part of the torque's root mean square: data without noise have none.
_SMALLEST = 1e-9
#: A minimum that is better than where the weights came from asks for weights of its own; so often.
_PASSES = 3
#: The slope of ψ counts as at least this: with less, most of the data are outliers.
_SLOPE = 0.1


def fit_robust(
    problem: FitProblem,
    loss: str = "huber",
    *,
    starts: int = STARTS,
    seed: int = 0,
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
) -> FitResult:
    """Fit with a loss that grows less than the square of the residual.

    The minimum of Σ σ²ρ(e/σ) is found by iteratively reweighted least squares: weights
    w = ψ(u)/u of the residual u = e/σ, a least-squares step with them, and again until they rest;
    σ is 1.4826 times the median of |e| over all samples that count. Tukey's loss, which has
    several minima, starts from Huber's solution and keeps its σ. All starts are then tried with
    these weights, and should one find a better minimum, the weights are made anew from there.

    The problem of the result holds the weights at the solution, the loss's multiplied with its own;
    `Outliers` tells them apart. What is derived from it takes them as fixed. All else is as of
    `fit_problem`.

    Raises
    ------
    InputError
        The loss is not known.

    References
    ----------
    Huber and Ronchetti, Robust Statistics (2009), chapter 7; Holland and Welsch, Robust regression
    using iteratively reweighted least-squares, Commun. Stat. A6 (1977).
    """
    check_known("loss", LOSSES, loss)
    begin = time.perf_counter()
    first = fit_problem(problem, starts=1, seed=seed, follow=follow)
    if first.status == "failed":
        return first
    x = np.array([first.values[name] for name in problem.free])
    for _ in range(_PASSES):
        resting = _settled(problem, x, LOSSES[loss])
        if resting is None:
            return replace(
                first,
                status="failed",
                solution=replace(first.solution, outcome=str(Outcome.INTERRUPTED)),
                message=Message("ended/outliers-stopped"),
            )
        x, sse, outliers = resting
        inputs = tuple(
            replace(trial, weight=read_only(trial.weights * w))
            for trial, w in zip(problem.inputs, outliers.weights, strict=True)
        )
        weighted = replace(problem, inputs=inputs, base=problem.values(x))
        result = fit_problem(
            weighted,
            starts=starts,
            seed=seed,
            progress=progress,
            noise=outliers.scale,
            follow=follow,
        )
        if result.status == "failed" or result.sse >= sse * (1 - 1 / (problem.n - len(x))):
            break
        x = np.array([result.values[name] for name in problem.free])
    status = result.status
    message = result.message
    if outliers.rounds >= _ROUNDS:
        status = "failed"
        message = Message("ended/outliers-rounds", loss=loss, n=_ROUNDS)
    elif status != "failed" and result.sse > sse * (1 + 1 / (problem.n - len(x))):
        status = "failed"
        message = Message("ended/outliers-lost")
    seconds = time.perf_counter() - begin
    assert isinstance(result.solution, LeastSquares)
    solution = replace(result.solution, outliers=outliers)
    return replace(result, status=status, message=message, solution=solution, seconds=seconds)


@dataclass(frozen=True, slots=True)
class _Round:
    """One round: parameters, weighted sum of squares, and what they came from."""

    x: FloatArray
    sse: float
    errors: FloatArray  #: Of all samples, those of a precise one the greater, shape (n,).
    weights: FloatArray  #: What the loss lets them count, shape (n,).
    scale: float
    number: int


def _settled(
    problem: FitProblem, x: FloatArray, loss: Loss
) -> tuple[FloatArray, float, Outliers] | None:
    """Parameters, weighted sum and weights at which the weights rest; None where interrupted."""
    held = None
    with one_blas_thread(), postponed_interrupt():
        try:
            if loss.name == "tukey":
                before = _iterated(problem, x, LOSSES["huber"])
                x = before.x
                held = before.scale
            last = _iterated(problem, x, loss, held)
        except KeyboardInterrupt:
            return None
    counts = np.concatenate([recording.counts for recording in problem.inputs])
    slopes = loss.slope(last.errors[counts] / (last.scale * loss.tuning))
    ends = np.cumsum([recording.n for recording in problem.inputs])[:-1]
    outliers = Outliers(
        loss=loss.name,
        tuning=loss.tuning,
        scale=last.scale,
        weights=tuple(map(read_only, np.split(last.weights, ends))),
        widening=float(last.weights[counts].mean()) / max(float(slopes.mean()), _SLOPE),
        rounds=last.number,
    )
    return last.x, last.sse, outliers


def _iterated(problem: FitProblem, x: FloatArray, loss: Loss, held: float | None = None) -> _Round:
    """Rounds of least squares until the weights rest; `held` is the scale, where it is known."""
    residuals = Residuals(problem, 1.0)
    inputs = problem.inputs
    counts = np.concatenate([recording.counts for recording in inputs])
    precise = np.concatenate([np.ones(r.n) if r.emphasised else np.sqrt(r.weights) for r in inputs])
    torque = np.concatenate([r.torque for r in inputs if r.torque is not None])
    least = _SMALLEST * float(np.sqrt(np.mean(torque**2)))
    last = _Round(x, np.inf, np.zeros(0), np.zeros(0), 0.0, 0)
    for number in range(1, _ROUNDS + 1):
        errors = np.concatenate(residuals.of(x)) * precise
        scale = held or max(spread(errors[counts]), least)
        weights = np.maximum(loss.weight(errors / (scale * loss.tuning)), _LEAST)
        if last.number and np.abs(weights - last.weights).max() <= _RESTS:
            return replace(last, errors=errors)
        x, sse = _step(problem, residuals, x, weights, scale)
        last = _Round(x, sse, errors, weights, scale, number)
    return last


def _step(
    problem: FitProblem, residuals: Residuals, x: FloatArray, weights: FloatArray, scale: float
) -> tuple[FloatArray, float]:
    """The least squares with these weights: parameters, and the weighted sum of the data."""
    root = np.sqrt(weights)
    n = len(weights)

    def rows(at: FloatArray) -> FloatArray:
        weighted = residuals.rows(at)
        weighted[:, :n] *= root
        weighted[:, n:] *= scale  # priors are weighed against the noise
        return weighted

    best = minimise(rows, x, problem.lower, problem.upper, ends=Ends(stall=0.1 / problem.n))
    data = best.residual[:n]
    if best.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return best.x, float(data @ data)
