"""`surae cite` and `surae completion`."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from surae.cli import COMMANDS

from .conftest import Run, refused

SURAE = Path(sys.executable).with_name("surae")


def test_without_a_fit_the_program_and_the_thesis_are_cited(run: Run) -> None:
    done = run("cite")
    assert done.code == 0
    assert "surae developers" in done.out
    assert "Estimating ankle muscle parameters" in done.out


def test_bibtex_entries(run: Run) -> None:
    out = run("cite", "--bibtex").out
    assert out.count("\n@") == 5
    assert "@mastersthesis{vandepoll2015" in out


def test_a_fit_names_its_methods(run: Run, files: Path) -> None:
    out = run("cite", files / "fit.json").out
    assert "least squares within bounds: Moré" in out


def test_a_missing_fit_is_refused(run: Run) -> None:
    refused(run("cite", "none.json"), "none.json")


@pytest.mark.parametrize("shell", ["zsh", "fish", "bash"])
def test_completion_scripts_ask_surae(run: Run, shell: str) -> None:
    done = run("completion", shell)
    assert done.code == 0
    assert f"_SURAE_COMPLETE={shell}_complete" in done.out


def completed(words: str, at: int) -> set[str]:
    asked = {"_SURAE_COMPLETE": "bash_complete", "COMP_WORDS": words, "COMP_CWORD": str(at)}
    done = subprocess.run(
        [SURAE], env=os.environ | asked, capture_output=True, text=True, check=False
    )
    return {line.partition(",")[2] for line in done.stdout.splitlines()}


def test_bash_completes_commands_and_options() -> None:
    assert completed("surae pro", 1) == {name for name in COMMANDS if name.startswith("pro")}
    assert "--bibtex" in completed("surae cite --", 2)
