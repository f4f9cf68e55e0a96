"""Every symbol and term that a page points at is explained, once."""

import re
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


def test_every_parameter_has_its_meaning_and_what_pages_point_at_exists() -> None:
    meanings = glossary.meanings()
    for spec in MODELS.values():
        for parameter in spec.parameters:
            assert parameter.meaning in meanings[parameter.name]
    scripts = [
        path.read_text(encoding="utf-8")
        for path in Path(glossary.__file__).parent.glob("static/js/**/*.js")
    ]
    told = {key for text in scripts for key in re.findall(r'meant\("([^"]+)"', text)}
    assert told
    assert told <= set(meanings)


def test_the_page_has_all_of_them(browser) -> None:
    page = browser.get("/glossary").text
    for key in glossary.meanings():
        assert f'id="{key}"' in page
    assert browser.get("/api/glossary").json() == glossary.meanings()


def test_models_are_named_shortly() -> None:
    of = {symbol.name: symbol.models for symbol in glossary.symbols()}
    assert of["m"] == ("every model",)
    assert of["k_tib"] == ("every model but the muscle model of 2010, reconstructed",)
    assert len(of["dlt_tri"]) == 3
    assert of["emd"] == ()  # of the automatic one, and of any other where it is freed
