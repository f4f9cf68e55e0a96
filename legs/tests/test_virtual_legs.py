"""Legs are the same for the same seed, what they claim to be, and scored as written."""

import csv
import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ankle_legs.leg import Leg
from ankle_legs.main import main
from ankle_legs.make import FAMILIES, leg, truth_of
from ankle_legs.score import score


def columns(one: Leg, trial: int = 1, kind: str = "active") -> dict[str, np.ndarray]:
    return one.columns(one.record(trial, 12.0, kind), trial)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_family_departs_from_the_same_leg_without_it(family: str) -> None:
    one = leg(family, 3)
    made = columns(one)
    assert made["time_s"].size == 12 * 128
    assert all(np.isfinite(column).all() for column in made.values())
    if family not in ("a", "p"):
        plain = columns(replace(one, departures=()))  # with the very same noise
        shown = [n for n in made if n not in ("time_s", "angle_rad")]
        largest = max(np.sqrt(np.mean((made[n] - plain[n]) ** 2)) / np.std(plain[n]) for n in shown)
        assert largest > 0.01


def test_a_leg_is_the_same_for_the_same_seed_alone() -> None:
    first, again, other = (columns(leg("i", seed)) for seed in (3, 3, 4))
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert np.std(first["torque_Nm"] - other["torque_Nm"]) > 1


@pytest.mark.slow
def test_true_measures_are_what_the_robot_reads_when_all_has_relaxed() -> None:
    """A ladder of long holds of the plain leg, less weight and zero."""
    one = leg("p", 4)
    run = one.record(1, 150.0, "curve")
    still = np.flatnonzero(np.diff(run.plate) == 0)
    last = still[np.flatnonzero(np.diff(still) > 1)]
    elastic = run.torque[last] - one.subject.values["m"] * 9.81 * 0.15 * np.cos(run.plate[last])
    rest = one.subject.passive_torque(run.plate[last])
    assert last.size >= 5
    # The EMG's resting level pulls with a few N.
    assert elastic == pytest.approx(rest, abs=0.8)
    slope = np.gradient(one.subject.passive_torque(np.radians([9.9, 10.0, 10.1])), 0.1)[1]
    measures = truth_of("p", 4, 1)["measures"]
    assert measures["passive_stiffness@10deg"] == pytest.approx(slope, rel=1e-3)


def test_isometric_trials_hold_eight_angles_and_one_muscle_at_a_time_pulls_alone() -> None:
    one = leg("a", 3)
    held = one.record(1, 64.0, "isometric")
    still = np.abs(np.gradient(held.plate, held.step)) < 1e-9
    angles = np.unique(np.round(np.degrees(held.plate[still & (held.times > 2)]), 3))
    assert angles.size == 8
    assert np.ptp(angles) > 0.9 * np.degrees(np.ptp(one.subject.range))
    assert held.effort.max(axis=1).min() > 0.1
    alone = one.record(1, 35.0, "alone")
    for row in range(4):
        strong = alone.effort[row] > 0.9 * alone.effort[row].max()
        others = np.delete(np.arange(4), row)
        share = alone.effort[others] / alone.effort[others].max(axis=1, keepdims=True)
        assert share[:, strong].max() < 0.4
    assert np.ptp(one.record(1, 35.0, "maximal").torque) > np.ptp(alone.torque)


def test_what_a_family_changes_the_meaning_of_has_no_truth_but_a_reason() -> None:
    truth = truth_of("b", 1, 1)
    assert truth["parameters"]["g2"] is None
    assert "force per volt" in truth["unscored"]["g2"]
    assert truth["parameters"]["l0_tri"] > 0


@pytest.mark.slow
def test_trials_say_whether_the_leg_or_its_mounting_is_another() -> None:
    first, moved, mounted, treated = (truth_of("a", 2, trial) for trial in (1, 2, 4, 7))
    assert first["parameters"] == moved["parameters"]
    lasting = [n for n in first["measures"] if n.startswith("passive") or "angle" in n]
    for name in lasting:
        assert moved["measures"][name] == mounted["measures"][name] == first["measures"][name]
    assert mounted["parameters"]["g1"] != first["parameters"]["g1"]
    soft, stiff = (t["measures"]["passive_stiffness@10deg"] for t in (treated, first))
    assert 0.4 < soft / stiff < 0.85


def test_film_sees_the_muscles_length_but_for_scale_zero_and_drift() -> None:
    one = leg("a", 2)
    run = one.record(1)
    film, seen = one.film(run, 1), one.seen_fascicles()
    assert 1 / np.diff(film["time_s"]) == pytest.approx(33.3, abs=0.1)
    for i, name in enumerate(("fascicle_gm", "fascicle_tib")):
        length = 1e3 * np.interp(film["time_s"], run.times, run.length[i])
        miss = film[f"{name}_mm"] - seen[name]["scale"] * length - seen[name]["zero_mm"]
        assert 0.3 < np.std(miss) < 2.0
        assert abs(np.corrcoef(miss[:-1], miss[1:])[0, 1]) > 0.7  # a drift, no white noise


def test_raw_emg_has_the_envelope_as_its_mean_size() -> None:
    one = leg("p", 2)
    run = one.record(1)
    raw, envelope = one.columns(run, 1, raw=True), one.columns(run, 1)
    for name in ("emg_ta_V", "emg_sol_V"):
        assert abs(np.mean(raw[name])) < 0.05 * np.mean(envelope[name])
        assert np.mean(np.abs(raw[name])) == pytest.approx(np.mean(envelope[name]), rel=0.1)


def test_make_writes_recordings_and_keeps_the_truth_apart(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    what = ["--trials", "2", "--film", "--geometry"]
    assert main(["make", "f", "5", "--output", str(tmp_path), *what]) == 0
    files = [Path(line) for line in capsys.readouterr().out.split()]
    assert [file.name for file in files] == ["trial-1.toml", "trial-2.toml"]
    channels = tomllib.loads(files[0].read_text())["channels"]
    assert len(channels) == 8
    for channel in channels.values():
        header = (files[0].parent / channel["file"]).read_text().splitlines()[:2]
        assert channel["column"] in ",".join(header).split(",")
    lines = files[0].with_suffix(".csv").read_text().splitlines()
    assert lines[0] == "# emg: envelope"
    assert lines[1] == "time_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V"
    assert not list((tmp_path / "f-5").glob("*.json"))
    truth = json.loads((tmp_path / "truth" / "f-5.json").read_text())
    assert truth["trials"][1]["parameters"] == truth_of("f", 5, 2)["parameters"]
    table = np.genfromtxt(
        tmp_path / "f-5/geometry/geometry.csv", delimiter=",", names=True, skip_header=3
    )
    one = leg("f", 5)
    own = one.lasting(one.subject).geometry.arm(np.radians(table["angle_deg"]))
    np.testing.assert_allclose(table["arm_tri_mm"], 1000 * own[0], rtol=1e-6)
    assert np.ptp(own[0] / one.subject.geometry.arm(np.radians(table["angle_deg"]))[0]) > 0.001


def answers(path: Path, rows: list[tuple[object, ...]]) -> Path:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["family", "seed", "trial", "parameter", "value", "low", "high", "verdict"])
        writer.writerows(rows)
    return path


@pytest.mark.slow
def test_pairs_are_counted_by_what_changed_in_truth(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "changes.csv"
    pairs = ["1,2,{}@10deg,changed", "1,3,{}@10deg,no change shown", "1,4,{}@0deg,changed"]
    pairs += ["1,4,g1,changed", "1,7,{}@10deg,changed", "1,7,m,changed"]
    pairs += ["1,3,reflex_gain,changed", "1,7,reflex_gain,changed"]  # of no known truth
    head = "family,seed,before,after,measure,verdict\n"
    rows = [f"a,2,{pair.format('passive_stiffness')}\n" for pair in pairs]
    table.write_text(head + "".join(rows))
    path = answers(tmp_path / "answers.csv", [])
    assert main(["score", str(path), "--changes", str(table)]) == 0
    words = capsys.readouterr().out.splitlines()[-1]
    assert "2 of 2, 1 of 1" in words
    assert "1 of 1 that changed, 1 of 1 that did not" in words


def test_score_counts_by_hand(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = (truth_of(family, 1, 1)["parameters"] for family in "ab")
    l0, f0 = a["l0_tri"], a["f0"]
    path = answers(
        tmp_path / "answers.csv",
        [
            ("a", 1, 1, "l0_tri", l0, 0.9 * l0, 1.1 * l0, "identified"),
            ("a", 1, 1, "f0", 1.5 * f0, 1.4 * f0, 1.6 * f0, "identified"),
            ("a", 1, 1, "k_tri", 1.0, "", "", "undetermined"),
            ("b", 1, 1, "l0_tri", b["l0_tri"], 0, 1, "weak"),
            ("b", 1, 1, "g2", 1.0, 0, 1, "identified"),
        ],
    )
    assert main(["score", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    worst, second = lines[1].split(), lines[2].split()
    assert worst[:8] == ["a", "1", "2", "1", "50", "%", "1", "of"]
    sd = 0.2 / (2 * 1.959964)
    assert f"{0.5 / sd:5.1f}" in lines[1]
    assert "f0 of a-1, trial 1" in lines[1]
    assert second[:2] == ["b", "1"]
    assert lines[3].split()[:4] == ["all", "2", "2", "1"]
    assert lines[-1].startswith("1 answers were not counted")


def test_a_repeat_is_counted_where_the_next_trial_came_to_lie(tmp_path: Path) -> None:
    head = "family,seed,trial,parameter,value,low,high,verdict,repeatable,repeat_low,repeat_high\n"
    rows = [
        "a,1,1,f0,2.0,,,weak,true,1.9,2.1",
        "a,1,2,f0,2.05,,,weak,true,2.0,2.1",
        "a,1,3,f0,1.9,,,weak,true,0,9",  # no trial 4 was answered
        "a,1,1,m,2.0,,,weak,false,0,9",
        "a,1,2,m,2.0,,,weak,false,0,9",
    ]
    table = tmp_path / "answers.csv"
    table.write_text(head + "\n".join(rows))
    family, total = score(table)
    assert (family.repeatable, family.repeated) == (2, 1)
    assert (total.repeatable, total.repeated) == (2, 1)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["make", "a", "1", "--output", "x", "--trials", "0"], "no trial"),
        (["make", "nothing", "1", "--output", "x"], "no family 'nothing'"),
        (["make", "a", "-1", "--output", "x"], "seed -1"),
        (["score", "missing.csv"], "missing.csv"),
    ],
)
def test_wrong_use_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_an_answer_without_a_column_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "answers.csv"
    path.write_text("family,seed,parameter\na,1,m\n")
    assert main(["score", str(path)]) == 2
    assert "trial" in capsys.readouterr().err


def test_legs_share_no_line_with_what_is_judged() -> None:
    for source in (Path(__file__).parents[1] / "src" / "ankle_legs").glob("*.py"):
        assert "import surae" not in source.read_text()
        assert "from surae" not in source.read_text()
