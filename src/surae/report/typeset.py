"""What a report may be written as, and content set as PDF by typst, the extra ``pdf``."""

import json
import os
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from surae.base.errors import ComputationError, InputError
from surae.base.files import PathLike, shown


def has_typst() -> bool:
    """Whether typst is installed."""
    return find_spec("typst") is not None


def typeset(template: bytes, folder: Path, content: Mapping[str, Any]) -> bytes:
    """The PDF that a template makes of plain data, with the images in `folder`.

    The template is Typst's markup; it reads `content` as data: no text in it is ever markup.

    Raises
    ------
    ComputationError
        Typst cannot set it.
    """
    import typst

    # Its types want source and root to be the same kind of thing: here bytes and a path.
    compiled: Callable[..., object] = typst.compile
    try:
        printed = compiled(template, root=str(folder), sys_inputs={"content": json.dumps(content)})
    except Exception as error:  # typst's own errors have no common type in all versions
        text = " ".join(str(error).split())
        raise ComputationError(f"typst could not set the PDF: {text}") from error
    if not isinstance(printed, bytes):
        raise ComputationError("typst gave no PDF")
    return printed


def is_pdf(path: PathLike) -> bool:
    """Whether a report of this name is a PDF, not a page."""
    return os.fspath(path).lower().endswith(".pdf")


def check_report(path: PathLike | None) -> None:
    """Refuse a report that could not be made, before the work instead of after it.

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
    if is_pdf(path) and not has_typst():
        raise InputError(
            'a PDF needs typst: pip install "surae[pdf]" installs it; the HTML report needs nothing'
        )
