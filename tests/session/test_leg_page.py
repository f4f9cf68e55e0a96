"""The leg's page: what it answers first, in four languages, and what it must not claim."""

import html
import json
import re
import shutil
import string
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from babel.messages.extract import extract_from_dir
from babel.messages.pofile import read_po

import surae
import surae.api
from ankle_legs.make import make, truth_of
from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.base.names import LANGUAGES
from surae.base.words import english
from surae.inference import Grade
from surae.inference.judging.reasons import Reason, against
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import quantities
from surae.quality import Finding, Quality
from surae.report import output
from surae.report.language import catalogue, words_in
from surae.report.leg import first_answer
from undrawn import blank_figures

pytestmark = pytest.mark.usefixtures("few")
TRANSLATED = LANGUAGES[1:]
#: Calls whose text `pybabel extract` takes for the catalogue, as `make messages` names them.
JS = {"parse_template_string": "true"}
MARKS = {"_": None, "N_": None, "self": None, "many": (1, 2)}


@pytest.fixture(scope="module")
def messages():
    """Every message that the source marks: singular, and plural where it has one."""
    methods = [("**.py", "python"), ("**.html.j2", "jinja2"), ("**.js", "javascript")]
    found = [
        each
        for package in ("surae", "surae.cohorts", "surae.nerve", "surae_thesis", "surae_workbench")
        for each in extract_from_dir(files(package), methods, {"**.js": JS}, keywords=MARKS)
    ]
    every = [(m,) if isinstance(m, str) else tuple(m) for *_, m, _, _ in found]
    assert len(every) > 100
    return {*every, *((code,) for code in english())}


def fields_of(text):
    return {(name, form) for _, name, form, _ in string.Formatter().parse(text) if name}


@pytest.mark.parametrize("language", TRANSLATED)
def test_every_message_is_translated_and_filled_in_alike(messages, language) -> None:
    with catalogue(language).open("rb") as file:
        catalog = read_po(file, language)
    known = {m.id if isinstance(m.id, tuple) else (m.id,): m for m in catalog if m.id}
    assert set(known) == messages  # none is missing, and none is left over
    for ids, message in known.items():
        source = english().get(ids[0], ids[0])
        texts = message.string if isinstance(message.string, tuple) else (message.string,)
        assert not message.fuzzy
        assert len(texts) == (1 if len(ids) == 1 else catalog.num_plurals)
        for text in texts:
            assert text
            assert fields_of(text) == fields_of(source)
            assert text.endswith(".") == source.endswith("."), text


def test_no_message_is_where_the_catalogue_does_not_find_it() -> None:
    """Within the braces of an f-string nothing is extracted."""
    for path in files("surae.report").rglob("*.py"):
        assert not re.search(r'\{_\(["\']', path.read_text(encoding="utf-8")), path


def test_an_unknown_language_is_refused(done, tmp_path) -> None:
    with pytest.raises(InputError, match="language 'it'"):
        done[1].report(tmp_path / "x.html", language="it")


def test_numbers_angles_and_measures_are_written_as_in_the_language() -> None:
    nl, en = words_in("nl"), words_in("en")
    assert nl.estimate(0.2104, (0.1812, 0.2411)) == ("0,210", "0,181 tot 0,241")
    assert en.estimate(0.2104, (0.1812, 0.2411)) == ("0.210", "0.181 to 0.241")
    assert nl.angle(-7.5) == "7,5° plantairflexie"
    assert en.measure("relaxed_share@5s") == "Part that relaxes within 5 s"
    assert nl.measure("passive_stiffness@10deg") == "Stijfheid in rust, 10° dorsaalflexie"
    assert nl.many("{n} held angle", "{n} held angles", 1) == "1 aangehouden hoek"
    assert words_in("fr").many("{n} held angle", "{n} held angles", 0) == "0 angle maintenu"


def test_every_reason_against_a_fit_has_plain_words() -> None:
    nl = words_in("nl")
    codes = [code.removeprefix("against/") for code in english() if code.startswith("against/")]
    assert len(codes) > 15
    for code in codes:
        plain = Reason(code).plain
        assert plain.code == f"plainly/{code}"
        assert nl(plain) != plain, code
    assert nl(Reason("a code of tomorrow").plain) == nl(Reason("said").plain)
    assert nl(against("still", moved=2.0).plain) == "de enkel beweegt nauwelijks in deze proeven"


@pytest.mark.usefixtures("words_alone")
@pytest.mark.parametrize("language", TRANSLATED)
def test_a_translated_page_has_no_english_and_no_code_name(done, tmp_path, language) -> None:
    _, result = done
    error = Finding("angle-sign", "error", "angle", 0.0, 1.0, 1.0, "-", "It is turned.", "Turn it.")
    wrong = replace(result, quality={name: Quality(name, (error,)) for name in result.fits})
    whole = replace(wrong, interrupted=True, session=replace(result.session, name="", side="left"))
    whole.report(tmp_path / "x.html", before=result, language=language)
    page = html.unescape((tmp_path / "x.html").read_text(encoding="utf-8"))
    text = re.sub(r"<[^>]+>", " ", page.split("</style>")[1])
    assert f'<html lang="{language}">' in page
    assert "{" not in text
    names = {*result.joint.parameters, *(n.partition("@")[0] for n in result.joint.measures())}
    assert not [
        n
        for n in (*names, "angle-sign")
        if re.search(rf"\b{re.escape(n)}\b", text) and n not in ("m", "delay")
    ]
    english = re.findall(r"\b(the|and|with|are|not|stiffness|torque|trial|known)\b", text)
    assert english == []
    assert not re.search(r"\d\.\d", re.sub(r"\d{4}-\d\d-\d\d \d\d:\d\d|surae \S+", "", text))


def test_a_figure_speaks_the_readers_language(done) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(output, "svg", lambda figure: "|".join(labels(figure)).encode())
        patched.setattr(output, "png", lambda *_: b"")
        patched.setattr(output, "data_url", lambda drawn, *_: drawn.decode())
        images = done[1].blocks("nl")["images"]
    assert "Moment [Nm]|" in images["stiffness"]
    assert "|ontspannen, 95 %|" in images["stiffness"]
    assert set(images) <= {"stiffness", "made"}


def labels(figure):
    figure.canvas.draw()
    for axes in figure.axes:
        yield axes.get_ylabel()
        yield from axes.get_legend_handles_labels()[1]
        yield from (tick.get_text() for tick in axes.get_yticklabels())


def card(page, name, after):
    return page[page.index(f'id="{name}"') : page.index(f'id="{after}"')]


QUESTIONS = ("How stiff is it?", "Tissue, muscle or tendon?", "Did it change?", "Can I trust it?")


def test_held_angles_answer_before_any_fit(leg):
    session = surae.session(leg)
    assert first_answer(session.trials, words_in("en")) == ""  # one hold shows no slope
    (hold,) = (trial for trial in session.trials if trial.hold is not None)
    moved = replace(hold.hold, angle=hold.hold.angle + 0.2, torque=hold.hold.torque + 2.0)
    both = [replace(each, effort="passive") for each in (hold, replace(hold, hold=moved))]
    assert "0.17 Nm/° from" in first_answer(both, words_in("en"))  # 2 Nm over 11.46°


def test_the_report_answers_four_questions_first(done):
    page = (done[0] / "report.html").read_text().split("</style>")[1]
    places = [page.index(text) for text in (*QUESTIONS, "Details", "Research", "by-trial")]
    assert places == sorted(places)
    assert "Nm/°</strong>" in page
    assert "One visit" in page
    assert page.count("<h1>") == 1


@pytest.mark.usefixtures("words_alone")
def test_an_earlier_visit_is_compared_in_measures_fixed_beforehand(done, tmp_path):
    _, result = done
    result.report(tmp_path / "x.html", before=result)
    page = (tmp_path / "x.html").read_text()
    shown = card(page, "change", "trust")
    assert shown.count('<th scope="row"') == 2
    if result.joint.adequacy.grade == "doubtful":
        assert "one visit’s fit is unreliable" in shown  # a doubtful fit never says Yes
    else:
        assert "Not shown" in shown
        assert "would have been shown" in shown


def test_a_notebook_shows_the_legs_page(done):
    with blank_figures():
        shown = done[1]._repr_html_()
    assert all(f">{text}</h2>" in shown for text in QUESTIONS)
    assert "<script" not in shown


@pytest.mark.usefixtures("words_alone")
def test_the_report_on_paper_says_what_the_page_says(done, tmp_path, run, monkeypatch):
    folder, result = done
    seen = {}

    def keep(template: bytes, place, content) -> bytes:
        assert template
        seen.update(json.loads(json.dumps(content)), files={f.name for f in place.iterdir()})
        return b"%PDF-"

    result.report(tmp_path / "whole.pdf")
    assert (tmp_path / "whole.pdf").read_bytes().startswith(b"%PDF-")
    monkeypatch.setattr(output, "typeset", keep)
    result.report(tmp_path / "session.pdf")
    page = html.unescape((folder / "report.html").read_text())
    first, numbers, details, research = seen["blocks"]
    assert numbers["title"] == "The numbers"
    assert [card["title"] for card in first["blocks"]] == list(QUESTIONS)
    assert first["blocks"][3]["blocks"][0]["grade"] == str(result.joint.adequacy.grade)
    sections = {b["title"]: b["blocks"] for part in (details, research) for b in part["blocks"]}
    assert sections["The fit"][0]["reasons"] == list(result.joint.adequacy.reasons)
    ((_, rows),) = sections["Trials"][0]["groups"]
    assert [row[0] for row in rows] == [t.name for t in result.session.trials]
    said = [trial.why for trial in result.session.trials if trial.why]
    said += [name for name in result.joint.parameters if result.joint.parameters[name].free]
    printed = repr(seen["blocks"])
    for text in said:
        assert text in page
        assert text in printed
    assert {"torques.svg", "trials.svg", "stiffness.svg"} <= seen["files"]
    assert page.count('<details class="explore">') == len(result.joined)
    refused = run("session", folder, "--output", tmp_path / "o", "--report", "r.docx")
    assert (refused.code, ".html or .pdf" in refused.err) == (2, True)


@pytest.mark.usefixtures("words_alone")
def test_the_commands_write_it_in_the_readers_language(done, leg, tmp_path, run) -> None:
    folder, _ = done
    shutil.copytree(folder, tmp_path / "out")  # its fits are kept
    made = run(
        "session",
        leg,
        "--output",
        tmp_path / "out",
        "--model",
        "muscle",
        "--prepared",
        "--starts",
        1,
        "--workers",
        1,
        "--before",
        folder,
        "--language",
        "de",
    )
    assert made.code == 0, made.err
    page = (tmp_path / "out" / "report.de.html").read_text(encoding="utf-8")
    assert "Wie steif ist es?" in page
    assert "Eine Untersuchung" not in page  # it is compared
    assert "How stiff is it?" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    made = run("change", folder, tmp_path / "out", "--report", "c.html", "--language", "nl")
    assert made.code == 0, made.err
    page = (tmp_path / "c.html").read_text(encoding="utf-8")
    assert "Is het veranderd?" in page
    assert "Stijfheid in rust, 10° dorsaalflexie" in page


@pytest.fixture(scope="module")
def sides(done):
    """Quantities of the leg's fit, as adequate and as doubtful, and the fit."""
    fit = done[1].joint
    one = quantities(fit, [10.0])
    good = replace(one.adequacy, grade=Grade.ADEQUATE, against=())
    doubt = replace(one.adequacy, grade=Grade.DOUBTFUL, against=(against("said", text="why"),))
    return replace(one, adequacy=good), replace(one, adequacy=doubt), fit


def change_page(path, change, fit):
    with blank_figures():
        surae.api.write_change_page(path, change, [fit, fit])
    return html.unescape(path.read_text(encoding="utf-8")).split("</style>")[1]


def test_two_legs_differ_and_do_not_change(sides, tmp_path) -> None:
    one, _, fit = sides
    page = change_page(tmp_path / "c.html", compare_sessions(one, one, legs=True), fit)
    assert "Do the legs differ?" in page
    assert "First leg" in page
    assert "Before" not in page


def test_no_change_and_doubtful_fits_are_never_a_yes(sides, tmp_path) -> None:
    one, doubt, fit = sides
    page = change_page(tmp_path / "c.html", compare_sessions(one, one), fit)
    assert "none shown" in page
    assert ">changed<" not in page
    assert "all are exploratory" in page
    by_model = {n: replace(q, basis="model") for n, q in one.by_name.items()}
    sides = [replace(each, by_name=FrozenDict(by_model)) for each in (one, doubt)]
    page = change_page(tmp_path / "c.html", compare_sessions(*sides), fit)
    assert "none shown" not in page
    assert "exploratory" not in page


def test_a_doubtful_fit_takes_no_verdict_off_what_rest_says(sides) -> None:
    one, doubt, _ = sides
    told = compare_sessions(one, doubt)
    by_rest = {name for name, q in one.by_name.items() if q.basis == "rest"}
    judged = {name for name, d in told.measures.items() if d.p is not None}
    assert "slow_stiffness@10deg" in judged
    assert judged <= by_rest
    assert not any(d.p is not None for d in told.parameters.values())


def foreign(folder, held):
    """A foreign leg's active trial, and its relaxed ankle held at eight angles in another trial."""
    out = folder / "leg"
    out.mkdir()
    (moves,) = make("p", 2, folder / "moves", (1,))
    (out / "active.csv").write_bytes(moves.read_bytes())
    (ladder,) = make("p", 2, folder / "ladder", (held,), seconds=60.0, kind="curve")
    comment, names, *rows = ladder.read_text(encoding="utf-8").splitlines()
    table = np.array([[float(v) for v in row.split(",")] for row in rows])
    still = np.abs(np.gradient(table[:, 1], table[:, 0])) < 1e-3
    ends = [*np.flatnonzero(still[:-1] & ~still[1:]).tolist(), len(rows) - 1]
    holds = [table[end - 383 : end + 1] for end in ends if still[end - 383 : end].all()]
    for number, hold in enumerate(holds):
        hold[:, 0] -= hold[0, 0]
        np.savetxt(
            out / f"hold {number}.csv", hold, "%.8g", ",", header=f"{comment}\n{names}", comments=""
        )
    return out


@pytest.mark.parametrize("treated", [pytest.param(False, marks=pytest.mark.slow), True])
def test_holds_that_contradict_the_model_take_its_stiffness_off_the_page(tmp_path, treated) -> None:
    """The treated leg's calf is softer: who mixes its holds with trials from before is told."""
    folder = foreign(tmp_path, 7 if treated else 1)
    with blank_figures():
        surae.session(folder).run(tmp_path / "out", model="muscle", starts=1)
    page = html.unescape((tmp_path / "out" / "report.html").read_text(encoding="utf-8"))
    stiff, trusted = card(page, "stiff", "made"), card(page, "trust", "details")
    told = "does not agree with the held angles" in stiff
    assert told is treated
    assert ("does not agree with the held angles" in trusted) is treated
    assert "8 held angles" in stiff
    value = float(re.search(r"<strong>([\d.]+) Nm/°</strong>", stiff)[1])
    truth = truth_of("p", 2, 1)["measures"]["end_stiffness"]  # which leads the page
    if treated:
        assert value != pytest.approx(truth, rel=0.1)
    else:  # by the few seconds between efforts
        low, high = map(float, re.search(r"95 %: ([\d.]+) to ([\d.]+)", stiff).groups())
        assert low <= truth <= high
