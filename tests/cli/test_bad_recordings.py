"""Recordings that cannot be used: one line that names the file and the place, before any work."""

import math

import pytest

from .conftest import refused


@pytest.fixture
def fit(run):
    return lambda *arguments: run(
        "fit", "--model", "muscle", "--prepared", *arguments, "--output", "out.json"
    )


def _cell(row: int, column: int, text: str):
    def change(header, rows) -> None:
        rows[row - 2][column] = text  # row 1 is the header

    return change


def _rename(old: str, new: str):
    def change(header, rows) -> None:
        header[header.index(old)] = new

    return change


def _drop(name: str):
    def change(header, rows) -> None:
        column = header.index(name)
        for row in [header, *rows]:
            del row[column]

    return change


def _fill(name: str, text: str):
    def change(header, rows) -> None:
        for row in rows:
            row[header.index(name)] = text

    return change


def _keep(count: int):
    def change(header, rows) -> None:
        del rows[count:]

    return change


def _degrees(header, rows) -> None:
    for row in rows:
        row[1] = repr(math.degrees(float(row[1])))


@pytest.mark.parametrize(
    ("how", "says"),
    [
        (_rename("torque_Nm", "torque_lbf"), ("'torque_lbf'", "row 1", "Nm, mNm")),
        (_cell(12, 2, "NaN"), ("'torque_Nm'", "row 12", "nan")),
        (_keep(10), ("10 samples",)),
        (_fill("angle_rad", "0.1"), ("angle never changes", "0.1 rad")),
        (_drop("torque_Nm"), ("no torque",)),
        (_drop("emg_sol_V"), ("'sol'", "emg_sol", "g3=0")),
        (_fill("emg_ta_V", "-1e-4"), ("emg_ta", "negative")),
        (_degrees, ("angle_deg", "rad, which no ankle does")),
    ],
)
def test_a_wrong_csv(fit, edit, how, says) -> None:
    path = edit("bad trial.csv", how)
    refused(fit(path.name), "bad trial.csv: ", *says)
    assert not (path.parent / "out.json").exists()


def test_what_is_no_recording(fit, files) -> None:
    refused(fit("none.csv"), "none.csv", "no such file")
    (files / "nothing").mkdir()
    refused(fit("nothing"), "nothing", "no recording")
    (files / "empty.csv").write_bytes(b"")
    refused(fit("empty.csv"), "empty.csv", "empty")
    (files / "noise.csv").write_bytes(bytes(range(256)) * 20)
    refused(fit("noise.csv"), "noise.csv", "binary", "CSV")
    refused(fit("fit.json"), "fit.json", "a fit, not a recording", "surae validate FIT.json")
    refused(fit("/dev/null"), "/dev/null", "device")


def test_the_same_recording_twice_would_count_double(fit, files) -> None:
    refused(fit("trial.csv", "./trial.csv"), "./trial.csv", "double")


def test_a_line_break_in_a_name_stays_on_the_line(fit, files) -> None:
    refused(fit("no\nsuch.csv"), "cannot read no such.csv: there is no such file")


MAPPING = """name = "a leg"
emg = "envelope"
[channels.angle]
file = "trial.csv"
column = "angle_rad"
[channels.torque]
file = "trial.csv"
column = "torque_Nm"
""" + "".join(
    f'[channels.emg_{m}]\nfile = "trial.csv"\ncolumn = "emg_{m}_V"\n'
    for m in ("ta", "gl", "sol", "gm")
)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"a leg"', '"a leg', ("TOML", "line 1")),
        ('"trial.csv"', '"gone.csv"', ("channels.angle", "gone.csv", "no such file")),
        ('"torque_Nm"', '"torq_Nm"', ("channels.torque", "'torq_Nm'", "'torque_Nm'")),
        ('name = "a leg"', "fixed = { mass = 1.0 }", ("fixed", "'mass'", "k_tri")),
        ("[channels.angle]", "[prepare]\nrate = 9\n[channels.angle]", ("'rate'", "rate_hz")),
    ],
)
def test_a_wrong_mapping(run, files, old, new, says) -> None:
    assert old in MAPPING
    (files / "leg.toml").write_text(MAPPING.replace(old, new, 1), encoding="utf-8")
    refused(run("fit", "--model", "muscle", "leg.toml"), "leg.toml: ", *says)


def test_the_mapping_itself_is_right(run, files) -> None:
    (files / "leg.toml").write_text(MAPPING, encoding="utf-8")
    done = run("fit", "--model", "muscle", "leg.toml", "--prepared", "--starts", 1)
    assert done.code == 0
    assert "a leg: VAF" in done.out
