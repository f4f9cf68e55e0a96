"""Files at the border: whole or not at all, on the disk, without names of folders or formulas."""

import csv
import fcntl
import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import surae
from surae.base import files

#: Writes half a file, says so, and waits to be ended.
_HALF = """
import sys, time
from surae import cli
from surae.base import files

def half(*_, **__):
    with files.atomic_file(sys.argv[1]) as handle:
        handle.write(b"half")
        handle.flush()
        print("writing", flush=True)
        time.sleep(60)

cli.group.main = half
cli.main()
"""


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_polite_kill_leaves_no_half_file(tmp_path, name) -> None:
    (tmp_path / "out.csv").write_text("before")
    process = subprocess.Popen(
        [sys.executable, "-c", _HALF, str(tmp_path / "out.csv")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    with process:
        assert process.stdout is not None
        assert process.stdout.readline() == "writing\n"
        process.send_signal(getattr(signal, name))
        assert process.wait(60) in (143, 129, 130)
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv"]
    assert (tmp_path / "out.csv").read_text() == "before"


def test_a_new_name_is_on_the_disk_too(tmp_path, monkeypatch) -> None:
    """A file whose folder is not written may be gone after a power cut."""
    synced: list[str] = []

    def sync(descriptor: int) -> None:
        synced.append(str(Path(f"/proc/self/fd/{descriptor}").readlink()))

    monkeypatch.setattr(files.os, "fsync", sync)
    files.write_atomic(tmp_path / "out.csv", "x")
    assert synced[0].endswith(".part")
    assert synced[1:] == [str(tmp_path)]


def test_on_a_mac_the_disk_itself_is_asked(tmp_path, monkeypatch) -> None:
    """What cannot be run here: the system's call is put in its place."""
    asked: list[int] = []
    monkeypatch.setattr(fcntl, "F_FULLFSYNC", 51, raising=False)
    monkeypatch.setattr(fcntl, "fcntl", lambda _, command: asked.append(command))
    files.write_atomic(tmp_path / "out.csv", "x")
    assert asked == [51]


@pytest.mark.parametrize(
    "text",
    [
        "=1+1",
        "+1",
        "-1",
        "@x",
        "\t=1",
        " =1",
        "a;=1",
        "a; @x",
        "a,+1",
        "a\n=1",
        "\r=1",
        "＝1",
        "=",
        "a|-1",
        '";=1',
    ],
)
def test_a_spreadsheet_runs_no_formula(text) -> None:
    line = files.csv_row(["S01", text, 1.5])
    (row,) = csv.reader([line.replace("\n", "⏎").replace("\r", "⏎").removesuffix("⏎")])
    for apart in (",", ";", "\t", "|", "⏎"):
        for cell in ("\x00".join(row)).replace(apart, "\x00").split("\x00"):
            assert cell.strip()[:1] not in "=+@-＝" or not cell.strip(), (apart, cell)
    assert line.endswith(",1.5\n")


def test_numbers_and_plain_texts_are_as_they_are() -> None:
    assert files.csv_row([-1.5, 0.1, 3, None, float("nan"), "S01", "a b", 'a"b', True]) == (
        '-1.5,0.1,3,,,S01,"a b","a""b",True\n'
    )


@pytest.mark.usefixtures("undrawn")
def test_what_leaves_the_house_says_no_folder(tmp_path, trial_csv) -> None:
    folder = tmp_path / "Jan Jansen"
    folder.mkdir()
    (folder / "trial.csv").write_bytes(trial_csv.read_bytes())
    fit = surae.fit(folder / "trial.csv", "muscle", prepared=True, starts=1)
    fit.save(tmp_path / "fit.json")
    fit.report(tmp_path / "report.html")
    for name in ("fit.json", "report.html"):
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert "trial.csv" in text
        assert "Jansen" not in text
        assert str(tmp_path) not in text
    assert json.loads((tmp_path / "fit.json").read_text())["recordings"][0]["path"] == "trial.csv"
    again = surae.load(tmp_path / "fit.json")
    assert again.result.problem.inputs == fit.result.problem.inputs


def test_a_folders_files_are_not_run(tmp_path) -> None:
    """`python -m` looks for modules in the current folder first, which holds somebody's data."""
    code = f"open({str(tmp_path / 'ran')!r}, 'w')"
    for name in ("click", "numpy", "h5py", "json", "secrets", "scipy", "fastapi"):
        (tmp_path / f"{name}.py").write_text(code)
    for command in ([Path(sys.executable).parent / "surae"], [sys.executable, "-m", "surae"]):
        done = subprocess.run(
            [*command, "check", "none.csv"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )
        assert done.returncode == 2
        assert "there is no such file" in done.stderr, done.stderr
    assert not (tmp_path / "ran").exists()
