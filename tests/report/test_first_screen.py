"""The first screen of a fit: a picture, and a table in which every number has its ±."""

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from surae.base.formatting import with_half
from surae.base.units import on_page
from surae.inference import Verdict
from surae.report import block
from surae.report.figures.first import SHOWN, first_figure
from surae.report.first import asked, first_screen, grade_line
from surae.report.fit import fit_report
from surae.report.leg_cards import is_told
from surae.report.traces import traces_of


@pytest.fixture(scope="module")
def document(joint):
    return fit_report(joint, versions={}, created=datetime(2026, 1, 5, 14, 3)).document


def table_of(first):
    return next(each for each in first.section.blocks if isinstance(each, block.Grid))


def numbers_of(first):
    """Rows that have a number, by what is measured."""
    rows = [row for _, group in table_of(first).groups for row in group]
    return {row[0]: tuple(row[1:]) for row in rows if len(row) > 1}


def test_it_stands_before_everything_else(document):
    judged, first, *rest = document.blocks
    assert isinstance(judged, block.AdequacyWords)
    assert first.look == "first"
    torque, relaxed, table = first.blocks
    assert (torque.name, relaxed.name) == ("first", "relaxed")
    assert isinstance(table, block.Grid)
    assert [each.title for each in rest] == ["Summary", "Details", "Research"]


def test_what_was_asked_is_said_with_what_was_changed(joint):
    text = asked(joint.result)
    assert text.startswith(
        "Asked: parameters of one leg from 2 recordings together, 20 s, by model"
    )
    assert "Fixed beta = 1" in text


def test_every_number_has_its_uncertainty_and_its_verdict(plain):
    first = first_screen(plain, traces_of(plain.result))
    numbers = numbers_of(first)
    assert len(numbers) >= 3
    by_words = {m.name: m for m in first.measures}
    for _value, half, judged in numbers.values():
        assert any(sign in half for sign in "±+…")
        assert judged.badge is not None
    width = by_words["active_width_tri"]
    if width.ci95 is not None and width.verdict in ("identified", "weak"):
        value, half = with_half(width.value, width.ci95)
        assert numbers["Width of the calf’s active range"][:2] == (value, f"{half} °")


def test_what_is_not_told_is_named_and_has_no_number(silent):
    first = first_screen(silent, traces_of(silent.result))
    *_groups, (_title, (row,)) = table_of(first).groups
    assert row[0].why.startswith("Not known: ")
    assert not [name for name in numbers_of(first) if f"{name}," in row[0].why]


def test_a_failed_fit_has_its_picture_and_no_number(plain):
    failed = replace(plain.result, status="failed", message="no minimum reached: fit again")
    first = first_screen(type(plain)(failed, plain.assessment), traces_of(failed))
    assert list(first.figures) == ["first"]
    assert first.measures == ()


def test_recordings_stand_beside_each_other_and_none_is_joined_to_the_next(joint):
    traces = traces_of(joint.result)
    angle, torque, _parts = first_figure(traces).axes
    measured = torque.get_lines()[0]
    time, values = measured.get_data()
    assert np.isnan(values).sum() == 1
    assert (np.diff(time) > 0).all()
    gap = int(np.flatnonzero(np.isnan(values))[0])
    assert values[:gap] == pytest.approx(traces[0].measured)
    assert values[gap + 1 :] == pytest.approx(traces[1].measured)
    assert traces[0].name in [text.get_text() for text in angle.texts]
    assert max(angle.get_lines()[0].get_ydata()[:gap]) == pytest.approx(
        np.degrees(traces[0].angle.max())
    )
    many = [traces[0]] * (SHOWN + 3)
    (axes, *_others) = first_figure(many).axes
    assert len(axes.texts) == SHOWN


def test_the_reason_that_weighs_most_is_on_it(joint):
    words = joint.assessment.adequacy
    line = grade_line(joint)
    assert words.reasons[0].rstrip(".") in line.sentence
    assert line.reasons == ()


@pytest.mark.parametrize(
    ("value", "ci95", "texts"),
    [
        (0.2134, (0.18, 0.2468), ("0.213", "± 0.033")),
        (0.19, (0.061, 0.287), ("0.190", "−0.129 +0.097")),
        (-3.2, (-4.4, -2.0), ("−3.2", "± 1.2")),
        (120.0, (90.0, 150.0), ("120", "± 30")),
        (5.0, (5.0, 7.0), ("5", "5.00 … 7.0")),
    ],
)
def test_a_half_width_has_the_digits_of_its_value(value, ci95, texts):
    assert with_half(value, ci95) == texts


@pytest.mark.parametrize(
    ("unit", "of_one"),
    [("Nm/rad", 0.0174533), ("Nm/deg", 1.0), ("1/rad", 0.0174533), ("V", 1e3), ("Nm", 1.0)],
)
def test_pages_have_one_unit_for_one_thing(unit, of_one):
    shown, factor = on_page(unit)
    assert factor == pytest.approx(of_one, rel=1e-5)
    assert "rad" not in shown
    assert "deg" not in shown


@pytest.mark.parametrize(
    ("value", "ci95", "told"),
    [
        (5300.0, (4.0, 7100.0), False),
        (0.19, (0.061, 0.287), True),
        (-5.0, (-8.0, -2.0), True),
        (-5.0, (-9.0, -0.1), False),
    ],
)
def test_what_reaches_down_to_nothing_is_not_told_first(plain, value, ci95, told):
    m = first_screen(plain, traces_of(plain.result)).measures[0]
    judged = replace(m, value=value, ci95=ci95, unit="Nm/deg", verdict=Verdict.WEAK)
    assert is_told(judged) == told
