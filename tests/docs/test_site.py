"""The site: every public name is on the pages of the API; nothing comes from outside hosts."""

import re
import sys
from importlib import import_module
from pathlib import Path

import pytest

import surae
from surae.quality import CODES

DOCS = Path(__file__).parents[2] / "docs"


def _listed(page: str) -> set[str]:
    """The names in the tables of a page of the API."""
    blocks = re.findall(
        r"\.\. autosummary::\n(.*?)```", (DOCS / "api" / page).read_text(), flags=re.DOTALL
    )
    return {name for block in blocks for name in re.findall(r"^   (\w+)$", block, re.MULTILINE)}


def test_the_api_page_has_every_public_name():
    assert _listed("index.md") == set(surae.__all__) - {"__version__"}


@pytest.mark.parametrize("package", ["recording", "quality", "protocol", "studies"])
def test_a_page_of_a_package_has_what_surae_itself_lacks(package):
    names = import_module(f"surae.{package}").__all__
    functions = {name for name in names if not name.isupper()}
    listed = _listed(f"{package}.md")
    assert listed <= functions
    assert functions - listed <= set(surae.__all__)
    text = (DOCS / "api" / f"{package}.md").read_text()
    assert [name for name in names if name.isupper() and f"`{name}`" not in text] == []


def test_every_page_shows_the_version():
    """It stands where the theme shows the site's title: at the head of each page."""
    conf = (DOCS / "conf.py").read_text()
    assert 'html_title = f"surae {release}"' in conf
    assert 'release = installed("surae")' in conf


def test_the_table_of_the_quality_gate_has_every_code(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    import quality_table

    try:
        rows = quality_table.table().splitlines()[2:]
    finally:
        sys.modules.pop("quality_table", None)
    assert [row.split("`")[1] for row in rows] == list(CODES)


def test_every_model_has_a_page():
    from surae.model import MODELS

    assert [name for name in MODELS if not (DOCS / "models" / f"{name}.md").exists()] == []
    index = (DOCS / "models" / "index.md").read_text()
    assert [name for name in MODELS if f"\n{name}\n" not in index] == []


def test_the_gallery_has_at_least_ten_questions():
    examples = sorted((DOCS.parent / "examples").glob("[0-9]*.py"))
    assert len(examples) >= 10
    for example in examples:
        assert example.read_text().split("\n")[1].endswith("?"), example.name


def test_pages_show_nothing_from_outside_hosts():
    sources = [*DOCS.glob("*.md"), *DOCS.glob("*/*.md"), DOCS.parent / "README.md"]
    file = r'<img src="(?!/)[a-z/]+\.png"[^>]*>'  # beside the page; `src` comes once and first
    shown = rf"!\[[^\]]*\]\(https?:|\{{image\}} https?:|(?!{file})<(?:img|script|link)\b|srcset"
    assert [path.name for path in sources if re.search(shown, path.read_text())] == []
