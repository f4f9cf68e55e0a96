"""Of which files a recording is made."""

import pytest

from surae.base.errors import InputError
from surae.recording import files_of

CHANNELS = """
[channels.angle]
file = "{trial}-angle.csv"
column = "angle"
unit = "rad"
[channels.torque]
file = "{trial}-torque.csv"
column = "torque"
unit = "Nm"
"""


def test_a_plain_recording_is_one_file(tmp_path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time_s,angle_rad\n0,0\n")
    assert files_of(path) == (path,)


def test_a_mapping_is_made_of_itself_and_of_the_files_it_names(tmp_path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(CHANNELS.replace("{trial}", "one"))
    assert files_of(path) == tuple(
        tmp_path / name for name in ("a.toml", "one-angle.csv", "one-torque.csv")
    )


def test_a_trial_has_all_files_of_its_name_and_the_mapping(tmp_path) -> None:
    mapping = tmp_path / "of.toml"
    mapping.write_text(CHANNELS)
    expected = (tmp_path / "b-angle.csv", tmp_path / "b-torque.csv", mapping)
    assert files_of(tmp_path / "b-torque.csv", mapping) == expected
    with pytest.raises(InputError, match="this is none of them"):
        files_of(tmp_path / "b.csv", mapping)


def test_what_is_no_mapping_is_refused_as_one(tmp_path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time_s,angle_rad\n0,0\n")
    with pytest.raises(InputError, match="no TOML mapping"):
        files_of(path, path)
