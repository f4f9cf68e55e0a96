"""Tables of the documentation, made of the program itself at every build."""

import json
from collections.abc import Iterable
from pathlib import Path

import constants
import options_table
import quality_table
from sphinx.application import Sphinx

from surae.base.setting import default_of, settings_of
from surae.inference.population_priors import WIDENED
from surae.inference.result import TENDONS
from surae.measures import DEFINITIONS
from surae.model.model_2010 import PARAMETERS_2010
from surae.model.parameters import (
    MUSCLE_PARAMETERS,
    OPTIONAL_PARAMETERS,
    TENDON_PARAMETERS,
    Parameter,
)
from surae.model.registry import PARAMETERS as EVERY
from surae.model.source_table import SOURCES, source_of
from surae.recording.described import MappedChannel, MappedRecording

PARAMETERS: dict[str, Iterable[Parameter]] = {
    "muscle": MUSCLE_PARAMETERS,
    "muscle-2010": PARAMETERS_2010,
    "tendon": TENDON_PARAMETERS,
    "drives": [p for p in OPTIONAL_PARAMETERS if p.group != "measurement"],
    "measurement": [p for p in OPTIONAL_PARAMETERS if p.group == "measurement"],
}


def measures() -> str:
    """A table in Markdown: every measure, its unit, what it is and how it is computed."""
    rows = []
    for d in DEFINITIONS:
        at = {"deg": "@θ", "": ""}.get(d.at, f"@{d.points[0]:g}{d.at}")
        formula = d.formula.replace("|", "\\|")
        rows.append(f"| `{d.name}{at}` | {d.unit} | {d.meaning} | {formula} |\n")
    return "| measure | unit | what it is | formula and source |\n|---|---|---|---|\n" + "".join(
        rows
    )


def sources() -> str:
    """A table in Markdown: every source of uncertainty, what is assumed of it, and what helps."""
    rows = []
    for s in SOURCES.values():
        prior, because = "", ""
        if n := s.nuisance:
            prior = f"`{n.group}`: {n.prior.mean:g} ± {n.prior.sd:g} {n.unit}"
            prior += "".join(f"; `{of}` {b.mean:g} ± {b.sd:g}" for of, b in n.prior_of.items())
            because = f"{n.because}{'; *a departure*' if n.departs else ''}"
        rows.append(f"| {s.label} | {s.meaning} | {prior} | {because} | {s.advice} |\n")
    head = "| source | what it is | prior in `nuisances` | because | what makes it smaller |\n"
    return f"{head}|---|---|---|---|---|\n" + "".join(rows)


def mapping() -> str:
    """Two tables in Markdown: what a TOML mapping may say of a recording, and of a channel."""
    tables = []
    for kind in (MappedRecording, MappedChannel):
        rows = "".join(
            f"| `{each.name}` | {record.meaning} | {_plain(default_of(each))} |\n"
            for each, record in settings_of(kind)
        )
        tables.append(f"| key | what it says | by default |\n|---|---|---|\n{rows}")
    return "At the top:\n\n{}\nIn the table of a channel:\n\n{}".format(*tables)


def _plain(default: object) -> str:
    return "–" if default in (None, "", {}) else f"`{json.dumps(default)}`"


def priors() -> str:
    """A table in Markdown: what is known of a leg's parameters before it is measured."""
    head = "| parameter | median | spread | source |\n|---|--:|--:|---|\n"

    def spread(name: str, of_health: float) -> float:
        return of_health if name in TENDONS else WIDENED * of_health

    return head + "".join(
        f"| `{name}` | {known.median:g} | {spread(name, known.spread):.2g} | {known.source} |\n"
        for name, p in EVERY.items()
        if (known := p.known.get("healthy"))
        and (source_of(name) is None or name in SOURCES["tendon"].leg)
    )


def of_parameters(parameters: Iterable[Parameter]) -> str:
    """A table in Markdown."""
    head = "| name | unit | meaning | start | bounds |\n|---|---|---|--:|---|\n"
    return head + "".join(
        f"| `{p.name}` | {p.unit} | {p.meaning} | {p.start:g} | {p.lower:g} … {p.upper:g} |\n"
        for p in parameters
    )


def write(app: Sphinx) -> None:
    """Write each beside the page that includes it, where it has changed."""
    texts = {
        "methods/measure-table.md": measures(),
        "methods/source-table.md": sources(),
        "methods/constants-table.md": constants.tables(),
        "methods/prior-table.md": priors(),
        "how-to/mapping-table.md": mapping(),
        "how-to/option-table.md": options_table.table(),
        "how-to/quality-codes.md": quality_table.table(),
        **{f"models/parameters-{name}.md": of_parameters(p) for name, p in PARAMETERS.items()},
    }
    for name, text in texts.items():
        path = Path(app.srcdir) / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Write them before anything is read."""
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
