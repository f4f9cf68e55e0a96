"""The table of all measures, made of their own definitions at every build."""

from pathlib import Path

from sphinx.application import Sphinx

from surae.measures import DEFINITIONS


def table() -> str:
    """A table in Markdown: every measure, its unit, what it is and how it is computed."""
    rows = []
    for d in DEFINITIONS:
        at = {"deg": "@θ", "": ""}.get(d.at, f"@{d.points[0]:g}{d.at}")
        formula = d.formula.replace("|", "\\|")
        rows.append(f"| `{d.name}{at}` | {d.unit} | {d.meaning} | {formula} |\n")
    return "| measure | unit | what it is | formula and source |\n|---|---|---|---|\n" + "".join(
        rows
    )


def write(app: Sphinx) -> None:
    """Write it beside the page that includes it, where it has changed."""
    path, text = Path(app.srcdir) / "methods" / "measure-table.md", table()
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Write it before anything is read."""
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
