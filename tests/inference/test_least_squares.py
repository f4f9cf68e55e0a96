"""The iteration: bounds, odd starts, overflow, rank, interruption and units."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from surae.inference.least_squares.minimise import Ends, Outcome, column_norms, compress, minimise

INF = np.full(2, np.inf)


def rosenbrock(x):
    """Rows of the Rosenbrock valley: J and residual, minimum 0 at (1, 1)."""
    return np.array([[-20.0 * x[0], -1.0], [10.0, 0.0], [10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]]])


T = np.linspace(0, 3, 40)


def decay(x, t=T, truth=(2.0, 1.3)):
    """Rows of a·exp(−b·t) with a little structure left in the residual."""
    e = np.exp(-x[1] * t)
    measured = truth[0] * np.exp(-truth[1] * t) + 0.05 * np.sin(5 * t)
    return np.stack([e, -x[0] * t * e, x[0] * e - measured])


def counted(rows, stop=None):
    """Rows that count their calls and press Ctrl-C in call number `stop`."""

    def wrapped(x):
        wrapped.calls += 1
        if wrapped.calls == stop:
            raise KeyboardInterrupt
        out = rows(x)
        wrapped.sums.append(float(out[-1] @ out[-1]))
        return out

    wrapped.calls, wrapped.sums = 0, []
    return wrapped


def test_compress_keeps_all_that_a_step_needs():
    rows = np.random.default_rng(0).standard_normal((5, 60))
    J, e = rows[:-1].T.copy(), rows[-1].copy()
    R, q = compress(rows)[:2]
    np.testing.assert_allclose(R.T @ R, J.T @ J, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(R.T @ q, J.T @ e, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(R, np.triu(R))
    np.testing.assert_allclose(column_norms(R), np.linalg.norm(J, axis=0), rtol=1e-13)


@pytest.mark.parametrize("n", [1, 3, 4])
def test_compress_of_fewer_samples_than_parameters(n):
    rows = np.random.default_rng(1).standard_normal((5, n))
    J, e = rows[:-1].T.copy(), rows[-1].copy()
    R, q = compress(rows)[:2]
    assert R.shape == (4, 4)
    np.testing.assert_allclose(R.T @ R, J.T @ J, atol=1e-12)
    np.testing.assert_allclose(R.T @ q, J.T @ e, atol=1e-12)


def test_what_is_returned_belongs_to_the_point():
    found = minimise(decay, np.array([1.0, 0.5]), -INF, INF)
    rows = decay(found.x)
    assert found.outcome is Outcome.CONVERGED
    np.testing.assert_array_equal(found.residual, rows[-1])
    assert found.sse == float(rows[-1] @ rows[-1])
    np.testing.assert_allclose(found.R.T @ found.R, rows[:-1] @ rows[:-1].T, rtol=1e-12)


def test_rows_may_be_one_buffer_that_is_written_over():
    buffer = np.empty((3, 40))

    def rows(x):
        buffer[:] = decay(x)
        return buffer

    once = minimise(decay, np.array([1.0, 0.5]), -INF, INF)
    again = minimise(rows, np.array([1.0, 0.5]), -INF, INF)
    np.testing.assert_array_equal(once.x, again.x)
    np.testing.assert_array_equal(once.residual, again.residual)
    np.testing.assert_array_equal(once.R, again.R)


@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        ([-2.0, -2.0], [0.5, 2.0]),
        ([-2.0, 1.5], [2.0, 2.0]),
        ([-2.0, -2.0], [2.0, 0.3]),
        ([0.2, -2.0], [0.6, 0.1]),
        ([1.2, 1.6], [3.0, 1.7]),
    ],
)
def test_a_solution_at_a_bound_equals_scipy(lower, upper):
    lower, upper = np.array(lower), np.array(upper)
    first = np.clip([0.5, 1.0], lower, upper)
    found = minimise(rosenbrock, first, lower, upper, ends=Ends(ftol=1e-14))
    theirs = least_squares(
        lambda x: rosenbrock(x)[-1],
        np.clip([0.8, 0.9], lower + 1e-3, upper - 1e-3),
        jac=lambda x: rosenbrock(x)[:-1].T,
        bounds=(lower, upper),
        method="dogbox",
        ftol=1e-15,
        xtol=1e-15,
        gtol=1e-15,
    )
    assert found.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(found.x, theirs.x, rtol=1e-6, atol=1e-8)
    assert np.any((found.x == lower) | (found.x == upper))


@pytest.mark.parametrize("first", [[-2.0, -2.0], [2.0, 2.0], [-2.0, 2.0], [2.0, -2.0]])
def test_a_start_in_a_corner_leaves_it(first):
    found = minimise(rosenbrock, np.array(first), np.full(2, -2.0), np.full(2, 2.0))
    assert found.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(found.x, [1.0, 1.0], rtol=1e-8)


def test_a_start_outside_the_bounds_is_brought_in():
    found = minimise(decay, np.array([50.0, -7.0]), np.zeros(2), np.array([10.0, 5.0]))
    inside = minimise(decay, np.array([1.0, 0.5]), np.zeros(2), np.array([10.0, 5.0]))
    assert found.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(found.x, inside.x, rtol=1e-5)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("where", [0, -1])
def test_not_finite_at_the_start(bad, where):
    def rows(x):
        out = rosenbrock(x)
        out[where, 0] = bad
        return out

    found = minimise(rows, np.array([0.5, 0.5]), -INF, INF)
    assert found.outcome is Outcome.NOT_FINITE
    assert found.iterations == 1
    np.testing.assert_array_equal(found.x, [0.5, 0.5])


@pytest.mark.parametrize("big", [np.inf, np.nan, 1e200])
def test_an_overflow_in_a_trial_step_is_a_step_too_far(big):
    # Beyond x0 = 0.9 the model fails until the valley is reached from the other side.
    def rows(x):
        out = decay(x)
        if x[1] > 1.6:
            out[-1] = big
        return out

    found = minimise(rows, np.array([6.0, 0.1]), -INF, INF)
    free = minimise(decay, np.array([1.0, 0.5]), -INF, INF)
    assert found.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(found.x, free.x, rtol=1e-5)


def test_a_sum_that_overflows_at_the_start():
    def rows(x):
        out = decay(x)
        out[-1] = 1e200
        return out

    assert minimise(rows, np.ones(2), -INF, INF).outcome is Outcome.NOT_FINITE


def test_two_columns_alike():
    # Only a + b matters: the sum is found, neither parameter runs away.
    t = np.linspace(0, 1, 30)

    def rows(x):
        return np.stack([t, t, np.cos(t), (x[0] + x[1]) * t + x[2] * np.cos(t) - 3 * t])

    infinite = np.full(3, np.inf)
    found = minimise(rows, np.array([1.0, 0.0, 1.0]), -infinite, infinite)
    assert found.outcome is Outcome.CONVERGED
    assert found.x[0] + found.x[1] == pytest.approx(3.0, rel=1e-6)
    assert np.all(np.abs(found.x) < 10)


def test_a_parameter_without_influence_stays():
    def rows(x):
        out = rosenbrock(x[:2])
        return np.insert(out, 2, 0.0, axis=0)

    infinite = np.full(3, np.inf)
    found = minimise(rows, np.array([-1.2, 1.0, 7.0]), -infinite, infinite)
    assert found.outcome is Outcome.CONVERGED
    assert found.x[2] == 7.0
    np.testing.assert_allclose(found.x[:2], 1.0, rtol=1e-8)


def test_a_perfect_start_is_recognised():
    rows = counted(rosenbrock)
    found = minimise(rows, np.ones(2), -INF, INF)
    assert found.outcome is Outcome.CONVERGED
    assert rows.calls == found.iterations == 1


@pytest.mark.parametrize("stop", [2, 5, 14])
def test_interruption_keeps_the_best_so_far(stop):
    rows = counted(rosenbrock, stop)
    found = minimise(rows, np.array([-1.2, 1.0]), -INF, INF)
    assert found.outcome is Outcome.INTERRUPTED
    assert found.sse == min(rows.sums)
    assert len(rows.sums) == stop - 1
    np.testing.assert_array_equal(found.residual, rosenbrock(found.x)[-1])


def test_interruption_within_a_move():
    def move(x, step):
        move.calls += 1
        if move.calls == 3:
            raise KeyboardInterrupt
        return x + step

    move.calls = 0
    rows = counted(rosenbrock)
    found = minimise(rows, np.array([-1.2, 1.0]), -INF, INF, move=move)
    assert found.outcome is Outcome.INTERRUPTED
    assert found.sse == min(rows.sums)


@pytest.mark.parametrize("limit", [1, 2, 7])
def test_the_iteration_limit_counts_evaluations(limit):
    rows = counted(rosenbrock)
    found = minimise(rows, np.array([-1.2, 1.0]), -INF, INF, ends=Ends(max_iterations=limit))
    assert found.outcome is Outcome.ITERATIONS
    assert rows.calls == found.iterations == limit
    assert found.sse == min(rows.sums)


@pytest.mark.parametrize("unit", [1e-6, 1e6])
@pytest.mark.parametrize("bounded", [False, True])
def test_units_do_not_change_the_path(unit, bounded):
    factor = np.array([unit, 1.0])
    lower, upper = (np.full(2, -2.0), np.array([0.7, 2.0])) if bounded else (-INF, INF)

    def scaled(x):
        out = rosenbrock(x / factor)
        out[0] /= unit
        return out

    once, again = counted(rosenbrock), counted(scaled)
    found = minimise(once, np.array([-1.2, 1.0]), lower, upper)
    other = minimise(again, np.array([-1.2, 1.0]) * factor, lower * factor, upper * factor)
    assert other.iterations == found.iterations
    np.testing.assert_allclose(again.sums, once.sums, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(other.x / factor, found.x, rtol=1e-8)


def test_a_move_along_the_valley_needs_fewer_steps():
    # In y − x² the Rosenbrock valley is straight.
    def along(x, step):
        return np.array([x[0] + step[0], x[1] + step[1] + step[0] ** 2])

    straight = minimise(rosenbrock, np.array([-1.2, 1.0]), -INF, INF)
    found = minimise(rosenbrock, np.array([-1.2, 1.0]), -INF, INF, move=along)
    np.testing.assert_allclose(found.x, [1.0, 1.0], rtol=1e-8)
    assert found.iterations < straight.iterations


def test_a_move_out_of_the_bounds_is_brought_back():
    lower, upper = np.full(2, -2.0), np.array([0.5, 2.0])
    seen = []

    def rows(x):
        seen.append(x.copy())
        return rosenbrock(x)

    found = minimise(rows, np.array([-1.2, 1.0]), lower, upper, move=lambda x, step: x + 3.0 * step)
    assert np.all((seen >= lower) & (seen <= upper))
    assert found.sse == min(np.sum(rosenbrock(x)[-1] ** 2) for x in seen)


def test_stall_ends_only_after_a_failed_step():
    # With every step accepted `stall` plays no part.
    sums = counted(decay)
    plain = minimise(sums, np.array([1.9, 1.2]), -INF, INF, ends=Ends(ftol=1e-14))
    assert np.all(np.diff(sums.sums) <= 0)
    found = minimise(decay, np.array([1.9, 1.2]), -INF, INF, ends=Ends(ftol=1e-14, stall=1e-3))
    assert found.iterations == plain.iterations
    np.testing.assert_array_equal(found.x, plain.x)

    def kinked(x):
        out = decay(x)
        if x[1] > 1.0:  # the residual jumps, nowhere to be seen in the Jacobian
            out[-1] += 1.0
        return out

    kink = np.array([2.0, 0.999])
    with_stall = minimise(kinked, kink, -INF, INF, ends=Ends(ftol=1e-14, stall=1.0))
    without = minimise(kinked, kink, -INF, INF, ends=Ends(ftol=1e-14))
    assert with_stall.outcome is Outcome.CONVERGED
    assert with_stall.iterations < without.iterations
