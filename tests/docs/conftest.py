"""What the commands and snippets of the documentation find in their folder."""

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.io import savemat

import surae
from made_osim import osim_text
from perturbed_ankle import Ankle, ramps
from surae.base.units import FloatArray
from surae.model import ModelOptions, adapted, get_model
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES, csv_columns, write_csv, write_hdf5
from surae.signals import ModelInputs
from surae.studies import virtual_subject, virtual_trial

#: Headings of a laboratory's own, for `surae inspect`.
_LAB = {
    "time_s": "Time (s)",
    "angle_rad": "Ankle Angle (deg)",
    "torque_Nm": "Ankle Torque (Nm)",
    "emg_ta_V": "TA (mV)",
    "emg_gl_V": "GL (mV)",
    "emg_sol_V": "SOL (mV)",
    "emg_gm_V": "GM (mV)",
}
#: What their units are, seen from ours.
_TO_LAB = {"angle_rad": 180.0 / np.pi} | {f"emg_{muscle}_V": 1e3 for muscle in MUSCLES}
_STUDY = """
name = "small"
protocol = "multiple-holds"
chirp_amplitude = [0.1, 0.2]
chirp_rate = 0.3
subjects = 1
rate_hz = 50
starts = 1
seed = 1
"""


def _columns(trial: ModelInputs) -> dict[str, FloatArray]:
    assert trial.torque is not None
    emg = {f"emg_{muscle}_V": trial.emg[:, i] for i, muscle in enumerate(MUSCLES)}
    return {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque} | emg


def _of_a_wrist(files: Path) -> dict[str, np.ndarray]:
    """Twelve seconds of the example's wrist."""
    t = np.arange(0.0, 12.0, 0.01)
    columns = {"time_s": t, "angle_rad": 0.5 * np.sin(t) + 0.1 * np.sin(5.0 * t)}
    columns |= {
        f"emg_{m}_V": 2e-4 * np.clip(np.sin(1.3 * t + k), 0.0, None) ** 2
        for k, m in enumerate(("ta", "gl", "sol"))
    }
    wrist = {"joint": files / "joint.toml", "geometry": files / "geometry.csv"}
    start = adapted(get_model("muscle").parameters, ModelOptions.of(**wrist))
    values = {n: p.start for n, p in start.items()} | {"g4": 0.0}
    still = columns | {"torque_Nm": 0.0 * t}
    table = pd.DataFrame(still | {"emg_gm_V": 0.0 * t})
    torque = surae.simulate("muscle", values, table, **wrist)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(t))
    return still | {"torque_Nm": torque + noise}


@pytest.fixture(scope="session")
def prepared(tmp_path_factory) -> Path:
    """Every file that a page takes for granted, small."""
    folder = tmp_path_factory.mktemp("documentation")
    subject = virtual_subject(seed=1)
    trials = {
        name: virtual_trial(
            subject,
            generate(Protocol(profile=profile, chirp_amplitude=0.2, duration=20.0, rate_hz=50.0)),
            seed=seed,
        )
        for seed, (name, profile) in enumerate(
            {"trial": "multiple-holds", "other": "multi-sine-holds"}.items()
        )
    }
    for name, trial in trials.items():
        write_csv(folder / f"{name}.csv", _columns(trial), ["emg: envelope"])
    for seed, name in enumerate(("perturbed", "relaxed", "effort", "device")):
        foot = {} if name != "device" else {"stiffness": 0.0, "inertia": 0.005, "gain": 0.0}
        moved = Ankle(seconds=25.0, rate=200.0, **foot).moved(seed)
        columns = zip(("time_s", "angle_rad", "torque_Nm"), moved.values(), strict=True)
        write_csv(folder / f"{name}.csv", dict(columns))
    for name, speeds in {"slow": (10.0, 10.0), "fast": (120.0, 120.0)}.items():
        write_csv(folder / f"{name}.csv", csv_columns(ramps(speeds, neural=6.0, rate=200.0)))
    for name, source in {
        "a": "trial",
        "b": "other",
        "trial1": "trial",
        "trial2": "other",
        "mvc": "other",
        "in": "trial",
    }.items():
        shutil.copy(folder / f"{source}.csv", folder / f"{name}.csv")
    (folder / "trials").mkdir()
    for name in trials:
        shutil.copy(folder / f"{name}.csv", folder / "trials")
    for person in ("S01",):  # a second one would only take time
        (folder / "cohort" / person).mkdir(parents=True)
        shutil.copy(folder / "trial.csv", folder / "cohort" / person / "trial.csv")
    columns = _columns(trials["trial"])
    write_csv(folder / "lab.csv", {_LAB[n]: _TO_LAB.get(n, 1.0) * columns[n] for n in columns})
    shutil.copy(Path(__file__).parents[1] / "data" / "geometry.csv", folder)
    shutil.copytree(Path(__file__).parents[2] / "examples" / "wrist", folder / "wrist")
    write_csv(folder / "wrist.csv", _of_a_wrist(folder / "wrist"), ["emg: envelope"])
    (folder / "leg").mkdir()
    for name, source in {"trial1": "trial", "trial2": "other", "rest": "trial"}.items():
        own = _columns(trials[source])
        if name == "rest":  # nothing happens in it
            own |= {
                still: np.full_like(own[still], own[still][0]) for still in own if still != "time_s"
            }
        laboratory = {_LAB[n]: _TO_LAB.get(n, 1.0) * own[n] for n in own}
        write_csv(folder / "leg" / f"{name}.csv", laboratory)
    for name in ("map", "corrected"):
        (folder / f"{name}.toml").write_text(_mapping())
    write_hdf5(folder / "recording.h5", surae.read(folder / "trial.csv"))
    bent = "".join(f"{n / 50}\t{10 + n % 40}\n" for n in range(1001))
    (folder / "walk36").mkdir()
    (folder / "walk36" / "ik.sto").write_text(
        f"ik\ninDegrees=yes\nendheader\ntime\tknee_angle_r\n{bent}"
    )
    shown = np.arange(0.0, 18.0, 0.03)
    region = np.empty(2, [("FL", object), ("Time", object)])
    region[:] = [(60.0 + np.sin(shown), shown)] * 2
    savemat(folder / "trial_tracked.mat", {"Fdat": {"Region": region}})
    (folder / "study.toml").write_text(_STUDY)
    (folder / "p.json").write_text(json.dumps({"parameters": dict(subject.parameters)}))
    fit = surae.fit(folder / "trial.csv", "muscle", starts=1)
    fit.save(folder / "fit.json")
    for name in ("before", "after", "leg1", "leg2", "leg3"):
        shutil.copy(folder / "fit.json", folder / f"{name}.json")
    rows = "".join(f"leg{i}.json,S{i},left\n" for i in (1, 2, 3))
    (folder / "legs.csv").write_text(f"fit,subject,side\n{rows}")
    (folder / "scaled.osim").write_text(osim_text("gait"), encoding="utf-8")
    (folder / "docs").mkdir()
    return folder


def _mapping() -> str:
    """The laboratory's file, described as the page on it says."""
    units = {"angle": "deg", "torque": "Nm"} | {f"emg_{muscle}": "mV" for muscle in MUSCLES}
    tables = [
        f'[channels.{name.rsplit("_", 1)[0]}]\nfile = "lab.csv"\ncolumn = "{column}"\n'
        f'unit = "{units[name.rsplit("_", 1)[0]]}"\n'
        for name, column in _LAB.items()
        if name != "time_s"
    ]
    return 'name = "lab"\nemg = "envelope"\n\n' + "\n".join(tables)


@pytest.fixture
def workplace(prepared, tmp_path, monkeypatch) -> Path:
    """A copy of them to write in, as the current folder."""
    folder = tmp_path / "work"
    shutil.copytree(prepared, folder)
    monkeypatch.chdir(folder)
    return folder
