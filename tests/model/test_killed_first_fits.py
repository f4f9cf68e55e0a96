"""First fits of an installation, begun two at a time and killed: the next one is right."""

import json
import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def begun(folder: Path, trial: Path, name: str) -> subprocess.Popen:
    words = ["fit", str(trial), "--model", "muscle", "--starts", "2", "--output", name]
    return subprocess.Popen(
        [sys.executable, "-m", "surae", *words],
        cwd=folder,
        env={**os.environ, "SURAE_CACHE": str(folder / "cache")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def values(path: Path) -> dict[str, float]:
    found = json.loads(path.read_text("utf-8"))["parameters"]
    return {name: p["value"] for name, p in found.items()}


@pytest.mark.parametrize("pairs", [1])
def test_after_two_that_were_killed_the_next_is_right(tmp_path, trial_csv, pairs) -> None:
    chance = random.Random(72)
    before = begun(tmp_path, trial_csv, "whole.json")
    begin = time.monotonic()
    assert before.communicate()[1] is not None
    whole = time.monotonic() - begin
    expected = values(tmp_path / "whole.json")
    for pair in range(pairs):
        folder = tmp_path / f"pair-{pair}"
        folder.mkdir()
        two = [begun(folder, trial_csv, f"{k}.json") for k in range(2)]
        for each in two:
            time.sleep(chance.uniform(0.02, 0.4) * whole)
            each.kill()
        for each in two:
            each.communicate()
        last = begun(folder, trial_csv, "next.json")
        _, said = last.communicate()
        assert last.returncode == 0, said
        assert "surae:" not in said
        assert values(folder / "next.json") == expected
        assert not [path.name for path in folder.glob("*.json") if path.name == "0.json.part"]
