"""True measures are what a robot would read, also of legs whose joint has tissue of its own."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ankle_legs import look
from ankle_legs.leg import Leg
from ankle_legs.main import main
from ankle_legs.make import leg, truth_of
from ankle_legs.muscle import integrate, static_force
from ankle_legs.score import measures_of, names
from ankle_legs.subject import GRAVITY, LEVER


def measures(one: Leg, kinds: tuple[str, ...] = ("active",)) -> dict[str, float]:
    return one.truth(*one.condition(1), 1, kinds)["measures"]


def with_(one: Leg, *departures: look.Departure) -> Leg:
    return replace(one, departures=departures)


def test_a_spring_adds_to_the_joint_and_not_to_its_muscles() -> None:
    plain = with_(leg("a", 3))
    spring = look.Spring(2.0, -0.2)
    before, after = measures(plain), measures(with_(plain, spring))
    slope = np.radians(2.0)
    for name in ("passive_stiffness@10deg", "end_stiffness", "quick_stiffness@0deg"):
        assert after[name] - before[name] == pytest.approx(slope, rel=1e-6)
    turned = after["passive_torque@10deg"] - before["passive_torque@10deg"]
    assert turned == pytest.approx(2.0 * (np.radians(10) + 0.2))
    assert after["passive_torque_tri@10deg"] == before["passive_torque_tri@10deg"]
    assert after["dissipated_energy"] == pytest.approx(before["dissipated_energy"], rel=1e-6)
    added = plain.record(1, 20, "passive"), with_(plain, spring).record(1, 20, "passive")
    np.testing.assert_allclose(
        added[1].torque - added[0].torque, spring.rest(added[0].ankle), atol=1e-9
    )


def test_a_damper_takes_energy_and_holds_nothing() -> None:
    plain = with_(leg("a", 3))
    before, after = measures(plain), measures(with_(plain, look.Damper(0.2)))
    assert after["passive_torque@10deg"] == before["passive_torque@10deg"]
    speed, way = np.radians(10), 2 * np.radians(30)
    taken = after["dissipated_energy"] - before["dissipated_energy"]
    assert taken == pytest.approx(1e3 * 0.2 * speed * way, rel=0.01)


def test_a_zero_moves_what_is_read_at_an_angle_and_not_what_is_read_at_the_end() -> None:
    plain = with_(leg("a", 3))
    off = with_(plain, look.Zero(4.0))
    before, after = measures(plain), measures(off)
    assert after["passive_torque@10deg"] == before["passive_torque@10deg"]
    shown = off.record(1, 35)
    end = np.percentile(shown.plate[::16], 99) - np.radians(4)
    assert after["end_torque"] == pytest.approx(plain.subject.passive_torque(np.array([end]))[0])
    np.testing.assert_allclose(shown.plate - shown.ankle, np.radians(4))


@pytest.mark.slow
@pytest.mark.parametrize("family", ["p", "v", "m", "l-21"])
def test_a_long_hold_reads_the_relaxed_torque(family: str) -> None:
    one = leg(family, 4)
    one = replace(one, departures=tuple(d for d in one.departures if not d.loops))
    run = one.record(1, 200.0, "curve")
    still = np.flatnonzero(np.diff(run.plate) == 0)
    last = still[np.flatnonzero(np.diff(still) > 1)]
    angle = run.ankle[last]
    weight = one.subject.values["m"] * GRAVITY * LEVER * np.cos(angle)
    rest = one.lasting(one.subject).passive_torque(angle) + one.rest(angle)
    friction = 1.3 if family == "l-21" else 0.0
    assert run.torque[last] - weight == pytest.approx(rest, abs=0.8 + friction)


def test_largest_active_torque_is_what_a_hold_at_that_activity_adds() -> None:
    one = with_(leg("a", 3))
    truth, subject = measures(one), one.subject
    run = one.record(1, 35)
    states = np.percentile(run.active[:, ::16], 99, axis=1)
    for i, group in enumerate(("tri", "tib")):
        path, arm = (f(np.zeros(1))[i, 0] for f in (subject.geometry.path, subject.geometry.arm))
        muscle, n = subject.muscles()[i], 12_000
        ones = np.ones(n)
        forces = [
            integrate(1e-3, path * ones, a * ones, ones, 0 * ones, muscle.constants())[1][-1]
            for a in (states[i], 0.0)
        ]
        added = arm * (forces[0] - forces[1])
        assert truth[f"active_torque_max_{group}@0deg"] == pytest.approx(added, rel=2e-3)


def test_quick_stiffness_is_that_of_a_sudden_stretch() -> None:
    one = with_(leg("v", 2), *leg("v", 2).departures)
    subject, truth = one.lasting(one.subject), measures(one)
    angle = np.full(2000, 0.0)
    angle[1000:] = np.radians(0.05)
    total = 0.0
    for i, muscle in enumerate(subject.muscles()):
        ones, path = np.ones(angle.size), subject.geometry.path(angle)[i]
        force = integrate(1e-5, path, 0 * ones, ones, 0 * ones, muscle.constants())[1]
        pull = force * subject.geometry.arm(angle)[i]
        total += (1, -1)[i] * (pull[1000] - pull[999]) / 0.05
    assert truth["quick_stiffness@0deg"] == pytest.approx(total, rel=2e-3)


def test_a_pennate_muscle_pulls_less_in_line_and_a_straight_one_is_the_limit() -> None:
    subject = leg("a", 3).subject
    plain = subject.muscles()[0]
    thin = replace(plain, width=1e-7)
    path = subject.geometry.path(np.zeros(1))[0, 0]
    for active in (0.0, 900.0):
        a, b = (static_force(m, path, active)[0] for m in (plain, thin))
        assert b == pytest.approx(a, rel=1e-6)
    n = 3000
    ones, move = np.ones(n), path + 0.002 * np.sin(np.arange(n) / 300)
    runs = [integrate(1e-3, move, 500 * ones, ones, 0 * ones, m.constants()) for m in (plain, thin)]
    np.testing.assert_allclose(runs[0][1], runs[1][1], rtol=1e-5)
    pennate = with_(leg("v", 3), look.Pennate(25.0))
    muscle = pennate.lasting(pennate.subject).muscles()[0]
    line = pennate.subject.values["l0_tri"]
    assert muscle.l0 * np.cos(np.radians(25)) == pytest.approx(line)
    assert np.hypot(line, muscle.width) == pytest.approx(muscle.l0)


@pytest.mark.slow
def test_softening_ends_conditioned() -> None:
    one = leg("r", 2)
    run, plain = one.record(1, 60, "passive"), with_(one).record(1, 60, "passive")
    more = run.torque - plain.torque
    assert np.abs(more[: 10 * 2048]).max() > 5 * np.abs(more[-10 * 2048 :]).max()


def test_a_visit_is_read_over_what_all_its_trials_moved() -> None:
    one, two = (truth_of("a", 2, 1, kinds)["measures"] for kinds in (("active",), ("active",) * 3))
    assert one["passive_torque@10deg"] == two["passive_torque@10deg"]
    assert one["end_torque"] != two["end_torque"]
    passive = truth_of("a", 2, 1, ("passive",))["measures"]
    assert passive["active_torque_max_tri@0deg"] is None


def test_what_a_parameter_has_no_truth_of_its_measures_have_none_either() -> None:
    truth = truth_of("b", 1, 1)["measures"]
    assert truth["torque_per_emg_tri"] is None
    assert truth["bandwidth"] is not None
    assert truth_of("r", 1, 1)["measures"]["dissipated_energy"] is None


def test_measures_are_counted_apart_by_hand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, visit = tmp_path / "answers.csv", ("active", "passive")
    end = truth_of("a", 1, 1, visit)["measures"]["end_torque"]
    m = truth_of("a", 1, 1)["parameters"]["m"]
    head = ["family", "seed", "trial", "parameter", "value", "low", "high", "verdict", "visit"]
    rows = [
        ["a", 1, 1, "m", m, 0.9 * m, 1.1 * m, "identified", "+".join(visit)],
        ["a", 1, 1, "end_torque", end, end - 0.01, end + 0.01, "identified", "+".join(visit)],
        ["a", 1, 1, "end_torque", 0, end + 0.01, end + 0.02, "weak", "+".join(visit)],
        ["a", 1, 1, "unheard_of", 0, 0, 1, "identified", "+".join(visit)],
    ]
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([head, *rows])
    assert main(["score", str(path)]) == 0
    said = capsys.readouterr().out
    parameters, others = said.split("measures\n")
    assert parameters.splitlines()[1].split()[:4] == ["a", "1", "1", "1"]
    assert others.splitlines()[1].split()[:8] == ["a", "1", "1", "1", "100", "%", "1", "of"]
    assert others.splitlines()[-1].startswith("1 answers were not counted")
    line = " ".join(names(path, measures_of(path)).split())
    assert line == "end_torque 1 of 2 hold, 1 identified, 1 true"
