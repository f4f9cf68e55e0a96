"""The reproduction as one HTML page that asks nothing of the outside."""

import base64
from collections.abc import Sequence

from surae._version import __version__
from surae.files import read_bytes
from surae.report.digits import significant
from surae.reproduction.chapter import Cell, Context
from surae.reproduction.kept import Chapter, counts

#: Classes of the verdicts in the style sheet.
CLASSES = {"holds": "holds", "differs": "differs", "cannot be checked": "unchecked"}


def page(context: Context, chapters: Sequence[Chapter]) -> str:
    """The page of these sections, its figures embedded.

    Raises
    ------
    InputError
        A figure cannot be read.
    """
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=ChoiceLoader([PackageLoader("surae.reproduction"), PackageLoader("surae.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    images = {
        picture.name: _image(read_bytes(context.folder / "figures" / f"{picture.name}.png"))
        for chapter in chapters
        for picture in chapter.pictures
    }
    return environment.get_template("reproduction.html.j2").render(
        chapters=chapters,
        counts=counts(chapters),
        images=images,
        classes=CLASSES,
        cell=cell_text,
        seed=context.seed,
        quick=context.quick,
        version=__version__,
    )


def cell_text(cell: Cell) -> str:
    """A cell of a table as text: four digits of a number at most."""
    if cell is None:
        return "–"
    if isinstance(cell, float):
        return f"{cell:.2f}" if 10.0 <= abs(cell) < 1e4 else significant(cell, 3)
    return str(cell)


def _image(data: bytes) -> str:
    return f"data:image/png;base64,{base64.b64encode(data).decode()}"
