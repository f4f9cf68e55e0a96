"""What stages say below the report: codes with values, said alike in every language."""

import pickle
import re
from importlib.resources import files

import pytest

from surae.base.names import LANGUAGES
from surae.base.words import Message, english
from surae.report.language import words_in

NESTED = Message(
    "note/trades",
    known=Message("note/known-only", percent=Message("{p:.2g} %", p=7.25)),
    partner="a.b",
    r=-0.953,
)


def test_a_message_is_its_english_sentence_and_keeps_its_parts() -> None:
    assert NESTED.startswith("known only to ±7.2 %: trades off with a.b (correlation −0.95)")
    assert words_in("en")(NESTED) == NESTED
    again = pickle.loads(pickle.dumps(NESTED))
    assert (again, again.code, again.values) == (NESTED, "note/trades", NESTED.values)


@pytest.mark.parametrize("language", LANGUAGES[1:])
def test_numbers_and_parts_are_said_in_the_language_and_names_as_they_are(language) -> None:
    said = words_in(language)(NESTED)
    assert "±7,2 %" in said
    assert "−0,95" in said
    assert "a.b" in said  # the user's own stays
    assert "known" not in said


def test_pages_get_the_parts_that_they_make_it_of() -> None:
    parts = NESTED.parts()
    assert parts["message"] == "note/trades"
    assert parts["given"]["r"] == "−0.95"
    assert parts["given"]["known"]["message"] == "note/known-only"


def test_what_no_catalogue_has_is_its_own_sentence_braces_and_all() -> None:
    assert words_in("nl")(Message("{a} of {b}")) == Message("{a} of {b}") == "{a} of {b}"


def test_a_joint_s_words_enter_before_the_values() -> None:
    def worded(text):
        return text.replace("ankle", "wrist")

    assert Message("against/still", worded, moved=2.0).startswith("the wrist hardly moves (2°")
    trial = Message("against/trial-not-followed", worded, trial="my ankle.csv", r2=1.0)
    assert trial.startswith("my ankle.csv ")


def test_every_code_in_the_source_has_a_sentence() -> None:
    said = set()
    for path in files("surae").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        codes = r'(?:Message|NotDefinedError)\(\s*"([a-z]+/[a-zA-Z/-]+)"'
        said |= set(re.findall(codes, text))
        said |= {f"found/{code}" for code in re.findall(r'make_finding\(\s*"([a-z/-]+)"', text)}
        said |= {f"against/{code}" for code in re.findall(r'[ =]against\(\s*"([a-z-]+)"', text)}
    assert len(said) > 100
    assert said <= english().keys()
