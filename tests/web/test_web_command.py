"""`surae serve`, before it serves."""

from typing import Any

import pytest
from click.testing import CliRunner

from surae.base.errors import InputError
from surae.cli import group


def refused(*arguments: str) -> str:
    done = CliRunner().invoke(group, ["serve", *arguments])
    assert isinstance(done.exception, InputError)
    assert "\n" not in str(done.exception)
    return str(done.exception)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--token", "short"], "at least 8"),
        (["--host", "no such host"], "give another --port or --host"),
        ([""], "no name"),
    ],
)
def test_wrong_use_is_one_line(arguments, says, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert says in refused(*arguments)


@pytest.mark.parametrize("arguments", [("--port", "99999"), ("--workers", "0")])
def test_numbers_have_their_range(arguments) -> None:
    done = CliRunner().invoke(group, ["serve", *arguments])
    assert done.exit_code == 2
    assert f"'{arguments[0]}'" in done.output
    assert f"{arguments[1]} is not in the range" in done.output


def test_without_its_package_it_says_how_to_get_it(monkeypatch) -> None:
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: ())
    assert 'run pip install "surae-workbench"' in refused()


def test_a_token_need_not_be_seen_in_the_list_of_processes(tmp_path, monkeypatch) -> None:
    given: list[Any] = []
    monkeypatch.setattr(
        "surae_workbench.web.server.serve", lambda *told, **_: given.append(told[1])
    )
    (tmp_path / "token").write_text("out of a file\n")
    CliRunner().invoke(group, ["serve", "--token-file", str(tmp_path / "token")])
    assert given[-1].token == "out of a file"
    CliRunner().invoke(group, ["serve"], env={"SURAE_TOKEN": "out of the environment"})
    assert given[-1].token == "out of the environment"
    (tmp_path / "token").write_text("short\n")
    assert "at least 8" in refused("--token-file", str(tmp_path / "token"))
