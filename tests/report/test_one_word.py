"""A verdict, and the torque, have one word in each language."""

import re

import pytest
from babel.messages.pofile import read_po

from surae.base.words import JUDGEMENTS, english
from surae.report.language import catalogue, words_in

#: The words of a verdict in English, and in each language what stands for it, and what does not.
WORDS = {
    "identified": (
        r"\bidentif(y|ies|ied|iable)\b",
        {
            "nl": (r"bepa(al|len)", r"identific"),
            "de": (r"bestimm", r"identifizi"),
            "fr": (r"identifi", r"déterminé\b"),
        },
    ),
    "torque": (
        r"\btorques?\b",
        {
            "nl": (r"moment", r"\b[Kk]oppels?\b"),
            "de": (r"[Dd]rehmoment", r"\bMoments?\b"),
            "fr": (r"moment", r"\b[Cc]ouples?\b"),
        },
    ),
    "weak": (
        r"\bweak\b",
        {"nl": (r"zwak", r"matig"), "de": (r"schwach", r"mäßig"), "fr": (r"faible", r"médiocre")},
    ),
    "roughly": (
        r"\broughly\b",
        {
            "nl": (r"ongeveer|grof|globaal", r"\bruw\b"),
            "de": (r"grob", r"\brau\b"),
            "fr": (r"approximativ|grossièrement", r"\bbrut"),
        },
    ),
}


def said(language):
    """Every English sentence with its translation."""
    with catalogue(language).open("rb") as file:
        messages = read_po(file, language)
    for m in messages:
        if m.id:
            ids = m.id if isinstance(m.id, tuple) else (m.id,)
            texts = m.string if isinstance(m.string, tuple) else (m.string,)
            yield english().get(ids[0], ids[0]), " ".join(texts)


@pytest.mark.parametrize("language", ["nl", "de", "fr"])
@pytest.mark.parametrize("word", sorted(WORDS))
def test_one_word_for_one_thing(word, language) -> None:
    source, others = WORDS[word]
    wanted, refused = others[language]
    used = [(e, t) for e, t in said(language) if re.search(source, e, re.IGNORECASE)]
    assert used
    assert not [t for _e, t in used if re.search(refused, t)]
    if word != "torque":  # a translation may leave out a torque that is meant
        assert not [(e, t) for e, t in used if not re.search(wanted, t, re.IGNORECASE)]


@pytest.mark.parametrize("language", ["en", "nl", "de", "fr"])
def test_no_two_verdicts_have_the_same_word(language) -> None:
    _ = words_in(language)
    plain = ("identified", "weak", "undetermined", "at-bound", "fixed")
    assert len({_(JUDGEMENTS[each].plain).casefold() for each in plain}) == len(plain)
