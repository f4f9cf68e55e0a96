"""The picture of a film: its units, what tells filmed from modelled in grey, and its words."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from surae.api.plots import Plots
from surae.base.errors import InputError
from surae.inference.judging.fascicles import FascicleQuality, Fascicles
from surae.report.figures.tendon import film_figure
from surae.report.recordings import film_block, film_lines


@pytest.fixture(scope="module")
def film() -> Fascicles:
    time = np.arange(60) / 30.0
    model = 0.06 + 0.005 * np.sin(time)
    seen = model + 3e-4 * (-1.0) ** np.arange(60)
    force, stretch = 100.0 + 50.0 * np.cos(time), 0.004 + 0.002 * np.cos(time)
    return Fascicles("walk", "fascicle_gm", time, seen, model, stretch, stretch, force, force)


def test_axes_have_units_and_lines_differ_without_colour(film) -> None:
    traces = SimpleNamespace(time=film.time, measured=film.torque, modelled=film.torque)
    figure = film_figure(traces, film)
    labels = " ".join(axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes)
    for unit in ("[Nm]", "[mm]", "[N]", "[s]"):
        assert unit in labels
    filmed, model = figure.axes[1].get_lines() or figure.axes[0].get_lines()
    grey = [float(np.dot(to_rgb(line.get_color()), (0.3, 0.6, 0.1))) for line in (filmed, model)]
    assert grey[0] - grey[1] > 0.3
    assert filmed.get_linewidth() > 2 * model.get_linewidth()


def test_the_terminal_and_the_report_say_how_well_it_is_followed(film) -> None:
    assert "RMS error 0.30 mm" in film_block("film-0-0", film).blocks[1].alt
    (said,) = film_lines("walk", [film.quality])
    assert said.startswith("walk: fascicle_gm: RMS error 0.30 mm, mean error ")
    assert "tracker noise 0.4" in said
    assert said.endswith("frames 60")


def test_what_cannot_be_known_is_not_printed() -> None:
    (said,) = film_lines("walk", [FascicleQuality("fascicle_gm", 2, 0.3, 0.1)])
    assert "correlation" not in said
    assert "tracker noise" not in said
    assert film_lines("walk", []) == []


def test_a_fit_without_a_film_has_no_such_picture(plain) -> None:
    with pytest.raises(InputError, match="has no film"):
        Plots(plain.result, plain.assessment).film()
