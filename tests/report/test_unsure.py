"""What a fit says of its own doubts: budget, remedies, laboratory, models, trials; and when not."""

from dataclasses import replace
from datetime import datetime
from importlib.resources import files

import pytest

from surae.inference import (
    AssessedFit,
    LeastSquares,
    Verdict,
    assess,
    fit_problem,
    make_problem,
    solve,
)
from surae.inference.judging.grade import Adequacy, Grade
from surae.inference.judging.reasons import against
from surae.inference.result import OfRecording
from surae.inference.uncertainty.combined import Uncertainty
from surae.model.source_table import SOURCES
from surae.report import block
from surae.report.budget import budget_of, budget_section, what_to_measure, what_would_help
from surae.report.fit import fit_report
from surae.report.laboratory import family_section, family_text, laboratory_section, trials_section
from surae.report.parameters import parameters_section, repeatable, shown_parameters

from . import parts


@pytest.fixture(scope="module")
def auto(make_trial):
    """A fit of the family, and what it is worth."""
    result = solve(make_problem([make_trial()], "auto"))
    return result, assess(result)


def with_parameters(assessment, **changed):
    """An assessment whose parameters are others in some respect."""
    table = {n: replace(p, **changed.get(n, {})) for n, p in assessment.parameters.items()}
    return replace(assessment, parameters=table)


def graded(assessment, grade):
    return replace(assessment, adequacy=Adequacy(grade, (against("said", text="a reason"),), 50.0))


def test_shares_add_up_and_are_those_of_the_assessment(auto):
    result, assessment = auto
    budget = budget_of(AssessedFit(result, assessment))
    assert list(budget.rows) == [p.name for p in assessment.parameters.values() if p.budget]
    for _, shares in budget.rows.values():
        assert sum(shares) == pytest.approx(1.0, abs=0.06)
        assert len(shares) == len(budget.sources)
    assert "noise" in budget.sources


def unsure(auto, source):
    """The fit with one parameter weak, nearly all of it by one source, and what it then helps."""
    result, assessment = auto
    name = next(n for n, p in assessment.parameters.items() if p.budget)
    known = assessment.uncertainty
    made = known.budget(known.along(name))
    value = assessment.parameters[name].value
    doubt = {"verdict": Verdict.WEAK, "ci95": (0.88 * value, 1.12 * value)}
    budget = replace(made, shares={source: 0.9, "noise": 0.1}, without={source: 0.25 * made.sd})
    return result, with_parameters(assessment, **{name: doubt}), budget, name


def budgeted(monkeypatch, name, budget):
    """Have a parameter this budget, and all others none that helps."""
    none = replace(budget, shares={}, without={})
    monkeypatch.setattr(
        Uncertainty,
        "budget",
        lambda known, along: budget if along[known.names.index(name)] else none,
    )


def test_the_sentence_follows_from_the_budget(auto, monkeypatch):
    result, assessment, budget, name = unsure(auto, "zero")
    budgeted(monkeypatch, name, budget)
    monkeypatch.setattr("surae.report.budget.covariance_if_filmed", lambda *_: None)
    assert what_would_help(AssessedFit(result, assessment)) == (
        f"Measure the zero of the torque sensor, and {name} would be known to ±3 % instead of "
        "±12 %.",
    )


@pytest.mark.parametrize("why", ["inadequate", "identified", "small share", "little gain", "named"])
def test_the_sentence_is_not_said(auto, monkeypatch, why):
    result, assessment, budget, name = unsure(auto, "zero")
    if why == "inadequate":
        assessment = graded(assessment, Grade.INADEQUATE)
    elif why == "identified":
        assessment = with_parameters(assessment, **{name: {"verdict": Verdict.IDENTIFIED}})
    elif why == "small share":
        budget = replace(budget, shares={"zero": 0.2, "noise": 0.8})
    elif why == "little gain":
        budget = replace(budget, without={"zero": 0.9 * budget.sd})
    else:
        own = (getattr(result.solution, n) for n in ("starts", "agreeing", "stages", "outcome"))
        result = replace(result, solution=LeastSquares(*own))
    budgeted(monkeypatch, name, budget)
    monkeypatch.setattr("surae.report.budget.covariance_if_filmed", lambda *_: None)
    assert what_would_help(AssessedFit(result, assessment)) == ()


@pytest.mark.parametrize("why", ["", "inadequate", "identified", "little gain", "filmed"])
def test_filming_is_advised_with_what_it_would_narrow(auto, monkeypatch, why):
    result, assessment, budget, name = unsure(auto, "zero")
    at = result.problem.free.index(name)
    narrowed = assessment.uncertainty.covariance(*result.problem.free)
    narrowed[at, at] *= 0.9**2 if why == "little gain" else 0.25**2
    if why == "inadequate":
        assessment = graded(assessment, Grade.INADEQUATE)
    elif why == "identified":
        assessment = with_parameters(assessment, **{name: {"verdict": Verdict.IDENTIFIED}})
    answers = {"tib": None if why == "filmed" else narrowed}
    budgeted(monkeypatch, name, replace(budget, without={}))
    monkeypatch.setattr("surae.report.budget.covariance_if_filmed", lambda *of: answers.get(of[-1]))
    said = f"Film the tibialis, and {name} would be known to ±3 % instead of ±12 %."
    assert what_would_help(AssessedFit(result, assessment)) == (() if why else (said,))


def test_a_named_model_says_that_noise_is_all_it_knows(plain):
    budget = budget_of(plain)
    assert "the noise of the torque and nothing else" in parts.text(budget_section(budget))
    assert (budget.rows, budget.helps) == ({}, what_to_measure(plain.assessment))
    for section in (laboratory_section, family_section, trials_section):
        assert section(plain) == ()
    assert "imperfections" not in plain.words


def test_every_weak_verdict_links_to_what_to_measure_next(plain):
    table = plain.assessment.parameters
    name = next(n for n, p in table.items() if p.free)
    for verdict, links in ((Verdict.WEAK, True), (Verdict.IDENTIFIED, False)):
        all_alike = {n: {"verdict": verdict} for n, p in table.items() if p.free}
        told = what_to_measure(with_parameters(plain.assessment, **all_alike))
        assert bool(told) is links
        assert all(name in text and "surae design --after" in text for text in told)
    doubted = graded(plain.assessment, Grade.INADEQUATE)
    assert what_to_measure(doubted) == ()
    weak = sum(p.verdict in (Verdict.WEAK, Verdict.UNDETERMINED) for p in table.values() if p.free)
    assert plain.words.count('href="#next"') == weak
    assert plain.words.count('id="next"') == min(weak, 1)


def test_the_laboratory_says_what_was_assumed_and_who_says_so(auto):
    result, assessment = auto
    (section,) = laboratory_section(AssessedFit(result, assessment))
    rows = parts.rows(section)
    assert set(rows) == set(result.solution.beliefs)
    zero, belief = rows["torque_zero"], result.solution.beliefs["torque_zero"]
    assert (zero["Assumed"].text, zero["Unit"].text) == ("0 ± 10", "Nm")
    known = assessment.nuisances["torque_zero"].sem / belief.sd
    assert (zero["Source"].text == "from the data") == (known <= 0.5)
    vague = replace(assessment.nuisances["torque_zero"], sem=9.9, value=25.0)
    other = replace(assessment, nuisances={**assessment.nuisances, "torque_zero": vague})
    origin = parts.rows(laboratory_section(AssessedFit(result, other))[0])["torque_zero"][
        "Source"
    ].text
    assert (
        origin == "as assumed: the data add little; 2.5 standard deviations from what was assumed"
    )
    assert "zero of each recording" not in parts.text(section)


def test_the_evidence_is_said_as_strongly_as_it_is(auto):
    result, assessment = auto
    first = result.solution.candidates[0]

    def said(weight, grade=Grade.ADEQUATE, groups=("arm", "shape")):
        one = replace(first, weight=weight, groups=groups)
        family = replace(result.solution, candidates=(one,))
        found = replace(result, solution=family)
        return family_text(AssessedFit(found, graded(assessment, grade)))

    assert said(0.9).startswith(
        "These data fit better with moment arms, EMG curve (probability 90 %)."
    )
    assert said(0.6, groups=()).startswith(
        "These data fit better with the plain model (probability 60 %)."
    )
    assert said(0.02).startswith(
        "Several models fit these data about as well, the likeliest with moment arms, EMG curve "
        "(probability 2 %)."
    )
    assert "moment arms" not in said(0.9, Grade.INADEQUATE)


def test_trials_are_told_of_only_where_they_differ(auto):
    result, assessment = auto
    assert trials_section(AssessedFit(result, assessment)) == ()  # a single recording
    names = [n for n, p in assessment.parameters.items() if p.free]
    value = assessment.parameters[names[0]].value
    recordings = tuple(
        OfRecording(
            {n: at * assessment.parameters[n].value for n in names},
            dict.fromkeys(names, 1e-3 * value),
        )
        for at in (0.9, 1.0, 1.1)
    )
    family = replace(result.solution, recordings=recordings)
    inputs = tuple(replace(result.problem.inputs[0], name=each) for each in "abc")
    joint = replace(result, solution=family, problem=replace(result.problem, inputs=inputs))
    rows = parts.rows(trials_section(AssessedFit(joint, assessment))[0])
    assert list(rows) == names
    first = rows[names[0]]
    assert all("±" in first[each].text for each in "abc")
    assert float(first["Spread"].text.split()[0]) == pytest.approx(10.0, abs=5.0)


def test_repeatable_stands_beside_identified_and_is_not_it(auto):
    result, assessment = auto
    name = next(n for n, p in assessment.parameters.items() if p.ci95_repeat)
    p = replace(assessment.parameters[name], verdict=Verdict.WEAK, repeatable=True)
    other = with_parameters(assessment, **{name: {"verdict": Verdict.WEAK, "repeatable": True}})
    row = parts.rows(parameters_section(AssessedFit(result, other), next_anchor=""))[name]
    assert (row["Verdict"].badge[1], row["Repeatable"].text) == ("weak", "yes")
    assert repeatable(replace(p, repeatable=False)) == "no"
    assert repeatable(replace(p, ci95_repeat=None)) == "—"


def test_what_had_nothing_to_act_on_is_not_shown(auto):
    _, assessment = auto
    shown = {p.name for p in shown_parameters(assessment)}
    assert not {n for n in shown if n.startswith("xt_")}
    assert {"k_tri", "l0_tib"} <= shown


@pytest.mark.usefixtures("undrawn")
def test_the_page_has_all_of_it(auto):
    result, assessment = auto
    page = fit_report(
        AssessedFit(result, assessment), versions={}, created=datetime(2026, 1, 5, 14, 3)
    ).page()
    for heading in (
        "What makes each parameter unsure",
        "The laboratory’s imperfections",
        "Which model the data support",
    ):
        assert page.count(f">{heading}</h3>") == 1
    assert "SEM (34)</th>" not in page.split("Correlation of the estimates")[0].split("unsure")[0]
    assert "Stacked bars of the shares" in page


def test_a_fit_without_imperfections_says_that_it_was_asked_for(make_trial):
    result = solve(make_problem([make_trial()], "auto", nuisances="none"))
    assert "data support" not in result.message  # that is for the judged fit to say
    (section,) = laboratory_section(AssessedFit(result, assess(result)))
    assert "assume a perfect laboratory" in parts.text(section)
    assert not any(isinstance(each, block.Grid) for each in section.blocks)


@pytest.mark.usefixtures("undrawn")
def test_one_start_of_a_named_model_is_still_warned_of(make_trial):
    result = fit_problem(make_problem([make_trial()]), starts=1)
    fit = AssessedFit(result, assess(result))
    page = fit_report(fit, versions={}, created=datetime(2026, 1, 5, 14, 3)).page()
    assert "only one: whether its minimum" in page


def test_every_source_has_its_words_advice_and_look():
    """One record has all that is shown of a source, on paper and on screen."""
    from matplotlib.colors import is_color_like

    from surae.report.figures.research import _COLOURS

    tokens = (files("surae_workbench.web") / "static" / "css" / "tokens.css").read_text(
        encoding="utf-8"
    )
    assert len({source.look for source in SOURCES.values()}) == len(SOURCES)
    for source in SOURCES.values():
        assert source.label
        assert source.meaning
        assert is_color_like(_COLOURS[source.look.colour])
        assert f"--{source.look.colour}: #" in tokens
        assert source.advice
        assert not source.advice.endswith(".")


def test_what_a_fit_can_find_has_a_record(auto):
    """Shifts that a fit adds to its intervals are sources, as are the nuisances it estimates."""
    result, _ = auto
    assert set(result.solution.spread) <= set(SOURCES)
    assert {"noise", "population", "left_out", "emg_gain"} <= set(result.solution.spread)
    named = {name for source in SOURCES.values() for name in source.parameters}
    assert set(result.solution.beliefs) <= named
