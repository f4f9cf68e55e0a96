"""What README and documentation tell people to type, page by page, in the order of the page."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
#: Made at every build, of docstrings and examples that have tests of their own.
_MADE = (
    "docs/_build",
    "docs/gallery",
    "docs/api/generated",
    "docs/models/parameters-",
    "docs/how-to/mapping-table",
    "docs/how-to/option-table",
    "docs/how-to/quality-codes",
    "docs/methods/prior-table",
    "docs/methods/source-table",
    "docs/reproduction-table",
)
PAGES = tuple(
    sorted(
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md"))
        if not path.relative_to(ROOT).as_posix().startswith(_MADE)
    )
)
#: How a command begins; anything else in a block without a language is no command.
_PROGRAMS = ("surae", "make", "pip", "python", ".venv/bin/surae", ".venv/bin/pre-commit")
_BLOCK = re.compile(
    r"^(?P<fence>`{3,})(?P<language>[^\n`]*)\n(?P<text>.*?)^(?P=fence)[ ]*$"
    r"|(?<!`)`(?P<inline>[^`\n]+)`(?!`)",
    flags=re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Snippet:
    """One thing to type.

    Attributes
    ----------
    kind : str
        ``command``, ``mention`` (a command in running text), or the language of a block.
    text : str
        As it is written.
    line : int
        Where in the page.
    """

    kind: str
    text: str
    line: int


def snippets(page: str) -> Iterator[Snippet]:
    """Everything that a page has to be typed."""
    content = (ROOT / page).read_text(encoding="utf-8")
    for match in _BLOCK.finditer(content):
        line = content.count("\n", 0, match.start()) + 1
        if match["inline"] is not None:
            if match["inline"].split()[0] in _PROGRAMS and " " in match["inline"]:
                yield Snippet("mention", match["inline"], line)
        elif not match["language"].strip():
            for i, text in enumerate(match["text"].splitlines()):
                command = text.split("  #")[0].strip()
                if command:
                    yield Snippet("command", command, line + 1 + i)
        # What is indented is part of a file: tests/test_recipes.py puts it there.
        elif not match["language"].startswith("{") and not match["text"].startswith(" "):
            yield Snippet(match["language"].strip(), match["text"], line)


def is_command(text: str) -> bool:
    """Whether a line of a block begins as a command does."""
    return text.split(maxsplit=1)[0] in _PROGRAMS
