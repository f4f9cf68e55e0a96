"""A small trial as files, and the command line run within this process."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from surae.cli import main
from surae.cli.progress import COMPILING
from surae.inference import fit_problem, make_problem
from surae.model import MODELS
from surae.protocol import Protocol, generate
from surae.recording import write_csv
from surae.studies import virtual_subject, virtual_trial


class Done(NamedTuple):
    """What a command left."""

    code: int
    out: str
    err: str


Run = Callable[..., Done]


@pytest.fixture(scope="session", autouse=True)
def compiled() -> None:
    """Compile every model beforehand, so that no process says that it does."""
    trial = virtual_trial(virtual_subject(1), generate(Protocol(profile="sine", rate_hz=20.0)))
    for model in MODELS:
        fit_problem(make_problem([trial], model), starts=2)


@pytest.fixture
def run(monkeypatch, capsys, tmp_path) -> Run:
    """Run `surae …` in an empty folder of its own, within this process.

    That something is compiled is not told: which test is the first to need it is chance.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)

    def command(*arguments: object) -> Done:
        capsys.readouterr()
        monkeypatch.setattr("sys.argv", ["surae", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            main()
        out, err = capsys.readouterr()
        return Done(int(exit_.value.code or 0), out, err.replace(f"{COMPILING}\n", ""))

    return command


@pytest.fixture(scope="session")
def made(tmp_path_factory) -> Path:
    """The files that tests start from: a trial, its true parameters and its fit."""
    folder = tmp_path_factory.mktemp("made")
    subject = virtual_subject(seed=3)
    profile = Protocol(
        profile="multi-sine-holds", chirp_amplitude=0.2, chirp_rate=0.1, rate_hz=48.0
    )
    motion = generate(profile)
    clean = virtual_trial(subject, motion, noise=0.0)
    assert clean.torque is not None
    noise = 0.3 * np.random.default_rng(1).standard_normal(clean.n)
    emg = {f"emg_{m}_V": clean.emg[:, i] for i, m in enumerate(("ta", "gl", "sol", "gm"))}
    table = {"time_s": clean.time, "angle_rad": clean.angle, "torque_Nm": clean.torque + noise}
    write_csv(folder / "trial.csv", table | emg)
    truth = {"parameters": dict(subject.parameters)}
    (folder / "true.json").write_text(json.dumps(truth), encoding="utf-8")

    from surae import fit

    fitted = fit(folder / "trial.csv", "muscle", prepared=True, start=subject.parameters, starts=1)
    assert fitted.status == "converged"
    fitted.save(folder / "fit.json")
    return folder


@pytest.fixture
def files(made, tmp_path) -> Path:
    """An own copy of `made`: trial.csv, true.json and fit.json."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    return tmp_path


@pytest.fixture
def edit(files) -> Callable[..., Path]:
    """Change the trial: a function of its header and rows, which are lists of cells."""

    def change(name: str, how: Callable[[list[str], list[list[str]]], None]) -> Path:
        lines = (files / "trial.csv").read_text(encoding="utf-8").splitlines()
        header, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
        how(header, rows)
        path = files / name
        path.write_text("".join(",".join(row) + "\n" for row in [header, *rows]), encoding="utf-8")
        return path

    return change


@pytest.fixture
def edit_fit(files) -> Callable[..., Path]:
    """Change FIT.json: a function of its content."""

    def change(name: str, how: Callable[[dict[str, object]], None]) -> Path:
        content = json.loads((files / "fit.json").read_text(encoding="utf-8"))
        how(content)
        (files / name).write_text(json.dumps(content), encoding="utf-8")
        return files / name

    return change


def refused(done: Done, *says: str, code: int = 2) -> None:
    """Assert one clear line on stderr, nothing on stdout, and the exit code."""
    assert done.code == code, done
    assert done.out == ""
    assert done.err.count("\n") == 1, done.err
    assert done.err.startswith("surae: ")
    assert "Traceback" not in done.err
    assert "internal error" not in done.err
    for text in says:
        assert text in done.err
