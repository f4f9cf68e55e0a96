"""How a report leaves: as a page, as PDF, and as plain data for parts of other pages."""

import re
import tempfile
from base64 import b64decode
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from surae.base.files import PathLike, template, write_atomic
from surae.report import block, inert_json
from surae.report.figures import Figure, data_url, png, svg
from surae.report.traces import Traces, plots, signals_of
from surae.report.typeset import check_report, is_pdf, typeset

__all__ = ["Report", "page_of", "paper_of", "write_blocks"]

#: Resolution of figures that are no lines [dots per inch].
_DPI = 150
#: Figures with many lines; all others have few lines and many letters, and stay sharp at any size.
_MANY_LINES = ("first", "torque-", "residual-", "tendon-", "predictions")
#: A figure's name, which is that of a file where a page is set on paper.
_NAME = re.compile(r"\w[\w.@ -]*")


@dataclass(frozen=True, slots=True)
class Report:
    """A report: a page that asks nothing of the outside, a PDF, or a part of another page."""

    document: block.Document
    figures: Iterable[tuple[str, Figure]]  #: By name; drawn one by one, and only once.
    traces: tuple[Traces, ...] = ()  #: Signals to zoom into; on paper there are none.

    def page(self) -> str:
        """The page as HTML."""
        plain = self.plain()
        return page_of(self.document, plain["images"], plain["signals"])

    def plain(self, *, lines: bool = False) -> dict[str, Any]:
        """Plain data for `surae.report.part_of` and `write_blocks`; all figures may be `lines`."""
        images = {
            name: data_url(png(figure, _DPI), "png")
            if name.startswith(_MANY_LINES) and not lines
            else data_url(svg(figure))
            for name, figure in self.figures
        }
        return asdict(self.document) | {"images": images, "signals": signals_of(self.traces)}

    def write(self, path: PathLike) -> None:
        """Write the page, or a PDF where `path` ends in ``.pdf``; see `write_blocks`."""
        check_report(path)
        write_blocks(path, **self.plain(lines=is_pdf(path)))


def page_of(
    document: block.Document | Mapping[str, Any], images: Mapping[str, str], signals: str = ""
) -> str:
    """A document as a page, its images data URLs; what `signals` holds can be zoomed into."""
    explore = {**plots(), "data": inert_json(str(signals))} if signals else None
    return template("page.html.j2", "surae.report").render(
        document=document, images=images, explore=explore
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
    """Write a report that is plain data: a PDF where `path` ends so, or a page.

    `images` are data URLs of SVG by name; `document` has the fields of
    `surae.report.block.Document`.
    """
    check_report(path)
    if is_pdf(path):
        drawn = {
            name: b64decode(url.partition(",")[2])
            for name, url in images.items()
            if _NAME.fullmatch(name)
        }
        write_atomic(path, paper_of(document, drawn))
    else:
        write_atomic(path, page_of(document, images, signals))
