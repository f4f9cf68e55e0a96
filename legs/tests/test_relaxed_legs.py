"""Relaxed legs: their true curve is what doing the protocol reads, and each family does its own."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from ankle_legs.courses import COURSES
from ankle_legs.curve import Ankle, own_measures, shown_measures
from ankle_legs.handling import HeelLift, MovedZero, Play, Setup, SoftPlate, StretchReflex, Tone
from ankle_legs.leg import Leg
from ankle_legs.main import main
from ankle_legs.make import RELAXED, leg, truth_of
from ankle_legs.movement import fine_times
from ankle_legs.relaxed import CHANGES, FAMILIES, SLACKER, RelaxedLeg
from ankle_legs.tissue import Form, Tissue, Yielding

RANGE = (float(np.radians(-35.0)), float(np.radians(25.0)))


def exponential(**more: object) -> Tissue:
    """Tissue of the calf alone, without a muscle beside it."""
    form = Form("exponential", end=0.4, bend=0.2)
    none = {"other": form, "other_size": 0.0, "muscle": 1e-12}
    given = {"shares": np.array([0.3, 0.2]), "seconds": np.array([0.5, 4.0])}
    return Tissue(form=form, size=10.0, **{**none, **given, **more})  # type: ignore[arg-type]


def bare(one: Leg, *departures: object) -> Leg:
    """The muscles of a leg with these departures, simulated as any leg is."""
    return Leg(one.family, one.seed, one.subject, departures)  # type: ignore[arg-type]


def of(tissue: Tissue, **how: object) -> Ankle:
    subject = tissue.leg(leg("ra", 1).subject)
    return Ankle(subject, (tissue,), **how)  # type: ignore[arg-type]


@pytest.mark.parametrize("family", FAMILIES)
def test_a_family_departs_from_the_same_leg_without_it(family: str) -> None:
    one = leg(family, 5)
    seconds = 45.0 if family == "rj" else 20.0  # until what is fast begins
    run = one.record(1, seconds)
    made = one.columns(run, 1)
    assert all(np.isfinite(column).all() for column in made.values())
    assert np.abs(made["torque_Nm"]).max() < 60
    again = leg(family, 5)
    np.testing.assert_array_equal(again.record(1, seconds).torque, run.torque)
    plain = replace(one, departures=one.departures[:1])  # its tissue alone
    other = plain.record(1, seconds)
    if len(one.departures) > 1:
        far = np.std(run.torque - other.torque) + 50 * np.std(run.plate - other.plate)
        assert far + 50 * np.std(run.ankle - other.ankle) > 0.02


def test_no_departure_is_the_plain_leg() -> None:
    one = leg("ra", 2)
    flat = Form("exponential", end=0.4, bend=0.2)
    nothing = Tissue(flat, 0.0, flat, 0.0, np.zeros(2), np.ones(2), muscle=1.0)
    still = Setup(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01)
    rest = (Play(0.0, 0.0, 0.0), SoftPlate(0.0, 0.03), HeelLift(0.0, 5.0, 1.0), Tone(0.0, 0.1, 0.5))
    made = bare(one, still, nothing, *rest).record(1, 20.0, "bouts")
    plain = bare(one).record(1, 20.0, "bouts")
    np.testing.assert_allclose(made.torque, plain.torque, atol=1e-9)
    np.testing.assert_allclose(made.emg, plain.emg, atol=1e-15)
    yielding = Yielding(flat, 8.0, flat, 1.0, np.array([0.2]), np.ones(1), softens=0.0, grip=0.0)
    angle = 0.3 * np.sin(np.arange(4000) / 500)
    calm = Tissue(flat, 8.0, flat, 1.0, np.array([0.2]), np.ones(1))
    np.testing.assert_allclose(yielding.resist(angle, 0.01), calm.resist(angle, 0.01))


def test_the_slow_curve_of_an_exponential_is_what_mathematics_says() -> None:
    tissue = exponential()
    found = own_measures(of(tissue), RANGE)
    rate = np.radians(5.0) / 0.2  # by which the elastic torque grows [1/s]
    for degrees in (-10, 0, 10):
        seconds = (degrees + 30) / 5
        elastic = 10 * np.exp((np.radians(degrees) - 0.4) / 0.2)
        grows = rate + 1 / tissue.seconds
        more = tissue.shares * rate / grows * -np.expm1(-grows * seconds)
        assert found[f"passive_torque@{degrees}deg"] == pytest.approx(elastic, rel=1e-6)
        expected = elastic * (1 + more.sum())
        assert found[f"slow_torque@{degrees}deg"] == pytest.approx(expected, rel=1e-4)
        slope = np.radians(1.0) * elastic / 0.2
        assert found[f"passive_stiffness@{degrees}deg"] == pytest.approx(slope, rel=1e-4)
    at = np.degrees(0.4 + 0.2 * np.log(5 / 10))
    assert found["range_at_torque@5Nm"] == pytest.approx(at, abs=1e-3)
    stiff = found["stiffness_at_torque@5Nm"]
    assert stiff == pytest.approx(np.radians(1.0) * 5 / 0.2, rel=1e-3)
    share = 100 * np.sum(tissue.shares * -np.expm1(-10 / tissue.seconds)) / 1.5
    assert found["relaxed_share@10s"] == pytest.approx(share, rel=0.01)
    assert found["range_at_torque@15Nm"] is None  # 12 Nm at the end
    assert own_measures(of(tissue), (-0.6, 0.1))["range_at_torque@10Nm"] is None


def test_a_muscle_alone_has_the_curve_and_the_relaxation_that_it_has_anywhere() -> None:
    subject = leg("a", 3).subject
    subject = subject.with_values(dlt_tri=0.0, dlt_tib=0.0, x0_tib=0.2)
    found = own_measures(Ankle(subject, ()), RANGE)
    angle = np.radians([10.0])
    assert found["passive_torque@10deg"] == pytest.approx(subject.passive_torque(angle)[0])
    k_rel, tau = subject.values["k_rel"], subject.values["tau_rel"]
    share = 100 * k_rel / (1 + k_rel) * -np.expm1(-(1 + k_rel) * 10 / tau)
    assert found["relaxed_share@10s"] == pytest.approx(share, rel=0.02)


@pytest.mark.parametrize("family", ["rb", "rd", "re", "rf", "rl-3", "rl-5", "rl-7"])
def test_a_very_long_hold_reads_the_relaxed_torque(family: str) -> None:
    ankle = leg(family, 3).placed(1).ankle()
    step, angles = 0.05, np.radians([-10.0, 10.0, 20.0])
    for angle in angles:
        ramp = np.linspace(np.radians(-30), angle, 100)
        course = np.concatenate([ramp, np.full(round(1500 / step), angle)])
        held = ankle.glide(course, step)[-1]
        assert held == pytest.approx(ankle.still(np.array([angle]))[0], abs=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["rb", "rc", "rd", "rl-2"])
def test_a_recorded_ladder_of_long_holds_reads_the_true_curve(family: str) -> None:
    one = leg(family, 4)
    run = bare(one, one.departures[0]).record(1, 400.0, "ladder")
    still = np.flatnonzero(np.abs(np.diff(run.plate)) < 1e-12)
    last = still[np.flatnonzero(np.diff(still) > 1)]
    weight = one.subject.values["m"] * 9.81 * 0.15 * np.cos(run.ankle[last])
    truth = Ankle(one.lasting(one.subject), (one.departures[0],)).still(run.ankle[last])
    assert last.size >= 5
    np.testing.assert_allclose(run.torque[last] - weight, truth, atol=0.8)  # muscles' resting EMG


def test_forms_are_what_they_are_called() -> None:
    angle = np.linspace(-0.7, 0.4, 500)
    toe = Form("toe", end=0.4, bend=0.02, slack=0.1)(angle)
    assert toe[angle < 0].max() < 0.01
    bent = Form("linear-quadratic", end=0.4, bend=0.2, slack=0.0)(angle)
    slopes = np.diff(bent)
    assert np.ptp(slopes[angle[1:] > 0.22]) < 1e-9
    assert np.all(slopes[angle[1:] < 0] == 0)
    stop = Form("capsule", end=0.4, bend=0.4, slack=0.28, stop=0.04)(angle)
    assert np.diff(stop)[-1] > 10 * np.diff(stop)[angle[1:] < 0.27][-1]
    for form in (toe, bent, stop):
        assert form[-1] == pytest.approx(1.0)
        assert np.all(np.diff(form) >= 0)
    with pytest.raises(ValueError, match="no form 'round'"):
        Form("round", end=0.4, bend=0.1)(angle)


def test_the_devices_angle_has_its_zero_and_what_yields_in_it() -> None:
    tissue, turned = exponential(), float(np.radians(2.0))
    own = own_measures(of(tissue), RANGE)
    off = shown_measures(of(tissue, turned=turned), RANGE)
    grown = np.exp(-turned / 0.2)
    assert off["passive_torque@10deg"] == pytest.approx(own["passive_torque@10deg"] * grown)
    play = shown_measures(of(tissue, between=(Play(2.0, 0.3, 2.0),)), RANGE)
    late = np.exp(-np.radians(1.0) / 0.2)
    assert play["slow_torque@10deg"] == pytest.approx(own["slow_torque@10deg"] * late, rel=2e-3)
    expected = own["passive_torque@10deg"] * late  # its torque presses it to one flank
    assert play["passive_torque@10deg"] == pytest.approx(expected, rel=1e-3)
    elastic = exponential(shares=np.zeros(2))
    for gap in (Play(2.0, 0.0, 0.0), Play(2.0, 0.0, 1.0)):  # gives back what was put in
        lost = shown_measures(of(elastic, between=(gap,)), RANGE)["hysteresis"]
        assert lost == pytest.approx(0.0, abs=0.05)
    for lift in (HeelLift(4.0, 3.0, 1.0), SoftPlate(3.0, 0.03)):
        ankle = of(tissue, between=(lift,))

        def beyond(angle: float, lift=lift, ankle=ankle) -> float:
            given = lift.gives_still(ankle.still(np.array([angle])))[0]
            return float(angle + given - np.radians(20.0))

        angle = brentq(beyond, -0.5, 0.5)
        read = ankle.still_shown(np.radians([20.0]))[0]
        assert read == pytest.approx(ankle.still(np.array([angle]))[0], rel=1e-4)
        assert read < of(tissue).still(np.radians([20.0]))[0]


def test_what_lies_between_is_settled_in_a_record_as_in_the_truth() -> None:
    one = leg("rh", 6)
    placed = one.placed(1)
    run = one.record(1, 20.0)
    lift = placed.ankle().between[0]
    joint = run.joint + run.arm[0] * run.force[0] - run.arm[1] * run.force[1]
    given = lift.gives(run.plate, joint, run.step)
    shown = run.ankle + placed.departures[0].zero() + given
    np.testing.assert_allclose(shown, run.plate, atol=2e-4)
    free = 0.0 * joint
    gap = Play(2.0, 1.0, 0.0)
    given = np.degrees(gap.gives(run.plate, free, run.step))  # no torque: the movement decides
    assert np.abs(given).max() == pytest.approx(np.tanh(2), rel=1e-6)
    up = np.gradient(run.plate) > 1e-6
    assert np.median(given[up]) > 0.9
    assert np.median(given[np.gradient(run.plate) < -1e-6]) < -0.9
    pressed = np.degrees(gap.gives(run.plate, free + 10, run.step))
    np.testing.assert_allclose(pressed, 1.0, atol=1e-6)


def test_yielding_tissue_softens_and_ends_conditioned() -> None:
    one = next(leg("rf", seed) for seed in range(9))
    tissue = one.departures[0]
    assert isinstance(tissue, Yielding)
    cycle = 0.4 * np.sin(2 * np.pi * np.arange(40 * 400) / 400)
    fresh, calm = tissue.resist(cycle, 0.02), tissue.conditioned().resist(cycle, 0.02)
    peaks = [fresh[i * 400 : (i + 1) * 400].max() for i in range(40)]
    assert peaks[0] > 1.05 * peaks[-1]
    assert peaks[-1] == pytest.approx(calm[-400:].max(), abs=tissue.grip)
    softer = replace(tissue, grip=0.0).resist(cycle, 0.02)
    np.testing.assert_allclose(softer[-400:], calm[-400:], rtol=1e-3, atol=1e-4)
    truth = truth_of("rf", one.seed, 1)
    assert truth["measures"]["hysteresis"] is None
    assert "how often" in truth["unscored"]["hysteresis"]
    assert truth["measures"]["slow_stiffness@10deg"] > 0


def test_a_reflex_answers_fast_stretches_alone_and_tone_does_not_stop() -> None:
    one = leg("ra", 3)
    reflex = StretchReflex(4.0, 20.0, 0.04, 0.5)
    for kind, answers in (("ladder", True), ("stretches", True), ("curve", False)):
        with_, plain = (bare(one, *d).record(1, 40.0, kind) for d in ((reflex,), ()))
        speed = np.degrees(np.gradient(plain.plate, plain.step))
        largest = np.abs(with_.torque - plain.torque).max()
        if speed.max() < 20:
            assert largest < 1e-9
        elif kind == "stretches":
            assert largest > 0.5
            assert answers
    tone = Tone(2.0, 0.1, 1.0)
    with_, plain = (bare(one, *d).record(1, 40.0, "ramps") for d in ((tone,), ()))
    more = (with_.torque - plain.torque)[4096:]
    assert 0.5 < np.median(more) < 4.0
    assert more.min() > 0.1
    assert np.median(with_.emg[2] / plain.emg[2]) > 1.5


def test_a_zero_moves_once() -> None:
    one = leg("ra", 3)
    for which, torque, angle in ((0.1, True, False), (0.9, False, True), (0.5, True, True)):
        moved = MovedZero(3.0, 2.0, which, 0.0)
        with_, plain = (bare(one, *d).record(1, 30.0, "ramps") for d in ((moved,), ()))
        away = with_.torque - plain.torque
        assert np.ptp(away) == pytest.approx(3.0 if torque else 0.0, abs=1e-9)
        turned = np.degrees(with_.plate - plain.plate)
        assert np.ptp(turned) == pytest.approx(2.0 if angle else 0.0, abs=1e-9)
        np.testing.assert_array_equal(with_.ankle, plain.ankle)


def test_courses_do_what_they_say() -> None:
    times = fine_times(60.0)
    for seed in range(12):
        rng = np.random.default_rng(seed)
        angle, level = COURSES["ramps"](rng, times, -0.7, 0.4)
        speed = np.degrees(np.abs(np.gradient(angle, times[1])))
        slow = (speed > 4.2) & (speed < 5.8)
        assert slow.mean() > 0.25
        assert speed.max() > 7
        assert not level.any()
        angle, level = COURSES["bouts"](rng, times, -0.7, 0.4)
        assert times[1] * np.sum(level.max(axis=0) < 0.01) > 8
        assert level.max() > 0.2
        angle, _ = COURSES["ladder"](rng, times, -0.7, 0.4)
        still = np.abs(np.gradient(angle, times[1])) < 1e-9
        assert 5 <= np.unique(np.round(angle[still], 6)).size <= 7
        for course in (angle,):
            assert course.min() >= -0.7 - 1e-9
            assert course.max() <= 0.4 + 1e-9


def own(one: RelaxedLeg, trial: int) -> dict[str, float]:
    return own_measures(one.placed(trial).ankle(), RANGE)  # type: ignore[return-value]


@pytest.mark.parametrize("change", CHANGES)
def test_a_second_visit_is_the_same_leg_placed_anew_and_a_third_has_changed(change: str) -> None:
    one = replace(leg("ra", 4), change=change)
    first, second, third = (own(one, trial) for trial in (1, 4, 7))
    assert first == second == own(one, 3)
    assert one.placed(1).departures[0] == one.placed(3).departures[0]
    assert one.placed(1).departures[0] != one.placed(4).departures[0]
    assert one.condition(4)[1].zero != one.condition(1)[1].zero
    ratio = third["passive_torque@10deg"] / first["passive_torque@10deg"]
    stiff = third["passive_stiffness@10deg"] / first["passive_stiffness@10deg"]
    if change in ("softer", "stiffer"):
        expected = 0.7 if change == "softer" else 1.3
        assert ratio == pytest.approx(expected, rel=0.02)  # the muscle's tendon gives a little
        assert stiff == pytest.approx(expected, rel=0.03)
    elif change in ("longer", "shorter"):
        turn = SLACKER if change == "longer" else -SLACKER
        ankles = [one.placed(trial).ankle() for trial in (1, 7)]
        before, after = (
            a.still(np.radians([10.0]) + t) for a, t in zip(ankles, (0, turn), strict=True)
        )
        assert after[0] == pytest.approx(before[0], rel=0.03)
        assert (ratio < 0.95) == (change == "longer")
    else:
        assert ratio == pytest.approx(1.0, abs=1e-6)
    more = third["relaxed_share@10s"] / first["relaxed_share@10s"]
    assert (more > 1.2) == (change == "relaxing")
    gains = [one.condition(t)[0].values["g3"] for t in (1, 7)]
    assert gains[1] / gains[0] == pytest.approx(0.7 if change == "weaker" else 1.0)
    delays = [one.condition(t)[1].delay for t in (1, 7)]
    assert delays[1] - delays[0] == pytest.approx(0.03 if change == "late" else 0.0)


def test_a_robot_turns_back_where_a_changed_leg_pulls_too_hard() -> None:
    one = leg("rd", 3)
    assert one.change == "shorter"
    changed, mounting = one.condition(7)
    ankle = one.placed(7).ankle()
    assert ankle.still_shown(np.array(one.subject.range))[1] > 50
    assert changed.range[1] < one.subject.range[1] - 0.01
    assert 20 < ankle.still_shown(np.array(changed.range))[1] < 32
    assert one.record(7).plate.max() <= changed.range[1] + 1e-9
    assert mounting.delay == one.condition(1)[1].delay


def test_seeds_change_in_one_thing_after_another() -> None:
    assert {leg("rb", seed).change for seed in range(7)} == {*CHANGES}
    assert set(FAMILIES) < set(RELAXED)


def test_answers_at_the_devices_angle_and_pairs_of_visits_are_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seed = next(s for s in range(9) if leg("rc", s).change == "stiffer")
    truth, name = truth_of("rc", seed, 1), "passive_stiffness@10deg"
    k, shown = truth["measures"][name], truth["device"][name]
    assert k != shown
    path, pairs = tmp_path / "answers.csv", tmp_path / "changes.csv"
    head = ["family", "seed", "trial", "parameter", "value", "low", "high", "verdict", "angle"]
    rows = [
        ["rc", seed, 1, name, k, k - 1e-6, k + 1e-6, "identified", "ankle"],
        ["rc", seed, 1, name, shown, shown - 1e-6, shown + 1e-6, "identified", "device"],
        ["rc", seed, 1, name, k, k - 1e-6, k + 1e-6, "weak", "device"],
    ]
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([head, *rows])
    third = truth_of("rc", seed, 7)["measures"][name]
    assert third / k == pytest.approx(1.3, rel=0.05)
    pairs.write_text(
        "family,seed,before,after,measure,verdict,low,high\n"
        f"rc,{seed},1,4,{name},no change shown,-0.01,0.01\n"
        f"rc,{seed},1,7,{name},changed,{0.9 * (third - k)},{1.1 * (third - k)}\n"
        f"rc,{seed},1,7,torque_gain_sol,changed,,\n"
    )
    assert main(["score", str(path), "--changes", str(pairs)]) == 0
    said = capsys.readouterr().out
    assert "2 of 3" in said
    assert "0 of 1" in said
    assert "1 of 1 that changed" in said
    assert said.strip().endswith("2 of 2 differences hold")


def test_make_writes_visits_of_their_usual_kinds(tmp_path: Path) -> None:
    assert main(["make", "rb", "2", "--output", str(tmp_path), "--trials", "1,7"]) == 0
    table = np.genfromtxt(tmp_path / "rb-2/trial-1.csv", delimiter=",", names=True, skip_header=1)
    kind, seconds = leg("rb", 2).usual(1)
    assert kind == "ramps"
    assert table["time_s"].size == seconds * 128
    assert (tmp_path / "truth" / "rb-2.json").exists()
