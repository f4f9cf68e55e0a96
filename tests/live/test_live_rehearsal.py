"""A rehearsal without a person: real streams of a process of its own, recorded and judged."""

import json
import subprocess
import sys

import pytest

from surae import read


def rehearsed(folder, *arguments: str) -> list[dict]:
    done = subprocess.run(
        [sys.executable, "-m", "surae", "live", "--rehearse", "--unattended",
         "--output", str(folder), *arguments],
        check=False, capture_output=True, text=True, timeout=400,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def made(lsl, tmp_path_factory):
    """Two trials of 20 s; in the second an electrode falls off at 12 s."""
    folder = tmp_path_factory.mktemp("live")
    lines = rehearsed(folder, "--trials", "2", "--seconds", "20", "--fault", "electrode-off@12@2")
    return folder, lines


def test_each_trial_has_a_line(made) -> None:
    folder, lines = made
    assert [line["trial"] for line in lines] == [1, 2]
    for line in lines:
        assert set(line) >= {
            "trial", "recording", "grade", "vaf", "findings", "seconds_to_verdict",
        }  # fmt: skip
        assert line["seconds_to_verdict"] > 0
        recording = read(line["recording"])
        angle = recording.channels["angle"]
        assert 20.5 < angle.time[-1] - angle.time[0] < 24.0
        assert set(recording.channels) == {
            "angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm",
        }  # fmt: skip
    assert (folder / "trial-01.xdf").exists()


def test_a_good_trial_fits_and_a_spoilt_one_is_named(made) -> None:
    _, (good, spoilt) = made
    assert good["vaf"] > 98.0
    assert "mains-hum" not in good["findings"]
    assert good["verdict"] != "repeat"
    assert "mains-hum" in spoilt["findings"]
    assert spoilt["verdict"] == "repeat"
    assert "soleus" in spoilt["advice"]


def test_the_folder_is_taken_up_again(made) -> None:
    folder, _ = made
    (line,) = rehearsed(folder, "--trials", "1", "--seconds", "8")
    assert line["trial"] == 3
