"""Signs, zeros, scales and electrodes put right without a mapping, and by a line of one."""

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.recording.corrections import Corrections

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
    assert right.channels["angle"].source.endswith("put right: offset -90, sign -1")
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


def test_jumps_by_a_period_are_taken_out_before_an_offset(file) -> None:
    wrapped = file.with_name("wrapped.csv")
    rows = [f"{0.1 * k:.1f},{(350 + k) % 360}" for k in range(40)]
    wrapped.write_text("\n".join(["time_s,angle_deg", *rows]) + "\n")
    right = surae.read(wrapped, wrap={"angle": 360}, offset={"angle": -350})
    np.testing.assert_allclose(right.channels["angle"].values, np.radians(np.arange(40.0)))


def test_the_lines_of_a_correction_do_what_it_does(file, tmp_path) -> None:
    """Also where a mapping, or an earlier correction, has changed the signal already."""
    mapping = tmp_path / "map.toml"

    def written(line: str) -> None:
        mapping.write_text(f'[channels.angle]\ncolumn = "angle_deg"\n{line}\n')

    written("sign = -1\noffset = -80\nscale = 2")
    mapped = surae.read(file, mapping=mapping)
    right = Corrections(sign={"angle": -1}, offset={"angle": 10})(mapped)
    again = Corrections(offset={"angle": 3}, scale={"angle": 0.5})
    lines = again.lines(right)
    toml, options = lines.removeprefix("Write ").split(" for the angle in the TOML, or give ")
    written(toml.replace(" and ", "\n"))
    wanted = again(right).channels["angle"].values
    np.testing.assert_allclose(surae.read(file, mapping=mapping).channels["angle"].values, wanted)
    written("sign = -1\noffset = -80\nscale = 2")
    words = options.removesuffix(".").split()
    given = {
        n[2:]: {"angle": float(v.split("=")[1])}
        for n, v in zip(words[::2], words[1::2], strict=True)
    }
    same = surae.read(file, mapping=mapping, **given)
    np.testing.assert_allclose(same.channels["angle"].values, wanted)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"sign": {"angle": 2}}, "1 or -1"),
        ({"scale": {"torque": 0}}, "not 0"),
        ({"offset": {"angel": 1}}, "no such signal"),
        ({"offset": {"emg_gm": 1}}, "no emg_gm"),
        ({"wrap": {"angle": 0}}, "a period"),
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
