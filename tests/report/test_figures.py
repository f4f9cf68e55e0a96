from dataclasses import replace

import numpy as np
import pytest

from surae.assessment import whiteness
from surae.report.figures import correlation_figure, png, residual_figure, svg, torque_figure
from surae.report.traces import traces_of


@pytest.fixture(scope="module")
def traces(plain):
    return traces_of(plain.result)[0]


def test_traces_are_those_of_the_fit(plain, traces):
    assert traces.modelled == pytest.approx(traces.parts.total, abs=1e-9)
    assert traces.residual == pytest.approx(plain.result.residuals[0], abs=1e-9)


def test_four_panels_with_units_on_one_time_axis(traces):
    parts, *strips, angle, torque = torque_figure(traces).axes
    labels = [axes.get_ylabel() for axes in strips]
    assert labels == ["", "EMG [µV]", "", ""]
    assert [t.get_text() for axes in strips for t in axes.texts] == ["TA", "GL", "SOL", "GM"]
    assert angle.get_ylabel() == "Angle [rad]"
    assert [one.get_ylabel() for one in angle.child_axes] == ["Angle [°]"]
    assert torque.get_ylabel() == parts.get_ylabel() == "Torque [Nm]"
    assert parts.get_xlabel() == "Time [s]"
    assert _legend(torque) == ["measured", "modelled"]
    assert _legend(parts) == ["tissue", "neural", "inertial", "gravitational"]
    for axes in (*strips, angle, torque):
        assert axes.get_shared_x_axes().joined(axes, parts)


def test_lines_differ_without_colour(traces):
    with_legends = [axes for axes in torque_figure(traces).axes if axes.get_legend()]
    assert len(with_legends) == 2
    for axes in with_legends:
        looks = {(line.get_linestyle(), line.get_linewidth()) for line in axes.get_lines()}
        assert len(looks) == len(axes.get_lines())


def test_a_muscle_without_emg_is_marked(traces):
    figure = torque_figure(replace(traces, missing_emg=("sol",), emg_unit="1"))
    texts = [t.get_text() for axes in figure.axes for t in axes.texts]
    assert texts == ["TA", "GL", "SOL (not recorded)", "GM"]
    assert "EMG [-]" in [axes.get_ylabel() for axes in figure.axes]


def test_the_residual_has_its_band_and_units(traces):
    white = whiteness(traces.residual, 100.0)
    over_time, correlation, histogram = residual_figure(traces.time, traces.residual, white).axes
    assert (over_time.get_xlabel(), over_time.get_ylabel()) == ("Time [s]", "Residual [Nm]")
    assert (correlation.get_xlabel(), correlation.get_ylabel()) == (
        "Lag [s]", "Autocorrelation [-]",
    )  # fmt: skip
    assert (histogram.get_xlabel(), histogram.get_ylabel()) == ("Residual [Nm]", "Density [1/Nm]")
    band = correlation.patches[0].get_extents().transformed(correlation.transData.inverted())
    assert (band.y0, band.y1) == pytest.approx((-white.band, white.band))


def test_a_residual_without_spread_is_drawn():
    zero = np.zeros(50)
    assert png(residual_figure(np.arange(50) / 100, zero, whiteness(zero, 100.0)), dpi=40)


def test_the_heat_map_has_values_names_signs_and_the_block():
    matrix = np.array([[1.0, -0.5, 0.9981], [-0.5, 1.0, 0.004], [0.9981, 0.004, 1.0]])
    figure = correlation_figure(["m", "k_tri", "g1"], matrix, ["k_tri"], ["g1"])
    axes = figure.axes[0]
    assert [t.get_text() for t in axes.texts] == [
        "1.00", "−0.50", "0.998", "−0.50", "1.00", "0.00", "0.998", "0.00", "1.00",
    ]  # fmt: skip
    assert [t.get_text() for t in axes.get_xticklabels()] == ["m", "k_tri", "g1"]
    corners = [p for p in axes.patches if type(p).__name__ == "Polygon"]
    assert len(corners) == 2  # the two negative cells
    (frame,) = [p for p in axes.patches if type(p).__name__ == "Rectangle"]
    assert (frame.get_xy(), frame.get_width(), frame.get_height()) == ((1.5, 0.5), 1, 1)
    assert figure.axes[1].get_ylabel() == "Correlation [-]"


def test_the_heat_map_outlines_a_block_in_as_many_pieces_as_it_has():
    names = ["m", "k_tri", "x0_tri", "e1", "e2", "f", "b_tri", "F0"]
    figure = correlation_figure(
        names, np.eye(8), ["k_tri", "x0_tri", "b_tri", "F0"], ["e1", "e2", "f"]
    )
    frames = [p for p in figure.axes[0].patches if type(p).__name__ == "Rectangle"]
    found = [(p.get_xy(), p.get_width(), p.get_height()) for p in frames]
    assert found == [((2.5, 0.5), 3, 2), ((2.5, 5.5), 3, 2)]


def test_equal_figures_give_equal_bytes():
    def draw():
        return correlation_figure(["a", "b"], np.eye(2))

    assert svg(draw()) == svg(draw())
    assert png(draw(), dpi=40) == png(draw(), dpi=40)
    assert png(draw(), dpi=40).startswith(b"\x89PNG")


def _legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]
