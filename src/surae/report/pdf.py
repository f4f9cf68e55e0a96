"""A fit's report for paper: the content of the page, set by typst."""

import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.report.content import make_content
from surae.report.figures import drawings, svg
from surae.report.traces import traces_of
from surae.report.typeset import require_typst, typeset


def render_pdf(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction], **what: Any
) -> bytes:
    """The report as PDF; the arguments are those of `surae.report.write_report`."""
    require_typst()
    traces = traces_of(result)
    content = make_content(result, assessment, traces, predictions=predictions, **what)
    template = files("surae.report").joinpath("templates", "report.typ").read_bytes()
    with tempfile.TemporaryDirectory(prefix="surae-pdf-") as folder:
        images = []
        for name, figure in drawings(content, traces, assessment, predictions):
            Path(folder, f"{name}.svg").write_bytes(svg(figure))
            images.append(name)
        return typeset(template, Path(folder), asdict(content) | {"images": images})
