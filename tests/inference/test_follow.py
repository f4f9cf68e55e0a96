"""A fit can be followed without being changed."""

from itertools import pairwise

import numpy as np
import pytest

from surae.inference import fit_problem, fit_robust, make_problem, solve


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
def test_every_better_point_is_told_and_nothing_changes(noisy, model) -> None:
    problem = make_problem([noisy], model)
    told = []
    followed = fit_problem(problem, starts=1, follow=lambda *point: told.append(point))
    alone = fit_problem(problem, starts=1)
    assert followed.values == alone.values
    assert followed.sse == alone.sse
    spec, values, sse = told[-1]
    assert spec is problem.spec
    assert dict(zip(spec.names, values.tolist(), strict=True)) == followed.values
    assert sse == pytest.approx(followed.sse)
    assert {one.name for one, _, _ in told} == {"muscle", model}
    own = [sse for one, values, sse in told if len(values) == len(spec.names)]
    assert np.all(np.isfinite(own))


def test_points_get_better_within_a_start(noisy) -> None:
    sums: list[float] = []
    fit_problem(make_problem([noisy]), starts=1, follow=lambda *told: sums.append(told[2]))
    assert len(sums) > 3
    assert np.all(np.diff(sums) < 0)


def test_a_robust_fit_is_followed_too(noisy) -> None:
    told = []
    fit_robust(make_problem([noisy]), starts=1, follow=lambda *point: told.append(point[0].name))
    assert set(told) == {"muscle"}


def test_a_posterior_is_followed_too_and_nothing_changes(noisy) -> None:
    problem = make_problem([noisy], "auto")
    told = []
    followed = solve(problem, follow=lambda *point: told.append(point))
    assert solve(problem).values == followed.values
    assert len(told) > 10
    for spec, values, cost in told:
        assert len(values) == len(spec.names)
        assert np.isfinite(cost)
    spec, values, _ = told[-1]
    found = dict(zip(spec.names, values.tolist(), strict=True))
    assert found["k_tri"] == pytest.approx(followed.values["k_tri"], rel=0.05)
    falls = [b < a for (s, _, a), (t, _, b) in pairwise(told) if s is t]
    assert np.mean(falls) > 0.5  # a stage begins again at another −2 ln p
