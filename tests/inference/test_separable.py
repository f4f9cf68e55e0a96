"""The linear parameters: solved exactly, within their bounds, whatever else is fixed or silent."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from surae.inference import make_problem
from surae.inference.least_squares.residuals import Residuals
from surae.inference.least_squares.separable import scan_lengths, solve_linear
from surae.model import get_model

MUSCLE = get_model("muscle")
LINEAR, SLACK, SCANNED = MUSCLE.linear, MUSCLE.slack, MUSCLE.scanned
SEVEN = (*LINEAR, *SLACK)


def random_point(problem, rng):
    return problem.lower + (problem.upper - problem.lower) * rng.random(len(problem.free))


def sensible_point(problem, rng):
    """Non-linear parameters near the defaults, so that every muscle matters."""
    spread = np.clip(problem.start * rng.uniform(0.8, 1.25, len(problem.start)), 0, None)
    return np.clip(spread, problem.lower, problem.upper)


def cost(rows, x):
    residual = rows(x)[-1]
    return float(residual @ residual)


def reference(problem, x):
    """Linear parameters and cost by scipy, from torques simulated one part at a time."""
    (inputs,) = problem.inputs
    simulator = problem.spec.simulator(inputs, problem.options)
    at = dict(zip(problem.spec.names, problem.values(x), strict=True))
    nothing = at | dict.fromkeys(LINEAR, 0.0) | dict.fromkeys(SLACK, 5.0)

    def torque(**given):
        return simulator.torque(np.array([(nothing | given)[n] for n in problem.spec.names]))

    np.testing.assert_allclose(torque(), 0.0, atol=1e-30)
    columns, low, high, offset = [], [], [], np.zeros(inputs.n)
    names = [name for name in SEVEN if name in problem.free]
    for name in SEVEN:
        if name not in problem.free:
            offset += torque(**{name: at[name]})
            continue
        j = problem.free.index(name)
        lower, upper = problem.lower[j], problem.upper[j]
        if name in LINEAR:
            columns.append(torque(**{name: 1.0}))
            low.append(lower)
            high.append(upper)
        else:  # in units of the factor at the middle of the bounds
            k, middle = at[SLACK[name]], 0.5 * (lower + upper)
            columns.append(torque(**{name: middle}))
            low.append(np.exp(-k * (upper - middle)))
            high.append(np.exp(-k * (lower - middle)))
    A = np.array(columns).T
    scale = np.linalg.norm(A, axis=0)
    scale[scale == 0] = 1.0
    found = lsq_linear(
        A / scale,
        inputs.torque - offset,
        (np.array(low) * scale, np.array(high) * scale),
        method="bvls",
        tol=1e-15,
    )
    return names, 2 * found.cost


@pytest.mark.parametrize("seed", range(4))
def test_as_low_as_scipy_within_the_bounds(seed, noisy):
    problem = make_problem([noisy])
    rows = Residuals(problem).data_rows
    rng = np.random.default_rng(seed)
    x = sensible_point(problem, rng) if seed % 2 else random_point(problem, rng)
    solved, sse = solve_linear(problem, rows, x)
    _, lowest = reference(problem, x)
    assert np.all((solved >= problem.lower) & (solved <= problem.upper))
    assert cost(rows, solved) == pytest.approx(lowest, rel=1e-6)
    assert sse == pytest.approx(cost(rows, solved), rel=1e-6)


def test_parameters_that_are_not_linear_are_kept(noisy):
    problem = make_problem([noisy])
    x = sensible_point(problem, np.random.default_rng(0))
    solved, _ = solve_linear(problem, Residuals(problem).data_rows, x)
    for j, name in enumerate(problem.free):
        assert (solved[j] == x[j]) == (name not in SEVEN), name


def test_the_truth_is_found_from_the_other_eight(clean, subject):
    problem = make_problem([clean])
    truth = np.array([subject.parameters[name] for name in problem.free])
    x = truth.copy()
    for j, name in enumerate(problem.free):
        if name in SEVEN:
            x[j] = problem.start[j]
    solved, sse = solve_linear(problem, Residuals(problem).data_rows, x)
    np.testing.assert_allclose(solved, truth, rtol=1e-6)
    assert sse < 1e-12 * float(clean.torque @ clean.torque)


@pytest.mark.parametrize("name", SEVEN)
@pytest.mark.parametrize("side", [0, 1])
def test_a_bound_in_the_way_is_met_exactly(name, side, clean, subject):
    truth = subject.parameters[name]
    # The allowed range lies above (0) or below (1) the truth.
    pair = (1.05 * truth, 1.5 * truth) if side == 0 else (0.5 * truth, 0.95 * truth)
    problem = make_problem([clean], bounds={name: pair})
    x = np.array([subject.parameters[n] for n in problem.free])
    x = np.clip(x, problem.lower, problem.upper)
    solved, _ = solve_linear(problem, Residuals(problem).data_rows, x)
    j = problem.free.index(name)
    assert solved[j] == pytest.approx(pair[side], rel=1e-9)
    assert np.all((solved >= problem.lower) & (solved <= problem.upper))
    _, lowest = reference(problem, x)
    assert cost(Residuals(problem).data_rows, solved) == pytest.approx(lowest, rel=1e-6)


@pytest.mark.parametrize(
    "names", [("m",), ("g2", "g4"), ("x0_tri",), ("x0_tib", "g1"), ("k_tri", "l0_tri"), LINEAR]
)
def test_fixed_parameters_stay(names, clean, subject):
    fixed = {name: 1.1 * subject.parameters[name] for name in names}
    problem = make_problem([clean], fixed=fixed)
    x = problem.start
    solved, _ = solve_linear(problem, Residuals(problem).data_rows, x)
    assert len(solved) == 15 - len(names)
    _, lowest = reference(problem, x)
    assert cost(Residuals(problem).data_rows, solved) == pytest.approx(lowest, rel=1e-6)


def test_no_linear_parameter_at_all(noisy, subject):
    problem = make_problem([noisy], fixed={name: subject.parameters[name] for name in SEVEN})
    rows = Residuals(problem).data_rows
    solved, sse = solve_linear(problem, rows, problem.start)
    np.testing.assert_array_equal(solved, problem.start)
    assert sse == pytest.approx(cost(rows, problem.start), rel=1e-12)


def test_a_silent_channel_keeps_its_weight(noisy):
    emg = noisy.emg.copy()
    emg[:, 1] = 0.0
    problem = make_problem([replace(noisy, emg=emg)])
    x = problem.start
    solved, _ = solve_linear(problem, Residuals(problem).data_rows, x)
    j = problem.free.index("g2")
    assert solved[j] == x[j]
    _, lowest = reference(problem, x)
    assert cost(Residuals(problem).data_rows, solved) == pytest.approx(lowest, rel=1e-6)


def held_at(inputs, **beyond):
    """A problem with parameters fixed beyond their bounds, where `make_problem` lets none be."""
    starts = {p.name: p.start for p in get_model("muscle").parameters}
    problem = make_problem([inputs], fixed={name: starts[name] for name in beyond})
    base = problem.base.copy()
    base[[problem.spec.names.index(name) for name in beyond]] = list(beyond.values())
    return replace(problem, base=base)


def test_a_model_that_overflows_leaves_the_point_as_it_is(noisy):
    problem = held_at(noisy, k_tri=1e6, x0_tri=1e-3)
    solved, sse = solve_linear(problem, Residuals(problem).data_rows, problem.start)
    np.testing.assert_array_equal(solved, problem.start)
    assert sse == np.inf


@pytest.mark.parametrize("seed", range(3))
def test_the_scan_never_raises_the_cost(seed, noisy):
    problem = make_problem([noisy])
    rows = Residuals(problem).data_rows
    x = random_point(problem, np.random.default_rng(seed))
    _, without = solve_linear(problem, rows, x)
    scanned = scan_lengths(problem, rows, x)
    assert cost(rows, scanned) <= without * (1 + 1e-9)
    assert cost(rows, scanned) <= cost(rows, x)
    assert np.all((scanned >= problem.lower) & (scanned <= problem.upper))
    for j, name in enumerate(problem.free):
        if name not in (*SEVEN, *SCANNED):
            assert scanned[j] == x[j], name


def test_the_scan_leaves_fixed_lengths_alone(noisy):
    problem = make_problem([noisy], fixed={"l0_tri": 0.045, "l0_tib": 0.08})
    rows = Residuals(problem).data_rows
    x = problem.start
    np.testing.assert_array_equal(scan_lengths(problem, rows, x), solve_linear(problem, rows, x)[0])


def test_the_scan_leaves_a_far_valley(clean, subject):
    problem = make_problem([clean])
    x = np.array([subject.parameters[name] for name in problem.free])
    j = problem.free.index("l0_tri")
    x[j] = problem.upper[j]
    found = scan_lengths(problem, Residuals(problem).data_rows, x)
    assert abs(found[j] - subject.parameters["l0_tri"]) < 0.01
