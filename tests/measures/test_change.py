"""What is called changed, and where it must not be."""

import json
import math
from dataclasses import replace
from itertools import combinations

import pytest

import surae
from surae.base.frozen import FrozenDict
from surae.inference import Grade
from surae.inference.judging.reasons import against
from surae.measures.change.compare import compare_sessions
from surae.measures.compared import common_end, quantities
from surae.measures.difference import ChangeVerdict
from surae.measures.reliability import SCATTER

pytestmark = pytest.mark.usefixtures("few")
CHANGED, NONE, NOT = ChangeVerdict


@pytest.fixture(scope="module")
def pair(fitted):
    """Two trials of one leg that did not change; a short one is soon fitted."""
    return fitted(1)[0], fitted(1, trial=1, duration=20.0)[0]


@pytest.fixture(scope="module")
def sides(pair):
    end = common_end(fit.result for fit in pair)
    return tuple(quantities(fit, [10.0], end) for fit in pair)


def moved(side, name: str, deviations: float):
    """The same leg but for one quantity, moved by so many standard deviations of a difference."""
    q = side.by_name[name]
    sd = SCATTER * math.sqrt(2.0 * (q.session**2 + q.model**2))
    shifted = replace(q, value=q.value + deviations * sd)
    return replace(side, by_name=FrozenDict({**side.by_name, name: shifted}))


def test_another_trial_of_a_leg_shows_no_change(pair) -> None:
    told = surae.change(*pair, angles=[10.0, 45.0])
    assert told.changed == ()
    assert any(d.verdict is NONE for d in told.measures.values())
    assert told.measures["passive_torque@45deg"].verdict is NOT  # it was not measured there


@pytest.mark.slow
def test_stiffness_is_compared_over_the_range_that_both_moved_through(pair) -> None:
    told = surae.change(*pair).measures["end_stiffness"]
    ends = [fit.measures()["end_stiffness"].to_deg for fit in pair]
    assert told.to_deg == min(ends)
    assert told.verdict is NONE
    row = surae.change(*pair).as_dict()["measures"]["end_stiffness"]
    assert row["to_deg"] - row["from_deg"] == pytest.approx(10.0)
    # that each session has a range of its own is no change of the leg
    own = (quantities(fit, [10.0]) for fit in pair)
    assert compare_sessions(*own).measures["end_stiffness"].verdict is NOT


def test_what_changes_by_far_more_than_its_noise_is_found(sides) -> None:
    before, _ = sides
    told = compare_sessions(before, moved(before, "k_tri", 6.0))
    assert [d.name for d in told.changed] == ["k_tri"]
    assert told.parameters["k_tri"].note.startswith("more than before")


def test_one_difference_of_many_beyond_its_interval_is_no_change(sides) -> None:
    before, _ = sides
    told = compare_sessions(before, moved(before, "k_tri", 2.2))
    k = told.parameters["k_tri"]
    assert not k.ci95[0] <= 0.0 <= k.ci95[1]
    assert k.verdict is NONE
    assert "exploratory" in told.multiplicity


def test_a_change_that_would_be_shown_is_beyond_the_interval(sides) -> None:
    told = compare_sessions(*sides)
    for d in (*told.measures.values(), *told.parameters.values()):
        if d.smallest is not None:
            assert d.smallest > 0.5 * (d.ci95[1] - d.ci95[0])


def test_electrodes_without_a_common_reference_are_not_compared(sides) -> None:
    told = compare_sessions(*sides)
    for name in ("g1", "g2", "g3", "g4"):
        assert told.parameters[name].verdict is NOT
        assert "electrodes" in told.parameters[name].note
    assert told.measures["torque_per_emg_tri"].verdict is NOT
    assert told.measures["passive_stiffness@10deg"].verdict is not NOT


def test_another_model_or_geometry_is_not_compared(sides) -> None:
    before, after = sides
    other = replace(after, model="muscle")
    told = compare_sessions(before, other)
    assert told.parameters["k_tri"].verdict is NOT
    assert told.measures["passive_torque@10deg"].verdict is not NOT  # Nm are Nm
    turned = replace(after, options=FrozenDict({**after.options, "geometry": "virtual-work"}))
    told = compare_sessions(before, turned)
    assert {d.verdict for d in (*told.measures.values(), *told.parameters.values())} == {NOT}


def test_what_models_leave_unsure_does_not_cancel(sides) -> None:
    before, after = sides
    q = before.by_name["passive_torque@10deg"]
    unsure = replace(q, model=10.0 * q.session)
    doubtful = replace(before, by_name=FrozenDict({**before.by_name, q.name: unsure}))
    sure, other = (compare_sessions(side, after).measures[q.name] for side in (before, doubtful))
    assert other.ci95[1] - other.ci95[0] > 3.0 * (sure.ci95[1] - sure.ci95[0])


@pytest.mark.slow
def test_timing_is_not_compared_where_a_muscle_had_no_electrode(pair, sides) -> None:
    fit, _ = pair
    problem = fit.result.problem
    deaf = tuple(replace(recording, missing_emg=("gl",)) for recording in problem.inputs)
    partly = replace(fit, result=replace(fit.result, problem=replace(problem, inputs=deaf)))
    told = compare_sessions(quantities(replace(fit, result=partly.result), [10.0]), sides[1])
    for d in (told.measures["bandwidth"], told.parameters["f0"], told.parameters["beta"]):
        assert d.verdict is NOT
        assert "electrode" in d.note
    assert told.measures["passive_stiffness@10deg"].verdict is not NOT
    assert compare_sessions(*sides).measures["bandwidth"].verdict is not NOT


def test_an_inadequate_fit_changes_nothing(pair, sides) -> None:
    fit, other = pair[0], sides[1]
    worse = replace(fit.adequacy, grade=Grade.INADEQUATE, against=(against("failed"),))
    judged = replace(fit, assessment=replace(fit.assessment, adequacy=worse))
    told = compare_sessions(quantities(judged, [10.0]), other)
    assert told.changed == ()
    assert {d.verdict for d in told.measures.values()} == {NOT}


def test_baselines_that_scatter_ask_more_of_a_change(sides) -> None:
    before, _ = sides
    after = moved(before, "k_tri", 6.0)
    scattered = [moved(before, "k_tri", by) for by in (-6.0, 6.0)]
    assert compare_sessions(before, after).parameters["k_tri"].verdict is CHANGED
    told = compare_sessions(before, after, scattered)
    assert told.parameters["k_tri"].verdict is NONE
    assert told.baselines == 3


def test_the_file(sides, tmp_path) -> None:
    told = compare_sessions(*sides)
    told.save(tmp_path / "c.json")
    data = json.loads((tmp_path / "c.json").read_text(encoding="utf-8"))
    row = data["measures"]["passive_stiffness@10deg"]
    assert row["verdict"] == "no change shown"
    assert row["ci95"][0] < row["difference"] < row["ci95"][1]


@pytest.mark.slow
def test_no_two_trials_of_a_measured_leg_changed(shared, tmp_path) -> None:
    """Six active trials of one leg, minutes apart: 15 pairs."""
    mapping = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    names = ("PL_50_01", "PL_50_02", "PL_0_01", "PL_100_01", "Ref_Long_01", "Ref_Long_02")
    fits = {}
    for name in names:
        (path,) = shared.glob(f"*/{name}.mat")
        described = mapping.replace("PL_50_01.mat", str(path))
        (tmp_path / f"{name}.toml").write_text(described, encoding="utf-8")
        fits[name] = surae.fit(tmp_path / f"{name}.toml", quality=())
    claimed = {
        pair: [d.name for d in surae.change(fits[pair[0]], fits[pair[1]]).changed]
        for pair in combinations(names, 2)
    }
    assert {pair: names for pair, names in claimed.items() if names} == {}


def test_answers_are_tables_in_a_notebook(sides, pair) -> None:
    """A few thousand characters, which ask nothing of the outside."""
    told, measures = compare_sessions(*sides), pair[0].measures()
    for answer, name in ((told, "k_tri"), (measures, "passive_stiffness@10deg")):
        assert repr(answer) == answer.as_table().text()
        assert name in repr(answer)
        assert len(repr(answer)) < 12_000
        html = answer._repr_html_()
        assert html.count("<tr>") == 1 + len(answer.as_table().rows)
        assert "http" not in html
