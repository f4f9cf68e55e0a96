"""The house as a reader feels it: small functions, and a page that says what is there."""

import tomllib

import house

CONFIG = tomllib.loads((house.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["ruff"]
RULES = {"C901", "PLR0912", "PLR0913", "PLR0915"}
TESTS = ("tests/", "legs/tests/")


def test_the_formatter_has_the_last_word() -> None:
    """But for tables of numbers and records, of which there are few."""
    everywhere = [where for folder in house.FOLDERS for where in house.unformatted(folder)]
    of_tests = [where for where in everywhere if where.startswith(TESTS)]
    assert len(of_tests) <= 40
    assert len(everywhere) - len(of_tests) <= 60


def test_complexity_is_held_down_everywhere_but_where_a_reason_is_named() -> None:
    lint = CONFIG["lint"]
    chosen = lint["select"]
    assert all(any(rule.startswith(some) for some in chosen) for rule in RULES)
    assert not RULES & {*lint["ignore"]}
    assert lint["mccabe"] == {"max-complexity": 15}
    assert lint["pylint"] == {"max-args": 8}
    freed = {
        file: RULES & {*codes}
        for file, codes in lint["per-file-ignores"].items()
        if RULES & {*codes}
    }
    assert freed == {"tests/*": {"PLR0913"}, "benchmarks/baseline.py": {"PLR0913"}}


def test_no_function_is_freed_by_itself() -> None:
    texts = {
        source: source.read_text(encoding="utf-8")
        for folder in house.FOLDERS
        for source in (house.ROOT / folder).rglob("*.py")
        if ".venv" not in source.parts and source.name != "test_house.py"
    }
    noted = [
        source.name for source, text in texts.items() for rule in RULES if f"noqa: {rule}" in text
    ]
    assert noted == []


def test_sizes_of_the_tree_are_those_of_the_files() -> None:
    page = house.PAGE.read_text(encoding="utf-8")
    now = house.sizes(page)
    assert len(now) > 30
    wrong = {
        str(place.relative_to(house.ROOT)): (said, now[place])
        for place, said in house.rows(page)
        if abs(said - now[place]) > max(0.2, 0.1 * now[place])
    }
    assert wrong == {}, "run python tests/house.py"


def test_every_package_of_surae_has_its_row() -> None:
    shown = {place for place, _ in house.rows(house.PAGE.read_text(encoding="utf-8"))}
    packages = {path.parent for path in (house.ROOT / "src" / "surae").glob("*/__init__.py")}
    assert packages - shown == set()
