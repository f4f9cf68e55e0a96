"""A report for paper: a file that ends in .pdf, with all that the page says."""

import json
import sys

import pytest

import surae
from surae.base.errors import InputError
from surae.inference import Verdict
from surae.quality import SEVERITIES
from surae.report import check_report, output
from undrawn import blank_figures


@pytest.fixture(scope="module")
def fit(noisy):
    """A fit of a recording in which something is found."""
    from dataclasses import replace

    return surae.fit(
        replace(noisy, name='a *b* #c "d"', torque=noisy.torque + 12.0), "muscle", starts=1
    )


def test_the_ending_says_that_it_is_a_pdf(fit, noisy, tmp_path) -> None:
    fit.report(tmp_path / "report.pdf", validation=surae.validate(fit, [noisy]))
    with blank_figures():
        fit.report(tmp_path / "REPORT.PDF")
        fit.report(tmp_path / "report.html")
    for name in ("report.pdf", "REPORT.PDF"):
        assert (tmp_path / name).read_bytes().startswith(b"%PDF-")
    assert (tmp_path / "report.html").read_text().startswith("<!DOCTYPE html>")


@pytest.mark.usefixtures("undrawn")
def test_it_holds_findings_and_predictions(fit, noisy, tmp_path, monkeypatch) -> None:
    seen = {}

    def keep(template: bytes, folder, content) -> bytes:
        assert template
        seen.update(json.loads(json.dumps(content)), images={f.name for f in folder.iterdir()})
        return b"%PDF-"

    monkeypatch.setattr(output, "typeset", keep)
    fit.report(tmp_path / "report.pdf", validation=surae.validate(fit, [noisy, noisy]))
    inner = [b for block in seen["blocks"] if block.get("look") == "more" for b in block["blocks"]]
    every = [block for block in (*seen["blocks"], *inner) if "title" in block]
    sections = {block["title"]: block["blocks"] for block in every}
    ((_, rows),) = sections["Checks"][0]["groups"]
    found = {f.code: f for f in fit.quality[0].findings}
    assert {row[0]["text"] for row in rows} == {*found}
    ends = [found[row[0]["text"]].severity for row in rows]
    assert ends == sorted(ends, key=SEVERITIES.index, reverse=True)
    assert "torque-offset" in {row[0]["text"] for row in rows}
    _, table, _ = sections["Predicting other recordings"]
    assert len(table["groups"][0][1]) == 3  # two, and all together
    assert sections["Summary"][0]["grade"] == str(fit.adequacy.grade)
    assert sections["Summary"][0]["reasons"] == list(fit.adequacy.reasons)
    budget = sections["What makes each parameter unsure"][0]["text"]
    assert budget.startswith("The intervals of this fit contain the noise")
    *_, table = sections["Parameters"]
    badges = {row[-1]["badge"][0] for _, rows in table["groups"] for row in rows}
    assert badges <= {f"verdict {verdict}" for verdict in Verdict}
    assert {"predictions.svg", "torque-0.svg"} <= seen["images"]


def test_without_typst_it_is_refused_beforehand(fit, tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(InputError, match=r"needs typst: pip install"):
        check_report("report.pdf")
    with pytest.raises(InputError, match="needs typst"):
        fit.report(tmp_path / "report.pdf")
    assert not (tmp_path / "report.pdf").exists()
    check_report("report.html")
    check_report(None)
