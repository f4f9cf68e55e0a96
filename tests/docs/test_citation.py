"""CITATION.cff: what its schema requires, and what the package says; the paper's counts."""

import re
import tomllib
from pathlib import Path

import surae

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
#: Keys at the top of version 1.2.0 of the Citation File Format, and those that it requires.
KNOWN = {
    "abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi",
    "identifiers", "keywords", "license", "license-url", "message", "preferred-citation",
    "references", "repository", "repository-artifact", "repository-code", "title", "type", "url",
    "version",
}  # fmt: skip
REQUIRED = {"authors", "cff-version", "message", "title"}


def _top() -> dict[str, str]:
    return dict(re.findall(r"^([a-z-]+):[ \t]*(.*)$", TEXT, flags=re.MULTILINE))


def test_the_keys_are_those_of_the_format():
    keys = set(_top())
    assert keys >= REQUIRED
    assert keys <= KNOWN


def test_it_says_what_the_package_says():
    top = _top()
    assert top["cff-version"] == "1.2.0"
    assert top["type"] in ("software", "dataset")
    assert top["version"] == surae.__version__
    assert top["license"] == PROJECT["license"]


def test_every_reference_has_what_the_format_asks_for():
    references = TEXT.split("\nreferences:\n")[1]
    entries = re.split(r"^  - ", references, flags=re.MULTILINE)[1:]
    assert entries
    for entry in entries:
        keys = set(re.findall(r"^(?:    )?([a-z-]+):", entry, flags=re.MULTILINE))
        assert keys >= {"type", "title", "authors"}


def test_the_papers_counts_are_those_of_the_documentation():
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    rows = [line for line in paper.splitlines() if line.startswith("|")]
    pages = [
        ROOT / "docs" / "how-to" / "when-to-believe-a-number.md",
        ROOT / "docs" / "methods" / "film.md",
    ]
    known = {line for page in pages for line in page.read_text(encoding="utf-8").splitlines()}
    assert len(rows) > 12
    assert [row for row in rows if row not in known] == []


def test_what_the_paper_cites_is_in_its_bibliography():
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    bibliography = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
    cited = set(re.findall(r"@([a-z]+\d{4})", paper))
    assert cited == set(re.findall(r"^@\w+\{(\w+),", bibliography, flags=re.MULTILINE))
