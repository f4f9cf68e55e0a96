"""A shell completes commands and options, by what click brings."""

import os
import subprocess
import sys
from pathlib import Path

from surae.cli import COMMANDS

SURAE = Path(sys.executable).with_name("surae")


def completed(words: str, at: int) -> set[str]:
    asked = {"_SURAE_COMPLETE": "bash_complete", "COMP_WORDS": words, "COMP_CWORD": str(at)}
    done = subprocess.run(
        [SURAE], env=os.environ | asked, capture_output=True, text=True, check=False
    )
    return {line.partition(",")[2] for line in done.stdout.splitlines()}


def test_bash_completes_commands_and_options() -> None:
    assert completed("surae pro", 1) == {name for name in COMMANDS if name.startswith("pro")}
    assert "--strict" in completed("surae check --", 2)
