"""What a fit knows is one thing: every door tells the same number, and each is what it says."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import surae
from richer_legs import richer_leg
from surae.base.formatting import estimate
from surae.base.normal import NORMAL
from surae.inference import assess, make_problem, solve
from surae.inference.identifiability.identified import identifiability
from surae.inference.least_squares.residuals import simulators
from surae.inference.uncertainty.combined import combined
from surae.measures.points import evaluate, points
from surae.model.source_table import SOURCES
from surae.planning.legs import fit_legs
from surae.report.parameters import parameters_section
from surae.report.provenance import fit_settings


@pytest.fixture(scope="module")
def auto():
    """The fit of a leg that no named model is."""
    return solve(make_problem([richer_leg(0, rate_hz=64.0, duration=20.0).inputs], "auto"))


@pytest.fixture(scope="module")
def fit(auto):
    return surae.Fit(auto, assess(auto, alternatives=True))


def torque_of(result, **changed):
    (simulator,) = simulators(result.problem)
    values = np.array([changed.get(n, result.values[n]) for n in result.problem.spec.names])
    return simulator.torque(values)


def test_influence_of_auto_is_what_the_torque_does(auto) -> None:
    """δ of Brun et al. (2001), by differences of the torque itself."""
    found = identifiability(auto).parameters
    size = float(np.sqrt(np.mean(auto.problem.inputs[0].torque ** 2)))
    for name in ("k_tri", "l0_tri", "m", "tau_rel", "g2"):
        value = auto.values[name]
        ends = (torque_of(auto, **{name: value * by}) for by in (1.0 + 1e-5, 1.0 - 1e-5))
        slope = np.subtract(*ends) / 2e-5
        told = float(np.sqrt(np.mean(slope**2))) / size
        assert found[name].sensitivity == pytest.approx(told, rel=0.02), name


@pytest.mark.parametrize("name", ["k_tri", "dlt_tri", "tau_rel"])
def test_a_leg_is_asked_through_every_door_and_one_number_comes(fit, tmp_path, name) -> None:
    p, known = fit.parameters[name], fit.assessment.uncertainty
    half = NORMAL * p.sem
    assert known.half_width(known.along(name)) == pytest.approx(half)
    assert NORMAL * known.covariance(name)[0, 0] ** 0.5 == pytest.approx(half)
    # draws, those of ArviZ and of plans, have the same ends
    drawn = known.draw(4000, seed=1)[:, known.names.index(name)]
    assert np.percentile(drawn, [2.5, 97.5]) == pytest.approx(p.ci95, abs=0.1 * half)
    tree = fit.to_inference_data(4000, seed=1)
    np.testing.assert_array_equal(tree["posterior"][name].values.ravel(), drawn)
    legs = fit_legs(fit, 400)
    own = legs.values[1:, legs.spec.names.index(name)]
    if half < 0.5 * p.value:
        assert np.percentile(own, [2.5, 97.5]) == pytest.approx(p.ci95, abs=0.25 * half)
    # what a plan begins with
    told = surae.expect("sine", fit=fit, legs=2).parameters[name]
    assert told.now == pytest.approx(half / p.value, rel=0.02)
    assert told.half_width <= told.now * (1 + 1e-9)
    # the file, and what is read of it
    fit.save(tmp_path / "fit.json")
    again = surae.load(tmp_path / "fit.json")
    assert again.parameters[name] == p
    assert again.assessment.uncertainty == known
    assert not again.assessment.differs


def test_a_measure_is_as_unsure_as_the_parameters_it_is_made_of(fit) -> None:
    known, name = fit.assessment.uncertainty, "activation_half_time"
    (found,) = evaluate(fit.result, known, [p for p in points() if p.name == name])
    V, told = known.covariance(), fit.measures()[name]
    variance = float(found.gradient @ V @ found.gradient)
    shares = known.variances(found.gradient)
    assert sum(shares.values()) == pytest.approx(variance)
    assert set(shares) <= set(SOURCES)
    ends = np.percentile(
        [p.value(leg)[0] for p in points() if p.name == name for leg in legs_of(fit)], [2.5, 97.5]
    )
    assert told.ci95 == pytest.approx(ends, abs=0.2 * np.ptp(ends))


def legs_of(fit):
    from surae.measures.fitted_leg import leg_of

    known = fit.assessment.uncertainty
    for drawn in known.draw(600, seed=3):
        yield leg_of(fit.result).with_values(dict(zip(known.names, drawn.tolist(), strict=True)))


@pytest.mark.slow
def test_a_named_model_that_the_data_contradict_is_as_unsure_in_its_measures() -> None:
    """An interval that reaches to where a better model is does so of measures too."""
    inputs = richer_leg(1, rate_hz=64.0, duration=20.0).inputs
    result = solve(make_problem([inputs], "muscle", starts=1))
    plain, held = assess(result), assess(result, alternatives=True)
    known = held.uncertainty
    assert np.any(known.shift)
    for name, p in held.parameters.items():
        if p.ci95 and not known.goes_with_geometry(name):
            half = p.ci95[1] - p.value  # the lower end stops at nought
            assert known.half_width(known.along(name)) == pytest.approx(half)
    wider = surae.Fit(result, held).measures()
    for name, m in surae.Fit(result, plain).measures().items():
        if m.ci95 and wider[name].ci95 and m.method == wider[name].method == "linear":
            assert np.ptp(wider[name].ci95) >= np.ptp(m.ci95) * (1 - 1e-9)


def test_the_report_has_the_numbers_of_the_fit(fit) -> None:
    text = str(parameters_section(fit, next_anchor=""))
    p = fit.parameters["k_tri"]
    assert estimate(p.value, p.trusted_sem, p.ci95).interval in text
    told = dict(fit_settings(fit.result))
    assert any(key.startswith("Search ") for key in told)
    assert told["Starts"].endswith("seed 0")


def test_draws_are_within_bounds_and_each_has_its_opposite(fit) -> None:
    known = fit.assessment.uncertainty.at_assumed  # another arm or path may take them beyond
    drawn = known.draw(11, seed=4)
    assert drawn.shape == (11, len(known.names))
    assert np.all(drawn >= np.minimum(known.lower, known.values) - 1e-12)
    assert np.all(drawn <= np.maximum(known.upper, known.values) + 1e-12)
    away = replace(known, lower=np.full_like(known.lower, -np.inf), upper=known.upper + np.inf)
    one, *_, other = away.draw(2, seed=4)
    straight = np.isnan(known.origin)
    assert (one + other)[straight] == pytest.approx(2.0 * known.values[straight])


def test_a_parameter_moves_with_the_zero_and_a_measure_at_an_angle_has_its_own(auto) -> None:
    """What a zero that is off makes of a parameter is in its interval, and in no measure twice."""
    solution = replace(auto.solution, turned={"x0_tri": 0.02})
    known = combined(replace(auto, solution=solution), solution.spread)
    before = combined(replace(auto, solution=replace(auto.solution, turned={})), solution.spread)
    assert "g1" in auto.solution.turned  # of a fit of which nobody stated a zero
    zero = np.radians(auto.problem.settings.zero_sd)
    wider = known.variances(known.along("x0_tri"))["angle_zero"]
    assert wider == pytest.approx((0.02 * zero) ** 2)
    assert known.sd(known.along("x0_tri")) > before.sd(before.along("x0_tri"))
    assert known.sd(known.along("l0_tri")) == before.sd(before.along("l0_tri"))
    assert np.array_equal(known.covariance(), before.covariance())


def test_the_decision_names_every_module_that_makes_or_asks_it() -> None:
    decision = Path(__file__).parents[2] / "docs/decisions/0021-one-uncertainty.md"
    told = set(re.findall(r"`([a-z_]+(?:\.[a-z_]+)+)`", decision.read_text(encoding="utf-8")))
    asks = re.compile(r"assessment\.uncertainty|uncertainty\.combined import [^\n]*Uncertainty")
    made = re.compile(r"= combined\(|replace\(known, rows=")
    asking = set()
    folder = Path(surae.__file__).parent
    for path in folder.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if asks.search(text) or made.search(text):
            asking.add(".".join(path.relative_to(folder).with_suffix("").parts))
    assert len(asking) > 12
    assert asking <= told
