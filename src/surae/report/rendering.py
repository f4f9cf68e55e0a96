"""Reports of fits and sessions: one HTML file that asks nothing of the outside, or a PDF."""

import base64
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from datetime import datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.files import PathLike, template, write_atomic
from surae.report.clinical import fit_page
from surae.report.content import make_content
from surae.report.explore import explorer
from surae.report.figures import data_url, drawings, png, svg
from surae.report.session import Fitted, session_content, session_drawings
from surae.report.traces import traces_of
from surae.report.typeset import check_report, is_pdf, require_typst, typeset
from surae.trials import Crossed, Trial

#: Resolution of the others [dots per inch].
_DPI = 150
#: Figures of few lines and many letters, which stay sharp at any size.
_DRAWN = ("correlation", "budget")


def render(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction] = (), **what: Any
) -> str:
    """The page; the arguments are those of `surae.report.write_report`."""
    traces = traces_of(result)
    content = make_content(result, assessment, traces, predictions=predictions, **what)
    images = {}
    for name, figure in drawings(content, traces, assessment, predictions):
        kind, data = ("svg+xml", svg(figure)) if name in _DRAWN else ("png", png(figure, _DPI))
        images[name] = data_url(data, kind)
    return template("report.html.j2", "surae.report").render(
        content=content, images=images, explore=explorer(traces)
    )


def render_pdf(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction], **what: Any
) -> bytes:
    """The report as PDF; the arguments are those of `surae.report.write_report`."""
    require_typst()
    traces = traces_of(result)
    content = make_content(result, assessment, traces, predictions=predictions, **what)
    drawn = drawings(content, traces, assessment, predictions)
    return on_paper("report.typ", asdict(content), {name: svg(figure) for name, figure in drawn})


def on_paper(markup: str, content: dict[str, Any], images: Mapping[str, bytes]) -> bytes:
    """What a template of ours makes of content, and of images as SVG by their names."""
    templates = files("surae.report").joinpath("templates")
    with tempfile.TemporaryDirectory(prefix="surae-pdf-") as folder:
        Path(folder, "common.typ").write_bytes(templates.joinpath("common.typ").read_bytes())
        for name, drawn in images.items():
            Path(folder, f"{name}.svg").write_bytes(drawn)
        text = templates.joinpath(markup).read_bytes()
        return typeset(text, Path(folder), content | {"images": list(images)})


def write_session_report(
    path: PathLike,
    name: str,
    about: Mapping[str, str | None],
    trials: Sequence[Trial],
    fits: Mapping[str, Fitted],
    joint: Fitted | None,
    *,
    joint_predictions: Mapping[str, Crossed],
    created: datetime,
    **what: Any,
) -> None:
    """Write the report of a session to `path`, a PDF where it ends in ``.pdf``.

    Parameters
    ----------
    path : path
        Where to; a page asks nothing of the outside.
    name, about, trials, fits, joint, joint_predictions, created, **what
        As of `surae.report.session.session_content`.

    Raises
    ------
    InputError
        The file cannot be written, or a PDF needs typst.
    ComputationError
        Typst cannot set the PDF.
    """
    check_report(path)
    content = session_content(
        name, about, trials, fits, joint,
        joint_predictions=joint_predictions, created=created, **what,
    )  # fmt: skip
    figures = session_drawings(trials, fits, joint, joint_predictions)
    images = {name: svg(figure) for name, figure in figures.items()}
    agreed = joint is not None and not content.contradictions
    page = fit_page(*joint, created=created) if joint is not None and agreed else None
    if is_pdf(path):
        drawn = {} if page is None else {n: _bytes(url) for n, url in page.images.items()}
        said = None if page is None else asdict(replace(page, images={}))
        write_atomic(
            path, on_paper("session.typ", asdict(content) | {"page": said}, images | drawn)
        )
        return
    urls = {name: data_url(drawn) for name, drawn in images.items()}
    explore = None if joint is None else explorer(traces_of(joint[0]))
    text = template("session.html.j2", "surae.report").render(
        content=content, images=urls, page=page, explore=explore
    )
    write_atomic(path, text)


def _bytes(url: str) -> bytes:
    return base64.b64decode(url.partition(",")[2])
