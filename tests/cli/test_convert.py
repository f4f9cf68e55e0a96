"""`surae convert`: one recording in every format that is written."""

import numpy as np
import pytest

from surae.recording import read

from .conftest import refused


@pytest.mark.parametrize("name", ["out.h5", "out.HDF5", "out.csv"])
def test_formats_that_read_back_to_the_same_numbers(files, run, name):
    done = run("convert", "trial.csv", name)
    assert (done.code, done.err) == (0, "")
    assert done.out == f"converted: {name}\n"
    recording, again = read("trial.csv"), read(name)
    assert recording.channels.keys() == again.channels.keys()
    for role, channel in recording.channels.items():
        np.testing.assert_array_equal(channel.values, again.channels[role].values)
        np.testing.assert_array_equal(channel.time, again.channels[role].time)


def test_other_channels_are_prepared_first(files, run):
    text = (files / "trial.csv").read_text(encoding="utf-8")
    (files / "own.csv").write_text("# emg: envelope\n" + text, encoding="utf-8")
    done = run("convert", "own.csv", "out.csv", "--prepare")
    assert (done.code, done.err) == (0, "")
    assert "fit it with --prepared" in done.out
    recording = read("out.csv")
    assert recording.emg == "envelope"
    assert {"angular_velocity", "angular_acceleration"} <= recording.channels.keys()
    assert run("fit", "--model", "muscle", "out.csv", "--prepared", "--starts", "2").code == 0


def test_what_a_format_does_not_keep_is_said(files, run):
    (files / "map.toml").write_text(
        'side = "left"\nfixed = { m = 2.0 }\n[channels.angle]\nfile = "trial.csv"\n'
        'column = "angle_rad"\n',
        encoding="utf-8",
    )
    assert "not kept in this format: fixed, side" in run("convert", "map.toml", "a.csv").out
    assert "not kept" not in run("convert", "map.toml", "a.h5").out
    assert read("a.h5").side == "left"
    refused(run("convert", "map.toml", "trial.csv"), "is read by this command")


def test_a_film_is_kept_or_said_to_be_left_out(files, run):
    (files / "film.csv").write_text(
        "frame,FL\n" + "".join(f"{i},{60 + i % 7}\n" for i in range(60))
    )
    (files / "map.toml").write_text(
        'emg = "envelope"\n'
        + "".join(
            f'[channels.{role}]\nfile = "trial.csv"\ncolumn = "{role}_{unit}"\nunit = "{unit}"\n'
            for role, unit in (("angle", "rad"), ("torque", "Nm"), ("emg_ta", "V"))
        )
        + '[channels.fascicle_tib]\nfile = "film.csv"\ncolumn = "FL"\nunit = "mm"\n'
        "start_s = 0.5\nrate_hz = 30.0\n",
        encoding="utf-8",
    )
    for how in ((), ("--prepare",)):
        kept = f"kept{len(how)}.h5"
        done = run("convert", "map.toml", kept, *how)
        assert (done.code, done.err, "not kept" in done.out) == (0, "", False)
        film, again = read("map.toml").films["fascicle_tib"], read(kept).films["fascicle_tib"]
        np.testing.assert_array_equal(film.values, again.values)
        np.testing.assert_array_equal(film.time, again.time)
        said = run("convert", "map.toml", f"left{len(how)}.csv", *how).out
        assert "not kept in this format: fascicle_tib" in said


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("trial.csv", "out.xlsx"), ".xlsx is not written"),
        (("trial.csv", "trial.csv"), "is read by this command"),
        (("nothing.csv", "out.h5"), "there is no such file"),
        (("trial.csv", "no/out.h5"), "there is no folder"),
        (("trial.csv", "out"), "no ending is not written"),
        (("trial.csv",), "Missing argument"),
    ],
)
def test_wrong_use_is_one_line(files, run, arguments, says):
    refused(run("convert", *arguments), says)


def test_times_of_their_own(shared, run):
    mapping = shared / "dynamometer" / "PL_50_01.toml"
    refused(run("convert", mapping, "out.csv"), "times of their own", "--prepare")
    assert run("convert", mapping, "out.h5").code == 0
    assert read("out.h5").channels["torque"].time[0] == read(mapping).channels["torque"].time[0]
