import json
import re
from dataclasses import replace

import pytest
from matplotlib.figure import Figure

from surae.base.errors import InputError
from surae_thesis.claims import Claim, JudgedClaim, NotThereError, Ruling, judge
from surae_thesis.reproduction import reproduce
from surae_thesis.section import (
    SECTIONS,
    Context,
    Drawing,
    Result,
    Section,
    Table,
    chapters,
    counts,
    keep,
    make_folder,
    sections,
)
from surae_thesis.writers import cell_text, markdown, write

#: Markup of HTML, Markdown and typst at once.
NASTY = "<script>alert(1)</script> | #panic() *b* $x$ [a](b) `c` \\"


def finding_of(name: str, *views: bool | None, ours: str = NASTY) -> JudgedClaim:
    """What becomes of a claim that holds in some views; None is one that is not there."""

    def rule(holds: bool | None) -> Ruling:
        if holds is None:
            raise NotThereError(NASTY)
        return Ruling(holds, ours)

    claim = Claim(
        id=name,
        source="3.1",
        statement=NASTY,
        number=NASTY,
        says=NASTY,
        rule=NASTY,
        ours=rule,
        why=NASTY,
        cause="our cohort",
    )
    names = ["", NASTY][: len(views)]
    return judge(claim, dict(zip(names, views, strict=True)))


def result(context: Context) -> Result:
    figure = Figure(figsize=(2, 1))
    figure.subplots().plot([0, 1])
    return Result(
        findings=(
            finding_of("one", True),
            finding_of("two", False, ours=f"seed {context.seed}"),
            finding_of("three", None),
            finding_of("four", False, True),
        ),
        insights=(NASTY,),
        figures=(Drawing("curve", NASTY, NASTY, NASTY, figure),),
        tables=(
            Table(name="short", title=NASTY, columns=("a", NASTY), rows=((1.25, None), (2, NASTY))),
            Table(name="long", title="All", columns=("a",), rows=((1.0,), (None,)), long=True),
        ),
        notes=(NASTY,),
    )


SECTION = Section(name="simulation", title=NASTY, source="3.1", run=result)


@pytest.fixture
def context(tmp_path) -> Context:
    return Context(folder=tmp_path)


def test_the_folder_holds_page_verdicts_figures_and_tables(context) -> None:
    written = reproduce(context, [SECTION])
    names = {path.relative_to(context.folder).as_posix() for path in context.folder.rglob("*.*")}
    assert {path.name for path in written} <= names
    assert written[0].name == "reproduction.html"
    assert {"figures/curve.png", "figures/curve.svg", "tables/long.csv", "tables/short.csv"} < names
    assert (context.folder / "tables" / "long.csv").read_text() == "a\n1.0\n\n"
    assert counts(chapters(context)) == {
        "holds": 1,
        "holds under a reading": 1,
        "holds with the thesis's integrator": 0,
        "same direction, smaller": 0,
        "calibrated": 0,
        "differs": 1,
        "not tested by this": 0,
        "cannot be checked": 1,
    }


def test_what_differs_is_counted_by_its_cause(context) -> None:
    assert "Of those that differ" not in markdown([])
    reproduce(context, [SECTION])
    for name in ("reproduction.html", "verdicts.md"):
        assert "Of those that differ, 1 by our cohort." in (context.folder / name).read_text()


def test_the_page_shows_text_and_never_runs_it(context) -> None:
    reproduce(context, [SECTION])
    page = (context.folder / "reproduction.html").read_text()
    assert "<script" not in page
    assert page.count("&lt;script&gt;") > 8
    assert "default-src 'none'" in page
    assert "http" not in page.replace("http-equiv", "")
    assert 'src="data:image/png;base64,' in page
    for verdict in ("holds", "differs: our cohort", "cannot be checked"):
        assert re.search(rf'class="verdict [a-z]+"[^>]*>{verdict}<', page)


def test_the_pdf_takes_texts_as_texts(context) -> None:
    reproduce(context, [SECTION])
    assert (context.folder / "reproduction.pdf").read_bytes().startswith(b"%PDF-")


def test_without_typst_there_is_a_page_and_no_pdf(context, monkeypatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "typst", None)
    names = [path.name for path in reproduce(context, [SECTION])]
    assert names == ["reproduction.html", "verdicts.md"]


def test_markdown_keeps_its_table_whatever_the_texts_hold(context) -> None:
    keep(context, SECTION, result(context))
    lines = [x for x in markdown(chapters(context)).splitlines() if x.startswith("| ")]
    assert len(lines) == 5
    for line in lines:
        assert line.replace("\\\\", "").replace("\\|", "").count("|") == 6
    assert "<script" not in markdown(chapters(context)).replace("\\<script", "")


def test_one_section_is_computed_again_and_the_others_keep_their_rows_and_dates(context) -> None:
    titles = [section.title for section in SECTIONS]
    first, other = (
        Section(name=SECTIONS[i].name, title=titles[i], source="3.1", run=result) for i in (1, 2)
    )
    for section in (first, other):
        keep(context, section, replace(result(context), findings=(finding_of("one", True),)))
    earlier = markdown(chapters(context)).replace("Computed on 20", "Computed on 19")
    assert "Verdicts: 2 holds, " in earlier
    renewed = [(other, replace(result(context), made="2001-01-01"))]
    text = markdown(renewed, earlier)
    assert [line[3:] for line in text.splitlines() if line.startswith("## ")] == titles[1:3]
    before, after = (each.split("\n## ") for each in (earlier, text))
    assert before[1] == after[1]
    assert "Computed on 19" in after[1]
    assert "Computed on 2001-01-01." in after[2]
    assert "Verdicts: 2 holds, 1 holds under a reading, " in after[0]
    assert "1 differs, 0 not tested by this, 1 cannot be checked." in after[0]
    assert "Of those that differ, 1 by our cohort." in after[0]
    assert markdown(chapters(context), text) == markdown(chapters(context))


def test_a_file_that_is_no_table_of_verdicts_is_written_anew(context) -> None:
    keep(context, SECTION, result(context))
    there = chapters(context)
    assert markdown(there, "# Notes\n\n## Mine\n\nkept") == markdown(there)


def test_a_section_of_another_version_stays_and_says_so(context, monkeypatch) -> None:
    monkeypatch.setattr("surae_thesis.section.__version__", "0.0.1")
    keep(context, SECTION, result(context))
    monkeypatch.undo()
    [(_, kept)] = chapters(context)
    assert kept.made.endswith("by surae 0.0.1, seed 1")
    write(context)
    for name in ("reproduction.html", "verdicts.md"):
        assert "omputed on 20" in (context.folder / name).read_text()


def test_a_section_of_other_settings_is_not_on_the_page(context, tmp_path) -> None:
    keep(context, SECTION, result(context))
    assert len(chapters(context)) == 1
    assert chapters(Context(folder=tmp_path, seed=2)) == []
    assert chapters(Context(folder=tmp_path, quick=True)) == []


@pytest.mark.parametrize("text", ["", "[]", "{}", "no JSON"])
def test_a_damaged_section_is_named(context, text) -> None:
    keep(context, SECTION, result(context))
    path = context.folder / "sections" / "simulation.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"simulation\.json is not what a section writes"):
        write(context)


def test_findings_of_the_wrong_shape_are_named(context) -> None:
    keep(context, SECTION, result(context))
    path = context.folder / "sections" / "simulation.json"
    data = json.loads(path.read_text())
    del data["findings"][0]["statement"]
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match="remove it and run the section again"):
        chapters(context)


def test_what_is_finished_is_on_the_page_when_a_later_section_fails(context) -> None:
    def stops(context):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reproduce(context, [SECTION, Section(name="later", title="", source="", run=stops)])
    assert "seed 1" in (context.folder / "reproduction.html").read_text()


def test_sections_are_those_asked_for_in_the_order_of_the_page() -> None:
    assert [section.name for section in sections()] == [section.name for section in SECTIONS]
    assert [section.name for section in sections(["simulation"])] == ["simulation"]
    with pytest.raises(InputError, match=r"no section 'x'; use one of: .*simulation"):
        sections(["x"])


def test_a_folder_that_cannot_be_made_is_told(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot write into the folder"):
        make_folder(tmp_path / "file" / "inner")
    make_folder(tmp_path / "new" / "folder")
    assert list((tmp_path / "new" / "folder").iterdir()) == []


@pytest.mark.parametrize(
    ("cell", "text"), [(None, "–"), (0.123456, "0.123"), (99.8765, "99.88"), (3, "3"), ("a", "a")]
)
def test_cells_read_well(cell, text) -> None:
    assert cell_text(cell) == text
