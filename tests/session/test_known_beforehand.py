"""A folder with a session.toml: its steps are used, what it states is in the fit and shown."""

import json

import numpy as np
import pytest

import surae
from surae import InputError
from surae.recording import write_csv
from surae.recording.recording import MUSCLES

RATE = 64.0


def recorded(folder, name, angle, torque, emg) -> None:
    time = np.arange(len(angle)) / RATE
    columns = {"time_s": time, "angle_rad": angle, "torque_Nm": torque}
    columns |= {f"emg_{m}_V": emg[i] for i, m in enumerate(MUSCLES)}
    write_csv(folder / f"{name}.csv", columns, ["emg: envelope"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An empty device, contractions one after the other, and two trials of a leg on the device."""
    folder = tmp_path_factory.mktemp("laboratory")
    rng = np.random.default_rng(5)
    time = np.arange(round(24 * RATE)) / RATE
    angle = 0.5 * np.sin(2.0 * np.pi * (0.1 * time + 0.01 * time**2))
    plate = 4.0 * np.cos(angle - 0.3) + 0.02 * np.gradient(np.gradient(angle, 1 / RATE), 1 / RATE)
    quiet = 1e-6 * rng.random((4, len(time)))
    recorded(folder, "empty", angle, plate + 0.02 * rng.standard_normal(len(time)), quiet)
    pulls = np.clip(np.sin(2.0 * np.pi * 0.4 * time), 0.0, 1.0)
    burst = np.stack([pulls, *[np.roll(pulls, round(1.2 * RATE))] * 3]) * 1e-4
    leg = plate + 3.0 * np.exp(2.0 * angle) + 30.0 * np.roll(pulls, round(1.2 * RATE))
    for name in ("one", "two"):
        recorded(folder, name, angle, leg + 0.1 * rng.standard_normal(len(time)), quiet + burst)
    hold = np.zeros(round(48 * RATE))
    alone = np.stack([(np.arange(len(hold)) // RATE % 48 // 12 == i) for i in range(4)])
    alone = alone * 1e-4 * (np.arange(len(hold)) / RATE % 4.0 < 3.0)
    noise = 1e-6 * rng.random((4, len(hold)))
    recorded(folder, "fourth", hold, 10.0 + 1e-3 * noise[0], alone + noise)
    (folder / "session.toml").write_text(
        "[knowledge]\nangle_zero_deg = {value = 0.0, sd = 1.0}\n"
        "axis_mm = {value = 0.0, sd = 3.0}\n\n[trials]\n'two.csv' = 'active'\n"
    )
    return folder


def test_steps_are_recognised_and_used(folder) -> None:
    session = surae.session(folder)
    assert {t.name: t.use for t in session.trials} == {
        "empty": "device",
        "fourth": "crosstalk",
        "one": "fit",
        "two": "fit",
    }
    assert session["two"].stated
    known = session.knowledge
    assert known.plate.file == "empty.csv"
    assert known.plate.values[0] == pytest.approx(0.02, abs=0.003)
    assert known.crosstalk_of == "fourth.csv"
    assert all(stated.value < 0.02 for stated in known.crosstalk.values())
    assert known.axis_mm.sd == 3.0
    assert not known.doubts


@pytest.mark.slow
def test_the_joint_fit_has_what_was_known(folder, tmp_path) -> None:
    session = surae.session(folder)
    with pytest.raises(InputError, match="axis_mm has no effect with model muscle"):
        session.fit(model="muscle")
    fit = session.fit()
    (one, _) = fit.result.problem.inputs
    raw = surae.read(folder / "one.csv")
    apart = np.interp(one.time, raw["torque"].time, raw["torque"].values) - one.torque
    assert apart.mean() == pytest.approx(4.0 * np.cos(one.angle - 0.3).mean(), abs=0.1)
    assert fit.settings.zero_sd == pytest.approx(np.hypot(1.0, 2.3))
    fit.save(tmp_path / "joint.json")
    stored = json.loads((tmp_path / "joint.json").read_text())
    assert '"axis_mm": {"value": 0.0, "sd": 3.0}' in json.dumps(stored)
    assert surae.load(tmp_path / "joint.json").settings == fit.settings
    fit.report(tmp_path / "r.html")
    assert "What was known beforehand" in (tmp_path / "r.html").read_text(encoding="utf-8")


def test_a_file_that_is_not_there_is_told(folder, tmp_path) -> None:
    for path in folder.glob("*.csv"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "session.toml").write_text("[trials]\n'on.csv' = 'active'\n")
    with pytest.raises(InputError, match=r"no on.csv .did you mean 'one"):
        surae.session(tmp_path)


def test_a_leg_called_empty_is_doubted(folder, tmp_path) -> None:
    for name in ("one", "two"):
        (tmp_path / f"{name}.csv").write_bytes((folder / f"{name}.csv").read_bytes())
    (tmp_path / "session.toml").write_text("[knowledge]\nplate = 'two.csv'\n")
    known = surae.session(tmp_path).knowledge
    assert known.plate is None
    assert "no empty device" in known.doubts[0]
