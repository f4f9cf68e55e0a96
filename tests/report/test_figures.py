import re
from dataclasses import replace

import numpy as np
import pytest

from surae.inference import whiteness
from surae.report.figures import png, write_figure
from surae.report.figures.research import correlation_figure, residual_figure
from surae.report.figures.torque import fit_figure, torque_figure
from surae.report.traces import traces_of


@pytest.fixture(scope="module")
def traces(plain):
    return traces_of(plain.result)[0]


def test_traces_are_those_of_the_fit(plain, traces):
    assert traces.modelled == pytest.approx(traces.parts.total, abs=1e-9)
    assert traces.residual == pytest.approx(plain.result.residuals[0], abs=1e-9)


def test_four_panels_with_units_on_one_time_axis(traces):
    emg, angle, torque, parts = torque_figure(traces).axes
    assert emg.get_ylabel() == "EMG [mV]"
    assert [t.get_text() for t in emg.get_yticklabels()] == ["TA", "GL", "SOL", "GM"]
    for line, level, channel in zip(emg.get_lines(), emg.get_yticks(), traces.emg.T, strict=True):
        assert max(line.get_ydata()) - level == pytest.approx(1e3 * channel.max())
    assert emg.get_title(loc="left").startswith("EMG, each from 0 to ")
    assert angle.get_ylabel() == "Angle [°]"
    assert max(angle.get_lines()[0].get_ydata()) == pytest.approx(np.degrees(traces.angle.max()))
    assert torque.get_ylabel() == parts.get_ylabel() == "Torque [Nm]"
    assert parts.get_xlabel() == "Time [s]"
    assert _legend(torque) == ["measured", "modelled"]
    assert _legend(parts) == ["tissue", "muscle", "inertial", "gravitational"]
    for axes in (emg, angle, torque):
        assert axes.get_shared_x_axes().joined(axes, parts)


def test_lines_differ_without_colour(traces):
    with_legends = [axes for axes in torque_figure(traces).axes if axes.get_legend()]
    assert len(with_legends) == 2
    for axes in with_legends:
        looks = {(line.get_linestyle(), line.get_linewidth()) for line in axes.get_lines()}
        assert len(looks) == len(axes.get_lines())


def test_emg_that_was_not_recorded_takes_no_panel(traces):
    figure = torque_figure(replace(traces, missing_emg=("sol",), emg_unit="1"))
    assert [t.get_text() for t in figure.axes[0].get_yticklabels()] == ["TA", "GL", "GM"]
    assert figure.axes[0].get_ylabel() == "EMG"
    without = torque_figure(replace(traces, missing_emg=("ta", "gl", "sol", "gm")))
    assert [axes.get_ylabel() for axes in without.axes] == [
        "Angle [°]",
        "Torque [Nm]",
        "Torque [Nm]",
    ]


@pytest.mark.parametrize("dpi", [100, 150])
def test_labels_of_a_column_are_in_line_and_clear_of_the_numbers(traces, dpi):
    figure = torque_figure(traces)
    png(figure, dpi)
    shown = [axes for axes in figure.axes if axes.get_ylabel()]
    places = [axes.yaxis.label.get_window_extent() for axes in shown]
    assert len(places) == 4
    assert np.ptp([place.x1 for place in places]) < 0.01
    numbers = [text.get_window_extent().x0 for axes in shown for text in axes.get_yticklabels()]
    assert min(place.x0 for place in places) >= 0
    assert max(place.x1 for place in places) < min(numbers)
    below = figure.axes[-1].xaxis
    top = below.label.get_window_extent().y1
    assert 0 < top < min(text.get_window_extent().y0 for text in below.get_ticklabels())


@pytest.mark.parametrize("factor", [1.0, 3000.0])
def test_emg_is_in_one_unit_whatever_its_size(traces, factor):
    one = replace(traces, emg=traces.emg * factor, missing_emg=("ta", "gl", "sol"))
    strip = torque_figure(one).axes[0]
    assert strip.get_ylabel() == "EMG [mV]"
    assert max(strip.get_lines()[0].get_ydata()) == pytest.approx(1e3 * one.emg[:, 3].max())


def test_movement_that_repeats_itself_is_shown_over_the_cycle_too(traces):
    wave = 0.2 * np.sin(2 * np.pi * 2.0 * traces.time)
    figure = torque_figure(replace(traces, angle=wave), width=170 / 25.4)
    assert len(figure.axes) == 8  # two columns of four
    labels = [axes.get_xlabel() for axes in figure.axes if axes.get_xlabel()]
    assert labels == ["Time [s], 8 of 18 cycles", "Cycle of 0.50 s [%]"]
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert "Mean ± SD of 18 cycles" in titles
    narrow = torque_figure(replace(traces, angle=wave), width=85 / 25.4)
    assert len(narrow.axes) == 4


def test_several_recordings_have_a_panel_each_with_their_names(joint):
    figure = fit_figure(joint.result, ["R² 99.0 %", "R² 98.0 %"])
    assert figure.axes[0].get_title(loc="left") == "trial 1"
    assert [axes.get_title(loc="right") for axes in figure.axes] == ["R² 99.0 %", "R² 98.0 %"]
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["measured", "modelled"]


def test_a_figure_has_the_width_asked_for_and_its_fonts_within(plain, tmp_path):
    for name in ("f.svg", "f.PDF"):
        figure = fit_figure(plain.result, width=120 / 25.4)
        write_figure(tmp_path / name, figure)
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+)", (tmp_path / "f.PDF").read_bytes())
    assert float(box[1]) / 72 * 25.4 == pytest.approx(120, abs=0.1)
    assert b"/FontFile2" in (tmp_path / "f.PDF").read_bytes()
    assert b"/Type3" not in (tmp_path / "f.PDF").read_bytes()
    drawing = (tmp_path / "f.svg").read_text()
    assert 'width="340' in drawing  # points
    assert "<text" not in drawing
    assert "<path" in drawing


def test_the_residual_has_its_band_and_units(traces):
    white = whiteness(traces.residual, 100.0)
    over_time, correlation = residual_figure(traces.time, traces.residual, white).axes
    assert (over_time.get_xlabel(), over_time.get_ylabel()) == ("Time [s]", "Residual [Nm]")
    assert (correlation.get_xlabel(), correlation.get_ylabel()) == (
        "Lag [s]",
        "Autocorrelation [-]",
    )
    band = correlation.patches[0].get_extents().transformed(correlation.transData.inverted())
    assert (band.y0, band.y1) == pytest.approx((-white.band, white.band))


def test_a_residual_without_spread_is_drawn():
    zero = np.zeros(50)
    assert png(residual_figure(np.arange(50) / 100, zero, whiteness(zero, 100.0)), dpi=40)


def test_the_heat_map_has_values_and_names():
    matrix = np.array([[1.0, -0.5, 0.9981], [-0.5, 1.0, 0.004], [0.9981, 0.004, 1.0]])
    figure = correlation_figure(["m", "k_tri", "g1"], matrix)
    axes = figure.axes[0]
    cells = {(*map(int, t.get_position()),): t.get_text() for t in axes.texts}
    assert cells == {(0, 1): "−0.50", (0, 2): "0.998", (1, 2): "0.00"}  # below the diagonal
    assert [t.get_text() for t in axes.get_xticklabels()] == ["m", "k_tri", "g1"]
    assert figure.axes[1].get_ylabel() == "Correlation [-]"


def _legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]
