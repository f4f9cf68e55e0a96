"""The report of a session as a page or on paper; both say the same."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from datetime import datetime
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from surae.files import PathLike, write_atomic
from surae.report import check_report, is_pdf
from surae.report.clinical import fit_page
from surae.report.explore import explorer
from surae.report.figures.style import svg
from surae.report.pdf import on_paper
from surae.report.session import Fitted, session_content, session_drawings
from surae.report.traces import traces_of
from surae.trials import Crossed, Trial


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
    environment = Environment(
        loader=PackageLoader("surae.report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    urls = {name: _url(drawn) for name, drawn in images.items()}
    explore = None if joint is None else explorer(traces_of(joint[0]))
    template = environment.get_template("session.html.j2")
    write_atomic(path, template.render(content=content, images=urls, page=page, explore=explore))


def _url(drawn: bytes) -> str:
    return f"data:image/svg+xml;base64,{base64.b64encode(drawn).decode()}"


def _bytes(url: str) -> bytes:
    return base64.b64decode(url.partition(",")[2])
