"""What arms and paths make unsure is in every uncertainty, and in nothing that they do not move."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import surae
from ankle_legs.make import make, truth_of
from richer_legs import richer_leg
from surae.base.normal import NORMAL
from surae.inference import Verdict, assess, make_problem, solve
from surae.inference.judging.assessment import _with_geometry
from surae.inference.posterior.empirical_bayes import BEGIN
from surae.inference.posterior.family import Family
from surae.inference.posterior.valleys import white_noise
from surae.measures.points import evaluate, points
from surae.model import ModelOptions
from surae.model.knowledge import Knowledge
from surae.model.laboratory import group_of
from surae.model.source_table import ARM_SIZE, GEAR, GEAR_OF_TABLE
from surae.model.statements import StatedArm
from surae.model.symmetry import with_paths

EXACT = {"arm": (0.0, 0.0)}
INVARIANT = ("passive_exponent", "active_width", "tendon_rotational", "torque_gain", "maximal")
MUSCLE = ("k_tri", "k_tib", "x0_tri", "x0_tib", "l0_tri", "l0_tib", "dlt_tri", "g1", "g3")
ELSE = ("m", "tau_rel", "k_rel", "f0", "beta")


@pytest.fixture(scope="module")
def inputs():
    return richer_leg(0, rate_hz=64.0, duration=20.0).inputs


@pytest.fixture(scope="module")
def auto(inputs):
    return solve(make_problem([inputs], "auto"))


@pytest.fixture(scope="module")
def known(auto):
    return assess(auto).uncertainty


def with_settings(result, **changes):
    settings = result.problem.settings
    settings = replace(settings, estimator=replace(settings.estimator, **changes))
    return replace(result, problem=replace(result.problem, settings=settings))


def test_intervals_of_muscles_widen_about_the_gears_mean(auto) -> None:
    wide = assess(auto)
    plain = assess(with_settings(auto, nuisances=EXACT))
    assert plain.uncertainty.geometry is None
    for name in ELSE:
        assert wide.parameters[name].ci95 == pytest.approx(plain.parameters[name].ci95, rel=1e-9)
    for name in MUSCLE:
        own = np.diff(np.log(plain.parameters[name].ci95)) / (2.0 * NORMAL)
        all_in = np.diff(np.log(wide.parameters[name].ci95)) / (2.0 * NORMAL)
        more = ARM_SIZE if name.startswith("g") else np.hypot(GEAR.sd, ARM_SIZE)
        if name[:2] not in ("x0", "dl"):  # λ moves these too, and x0 has a scale of its own
            assert all_in == pytest.approx(np.hypot(own, more), rel=0.02), name
        assert wide.parameters[name].verdict is not Verdict.IDENTIFIED
        assert wide.parameters[name].value == plain.parameters[name].value
        low, high = plain.parameters[name].ci95  # as the fit's own arm and path have it
        assert wide.parameters[name].ci95[0] <= low * (1.0 + 1e-9)
        assert wide.parameters[name].ci95[1] >= high * (1.0 - 1e-9)
    # about the mean of what the gear may be: the thesis's triceps travels 0.36 of its arm
    middle = np.mean(np.log(wide.parameters["l0_tri"].ci95))
    gear = 1.67 * 0.0104 / 0.0480
    value = wide.parameters["l0_tri"].value
    assert middle == pytest.approx(np.log(value) + GEAR.mean - np.log(gear), abs=0.01)


def test_another_trial_has_the_same_arms_and_paths(auto) -> None:
    wide, plain = assess(auto), assess(with_settings(auto, nuisances=EXACT))
    for name in (*MUSCLE, *ELSE):
        one, other = wide.parameters[name], plain.parameters[name]
        assert one.repeatable is other.repeatable
        assert np.diff(one.ci95_repeat) == pytest.approx(np.diff(other.ci95_repeat), rel=0.05)
        total, session, _ = wide.uncertainty.deviations(wide.uncertainty.along(name))
        before, same, _ = plain.uncertainty.deviations(plain.uncertainty.along(name))
        assert session == pytest.approx(same, rel=1e-9)
        assert (total > 1.001 * before) is (name in MUSCLE)


def test_budget_says_what_it_rests_on(auto) -> None:
    p = assess(auto).parameters["l0_tri"]
    assert sum(p.budget.values()) == pytest.approx(1.0)
    assert p.budget["path_size"] > 0.8
    assert "of which arms and paths" in p.note
    assert "film the muscle" in p.note
    assert "state this person’s own arm" in assess(auto).parameters["g1"].note


def test_measures_do_not_move_but_for_tendons_and_slack(auto, known) -> None:
    wanted = points()
    moving = set()
    for each in evaluate(auto, known, wanted):
        if each.value is None or each.missing:
            continue
        for scale in known.geometry.by:
            slope = each.gradient[known.names.index(scale)]
            if abs(slope) > 1e-4 * max(abs(each.value), 1e-3):
                moving.add(each.point.definition.name.rsplit("_", 1)[0])
    assert moving == {
        "slack_angle",
        "slack_before_end",
        "tendon_stiffness",
        "tendon_secant",
        "tendon_strain",
    }


def test_every_leg_that_is_drawn_has_the_torque_of_one_with_assumed_arms(auto, known) -> None:
    away = known.away(6, seed=2)
    spec = with_paths(auto.problem.spec)
    simulator = spec.simulator(auto.problem.inputs[0], auto.problem.options)
    start = {**dict.fromkeys(spec.names, 0.0), **auto.values}

    def torque(row):
        values = start | dict(zip(known.names, row.tolist(), strict=True))
        return simulator.torque(np.array([values[name] for name in spec.names]))

    at_assumed = known.at(away)
    for scale in known.geometry.by:
        at_assumed[:, known.names.index(scale)] = auto.values.get(scale, 0.0)
    for moved, still in zip(known.legs_at(away), at_assumed, strict=True):
        assert not np.allclose(moved, still)
        assert torque(moved) == pytest.approx(torque(still), abs=1e-9)


def test_draws_are_as_wide_as_intervals(auto, known) -> None:
    legs = known.draw(4000, seed=3)
    for name in ("k_tri", "l0_tri", "g1", "l0_tib"):
        ends = np.percentile(legs[:, known.names.index(name)], [2.5, 97.5])
        assert np.log(ends) == pytest.approx(np.log(assess(auto).parameters[name].ci95), abs=0.08)
    # the gear is what is known: path and arm go together
    arm, path = (legs[:, known.names.index(f"{of}_tri")] for of in ("arm_scale", "path_scale"))
    told = ARM_SIZE / np.hypot(ARM_SIZE, GEAR.sd)
    assert np.corrcoef(arm, path)[0, 1] == pytest.approx(told, abs=0.05)
    assert np.std(path - arm) == pytest.approx(GEAR.sd, rel=0.05)


def test_the_order_of_parameters_changes_no_draw(known) -> None:
    order = np.random.default_rng(0).permutation(len(known.names))
    fields = ("values", "lower", "upper", "origin", "shift", "dof")
    other = replace(
        known,
        names=tuple(known.names[j] for j in order),
        **{name: getattr(known, name)[order] for name in fields},
        rows={source: by[:, order] for source, by in known.rows.items()},
    )
    one, two = known.draw(20, seed=5), other.draw(20, seed=5)
    assert one[:, order] == pytest.approx(two, rel=1e-6, abs=1e-9)


def test_another_seed_or_order_changes_no_verdict(auto, monkeypatch) -> None:
    from surae.measures import bent, compute

    def verdicts(seed):
        monkeypatch.setattr(bent, "_SEED", seed)
        compute.judged_measures.cache_clear()
        fit = surae.Fit(auto, assess(auto))
        return {name: m.verdict for name, m in fit.measures().items()}

    before = verdicts(7)
    assert len(before) > 60
    for seed in (1, 2, 3):
        assert verdicts(seed) == before


def arms_of(inputs, model="muscle", **given):
    if model == "muscle":
        given["starts"] = 1
    return assess(solve(make_problem([inputs], model, **given))).uncertainty.geometry


def test_what_is_stated_of_arm_or_path_takes_its_place(inputs) -> None:
    knowledge = Knowledge(arm_tri_mm=StatedArm(value=52.0, sd=1.0))
    known = arms_of(inputs, knowledge=knowledge)
    tri, tib = known.rows["arm_size"]
    assert known.centre["arm_scale_tri"] == pytest.approx(np.log(52.0 / 48.0))
    assert tri["arm_scale_tri"] == pytest.approx(np.hypot(1.0, 4.0) / 52.0)
    assert tib["arm_scale_tib"] == ARM_SIZE
    # the gear is as unknown as before: the path goes with the arm
    usual = arms_of(inputs)
    assert known.rows["path_size"] == usual.rows["path_size"]
    more = known.centre["path_scale_tri"] - usual.centre["path_scale_tri"]
    assert more == pytest.approx(np.log(52.0 / 48.0))
    small = arms_of(inputs, knowledge=Knowledge(height_cm=160.0))
    assert small.centre["arm_scale_tib"] == pytest.approx(np.log(160.0 / 175.0))
    path = arms_of(inputs, "auto", nuisances={"path_scale_tri": (0.1, 0.02)})
    assert path.centre["path_scale_tri"] == 0.1
    assert {"path_scale_tri": 0.02} in path.rows["path_size"]


def test_a_persons_own_table_tells_the_path_but_for_pennation(
    inputs, tmp_path, monkeypatch
) -> None:
    angle = np.radians(np.linspace(-60.0, 40.0, 41))
    rows = ["angle_deg,length_tri_m,arm_tri_m,length_tib_m,arm_tib_m"]
    for a in angle:
        tri = 0.45 + 0.05 * a
        rows.append(f"{np.degrees(a)},{tri},0.05,{0.30 - 0.04 * a},0.04")
    path = tmp_path / "person.csv"
    path.write_text("\n".join(rows), encoding="utf-8")
    generic = arms_of(inputs, geometry=str(path))
    # of auto alone may be said whose it is; there departures of arms and paths are sampled too
    monkeypatch.setattr("surae.inference.uncertainty.arms_and_paths._is_own", lambda _: True)
    known = arms_of(inputs, geometry=str(path))
    assert known.centre["path_scale_tri"] == pytest.approx(0.0, abs=1e-9)
    assert known.rows["path_size"][0] == {"path_scale_tri": GEAR_OF_TABLE}
    assert generic.centre["path_scale_tri"] == pytest.approx(GEAR.mean, abs=1e-9)


def test_a_model_tied_to_the_assumed_path_tells_no_muscle_values(inputs) -> None:
    found = assess(solve(make_problem([inputs], "muscle-2010", starts=1)))
    for name in ("k_tri", "x0_tri", "e1"):
        p = found.parameters[name]
        assert p.ci95 is None
        assert p.verdict is Verdict.UNDETERMINED
        assert "ties the muscle to the assumed arm and path" in p.note
    assert found.parameters["f"].ci95 is not None


def test_saved_fits_are_judged_anew(inputs, tmp_path) -> None:
    fit = surae.fit(surae.example(), model="muscle", starts=1)
    fit.save(tmp_path / "fit.json")
    assert surae.load(tmp_path / "fit.json").assessment.uncertainty == fit.assessment.uncertainty


def test_profiles_and_posteriors_know_arms_and_paths_too() -> None:
    fit = surae.fit(surae.example(), model="muscle", starts=1)
    profiled = surae.profile(fit, ["l0_tri", "f0"])
    low, high = profiled["l0_tri"].interval
    least, most = profiled["l0_tri"].with_geometry
    assert np.log(most / least) == pytest.approx(
        np.hypot(np.log(high / low), 2 * NORMAL * np.hypot(GEAR.sd, ARM_SIZE)), rel=0.02
    )
    assert profiled["f0"].with_geometry is None
    drawn = surae.posterior(fit, draws=2000, seed=1)
    at_fit = np.log(fit["l0_tri"].ci95)
    assert np.log(drawn["l0_tri"].ci95) == pytest.approx(at_fit, abs=0.1)
    assert drawn["l0_tri"].from_covariance == pytest.approx(fit["l0_tri"].ci95, rel=0.1)
    # stiffness and length go against each other along the path, and the torque is the same
    k, l0 = np.log(drawn.of("k_tri")), np.log(drawn.of("l0_tri"))
    assert np.corrcoef(k, l0)[0, 1] < -0.9
    assert np.std(k + l0) < 0.2 * np.std(k)


def beliefs_of(inputs, **settings):
    problem = make_problem([inputs], "auto", **settings)
    return Family(problem).posterior(("bend",), 64.0, white_noise(problem, 0.05), BEGIN).beliefs


def test_a_path_is_thought_to_bend_as_its_arm_unless_somebody_says_otherwise(inputs) -> None:
    usual = beliefs_of(inputs)
    assert usual["path_bend_tri"].mean == pytest.approx(-0.00188, rel=1e-2)
    assert usual["path_bend_tib"].mean == pytest.approx(-0.00580, rel=1e-2)
    assert "arm_scale_tri" not in usual  # a departure of its own
    stated = beliefs_of(inputs, nuisances={"bend": (0.001, 0.002)})
    assert (stated["path_bend_tri"].mean, stated["path_bend_tri"].sd) == (0.001, 0.002)


def test_lengths_on_a_tendons_path_are_as_unsure_as_the_share_that_fascicles_have(inputs) -> None:
    options = ModelOptions(geometry="virtual-work")
    far = beliefs_of(inputs, options=options)
    assert far["length_zero_tri"].sd == pytest.approx(0.33 * options.x_ref_tri)
    assert far["path_bend_tri"].mean == 0.0  # it bends as its arm already
    assert beliefs_of(inputs)["length_zero_tri"].sd == 0.005
    stated = {"length_zero_tri": (0.0, 0.004)}
    assert beliefs_of(inputs, options=options, nuisances=stated)["length_zero_tri"].sd == 0.004


@pytest.mark.slow
@pytest.mark.parametrize(("family", "departs"), [("va", set()), ("vd", {"bend"}), ("f", {"arm"})])
def test_paths_that_work_need_no_other_arms(tmp_path, family, departs) -> None:
    """Legs by another author: paths of equation (9), paths that work, other arms."""
    (path,) = make(family, 3101, tmp_path, (1,))
    fit = surae.fit(path, quality=())
    there = {group_of(name) for name in fit.result.posterior.beliefs}
    assert departs <= there
    assert family == "f" or "arm" not in there
    truth = truth_of(family, 3101, 1)["measures"]
    claimed = {n: m for n, m in fit.measures().items() if m.verdict is Verdict.IDENTIFIED}
    invariants = [n for n in claimed if n.startswith(INVARIANT) and truth.get(n) is not None]
    assert family == "f" or len(invariants) >= 3
    for name in invariants:
        assert claimed[name].ci95[0] <= truth[name] <= claimed[name].ci95[1], name


@pytest.mark.parametrize("half", [1e200, math.inf])
def test_what_the_data_leave_boundless_stays_so(half) -> None:
    """A passive trial tells nothing of a gain: the square of such a half-width is no number."""
    geometry = SimpleNamespace(moves=lambda _: True, sd=lambda _: 0.3, about=lambda *_: None)
    known = SimpleNamespace(names=("g1",), values=np.array([1e5]), geometry=geometry)
    assert _with_geometry("g1", known, half, 0.0) == ((0.0, 1e5 + half), half, half)
