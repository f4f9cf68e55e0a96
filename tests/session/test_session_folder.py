"""The folder of results: never over the user's files, never a fit that is not of this run."""

import json
import shutil
from contextlib import suppress
from types import SimpleNamespace

import pytest

import surae
from surae.api.answers import fit_of
from surae.api.session_run import run
from surae.base.errors import InputError
from surae.cohorts.members import quantities_of
from surae.trials.folder import require_own
from undrawn import blank_figures, few_legs

QUICK = {"model": "muscle", "prepared": True, "starts": 1}


@pytest.fixture(scope="module")
def walks(leg, tmp_path_factory):
    """Two trials in a folder, and their results."""
    folder = tmp_path_factory.mktemp("walks")
    for name in ("walk 1", "walk 2"):
        shutil.copy(leg / f"{name}.csv", folder)
    out = tmp_path_factory.mktemp("results") / "out"
    with blank_figures(made=False), few_legs():
        return folder, out, surae.session(folder).run(out, **QUICK)


def content(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_folder_of_the_recordings_is_no_place_for_results(walks, tmp_path, run):
    leg = tmp_path / "leg"
    shutil.copytree(walks[0], leg)
    shutil.copy(leg / "walk 1.csv", leg / "table.csv")  # which the results would replace
    before = content(leg)
    done = run("session", leg, "--output", leg, "--model", "muscle", "--prepared", "--workers", 1)
    assert done.code == 2
    assert "holds the recordings themselves" in done.err
    with pytest.raises(InputError, match="holds the recordings themselves"):
        walks[2].__class__(surae.session(leg), walks[2].settings).save(leg)
    assert content(leg) == before


@pytest.mark.parametrize(
    "name", ["table.csv", "report.html", "joint.json", "session.json", "fits/walk_1.json"]
)
def test_what_is_no_result_is_never_replaced(walks, tmp_path, name):
    (tmp_path / "fits").mkdir()
    (tmp_path / name).write_text("mine")
    for write in (
        lambda: surae.session(walks[0]).run(tmp_path, **QUICK),
        lambda: walks[2].save(tmp_path),
    ):
        with pytest.raises(InputError, match="is not a result of this session"):
            write()
    assert (tmp_path / name).read_text() == "mine"
    assert len(content(tmp_path)) == 1


@pytest.mark.parametrize("names", [("walk 1", "walk_1"), ("walk", "Walk")])
def test_two_trials_of_one_file_name_are_refused(walks, tmp_path, names):
    for name in names:
        shutil.copy(walks[0] / "walk 1.csv", tmp_path / f"{name}.csv")
    session = surae.session(tmp_path)
    with pytest.raises(InputError, match=r"would both be .*rename one of the trials"):
        session.run(tmp_path / "out", **QUICK)
    assert not (tmp_path / "out").exists()


def test_a_trial_called_joint_is_refused(walks, tmp_path):
    for name in ("joint", "walk 2"):
        shutil.copy(walks[0] / "walk 2.csv", tmp_path / f"{name}.csv")
    with pytest.raises(InputError, match=r"called 'joint'.*rename it"):
        surae.session(tmp_path).run(**QUICK)


@pytest.mark.usefixtures("undrawn")
def test_fits_of_an_earlier_run_are_not_taken_for_this_ones(walks, tmp_path):
    folder, done, _ = walks
    out = tmp_path / "out"
    shutil.copytree(done, out)
    (out / "fits" / "mine.json").write_text("the user's")
    assert fit_of(out) == fit_of(done)
    alone = surae.session(folder / "walk 1.csv").run(out, **QUICK)
    assert alone.joint is None
    assert sorted(p.name for p in (out / "fits").iterdir()) == ["mine.json", "walk_1.json"]
    assert not (out / "joint.json").exists()
    assert (out / "trash" / "1-joint.json").read_bytes() == (done / "joint.json").read_bytes()
    assert surae.load_session(out).rows() == alone.rows()


@pytest.mark.usefixtures("undrawn")
def test_a_run_that_was_stopped_tells_no_older_joint_fit(walks, tmp_path, monkeypatch):
    """A change of settings, stopped before the joint fit: the older one stands for nothing."""
    folder, done, _ = walks
    out = tmp_path / "out"
    shutil.copytree(done, out)

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "fit_inputs", stopped)
    surae.session(folder).run(out, **QUICK, fixed={"beta": 1.0})
    with pytest.raises(InputError, match=r"no joint one \(it was stopped\)"):
        surae.change(out, done)
    told = quantities_of(path=str(out), angles=[10.0], priors=None)
    assert "no joint one" in told["error"]


@pytest.mark.usefixtures("undrawn")
def test_a_killed_run_leaves_an_index_and_goes_on(walks, tmp_path, monkeypatch):
    folder, _, result = walks
    out, whole, calls = tmp_path / "out", run.fit_inputs, []

    def killed(*given):
        calls.append(given)
        if len(calls) == 2:
            raise SystemExit(137)  # no code of ours runs any more
        return whole(*given)

    monkeypatch.setattr(run, "fit_inputs", killed)
    with pytest.raises(SystemExit):
        surae.session(folder).run(out, **QUICK)
    assert json.loads((out / "session.json").read_text())["interrupted"] is True
    monkeypatch.setattr(run, "fit_inputs", whole)
    told = []
    again = surae.session(folder).run(out, progress=told.append, **QUICK)
    assert any("(kept)" in step.outcome for step in told)
    assert again.rows() == result.rows()


@pytest.mark.usefixtures("undrawn")
def test_an_index_cannot_have_other_files_removed(walks, tmp_path):
    folder, done, _ = walks
    out = tmp_path / "out"
    shutil.copytree(done, out)
    (tmp_path / "mine.json").write_text("the user's")
    index = json.loads((out / "session.json").read_text())
    index["results"] += ["../mine.json", "fits/../../mine.json", str(tmp_path / "mine.json")]
    (out / "session.json").write_text(json.dumps(index))
    surae.session(folder).run(out, **QUICK)
    assert (tmp_path / "mine.json").exists()


def of_fit(*names, sums=()):
    """What is asked of the recordings of a fit."""
    files = tuple(SimpleNamespace(name=f"{n}.csv", sha256=s) for n, s in zip(names, sums))  # noqa: B905
    return [SimpleNamespace(name=name, files=files) for name in names]


def indexed(folder, **trials):
    """An index of trials, each with the checksum of its file, if it has one."""
    rows = [
        {"name": name, "fit": None, "files": [{"name": f"{name}.csv", "sha256": s}] if s else []}
        for name, s in trials.items()
    ]
    (folder / "session.json").write_text(json.dumps({"format": "surae session", "trials": rows}))


def test_a_fit_of_other_recordings_than_the_folders_is_refused(tmp_path):
    """Somebody copied another subject's joint.json here, or exchanged the fits of two trials."""
    require_own(tmp_path, of_fit("x"))  # nothing in the folder says whose it is
    indexed(tmp_path, a="1", b="2")
    require_own(tmp_path, of_fit("a", sums=["1"]))
    require_own(tmp_path, of_fit("code 17", sums=["1"]))  # names may be changed
    with pytest.raises(InputError, match="of other recordings"):
        require_own(tmp_path, of_fit("a", sums=["9"]))
    require_own(tmp_path, of_fit("a", sums=["1"]), "a")
    with pytest.raises(InputError, match="of other recordings"):
        require_own(tmp_path, of_fit("a", sums=["1"]), "b")
    indexed(tmp_path, a=None)
    require_own(tmp_path, of_fit("a, 0 to 60 s"))
    with pytest.raises(InputError, match="of other recordings"):
        require_own(tmp_path, of_fit("b"))


def test_fits_of_two_trials_that_were_exchanged_are_refused(walks, tmp_path):
    _, out, _ = walks
    copy = tmp_path / "out"
    shutil.copytree(out, copy)
    assert surae.load_session(copy).fits
    fits = sorted((copy / "fits").glob("*.json"))
    whole = [path.read_bytes() for path in fits]
    for path, data in zip(fits, reversed(whole), strict=True):
        path.write_bytes(data)
    with pytest.raises(InputError, match="files were exchanged"):
        surae.load_session(copy)


def test_a_joint_fit_beside_other_recordings_is_refused(walks, tmp_path):
    recording = next(walks[0].glob("*.csv"))
    shutil.copy(recording, tmp_path)
    require_own(tmp_path, of_fit(recording.stem))
    with pytest.raises(InputError, match="of other recordings"):
        require_own(tmp_path, of_fit("somebody-else"))


@pytest.mark.parametrize("index", ["[]", '{"format": "surae session", "trials": 3}', "{"])
def test_a_damaged_index_believes_no_fit_by_accident(tmp_path, index):
    (tmp_path / "session.json").write_text(index)
    with suppress(InputError):
        require_own(tmp_path, of_fit("x", sums=["1"]))
