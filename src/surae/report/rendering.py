"""Reports of fits and sessions: one HTML file that asks nothing of the outside, or a PDF."""

import tempfile
from base64 import b64decode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from importlib.resources import files
from itertools import chain
from pathlib import Path
from typing import Any

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.files import PathLike, template, write_atomic
from surae.model import GeometryTable
from surae.report.budget import BudgetTable, budget_of
from surae.report.content import fit_document
from surae.report.document import Document, SectionBlock
from surae.report.explore import explorer, signals_of
from surae.report.figures import (
    Figure,
    correlation_figure,
    data_url,
    png,
    prediction_figure,
    residual_figure,
    svg,
    tendon_figure,
    torque_figure,
)
from surae.report.figures.budget import budget_figure
from surae.report.figures.film import film_figure
from surae.report.figures.geometry import geometry_figure
from surae.report.recordings import GROUPS
from surae.report.sections import predictions_section
from surae.report.session import session_report
from surae.report.traces import Traces, traces_of
from surae.report.typeset import check_report, is_pdf, require_typst, typeset

__all__ = [
    "drawings",
    "fit_blocks",
    "page_of",
    "paper_of",
    "prediction_blocks",
    "render",
    "render_pdf",
    "session_blocks",
    "write_blocks",
]

#: Resolution of the others [dots per inch].
_DPI = 150
#: Figures of few lines and many letters, which stay sharp at any size.
_DRAWN = ("correlation", "budget")


def render(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction] = (), **about: Any
) -> str:
    """The page; the arguments are those of `surae.report.write_report`."""
    document, figures, traces = _of_fit(result, assessment, predictions, **about)
    return page_of(document, _urls(figures), signals_of(traces))


def fit_blocks(result: FitResult, assessment: Assessment, **about: Any) -> dict[str, Any]:
    """The report of a fit as plain data for `surae.report.part_of`; arguments as of `render`."""
    document, figures, traces = _of_fit(result, assessment, (), **about)
    return _plain(document, _urls(figures), traces)


def prediction_blocks(
    assessment: Assessment, predictions: Sequence[Prediction]
) -> tuple[tuple[SectionBlock, ...], dict[str, str]]:
    """How other recordings are predicted, and its images."""
    drawn = ((f"prediction-{k}", prediction_figure(p)) for k, p in enumerate(predictions))
    return predictions_section(assessment, predictions), _urls(drawn)


def _urls(figures: Iterable[tuple[str, Figure]]) -> dict[str, str]:
    """Figures as data URLs."""
    images = {}
    for name, figure in figures:
        kind, data = ("svg+xml", svg(figure)) if name in _DRAWN else ("png", png(figure, _DPI))
        images[name] = data_url(data, kind)
    return images


def _plain(
    document: Document, images: Mapping[str, str], traces: Sequence[Traces]
) -> dict[str, Any]:
    """What `surae.report.part_of` and `write_blocks` take."""
    return asdict(document) | {"images": images, "signals": signals_of(traces)}


def render_pdf(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction], **about: Any
) -> bytes:
    """The report as PDF; the arguments are those of `surae.report.write_report`."""
    require_typst()
    document, figures, _ = _of_fit(result, assessment, predictions, **about)
    return paper_of(asdict(document), {name: svg(figure) for name, figure in figures})


def _of_fit(
    result: FitResult, assessment: Assessment, predictions: Sequence[Prediction], **about: Any
) -> tuple[Document, Iterator[tuple[str, Figure]], tuple[Traces, ...]]:
    """What a fit's report is made of: its document, its figures one by one, and its signals."""
    traces = traces_of(result)
    document = fit_document(result, assessment, traces, predictions=predictions, **about)
    budget = budget_of(result, assessment)
    figures = drawings(budget, traces, assessment, predictions)
    if isinstance(result.problem.options.geometry, GeometryTable):
        figures = chain(figures, [("geometry", geometry_figure(result.problem.options, GROUPS))])
    return document, figures, traces


def drawings(
    budget: BudgetTable,
    traces: Sequence[Traces],
    assessment: Assessment,
    predictions: Sequence[Prediction],
) -> Iterator[tuple[str, Figure]]:
    """Name and figure, such as ``"torque-0"``; the same on the page and on paper."""
    for number, (trial, white) in enumerate(zip(traces, assessment.whiteness, strict=True)):
        yield f"torque-{number}", torque_figure(trial)
        residual = residual_figure(trial.time, trial.residual, white, trial.excluded)
        yield f"residual-{number}", residual
        if trial.tendon is not None:
            yield f"tendon-{number}", tendon_figure(trial, trial.tendon)
        for place, film in enumerate(trial.films):
            yield f"film-{number}-{place}", film_figure(trial, film)
    for number, prediction in enumerate(predictions):
        yield f"prediction-{number}", prediction_figure(prediction)
    if budget.rows:
        yield "budget", budget_figure(budget)
    estimated = assessment.covariance
    if len(estimated.names) > 1:
        group = {p.name: p.group for p in assessment.parameters.values()}
        passive, active = (
            [name for name in estimated.names if group[name] == part]
            for part in ("passive", "active")
        )
        yield (
            "correlation",
            correlation_figure(estimated.names, estimated.correlation, passive, active),
        )


def page_of(
    document: Document | Mapping[str, Any], images: Mapping[str, str], signals: str = ""
) -> str:
    """A document as a page, its images data URLs; what `signals` holds can be zoomed into."""
    return template("page.html.j2", "surae.report").render(
        document=document, images=images, explore=explorer(signals) if signals else None
    )


def paper_of(document: Mapping[str, Any], images: Mapping[str, bytes]) -> bytes:
    """A document, as plain data, as PDF; its images are SVG."""
    with tempfile.TemporaryDirectory(prefix="surae-pdf-") as folder:
        for name, drawn in images.items():
            Path(folder, f"{name}.svg").write_bytes(drawn)
        markup = files("surae.report").joinpath("templates", "paper.typ").read_bytes()
        return typeset(markup, Path(folder), {**document, "images": list(images)})


def session_blocks(**about: Any) -> dict[str, Any]:
    """The report of a session as plain data for `surae.report.part_of` and `write_blocks`.

    `about` is as of `surae.report.session.session_report`.
    """
    report, joint = session_report(**about), about["joint"]
    urls = {name: data_url(svg(figure)) for name, figure in report.figures.items()}
    return _plain(report.document, urls, () if joint is None else traces_of(joint[0]))


def write_blocks(
    path: PathLike, *, images: Mapping[str, str], signals: str = "", **document: Any
) -> None:
    """Write a report that is plain data, its images SVG: a PDF where `path` ends so, or a page.

    Parameters
    ----------
    path : path
        Where to.
    images : mapping of str to str
        Data URLs by name.
    signals : str
        What can be zoomed into.
    **document
        The fields of `surae.report.document.Document`.

    Raises
    ------
    InputError
        The file cannot be written, or a PDF needs typst.
    ComputationError
        Typst cannot set the PDF.
    """
    check_report(path)
    if is_pdf(path):
        drawn = {name: b64decode(url.partition(",")[2]) for name, url in images.items()}
        write_atomic(path, paper_of(document, drawn))
    else:
        write_atomic(path, page_of(document, images, signals))
