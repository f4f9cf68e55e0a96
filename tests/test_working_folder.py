"""Files in the current folder that libraries would obey: they change nothing, nor stop anything."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SEEN = """
import surae
from surae.report import figures
import surae.model.jit, matplotlib, numba, os
assert numba.njit(lambda x: 2 * x)(2) == 4  # at every compilation the settings are read again
print(numba.config.DISABLE_JIT, matplotlib.rcParams["lines.linewidth"] < 50, os.getcwd())
"""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_settings_in_the_current_folder_are_not_obeyed(tmp_path: Path) -> None:
    (tmp_path / ".numba_config.yaml").write_text("disable_jit: 1\n")
    os.mkfifo(tmp_path / "matplotlibrc")  # who reads it waits for ever
    done = subprocess.run(
        [sys.executable, "-c", SEEN],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["0", "True", str(tmp_path)]
