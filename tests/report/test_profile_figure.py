"""The figure of profiles, from profiles made by hand."""

import numpy as np
import pytest

from surae.assessment.likelihood.profile import ParameterProfile
from surae.report.figures.intervals import profile_figure


def made(name="f0", unit="Hz", interval=(1.0, 3.0), sem=0.5) -> ParameterProfile:
    values = np.linspace(0.5, 3.5, 13)
    chi2 = 4 * (values - 2.0) ** 2
    return ParameterProfile(
        name=name, unit=unit, value=2.0, sem=sem, values=values, sse=10 + chi2, chi2=chi2,
        others=("m",), path=np.ones((13, 1)), variance_inflation=1.0, threshold=4.0,
        interval=interval, reasons=("", ""), status="closed", message="both ends found",
        lower=None, evaluations=50,
    )  # fmt: skip


@pytest.mark.parametrize(("count", "rows"), [(1, 1), (2, 1), (3, 1), (4, 2), (15, 5)])
def test_a_panel_for_each(count, rows):
    figure = profile_figure([made(f"p{i}") for i in range(count)])
    shown = [axes for axes in figure.axes if axes.get_visible()]
    assert [axes.get_xlabel() for axes in shown] == [f"p{i} [Hz]" for i in range(count)]
    assert figure.axes[0].get_gridspec().nrows == rows
    assert shown[0].get_ylabel() == "Δχ² [-]"
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["95 % interval", "threshold 4.00", "covariance", "profile", "estimate"]


def test_curve_threshold_parabola_and_interval_lie_where_they_should():
    (axes,) = profile_figure([made(sem=0.4)]).axes
    by_label = {line.get_label(): line for line in axes.get_lines()}
    assert by_label["threshold 4.00"].get_ydata()[0] == 4.0
    x, y = by_label["covariance"].get_data()
    np.testing.assert_allclose(y, ((x - 2.0) / 0.4) ** 2)
    band = axes.patches[0].get_extents().transformed(axes.transData.inverted())
    assert (band.x0, band.x1) == pytest.approx((1.0, 3.0))
    curve = max(axes.get_lines(), key=lambda line: len(line.get_xdata()) * (line.get_zorder() > 2))
    np.testing.assert_allclose(curve.get_ydata(), 4 * (curve.get_xdata() - 2.0) ** 2, atol=0.02)


def test_lines_differ_without_colour():
    (axes,) = profile_figure([made()]).axes
    named = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
    looks = {(line.get_linestyle(), line.get_linewidth(), line.get_marker()) for line in named}
    assert len(looks) == len(named)


def test_an_open_end_is_marked_and_the_rest_goes_on_without_a_parabola():
    (axes,) = profile_figure([made(interval=(None, 3.0), sem=None)]).axes
    assert [t.get_text() for t in axes.texts] == ["open"]
    assert axes.get_title(loc="right") == "open … 3.00"
    assert "covariance" not in axes.get_legend_handles_labels()[1]


def test_the_caption_says_what_the_noise_was_taken_for():
    noise = "variance of the noise ×4: the residual is correlated over time (p < 0.001)"
    figure = profile_figure([made()], noise)
    assert figure.get_supxlabel().replace("\n", " ") == noise
    assert profile_figure([made()]).get_supxlabel() == ""
