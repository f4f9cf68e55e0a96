"""Model 1.0 against the plain SciPy baseline: torque, Jacobian, whole fit."""

import statistics
import time
from collections.abc import Callable

import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture
from threadpoolctl import threadpool_limits

from surae.inference import FitProblem, assess, fit_problem
from surae.inference.least_squares.residuals import simulators
from surae.inference.uncertainty.covariance import covariance

import baseline

_PAIRS = 9


def paired(ours: Callable[[], object], theirs: Callable[[], object], pairs: int) -> list[float]:
    """Ratios theirs/ours of alternating runs, so that a slow moment of the machine hits both."""
    ratios = []
    for _ in range(pairs):
        begin = time.perf_counter()
        ours()
        middle = time.perf_counter()
        theirs()
        ratios.append((time.perf_counter() - middle) / (middle - begin))
    return ratios


def test_torque(benchmark: BenchmarkFixture, problem: FitProblem) -> None:
    (simulator,) = simulators(problem)
    benchmark(simulator.torque, problem.base)


def test_torque_jacobian(
    benchmark: BenchmarkFixture, problem: FitProblem, ratio: Callable[[str], None]
) -> None:
    (simulator,) = simulators(problem)
    columns = problem.columns
    benchmark(simulator.torque_jacobian, problem.base, columns)
    ratios = paired(
        lambda: simulator.torque(problem.base),
        lambda: simulator.torque_jacobian(problem.base, columns),
        101,
    )
    ratio(f"torque with Jacobian / torque: {statistics.median(ratios):.2f}")


def test_fit(
    benchmark: BenchmarkFixture, problem: FitProblem, ratio: Callable[[str], None]
) -> None:
    def ours() -> object:
        result = fit_problem(problem, starts=1)
        return result, assess(result)

    def plain() -> object:  # what the baseline computes, and no more
        result = fit_problem(problem, starts=1)
        return covariance(result.R, problem.free, result.sse, problem.n)

    result, assessed = benchmark(ours)
    with threadpool_limits(limits=1, user_api="blas"):  # the same for both, and faster for both
        best, theirs_covariance = baseline.fit(problem)
        ratios = paired(ours, lambda: baseline.fit(problem), _PAIRS)
        alike = paired(plain, lambda: baseline.fit(problem), _PAIRS)
    assert result.sse <= 2 * best.cost * (1 + 1e-4)
    sem = np.sqrt(np.diag(theirs_covariance))
    for name, theirs in zip(problem.free, sem, strict=True):
        ratio(f"  {name}: SEM {assessed.parameters[name].sem:.4g}, baseline {theirs:.4g}")
    ratio(
        f"baseline fit / surae fit and covariance, {problem.n} samples, default start: median "
        f"{statistics.median(alike):.1f} ({min(alike):.1f} … {max(alike):.1f} in {_PAIRS} pairs)"
    )
    ratio(
        "baseline fit / surae fit with its whole assessment, correlated residuals looked for: "
        f"median {statistics.median(ratios):.1f} ({min(ratios):.1f} … {max(ratios):.1f} in "
        f"{_PAIRS} pairs); baseline: {best.nfev} Jacobians, VAF residual {2 * best.cost:.5g}, "
        f"ours {result.sse:.5g}"
    )
