"""`surae study`: resumes whatever happened to it, and its table is always the same."""

import csv
import os
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

from surae.cli import group
from surae.studies.study import FACTORS

from .conftest import refused
from .test_startup import COMPUTING, imported

#: Thirty fits of a hundredth of a second.
STUDY = """
name = "small"
protocol = "ramp-and-hold"
rate_hz = 50
starts = 1
chirp_amplitude = [0.0, 0.1, 0.2]
chirp_rate = [0.3, 0.5]
subjects = 6
"""
ROWS, FITS = 36, 30
#: Seconds that anything may take on a computer that is busy with other things.
PATIENCE = 300.0


@pytest.fixture
def study(tmp_path) -> Path:
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    return tmp_path


def start(folder: Path, *more: str, store: str = "s.db") -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "surae", "study", "run", "study.toml", "--store", store, *more],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finish(folder: Path, *more: str, store: str = "s.db") -> "subprocess.CompletedProcess[str]":
    with start(folder, *more, store=store) as process:
        out, err = process.communicate(timeout=PATIENCE)
    return subprocess.CompletedProcess([], process.returncode, out, err)


def outcomes(path: Path) -> dict[str, tuple[float, ...]]:
    """When and in which time every finished fit was computed, as the store has it."""
    if not path.exists():
        return {}
    file = sqlite3.connect(path, timeout=10)
    try:
        rows = file.execute("SELECT key, finished, value FROM result").fetchall()
    except sqlite3.OperationalError:  # killed before there was a table
        return {}
    finally:
        file.close()
    return {key: tuple(rest) for key, *rest in rows}


def numbers(path: Path) -> list[list[str]]:
    """The table without its last column, the seconds."""
    with path.open(newline="", encoding="utf-8") as handle:
        rows = list(csv.reader(handle))
    assert rows[0][-1] == "seconds"
    return [row[:-1] for row in rows]


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """The folder of a run that nothing disturbed."""
    folder = tmp_path_factory.mktemp("undisturbed")
    (folder / "study.toml").write_text(STUDY, encoding="utf-8")
    within("run", str(folder / "study.toml"), "--store", str(folder / "s.db"), "--workers", "1")
    return folder


@pytest.fixture(scope="module")
def undisturbed(finished) -> list[list[str]]:
    return exported(finished)


@pytest.fixture
def ran(study, finished) -> Path:
    """The study with its finished store, s.db, to change."""
    shutil.copy(finished / "s.db", study)
    return study


def exported(folder: Path, store: str = "s.db") -> list[list[str]]:
    said = within("export", str(folder / store), "--output", str(folder / "table.csv"))
    assert said == ""
    return numbers(folder / "table.csv")


def within(*arguments: str) -> str:
    """Run `surae study …` within this process; what it said on stderr."""
    done = CliRunner().invoke(group, ["study", *arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stderr


def test_run_status_export(run, study, finished, undisturbed) -> None:
    done = run("study", "run", "study.toml", "--store", "s.db", "--workers", 1)
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith("small: 30 fits (for 36 combinations), all there; 30 computed now")
    kept = outcomes(study / "s.db")
    again = run("study", "run", "study.toml", "--store", "s.db")
    assert "; 0 computed now" in again.out
    assert outcomes(study / "s.db") == kept
    status = run("study", "status", "s.db")
    assert status.out.startswith("small: 30 of 30 fits (for 36 combinations) done (100 %)\n")
    assert "last run: finished\n" in status.out
    done = run("study", "export", "s.db", "--output", "table.csv")
    assert (done.code, done.err) == (0, "")
    told = re.fullmatch(
        r"table: table\.csv, 36 rows; without its seconds it has the hash ([0-9a-f]{16})\n",
        done.out,
    )
    assert told
    shutil.copy(finished / "s.db", study / "t.db")  # by threads
    other = run("study", "export", "t.db", "--output", "u.csv").out
    assert other == done.out.replace("table.csv", "u.csv")  # though it took other times
    assert (study / "u.csv").read_bytes() != (study / "table.csv").read_bytes()
    table = numbers(study / "table.csv")
    assert table == undisturbed
    assert len(table) == 1 + ROWS
    named = {{"subjects": "subject", "repeats": "repeat"}.get(name, name) for name in FACTORS}
    assert set(table[0][: len(named)]) == named


def test_a_changed_setting_computes_only_what_it_touches(run, ran) -> None:
    (ran / "study.toml").write_text(STUDY.replace("[0.3, 0.5]", "[0.3, 0.6]"))
    done = run("study", "run", "study.toml", "--store", "s.db", "--workers", "1")
    assert "; 12 computed now" in done.out  # two amplitudes of six subjects at the new rate


def test_wrong_use_is_one_line(run, study) -> None:
    begin = ("study", "run", "study.toml", "--store")
    refused(run(*begin, "s.db", "--workers", "0"), "0 is not in the range 1<=x<=1000")
    refused(run(*begin, "s.db", "--workers", "2", "--dask", "tcp://h:1"), "--dask brings workers")
    refused(run(*begin, "study.toml"), "study.toml is read by this command")
    refused(run(*begin, "no/s.db"), "there is no folder")
    refused(run("study", "run", "none.toml", "--store", "s.db"), "there is no such file")
    refused(run("study", "status", "none.db"), "cannot read none.db: there is no such file")
    refused(run("study", "export", "none.db", "--output", "t.csv"), "there is no such file")
    refused(run("study", "export", "study.toml", "--output", "t.csv"), "is not a store of surae")
    (study / "study.toml").write_text('protocol = "sin"')
    refused(run(*begin, "s.db"), "study.toml: protocol is 'sin'; use one of: ramp-and-hold")
    assert not (study / "s.db").exists()


def test_the_table_never_replaces_the_store(run, ran) -> None:
    refused(run("study", "export", "s.db", "--output", "s.db"), "is read by this command")


def test_an_unfinished_study_is_exported_as_far_as_it_is(run, ran) -> None:
    file = sqlite3.connect(ran / "s.db")
    file.execute("DELETE FROM result WHERE key IN (SELECT key FROM plan WHERE row >= 34)")
    file.commit()
    file.close()
    done = run("study", "export", "s.db", "--output", "table.csv")
    assert done.code == 0
    assert done.out.startswith("table: table.csv, 34 rows;")
    assert done.err == "surae: 2 of 36 rows are left out: they are not done yet, or damaged\n"


def test_status_imports_no_library_that_computes(run, ran) -> None:
    assert imported(["study", "status", "s.db"], folder=ran) & COMPUTING == set()


def test_a_damaged_result_is_computed_again(run, ran) -> None:
    with closing(sqlite3.connect(ran / "s.db")) as file, file:
        file.execute("UPDATE result SET value = '{' WHERE key = (SELECT max(key) FROM result)")
    done = run("study", "run", "study.toml", "--store", "s.db", "--workers", "1")
    assert "; 1 computed now" in done.out


def until_some(folder: Path, process: "subprocess.Popen[str]", least: int) -> int:
    end = time.monotonic() + PATIENCE
    while len(seen := outcomes(folder / "s.db")) < least:
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)
    return len(seen)


@pytest.mark.slow
def test_status_tells_of_a_run_at_work_and_a_second_run_is_refused(study, undisturbed) -> None:
    (study / "study.toml").write_text(STUDY.replace("subjects = 6", "subjects = 2000"))
    with start(study, "--workers", "2") as process:
        try:
            until_some(study, process, 5)
            second = finish(study)
            assert second.returncode == 2
            assert f"s.db is in use by another run (process {process.pid} on" in second.stderr
            status = subprocess.run(
                [sys.executable, "-m", "surae", "study", "status", "s.db"],
                cwd=study,
                check=True,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
            )
            assert f"(process {process.pid} on " in status.stdout
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    told = re.search(r"([\d.]+) fits a second, about (\d+):(\d\d):(\d\d) left", status.stdout)
    done = re.match(r"small: ([\d,]+) of 10,000 fits", status.stdout)
    assert told, status.stdout
    assert done, status.stdout
    rate, hours, minutes, seconds = map(float, told.groups())
    left = 10_000 - int(done[1].replace(",", ""))
    assert abs((3600 * hours + 60 * minutes + seconds) * rate - left) < 0.2 * left
    assert (process.returncode, out) == (130, "")
    kept = len(outcomes(study / "s.db"))
    assert kept >= 5
    assert err == (
        f"surae: stopped by the user; {kept:,} of 10,000 fits are kept: run the same command to "
        "go on\n"
    )
    (study / "study.toml").write_text(STUDY)
    assert finish(study).returncode == 0
    assert exported(study) == undisturbed


def killed_at_random(folder: Path, moments: int, seed: int) -> list[int]:
    """Kill runs with signal 9 until they have been killed so often; fits there after each."""
    choice = random.Random(seed)
    kept: dict[str, tuple[float, ...]] = {}
    counts = []
    for _ in range(moments):
        with start(folder, "--workers", "2") as process:
            if choice.random() < 0.7 and len(kept) < FITS:  # among the fits, else while it starts
                end = time.monotonic() + PATIENCE
                while process.poll() is None and len(outcomes(folder / "s.db")) == len(kept):
                    assert time.monotonic() < end
                    time.sleep(0.001)
                time.sleep(choice.uniform(0.0, 0.05))
            else:
                time.sleep(choice.uniform(0.0, 1.5))
            process.kill()
        now = outcomes(folder / "s.db")
        assert kept.items() <= now.items()  # nothing lost, nothing computed twice
        kept = now
        counts.append(len(now))
    done = finish(folder)
    assert done.returncode == 0
    assert f"; {FITS - len(kept)} computed now" in done.stdout
    assert kept.items() <= outcomes(folder / "s.db").items()
    return counts


@pytest.mark.slow
def test_runs_killed_at_any_moment_lose_nothing(study, undisturbed) -> None:
    for seed in range(1, 9):  # on a busy computer a run may be through before it is killed
        (study / "s.db").unlink(missing_ok=True)
        counts = killed_at_random(study, 3, seed)
        if counts[-1] < FITS:
            break
    assert 0 < counts[-1] < FITS
    assert exported(study) == undisturbed


@pytest.mark.slow
def test_runs_killed_at_fifty_moments_lose_nothing(study, undisturbed) -> None:
    moments, seed = 50, 0
    while moments > 0:
        seed += 1
        (study / "s.db").unlink(missing_ok=True)
        counts = killed_at_random(study, min(10, moments), seed)
        assert exported(study) == undisturbed
        moments -= len(counts)


@pytest.mark.slow
def test_a_killed_worker_costs_a_retry(study, undisturbed) -> None:
    psutil = pytest.importorskip("psutil")
    with start(study, "--workers", "2") as process:
        until_some(study, process, 3)
        process.send_signal(signal.SIGSTOP)  # else it may be through before a worker is killed
        workers = [
            child
            for child in psutil.Process(process.pid).children(recursive=True)
            if "resource_tracker" not in " ".join(child.cmdline())
        ]
        workers[0].kill()
        process.send_signal(signal.SIGCONT)
        out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")
    assert "; 30 computed now" in out
    assert exported(study) == undisturbed


@contextmanager
def small_disk(folder: Path, size: str) -> Iterator[Path]:
    """A file system of a size; skips where it cannot be made."""
    if sys.platform != "linux" or os.geteuid() != 0 or not shutil.which("mount"):
        pytest.skip("a small disk can be mounted only by root on Linux")
    disk = folder / "disk"
    disk.mkdir()
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", disk],
        check=False,
        capture_output=True,
        text=True,
    )
    if done.returncode:
        pytest.skip(f"no small disk can be mounted: {done.stderr.strip()}")
    try:
        yield disk
    finally:
        subprocess.run(["umount", "-l", disk], check=True)


@pytest.mark.slow
def test_a_full_disk_is_one_line_and_the_run_goes_on_later(study, undisturbed) -> None:
    with small_disk(study, "192k") as disk:
        full = finish(study, "--workers", "2", store="disk/s.db")
        assert full.returncode == 1
        assert full.stderr.count("\n") == 1, full.stderr
        assert full.stderr.startswith("surae: disk/s.db: ")
        assert "make room on its disk and run the same command again" in full.stderr
        subprocess.run(["mount", "-o", "remount,size=20m", disk], check=True)
        kept = outcomes(disk / "s.db")
        assert 0 < len(kept) < FITS
        done = finish(study, "--workers", "2", store="disk/s.db")
        assert (done.returncode, done.stderr) == (0, "")
        assert kept.items() <= outcomes(disk / "s.db").items()
        assert exported(study, "disk/s.db") == undisturbed
