"""The pages of tissue and reflex in the reader's language."""

import pytest

import surae
from perturbed_ankle import Ankle, ramps
from surae.api.perturbed import perturbation_page
from surae.base.names import LANGUAGES
from surae.base.words import Message
from surae.nerve.stretch_records import StretchThreshold
from surae.report.language import words_in
from surae.report.nerve import _translated


def texts(page):
    """All texts of a page's blocks."""
    found = []
    for each in page.document.blocks:
        inside = getattr(each, "blocks", ())
        found += [each.text for each in (each, *inside) if each.kind == "paragraph"]
    return found


@pytest.fixture(scope="module")
def told():
    return surae.stretches(ramps((10.0, 10.0, 120.0, 120.0), neural=6.0))


@pytest.mark.parametrize("language", [each for each in LANGUAGES if each != "en"])
def test_nothing_of_a_page_of_stretches_is_left_in_english(told, language) -> None:
    english, other = perturbation_page(told), perturbation_page(told, language)
    pairs = list(zip(texts(english), texts(other), strict=True))
    assert len(pairs) > 4
    assert all(a != b for a, b in pairs)
    assert english.document.heading != other.document.heading
    assert other.document.language == language


def test_a_note_keeps_its_values_in_every_language() -> None:
    note = Message(
        "Left out: {what}.",
        what=Message("{seconds:.2g} s {what}", seconds=1.5, what=Message("without samples")),
    )
    assert note == "Left out: 1.5 s without samples."
    assert words_in("nl")(note) == "Weggelaten: 1,5 s zonder meetpunten."
    threshold = StretchThreshold(None, None, "undetermined", note)
    assert threshold.note == str(note)


@pytest.mark.parametrize("language", ["nl", "de", "fr"])
def test_nothing_of_a_page_of_perturbations_is_left_in_english(language) -> None:
    own = surae.impedance(Ankle(seconds=30.0).recording())
    english = texts(perturbation_page(own))
    pairs = list(zip(english, texts(perturbation_page(own, language)), strict=True))
    assert all(a != b for a, b in pairs)
    assert all(words_in(language)(m.note) != m.note for m in own.measures.values() if m.note)


def test_the_name_of_a_file_is_as_the_user_wrote_it() -> None:
    row = ("fast.csv", "3.95", "dorsiflexion", "-27 to 11", "with EMG")
    assert _translated(row, words_in("de"))[:2] == ("fast.csv", "3,95")
