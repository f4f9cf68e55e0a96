"""Uncertainty without formulas: fit again and again with blocks of the residual as the noise."""

import math
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.assessment.fit_ledger import ledger_of
from surae.assessment.likelihood.profile import prior_noise
from surae.assessment.residual import autocovariance
from surae.errors import InputError
from surae.estimation import FitProblem, FitResult
from surae.estimation.least_squares import Outcome, minimise
from surae.estimation.residuals import Residuals, curved_move
from surae.estimation.result import with_laboratory
from surae.filed import filed
from surae.files import PathLike
from surae.frozen import Comparable, read_only
from surae.model import adapted
from surae.progress import Progress
from surae.records import Saved
from surae.runner import Engine, cores, results
from surae.signals import ModelInputs
from surae.units import FloatArray
from surae.versions import versions

#: Replicates unless told otherwise: the ends of a 95 % interval are then known to about a tenth
#: Fewer replicates than this have no 2.5th percentile.
_FEWEST = 40
#: What its file holds.
_KIND = "bootstrap"


@filed("name")
@dataclass(frozen=True, slots=True)
class BootstrapEstimate:
    """One parameter over the replicates."""

    #: `name`, `unit`: the parameter.
    name: str
    unit: str
    value: float  #: Estimate of the fit.
    sem: float | None  #: Standard deviation of the replicates.
    #: Percentile interval: the 2.5th and 97.5th percentile of the replicates.
    ci95: tuple[float, float] | None


@filed("values", "resumed")
@dataclass(frozen=True, slots=True, eq=False)
class Bootstrap(Comparable, Saved):
    """A block bootstrap of a fit.

    Attributes
    ----------
    model : str
        Name of the model.
    parameters : mapping of str to BootstrapEstimate
        The estimated ones.
    values : ndarray, shape (replicates, p)
        Estimates of every replicate that was done, in the order of their numbers; NaN where its
        fit failed.
    block_s : tuple of float
        Length of the blocks of each recording [s].
    replicates, missing, failed, resumed : int
        Asked for; not done, as the user stopped it; without a fit; and taken from the file.
    seed : int
        Of the random numbers.
    seconds : float
        Wall time.
    versions : mapping of str to str
        Versions of surae and of what its numbers depend on.
    """

    model: str
    parameters: Mapping[str, BootstrapEstimate]
    values: FloatArray
    block_s: tuple[float, ...]
    replicates: int
    missing: int
    failed: int
    resumed: int
    seed: int
    seconds: float
    versions: Mapping[str, str]

    def as_dict(self) -> dict[str, Any]:
        """The bootstrap as plain data, as it is saved."""
        return {"method": "circular residual blocks, percentile intervals"} | Saved.as_dict(self)


def bootstrap(
    result: FitResult,
    *,
    replicates: int,
    seed: int = 0,
    block_s: float | None = None,
    workers: int | None = None,
    store: PathLike | None = None,
    progress: Progress | None = None,
) -> Bootstrap:
    """Fit torques made of the modelled one and random blocks of the residual.

    Blocks are circular, of one length for each recording; the residual's mean is removed, and it is
    widened by √(n/(n − p)) for what the fit took of it. Where samples are weighted, and not for
    emphasis, the blocks are of the weighted residual; samples left out get none. A prior is an
    observation too: its median is drawn anew. Every replicate starts from the fit, and has its own
    stream of random numbers: the same seed gives the same numbers, whatever the workers or
    interruptions.

    Replicates of the same fit, seed and blocks that the file `store` already holds are not made
    again. All else is as of `surae.bootstrap`.
    """
    begin = time.perf_counter()
    result = with_laboratory(result)
    problem = result.problem
    if replicates < 1:
        raise InputError(f"replicates is {replicates}; give at least 1")
    if seed < 0:
        raise InputError(f"seed is {seed}; give 0 or more")
    if result.outliers is not None:
        raise InputError(
            "a fit in which outliers count less has no bootstrap: its blocks would carry them to "
            "samples that count; fit by least squares"
        )
    if not np.isfinite(result.sse):
        raise InputError("the fit has no finite torque to draw residuals from; fit again")
    pools = [
        _pool(inputs, e, result) for inputs, e in zip(problem.inputs, result.residuals, strict=True)
    ]
    lengths = [
        _length(inputs, pool, block_s) for inputs, pool in zip(problem.inputs, pools, strict=True)
    ]
    noise = prior_noise(result)
    x = np.clip([result.values[name] for name in problem.free], problem.lower, problem.upper)

    def replicate(number: int) -> list[float] | None:
        rng = np.random.default_rng([seed, number])
        drawn = replace(
            problem,
            inputs=tuple(
                _redrawn(inputs, e, pool, length, rng)
                for inputs, e, pool, length in zip(
                    problem.inputs, result.residuals, pools, lengths, strict=True
                )
            ),
            priors={name: prior.drawn(rng) for name, prior in problem.priors.items()},
        )
        minimum = refit(drawn, x, noise)
        return None if minimum is None else minimum.tolist()

    settings = {"seed": seed, "block": lengths, "parameters": list(problem.free)}
    ledger, about = ledger_of(result, store, _KIND, settings)
    with ledger:
        threads = Engine("threads", cores() if workers is None else workers)
        plan = [(str(number), number) for number in range(replicates)]
        there = ledger.begin(_KIND, _KIND, about, plan)
        calls = {key: {"number": number} for key, number in plan if key not in there}
        resumed = replicates - len(calls)
        with suppress(KeyboardInterrupt):
            ledger.keep(results(replicate, calls, threads), progress)
        done = dict(ledger.results())
    p = len(problem.free)
    table = np.array(
        [np.full(p, np.nan) if done[i] is None else done[i] for i in sorted(done)], dtype=float
    ).reshape(len(done), p)
    good = table[np.isfinite(table).all(axis=1)]
    return Bootstrap(
        model=problem.spec.name,
        parameters=_estimates(result, good),
        values=read_only(table),
        block_s=tuple(
            b / inputs.rate_hz for b, inputs in zip(lengths, problem.inputs, strict=True)
        ),
        replicates=replicates,
        missing=replicates - len(done),
        failed=len(table) - len(good),
        resumed=resumed,
        seed=seed,
        seconds=time.perf_counter() - begin,
        versions=versions(),
    )


def _estimates(result: FitResult, good: FloatArray) -> dict[str, BootstrapEstimate]:
    problem = result.problem
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    estimates = {}
    for j, name in enumerate(problem.free):
        sem = ci95 = None
        if len(good) >= _FEWEST:
            sem = float(good[:, j].std(ddof=1))
            low, high = np.quantile(good[:, j], [0.025, 0.975]).tolist()
            ci95 = (low, high)
        estimates[name] = BootstrapEstimate(name, table[name].unit, result.values[name], sem, ci95)
    return estimates


def _pool(inputs: ModelInputs, residual: FloatArray, result: FitResult) -> FloatArray:
    """What blocks are drawn from: the weighted residual where samples count."""
    n, p = result.problem.n, len(result.problem.free)
    weighted = residual * _roots(inputs)
    if inputs.weight is not None:
        weighted = weighted[inputs.weight > 0]
    return np.asarray((weighted - weighted.mean()) * math.sqrt(n / (n - p)))


def _length(inputs: ModelInputs, pool: FloatArray, block_s: float | None) -> int:
    if block_s is None:
        return block_length(pool)
    longest = len(pool) / inputs.rate_hz / 2
    if not 0 < block_s <= longest:
        raise InputError(
            f"{inputs.where}: blocks of {block_s:g} s; give more than 0 and at most half of the "
            f"recording, {longest:.4g} s"
        )
    return max(round(block_s * inputs.rate_hz), 1)


def _redrawn(
    inputs: ModelInputs,
    residual: FloatArray,
    pool: FloatArray,
    length: int,
    rng: np.random.Generator,
) -> ModelInputs:
    """The recording with another torque: modelled, and blocks of the residual."""
    assert inputs.torque is not None
    torque = inputs.torque - residual
    drawn = draw_blocks(pool, length, rng)
    counted = inputs.counts
    torque[counted] += drawn / _roots(inputs)[counted]
    return replace(inputs, torque=read_only(torque))


def _roots(inputs: ModelInputs) -> FloatArray:
    """What makes the residual stationary: √w, unless weights are there for emphasis."""
    if inputs.weight is None or inputs.emphasised:
        return np.ones(inputs.n)
    return np.asarray(np.sqrt(inputs.weight))


def block_length(residual: FloatArray) -> int:
    """Length of the blocks that gives a mean its most precise standard error.

    Politis and White (2004) with the correction of Patton, Politis and White (2009), for circular
    blocks: (2G²/D)^⅓·n^⅓ from the autocovariance R under a flat-top window, G = Σ|k|R(k) and
    D = 4/3·(ΣR)².

    At least 1, at most 3√n.
    """
    n = len(residual)
    centred = residual - residual.mean()
    sums, _ = autocovariance(centred, np.ones(n, dtype=bool), n - 1)
    if not sums[0] > 0:
        return 1
    rho = sums / sums[0]
    limit = 2.0 * math.sqrt(math.log10(max(n, 10)) / n)
    small = np.abs(rho[1:]) < limit
    run = max(5, math.ceil(math.sqrt(math.log10(max(n, 10)))))
    # The first of `run` lags in a row that are all small.
    together = np.convolve(small, np.ones(run), "valid") >= run
    first = int(np.argmax(together)) if together.any() else n // 2
    reach = min(2 * max(first, 1), n - 1)
    lags = np.arange(-reach, reach + 1)
    window = np.clip(2.0 * (1.0 - np.abs(lags) / reach), 0.0, 1.0)
    R = sums[np.abs(lags)] / n
    G, g0 = float(np.sum(window * np.abs(lags) * R)), float(np.sum(window * R))
    most = max(1, math.ceil(3 * math.sqrt(n)))
    if g0 <= 0:
        return most
    length = (2.0 * G * G / (4.0 / 3.0 * g0 * g0)) ** (1 / 3) * n ** (1 / 3)
    return int(min(max(round(length), 1), most))


def draw_blocks(residual: FloatArray, length: int, rng: np.random.Generator) -> FloatArray:
    """Draw as many samples as there are, from blocks that begin anywhere and go on past the end."""
    n = len(residual)
    starts = rng.integers(n, size=math.ceil(n / length))
    index = (starts[:, None] + np.arange(length)) % n
    return np.asarray(residual[index.ravel()[:n]])


#: Evaluations of one fit at most.
_EVALUATIONS = 60


def refit(problem: FitProblem, x: FloatArray, noise: float) -> FloatArray | None:
    """Minimum next to a point, from that point only.

    `noise` is the standard deviation [Nm] that priors are weighed against. None where the model
    gives no finite numbers.
    """
    minimum = minimise(
        Residuals(problem, noise).rows, x, problem.lower, problem.upper,
        move=curved_move(problem), max_iterations=_EVALUATIONS, stall=0.1 / problem.n,
    )  # fmt: skip
    if minimum.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return None if minimum.outcome is Outcome.NOT_FINITE else minimum.x
