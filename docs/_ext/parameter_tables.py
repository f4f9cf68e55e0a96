"""The parameter tables of the model pages, made of the models themselves at every build."""

from collections.abc import Iterable
from pathlib import Path

from sphinx.application import Sphinx

from surae.model.parameters import (
    MUSCLE_2010_PARAMETERS,
    MUSCLE_PARAMETERS,
    OPTIONAL_PARAMETERS,
    TENDON_PARAMETERS,
    Parameter,
)

TABLES: dict[str, Iterable[Parameter]] = {
    "muscle": MUSCLE_PARAMETERS,
    "muscle-2010": MUSCLE_2010_PARAMETERS,
    "tendon": TENDON_PARAMETERS,
    "drives": [p for p in OPTIONAL_PARAMETERS if p.group != "measurement"],
    "measurement": [p for p in OPTIONAL_PARAMETERS if p.group == "measurement"],
}


def table(parameters: Iterable[Parameter]) -> str:
    """A table in Markdown."""
    head = "| name | unit | meaning | start | bounds |\n|---|---|---|--:|---|\n"
    return head + "".join(
        f"| `{p.name}` | {p.unit} | {p.meaning} | {p.start:g} | {p.lower:g} … {p.upper:g} |\n"
        for p in parameters
    )


def write(app: Sphinx) -> None:
    """Write all tables beside the pages that include them, where they have changed."""
    for name, parameters in TABLES.items():
        path, text = Path(app.srcdir) / "models" / f"parameters-{name}.md", table(parameters)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Write them before anything is read."""
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
