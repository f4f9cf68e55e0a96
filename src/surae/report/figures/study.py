"""A study against one factor: standard errors, correlation and goodness, a row for each model."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from surae.report.figures.style import (
    GREY,
    MARKERS,
    dress,
    footnote,
    heading,
    line,
    new_figure,
    shared_legend,
)
from surae.report.study import Curve, ModelCurves, StudyCurves
from surae.units import FloatArray

#: Height of a row of panels, and of legends and footnote together [inch].
_ROW, _AROUND = 2.9, 1.5
#: A logarithmic axis shows more from this ratio of largest to smallest mean.
_WIDE = 8.0
#: Names of parameters in a line of the legend.
_COLUMNS = 8
_UNITS = {
    "chirp_amplitude": "rad",
    "chirp_rate": "Hz/s",
    "chirp_factor": "rad/s²",
    "rate_hz": "Hz",
    "noise": "-",
}


def study_figure(curves: StudyCurves, caption: str = "") -> Figure:
    """Standard errors, IPDE and VAF against a factor.

    Parameters
    ----------
    curves : StudyCurves
        See `surae.report.study.study_curves`.
    caption : str
        Begins the footnote, which the notes of the curves end.

    Returns
    -------
    Figure
        A row for each model: standard errors by parameter, IPDE [-] and VAF [%] by protocol with
        their spread as a band.
    """
    figure = new_figure(_ROW * len(curves.models) + _AROUND)
    grid = figure.subplots(
        len(curves.models), 3, squeeze=False, sharex=True, width_ratios=(1.7, 1, 1)
    )
    names = dict.fromkeys(curve.label for model in curves.models for curve in model.sem)
    styles = {name: line(number) for number, name in enumerate(names)}
    for number, (panels, model) in enumerate(zip(grid, curves.models, strict=True)):
        _row(panels, model, curves, styles, lowest=number == len(curves.models) - 1)
    shared_legend(figure, [panels[0] for panels in grid], _COLUMNS)
    text = " ".join([caption, *curves.notes]).strip()
    below = [panels[1] for panels in grid]
    if not shared_legend(figure, below, 4, "outside lower center", text):
        footnote(figure, text)
    return figure


def _row(
    panels: Sequence[Axes],
    of_model: ModelCurves,
    curves: StudyCurves,
    styles: dict[str, dict[str, Any]],
    *,
    lowest: bool,
) -> None:
    unit = _UNITS.get(curves.x, "-") if curves.numeric else ""
    label = f"{curves.x} [{unit}]" if unit else curves.x
    texts = ("SEM / its mean [-]", "IPDE [-]", "VAF [%]")
    for axes, text in zip(panels, texts, strict=True):
        dress(axes, text, label if lowest else "")
        _ticks(axes, curves)
    sem, ipde, vaf = panels
    heading(sem, of_model.model)
    at = _positions(curves)
    for curve in of_model.sem:
        sem.plot(at, curve.mean, label=curve.label, **styles[curve.label])
    _scale(sem, of_model.sem)
    for axes, of_panel in ((ipde, of_model.ipde), (vaf, of_model.vaf)):
        for number, curve in enumerate(of_panel):
            _with_spread(axes, at, curve, number, curves.numeric)
        axes.ticklabel_format(axis="y", useOffset=False)


def _with_spread(
    axes: Axes, at: FloatArray, curve: Curve, number: int,
    numeric: bool,
) -> None:  # fmt: skip
    """A line in its band; where the axis has no numbers, points with bars."""
    style = line(number) | {"marker": MARKERS[number % len(MARKERS)]}
    if numeric:
        axes.fill_between(at, curve.low, curve.high, color=style["color"], alpha=0.16, linewidth=0)
    else:
        style |= {"linestyle": "none"}
        axes.vlines(at, curve.low, curve.high, color=GREY, linewidth=2.2)
    axes.plot(at, curve.mean, label=curve.label or "_", **style)


def _positions(curves: StudyCurves) -> FloatArray:
    if curves.numeric:
        return np.array([float(value) for value in curves.values])
    return np.arange(float(len(curves.values)))


def _ticks(axes: Axes, curves: StudyCurves) -> None:
    """The factor's own names, or its numbers."""
    if curves.numeric:
        axes.locator_params(axis="x", nbins=6)
        return
    axes.set_xticks(_positions(curves), [str(value) for value in curves.values])
    for label in axes.get_xticklabels():
        label.set(rotation=35, horizontalalignment="right", rotation_mode="anchor")
    axes.margins(x=0.15)


def _scale(axes: Axes, curves: tuple[Curve, ...]) -> None:
    """Logarithmic where the means differ much; the mean over the study is marked."""
    axes.axhline(1.0, color=GREY, linewidth=0.8, zorder=1)
    means = [value for curve in curves for value in curve.mean if value > 0.0]
    if means and max(means) > _WIDE * min(means):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
