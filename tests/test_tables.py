"""Answers as tables: text in a console, HTML in a notebook."""

import re
from importlib.resources import files

import surae
from surae.base.names import LANGUAGES
from surae.base.tables import TextTable
from surae.base.words import JUDGEMENTS
from surae.inference import Grade, Verdict
from surae.measures.difference import ChangeVerdict
from surae.quality import KINDS, SEVERITIES, Finding, Quality, Skipped
from surae.report.language import words_in


def test_text_is_aligned_and_numbers_stand_right() -> None:
    table = TextTable(("of", "n"), (("a", "1"), ("bcd", "22")), ("title",), ("end",), ("n",))
    assert table.text().splitlines() == ["title", "", "of    n", "a     1", "bcd  22", "", "end"]


def test_html_escapes_what_a_file_may_be_named() -> None:
    table = TextTable(("<of>",), (("<b>",), ("error",)), ("<title>", "a & b"), ("<end>",))
    html = table.html()
    assert html.count("<tr>") == 3
    for raw in ("<of>", "<b>", "<title>", "<end>", "a & b"):
        assert raw not in html
    assert "color:#c0392b'>error<" in html


def test_findings_are_a_table() -> None:
    found = Finding("mains-hum", "warning", "emg_ta", 0.0, 9.5, 0.1, "V", "A hum.", "Mend it.")
    quality = Quality("trial", (found,), (Skipped("emg-flat", "There is no EMG."),))
    lines = repr(quality).splitlines()
    assert lines[0] == "trial: 1 warning"
    assert "mains-hum" in lines[3]
    assert lines[3].endswith("Mend it.")
    assert lines[-1] == "not checked: emg-flat: There is no EMG."
    assert "mains-hum" in quality._repr_html_()
    assert repr(Quality("trial", ())) == "trial: nothing found"


#: Words that verdicts once had beside their own.
_SECOND = ("known", "roughly", "at its limit", "assumed", "none shown")


def test_a_verdict_has_one_word_in_each_language() -> None:
    """What files, the screen and pages say of a value is one word, and its translation another."""
    for name, judged in JUDGEMENTS.items():
        assert judged.plain in ("", name.replace("-", " "))
    for language in LANGUAGES:
        words = words_in(language)
        told = [words(JUDGEMENTS[each].plain) for each in (*Verdict, *ChangeVerdict)]
        assert len(set(told)) == len(told), language
        if language != "en":
            assert not [each for each in _SECOND if each in words.messages], language


def test_every_verdict_and_finding_has_its_word_colour_and_advice() -> None:
    """On the leg's page, on the screen, on paper and in the workbench."""
    css = (files("surae_workbench.web") / "static" / "css" / "parts.css").read_text(
        encoding="utf-8"
    )
    paper = (files("surae.report") / "templates" / "report.css").read_text(encoding="utf-8")
    js = (files("surae_workbench.web") / "static" / "js" / "core" / "format.js").read_text(
        encoding="utf-8"
    )
    for word in (*Verdict, *ChangeVerdict):
        assert JUDGEMENTS[word].plain
    for word in (*Verdict, *Grade, *SEVERITIES):
        assert JUDGEMENTS[word].role
    for word in Verdict:
        assert f".mark.{word}" in css
        assert f".verdict.{word}" in paper
        assert re.search(rf'"?{word}"?: _\("', js)
    for grade in Grade:
        assert f".adequacy.{grade}" in paper
    for kind in KINDS.values():
        assert kind.looks_for
        assert kind.advice.endswith(".")
        assert kind.severity in SEVERITIES


def test_an_expectation_is_a_table() -> None:
    expectation = surae.expect("multiple-holds", model="muscle", legs=2)
    lines = repr(expectation).splitlines()
    assert lines[0].startswith("multiple-holds: ")
    assert sum(line.split()[0] == "k_tri" for line in lines if line) == 1
    assert "identified" in lines[-2]
    assert "k_tri" in expectation._repr_html_()
