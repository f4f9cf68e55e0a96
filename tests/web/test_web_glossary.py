"""Every symbol and term that a page points at is explained, once."""

from pathlib import Path

from surae.model import MODELS
from surae_workbench.web import glossary


def test_every_entry_of_the_glossary_is_read() -> None:
    text = Path(glossary.__file__).with_name("glossary.md").read_text(encoding="utf-8")
    terms = glossary.terms()
    assert len(terms) == text.count("\n: ") > 20
    assert all(term.text and "`" not in term.text and "**" not in term.text for term in terms)
    (vaf,) = (term for term in terms if term.key == "vaf")
    assert vaf.text.endswith("A high VAF does not make parameters right.")
    keys = [term.key for term in terms] + [symbol.name for symbol in glossary.symbols()]
    assert len(set(keys)) == len(keys)


def test_the_page_has_every_parameter_and_term(browser) -> None:
    page = browser.get("/glossary").text
    for spec in MODELS.values():
        for parameter in spec.parameters:
            assert f'id="{parameter.name}"' in page
            assert parameter.meaning in page
    for term in glossary.terms():
        assert f'id="{term.key}"' in page


def test_models_are_named_shortly() -> None:
    of = {symbol.name: symbol.models for symbol in glossary.symbols()}
    assert of["m"] == ("every model",)
    assert of["k_tib"] == ("every model but the muscle model of 2010, reconstructed",)
    assert len(of["dlt_tri"]) == 3
    assert of["emd"] == ()  # of the automatic one, and of any other where it is freed
