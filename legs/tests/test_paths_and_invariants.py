"""Paths that do work do it, and invariants are what no arm and no path changes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, simpson
from scipy.optimize import brentq

from ankle_legs import last_relaxed, paths
from ankle_legs.invariants import invariants
from ankle_legs.make import PATHS, leg, truth_of
from ankle_legs.measures import measures
from ankle_legs.muscle import integrate, static_force, tendon_force
from ankle_legs.paths import ARM_SD, FAMILIES, GEARS, Way, geared
from ankle_legs.subject import Geometry, Subject, draw

RANGE = (-0.6, 0.4)
ACTIVE = (900.0, 400.0)


def subject(seed: int = 3, *, tendons: bool = True) -> Subject:
    return draw(np.random.default_rng(seed), "healthy", tendons=tendons)


def read(one: Subject, gains: tuple[float, ...] = (1e6, 1e6, 1.5e6, 1.2e6)) -> dict[str, float]:
    return invariants(one, gains, RANGE, ACTIVE)  # type: ignore[return-value]


@pytest.mark.parametrize("tendons", [False, True])
@pytest.mark.parametrize("gear", [0.4, 1.0])
def test_the_joints_work_is_the_muscles_and_tendons_work(gear: float, *, tendons: bool) -> None:
    """From one angle to another, all elastic and relaxed; a gear's share of it travels."""
    one = geared(subject(tendons=tendons), Geometry().arms, np.full(2, gear))
    angle = np.linspace(-0.5, 0.35, 401)
    path, arm = one.geometry.path(angle), one.geometry.arm(angle)
    for i, muscle in enumerate(one.muscles()):
        pull = np.array([static_force(muscle, p, 0.0) for p in path[i]])
        work = (1, -1)[i] * simpson(pull[:, 0] * arm[i], x=angle)
        stored = quad(
            lambda x, m=muscle: np.exp(m.k * (x - m.x0)) / (1 + m.k_rel),
            *pull[[0, -1], 1],
            epsrel=1e-10,
        )[0]
        if tendons:
            c, ends = muscle.constants(), (path[i] - pull[:, 1])[[0, -1]]
            stored += quad(lambda e, c=c: tendon_force(e, c)[0], *ends, epsrel=1e-10)[0]
        assert gear * work == pytest.approx(stored, rel=1e-6)


def test_the_thesis_path_does_not_conserve_work() -> None:
    one = subject(tendons=False)
    near = np.array([-1e-4, 1e-4])
    slopes = np.diff(one.geometry.path(near)) / 2e-4
    arms = one.geometry.arm(np.zeros(1))
    assert slopes[0, 0] / arms[0, 0] == pytest.approx(0.362, abs=0.001)
    assert -slopes[1, 0] / arms[1, 0] == pytest.approx(0.679, abs=0.001)


def test_force_against_arm_and_metre_against_path_change_no_torque_and_no_invariant() -> None:
    one, angle = subject(), np.linspace(*RANGE, 30)
    flat = replace(one.geometry, paths=one.geometry.paths * np.array([1.0, 1.0, 0.0]))
    one = replace(one, geometry=flat)
    before, torque = read(one), one.passive_torque(angle)
    v = one.values
    longer = replace(  # metre against path
        one.with_values(
            **{
                f"{name}_{g}": v[f"{name}_{g}"] * 1.7 ** (-1 if name == "k" else 1)
                for name in ("k", "x0", "l0", "dlt")
                for g in ("tri", "tib")
            }
        ),
        geometry=replace(flat, paths=1.7 * flat.paths),
    )
    np.testing.assert_allclose(longer.passive_torque(angle), torque, rtol=1e-9)
    after = read(longer)
    for name, value in before.items():
        assert after[name] == pytest.approx(value, rel=1e-6), name
    share = 1.12  # force against arm; the tendon's curve goes along with its force
    weaker = replace(
        one.with_values(
            **{f"x0_{g}": v[f"x0_{g}"] + np.log(share) / v[f"k_{g}"] for g in ("tri", "tib")}
        ),
        geometry=replace(flat, arms=share * flat.arms),
    ).shaped([{"f_max": m.f_max / share} for m in one.muscles()])
    np.testing.assert_allclose(weaker.passive_torque(angle), torque, rtol=1e-9)
    gains = tuple(g / share for g in (1e6, 1e6, 1.5e6, 1.2e6))
    less = invariants(weaker, gains, RANGE, (ACTIVE[0] / share, ACTIVE[1] / share))
    for name, value in before.items():
        assert less[name] == pytest.approx(value, rel=1e-6), name


def test_invariants_are_what_an_experiment_reads() -> None:
    one = leg("vd", 3).subject
    found, zero = read(one), np.zeros(1)
    arms = one.geometry.arm(zero)[:, 0]
    for i, (group, muscle) in enumerate(zip(("tri", "tib"), one.muscles(), strict=True)):
        near = np.array([-1e-4, 1e-4])
        rigid = replace(muscle, dlt=0.0)
        pulls = [static_force(rigid, p, 0.0)[0] for p in one.geometry.path(near)[i]]
        grows = abs(np.log(pulls[1] / pulls[0])) / 2e-4
        assert found[f"passive_exponent_{group}"] == pytest.approx(grows, rel=1e-5)
        # force over length falls to 1/e where the path has gone one width from the optimum
        slope = abs(float(np.diff(one.geometry.path(near)[i])[0])) / 2e-4
        away = np.radians(found[f"active_width_{group}"]) * slope
        lone = replace(rigid, x0=10.0)
        lift = static_force(lone, muscle.l0 + away, 1.0)[0] / static_force(lone, muscle.l0, 1.0)[0]
        assert lift == pytest.approx(np.exp(-1), rel=1e-6)
        # the fibre held at its length, the tendon alone gives
        at = {"tri": 25, "tib": 4}[group]
        c = muscle.constants()
        stretch = brentq(lambda e, c=c: tendon_force(e, c)[0] * arms[i] - at, 0, 0.3)  # noqa: B023
        turned = [
            arms[i] * tendon_force(stretch + s * slope * np.radians(0.01), c)[0] for s in (-1, 1)
        ]
        name = f"tendon_rotational_stiffness_{group}@{at}Nm"
        assert found[name] == pytest.approx((turned[1] - turned[0]) / 0.02, rel=1e-5)
        length = static_force(muscle, float(one.geometry.path(zero)[i, 0]), 0.0)[1]
        turn = np.degrees((length - muscle.l0) / slope)
        assert found[f"working_point_{group}"] == pytest.approx(turn)
        best = 0.0
        for angle in np.linspace(*RANGE, 21):  # held for long at each angle, with and without
            path, arm = (f(np.array([angle]))[i, 0] for f in (one.geometry.path, one.geometry.arm))
            ones = np.ones(4000)
            added = [
                integrate(5e-3, path * ones, a * ones, ones, 0 * ones, c)[1][-1]
                for a in (ACTIVE[i], 0.0)
            ]
            best = max(best, arm * (added[0] - added[1]))
        assert found[f"maximal_torque_{group}"] == pytest.approx(best, rel=0.01)
    assert found["torque_gain_sol"] == pytest.approx(1.5e6 * arms[0])
    assert found["torque_gain_ta"] == pytest.approx(1e6 * arms[1])


def test_what_has_no_true_value_says_why() -> None:
    rigid = truth_of("p", next(s for s in range(9) if leg("p", s).rigid), 1)
    assert rigid["measures"]["tendon_rotational_stiffness_tri@25Nm"] is None
    assert "rigid" in rigid["unscored"]["tendon_rotational_stiffness_tri"]
    assert truth_of("b", 1, 1)["measures"]["torque_gain_sol"] is None
    assert truth_of("v", 1, 1)["measures"]["passive_exponent_tri"] is None
    assert truth_of("v", 1, 1)["measures"]["passive_exponent_tib"] > 0
    assert truth_of("d", 1, 1)["measures"]["active_width_tri"] is None
    passive = truth_of("vd", 1, 1, ("passive",))["measures"]
    assert passive["maximal_torque_tri"] is None


def test_arms_and_gears_are_spread_as_people_are() -> None:
    rng = np.random.default_rng(5)
    arms = np.array([paths.own_arms(rng, ARM_SD)[:, 0] for _ in range(2000)])
    spread = np.std(np.log(arms), axis=0)
    np.testing.assert_allclose(spread, ARM_SD, rtol=0.08)
    gears = []
    for seed in range(60):
        one = leg("vd", seed).subject
        near = np.array([-1e-4, 1e-4])
        slopes = np.abs(np.diff(one.geometry.path(near))[:, 0]) / 2e-4
        gears += list(slopes / one.geometry.arm(np.zeros(1))[:, 0])
        at_10 = float(one.passive_torque(np.radians([10.0]))[0])
        assert 1.5 <= at_10 <= 19
        assert float(one.passive_torque(np.array([one.range[1]]))[0]) < 27
        lengths = one.geometry.path(np.linspace(*one.range, 20))
        assert lengths.min() > 0.003
    assert GEARS[0] - 1e-6 <= min(gears) < 0.4
    assert 0.85 < max(gears) <= GEARS[1] + 1e-6
    assert np.median(gears) == pytest.approx(0.57, abs=0.08)


def test_a_virtual_work_leg_travels_as_its_arms_say_at_every_angle() -> None:
    geometry = leg("vc", 2).subject.geometry
    angle = np.linspace(-0.8, 0.6, 50)
    slopes = (geometry.path(angle + 1e-5) - geometry.path(angle - 1e-5)) / 2e-5
    np.testing.assert_allclose(slopes, geometry.arm(angle) * np.array([[1.0], [-1.0]]), rtol=1e-7)
    bent = geared(subject(), Geometry().arms, np.full(2, 0.5), (0.2, -0.2)).geometry
    slopes = (bent.path(angle + 1e-5) - bent.path(angle - 1e-5)) / 2e-5
    gears = 0.5 * np.array([1 + 0.2 * angle, -(1 - 0.2 * angle)])
    np.testing.assert_allclose(slopes, gears * bent.arm(angle), rtol=1e-6)


def test_textbook_arms_and_the_thesis_path_are_the_limit() -> None:
    one = subject()
    same = paths._subject(np.random.default_rng(1), one, Way(0.0, thesis=True))
    np.testing.assert_array_equal(same.geometry.arms, one.geometry.arms)
    np.testing.assert_array_equal(same.geometry.paths, one.geometry.paths)
    assert same.values == one.values
    own, other = (
        measures(s, (1.0, 1.0), np.zeros_like, lambda a, _: 0 * a, RANGE, ACTIVE)
        for s in (one, same)
    )
    assert own == other


@pytest.mark.parametrize("family", [*FAMILIES, *last_relaxed.PATHS])
def test_a_family_makes_the_same_leg_for_the_same_seed(family: str) -> None:
    one, again = leg(family, 3), leg(family, 3)
    made = one.columns(one.record(1, 8.0), 1)
    assert all(np.isfinite(column).all() for column in made.values())
    same = again.columns(again.record(1, 8.0), 1)
    np.testing.assert_array_equal(made["torque_Nm"], same["torque_Nm"])
    assert one.subject.values == again.subject.values
    assert family in PATHS


def test_a_laboratory_measures_arms_that_are_the_legs_own() -> None:
    from ankle_legs import laboratory

    made = laboratory.measure("vd", 2, ("geometry", "slow"))
    own = leg("vd", 2).subject.geometry.arm(np.zeros(1))[:, 0]
    np.testing.assert_allclose(made.table.arm(np.zeros(1))[:, 0], own, rtol=0.12)
