"""`surae batch`: whose recording a file is, what is computed once, and what its table says."""

import csv
import json

import pytest
from click.testing import CliRunner

from surae import InputError
from surae.cli import group
from surae_thesis.batch.answers import Outcomes, answers
from surae_thesis.batch.files import find_trials
from surae_thesis.batch.table import settings_of, table


def made(folder, *names):
    for name in names:
        path = folder / f"{name}.csv"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("time_s,angle_rad,torque_Nm\n0,0,0\n")
    return folder


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("S01_multiple-holds_2", ("S01", "multiple-holds", 2)),
        ("S01/multiple-holds_2", ("S01", "multiple-holds", 2)),
        ("S01/holds/rep3", ("S01", "holds", 3)),
        ("P-7 ramp and hold 1", ("P-7", "ramp_and_hold", 1)),
        ("S02/holds2", ("S02", "holds", 2)),
        ("S02/relaxed", ("S02", "relaxed", 1)),
        ("S03", ("S03", "trial", 1)),
    ],
)
def test_a_name_tells_whose_a_recording_is(tmp_path, name, told):
    (trial,) = find_trials([made(tmp_path, name)])
    assert (trial.subject, trial.protocol, trial.repetition) == told


def test_a_pattern_tells_what_names_do_not(tmp_path):
    made(tmp_path, "holds/anna-2", "holds/bert-1")
    anna, bert = find_trials([tmp_path], pattern="{protocol}/{subject}-{repetition}")
    assert (anna.subject, anna.protocol, anna.repetition) == ("anna", "holds", 2)
    assert bert.subject == "bert"
    with pytest.raises(InputError, match="is not as --name"):
        find_trials([tmp_path], pattern="{subject}_{repetition}")


def test_two_files_of_one_repetition_are_refused(tmp_path):
    with pytest.raises(InputError, match="are both 'S01 holds 1'; rename one"):
        find_trials([made(tmp_path, "S01_holds_1", "S01/holds_1")])


def test_sets_are_fitted_beside_what_is_free():
    settings = settings_of(["1.0", "auto"], ["beta=1,m=2"], {"seed": 3})
    assert list(settings) == [(m, s) for m in ("1.0", "auto") for s in ("", "beta=1,m=2")]
    assert settings["1.0", "beta=1,m=2"].fixed == {"beta": 1.0, "m": 2.0}
    assert not settings["1.0", ""].fixed
    with pytest.raises(InputError, match="write it as beta=1,m=2"):
        settings_of(["1.0"], ["beta"], {})


def _fit(subject, repetition, vaf, predicted, sem=0.2):
    label = {
        "kind": "fit",
        "subject": subject,
        "protocol": "holds",
        "repetition": repetition,
        "path": "",
        "model": "1.0",
        "fixed": "",
    }
    p = {"value": 2.0, "sem": sem, "ci95": [1.0, 3.0], "verdict": "weak"}
    others = {f"{subject} holds {r}": v for r, v in predicted.items()}
    return label, {
        "failed": None,
        "status": "converged",
        "grade": "adequate",
        "vaf": vaf,
        "r2": vaf,
        "ipde": 2.6,
        "parameters": {"m": p, "g1": p},
        "predicted": others,
        "seconds": 1.0,
    }


def _outcomes():
    trial = {"kind": "trial", "protocol": "holds", "path": ""}
    seen = [
        ({**trial, "subject": "A", "repetition": r}, {"spectrum": [10.0 * r] * 60, "findings": []})
        for r in (1, 2)
    ]
    simulated = {"kind": "simulation", "protocol": "holds", "model": "1.0", "leg": 0}
    failed = _fit("B", 1, 0.0, {})[0]
    return [
        *seen,
        _fit("A", 1, 95.0, {2: 80.0}),
        _fit("A", 2, 97.0, {1: 70.0}),
        (failed, {"failed": "no torque", "seconds": 0.1}),
        (simulated, {"sem": {"m": 0.1, "g1": 0.05}}),
    ]


def test_what_a_batch_says_is_of_its_fits():
    o = Outcomes(_outcomes())
    assert o.vaf("1.0", "holds") == {("A", 1): 95.0, ("A", 2): 97.0}
    assert o.predicted("1.0", "holds") == {("A", 2): 80.0}  # by the first repetition alone
    # A weight's standard error is compared relative to its value: 0.2 of 2 over 0.05.
    ratios = o.snsem("1.0", "holds")
    assert ratios["m"] == pytest.approx([2.0, 2.0])
    assert ratios["g1"] == pytest.approx([2.0, 2.0])
    result = answers(_outcomes())
    summary, parameters, repetitions, failures = result.tables
    assert summary.rows[0][:7] == ("1.0", "holds", 2, 96.0, 95.0, 80.0, 80.0)
    assert repetitions.rows == (("holds", "A", 2, 10.0),)
    assert failures.rows[0][1] == "no torque"
    assert {row[2]: row[4] for row in parameters.rows} == {"m": 0.0, "g1": 0.0}
    assert any(figure.name.startswith("batch-snsem") for figure in result.figures)


def test_a_row_of_the_table_is_one_fit():
    columns, rows = table(_outcomes())
    first, second, failed = (dict(zip(columns, row, strict=True)) for row in rows)
    assert (first["subject"], first["validation_vaf"], first["m_sem"]) == ("A", 80.0, 0.2)
    assert second["validation_vaf"] == 70.0
    assert (failed["status"], failed["message"], failed["m"]) == ("failed", "no torque", None)


@pytest.mark.slow
def test_a_batch_goes_on_where_it_was(tmp_path, monkeypatch):
    import surae
    from surae.studies import virtual_subject, virtual_trial

    monkeypatch.chdir(tmp_path)
    motion = surae.generate(surae.Protocol(profile="sine", duration=20.0, rate_hz=125.0))
    leg = virtual_subject(seed=1)
    for repetition in (1, 2):
        t = virtual_trial(leg, motion, seed=repetition)
        columns = [t.time, t.angle, t.torque, *t.emg.T]
        names = "time_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V"
        lines = [
            names,
            *(",".join(map(repr, map(float, row))) for row in zip(*columns, strict=True)),
        ]
        (tmp_path / f"S1_sine_{repetition}.csv").write_text("\n".join(lines))
    asked = [
        "batch",
        "S1_sine_1.csv",
        "S1_sine_2.csv",
        "--models",
        "1.0",
        "--prepared",
        "--store",
        "b.db",
        "--output",
        "out",
        "--workers",
        "1",
        "--starts",
        "1",
    ]
    first = CliRunner().invoke(group, asked, catch_exceptions=False)
    assert "5 computed now" in first.output
    again = CliRunner().invoke(group, asked, catch_exceptions=False)
    assert "0 computed now" in again.output
    rows = list(csv.DictReader((tmp_path / "out" / "table.csv").read_text().splitlines()))
    assert [row["repetition"] for row in rows] == ["1", "2"]
    assert min(float(row["validation_vaf"]) for row in rows) > 99.0
    for only, computed in (("spectra", 2), ("snsem", 3)):
        words = [*asked, "--only", only, "--store", f"{only}.db", "--output", only]
        said = CliRunner().invoke(group, words, catch_exceptions=False)
        assert f"{computed} computed now" in said.output
        drawn = {path.name for path in (tmp_path / only / "figures").glob("*.png")}
        assert {name.split("-")[1].removesuffix(".png") for name in drawn} >= {only}
    kept = json.loads((tmp_path / "out" / "sections" / "batch.json").read_text())
    assert kept["tables"][0]["name"] == "batch-summary"
