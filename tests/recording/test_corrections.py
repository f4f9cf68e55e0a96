"""Signs, zeros, scales and electrodes put right without a mapping, and by a line of one."""

import numpy as np
import pytest

import surae
from surae.base.errors import InputError

HEADER = "time_s,angle_deg,torque_Nm,emg_ta_V,emg_sol_V"


@pytest.fixture
def file(tmp_path):
    rows = [f"{0.1 * k:.1f},{90 + k},{k},{k}e-6,{2 * k}e-6" for k in range(40)]
    path = tmp_path / "trial.csv"
    path.write_text("\n".join(["# emg: raw", HEADER, *rows]) + "\n")
    return path


def test_an_offset_is_in_the_files_unit_and_acts_before_the_sign(file) -> None:
    right = surae.read(file, offset={"angle": -90}, sign={"angle": -1}, scale={"torque": 72})
    k = np.arange(40.0)
    np.testing.assert_allclose(right.channels["angle"].values, -np.radians(k), atol=1e-12)
    np.testing.assert_allclose(right.channels["torque"].values, 72 * k)
    assert right.channels["angle"].source.endswith("put right: sign -1, offset -90")
    assert surae.read(file).channels["angle"].values[0] == pytest.approx(np.pi / 2)


def test_exchanged_electrodes_come_back_in_either_way(file, tmp_path) -> None:
    mapping = tmp_path / "map.toml"
    columns = {"angle": "angle_deg", "emg_ta": "emg_ta_V", "emg_sol": "emg_sol_V"}
    mapping.write_text(
        'swap = ["ta", "sol"]\n'
        + "".join(f'[channels.{role}]\ncolumn = "{name}"\n' for role, name in columns.items())
    )
    plain = surae.read(file)
    for right in (surae.read(file, swap=[("ta", "sol")]), surae.read(file, mapping=mapping)):
        for role, other in (("emg_ta", "emg_sol"), ("emg_sol", "emg_ta")):
            was = plain.channels[other].values
            np.testing.assert_array_equal(right.channels[role].values, was)
        assert right.channels["emg_ta"].role == "emg_ta"
        assert right.channels["emg_ta"].source.endswith("emg_sol_V [V], swapped")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"sign": {"angle": 2}}, "1 or -1"),
        ({"scale": {"torque": 0}}, "not 0"),
        ({"offset": {"angel": 1}}, "no such signal"),
        ({"offset": {"emg_gm": 1}}, "no emg_gm"),
        ({"swap": [("ta", "gm")]}, "no emg_gm"),
        ({"swap": [("ta", "tib")]}, "give two of"),
    ],
)
def test_what_no_recording_has_is_refused(file, wrong, words) -> None:
    with pytest.raises(InputError, match=words):
        surae.read(file, **wrong)


def test_a_session_puts_all_its_trials_right(file) -> None:
    (trial,) = surae.session([file], offset={"angle": -90}).trials
    assert trial.recording.channels["angle"].values[0] == pytest.approx(0.0, abs=1e-12)
