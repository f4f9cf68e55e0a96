"""What a comparison was asked beforehand."""

from collections.abc import Iterable, Sequence

from surae.base.errors import InputError
from surae.base.formatting import nearest
from surae.measures.plain import PLAIN
from surae.measures.strength import STRENGTH

#: Questions by a word: the measures that they are about.
QUESTIONS = {"strength": tuple(STRENGTH)}


def asked_of(question: Sequence[str], names: Iterable[str]) -> frozenset[str]:
    """The names that a question is about."""
    every = tuple(names)
    asked: set[str] = set()
    for one in question:
        of = [name for name in QUESTIONS.get(one, ()) if name in every]
        if one in QUESTIONS and not of:
            raise InputError(
                f"question {one!r}: neither visit has a trial of maximal effort; record three "
                "efforts of each group, held still, and name the file max"
            )
        of = of or [name for name in every if one in (name, name.partition("@")[0])]
        if not of and one.partition("@")[0] in PLAIN:
            raise InputError(
                f"question {one!r}: one of the visits has none of it; what is read from rest asks "
                "for half a minute without effort at each, through the range"
            )
        if not of:
            raise InputError(
                f"question {one!r}: no such measure or parameter is compared"
                f"{nearest(one, (*every, *QUESTIONS))}"
            )
        asked.update(of)
    return frozenset(asked)
