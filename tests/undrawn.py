"""What makes tests quick whose claims are others: reports without figures, measures of few legs."""

import base64
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure

from surae.measures import compute
from surae.report import leg, session

#: An image of one dot.
_PNG = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNkYAAAAAYAAjCB0C8AAAAASUVORK5CYII="
)
_SVG = b'<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>'


@contextmanager
def few_legs() -> Iterator[None]:
    """Intervals of measures from 64 possible legs: for tests that claim other things of them."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("surae.measures.bent._DRAWS", 64)
        yield
    compute.judged_measures.cache_clear()


@contextmanager
def blank_figures(*, made: bool = True) -> Iterator[None]:
    """Figures are a dot each: to draw them takes longer than all else of a small report.

    Those of a session are not even `made` where another test makes the same.
    """
    dot = Figure()
    with pytest.MonkeyPatch.context() as patched:
        for module in () if made else (leg, session):
            for name in vars(module).copy():
                if name.endswith(("_figure", "shares_bar")):
                    patched.setattr(module, name, lambda *_, **__: dot)
        for module in ("output", "figures"):
            patched.setattr(f"surae.report.{module}.png", lambda *_: _PNG)
            patched.setattr(f"surae.report.{module}.svg", lambda *_: _SVG)
        yield
