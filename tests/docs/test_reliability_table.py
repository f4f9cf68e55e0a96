"""The table of smallest detectable changes is what was counted, on every page that has it."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def counted() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "reliability", ROOT / "benchmarks" / "reliability.py"
    )
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_pages_have_the_table_of_the_last_count(counted: ModuleType) -> None:
    result = json.loads(counted.RESULT.read_text(encoding="utf-8"))
    for page in counted.PAGES:
        text = page.read_text(encoding="utf-8")
        assert counted.written(text, result) == text, f"{page.name}: run it with --write"
        assert text.count(counted.BEGIN) == 1


def test_the_count_is_as_large_as_it_was_asked_to_be(counted: ModuleType) -> None:
    result = json.loads(counted.RESULT.read_text(encoding="utf-8"))
    assert result["pairs"] >= 40
    assert set(result["measures"]) == set(counted.SHOWN)
    for own in result["measures"].values():
        assert 0.0 <= own["icc"] <= 1.0
        assert own["holds"][0] <= own["holds"][1]
