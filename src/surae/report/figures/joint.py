"""Figures in the words of their joint."""

from collections.abc import Iterable, Iterator

from matplotlib.figure import Figure
from matplotlib.text import Text

from surae.model.joint import ANKLE, Joint


def relabelled(
    joint: Joint, figures: Iterable[tuple[str, Figure]], language: str = "en"
) -> Iterator[tuple[str, Figure]]:
    """Figures, each with its text in the words of this joint."""
    for name, figure in figures:
        for text in figure.findobj(Text) if joint != ANKLE else ():
            text.set_text(joint.worded(text.get_text(), language))
        yield name, figure
