"""Content set as PDF by typst, which the extra ``pdf`` brings."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from surae.errors import ComputationError, InputError


def has_typst() -> bool:
    """Whether typst is installed."""
    try:
        import typst  # noqa: F401
    except ImportError:
        return False
    return True


def require_typst() -> None:
    """Refuse to make a PDF where nothing can set it."""
    if not has_typst():
        raise InputError(
            'a PDF needs typst: pip install "surae[pdf]" installs it; the HTML report needs nothing'
        )


def typeset(template: bytes, folder: Path, content: Mapping[str, Any]) -> bytes:
    """The PDF that a template makes of plain data.

    Parameters
    ----------
    template : bytes
        Typst's markup. It reads `content` as data: no text in it is ever markup.
    folder : Path
        Where the template's images are.
    content : mapping
        What JSON can hold.

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
