"""A session from folder to report: kept, resumed, stopped; and what it must not claim."""

import csv
import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api.session_run import run
from surae.api.session_run.beside import Beside
from surae.api.sides import side_of
from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.records import to_plain
from surae.protocol import Protocol, generate
from surae.report import block
from surae.report.trials import crossed_section
from surae.studies import virtual_subject, virtual_trial
from surae.trials import Crossed, Effort

pytestmark = pytest.mark.usefixtures("few")
QUICK = {"model": "muscle", "prepared": True, "starts": 1}


def test_each_and_all_are_fitted_and_predicted(done):
    _, result = done
    assert set(result.fits) == {"passive", "walk 1", "walk 2"}
    assert result.joined == ("passive", "walk 1", "walk 2")
    assert result.joint is not None
    assert result.joint.adequacy.r2 > 95
    assert "row 3" in result.failed["broken"]  # one bad file is told, the others go on
    other = result.predictions["walk 1"]["walk 2"]
    assert not other.fitted
    assert other.r2 > 95
    assert result.predictions["walk 1"]["walk 1"].fitted
    hold = result.joint_predictions["hold"]
    assert hold.r2 is None  # its torque does not change: R² would be of noise
    assert abs(hold.bias) < 1.0
    assert all(result.joint_predictions[name].fitted for name in result.joined)


@pytest.mark.parametrize("lost", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_joint_fit_in_a_process_beside_is_the_same(done, leg, monkeypatch, lost):
    """Where that process is lost, the fit is made here."""
    if lost:
        monkeypatch.setattr(Beside, "begin", lambda self, *_: self._child.close())
    _, result = done
    both = surae.session(leg).run(workers=2, **QUICK)
    assert both.rows() == result.rows()
    assert both.joint_predictions == result.joint_predictions


def test_trials_above_the_rate_of_a_fit_are_found_in_it_and_kept(tmp_path):
    """`auto` says in a fit's signals what it decimated: they are the trial's all the same."""
    profile = Protocol(profile="sine", passive_seconds=4.0, rate_hz=128.0)
    trial = virtual_trial(virtual_subject(3), generate(profile), noise=0.05)
    columns = np.column_stack([trial.time, trial.angle, trial.torque, trial.emg])
    head = "# emg: envelope\ntime_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V"
    for name in ("one", "two"):
        np.savetxt(tmp_path / f"{name}.csv", columns, "%.9g", ",", header=head, comments="")
    session = surae.session([tmp_path / "one.csv", tmp_path / "two.csv"])
    first = session.run(output=tmp_path / "OUT", nuisances="none")
    (fitted,) = first.fits["one"].result.problem.inputs
    assert any("64 Hz" in step for step in fitted.steps)
    assert first.predictions["one"]["one"].fitted
    seconds = {name: fit.result.seconds for name, fit in first.fits.items()}
    again = session.run(output=tmp_path / "OUT", nuisances="none")
    assert {name: fit.result.seconds for name, fit in again.fits.items()} == seconds


@pytest.mark.slow
def test_a_trial_in_which_a_stream_stopped_is_fitted_in_parts(leg):
    whole = surae.read(leg / "walk 1.csv")
    time = whole["angle"].time
    kept = (time < 8.0) | (time > 9.5)
    lost = {
        role: replace(each, time=read_only(time[kept]), values=read_only(each.values[kept]))
        for role, each in whole.channels.items()
    }
    trials = [replace(whole, name="lost", channels=lost), surae.read(leg / "walk 2.csv")]
    result = surae.session(trials).run(**QUICK)
    assert len(result.fits["lost"].result.problem.inputs) == 2
    assert len(result.joint.result.problem.inputs) == 3
    own, other = result.predictions["lost"]["lost"], result.predictions["walk 2"]["lost"]
    assert own.fitted
    assert own.r2 > 95 < other.r2


def test_of_a_usual_folder_every_file_is_named_and_every_trial_analysed(leg, tmp_path, run):
    """Ten trials beside notes, a list of events and a file that is broken."""
    for number in range(10):
        shutil.copy(leg / f"walk {1 + number % 2}.csv", tmp_path / f"trial_{number}.csv")
    (tmp_path / "notes.txt").write_text("Notes of the session\nelectrode fell off\n")
    (tmp_path / "events.tsv").write_text("onset\tduration\n1\t2\n")
    (tmp_path / "broken.csv").write_text("time_s,angle_rad\n0,1\n1,x\n")
    session = surae.session(tmp_path)
    assert len(session.trials) == 13
    assert len(session.fitted) == 10
    inspected = run("inspect", tmp_path)
    assert inspected.code == 0
    for name in ("notes.txt", "events.tsv", "broken.csv"):
        assert name in inspected.out
        assert session[name.partition(".")[0]].problem
    assert all(f"trial_{number}" in inspected.out for number in range(10))


def test_a_passive_trial_predicts_no_active_one(done):
    """Nothing told its fit what EMG does: a percentage would be that of a default."""
    _, result = done
    for active in ("walk 1", "walk 2"):
        assert result.predictions["passive"][active] == Crossed(reason="no effort here")
    assert result.predictions["walk 1"]["passive"].bias is not None
    _, table = crossed_section(result.predictions, {}, result.session.trials).blocks
    rows = {row[0]: row for row in table.groups[0][1]}
    assert rows["passive"][2] == block.Cell("—", "no effort here")


def test_the_folder_holds_everything(done):
    folder, result = done
    names = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert names >= {
        "session.json",
        "joint.json",
        "table.csv",
        "report.html",
        "fits/walk_1.json",
        "fits/walk_2.json",
        "fits/passive.json",
    }
    assert "fits/hold.json" not in names
    index = json.loads((folder / "session.json").read_text())
    hold = next(trial for trial in index["trials"] if trial["name"] == "hold")
    assert hold["use"] == "hold"
    assert hold["fit"] is None
    assert hold["hold"]["angle_rad"] == pytest.approx(0.1, abs=0.01)
    with (folder / "table.csv").open() as handle:
        rows = list(csv.DictReader(handle))
    assert [row["trial"] for row in rows] == ["passive", "walk 1", "walk 2", "joint"]
    assert float(rows[1]["k_tri"]) == result.fits["walk 1"].values["k_tri"]


def test_the_folder_is_read_back(done):
    folder, result = done
    again = surae.load_session(folder)
    assert again.fits == result.fits
    assert again.joint == result.joint
    assert again.predictions == result.predictions
    assert again.failed == result.failed
    assert again.rows() == result.rows()
    assert [t.effort for t in again.session.trials] == [t.effort for t in result.session.trials]
    frame = again.to_dataframe()
    assert frame.loc[1, "k_tri"] == result.fits["walk 1"].values["k_tri"]
    assert frame.attrs["units"]["k_tri"] == "1/m"


@pytest.mark.usefixtures("undrawn")
def test_what_trials_are_and_how_strong_they_were_are_both_read_back(done, tmp_path):
    """Both are of efforts, and stand in one index."""
    _, result = done
    assert not to_plain(result.session).keys() & to_plain(result).keys()
    given = replace(result.session, efforts={"hold": "maximal"})
    strong = (Effort("hold", "tri", 61.5, 4.0, 2.5), Effort("hold", "tib", 20.0, 4.0, 7.5))
    replace(result, session=given, maximal_efforts=strong).save(tmp_path)
    again = surae.load_session(tmp_path)
    assert again.session.efforts == {"hold": "maximal"}
    assert again.maximal_efforts == strong
    assert side_of(tmp_path).efforts == strong


@pytest.mark.usefixtures("undrawn")
def test_a_run_resumes_and_notices_what_changed(done, leg, tmp_path, monkeypatch):
    folder, result = done
    out = tmp_path / "out"
    shutil.copytree(folder, out)
    made = []
    whole = run.fit_inputs

    def counted(inputs, *rest):
        made.append([each.name for each in inputs])
        return whole(inputs, *rest)

    monkeypatch.setattr(run, "fit_inputs", counted)
    again = surae.session(leg).run(out, **QUICK)
    assert made == []
    assert again.fits == result.fits
    (out / "fits" / "walk_1.json").unlink()  # a run that was killed before
    surae.session(leg).run(out, **QUICK)
    assert made == [["walk 1"]]
    made.clear()
    surae.session(leg).run(out, **QUICK, fixed={"beta": 1.0})  # another question
    assert len(made) == 4
    made.clear()
    changed = tmp_path / "leg"
    shutil.copytree(leg, changed)
    text = (changed / "walk 2.csv").read_text().splitlines()
    (changed / "walk 2.csv").write_text("\n".join(text[:-5]) + "\n")
    surae.session(changed).run(out, **QUICK, fixed={"beta": 1.0})
    assert list(map(sorted, made)) == [["walk 2"], ["passive", "walk 1", "walk 2"]]


@pytest.mark.usefixtures("figures_made")
def test_ctrl_c_keeps_what_is_done(leg, tmp_path, monkeypatch):
    whole, calls = run.fit_inputs, []

    def stopped(inputs, *rest):
        calls.append(inputs[0].name)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return whole(inputs, *rest)

    monkeypatch.setattr(run, "fit_inputs", stopped)
    result = surae.session(leg).run(tmp_path / "out", **QUICK)
    assert result.interrupted
    assert list(result.fits) == calls[:1]
    assert result.joint is None
    assert surae.load_session(tmp_path / "out").interrupted
    assert "This run was stopped" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.usefixtures("figures_made")
def test_holds_alone_identify_nothing(leg, tmp_path, run):
    done = run(
        "session",
        leg / "hold.csv",
        "--output",
        tmp_path / "out",
        "--model",
        "muscle",
        "--prepared",
        "--workers",
        1,
    )
    assert done.code == 1
    assert "no trial could be fitted" in done.err
    index = json.loads((tmp_path / "out" / "session.json").read_text())
    assert index["joint"] is None
    assert not list((tmp_path / "out" / "fits").iterdir())
    page = (tmp_path / "out" / "report.html").read_text()
    assert "identified" not in page.split("</style>")[1]


def test_a_turned_trial_is_not_in_the_joint_fit(leg, tmp_path):
    for name in ("walk 1", "walk 2", "passive"):
        shutil.copy(leg / f"{name}.csv", tmp_path)
    lines = (tmp_path / "walk 2.csv").read_text().splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
    turned = [line.split(",") for line in lines[head + 1 :]]
    turned = [",".join([t, repr(-float(a)), *rest]) for t, a, *rest in turned]
    (tmp_path / "walk 2.csv").write_text("\n".join([*lines[: head + 1], *turned]) + "\n")
    result = surae.session(tmp_path).run(**QUICK)
    assert "walk 2" in result.fits
    assert result.joined == ("passive", "walk 1")
    assert result.failed["walk 2"].startswith("not in the joint fit: angle-sign")


def test_one_reference_of_emg_for_all_trials(leg):
    session = surae.session(leg)
    result = session.run(**QUICK, normalise="session")
    references = {fit.result.problem.inputs[0].emg_reference for fit in result.fits.values()}
    assert len(references) == 1
    assert references.pop().count == 4  # the hold's EMG too
    with pytest.raises(InputError, match="no trial is of maximal effort"):
        session.fit("walk 1", **QUICK, normalise="mvc")


def test_progress_is_told_with_an_estimate(leg):
    steps = []
    surae.session(leg).run(progress=steps.append, **QUICK)
    outcomes = [step for step in steps if step.outcome]
    assert [step.done for step in outcomes] == list(range(1, 7))
    assert outcomes[-1].left_s == pytest.approx(0.0)
    assert any(step.left_s and step.left_s > 0 for step in outcomes)


@pytest.mark.usefixtures("undrawn")
def test_what_was_there_already_is_no_measure_of_the_time_left(done, leg, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(done[0], out)
    (out / "joint.json").unlink()
    steps = []
    surae.session(leg).run(out, progress=steps.append, **QUICK)
    kept = [step for step in steps if "(kept)" in step.outcome]
    assert len(kept) == 3
    assert all(step.left_s is None for step in kept)  # nobody knows how long a fit takes


@pytest.mark.usefixtures("words_alone")
def test_the_command(leg, tmp_path, run):
    command = (
        "session",
        leg,
        "--output",
        tmp_path / "out",
        "--model",
        "muscle",
        "--prepared",
        "--starts",
        1,
        "--workers",
        1,
    )
    done = run(*command)
    assert done.code == 0
    assert "could not be read: broken" in done.err
    assert "[6/6] all together" in done.err
    for question in ("How stiff is it?", "Did it change? One visit", "Can I trust it?"):
        assert question in done.out
    assert "joint" in done.out
    again = run(*command)
    assert again.err.count("(kept)") == 4
    assert run("session", leg, "--output", tmp_path / "o", "--mvc", "x.csv").code == 2


@pytest.mark.slow
@pytest.mark.usefixtures("words_alone")
def test_names_in_the_report_are_escaped(leg, tmp_path):
    trial = tmp_path / "<b>x.csv"
    shutil.copy(leg / "walk 1.csv", trial)
    result = surae.session(trial).run(**QUICK)
    result.report(tmp_path / "report.html")
    assert "<b>x" not in (tmp_path / "report.html").read_text()


def test_a_damaged_folder_is_told(tmp_path):
    with pytest.raises(InputError, match=r"this is no session: it has no session\.json"):
        surae.load_session(tmp_path)
    (tmp_path / "session.json").write_text('{"format": "surae session", "version": 99}')
    with pytest.raises(InputError, match="damaged, or of a newer surae"):
        surae.load_session(tmp_path)


@pytest.mark.slow
def test_measured_trials_by_the_plain_model(shared, tmp_path, run):
    """Ten files that were never prepared, one mapping whose zero comes from a quiet trial."""
    for part in ("dynamometer", "repeats"):
        for file in (shared / part).glob("*.mat"):
            shutil.copy(file, tmp_path)
    (tmp_path / "map.toml").write_text(
        "[channels.angle]\ncolumn='Angle'\nunit='deg'\nsign=-1\n"
        "[channels.torque]\ncolumn='Torque'\nunit='Nm'\nsign=-1\nzero='Pas_-15.mat'\n"
        "[channels.emg_ta]\ncolumn='EMG_TA'\nunit='V'\n[trials]\n'Pas_10'.use = false\n"
    )
    quick = ("--model", "muscle", "--starts", 1, "--fixed", "g2=0", "--fixed", "g3=0")
    done = run(
        "session", tmp_path, "--mapping", "map.toml", *quick, "--fixed", "g4=0", "--output", "out"
    )
    assert done.code == 0, done.err
    assert "Pas_10: left out by the description" in done.out
    result = surae.load_session(tmp_path / "out")
    assert len(result.fits) == 5
    predicted = result.predictions["PL_50_01"]["PL_50_02"]
    assert predicted.r2 > 95
    assert np.isfinite(result.joint_predictions["Pas_20"].bias)


@pytest.mark.slow
@pytest.mark.usefixtures("figures_made")
def test_trials_that_contradict_each_other_are_told(done, leg, other_leg, tmp_path):
    """A trial of another leg beside the joint fit."""
    for name in ("walk 1", "walk 2"):
        shutil.copy(leg / f"{name}.csv", tmp_path)
    shutil.copy(other_leg, tmp_path)
    session = surae.session(tmp_path)
    alone = {name: session.fit(name, **QUICK) for name in session.fitted}
    joined = ("walk 1", "walk 2")
    joint = session.fit(joined, **QUICK)
    surae.SessionResult(session, joint.settings, alone, joint, joined).report(tmp_path / "x.html")
    page = (tmp_path / "x.html").read_text()
    assert "contradict each other" in page
    disputed = re.findall(r"([a-z0-9_]+): [^<]* contradict each other", page)
    assert disputed
    assert "differ between trials" in page or "differs between trials" in page
    if {"k_tri", "x0_tri", "k_tib", "x0_tib", "k_rel"} & set(disputed):
        assert "relaxed · 95 %" not in page  # no stiffness of a model that trials contradict
    alike = (done[0] / "report.html").read_text()  # of trials of one leg
    assert alike.count("contradict each other") == 0


@pytest.fixture(scope="module")
def mapped(shared, tmp_path_factory):
    """Sessions of measured trials as `inspect` proposes them, both signs unset; and both turned."""
    folder = tmp_path_factory.mktemp("mapped")
    for name in ("PL_0_01", "PL_100_01", "Pas_5"):
        shutil.copy(shared / "repeats" / f"{name}.mat", folder)
    text = (
        "fixed={g2=0.0,g3=0.0,g4=0.0}\n[channels.angle]\ncolumn='Angle'\nunit='deg'\nsign=%d\n"
        "[channels.torque]\ncolumn='Torque'\nunit='Nm'\nsign=%d\n"
        "[channels.emg_ta]\ncolumn='EMG_TA'\nunit='V'\n"
    )
    results = []
    for sign in (1, -1):
        (folder / "map.toml").write_text(text % (sign, sign))
        session = surae.session(folder, mapping=folder / "map.toml")
        results.append(session.run(model="muscle", starts=1))
    return results


@pytest.mark.slow
@pytest.mark.usefixtures("figures_made")
def test_what_is_wrong_in_every_trial_is_the_mappings(mapped, tmp_path):
    turned, right = mapped
    assert turned.joined == ()
    assert turned.common[0].startswith(
        "The angle is reversed in 2 of 2 trials; correct it once for all of them"
    )
    assert "Write sign = -1 for the angle, sign = -1 for the torque" in turned.common[0]
    turned.report(tmp_path / "report.html")
    assert "correct it once for all of them" in (tmp_path / "report.html").read_text()
    assert right.common == ()
    assert set(right.fits) == {"PL_0_01", "PL_100_01"}


@pytest.mark.slow
def test_trials_that_are_mapped_rightly_are_fitted_together(mapped):
    """PL_100_01 too, whose calf has no electrode: its EMG was once called 600 ms late."""
    assert mapped[1].joined == ("PL_0_01", "PL_100_01")
