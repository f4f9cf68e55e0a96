"""What only a real process shows: pipes, terminals, signals, exit codes."""

import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

import surae

SURAE = Path(sys.executable).with_name("surae")
CONTRACT = Path(__file__).resolve().parents[3] / "shared" / "checks" / "contract"
FIT = ("fit", "--model", "muscle", "trial.csv", "--prepared", "--starts", "1")
#: Seconds that anything may take on a computer that is busy with other things.
PATIENCE = 300.0

pytestmark = pytest.mark.skipif(not SURAE.exists(), reason="no surae command beside this Python")


def run(*arguments: str, folder: Path, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [SURAE, *arguments],
        check=False,
        cwd=folder,
        stderr=subprocess.PIPE,
        text=True,
        timeout=PATIENCE,
        **options,
    )


def shell(script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {script}"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
        env=os.environ | {"SURAE": str(SURAE)},
    )


@pytest.mark.slow
def test_a_reader_that_goes_away_costs_nothing(files) -> None:
    done = shell('"$SURAE" ' + " ".join(FIT) + " --output f.json | head -n 1", files)
    assert (done.returncode, done.stdout, done.stderr) == (0, "muscle model [1.0]\n", "")
    done = shell('"$SURAE" ' + " ".join(FIT) + " --output g.json | true", files)
    assert (done.returncode, done.stderr) == (0, "")
    for name in ("f.json", "g.json"):
        assert surae.load(files / name).status == "converged"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_a_full_disk_behind_stdout_is_one_line(files) -> None:
    with Path("/dev/full").open("w") as full:
        done = run("inspect", "trial.csv", folder=files, stdout=full)
        assert done.returncode == 1
        assert done.stderr == "surae: stdout: No space left on device\n"
        done = run("--help", folder=files, stdout=full)
        assert done.returncode == 1
        assert done.stderr == "surae: stdout: No space left on device\n"


def test_without_stdout_the_work_is_done_all_the_same(files) -> None:
    done = shell('"$SURAE" inspect trial.csv --output map.toml >&-', files)
    assert (done.returncode, done.stderr) == (0, "")
    assert "[channels.angle]" in (files / "map.toml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_results_go_to_stdout_as_a_file(files) -> None:
    done = shell('"$SURAE" simulate trial.csv --parameters true.json --output /dev/stdout', files)
    assert done.returncode == 0
    assert "time_s,angle_rad,torque_Nm" in done.stdout


def test_a_terminal_that_knows_ascii_only(files) -> None:
    ascii_only = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = run("inspect", "trial.csv", folder=files, stdout=subprocess.PIPE, env=ascii_only)
    assert (done.returncode, done.stderr) == (0, "")
    assert "torque_Nm" in done.stdout


def test_errors_leave_with_their_code(files) -> None:
    done = run("fit", "--model", "muscle", "none.csv", folder=files, stdout=subprocess.PIPE)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "surae: cannot read none.csv: there is no such file\n"
    done = run(
        "--debug", "fit", "--model", "muscle", "none.csv", folder=files, stdout=subprocess.PIPE
    )
    assert done.returncode == 2
    assert done.stderr.startswith("Traceback")


def test_python_m_is_the_same_program(files) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "surae", "--version"],
        capture_output=True,
        check=False,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stdout) == (0, f"surae {surae.__version__}\n")


def _until(screen: int, pattern: str) -> None:
    """Read what a terminal shows, without its colours, until a pattern appears."""
    end, seen = time.monotonic() + PATIENCE, b""
    while not re.search(
        pattern, re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", seen.decode(errors="replace"))
    ):
        assert time.monotonic() < end, seen[-2000:]
        if select.select([screen], [], [], 1.0)[0]:
            seen += os.read(screen, 65536)


def _end(process: "subprocess.Popen[bytes]", screen: int) -> int:
    """Read on until a process ends, which a terminal full of unread text would keep it from."""
    end = time.monotonic() + PATIENCE
    while process.poll() is None:
        assert time.monotonic() < end
        if select.select([screen], [], [], 0.02)[0]:
            with suppress(OSError):  # closed at the other end
                os.read(screen, 65536)
    return process.returncode


def test_a_terminal_shows_how_far_the_fit_is_and_ctrl_c_keeps_the_best(files) -> None:
    screen, terminal = pty.openpty()
    arguments = [
        "fit",
        "--model",
        "muscle",
        "trial.csv",
        "--prepared",
        "--starts",
        "10000",
        "--output",
        "f.json",
    ]
    with subprocess.Popen(
        [SURAE, *arguments],
        cwd=files,
        stdout=subprocess.PIPE,
        stderr=terminal,
        stdin=terminal,
        text=True,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "80"},
    ) as process:
        os.close(terminal)
        try:
            _until(screen, r"fitting: start \d+ of 10000 .+ left \d+:\d\d:\d\d")
            process.send_signal(signal.SIGINT)
            _until(screen, "surae: stopped by the user; the best fit so far is shown and written")
            out = process.communicate(timeout=PATIENCE)[0]
        finally:
            process.kill()
            os.close(screen)
    assert process.returncode == 130
    assert "k_tri" in out
    assert "stopped by the user in start" in surae.load(files / "f.json").message


@pytest.mark.parametrize(
    ("arguments", "shows"),
    [
        pytest.param(["inspect", "trial.csv"], "reading trial.csv", marks=pytest.mark.slow),
        pytest.param(["convert", "trial.csv", "out.h5"], "writing out.h5", marks=pytest.mark.slow),
        pytest.param(["check", "trial.csv"], "checking trial.csv", marks=pytest.mark.slow),
    ],
)
def test_a_terminal_shows_what_is_being_done(files, arguments, shows) -> None:
    screen, terminal = pty.openpty()
    with subprocess.Popen(
        [SURAE, *arguments],
        cwd=files,
        stdout=subprocess.DEVNULL,
        stderr=terminal,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "80"},
    ) as process:
        os.close(terminal)
        try:
            _until(screen, shows)
            assert _end(process, screen) == 0
        finally:
            process.kill()
            os.close(screen)


@pytest.mark.slow
def test_the_contract(shared) -> None:
    if not CONTRACT.exists():
        pytest.skip("no contract check: the folder ../shared/checks is not beside the repository")
    done = subprocess.run(
        [sys.executable, CONTRACT],
        capture_output=True,
        check=False,
        text=True,
        timeout=600,
        env=os.environ | {"SURAE": str(SURAE)},
    )
    assert (done.returncode, done.stdout) == (0, "contract: all agree\n")
