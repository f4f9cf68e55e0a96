"""A rehearsal without a person: real streams of a process of its own, recorded and judged."""

import json
import re
import signal

import pytest
from streaming import as_rehearsed, rehearsed, rehearsing, waited

from surae import read
from surae.protocol import Protocol, generate
from surae.studies import virtual_recording, virtual_subject

ROLES = {"angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm"}


@pytest.fixture(scope="module")
def made(lsl, tmp_path_factory):
    """A folder with a trial that broke off, and one more in which an electrode falls off."""
    folder = tmp_path_factory.mktemp("live")
    asked = Protocol(profile="multiple-holds", task="active", duration=10.0, rate_hz=1024.0)
    leg = virtual_recording(virtual_subject(3), generate(asked))
    as_rehearsed(leg, folder / "trial-01.xdf")
    whole = (folder / "trial-01.xdf").read_bytes()
    (folder / "trial-01.xdf").write_bytes(whole[:-40])
    (folder / "mapping.toml").write_text(
        "".join(
            f'[channels.{role}]\ncolumn = "{stream}: {role}"\nunit = "{unit}"\n'
            for role, stream, unit in [
                ("angle", "manipulator", "rad"),
                ("torque", "manipulator", "Nm"),
                *((role, "EMG", "V") for role in sorted(ROLES) if role.startswith("emg_")),
            ]
        )
    )
    lines, wrong = rehearsed(folder, "--seconds", "7", "--fault", "electrode-off@3")
    return folder, lines, wrong


def test_a_trial_is_recorded_and_an_electrode_that_fell_off_is_named(made) -> None:
    _, (line,), _ = made
    assert set(line) >= {"trial", "recording", "grade", "vaf", "findings", "seconds_to_verdict"}
    assert "electrode-off" in line["findings"]
    assert line["verdict"] == "repeat"
    assert "soleus" in line["advice"]
    assert re.search(r"come off at [34] s", line["advice"]), line["advice"]  # as asked: at 3 s
    recording = read(line["recording"])
    assert set(recording.channels) == ROLES
    angle = recording.channels["angle"]
    assert 7.5 < angle.time[-1] - angle.time[0] < 11.0


def test_what_broke_off_before_is_named_judged_and_numbered_on(made) -> None:
    folder, (line,), wrong = made
    assert line["trial"] == 2
    assert "trial 1 broke off" in wrong
    before = json.loads((folder / "trial-01.json").read_text(encoding="utf-8"))
    assert "broke off" in before["note"]
    assert before["lost_bytes"] > 0
    assert before["vaf"] > 98.0
    channels = read(before["recording"]).channels
    assert 9.0 < channels["emg_gm"].time[-1] < channels["angle"].time[-1]


@pytest.mark.slow
def test_a_good_trial_fits_and_a_spoilt_one_is_repeated(lsl, tmp_path) -> None:
    (good, spoilt), wrong = rehearsed(
        tmp_path, "--trials", "2", "--seconds", "20", "--fault", "electrode-off@12@2", limit=400
    )
    assert wrong == ""
    assert good["vaf"] > 98.0
    assert "electrode-off" not in good["findings"]
    assert good["verdict"] != "repeat"
    assert "electrode-off" in spoilt["findings"]
    assert spoilt["verdict"] == "repeat"
    what = r"electrode of the soleus .* come off at 1[23] s: .*Fix the electrode.* record again"
    assert re.search(what, spoilt["advice"]), spoilt["advice"]


@pytest.mark.slow
def test_a_killed_rehearsal_is_judged_at_the_next_start(lsl, tmp_path) -> None:
    with rehearsing(tmp_path, "--unattended", "--seconds", "60") as first:
        waited((tmp_path / "trial-01.xdf").exists, 200)
        waited(lambda: (tmp_path / "trial-01.xdf").stat().st_size > 1_400_000, 60)
        first.send_signal(signal.SIGKILL)
        first.wait(20.0)
    kept = json.loads((tmp_path / "trial-01.json").read_text(encoding="utf-8"))
    assert kept["state"] == "recording"
    (line,), wrong = rehearsed(tmp_path, "--seconds", "8", limit=300)
    assert "trial 1 broke off" in wrong
    assert line["trial"] == 2
    before = json.loads((tmp_path / "trial-01.json").read_text(encoding="utf-8"))
    assert before["vaf"] > 90.0
    angle = read(before["recording"]).channels["angle"]
    assert angle.time[-1] - angle.time[0] > 10.0
