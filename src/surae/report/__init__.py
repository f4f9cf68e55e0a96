"""Reports of fits: one HTML file to read, print and keep."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import TYPE_CHECKING

from surae.files import PathLike, write_atomic

if TYPE_CHECKING:  # modules of this package are also used where nothing is computed
    from surae.assessment import Assessment, Prediction
    from surae.estimation import FitResult
    from surae.quality import Quality

__all__ = ["build", "write_report"]


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
    from surae.report.html import render  # matplotlib and Jinja, only when a report is made

    return render(
        result,
        assessment,
        versions=versions,
        created=created,
        predictions=predictions,
        quality=quality,
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
    """Write the report of a fit to `path`; see `build`.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    page = build(
        result,
        assessment,
        versions=versions,
        created=created,
        predictions=predictions,
        quality=quality,
    )
    write_atomic(path, page)
