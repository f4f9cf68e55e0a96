"""The page for clinicians: what it says, and what it must not say."""

import json
import re
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

import surae
from surae.assessment import Grade, Verdict
from surae.errors import InputError
from surae.formatting import NO_NUMBER
from surae.measures.change import compare_sessions
from surae.measures.curve import CurveLine, TorqueCurve
from surae.measures.norms import Placed, read_norms
from surae.measures.quantity import quantities
from surae.names import LANGUAGES
from surae.protocol import Protocol, generate
from surae.report.clinical import change_page, fit_page, sentences
from surae.report.figures.clinical import curve_figure
from surae.studies import virtual_subject, virtual_trial

from . import parts

NOW = datetime(2026, 11, 22)


@pytest.fixture(scope="module")
def fit() -> surae.Fit:
    motion = generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=100.0)
    )
    trial = virtual_trial(virtual_subject(2), motion, noise=0.02)
    return surae.fit(replace(trial, name="Jane Roe"), "muscle", starts=2, quality=())


def page(fit, **how):
    return fit_page(fit.result, fit.assessment, created=NOW, **how)


def answer(page):
    return next(b.text for b in page.document.blocks if getattr(b, "look", "") == "answer")


def numbers(page):
    """The rows of the table."""
    section = parts.section(page.document, sentences()["figures"]["en"])
    ((_, rows),) = section.blocks[0].groups
    return rows


def strong(page):
    return [row for row in numbers(page) if row[-1].kind == "strong"]


def judged(fit, grade: Grade):
    worse = replace(fit.adequacy, grade=grade, reasons=("the ankle hardly moves",))
    return replace(fit, assessment=replace(fit.assessment, adequacy=worse))


def test_one_sentence_answers_and_holds_its_numbers(fit) -> None:
    told = fit.measures([10])
    text = answer(page(fit))
    numbers = [float(n) for n in re.findall(r"\d+\.\d+", text)]
    assert numbers[0] == pytest.approx(told["passive_torque@10deg"].value, rel=5e-3)
    assert numbers[3] == pytest.approx(told["passive_stiffness@10deg"].value, rel=5e-3)


@pytest.mark.usefixtures("undrawn")
def test_an_inadequate_fit_gives_no_answer_and_no_known_number(fit) -> None:
    told = page(judged(fit, Grade.INADEQUATE))
    assert answer(told) == "These recordings do not show how stiff this ankle is."
    assert not strong(told)
    assert not any(b.title == sentences()["norms"]["en"] for b in told.document.blocks[3:])
    assert "the ankle hardly moves" in told.page()


def test_a_band_without_an_end_leaves_its_curve_readable() -> None:
    angle = np.linspace(-0.3, 0.3, 20)
    torque = 10.0 * angle
    vast = CurveLine(torque=torque, low=torque - 1e7, high=torque + 1e7)
    near = CurveLine(torque=torque, low=torque - 1.0, high=torque + 1.0)
    names = {name: name for name in ("angle", "torque", "relaxed", "calf", "tibialis")}
    curve = TorqueCurve(angle=angle, passive=vast, active_tri=near, active_tib=near)
    rest, active = curve_figure([("leg", curve)], [], names).axes
    assert -20.0 < rest.get_ylim()[0] < -6.0
    assert active.get_ylim()[0] == pytest.approx(-4.0, abs=0.7)


def test_a_group_is_drawn_beside_the_same_measure_of_the_leg() -> None:
    # What groups resisted in a slow stretch is no point of the relaxed line.
    angle = np.linspace(-0.3, 0.3, 20)
    line = CurveLine(torque=angle, low=angle - 1.0, high=angle + 1.0)
    names = {n: n for n in ("angle", "torque", "relaxed", "slow", "calf", "tibialis")}
    curve = TorqueCurve(angle=angle, passive=line, active_tri=line, active_tib=line)
    slow = [n for n in read_norms() if n.measure == "slow_torque@10deg"]
    beside = [(Placed(norm=norm, value=7.5, below=0.5), norm.group) for norm in slow]
    rest = curve_figure([("leg", curve)], beside, names).axes[0]
    drawn = [text.get_text() for text in rest.get_legend().get_texts()]
    assert drawn == ["relaxed", "slow", *(norm.group for norm in slow)]
    own = [mark for mark in rest.lines if mark.get_label() == "slow"]
    assert [*own[0].get_xdata(), *own[0].get_ydata()] == [10.0, 7.5]


def test_what_is_not_identified_is_no_plain_answer(fit) -> None:
    assert "only roughly" in answer(page(fit, angle=45.0))  # beyond what was measured


def test_an_angle_has_its_direction_and_a_pull_is_no_resistance(fit) -> None:
    told = answer(page(fit, angle=-10.0))
    assert "10° of plantarflexion" in told
    assert "resist" not in told
    assert "10° of dorsiflexion" in answer(page(fit))


@pytest.mark.usefixtures("undrawn")
def test_what_is_not_all_known_asks_for_more_or_says_nothing(fit) -> None:
    strong = replace(fit, assessment=replace(
        fit.assessment, parameters={n: replace(p, verdict=Verdict.IDENTIFIED)
                                    for n, p in fit.parameters.items()}
    ))  # fmt: skip
    assert "well known" not in page(strong, angle=45.0).page()


@pytest.fixture(scope="module")
def one(fit):
    """What is compared of the fit."""
    return quantities(fit.result, fit.assessment, [10.0])


@pytest.mark.usefixtures("undrawn")
def test_two_legs_do_not_change(fit, one) -> None:
    side = (fit.result, fit.assessment)
    told = change_page(compare_sessions(one, one, legs=True), [side, side], created=NOW)
    assert told.document.title == "Do the ankles differ?"
    assert answer(told).startswith("No difference is shown.")
    assert "before" not in told.page().split("</style>")[1].casefold()


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_has_a_whole_page_without_names(fit, language) -> None:
    html = page(fit, language=language).page()
    assert f'lang="{language}"' in html
    assert "Jane" not in html
    assert "{" not in re.sub(r"<style>.*?</style>", "", html, flags=re.DOTALL)
    assert "http" not in re.sub(r"<meta[^>]*>", "", html)


def test_every_sentence_is_there_in_every_language() -> None:
    for key, texts in sentences().items():
        assert set(texts) == set(LANGUAGES), key
        fields = {frozenset(re.findall(r"{\w+}", text)) for text in texts.values()}
        assert len(fields) == 1, key


def test_an_unknown_language_is_refused(fit) -> None:
    with pytest.raises(InputError, match="language"):
        page(fit, language="it")


def test_no_change_is_never_a_yes(fit, one) -> None:
    side = (fit.result, fit.assessment)
    told = change_page(compare_sessions(one, one), [side, side], created=NOW)
    assert answer(told).startswith("No change is shown. One of ")
    assert not strong(told)


def test_doubtful_fits_have_no_headline(fit, one) -> None:
    side = (fit.result, fit.assessment)
    doubt = replace(one, adequacy=replace(one.adequacy, grade=Grade.DOUBTFUL, reasons=("why",)))
    told = change_page(compare_sessions(one, doubt), [side, side], created=NOW)
    assert answer(told).startswith("No answer yet")
    shown = [row for row in numbers(told) if row[3] != NO_NUMBER]
    assert {row[-1].text for row in shown} == {NO_NUMBER}


@pytest.mark.usefixtures("undrawn")
def test_the_commands_write_it(fit, tmp_path, monkeypatch) -> None:
    from click.testing import CliRunner

    from surae.cli import group

    monkeypatch.setenv("COLUMNS", "60")  # narrower than the names and numbers
    fit.save(tmp_path / "fit.json")
    (tmp_path / "after.json").write_bytes((tmp_path / "fit.json").read_bytes())
    files = [str(tmp_path / name) for name in ("fit.json", "after.json", "p.html", "o.json")]
    runner = CliRunner()
    made = runner.invoke(
        group, ["measures", files[0], "--angle", "10", "--report", files[2], "--output", files[3],
                "--language", "nl"]
    )  # fmt: skip
    assert made.exit_code == 0, made.output
    assert "passive_stiffness@10deg" in made.output  # whole, whatever the width
    told = json.loads((tmp_path / "o.json").read_text(encoding="utf-8"))["measures"]
    assert (
        told["passive_torque@10deg"]["verdict"]
        in re.search(r"passive_torque@10deg .*", made.output)[0]
    )
    assert "Stijfheid" in (tmp_path / "p.html").read_text(encoding="utf-8")
    made = runner.invoke(group, ["change", *files[:2], "--report", files[2], "--output", files[3]])
    assert made.exit_code == 0, made.output
    assert "no change shown" in made.output
    assert "Holm" in made.output
    made = runner.invoke(group, ["measures", files[0], "--report", str(tmp_path / "p.pdf")])
    assert made.exit_code == 0, made.output
    assert (tmp_path / "p.pdf").read_bytes().startswith(b"%PDF-")
    refused = runner.invoke(group, ["measures", files[0], "--report", str(tmp_path / "p.txt")])
    assert isinstance(refused.exception, InputError)
