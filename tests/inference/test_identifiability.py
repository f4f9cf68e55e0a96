"""Identifiability on Jacobians made for the purpose, and on virtual trials of both models."""

from dataclasses import replace

import numpy as np
import pytest
from toys import linear, toy_fit

from surae.inference import assess, fit_problem, make_problem
from surae.inference.identifiability.identified import identifiability, unexplained
from surae.inference.least_squares.residuals import Residuals
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

N = 400
RNG = np.random.default_rng(5)
NOISE = 0.01 * RNG.standard_normal(N)
Q = np.linalg.qr(RNG.standard_normal((N, 4)))[0] * np.sqrt(N)


def examine(*columns, values=None, **more):
    """Fit a linear model of these columns, named a, b, …, and examine it."""
    design = np.column_stack(columns)
    names = "abcdefgh"[: design.shape[1]]
    values = np.ones(len(names)) if values is None else np.asarray(values)
    fit = toy_fit(
        linear(design),
        design @ values + NOISE,
        dict(zip(names, values.tolist(), strict=True)),
        dict.fromkeys(names, (-50.0, 50.0)),
    )
    return identifiability(fit, **more)


def test_orthogonal_columns_are_told_apart():
    found = examine(*Q.T[:3])
    assert found.names == ("a", "b", "c")
    assert found.condition == pytest.approx(1.0, rel=0.02)
    for one in found.parameters.values():
        assert one.collinearity == pytest.approx(1.0, abs=1e-9)
        assert one.alone == pytest.approx(one.uncertainty)
        assert one.alone == pytest.approx(0.01 / np.sqrt(N), rel=0.1)
        assert one.partners == ()
        # A change by its own value gives 1/√3 of the torque's root mean square.
        assert one.sensitivity == pytest.approx(3**-0.5, rel=0.01)


def test_two_equal_columns_are_one_direction():
    found = examine(Q[:, 0], Q[:, 1], Q[:, 0])
    assert found.condition is None
    weakest = found.directions[0]
    assert (weakest.eigenvalue, weakest.uncertainty) == (0.0, None)
    assert set(weakest.changes) == {"a", "c"}
    assert weakest.changes["a"] == pytest.approx(-weakest.changes["c"], rel=1e-2)
    assert weakest.words in (
        "a up with c down: the same torque",
        "c up with a down: the same torque",
    )
    for name, other in (("a", "c"), ("c", "a")):
        one = found.parameters[name]
        assert (one.collinearity, one.uncertainty) == (None, None)
        assert one.partners == (other,)
        assert f"{name} trades off with {other}" in one.advice
    assert found.parameters["b"].partners == ()
    assert found.parameters["b"].collinearity == pytest.approx(1.0)


def test_a_silent_column():
    found = examine(Q[:, 0], np.zeros(N))
    one = found.parameters["b"]
    assert (one.sensitivity, one.alone, one.uncertainty) == (0.0, None, None)
    assert "does not depend on b" in one.advice
    assert found.directions[0].words == "b up: the same torque"
    assert found.directions[0].uncertainty is None
    assert found.parameters["a"].partners == ()


def test_a_faint_column_has_little_influence():
    found = examine(Q[:, 0], 1e-3 * Q[:, 1])
    one = found.parameters["b"]
    assert one.collinearity == pytest.approx(1.0, abs=1e-6)
    assert one.advice.startswith("b has little influence on this torque")


def test_three_that_only_trade_off_together():
    third = (Q[:, 0] + Q[:, 1]) / np.sqrt(2) + 0.01 * Q[:, 2]
    found = examine(Q[:, 0], Q[:, 1], third)
    assert set(found.directions[0].changes) == {"a", "b", "c"}
    assert set(found.parameters["c"].partners) == {"a", "b"}


def test_what_others_do_not_explain():
    unit = Q[:, :3] / np.linalg.norm(Q[:, :3], axis=0)
    unit[:, 2] = 0.8 * unit[:, 0] + 0.6 * unit[:, 2]
    assert unexplained(unit, 2, [0]) == pytest.approx(0.36)
    assert unexplained(unit, 2, []) == pytest.approx(1.0)
    assert unexplained(unit, 0, [0]) == 0.0


def test_the_variance_inflation_widens():
    plain, wide = (examine(*Q.T[:2], variance_inflation=v) for v in (1.0, 9.0))
    assert wide.parameters["a"].uncertainty == pytest.approx(3 * plain.parameters["a"].uncertainty)
    assert wide.directions[0].uncertainty == pytest.approx(3 * plain.directions[0].uncertainty)
    assert wide.parameters["a"].collinearity == plain.parameters["a"].collinearity


def test_without_finite_torque_there_is_nothing(fitted):
    found = identifiability(replace(fitted, sse=np.inf))
    assert (found.names, found.directions, dict(found.parameters)) == ((), (), {})


def test_it_agrees_with_the_covariance(fitted):
    found, known = identifiability(fitted), assess(fitted)
    assert found.names == fitted.problem.free
    for name, one in found.parameters.items():
        sem, value = known.parameters[name].sem, fitted.values[name]
        assert one.uncertainty == pytest.approx(sem / value, rel=1e-6)
        assert one.uncertainty == pytest.approx(one.alone * one.collinearity, rel=1e-9)
    scaled = fitted.R * np.array([fitted.values[name] for name in found.names])
    eigenvalues = np.linalg.eigvalsh(scaled.T @ scaled) / (fitted.sse / (fitted.problem.n - 15))
    np.testing.assert_allclose([d.eigenvalue for d in found.directions], eigenvalues, rtol=1e-4)


def test_the_passive_tibialis_is_the_weakest_of_the_muscle_model(fitted):
    found = identifiability(fitted)
    weakest = found.directions[0]
    assert set(weakest.changes) == {"k_tib", "x0_tib"}
    assert weakest.words == "k_tib up with x0_tib up: nearly the same torque"
    for name, other in (("k_tib", "x0_tib"), ("x0_tib", "k_tib")):
        one = found.parameters[name]
        assert one.partners[0] == other
        assert "more plantarflexion" in one.advice
    assert "x0_tri" in found.parameters["k_tri"].partners
    assert found.parameters["k_tri"].collinearity > 10.0


def test_at_a_bound(noisy):
    found = identifiability(fit_problem(make_problem([noisy], bounds={"m": (2.9, 3.0)}), starts=1))
    assert "m" not in found.names
    one = found.parameters["m"]
    assert one.collinearity is None
    assert "bound of m" in one.advice


TENDON = {"dlt_tri": 0.04, "dlt_tib": 0.04, "pt_tri": 0.3, "pt_tib": 0.3}


@pytest.fixture(scope="module")
def rich():
    """A rich trial with compliant tendons, noise of 5 % on the torque alone."""
    subject = virtual_subject(2)
    protocol = Protocol(
        profile="multi-sine-holds", task="active", chirp_amplitude=0.2, chirp_rate=0.3, rate_hz=125
    )
    clean = virtual_trial(subject, generate(protocol), model="muscle-tendon", noise=0.0)
    spread = 0.05 * np.abs(clean.torque).mean()
    noise = spread * np.random.default_rng(4).standard_normal(clean.n)
    return subject, replace(clean, torque=clean.torque + noise)


def at_truth(rich, *free):
    """Identifiability at the true parameters, with these of the tendons estimated too."""
    from surae.inference.least_squares.minimise import compress

    subject, trial = rich
    truth = dict(subject.parameters) | TENDON
    problem = make_problem([trial], "muscle-tendon", free=free, start=truth)
    rows = Residuals(problem).rows(problem.start).copy()
    sse = float(rows[-1] @ rows[-1])
    R, _, _ = compress(rows)
    fit = fit_problem(problem, starts=1)
    values = dict(zip(problem.spec.names, problem.base.tolist(), strict=True))
    return identifiability(replace(fit, values=values, R=R, sse=sse))


def test_strain_and_toe_of_the_tibialis_tendon_are_hardly_separable(rich):
    strain = at_truth(rich, "dlt_tri", "dlt_tib").parameters
    toe = at_truth(rich, "pt_tri", "pt_tib").parameters
    both = at_truth(rich, *TENDON)
    # Relative standard errors as in section 3 of the models: 2–4 % and 4–9 % apart, 6–17 % and
    # 12–37 % together; the triceps a few times better.
    assert 0.015 < strain["dlt_tib"].uncertainty < 0.05
    assert 0.035 < toe["pt_tib"].uncertainty < 0.10
    assert 0.06 < both.parameters["dlt_tib"].uncertainty < 0.17
    assert 0.12 < both.parameters["pt_tib"].uncertainty < 0.37
    for name, alone in (("dlt_tri", strain), ("pt_tri", toe)):
        tibialis = name.replace("tri", "tib")
        assert alone[name].uncertainty < 0.5 * alone[tibialis].uncertainty
        assert both.parameters[name].uncertainty < 0.3 * both.parameters[tibialis].uncertainty
    weakest = both.directions[0]
    assert {"dlt_tib", "pt_tib"} <= set(weakest.changes)
    assert weakest.changes["dlt_tib"] * weakest.changes["pt_tib"] < 0
    assert weakest.words.endswith("nearly the same torque")
    for name, other in (("dlt_tib", "pt_tib"), ("pt_tib", "dlt_tib")):
        assert both.parameters[name].partners[0] == other
        assert "past the toe" in both.parameters[name].advice
