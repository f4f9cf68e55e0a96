"""What is said of a whole fit before anything else: one sentence with a mark, and its reasons."""

from dataclasses import dataclass

from surae.assessment.adequacy import Adequacy, Grade
from surae.report.formatting import percentage

#: A mark that is told from the others without colour, and what a grade means to the reader.
_WORDS = {
    Grade.ADEQUATE: (
        "✓",
        "Adequate: the model follows the torque’s changes (centred R² {r2} %), and nothing that "
        "was looked at speaks against its numbers.",
    ),
    Grade.DOUBTFUL: (
        "!",
        "Doubtful: read every value with the reasons below in mind (centred R² {r2} %).",
    ),
    Grade.INADEQUATE: (
        "✗",
        "Inadequate: no parameter of this fit counts as identified, whatever its interval says "
        "(centred R² {r2} %).",
    ),
}


@dataclass(frozen=True, slots=True)
class AdequacyWords:
    """The grade of a fit in words: its mark, one sentence, and the reasons for it."""

    grade: str
    mark: str
    sentence: str
    reasons: tuple[str, ...]


def adequacy_words(adequacy: Adequacy) -> AdequacyWords:
    """Say what a fit is good for; the same words on screen, on paper and in the workbench."""
    mark, sentence = _WORDS[adequacy.grade]
    return AdequacyWords(
        grade=str(adequacy.grade),
        mark=mark,
        sentence=sentence.format(r2=percentage(adequacy.r2)),
        reasons=adequacy.reasons,
    )
