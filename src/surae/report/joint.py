"""A report in the words of its joint: what is written of the ankle, for another one."""

from collections.abc import Iterable, Iterator, Set
from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar, cast

from surae.inference import FitResult
from surae.model.joint import ANKLE, Joint

if TYPE_CHECKING:
    from surae.report.figures import Figure

T = TypeVar("T")
#: Fields of blocks that are no text: what style sheets and links go by.
_NO_TEXT = ("kind", "look", "anchor", "link", "links", "name")


def given_in(*results: FitResult, more: Iterable[str | None] = ()) -> frozenset[str]:
    """What users gave that a report shows: names of recordings and files, and `more`."""
    inputs = [recording for result in results for recording in result.problem.inputs]
    files = [file.name for recording in inputs for file in recording.files]
    return frozenset(filter(None, (*(own.name for own in inputs), *files, *more)))


def reworded(joint: Joint, part: T, given: Set[str], language: str = "en") -> T:
    """A document, or a part of one, in the words of this joint, all but what users gave."""
    if joint == ANKLE:
        return part
    made: Any = part
    if isinstance(part, str):
        made = joint.worded(part, language, given)
    elif isinstance(part, tuple):
        made = tuple(reworded(joint, each, given, language) for each in part)
    elif is_dataclass(part) and not isinstance(part, type):
        own = ((f.name, getattr(part, f.name)) for f in fields(part) if f.init)
        said = {n: reworded(joint, v, given, language) for n, v in own if n not in _NO_TEXT}
        made = replace(part, **said)
    return cast(T, made)


def relabelled(
    joint: Joint, figures: "Iterable[tuple[str, Figure]]", given: Set[str], language: str = "en"
) -> "Iterator[tuple[str, Figure]]":
    """Figures, each with its text in the words of this joint, all but what users gave."""
    for name, figure in figures:
        if joint != ANKLE:
            from matplotlib.text import Text

            for text in figure.findobj(Text):
                text.set_text(joint.worded(text.get_text(), language, given))
        yield name, figure
