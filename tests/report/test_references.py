"""The papers behind a fit: those of what it used, and no others."""

import re
from importlib.resources import files

import pytest

import surae
from surae.protocol import Protocol, generate
from surae.report.references import always_cited, cited_by, references
from surae.studies import virtual_subject, virtual_trial


def keys(fit: surae.Fit) -> list[str]:
    return [each.reference.key for each in cited_by(fit.result, fit.assessment)]


@pytest.fixture(scope="module")
def trial():  # type: ignore[no-untyped-def]
    settings = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=32.0, chirp_rate=0.2)
    return virtual_trial(virtual_subject(seed=1), generate(settings))


def test_a_model_without_tendons_cites_no_tendons(trial) -> None:  # type: ignore[no-untyped-def]
    cited = keys(surae.fit(trial, "muscle", starts=1))
    assert {"surae", "vandepoll2015", "golub1973", "more1978", "ljung1978"} <= set(cited)
    assert not {"thelen2003", "alexander1977", "devlugt2010", "holland1977"} & set(cited)
    assert len(cited) == len(set(cited))


def test_what_was_asked_for_is_cited(trial) -> None:  # type: ignore[no-untyped-def]
    assert "devlugt2010" in keys(surae.fit(trial, "muscle-2010", starts=1))
    assert "holland1977" in keys(surae.fit(trial, "muscle", starts=1, loss="huber"))
    tendons = keys(surae.fit(trial, "muscle-tendon", starts=1))
    assert {"thelen2003", "alexander1977"} <= set(tendons)


def test_bibtex_is_balanced_and_dois_are_dois() -> None:
    for reference in references().values():
        assert reference.bibtex.count("{") == reference.bibtex.count("}")
        assert re.match(r"@\w+\{\w+,\n", reference.bibtex)
        assert not reference.doi or re.match(r"10\.\d{4,}/\S+$", reference.doi)
        assert reference.title in reference.text


def test_the_file_is_read_whole_and_unchanged() -> None:
    text = files("surae.report").joinpath("references.bib").read_text(encoding="utf-8")
    assert len(references()) == text.count("\n@")
    for key, reference in references().items():
        assert key == "surae" or reference.bibtex in text
    assert references()["more1978"].text == (
        "Moré, Jorge J. (1978). The Levenberg-Marquardt algorithm: implementation and theory. "
        "Numerical Analysis, Lecture Notes in Mathematics 630, 105--116. doi:10.1007/BFb0067700"
    )
    assert always_cited()[0].reference.key == "surae"
    assert surae.__version__ in references()["surae"].text
