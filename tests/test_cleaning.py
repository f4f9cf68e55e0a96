"""What texts from outside may do to a screen, a page or a file: nothing."""

import unicodedata
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surae.base.cleaning import cleaned
from surae.base.errors import InputError, in_short


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("Tibialis anterior (µV)", "Tibialis anterior (µV)"),
        ("\x1b[31mred\x1b[0m", "red"),
        ("\x9b2Jgone", "gone"),
        ("\x1b]0;title\x07after", "after"),
        ("\x1b]8;;http://x\x1b\\link\x1b]8;;\x1b\\", "link"),
        ("\x1b", ""),
        ("a\tb\r\nc\u2028d\xa0e", "a b  c d e"),
        ("a\0b\x07c", "a?b?c"),
        ("gpj\u202evsc", "gpj?vsc"),
        ("M\udcfcller.csv", "Müller.csv"),
        ("half \ud83d letter", "half ? letter"),
        ("\ufffe\uffff", "??"),
        ("  angle ", "angle"),
    ],
)
def test_a_text_from_outside_becomes_one_printable_line(text: str, line: str) -> None:
    assert cleaned(text) == line


def test_a_long_text_is_cut() -> None:
    assert cleaned("x" * 200) == "x" * 200
    assert cleaned("x" * 10**7) == "x" * 199 + "…"
    assert cleaned("abcdef", 4) == "abc…"


@given(st.text(st.characters(codec=None), max_size=60))
def test_every_text_can_be_printed_encoded_and_stand_in_xml(text: str) -> None:
    line = cleaned(text)
    assert line.isprintable()
    assert not {unicodedata.category(letter) for letter in line} & {"Cc", "Cf", "Cs", "Co", "Cn"}
    assert cleaned(line) == line
    element = ElementTree.Element("name")
    element.text = line
    assert (ElementTree.fromstring(ElementTree.tostring(element)).text or "") == line


def test_an_error_repeats_no_more_of_what_was_given_than_shows_it():
    path = "/data/" + "/".join(["a-patient's folder"] * 20) + "/trial.csv"
    assert in_short(f"{path}: no column 'angle'") == f"{path}: no column 'angle'"
    assert len(str(InputError("A" * 2**20))) < 300
    assert len(str(InputError("plate = " + "A b" * 2**20 + " is none"))) <= 2000
    assert str(InputError("no such file")) == "no such file"
