"""The scripts that need no page: units in `js/`, run by Node's own runner."""

import shutil
import subprocess
from pathlib import Path

import playwright

import surae_workbench

UNITS = Path(__file__).parent / "js"
SCRIPTS = Path(surae_workbench.__file__).parent / "web" / "static" / "js"


def test_scripts_do_what_they_say(tmp_path) -> None:
    # The browser's driver, which the tests bring along, holds a Node of its own.
    node = shutil.which("node") or str(Path(playwright.__file__).parent / "driver" / "node")
    shutil.copytree(SCRIPTS, tmp_path / "js")
    units = sorted(UNITS.glob("*.test.mjs"))
    for unit in units:
        shutil.copy(unit, tmp_path)
    (tmp_path / "package.json").write_text('{"type": "module"}', encoding="utf-8")
    done = subprocess.run(
        [node, "--test", "--test-reporter=tap", *(unit.name for unit in units)],
        cwd=tmp_path,
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stdout
    assert "# pass 0" not in done.stdout
