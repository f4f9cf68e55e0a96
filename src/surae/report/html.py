"""A report as one HTML file that asks nothing of the outside."""

import base64
from collections.abc import Mapping, Sequence
from datetime import datetime

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.quality import Quality
from surae.report.content import make_content
from surae.report.correlations import CorrelationSection
from surae.report.figures import (
    correlation_figure,
    png,
    prediction_figure,
    residual_figure,
    svg,
    tendon_figure,
    torque_figure,
)
from surae.report.traces import traces_of


def render(
    result: FitResult,
    assessment: Assessment,
    *,
    versions: Mapping[str, str],
    created: datetime,
    predictions: Sequence[Prediction] = (),
    quality: Sequence[Quality] = (),
) -> str:
    """The page; see `surae.report.build`."""
    traces = traces_of(result)
    content = make_content(
        result,
        assessment,
        traces,
        versions=versions,
        created=created,
        predictions=predictions,
        quality=quality,
    )
    # Names come from files and are untrusted: everything is escaped.
    environment = Environment(
        loader=PackageLoader("surae.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2").render(
        content=content,
        torque=[_image(png(torque_figure(trial)), "png") for trial in traces],
        residual=[
            _image(png(residual_figure(trial.time, trial.residual, w, trial.excluded)), "png")
            for trial, w in zip(traces, assessment.whiteness, strict=True)
        ],
        tendon=[
            None
            if trial.tendon is None
            else _image(png(tendon_figure(trial, trial.tendon), 150), "png")
            for trial in traces
        ],
        correlation=_heat_map(content.correlation),
        predictions=[
            _image(png(prediction_figure(prediction)), "png") for prediction in predictions
        ],
    )


def _heat_map(section: CorrelationSection) -> str | None:
    if len(section.names) < 2:
        return None
    figure = correlation_figure(
        section.names, np.array(section.matrix), section.passive, section.active
    )
    return _image(svg(figure), "svg+xml")


def _image(data: bytes, kind: str) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
