"""What speaks against a fit: by code, its sentence, and what the leg's page says of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from surae.base.file_form import filed
from surae.base.frozen import FrozenDict
from surae.base.words import Message, english

#: Reasons that other trials of a leg give against its fit; the first are of its stiffness at rest.
OF_STIFFNESS = ("other-slope", "other-holds", "other-stiffness", "apart")
OF_OTHER_TRIALS = (*OF_STIFFNESS, "misses-trial", "mean-of-trial", "error-stands")


@filed("says")
@dataclass(frozen=True, slots=True)
class Reason:
    """One reason against a fit."""

    code: str  #: Which.
    #: What its sentence tells, by name: numbers, and names of parameters and recordings.
    values: Mapping[str, str | float] = FrozenDict()
    is_grave: bool = False  #: Whether nothing that the fit says counts.
    says: str = ""  #: The sentence: a `Message`, or as a file has it.

    @property
    def plain(self) -> Message:
        """What the leg's page says of it."""
        code = f"plainly/{self.code}"
        return Message(code if code in english() else "plainly/said", **self.values)

    def __str__(self) -> str:
        """The sentence."""
        return self.says


def against(
    code: str, worded: Callable[[str], str] = str, /, *, grave: bool = False, **values: str | float
) -> Reason:
    """A reason against a fit, with what its sentence tells, whose words are `worded` as a joint's.

    ``said`` is what was stated and is doubted, and all that older files have.
    """
    says = Message(f"against/{code}", worded, **values)
    return Reason(code, FrozenDict(values), grave, says)


def as_given(sentences: Sequence[str], saved: Sequence[Reason]) -> tuple[Reason, ...]:
    """Reasons of a file, each with the sentence that it was given there.

    Older files have sentences alone, and a newer surae may put a reason otherwise.
    """
    if len(saved) != len(sentences):
        saved = [against("said", text=text) for text in sentences]
    return tuple(replace(reason, says=text) for reason, text in zip(saved, sentences, strict=True))
