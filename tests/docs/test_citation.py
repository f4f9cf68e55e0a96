"""CITATION.cff: what its schema requires, and what the package says; the paper, the recipe."""

import re
import tomllib
from pathlib import Path

import surae

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
#: Keys at the top of version 1.2.0 of the Citation File Format, and those that it requires.
KNOWN = {
    "abstract",
    "authors",
    "cff-version",
    "commit",
    "contact",
    "date-released",
    "doi",
    "identifiers",
    "keywords",
    "license",
    "license-url",
    "message",
    "preferred-citation",
    "references",
    "repository",
    "repository-artifact",
    "repository-code",
    "title",
    "type",
    "url",
    "version",
}
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


def test_condas_recipe_needs_and_offers_what_the_package_does():
    """Both ways: what a dependency of one alone would be is found by nobody but conda's users."""
    recipe = (ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8")
    run = recipe.split("\n  run:\n")[1].split("\n\n")[0]
    needs = {line.removeprefix("    - ").replace(" ", "") for line in run.splitlines()}
    asked = {need.replace("matplotlib>", "matplotlib-base>") for need in PROJECT["dependencies"]}
    assert needs == asked | {f"python{PROJECT['requires-python']}"}
    scripts = re.findall(r'"(.+?)"', recipe.split("entry_points: [")[1].split("]")[0])
    assert scripts == [f"{name} = {what}" for name, what in PROJECT["scripts"].items()]


def test_counts_on_the_front_are_those_that_were_made():
    """README and challenge say of no entrant what no count has."""
    counts = (ROOT / "benchmarks" / "counts.md").read_text(encoding="utf-8")
    for page in ("README.md", "docs/challenge.md"):
        # what two visits show is kept as a file of its own: test_reliability_table.py compares it
        visits = "<!-- reliability: begin -->.*?<!-- reliability: end -->"
        rest = re.sub(visits, "", (ROOT / page).read_text("utf-8"), flags=re.DOTALL)
        rows = re.findall(r"^\|.*\d of \d.*$", rest, re.MULTILINE)
        said = [re.search(r"\d+ of \d+", row)[0] for row in rows]
        assert len(said) > 2
        assert [each for each in said if not re.search(rf"(?<!\d){each}(?!\d)", counts)] == []
