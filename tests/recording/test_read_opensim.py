"""OpenSim storage files: headers, degrees, and columns that need a mapping."""

import math

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import read
from surae.recording.opensim import open_table
from surae.recording.source import open_source

IK = (
    "Coordinates\nversion=1\nnRows=3\nnColumns=3\ninDegrees=yes\n\nAngles are in degrees.\n\n"
    "endheader\ntime\tknee_angle_r\tankle_angle_r\n"
    "  0.00\t  1.0\t  90\n  0.01\t  2.0\t  45\n  0.02\t  3.0\t  0\n"
)
MAPPING = '[channels.angle]\nfile = "ik.sto"\ncolumn = "ankle_angle_r"\n'


@pytest.fixture
def ik(tmp_path):
    def write(ik: str = IK, mapping: str = MAPPING):
        (tmp_path / "ik.sto").write_text(ik)
        path = tmp_path / "map.toml"
        path.write_text(mapping)
        return path

    return write


@pytest.mark.parametrize("mapping", [MAPPING, MAPPING + 'unit = "deg"\n'])
def test_degrees_come_from_the_header_or_the_mapping(ik, mapping):
    angle = read(ik(mapping=mapping)).channels["angle"]
    np.testing.assert_allclose(angle.values, [math.pi / 2, math.pi / 4, 0])
    np.testing.assert_array_equal(angle.time, [0, 0.01, 0.02])
    assert angle.source == "ik.sto: ankle_angle_r [deg]"


def test_radians_come_from_the_header(ik):
    angle = read(ik(IK.replace("=yes", " = No"))).channels["angle"]
    np.testing.assert_array_equal(angle.values, [90, 45, 0])


def test_velocities_are_rotational_too(ik):
    more = MAPPING + MAPPING.replace("angle]", "angular_velocity]").replace("ankle", "knee")
    velocity = read(ik(mapping=more)).channels["angular_velocity"]
    np.testing.assert_allclose(velocity.values, np.deg2rad([1, 2, 3]))


@pytest.mark.parametrize(
    ("degrees", "unit", "stated"), [("yes", "rad", "deg"), ("no", "deg", "rad")]
)
def test_a_unit_that_contradicts_the_header(ik, degrees, unit, stated):
    path = ik(IK.replace("=yes", f"={degrees}"), MAPPING + f'unit = "{unit}"\n')
    with pytest.raises(InputError) as caught:
        read(path)
    for part in ("map.toml: channels.angle", "ik.sto", repr(unit), repr(stated), "ankle_angle_r"):
        assert part in str(caught.value)


def test_without_indegrees_the_mapping_must_say(ik):
    with pytest.raises(InputError, match=r"unit is missing .*'ankle_angle_r'.*: rad, deg"):
        read(ik(IK.replace("inDegrees=yes\n", "")))


def test_torque_needs_a_unit(ik):
    more = MAPPING + MAPPING.replace("angle]", "torque]")
    with pytest.raises(InputError, match=r"channels\.torque: unit is missing.*Nm"):
        read(ik(mapping=more))


def test_alone_it_is_refused_with_what_to_do(ik):
    path = ik().with_name("ik.sto")
    with pytest.raises(InputError, match=r"ik\.sto: .*TOML mapping.*'knee_angle_r'"):
        read(path)


def test_alone_it_is_read_when_the_columns_have_our_names(ik):
    text = IK.replace("ankle_angle_r", "angle_deg").replace("knee_angle_r", "Torque")
    recording = read(ik(text).with_name("ik.sto"))
    assert list(recording.channels) == ["angle"]
    np.testing.assert_allclose(recording.channels["angle"].values[0], math.pi / 2)
    with pytest.raises(InputError, match="contradicts"):
        read(ik(text.replace("=yes", "=no")).with_name("ik.sto"))


def test_names_may_hold_spaces_and_lines_end_in_tabs(ik):
    text = IK.replace("\tankle_angle_r\n", "\tankle angle\t\n").replace("  45\n", "  45\t\n")
    angle = read(ik(text, MAPPING.replace("ankle_angle_r", "ankle angle"))).channels["angle"]
    assert angle.values[1] == pytest.approx(math.pi / 4)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("  45", " abc", ["ik.sto: column 'ankle_angle_r', row 12", "'abc'"]),
        ("  45", " nan", ["ik.sto: column 'ankle_angle_r', row 12", "nan"]),
        ("  45", "", ["ik.sto: row 12", "2 cells", "3 columns"]),
        ("0.02", "0.01", ["ik.sto: column 'time', row 13", "doesn't increase"]),
        ("time\t", "t\t", ["ik.sto", "no column 'time'", "'knee_angle_r'"]),
        ("inDegrees=yes", "inDegrees=maybe", ["ik.sto: row 5", "'maybe'", "yes or no"]),
        ("  0.00\t  1.0\t  90\n  0.01\t  2.0\t  45\n  0.02\t  3.0\t  0\n", "", ["no samples"]),
    ],
)
def test_errors_name_column_and_row(ik, old, new, says):
    assert old in IK
    with pytest.raises(InputError) as caught:
        read(ik(IK.replace(old, new)))
    for part in says:
        assert part in str(caught.value)


def test_measured_gait(shared):
    recording = read(shared / "gait" / "walk36.toml")
    assert recording.name == "treadmill walk36, right ankle"
    assert recording.emg == "envelope"
    assert dict(recording.fixed) == {"m": 0.0}
    assert len(recording.channels) == 6
    assert [len(file.sha256) for file in recording.files] == [64] * 4
    angle, torque = recording.channels["angle"], recording.channels["torque"]
    assert angle.rate_hz == pytest.approx(100)
    assert angle.values[0] == pytest.approx(math.radians(10.42505039), abs=1e-9)
    id_table = open_table(open_source(shared / "gait" / "walk36" / "id.sto"))
    raw = id_table.load(["ankle_angle_r_moment"])["ankle_angle_r_moment"].values
    np.testing.assert_array_equal(torque.values, -raw)
    assert recording.channels["emg_sol"].unit == "1"
    assert recording.channels["emg_sol"].values[0] == 0.070021
    read(shared / "gait" / "run81.toml")
