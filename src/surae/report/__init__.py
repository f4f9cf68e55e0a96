"""Reports of fits: one HTML file to read, print and keep."""

import os
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from surae.errors import InputError
from surae.files import PathLike, shown, write_atomic
from surae.report.typeset import has_typst, typeset

if TYPE_CHECKING:  # modules of this package are also used where nothing is computed
    from surae.assessment import Assessment, Prediction
    from surae.estimation import FitResult
    from surae.quality import Quality

__all__ = ["build", "check_report", "has_typst", "typeset", "write_report"]


def build(
    result: "FitResult",
    assessment: "Assessment",
    *,
    versions: Mapping[str, str],
    created: datetime,
    predictions: "Sequence[Prediction]" = (),
    quality: "Sequence[Quality]" = (),
) -> str:
    """The report of a fit as one HTML page, which needs no script and no other file.

    Parameters
    ----------
    result : FitResult
        A fit of one or more recordings.
    assessment : Assessment
        What it is worth.
    versions : mapping of str to str
        Names and versions of the programs that made the fit.
    created : datetime
        When the report is made; the same arguments give the same page.
    predictions : sequence of Prediction
        Of other recordings, with the parameters of the fit.
    quality : sequence of Quality
        What was found in each recording before it was fitted.

    Returns
    -------
    str
        HTML.
    """
    from surae.report.rendering import render  # matplotlib and Jinja, only when a report is made

    return render(
        result, assessment, predictions, versions=versions, created=created, quality=quality
    )


def write_report(
    path: PathLike,
    result: "FitResult",
    assessment: "Assessment",
    *,
    versions: Mapping[str, str],
    created: datetime,
    predictions: "Sequence[Prediction]" = (),
    quality: "Sequence[Quality]" = (),
) -> None:
    """Write the report of a fit to `path`, a PDF where it ends in ``.pdf``; see `build`.

    Raises
    ------
    InputError
        The file cannot be written, or a PDF needs typst.
    ComputationError
        Typst cannot set the PDF.
    """
    check_report(path)
    what: dict[str, Any] = {"versions": versions, "created": created, "quality": quality}
    if is_pdf(path):
        from surae.report.rendering import render_pdf

        write_atomic(path, render_pdf(result, assessment, predictions, **what))
    else:
        write_atomic(path, build(result, assessment, predictions=predictions, **what))


def is_pdf(path: PathLike) -> bool:
    """Whether a report of this name is a PDF, not a page."""
    return os.fspath(path).lower().endswith(".pdf")


def check_report(path: PathLike | None) -> None:
    """Refuse a report that could not be made, before the work instead of after it.

    Parameters
    ----------
    path : path or None
        Where it shall be written; None: nowhere.

    Raises
    ------
    InputError
        It is a PDF, and typst is not installed; or of another kind than HTML and PDF.
    """
    if path is None:
        return
    ending = Path(path).suffix.lower()
    if ending not in ("", ".html", ".htm", ".pdf"):
        raise InputError(f"{shown(path)}: a report is a page or a PDF; give .html or .pdf")
    if is_pdf(path):
        from surae.report.typeset import require_typst

        require_typst()
