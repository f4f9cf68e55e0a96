"""Steps along the valley of stiffness and slack length."""

import numpy as np
import pytest

from surae.inference import make_problem
from surae.inference.least_squares.residuals import Residuals, curved_move


@pytest.mark.parametrize("geometry", ["thesis", "virtual-work"])
def test_to_first_order_a_move_is_the_step(noisy, geometry):
    from surae.model import ModelOptions

    problem = make_problem([noisy], options=ModelOptions(geometry=geometry))
    move = curved_move(problem)
    x = problem.start
    direction = 0.1 * x * np.random.default_rng(0).standard_normal(len(x))
    errors = [np.abs(move(x, h * direction) - x - h * direction) / x for h in (1e-3, 1e-4)]
    assert errors[0].max() < 1e-5
    assert errors[1].max() < 0.011 * errors[0].max()


def test_only_stiffness_and_slack_are_bent(noisy):
    problem = make_problem([noisy])
    x, step = problem.start, 0.1 * problem.start
    moved = curved_move(problem)(x, step)
    for j, name in enumerate(problem.free):
        if not name.startswith("x0"):
            assert moved[j] == x[j] + step[j], name


def test_the_force_where_the_muscle_is_longest_follows_the_step(noisy):
    # A step in the stiffness alone scales φ = k·(x_ref − x0) as a straight line would.
    problem = make_problem([noisy])
    x = problem.start
    k, x0 = problem.free.index("k_tri"), problem.free.index("x0_tri")
    step = np.zeros(len(x))
    step[k] = 50.0
    moved = curved_move(problem)(x, step)
    assert moved[k] == x[k] + 50.0
    assert moved[x0] == pytest.approx(x[x0], rel=1e-12)


def test_a_slack_length_held_stays(noisy):
    problem = make_problem([noisy])
    x = problem.start
    step = 0.3 * x
    step[problem.free.index("x0_tri")] = 0.0
    j = problem.free.index("x0_tri")
    assert curved_move(problem)(x, step)[j] == pytest.approx(x[j], rel=1e-12)


def test_a_fixed_partner_makes_it_straight(noisy):
    problem = make_problem([noisy], fixed={"k_tri": 150.0, "x0_tib": 0.06})
    x, step = problem.start, 0.1 * problem.start
    np.testing.assert_array_equal(curved_move(problem)(x, step), x + step)


def test_a_move_is_better_than_a_straight_step(clean, subject):
    # From another point of the valley, a step towards the truth lands lower on the curve.
    problem = make_problem([clean])
    rows = Residuals(problem).rows
    truth = np.array([subject.parameters[name] for name in problem.free])
    x = truth.copy()
    k, x0 = problem.free.index("k_tri"), problem.free.index("x0_tri")
    longest = 0.118 - 1.67 * (0.0480 - 0.0104 * clean.angle.max())
    x[k] *= 0.7
    x[x0] = longest - truth[k] * (longest - truth[x0]) / x[k]
    # The step whose first order leads to the truth's stiffness along the valley.
    step = np.zeros(len(x))
    step[k] = truth[k] - x[k]
    step[x0] = (longest - x[x0]) * step[k] / x[k]

    def cost(point):
        residual = rows(point)[-1]
        return float(residual @ residual)

    assert cost(curved_move(problem)(x, step)) < 1e-3 * cost(x + step)
