"""A fit's report for paper: the content of the page, set by typst."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.quality import Quality
from surae.report.content import Content, make_content
from surae.report.figures import (
    correlation_figure,
    png,
    prediction_figure,
    residual_figure,
    torque_figure,
)
from surae.report.traces import traces_of
from surae.report.typeset import require_typst, typeset

#: Resolution of figures of signals [dots per inch].
_DPI = 180


def render_pdf(
    result: FitResult,
    assessment: Assessment,
    *,
    versions: Mapping[str, str],
    created: datetime,
    predictions: Sequence[Prediction] = (),
    quality: Sequence[Quality] = (),
) -> bytes:
    """The report as PDF; the arguments are those of `surae.report.write_report`.

    Raises
    ------
    InputError
        Typst is not installed.
    ComputationError
        Typst cannot set it.
    """
    require_typst()
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
    template = files("surae.report").joinpath("templates", "report.typ").read_bytes()
    with tempfile.TemporaryDirectory(prefix="surae-pdf-") as name:
        folder = Path(name)
        for number, trial in enumerate(traces):
            (folder / f"torque-{number}.png").write_bytes(png(torque_figure(trial), _DPI))
            white = assessment.whiteness[number]
            figure = residual_figure(trial.time, trial.residual, white, trial.excluded)
            (folder / f"residual-{number}.png").write_bytes(png(figure, _DPI))
        for number, prediction in enumerate(predictions):
            drawn = png(prediction_figure(prediction), _DPI)
            (folder / f"prediction-{number}.png").write_bytes(drawn)
        section = content.correlation
        if len(section.names) > 1:
            figure = correlation_figure(
                section.names, np.array(section.matrix), section.passive, section.active
            )
            (folder / "correlation.png").write_bytes(png(figure, _DPI))
        return typeset(template, folder, _plain(content) | {"predicted": len(predictions)})


def _plain(content: Content) -> dict[str, Any]:
    """What the template shows."""
    keys = ("title", "names", "created", "status", "status_text", "message", "adequacy",
            "summary", "key", "caution", "quality", "recordings", "groups", "predictions",
            "settings", "sources", "versions")  # fmt: skip
    whole = asdict(content)
    return {key: whole[key] for key in keys} | {
        "correlation": len(content.correlation.names) > 1,
        "starts": f"{content.agreeing} of {len(content.starts)} starts reach the best minimum",
    }
