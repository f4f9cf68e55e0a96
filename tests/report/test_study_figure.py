"""The figure of a study, from rows made by hand."""

import numpy as np
import pytest

from surae.errors import InputError
from surae.report.figures import png
from surae.report.figures.study import study_figure
from surae.report.study import study_curves

FACTORS = ("protocol", "chirp_amplitude", "chirp_rate", "subject", "noise", "model")


def row(protocol="sine", rate=0.1, subject=1, sem=1.0, **more):
    return {
        "protocol": protocol, "chirp_amplitude": 0.2, "chirp_rate": rate, "subject": subject,
        "noise": 0.05, "model": "muscle", "status": "converged", "vaf": 99.0, "ipde": 3.0,
        "m": 2.0, "m_sem": sem, "m_true": 2.0, "f0": 2.0, "f0_sem": 2 * sem, "f0_true": 2.0,
    } | more  # fmt: skip


def crossed(**more):
    return [
        row(protocol, rate, subject, sem=10 * rate * scale, ipde=2.0 + subject, **more)
        for protocol, scale in (("sine", 1.0), ("multiple-holds", 0.01))
        for rate in (0.1, 0.2, 0.3)
        for subject in (1, 2)
    ]


def test_the_factor_that_varies_most_is_the_axis() -> None:
    assert study_curves(crossed(), FACTORS).x == "chirp_rate"
    many_subjects = [row(subject=s, noise=n) for s in range(1, 9) for n in (0.0, 0.1)]
    assert study_curves(many_subjects, FACTORS).x == "noise"
    assert study_curves(many_subjects, FACTORS, "subject").values == tuple(range(1, 9))
    assert study_curves([row("sine"), row("multi-sine")], FACTORS).x == "protocol"
    assert study_curves([row()], FACTORS).x == "protocol"


def test_means_spread_and_normalisation() -> None:
    curves = study_curves(crossed(), FACTORS)
    (model,) = curves.models
    assert curves.values == (0.1, 0.2, 0.3)
    assert [curve.label for curve in model.sem] == ["m", "f0"]
    for curve in model.sem:  # the hundredfold between the protocols does not matter
        np.testing.assert_allclose(curve.mean, [0.5, 1.0, 1.5])
    assert [curve.label for curve in model.ipde] == ["sine", "multiple-holds"]
    np.testing.assert_allclose(model.ipde[0].mean, 3.5)
    np.testing.assert_allclose(model.ipde[0].high - model.ipde[0].low, 2 * np.std([3, 4], ddof=1))
    assert (model.vaf[0].high <= 100.0).all()
    (model,) = study_curves(crossed(), FACTORS, "protocol").models
    np.testing.assert_allclose(model.sem[0].mean, [2 / 1.01, 0.02 / 1.01])


def test_what_failed_or_has_no_chirp_is_left_out_and_counted() -> None:
    rows = [
        *crossed(),
        row(status="failed", vaf=None, ipde=None, m_sem=None, f0_sem=None),
        row(chirp_amplitude=0.0, sem=1e6),
    ]
    curves = study_curves(rows, FACTORS, "chirp_rate")
    np.testing.assert_allclose(curves.models[0].sem[0].mean, [0.5, 1.0, 1.5])
    assert curves.notes[0].startswith("12 rows;")
    assert curves.notes[2:] == (
        "Rows of failed fits, left out: 1.", "Rows without chirp, left out: 1.",
    )  # fmt: skip


def test_a_parameter_without_standard_errors_has_no_line() -> None:
    (model,) = study_curves(crossed(f0_sem=None), FACTORS).models
    assert [curve.label for curve in model.sem] == ["m"]


def test_nothing_to_draw_is_refused() -> None:
    with pytest.raises(InputError, match="nothing to draw: 0 rows"):
        study_curves([], FACTORS)
    with pytest.raises(InputError, match="nothing to draw: 1 rows are done and none has a fit"):
        study_curves([row(status="failed", vaf=None)], FACTORS)
    with pytest.raises(InputError, match=r"'noise' is no factor that varies .* use one of: prot"):
        study_curves(crossed(), FACTORS, "noise")


def test_panels_units_and_legends() -> None:
    rows = crossed() + crossed(model="muscle-tendon")
    figure = study_figure(study_curves(rows, FACTORS), "small:")
    labels = ["SEM / its mean [-]", "IPDE [-]", "VAF [%]"]
    assert [axes.get_ylabel() for axes in figure.axes] == 2 * labels
    assert [axes.get_xlabel() for axes in figure.axes] == 3 * [""] + 3 * ["chirp_rate [Hz/s]"]
    assert [a.get_title(loc="left") for a in figure.axes[::3]] == ["muscle", "muscle-tendon"]
    above, below = ([text.get_text() for text in legend.get_texts()] for legend in figure.legends)
    assert (above, below) == (["m", "f0"], ["sine", "multiple-holds"])
    assert figure.legends[1].get_title().get_text().startswith("small: 24 rows")


def test_lines_differ_without_colour() -> None:
    more = {f"p{i}_sem": 1.0 for i in range(21)}  # as many as the largest model has
    axes = study_figure(study_curves(crossed(**more), FACTORS)).axes[0]
    named = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
    looks = {
        (str(line._dash_pattern), line.get_marker(), line.get_markerfacecolor() == "white")
        for line in named
    }
    assert len(looks) == len(named) == 23


def test_protocols_are_categories_where_no_number_varies() -> None:
    figure = study_figure(study_curves([row("sine"), row("multi-sine", sem=30.0)], FACTORS))
    assert [t.get_text() for t in figure.axes[0].get_xticklabels()] == ["sine", "multi-sine"]
    assert figure.axes[0].get_yscale() == "log"
    assert len(figure.legends) == 1
    assert png(figure, 40).startswith(b"\x89PNG")
