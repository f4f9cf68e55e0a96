"""A fit's report for paper: the content of the page, set by typst."""

import json
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from datetime import datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from surae.assessment import Assessment
from surae.errors import ComputationError, InputError
from surae.estimation import FitResult
from surae.files import PathLike, write_atomic
from surae.report.content import make_content
from surae.report.figures import correlation_figure, png, residual_figure, torque_figure
from surae.report.traces import traces_of

#: Resolution of figures of signals [dots per inch].
_DPI = 180


def write_pdf(
    path: PathLike, result: FitResult, assessment: Assessment, *, created: datetime
) -> None:
    """Write the report of a fit as PDF.

    Parameters
    ----------
    path : path
        The file.
    result, assessment : FitResult, Assessment
        The fit and what it is worth.
    created : datetime
        When the report is made.

    Raises
    ------
    InputError
        Typst is not installed, or the file cannot be written.
    ComputationError
        Typst cannot set it.
    """
    try:
        import typst
    except ImportError:
        raise InputError(
            'a PDF needs typst: pip install "surae[pdf]" installs it; the HTML report needs nothing'
        ) from None
    traces = traces_of(result)
    content = make_content(result, assessment, traces, versions=result.versions, created=created)
    # Its types want source and root to be the same kind of thing: here bytes and a path.
    compiled: Callable[..., object] = typst.compile
    template = files("surae.report").joinpath("templates", "report.typ").read_bytes()
    with tempfile.TemporaryDirectory(prefix="surae-pdf-") as name:
        folder = Path(name)
        for number, one in enumerate(traces):
            (folder / f"torque-{number}.png").write_bytes(png(torque_figure(one), _DPI))
            white = assessment.whiteness[number]
            figure = residual_figure(one.time, one.residual, white, one.left_out)
            (folder / f"residual-{number}.png").write_bytes(png(figure, _DPI))
        section = content.correlation
        if len(section.names) > 1:
            figure = correlation_figure(
                section.names, np.array(section.matrix), section.passive, section.active
            )
            (folder / "correlation.png").write_bytes(png(figure, _DPI))
        try:
            printed = compiled(
                template, root=str(folder), sys_inputs={"content": json.dumps(_plain(content))}
            )
        except Exception as error:  # typst's own errors have no common type in all versions
            text = " ".join(str(error).split())
            raise ComputationError(f"typst could not set the PDF: {text}") from error
    if not isinstance(printed, bytes):
        raise ComputationError("typst gave no PDF")
    write_atomic(path, printed)


def _plain(content: Any) -> dict[str, Any]:
    """What the template shows; texts reach typst as data, never as markup."""
    keys = ("title", "names", "created", "status", "status_text", "message", "summary", "key",
            "caution", "recordings", "groups", "settings", "sources", "versions")  # fmt: skip
    whole = asdict(content)
    return {key: whole[key] for key in keys} | {
        "correlation": len(content.correlation.names) > 1,
        "starts": f"{content.agreeing} of {len(content.starts)} starts reach the best minimum",
    }
