"""Reports for paper: the content of the page, set by typst."""

import tempfile
from collections.abc import Mapping, Sequence
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
    drawn = drawings(content, traces, assessment, predictions)
    return on_paper("report.typ", asdict(content), {name: svg(figure) for name, figure in drawn})


def on_paper(template: str, content: dict[str, Any], images: Mapping[str, bytes]) -> bytes:
    """What a template of ours makes of content, and of images as SVG by their names."""
    templates = files("surae.report").joinpath("templates")
    with tempfile.TemporaryDirectory(prefix="surae-pdf-") as folder:
        Path(folder, "common.typ").write_bytes(templates.joinpath("common.typ").read_bytes())
        for name, drawn in images.items():
            Path(folder, f"{name}.svg").write_bytes(drawn)
        markup = templates.joinpath(template).read_bytes()
        return typeset(markup, Path(folder), content | {"images": list(images)})
