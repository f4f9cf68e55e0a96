"""What a recording says of other programs' muscles: made by another muscle than those here."""

from pathlib import Path

import numpy as np
import pytest
from results_made import subject_text

import surae
from made_osim import HEADS, osim_text
from surae.base.errors import InputError
from surae.exchange.leg_in_model import leg_in_model
from surae.exchange.opinion import disputed_said, recording_said
from surae.recording import write_csv

RATE = 50.0


def hill(length, speed, numbers, active):
    """Force of a plain muscle: bell, line of speed, exponential tissue; its tendon rigid."""
    fibre, tendon, pennation, force = numbers
    along = np.maximum(length - tendon, 0.01 * fibre)
    own = np.hypot(along, fibre * np.sin(pennation)) / fibre
    slant = along / fibre / own
    bell = np.exp(-(((own - 1.0) / 0.45) ** 2))
    slow = np.clip(1.0 + 0.9 * speed * slant / fibre / 2.0, 0.1, 1.4)
    tissue = np.expm1(5.0 * np.maximum(own - 1.0, 0.0)) / np.expm1(3.0)
    return force * slant * (active * bell * slow + tissue)


def recording(folder: Path, seed: int, numbers=None) -> Path:
    """A recording of the right leg of the model in a folder, of muscles with these numbers."""
    rng = np.random.default_rng(seed)
    path = folder / "model.osim"
    rigid = "<ignore_tendon_compliance>true</ignore_tendon_compliance><max_isometric_force>"
    text = osim_text("gait").replace("<max_isometric_force>", rigid)
    path.write_text(text, encoding="utf-8")
    leg = leg_in_model(path)
    time = np.arange(0.0, 40.0, 1.0 / RATE)
    angle = sum(
        rng.uniform(2, 7) * np.sin(2 * np.pi * rate * time + rng.uniform(0, 6))
        for rate in (0.05, 0.11, 0.23, 0.4, 0.71)
    )
    angle = np.radians(22.0 * angle / np.abs(angle).max() - 3.0)
    speed = np.gradient(angle, time)
    torque = 12.0 * np.cos(angle) + 0.3 * rng.standard_normal(len(time))
    table = {"time_s": time, "angle_rad": angle}
    for head in leg.heads:
        emg = np.full(len(time), 0.005)
        for start in rng.uniform(0, 38, 12):
            emg[(time > start) & (time < start + rng.uniform(1, 3))] = rng.uniform(0.05, 0.4)
        emg = np.convolve(emg, np.ones(15) / 15, "same")
        active = emg.copy()
        for place in range(1, len(time)):
            active[place] = active[place - 1] + (emg[place] - active[place - 1]) * 0.3
        grid = np.linspace(angle.min(), angle.max(), 60)
        length = np.interp(angle, grid, leg.length(head, grid))
        arm = np.interp(angle, grid, leg.arm(head, grid))
        own = (numbers or {}).get(head.name[:-2], HEADS["gait"][head.name[:-2]][1])
        torque += arm * hill(length, arm * speed, own, active)
        table[f"emg_{head.kind}_V"] = 1e-3 * rng.uniform(0.5, 2.0) * emg
    file = folder / "leg.csv"
    write_csv(file, {**table, "torque_Nm": torque}, ["emg: envelope"])
    return file


def judged(folder: Path, file: Path):
    return surae.judge(folder / "model.osim", recording=file).results[0]


@pytest.mark.parametrize("seed", range(3))
def test_a_recording_does_not_speak_against_the_muscles_that_made_it(tmp_path, seed) -> None:
    result = judged(tmp_path, recording(tmp_path, seed))
    assert result.recording.r2 > 95.0
    assert "contradicted" not in result.recording.verdicts().values()
    assert "contradicted" not in {kind for value in result.values for kind in value.kinds}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("apart", [-0.035, -0.02])
def test_it_speaks_against_a_muscle_that_is_not_the_one_and_blames_no_other(
    tmp_path, seed, apart
) -> None:
    fibre, tendon, *rest = HEADS["gait"]["soleus"][1]
    file = recording(tmp_path, seed, {"soleus": (fibre, tendon + apart, *rest)})
    of = judged(tmp_path, file).recording
    verdicts = of.verdicts()
    against = {m for (m, _), verdict in verdicts.items() if verdict == "contradicted"}
    disputed = {m for (m, _), verdict in verdicts.items() if verdict == "disputed"}
    assert against <= {"soleus_r"}
    assert "soleus_r" in against | disputed
    assert (of.r2 < 75.0) == ("no more than" in str(recording_said(of)))
    said = disputed_said(of)
    assert (said is None) == (not disputed)


def test_a_page_and_files_have_it_in_every_language(tmp_path) -> None:
    fibre, tendon, *rest = HEADS["gait"]["soleus"][1]
    file = recording(tmp_path, 0, {"soleus": (fibre, tendon - 0.035, *rest)})
    opinion = surae.judge(tmp_path / "model.osim", recording=file)
    plain = opinion.as_dict()["results"][0]["recording"]
    assert len(plain["told"]) == 8
    assert f"{plain['r2']:.3g} %" in "\n".join(opinion.summary)
    for language, word in {
        "en": "speaks against them",
        "nl": "spreekt ze tegen",
        "de": "spricht gegen sie",
        "fr": "parle contre eux",
    }.items():
        page = tmp_path / f"{language}.html"
        opinion.report(page, language=language)
        assert word in page.read_text(encoding="utf-8")


def test_what_a_recording_needs_is_said_in_a_line(tmp_path) -> None:
    file = recording(tmp_path, 0)
    subject = tmp_path / "subject.xml"
    muscles = {"soleus_r": {"optimalFibreLength": 0.05, "tendonSlackLength": 0.255}}
    subject.write_text(subject_text(muscles), encoding="utf-8")
    with pytest.raises(InputError, match="give the OpenSim model"):
        surae.judge(subject, recording=file)
    beside = surae.judge(subject, recording=file, model=tmp_path / "model.osim")
    assert beside.results[0].recording.told[0].value == 0.05
    other = {"vaslat_r": muscles["soleus_r"]}
    subject.write_text(subject_text(other), encoding="utf-8")
    with pytest.raises(InputError, match="none of the leg's muscles"):
        surae.judge(subject, recording=file, model=tmp_path / "model.osim")
    text = file.read_text(encoding="utf-8").replace("emg_sol_V", "emg_sol_s")
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError):
        surae.judge(tmp_path / "model.osim", recording=file)
