"""Figures of changes are what was counted, on every page that has them."""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


def benchmark(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    sys.modules[name] = made  # its records look for their module
    spec.loader.exec_module(made)
    return made


@pytest.fixture(scope="module")
def counted() -> ModuleType:
    return benchmark("reliability")


def test_pages_have_the_table_of_the_last_count(counted: ModuleType) -> None:
    result = json.loads(counted.RESULT.read_text(encoding="utf-8"))
    for page in counted.PAGES:
        text = page.read_text(encoding="utf-8")
        assert counted.written(text, result) == text, f"{page.name}: run it with --write"
        assert text.count(counted.BEGIN) == 1


def test_the_count_is_as_large_as_it_was_asked_to_be(counted: ModuleType) -> None:
    result = json.loads(counted.RESULT.read_text(encoding="utf-8"))
    for way in result["ways"].values():
        assert 40 <= way["pairs"] <= 2 * len(result["legs"])
        assert set(way["measures"]) == set(counted.SHOWN)
        for own in way["measures"].values():
            assert own["icc"] is None or 0.0 <= own["icc"] <= 1.0
            for key in ("holds", "false", "found"):
                assert 0 <= own[key][0] <= own[key][1] <= way["pairs"]


def test_the_one_leg_of_the_page_is_that_of_the_command() -> None:
    change = benchmark("change")
    kept = json.loads(change.CASE_KEPT.read_text(encoding="utf-8"))
    page = change.CASE_PAGE.read_text(encoding="utf-8")
    assert change.with_case(page, kept) == page, "run it with --case"
    assert set(kept["rows"]) == set(change.CASE_ROWS)


def test_the_cohorts_counts_are_those_of_the_command() -> None:
    groups = benchmark("groups")
    kept = json.loads(groups.RESULT.read_text(encoding="utf-8"))
    page = groups.PAGE.read_text(encoding="utf-8")
    assert groups.written(page, kept) == page, "run it with --write"
    for told in kept["measures"].values():
        assert all(0 <= n <= groups.TIMES for key in ("false", "found") for n in told[key])
