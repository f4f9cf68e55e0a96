"""The claims of the thesis with their verdicts, as `surae reproduce --markdown` wrote them."""

from pathlib import Path

from sphinx.application import Sphinx

MARKER = "<!-- verdicts -->"
FILE = "reproduction-table.md"


def insert(app: Sphinx, docname: str, source: list[str]) -> None:
    """Put the table in the place of the marker, its headings one level down, its title left out."""
    if docname != "reproduction":
        return
    path = Path(app.srcdir) / FILE
    if not path.exists():
        source[0] = source[0].replace(MARKER, "The table is not made yet: run the command above.")
        return
    app.env.note_dependency(FILE)
    lines = path.read_text(encoding="utf-8").splitlines()
    body = [line for line in lines if not line.startswith("# ")]
    source[0] = source[0].replace(MARKER, "\n".join(body))


def setup(app: Sphinx) -> dict[str, bool]:
    """Do it as the page is read."""
    app.connect("source-read", insert)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
