"""The papers behind a fit: those of what it used, and no others."""

import re

import pytest

import surae
from surae.protocol import Protocol, generate
from surae.report.references import ALWAYS, cited_by
from surae.studies import virtual_subject, virtual_trial


def keys(fit: surae.Fit) -> list[str]:
    return [one.reference.key for one in cited_by(fit.result, fit.assessment)]


@pytest.fixture(scope="module")
def trial():  # type: ignore[no-untyped-def]
    settings = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=32.0, chirp_rate=0.2)
    return virtual_trial(virtual_subject(seed=1), generate(settings))


def test_a_model_without_tendons_cites_no_tendons(trial) -> None:  # type: ignore[no-untyped-def]
    found = keys(surae.fit(trial, starts=1))
    assert {"surae", "vandepoll2015", "golub1973", "more1978", "ljung1978"} <= set(found)
    assert not {"thelen2003", "alexander1977", "devlugt2010", "holland1977"} & set(found)
    assert len(found) == len(set(found))


def test_what_was_asked_for_is_cited(trial) -> None:  # type: ignore[no-untyped-def]
    assert "devlugt2010" in keys(surae.fit(trial, "muscle-2010", starts=1))
    assert "holland1977" in keys(surae.fit(trial, starts=1, loss="huber"))
    tendons = keys(surae.fit(trial, "muscle-tendon", starts=1))
    assert {"thelen2003", "alexander1977"} <= set(tendons)


def test_bibtex_is_balanced_and_dois_are_dois() -> None:
    for one in ALWAYS:
        assert one.reference.bibtex.count("{") == one.reference.bibtex.count("}")
        assert re.match(r"@\w+\{\w+,\n", one.reference.bibtex)
        assert not one.reference.doi or re.match(r"10\.\d{4,}/\S+$", one.reference.doi)
        assert one.reference.title in one.reference.text
