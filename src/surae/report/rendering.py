"""Reports as pages, as PDF, and as parts of other pages."""

import tempfile
from base64 import b64decode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from importlib.resources import files
from itertools import chain
from pathlib import Path
from typing import Any

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.files import PathLike, template, write_atomic
from surae.model import GeometryTable
from surae.quality import Quality
from surae.report.budget import BudgetTable, budget_of
from surae.report.content import fit_document
from surae.report.document import Document
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
from surae.report.figures.joint import relabelled
from surae.report.joint import reworded
from surae.report.recordings import GROUPS
from surae.report.sections import predictions_section
from surae.report.traces import Traces, traces_of
from surae.report.typeset import check_report, is_pdf, typeset

__all__ = ["Report", "fit_report", "page_of", "paper_of"]

#: Resolution of figures that are no lines [dots per inch].
_DPI = 150
#: Figures with many lines; all others have few lines and many letters, and stay sharp at any size.
_MANY_LINES = ("torque-", "residual-", "tendon-", "prediction-")


@dataclass(frozen=True, slots=True)
class Report:
    """A report: a page that asks nothing of the outside, a PDF, or a part of another page."""

    document: Document
    figures: Iterable[tuple[str, Figure]]  #: By name; drawn one by one, and only once.
    traces: tuple[Traces, ...] = ()  #: Signals to zoom into; on paper there are none.

    def page(self) -> str:
        """The page as HTML."""
        return page_of(self.document, self._urls(), signals_of(self.traces))

    def plain(self) -> dict[str, Any]:
        """Plain data for `surae.report.part_of` and `write_blocks`."""
        images, signals = self._urls(), signals_of(self.traces)
        return asdict(self.document) | {"images": images, "signals": signals}

    def write(self, path: PathLike) -> None:
        """Write the page, or a PDF where `path` ends in ``.pdf``.

        Raises
        ------
        InputError
            The file cannot be written, or a PDF needs typst.
        ComputationError
            Typst cannot set the PDF.
        """
        check_report(path)
        if is_pdf(path):
            drawn = {name: svg(figure) for name, figure in self.figures}
            write_atomic(path, paper_of(asdict(self.document), drawn))
        else:
            write_atomic(path, self.page())

    def _urls(self) -> dict[str, str]:
        """Figures as data URLs."""
        return {
            name: data_url(png(figure, _DPI), "png")
            if name.startswith(_MANY_LINES)
            else data_url(svg(figure))
            for name, figure in self.figures
        }


def fit_report(
    result: FitResult,
    assessment: Assessment,
    predictions: Sequence[Prediction] = (),
    *,
    versions: Mapping[str, str],
    created: datetime,
    quality: Sequence[Quality] = (),
) -> Report:
    """The report of a fit.

    `versions` are those of the programs that made the fit, `created` is when the report is made,
    `predictions` are of other recordings, `quality` is what was found in each recording before it
    was fitted. The same arguments give the same report.
    """
    traces, budget = traces_of(result), budget_of(result, assessment)
    document = fit_document(
        result, assessment, traces, budget, predictions=predictions, versions=versions,
        created=created, quality=quality,
    )  # fmt: skip
    figures = drawings(budget, traces, assessment, predictions)
    joint = result.problem.options.anatomy
    if isinstance(result.problem.options.geometry, GeometryTable):
        figures = chain(figures, [("geometry", geometry_figure(result.problem.options, GROUPS))])
    return Report(reworded(joint, document), relabelled(joint, figures), traces)


def session_page(**about: Any) -> Report:
    """The report of a session; `about` is as of `surae.report.session.session_report`."""
    from surae.report.session import session_report  # its numbers are those of a `Report`

    report, joint = session_report(**about), about["joint"]
    traces = () if joint is None else traces_of(joint[0])
    return Report(report.document, report.figures.items(), traces)


def predictions_report(assessment: Assessment, predictions: Sequence[Prediction]) -> Report:
    """How other recordings are predicted, to be a part of a page."""
    drawn = ((f"prediction-{k}", prediction_figure(p)) for k, p in enumerate(predictions))
    return Report(Document("", "", "", "", predictions_section(assessment, predictions)), drawn)


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
