"""A leg's folder of trials, and the command line run within this process."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import surae
from surae import simulate
from surae.cli import main
from surae.protocol import Protocol, generate
from surae.recording import write_csv
from surae.studies import virtual_subject, virtual_trial
from undrawn import blank_figures, few_legs


class Done(NamedTuple):
    """What a command left."""

    code: int
    out: str
    err: str


@pytest.fixture
def run(monkeypatch, capsys, tmp_path):
    """Run `surae …` in an empty folder of its own, within this process."""
    monkeypatch.chdir(tmp_path)

    def command(*arguments) -> Done:
        capsys.readouterr()
        monkeypatch.setattr("sys.argv", ["surae", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            main()
        return Done(int(exit_.value.code or 0), *capsys.readouterr())

    return command


@pytest.fixture
def undrawn(monkeypatch) -> None:
    """Reports without figures and words, which take longer than small fits: nobody reads them."""
    monkeypatch.setattr(
        "surae.SessionResult.report", lambda _, path: path.write_text("", encoding="utf-8")
    )


@pytest.fixture
def words_alone():
    """Reports without figures: their words are what is read."""
    with blank_figures(made=False):
        yield


@pytest.fixture
def figures_made():
    """Reports whose figures are made, of what is unusual, and not drawn."""
    with blank_figures():
        yield


def rows(n=400, rate=200.0, angle=0.2, torque=5.0, emg=0.0, seed=0):
    """The lines of a laboratory's table: crank in degrees, load in Nm, one EMG in mV."""
    time = np.arange(n) / rate
    rng = np.random.default_rng(seed)
    crank = np.rad2deg(angle) * np.sin(2 * np.pi * 0.5 * time)
    load = torque + 10 * np.sin(2 * np.pi * 0.5 * time)
    noise = 0.01 * rng.standard_normal(n) + emg * rng.standard_normal(n) * (time > time[-1] / 2)
    lines = ["time,crank,load,muscle"]
    lines += [
        f"{t:.6f},{a:.6f},{b:.6f},{e:.6f}"
        for t, a, b, e in zip(time, crank, load, noise, strict=True)
    ]
    return "\n".join(lines) + "\n"


@pytest.fixture
def table():
    return rows


@pytest.fixture(scope="session")
def leg(tmp_path_factory):
    """A virtual leg's folder: two trials that move, one that is passive, a hold, a bad file."""
    folder = tmp_path_factory.mktemp("leg")
    subject = virtual_subject(seed=3)
    for number, name in enumerate(("walk 1", "walk 2")):
        write_trial(folder / f"{name}.csv", virtual_trial(subject, generate(MOVES), seed=number))
    trial = virtual_trial(subject, generate(MOVES), seed=5)
    quiet = replace(trial, emg=1e-3 * trial.emg)
    torque = simulate("muscle", subject.parameters, quiet)
    write_trial(folder / "passive.csv", replace(quiet, torque=torque))
    still = 0.1 + 0.001 * trial.angle
    held = replace(trial, angle=still, velocity=0 * still, acceleration=0 * still)
    torque = simulate("muscle", subject.parameters, held)
    write_trial(folder / "hold.csv", replace(held, torque=torque))
    (folder / "broken.csv").write_text("time_s,angle_rad\n0,1\n1,x\n")
    (folder / "LICENSE").write_text("not a recording")
    return folder


MOVES = Protocol(
    profile="multiple-holds",
    chirp_amplitude=0.2,
    chirp_rate=0.2,
    rate_hz=50.0,
    task="active",
    duration=20.0,
)


def write_trial(path, trial):
    """A prepared trial as our CSV, of which a fit says prepared=True."""
    names = ("emg_ta_V", "emg_gl_V", "emg_sol_V", "emg_gm_V")
    write_csv(
        path,
        {
            "time_s": trial.time,
            "angle_rad": trial.angle,
            "torque_Nm": trial.torque,
            **{name: trial.emg[:, i] for i, name in enumerate(names)},
        },
        ["emg: envelope"],
    )


@pytest.fixture(scope="session")
def relaxed_trial():
    """Write a relaxed trial of a leg whose foot lay turned by so much [rad]."""

    def write(path, seed, turned=0.0):
        subject = virtual_subject(seed=seed)
        trial = virtual_trial(subject, generate(MOVES), seed=5)
        quiet = replace(trial, emg=1e-3 * trial.emg)
        torque = simulate("muscle", subject.parameters, quiet)
        write_trial(path, replace(quiet, torque=torque, angle=quiet.angle + turned))

    return write


@pytest.fixture(scope="session")
def other_leg(tmp_path_factory):
    """A trial of another leg."""
    path = tmp_path_factory.mktemp("other") / "other.csv"
    write_trial(path, virtual_trial(virtual_subject(seed=8), generate(MOVES), seed=1))
    return path


@pytest.fixture(scope="session")
def done(leg, tmp_path_factory):
    """The leg's session, fitted: its folder and its result."""
    folder = tmp_path_factory.mktemp("out")
    with blank_figures(made=False), few_legs():
        return folder, surae.session(leg).run(folder, model="muscle", prepared=True, starts=1)
