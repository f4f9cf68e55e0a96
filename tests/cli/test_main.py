import click
import pytest

from surae import __version__
from surae.base.errors import ComputationError, InputError
from surae.cli import COMMANDS, group

from .conftest import refused


def test_every_command_has_help(run) -> None:
    for command in ([], *([name] for name in COMMANDS)):
        done, short = run(*command, "--help"), run(*command, "-h")
        assert (done.code, done.err) == (0, ""), command
        assert done.out.startswith(" ".join(["Usage: surae", *command])), command
        assert max(map(len, done.out.splitlines())) <= 80, command
        assert short == done


def test_help_of_the_program_lists_every_command(run) -> None:
    listed = run("--help").out
    for name, (_, text) in COMMANDS.items():
        assert f"  {name}" in listed
        assert text in listed
    assert "--debug" in listed


def test_without_arguments_there_is_help(run) -> None:
    assert run() == run("--help")


def test_version(run) -> None:
    assert run("--version") == (0, f"surae {__version__}\n", "")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nonsense"], ("'nonsense'", "surae --help")),
        (["fit", "--model", "muscle", "--nonsense"], ("--nonsense", "surae fit --help")),
        (["fit"], ("REC", "surae fit --help")),
        (["demo", "extra"], ("extra", "surae demo --help")),
    ],
)
def test_wrong_use_is_one_line_that_leads_to_help(run, arguments, says) -> None:
    refused(run(*arguments), *says)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--debug", "fit", "--model", "muscle", "none.csv"],
        ["fit", "--model", "muscle", "--debug", "none.csv"],
        ["fit", "--model", "muscle", "none.csv", "--debug"],
        ["fit", "--model", "muscle", "none.csv", "--debug", "--debug"],
    ],
)
def test_debug_shows_where_an_error_came_from(run, arguments) -> None:
    done = run(*arguments)
    assert done.code == 2
    assert done.err.startswith("Traceback (most recent call last)")
    assert done.err.splitlines()[-1] == "surae: cannot read none.csv: there is no such file"


def test_after_two_dashes_debug_is_a_file(run) -> None:
    refused(run("fit", "--model", "muscle", "--", "--debug"), "--debug", "no such file")


def _stopped_in_compiled_code() -> Exception:
    error = SystemError("returned a result with an exception set")
    error.__cause__ = KeyboardInterrupt()
    return error


@pytest.mark.parametrize(
    ("error", "code", "says"),
    [
        (InputError("a.csv: row 3: no"), 2, "a.csv: row 3: no"),
        (ComputationError("it diverged"), 1, "it diverged"),
        (MemoryError(), 1, "memory"),
        (KeyboardInterrupt(), 130, "stopped by the user"),
        (click.Abort(), 130, "stopped by the user"),
        (_stopped_in_compiled_code(), 130, "stopped by the user"),
        (OSError(28, "No space left on device"), 1, "No space left on device"),
        (InputError("two\nlines"), 2, "two lines"),
    ],
)
def test_every_error_is_one_line_and_an_exit_code(run, monkeypatch, error, code, says) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr("os.dup2", lambda *_: None)  # stdout here is not a process's own
    monkeypatch.setattr(group, "main", fail)
    refused(run("fit"), says, code=code)


def test_a_fault_of_ours_asks_for_a_report(run, monkeypatch) -> None:
    monkeypatch.setattr(group, "main", lambda *_, **__: int("seven"))
    done = run("fit")
    assert done.code == 1
    assert done.err.count("\n") == 1
    assert "internal error (ValueError" in done.err
    assert "--debug" in done.err
