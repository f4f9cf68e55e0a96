"""The muscle-tendon model against model 1.0, and against the thesis's scheme at 1000 Hz."""

import statistics
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.optimize import least_squares
from threadpoolctl import threadpool_limits

from surae.inference import FitProblem, fit_problem, make_problem
from surae.inference.least_squares.residuals import simulators
from surae.model import ModelOptions
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

PROTOCOLS = ("multiple-holds", "multi-sine-holds")
_THESIS_RATE = 1000.0


def _problem(profile: str, model: str, rate_hz: float, truth: ModelOptions) -> FitProblem:
    """A problem on a trial whose truth has compliant tendons."""
    protocol = Protocol(profile=profile, chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=rate_hz)
    trial = virtual_trial(virtual_subject(seed=1), generate(protocol), model="muscle-tendon")
    return make_problem([trial], model, options=truth)


@pytest.fixture(scope="module", params=PROTOCOLS)
def profile(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


def test_torque_jacobian(benchmark: BenchmarkFixture) -> None:
    problem = _problem("multiple-holds", "muscle-tendon-strain", 8191 / 35, ModelOptions())
    (simulator,) = simulators(problem)
    benchmark(simulator.torque_jacobian, problem.base, problem.columns)


def test_fit_against_rigid(profile: str, ratio: Callable[[str], None]) -> None:
    rigid, elastic = (
        _problem(profile, model, 256.0, ModelOptions()) for model in ("muscle", "muscle-tendon")
    )
    fit_problem(elastic, starts=1)
    ratios = []
    for _ in range(5):
        begin = time.perf_counter()
        fit_problem(rigid, starts=1)
        middle = time.perf_counter()
        fit_problem(elastic, starts=1)
        ratios.append((time.perf_counter() - middle) / (middle - begin))
    ratio(f"{profile}: 2.0 fit / 1.0 fit of the same trial: {statistics.median(ratios):.1f}")


def test_fit_against_the_thesis(profile: str, ratio: Callable[[str], None]) -> None:
    """The same problem with the explicit scheme, compiled, at 1000 Hz, by finite differences."""
    ours = _problem(profile, "muscle-tendon", 256.0, ModelOptions())
    theirs = _problem(
        profile, "muscle-tendon", _THESIS_RATE, ModelOptions(integrator="explicit-euler")
    )
    (simulator,) = simulators(theirs)
    (inputs,) = theirs.inputs
    fit_problem(ours, starts=1)
    simulator.torque(theirs.base)

    def residual(x: np.ndarray) -> np.ndarray:
        torque = simulator.torque(theirs.values(x))
        return np.nan_to_num(torque - inputs.torque, nan=1e3, posinf=1e3, neginf=-1e3)

    begin = time.perf_counter()
    mine = fit_problem(ours, starts=1)
    middle = time.perf_counter()
    with threadpool_limits(limits=1, user_api="blas"):
        best = least_squares(
            residual,
            theirs.start,
            bounds=(theirs.lower, theirs.upper),
            x_scale="jac",
            diff_step=1e-4,  # the scheme chatters: with SciPy's own step it gives up at once
            max_nfev=100,
        )
    spent = time.perf_counter() - middle
    power = float(inputs.torque @ inputs.torque)
    ratio(
        f"{profile}: explicit scheme at {_THESIS_RATE:g} Hz with finite differences / ours: "
        f"{spent / (middle - begin):.0f} ({spent:.1f} s, {best.nfev} steps, VAF "
        f"{100 * (1 - 2 * best.cost / power):.2f} %; ours {mine.seconds:.2f} s, residual variance "
        f"{mine.sse / ours.n:.3g} Nm²)"
    )


@pytest.mark.parametrize("samples", [4_000, 40_000, 400_000])
def test_cost_is_linear(samples: int, ratio: Callable[[str], None]) -> None:
    problem = _problem("multiple-holds", "muscle-tendon", 256.0, ModelOptions())
    (trial,) = problem.inputs
    index = np.arange(samples) % trial.n
    names = ("angle", "velocity", "acceleration", "emg", "torque")
    longer = replace(
        trial,
        time=np.arange(samples) / trial.rate_hz,
        **{name: getattr(trial, name)[index] for name in names},
    )
    simulator = problem.spec.simulator(longer, problem.options)
    seconds = []
    for _ in range(3):
        begin = time.perf_counter()
        simulator.torque_jacobian(problem.base, problem.columns)
        seconds.append(time.perf_counter() - begin)
    ratio(
        f"{samples:,} samples: torque with Jacobian {1e3 * min(seconds):.1f} ms, "
        f"{1e9 * min(seconds) / samples:.0f} ns a sample"
    )
