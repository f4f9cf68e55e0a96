"""The list of slow tests is that of the tests there are, and each has its turn."""

import runpy
import tomllib
from pathlib import Path

import pytest

from marks import COLLECTED

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def listed():
    with (ROOT / "tests" / "slow.toml").open("rb") as file:
        return tomllib.load(file)


@pytest.fixture(scope="module")
def chosen():
    return runpy.run_path(str(ROOT / ".ci" / "slow"))["chosen"]


def test_every_slow_test_is_listed_once_and_no_other(listed, pytestconfig) -> None:
    """Of the files that this run collected: the whole suite holds the whole list."""
    names = [name for group in listed["groups"].values() for name in group]
    assert len(names) == len(set(names))
    collected = pytestconfig.stash[COLLECTED]
    slow = {name for name, is_slow in collected.items() if is_slow}
    assert sorted(slow - {*names}) == []
    assert [n for n in names if not (ROOT / n.partition("::")[0]).is_file()] == []
    if any("::" in each for each in pytestconfig.args):
        return  # of a file there is a part
    files = {name.partition("::")[0] for name in collected}
    assert [n for n in names if n.partition("::")[0] in files and n not in slow] == []


def test_every_group_has_its_turn_within_the_budget(listed, chosen) -> None:
    groups, always = listed["groups"], listed["always"]
    turns = [chosen(listed, turn) for turn in range(len(groups) - len(always))]
    assert {name for turn in turns for name in turn} == {*groups}
    for turn in turns:
        assert turn[: len(always)] == always
        assert len(turn) == len({*turn}) > len(always)
        assert sum(sum(groups[name].values()) for name in turn) <= listed["budget"]


def test_turns_go_round(chosen) -> None:
    groups = {name: {"test": seconds} for name, seconds in zip("abcd", (5, 3, 3, 9), strict=True)}
    listed = {"budget": 12, "always": ["a"], "groups": groups}
    assert chosen(listed, 0) == ["a", "b", "c"]
    assert chosen(listed, 1) == ["a", "c"]  # d, the next, has no room
    assert chosen(listed, 2) == chosen(listed, 5) == ["a", "d"]  # alone over the budget, yet run
    assert chosen(listed, 3) == chosen(listed, 0)


def test_a_turn_is_recorded_in_the_file() -> None:
    advanced = runpy.run_path(str(ROOT / ".ci" / "slow"))["advanced"]
    text = "budget = 9\nturn = 1\nalways = []\n"
    assert advanced(text, 3) == text.replace("turn = 1", "turn = 2")
    assert advanced(advanced(text, 3), 3) == text.replace("turn = 1", "turn = 0")
