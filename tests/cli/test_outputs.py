"""Outputs that cannot be written are found before the work; inputs are never replaced."""

import os

import pytest

from .conftest import refused

COMMANDS = {
    "fit": ("fit", "trial.csv", "--model", "muscle", "--prepared"),
    "simulate": ("simulate", "trial.csv", "--parameters", "true.json"),
    "validate": ("validate", "fit.json", "trial.csv"),
}


@pytest.fixture(params=COMMANDS)
def command(request, run, files, monkeypatch):
    """A command whose work must not begin."""

    def never(*arguments: object, **options: object) -> None:
        pytest.fail("the work began")

    for name in ("fit_inputs", "simulate_parts", "validate"):
        monkeypatch.setattr(f"surae.api.{name}", never)
    return lambda output: run(*COMMANDS[request.param], "--output", output)


def test_in_a_folder_that_is_missing(command) -> None:
    refused(command("no where/out"), "no where/out", "make it first")


def test_onto_a_folder(command) -> None:
    refused(command("."), "cannot write .", "folder")


def test_without_a_name(command) -> None:
    refused(command(""), "--output is empty")


def test_in_a_folder_that_is_read_only(command, files, monkeypatch) -> None:
    folder = files / "locked"
    folder.mkdir()
    real = os.access
    # Not by chmod: to the superuser every folder is writable.
    monkeypatch.setattr("os.access", lambda p, mode: str(p) != str(folder) and real(p, mode))
    refused(command("locked/out"), "locked/out", "write-protected")


def test_onto_an_input(command, files) -> None:
    before = (files / "trial.csv").read_bytes()
    refused(command("trial.csv"), "trial.csv is read by this command")
    (files / "link.csv").symlink_to("trial.csv")
    refused(command("link.csv"), "link.csv is read by this command")
    assert (files / "trial.csv").read_bytes() == before


def test_onto_the_data_of_a_mapping(run, files) -> None:
    (files / "leg.toml").write_text(
        'emg = "envelope"\n[channels.angle]\nfile = "trial.csv"\ncolumn = "angle_rad"\n',
        encoding="utf-8",
    )
    refused(
        run("fit", "--model", "muscle", "leg.toml", "--output", "trial.csv"),
        "trial.csv is read by this command",
    )


def test_onto_parameters_and_fits(run, files) -> None:
    refused(run(*COMMANDS["simulate"], "--output", "true.json"), "true.json is read")
    refused(run(*COMMANDS["validate"], "--output", "fit.json"), "fit.json is read")


def test_two_outputs_in_one_file(run, files) -> None:
    done = run(*COMMANDS["fit"], "--output", "a", "--report", "./a")
    refused(done, "--report: ./a is the file of --output too")


def test_a_report_that_cannot_be_written(run, files) -> None:
    refused(run(*COMMANDS["fit"], "--report", "gone/r.html"), "gone/r.html", "make it first")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full on this system")  # noqa: PTH110
@pytest.mark.parametrize("name", COMMANDS)
def test_onto_a_disk_that_is_full(run, files, name) -> None:
    done = run(*COMMANDS[name], "--output", "/dev/full", *(["--starts", "1"] * (name == "fit")))
    refused(done, "/dev/full", "no space left")


def test_a_demo_in_the_place_of_a_file(run, files) -> None:
    refused(run("demo", "--output", "trial.csv"), "cannot make the folder trial.csv")
