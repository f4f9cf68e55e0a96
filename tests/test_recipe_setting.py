"""The recipe "Add a setting of a fit" of CONTRIBUTING, followed in a copy of the tree."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import surae
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject, virtual_trial

PACKAGE = Path(surae.__file__).parent
RECIPES = PACKAGE.parents[1] / "CONTRIBUTING.md"
#: What is asked of the copy: how each part of the product sees the new setting.
SEEN = """
import inspect, json, sys
import surae
from surae_workbench.web.form import form
from surae_workbench.web.schemas import DraftChange

def refused(value):
    try:
        DraftChange(patience=value)
    except ValueError:
        return True
    return False

older = surae.FitSettings().as_dict()
del older["patience"]
json.dump({
    "home": surae.__file__,
    "doc": inspect.getdoc(surae.fit),
    "keywords": list(inspect.signature(surae.fit).parameters),
    "form": [row for row in form() if row["path"] == ["patience"]],
    "request": DraftChange(patience=5).plain(),
    "refused": [refused(0), refused("often"), refused(1)],
    "older": surae.FitSettings.from_dict(older).patience,
}, sys.stdout)
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Run Python in a copy of the package to which the recipe's field was added."""
    copy = tmp_path_factory.mktemp("copy")
    shutil.copytree(PACKAGE, copy / "surae", ignore=shutil.ignore_patterns("__pycache__", "vendor"))
    recipe = RECIPES.read_text(encoding="utf-8").split("## Add a setting of a fit")[1]
    named, field = re.search(
        r"`src/(surae/\w+\.py)`.*?```python\n(.*?)```", recipe, re.DOTALL
    ).groups()
    file = copy / named
    fields, methods = file.read_text(encoding="utf-8").split("    def __post_init__", 1)
    file.write_text(f"{fields}{field}\n    def __post_init__{methods}", encoding="utf-8")
    # Nothing is compiled anew for the copy.
    env = {**os.environ, "PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "COLUMNS": "100"}

    def run(*arguments: str) -> str:
        done = subprocess.run(
            [sys.executable, *arguments],
            env=env, cwd=copy, capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def test_a_field_is_an_option_a_keyword_a_request_and_a_field_of_the_form(run) -> None:
    seen = json.loads(run("-c", SEEN))
    assert Path(seen["home"]).parent != PACKAGE
    assert "patience : int, default 3\n    How many searches may fail" in seen["doc"]
    assert "patience" in seen["keywords"]
    (row,) = seen["form"]
    assert (row["label"], row["kind"], row["least"], row["default"]) == ("Patience", "whole", 1, 3)
    assert seen["request"] == {"patience": 5}
    assert seen["refused"] == [True, True, False]
    assert seen["older"] == 3


def test_a_field_is_in_help_and_in_a_fit(run, tmp_path) -> None:
    for command in ("fit", "session"):
        said = " ".join(run("-m", "surae", command, "--help").split())
        assert "--patience N How many searches may fail before a fit gives up. [default: 3]" in said
    motion = generate(Protocol(profile="multiple-holds", rate_hz=16.0))
    made = virtual_trial(virtual_subject(3), motion)
    columns = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque}
    columns |= {f"emg_{m}_V": made.emg[:, i] for i, m in enumerate(MUSCLES)}
    surae.write_csv(tmp_path / "trial.csv", columns, ["emg: envelope"])
    fit = ["-m", "surae", "fit", str(tmp_path / "trial.csv"), "--model", "muscle", "--prepared"]
    run(*fit, "--starts", "1", "--patience", "7", "--output", str(tmp_path / "fit.json"))
    saved = json.loads((tmp_path / "fit.json").read_text(encoding="utf-8"))
    assert saved["settings"]["patience"] == 7
