"""Reports of fits: one HTML file to read, print and keep."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from surae.files import PathLike, template, write_atomic
from surae.report.typeset import check_report, has_typst, is_pdf, typeset

if TYPE_CHECKING:  # modules of this package are also used where nothing is computed
    from surae.assessment import Assessment, Prediction
    from surae.estimation import FitResult
    from surae.quality import Quality

__all__ = ["check_report", "has_typst", "part_of", "style", "typeset", "write_report"]


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
    """Write the report of a fit to `path`: a PDF where it ends in ``.pdf``, else one HTML page.

    The page needs no script and no other file; the same arguments give the same. `versions` are
    those of the programs that made the fit, `created` is when the report is made, `predictions` are
    of other recordings, `quality` is what was found in each recording before it was fitted.

    Raises
    ------
    InputError
        The file cannot be written, or a PDF needs typst.
    ComputationError
        Typst cannot set the PDF.
    """
    check_report(path)
    about: dict[str, Any] = {"versions": versions, "created": created, "quality": quality}
    from surae.report.rendering import render, render_pdf  # matplotlib, only when one is made

    report = (render_pdf if is_pdf(path) else render)(result, assessment, predictions, **about)
    write_atomic(path, report)


def style() -> str:
    """The style sheet of reports, of what stands within an element of class ``report``."""
    text = files("surae.report").joinpath("templates", "report.css").read_text(encoding="utf-8")
    text = text.replace(".live .", ".live & .")  # the class of the whole page, once plots are drawn
    light = "& { background: #fff; color: var(--ink); padding: .2rem; }"
    return f".report {{\n{text.replace(':root', '&', 1)}{light}\n}}\n"


def part_of(
    blocks: Sequence[Any],
    images: Mapping[str, str],
    signals: str = "",
    **heading: Any,  # noqa: ARG001
) -> str:
    """Blocks of a report as a part of another page, whose headings begin at the second level.

    All texts are escaped; blocks may be as they were or plain data, `images` are data URLs.
    `signals` is what ``explore.js`` draws to be zoomed into, where the page has that script; a
    `heading` is the other page's own.
    """
    macros: Any = template("blocks.html.j2", "surae.report").module
    data = f'<script type="application/json" id="signals">{signals}</script>' if signals else ""
    return f"{macros.show_all(blocks, images, 2)}{data}"
