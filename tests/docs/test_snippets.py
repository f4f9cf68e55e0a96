"""Every command and every snippet of README and documentation works as it is printed."""

import doctest
import functools
import inspect
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import click
import pytest

import surae as surae_package
from surae.cli import COMMANDS, group, main
from undrawn import blank_figures

from .pages import PAGES, ROOT, Snippet, is_command, snippets

#: Blocks without a language whose lines are no commands.
SHOWN = {"docs/start.md": "time_s,angle_rad", "CONTRIBUTING.md": "src/surae/"}
#: Words that stand for something of the reader's.
PLACEHOLDERS = {"FILE": "lab.csv", "FOLDER": "leg", "START:END": "1:2"}
#: Commands whose options are read but which are not run here, and why.
READ_ONLY = {
    "surae live": "runs in real time until it is stopped; tests/live runs it",
    "surae serve": "serves until it is stopped; tests/web runs it",
    "surae reproduce": "takes minutes; tests/thesis runs it",
    "surae posterior": "takes a while; tests/cli/test_posterior.py runs it",
    "surae demo": "fits for seconds; tests/cli/test_demo.py runs it",
    "surae project": "needs a project; tests/web/test_web_upkeep.py runs it",
    "--knowledge": "needs a laboratory's folder; tests/session runs one",
    "surae session leg --output OUT": "the same",
    "--dask": "needs a cluster; tests/studies runs one",
}
#: What makes a command quick without changing what it does.
QUICKER = {
    "surae fit": ["--model", "muscle", "--starts", "1"],
    "surae cohort": ["--workers", "1"],
    "surae session": ["--model", "muscle", "--starts", "1"],
    "surae profile": ["--workers", "1"],
    "surae design": ["--evaluations", "20"],
    "surae study run": ["--workers", "1"],
}
#: Pages whose sessions, cohorts and studies take seconds each; what they run has tests of its own.
LONG = {
    f"docs/{page}.md"
    for page in (
        "start",
        "clinicians",
        "readers/student",
        "readers/researcher",
        "how-to/run-a-cohort",
        "how-to/sessions",
        "how-to/run-a-study",
        "how-to/script-it",
        "how-to/before-and-after",
        "how-to/design-a-protocol",
        "methods/measures",
    )
}
#: Pages that take seconds, and functions whose examples do: CI runs them.
SECONDS = {
    f"docs/how-to/{page}.md"
    for page in (
        "another-joint",
        "check",
        "choose-a-model",
        "export",
        "fit-my-file",
        "geometry",
        "how-much-is-nerve",
        "measure-a-leg",
        "other-programs",
        "predict-while-measuring",
    )
}
SECONDS |= {
    "change",
    "cohort",
    "design",
    "example",
    "export",
    "fit",
    "impedance",
    "judge",
    "load_session",
    "measures",
    "plan_session",
    "posterior",
    "session",
}
#: Targets of the Makefile, and extras of the package.
TARGETS = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))


def marked(page: str) -> object:
    """A page or a function's example, with the mark of what it takes."""
    slow, long = pytest.mark.slow, pytest.mark.long
    return pytest.param(page, marks=slow if page in LONG else long if page in SECONDS else ())


def extras_of(folder: str = "") -> dict[str, list[str]]:
    """The extras of the package that a folder of ours is."""
    described = tomllib.loads((ROOT / folder / "pyproject.toml").read_text(encoding="utf-8"))
    return described["project"].get("optional-dependencies", {})


EXTRAS = extras_of()


@pytest.fixture
def surae(monkeypatch, capsys):
    """Run `surae …` in this process; a failure shows what it said."""

    def run(words: list[str]) -> None:
        capsys.readouterr()
        monkeypatch.setattr("sys.argv", words)
        with pytest.raises(SystemExit) as end:
            main()
        out, err = capsys.readouterr()
        assert not end.value.code, f"{shlex.join(words)}: exit {end.value.code}: {err}{out}"

    return run


def _reason_to_read_only(words: list[str]) -> str | None:
    text = " ".join(words)
    return next((why for part, why in READ_ONLY.items() if part in text), None)


def _resolved(words: list[str]) -> tuple[click.Command, list[str]]:
    """The command that words call, and what is left of them."""
    command: click.Command = group
    rest = words[1:]
    while isinstance(command, click.Group) and rest:
        called = command.get_command(click.Context(command), rest[0])
        assert called is not None, f"there is no command {' '.join(words)}"
        command, rest = called, rest[1:]
    return command, rest


def _run_surae(words: list[str], surae, named: bool) -> None:
    """Run a command as it stands, or read its options: of one that is only named, in a text."""
    command, rest = _resolved(words)
    if named or _reason_to_read_only(words) is not None:
        with command.make_context("surae", list(rest)):
            return
    for called, more in QUICKER.items():
        if " ".join(words).startswith(called) and not {"--session", "auto"} & {*words}:
            options = zip(more[::2], more[1::2], strict=True)
            words = [*words, *(part for pair in options if pair[0] not in words for part in pair)]
    surae(words)
    if words[1] == "inspect" and "--output" in words:
        # Here the reader corrects the mapping; the laboratory's file states no units.
        written = Path(words[words.index("--output") + 1])
        assert "[channels.angle]" in written.read_text(encoding="utf-8")
        shutil.copy("corrected.toml", written)


def _check_other(words: list[str]) -> None:
    """What is not surae's own command: its target, extra, script or tool exists."""
    program, *rest = words
    if program == "make":
        assert rest[0] in TARGETS
    elif program == "pip":
        assert rest[0] == "install"
        if rest[1].startswith("./"):
            assert (ROOT / rest[1] / "pyproject.toml").exists()
            return
        own = "(surae(?:-cohort|-exchange|-formats|-nerve|-posterior|-thesis|-workbench)?)"
        match = re.fullmatch(rf"{own}(?:\[([a-z,]+)\])?", rest[1])
        assert match, rest
        extras = EXTRAS if match[1] == "surae" else extras_of(f"{match[1].removeprefix('surae-')}/")
        assert set(filter(None, (match[2] or "").split(","))) <= set(extras)
    elif program == "python" and rest[0] == "-m":
        assert find_spec(f"{rest[1]}.__main__"), rest
    elif program == "python" and rest[0] == "-c":
        # Not run: it would replace the small trial that pages share. The README's block runs it.
        assert all(hasattr(surae_package, name) for name in re.findall(r"surae\.(\w+)", rest[1]))
        compile(rest[1], "-c", "exec")
    elif program == "python":
        script = (ROOT / rest[0]).read_text(encoding="utf-8")
        for option in (word for word in rest[1:] if word.startswith("--")):
            assert f'"{option}"' in script
    else:
        assert program == ".venv/bin/pre-commit", words
        assert (ROOT / ".pre-commit-config.yaml").exists()
        assert any(requirement.startswith("pre-commit") for requirement in EXTRAS["dev"])


def _do(snippet: Snippet, page: str, surae, namespace: dict[str, object]) -> None:
    if snippet.kind in ("command", "mention"):
        command, _, target = snippet.text.partition(" > ")
        words = [PLACEHOLDERS.get(word, word) for word in shlex.split(command)]
        words[0] = words[0].removeprefix(".venv/bin/") if words[0].endswith("surae") else words[0]
        if words[0] != "surae":
            _check_other(words)
        elif snippet.kind == "mention" and len(_resolved(words)[1]) == 0:
            surae([*words, "--help"])  # only named
        elif snippet.kind == "mention" and words[-1].startswith("--"):
            named = {
                option for parameter in _resolved(words)[0].params for option in parameter.opts
            }
            assert words[-1] in named
        else:
            _run_surae(words, surae, snippet.kind == "mention")
        assert not target or re.fullmatch(r"\S+", target)
    elif snippet.kind == "python":
        exec(compile(snippet.text, f"{page}:{snippet.line}", "exec"), namespace)
    elif snippet.kind == "toml":
        _read_toml(snippet.text)
    else:
        assert snippet.kind == "sh", f"nothing checks blocks of {snippet.kind}"
        path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
        text = snippet.text.replace("surae fit ", "surae fit --model muscle --starts 1 ")
        subprocess.run(
            ["bash", "-euc", text], check=True, timeout=120, env=os.environ | {"PATH": path}
        )


def _read_toml(text: str) -> None:
    """A mapping, a device, a study, or a distribution's own entry points."""
    if "max_torque_Nm" in text:
        from surae.protocol import read_device

        Path("printed.toml").write_text(text, encoding="utf-8")
        assert read_device("printed.toml").sources
    elif "[channels." in text:
        from surae import read

        if "[channels.angle]" not in text:  # one channel more for a mapping
            text = Path("corrected.toml").read_text(encoding="utf-8") + text
        Path("printed.toml").write_text(text, encoding="utf-8")
        alone = "file =" in text  # else it is of many files
        mapped = read("printed.toml") if alone else read("leg/trial1.csv", mapping="printed.toml")
        assert len(mapped.channels) > 2
    elif "[knowledge]" in text:
        from surae.model.knowledge_file import read_session_toml

        Path("leg/session.toml").write_text(text, encoding="utf-8")
        assert read_session_toml("leg/session.toml").trials
    elif "[project.entry-points" in text:
        from surae.base.plugins import plugins

        named = {
            group.partition(".")[2] for group in tomllib.loads(text)["project"]["entry-points"]
        }
        served = set(re.findall(r'"(\w+)"', plugins.__doc__))
        assert named <= served | {"commands"}
    else:
        from surae.studies.study import parse_study

        assert parse_study(text).size > 1


@pytest.fixture
def undrawn() -> Iterator[None]:
    """Reports of these pages have no figures, nor are those of sessions made."""
    with blank_figures(made=False):
        yield


@pytest.fixture
def quick_fits(page, monkeypatch):
    """Python fits as `QUICKER` says of the shell, but where `auto` itself is shown."""
    if page != "docs/how-to/design-a-protocol.md":
        few = {"model": "muscle", "starts": 1}
        drawn = functools.partial(surae_package.posterior, draws=20, evaluations=600)
        monkeypatch.setattr(surae_package, "posterior", drawn)
        monkeypatch.setattr(surae_package, "fit", functools.partial(surae_package.fit, **few))
        for name in ("fit", "run"):
            whole = getattr(surae_package.Session, name)

            def quick(session, *given, whole=whole, **more):
                return whole(session, *given, **(few if len(given) < 2 else {}), **more)

            monkeypatch.setattr(surae_package.Session, name, quick)


@pytest.fixture
def small_example(monkeypatch):
    """The example is written as always, and then made way for the small trial of its name.

    To fit all of it takes as long as the other pages together; `surae demo` is tested with as much.
    """
    whole = surae_package.example

    def example(path: str) -> None:
        small = Path(path).read_bytes()
        whole(path)
        assert surae_package.read(path).emg == "raw"
        Path(path).write_bytes(small)

    monkeypatch.setattr(surae_package, "example", example)


def test_commands_have_the_options_that_long_pages_give_them(workplace):
    """Those whose commands are run in the slow suite alone."""
    for page in LONG:
        for snippet in snippets(page):
            if snippet.kind == "command" and snippet.text.startswith("surae "):
                words = shlex.split(snippet.text.partition(" > ")[0])
                command, rest = _resolved([PLACEHOLDERS.get(word, word) for word in words])
                with command.make_context("surae", list(rest)):
                    pass


@pytest.mark.usefixtures("undrawn", "few", "small_example", "quick_fits")
@pytest.mark.parametrize("page", [marked(page) for page in PAGES])
def test_a_page_works_as_it_is_printed(page, workplace, surae):
    namespace: dict[str, object] = {"__name__": "printed"}
    skip = SHOWN.get(page)
    for snippet in snippets(page):
        if snippet.kind == "command" and not is_command(snippet.text):
            # Only blocks that are known to show something else may hold other lines.
            assert skip is not None, f"{page}:{snippet.line}: what is {snippet.text!r}?"
            continue
        try:
            _do(snippet, page, surae, namespace)
        except BaseException as error:
            error.add_note(f"{page}, line {snippet.line}: {snippet.text}")
            raise


def test_the_pages_hold_what_they_are_read_for():
    kinds = [snippet.kind for page in PAGES for snippet in snippets(page)]
    assert kinds.count("command") > 25
    assert kinds.count("python") > 5


def test_every_command_is_documented():
    text = " ".join((ROOT / page).read_text(encoding="utf-8") for page in PAGES)
    assert [name for name in COMMANDS if f"surae {name}" not in text] == []


def test_no_reason_to_skip_is_left_over():
    text = " ".join(
        snippet.text
        for page in PAGES
        for snippet in snippets(page)
        if snippet.kind in ("command", "mention")
    )
    assert [part for part in READ_ONLY if part not in text] == []
    assert [word for word in QUICKER if word not in text] == []


#: Functions of `surae`, each with its docstring; `surae.measures` is a package that can be called.
FUNCTIONS = {
    name: inspect.getdoc(public.__call__ if inspect.ismodule(public) else public) or ""
    for name in surae_package.__all__
    if callable(public := getattr(surae_package, name)) and not isinstance(public, type)
}


@pytest.mark.usefixtures("undrawn", "few", "small_example", "quick_fits", "workplace")
@pytest.mark.parametrize("page", [marked(name) for name in FUNCTIONS])
def test_a_function_has_an_example_that_runs(page):
    if page == "load_session":
        surae_package.session("leg", mapping="corrected.toml").run("OUT")
    examples = doctest.DocTestParser().get_examples(FUNCTIONS[page])
    assert examples
    namespace = {"surae": surae_package}
    for example in examples:
        exec(example.source, namespace)
