"""Docstrings that are data: what a measure means, what a command does."""

import ast
import inspect
import textwrap
from collections.abc import Callable
from typing import Any


def docstring(function: Callable[..., Any]) -> str:
    """What a function says of itself; `python -OO` takes it away, then it is read in the source."""
    text = function.__doc__
    if text is None and not __debug__:
        (definition,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
        text = (
            ast.get_docstring(definition, clean=False)
            if isinstance(definition, ast.FunctionDef)
            else None
        )
    return text or ""
