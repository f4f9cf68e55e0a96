"""A report as one HTML file that asks nothing of the outside."""

import base64
from collections.abc import Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.report.content import make_content
from surae.report.explore import explorer
from surae.report.figures import drawings, png, svg
from surae.report.traces import traces_of

#: Resolution of the others [dots per inch].
_DPI = 150
#: Figures of few lines and many letters, which stay sharp at any size.
_DRAWN = ("correlation", "budget")


def render(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction], **what: Any
) -> str:
    """The page; see `surae.report.build`."""
    traces = traces_of(result)
    content = make_content(result, assessment, traces, predictions=predictions, **what)
    images = {}
    for name, figure in drawings(content, traces, assessment, predictions):
        kind, data = ("svg+xml", svg(figure)) if name in _DRAWN else ("png", png(figure, _DPI))
        images[name] = f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
    # Names come from files and are untrusted: everything is escaped.
    environment = Environment(
        loader=PackageLoader("surae.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2").render(
        content=content, images=images, explore=explorer(traces)
    )
