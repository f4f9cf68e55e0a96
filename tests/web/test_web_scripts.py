"""The scripts that need no page: units in `js/`, run by Node's own runner."""

import shutil
import subprocess
from pathlib import Path

import pytest

import surae

UNITS = Path(__file__).parent / "js"
SCRIPTS = Path(surae.__file__).parent / "web" / "static" / "js"


@pytest.mark.parametrize("unit", sorted(path.name for path in UNITS.glob("*.test.mjs")))
def test_scripts_do_what_they_say(unit, tmp_path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("SCRIPTS NOT TESTED: node is not installed")
    shutil.copytree(SCRIPTS, tmp_path / "js")
    shutil.copy(UNITS / unit, tmp_path)
    (tmp_path / "package.json").write_text('{"type": "module"}', encoding="utf-8")
    done = subprocess.run(
        [node, "--test", "--test-reporter=tap", unit],
        cwd=tmp_path, check=False, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert "# pass 0" not in done.stdout
