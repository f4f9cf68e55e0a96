"""What a leg's cards say of intervals alone, and what they say where nothing was measured."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import FrozenDict
from surae.inference import Grade, Verdict
from surae.measures.norms import Norm
from surae.nerve.leg import Nerve
from surae.report import block
from surae.report.invariants import invariants_section
from surae.report.language import MEASURES, words_in
from surae.report.leg import leg_answers
from surae.report.leg_cards import change_card, is_told, share_words
from surae.report.nerve_card import nerve_card
from surae.report.normal import beside
from surae.report.session import _in_words, _other_measures

EN = words_in("en")


def parts(tissue, muscle):
    """Shares with these intervals, their values in the middle."""
    return [(name, float(np.mean(ci)), ci) for name, ci in (("tissue", tissue), ("muscle", muscle))]


@pytest.mark.parametrize(
    ("tissue", "muscle", "said"),
    [
        ((51.0, 60.0), (20.0, 40.0), "Mostly tissue"),
        ((45.0, 60.0), (20.0, 40.0), "More tissue than muscle"),
        ((35.0, 60.0), (20.0, 40.0), "Both tissue and muscle"),
        ((5.0, 19.0), (20.0, 40.0), "More muscle than tissue"),
        ((5.0, 45.0), (52.0, 70.0), "Mostly active muscle"),
        ((-5.0, 45.0), (20.0, 60.0), "Not clear which resists more"),
    ],
)
def test_a_headline_says_what_both_intervals_say(tissue, muscle, said) -> None:
    assert share_words(parts(tissue, muscle), EN) == said


@pytest.mark.parametrize("tissue", [(51.0, 60.0), (45.0, 60.0), (35.0, 60.0)])
def test_of_a_calf_that_was_not_heard_nothing_is_said_of_tissue(tissue) -> None:
    said = share_words(parts(tissue, (20.0, 40.0)), EN, unheard=True)
    assert said == "Muscle: at least 20 %"


def test_where_trials_dispute_the_stiffness_neither_is_more() -> None:
    assert share_words(parts((5.0, 19.0), (20.0, 40.0)), EN, disputed=True) == (
        "Both tissue and muscle"
    )
    said = share_words(parts((5.0, 19.0), (20.0, 40.0)), EN, unheard=True, disputed=True)
    assert said == "Muscle: at least 20 %"


@pytest.mark.parametrize("language", ["en", "nl", "de", "fr"])
def test_a_leg_of_which_nothing_is_known_says_how_to_measure_it(language) -> None:
    _ = words_in(language)
    answers = leg_answers((), {}, None, _)
    cards = {card.anchor: card.blocks for card in answers.cards}
    assert list(cards) == ["stiff", "made", "change", "trust", "nerve"]
    for anchor, seconds in (("stiff", "30 s"), ("made", "35 s"), ("nerve", "2 min")):
        action = [b.text for b in cards[anchor] if isinstance(b, block.Text) and not b.look]
        assert len(action) == 1, anchor
        assert seconds in action[0]
    (judged,) = [b for b in cards["trust"] if isinstance(b, block.AdequacyWords)]
    assert judged.grade == "inadequate"


def test_nerve_that_was_measured_is_not_called_unmeasured() -> None:
    blocks, _figures = nerve_card(Nerve(), EN)
    assert blocks[0].lead != "Not measured"


def test_one_visit_says_which_change_would_show(done) -> None:
    m = done[1].joint.measures()["end_stiffness"]
    told = replace(m, sdc=0.123, unit="Nm/deg", ci95=(0.1, 0.3), verdict=Verdict.WEAK)
    said = change_card(None, EN, told)[0]
    assert (said.look, said.lead) == ("say", "One visit")
    assert said.text.endswith("a change of 0.12 Nm/° or more would show")
    unknown = change_card(None, EN, replace(told, verdict=Verdict.UNDETERMINED))
    assert not [b for b in unknown if "would show" in b.text]
    silent = change_card(None, EN, replace(m, sdc=None))
    assert not [b for b in silent if "would show" in b.text]


def test_normal_stands_beside_the_number_or_says_what_would_tell_it(done) -> None:
    of_fit = done[1].joint.measures()
    number = block.Text("", "say", "0.2 Nm/°")
    name, m = next((n, m) for n, m in of_fit.items() if m.verdict in ("identified", "weak"))
    norm = Norm(name, m.unit, "slow", "healthy adults", 32, m.value, abs(m.value), "A (2020)")
    good = replace(of_fit.adequacy, grade=Grade.ADEQUATE)
    of_fit = replace(of_fit, adequacy=good)
    pair, source = beside(number, of_fit, [norm], EN, name)
    assert pair.blocks[0] is number
    assert pair.blocks[1].lead.startswith("Normal? Above 50 %")
    assert pair.blocks[1].text.startswith("of 32 healthy adults")
    assert source.text == "A (2020)"
    other = replace(norm, measure="slow_torque@55deg")
    ((_number, asked),) = [each.blocks for each in beside(number, of_fit, [other], EN)]
    assert asked.lead == "Normal? Not known"
    assert "55° dorsiflexion" in asked.text


def test_a_doubted_model_places_no_leg_beside_others(done) -> None:
    of_fit = done[1].joint.measures()
    name, m = next((n, m) for n, m in of_fit.items() if m.verdict in ("identified", "weak"))
    norm = Norm(name, m.unit, "slow", "healthy adults", 32, m.value, abs(m.value), "A (2020)")
    doubt = replace(of_fit.adequacy, grade=Grade.DOUBTFUL)
    number = block.Text("", "say", "0.2 Nm/°")
    for basis, leads in (("model", "Normal? Not known"), ("rest", "Normal? Above 50 %")):
        by_name = FrozenDict({name: replace(m, basis=basis)})
        told = replace(of_fit, adequacy=doubt, by_name=by_name)
        assert beside(number, told, [norm], EN, name)[0].blocks[1].lead == leads


def test_each_question_has_one_line_of_answer(done) -> None:
    answers = done[1].answers()
    assert len(answers) == 5
    assert all(answers.values())
    assert answers["How much is nerve?"] == "Not measured"
    assert isinstance(done[1], surae.SessionResult)


def numbers_of(section):
    """What a section of numbers shows: its rows, and the texts beside them."""
    rows = [
        row for b in section.blocks if b.kind == "table" for _title, rs in b.groups for row in rs
    ]
    return rows, [b.text for b in section.blocks if b.kind == "paragraph"]


def test_of_a_fit_that_follows_no_torque_only_rest_is_a_number(done) -> None:
    of_fit = done[1].joint.measures()
    modelled = FrozenDict({n: replace(m, basis="model") for n, m in of_fit.items()})
    poor = replace(of_fit, adequacy=replace(of_fit.adequacy, grade=Grade.INADEQUATE))
    poor = replace(poor, by_name=modelled)
    rows, texts = numbers_of(_in_words(poor, 10.0, "", EN))
    assert rows == []
    assert texts == ["The fit is not good enough: first do what “Can I trust it?” says."]
    name, m = next((n, m) for n, m in of_fit.items() if n in MEASURES and is_told(m))
    rest = replace(poor, by_name=FrozenDict({name: replace(m, basis="rest")}))
    assert len(numbers_of(_in_words(rest, 10.0, "", EN))[0]) == 1


def test_numbers_of_one_trial_alone_say_so(done) -> None:
    of_fit = done[1].joint.measures()
    good = replace(of_fit, adequacy=replace(of_fit.adequacy, grade=Grade.DOUBTFUL))
    rows, texts = numbers_of(_in_words(good, 10.0, "walk", EN))
    assert rows
    assert texts[0] == "in walk alone"


def test_a_number_from_next_to_nothing_up_is_not_shown(done) -> None:
    of_fit = done[1].joint.measures()
    m = next(m for n, m in of_fit.items() if n in MEASURES and is_told(m))
    wide = replace(m, name="maximal_torque_tri", value=5300.0, ci95=(4.0, 7100.0), unit="Nm")
    wide = replace(wide, verdict=Verdict.WEAK)
    told = replace(of_fit, by_name=FrozenDict({wide.name: wide}))
    told = replace(told, adequacy=replace(of_fit.adequacy, grade=Grade.DOUBTFUL))
    assert numbers_of(_in_words(told, 10.0, "", EN))[0] == []
    assert numbers_of(_other_measures(told))[0] == []
    (row,) = numbers_of(invariants_section([wide]))[0]
    assert getattr(row[1], "text", row[1]) == "—"
