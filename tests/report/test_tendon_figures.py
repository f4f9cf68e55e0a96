from dataclasses import replace

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.inference import fit_problem, make_problem
from surae.report.figures import png
from surae.report.figures.tendon import tendon_figure
from surae.report.recordings import warnings_of
from surae.report.traces import traces_of

from . import parts
from .test_content import content_of


@pytest.fixture(scope="module")
def elastic(make_trial, make_fitted):
    """A fit of model 2.1 to the trial of a rigid tendon."""
    return make_fitted(fit_problem(make_problem([make_trial()], "muscle-tendon-strain"), starts=1))


@pytest.fixture(scope="module")
def traces(elastic):
    return traces_of(elastic.result)[0]


def lines_of(axes):
    return {line.get_label(): line for line in axes.get_lines()}


def test_every_panel_has_its_units_for_both_groups(traces):
    axes = tendon_figure(traces, traces.tendon).axes
    assert len(axes) == 10
    labels = [axis.get_ylabel().replace("\n", " ") for axis in axes]
    for expected in (
        "Muscle length [l0]",
        "Muscle velocity [l0/s]",
        "Tendon elongation [mm]",
    ):
        assert labels.count(expected) == 2
    assert labels.count("Tendon force [N]") == 4
    titles = [axis.get_title(loc="left") for axis in axes]
    assert [title for title in titles if title] == ["Triceps surae", "Tibialis anterior"]
    bottom = [axis.get_xlabel() for axis in axes if axis.get_xlabel()]
    assert sorted(bottom) == ["Tendon elongation [mm]"] * 2 + ["Time [s]"] * 2


def test_the_curves_are_the_fitted_ones_with_the_range_used(traces, elastic):
    state = traces.tendon
    curves = [a for a in tendon_figure(traces, state).axes if "used here" in lines_of(a)]
    assert len(curves) == 2
    for group, axes in enumerate(curves):
        lines, law = lines_of(axes), state.laws[group]
        x, y = lines["fitted curve"].get_data()
        assert y == pytest.approx(law.force(np.asarray(x) / 1e3))
        used = 1e-3 * lines["used here"].get_xdata()
        assert (used[0], used[-1]) == pytest.approx(
            (state.elongation[group].min(), state.elongation[group].max())
        )
        eps0 = elastic.result.values[("dlt_tri", "dlt_tib")[group]]
        ((toe, force),) = np.transpose(lines["end of toe"].get_data())
        assert force == pytest.approx(0.3 * (8000.0, 1400.0)[group])
        assert 1e-3 * toe == pytest.approx(law.toe_elongation)
        assert toe < 1e3 * eps0


def test_the_toe_is_marked_or_said_to_be_above(traces):
    """Line where it is near the forces; words where a line would flatten them."""

    def forces(scale):
        state = replace(traces.tendon, tendon_force=scale * traces.tendon.tendon_force)
        axes = [a for a in tendon_figure(traces, state).axes if "passive tissue" in lines_of(a)]
        return state, axes

    highest = traces.tendon.tendon_force.max(axis=1)
    toe = np.array([law.toe_force for law in traces.tendon.laws])
    _, near = forces(float((0.9 * toe / highest).max()))
    assert any("end of toe" in lines_of(axes) for axes in near)
    _, far = forces(float((0.1 * toe / highest).min()))
    for axes, force in zip(far, toe, strict=True):
        assert "end of toe" not in lines_of(axes)
        assert [t.get_text() for t in axes.texts] == [f"toe ends at {force:.0f} N, above"]


def test_lines_differ_without_colour(traces):
    for axes in tendon_figure(traces, traces.tendon).axes:
        shown = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
        looks = {(o.get_linestyle(), o.get_linewidth(), o.get_marker()) for o in shown}
        assert len(looks) == len(shown)


def test_the_page_shows_them_with_words_for_the_figure(elastic):
    assert elastic.words.count("<h4>Muscles and tendons</h4>") == 1
    assert warnings_of(traces_of(elastic.result)[0]) == ()


def test_rigid_tendons_have_no_section(plain):
    assert "Muscles and tendons" not in plain.words
    assert traces_of(plain.result)[0].tendon is None


@pytest.mark.slow
def test_samples_without_a_solution_are_named_and_drawn_up_to_there(elastic):
    result = elastic.result
    (inputs,) = result.problem.inputs
    angle = inputs.angle.copy()
    angle[400] = np.nan
    problem = replace(result.problem, inputs=(replace(inputs, angle=read_only(angle)),))
    residual = result.residuals[0].copy()
    residual[400:] = np.nan
    broken = replace(result, problem=problem, residuals=(residual,), status="failed")
    traces = traces_of(broken)[0]
    first, other = warnings_of(traces)
    assert first.startswith("Triceps surae: the balance of forces could not be")
    assert "at sample 401 (4 s)" in first
    assert other in parts.text(parts.section(content_of(elastic, broken), "Recording:"))
    assert png(tendon_figure(traces, traces.tendon), dpi=40)
    nothing = np.full((2, 1000), np.nan)
    state = replace(traces.tendon, tendon_force=nothing, elongation=nothing, muscle_length=nothing)
    assert png(tendon_figure(traces, state), dpi=40)
