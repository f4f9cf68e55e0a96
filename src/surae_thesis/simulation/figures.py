"""Figures 11 to 16 of the thesis from our grid, and what explains where they differ."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    MUTED,
    OCHRE,
    RED,
    dress,
    footnote,
    heading,
    line,
    new_figure,
    shared_legend,
)
from surae.studies import POPULATIONS
from surae.units import FloatArray
from surae_thesis.section import Drawing
from surae_thesis.simulation.claims import GOOD_ESTIMATE, GOOD_VAF
from surae_thesis.simulation.grid import (
    AMPLITUDES,
    CHOSEN,
    CHOSEN_FACTOR,
    EQUAL,
    MAGNITUDE,
    MODELS,
    PROFILES,
    Cell,
    Cells,
    Study,
    along_amplitude,
    along_factor,
    along_profile,
    normalised,
    select,
)

_SEM = "SEM / its mean [-]"
_FACTOR, _AMPLITUDE = "chirp factor [-]", "chirp amplitude [rad]"
_NAMES = tuple(POPULATIONS["healthy"])
#: A logarithmic axis shows more from this ratio of largest to smallest.
_WIDE = 8.0


def drawings(views: Mapping[str, Study]) -> tuple[Drawing, ...]:
    """All figures of the section, from the cells under each reading of the noise."""
    study = views[MAGNITUDE]
    grid, noise, explicit = study.grid, study.noise, study.explicit
    return (
        Drawing(
            name="figure-11",
            title="Figure 11: SEM against the chirp’s factor",
            caption="Multiple holds, chirp of 0.2 rad, part-passive task: SEM of each parameter "
            "over its mean over the factors, muscle model above, muscle-tendon model below.",
            alt="Fifteen lines for each model, most falling, that of m by far most.",
            figure=_by_number(
                [along_factor(grid, model) for model in MODELS],
                [[cell.factor or 0.0 for cell in along_factor(grid, model)] for model in MODELS],
                _FACTOR,
            ),
        ),
        Drawing(
            name="figure-12",
            title="Figure 12: SEM against the chirp’s amplitude",
            caption="Multiple holds, chirp factor of 0.5, part-passive task: SEM of each "
            "parameter over its mean over the amplitudes. The thesis leaves out 0.3 rad for the "
            "muscle-tendon model.",
            alt="Fifteen lines for each model, most falling with the amplitude.",
            figure=_by_number(
                [along_amplitude(grid, model) for model in MODELS],
                [list(AMPLITUDES)] * 2,
                _AMPLITUDE,
            ),
        ),
        Drawing(
            name="figures-11-12-equal-noise",
            title="Figures 11 and 12 at equal noise",
            caption="As in Figures 11a and 12a, muscle model with multiple holds, but every SEM "
            "of the noise that is the same in every cell: what the motion alone does.",
            alt="Most lines fall with factor and amplitude, that of m by far most.",
            figure=_equal(views[EQUAL].grid),
        ),
        _profiles(grid, "muscle", "figure-13", "Figure 13: SEM by profile, muscle model"),
        _profiles(
            grid, "muscle-tendon", "figure-14", "Figure 14: SEM by profile, muscle-tendon model"
        ),
        Drawing(
            name="figure-15",
            title="Figure 15: IPDE against the chirp’s factor",
            caption="Chirp of 0.2 rad, part-passive task; the thesis shows multiple holds. Grey: "
            "the thesis’s figures at 0.5.",
            alt="IPDE of five profiles for each model, falling to about 0.2 and flat beyond.",
            figure=_ipde(grid),
        ),
        Drawing(
            name="figure-16",
            title="Figure 16: what the randomness of the noise does",
            caption="Five repeats of the noise at each factor, chirp of 0.1 rad, muscle model. A: "
            "VAF, B: SEM of k_tri, both with multiple holds; C: IPDE with multiple holds, D: with "
            "multi-sine-holds. Boxes from the first to the third quartile, line at the median, "
            "whiskers to the outermost value.",
            alt="Four panels of box plots against the chirp’s factor.",
            figure=_noise(noise),
        ),
        Drawing(
            name="vaf-and-estimates",
            title="VAF and the worst estimate",
            caption="Every cell of the grid: VAF against the error of its worst parameter. The "
            "lines are the thesis’s 99.85 % and 10 %: by its rule the lower left quarter would be "
            "empty, and a VAF from the line up would promise a place left of the other line.",
            alt="Scatter of VAF against the largest relative error, for both models.",
            figure=_errors(grid),
        ),
        Drawing(
            name="explicit-scheme",
            title="The thesis’s explicit scheme against an implicit one",
            caption="1 − VAF of the muscle-tendon model over the chirp’s amplitude at factor 0.5, "
            "part-passive, simulated and fitted by the same scheme: explicit Euler (4.4) at two "
            "sampling rates, and an implicit one at 125 Hz. Below the line: the thesis’s success.",
            alt="The explicit scheme lies above the line, the implicit one near or below it.",
            figure=_explicit(grid, explicit),
        ),
    )


def _by_number(
    lines: Sequence[Sequence[Cell]], at: Sequence[Sequence[float]], xlabel: str
) -> Figure:
    """Normalised SEM of both models against a number."""
    figure = new_figure(7.6)
    panels = figure.subplots(2, 1, sharex=True)
    for axes, model, some, x in zip(panels, MODELS, lines, at, strict=True):
        dress(axes, _SEM, xlabel if model == MODELS[-1] else "")
        heading(axes, f"{model} model")
        _curves(axes, some, x)
    shared_legend(figure, panels, 8)
    return figure


def _equal(grid: Cells) -> Figure:
    """Normalised SEM of the muscle model against rate and amplitude."""
    figure = new_figure(4.6)
    panels = figure.subplots(1, 2, sharey=True)
    lines = (along_factor(grid, "muscle"), along_amplitude(grid, "muscle"))
    for axes, some, label in zip(panels, lines, (_FACTOR, _AMPLITUDE), strict=True):
        dress(axes, _SEM if label == _FACTOR else "", label)
        at = [(cell.factor or 0.0) if label == _FACTOR else cell.amplitude for cell in some]
        _curves(axes, some, at)
    shared_legend(figure, panels, 8)
    return figure


def _profiles(grid: Cells, model: str, name: str, title: str) -> Drawing:
    names = [p for p in PROFILES if model == "muscle" or p != "multi-sine"]
    some = along_profile(grid, model, names)
    figure = new_figure(4.6)
    axes = figure.subplots()
    dress(axes, _SEM)
    curves = normalised(some)
    there = [one for one in _NAMES if one in curves]
    for number, one in enumerate(there):
        at = np.arange(float(len(some))) + 0.045 * (number - 0.5 * (len(there) - 1))
        axes.plot(at, curves[one], label=one, **line(_NAMES.index(one)) | {"linestyle": "none"})
    mean = np.nanmean(np.array(list(curves.values())), axis=0)
    axes.hlines(
        mean, np.arange(len(some)) - 0.38, np.arange(len(some)) + 0.38, color=INK, linewidth=1.4,
        label="mean",
    )  # fmt: skip
    axes.set_xticks(range(len(some)), [cell.profile for cell in some])
    _scale(axes, curves)
    shared_legend(figure, [axes], 8)
    less = "" if model == "muscle" else " Without the multi-sine, as in the thesis."
    return Drawing(
        name=name,
        title=title,
        caption=f"Chirp of 0.2 rad and factor 0.5, part-passive task: SEM of each parameter over "
        f"its mean over the profiles, and the mean over the parameters.{less}",
        alt="Markers of fifteen parameters above each profile, with their mean as a line.",
        figure=figure,
    )


def _ipde(grid: Cells) -> Figure:
    figure = new_figure(6.8)
    panels = figure.subplots(2, 1, sharex=True)
    marks = {"muscle": ((2.60, "2.60 holds"), (2.80, "2.80")), "muscle-tendon": ((3.45, "3.45"),)}
    for axes, model in zip(panels, MODELS, strict=True):
        dress(axes, "IPDE [-]", _FACTOR if model == MODELS[-1] else "")
        heading(axes, f"{model} model")
        for value, _ in marks[model]:
            axes.plot(CHOSEN_FACTOR, value, "D", color=GREY, markersize=9, zorder=1)
        for number, profile in enumerate(PROFILES):
            some = [cell for cell in along_factor(grid, model, profile) if cell.ipde is not None]
            x = [cell.factor for cell in some]
            axes.plot(x, [cell.ipde for cell in some], label=profile, **_profile_line(number))
    shared_legend(figure, panels, 5)
    return figure


def _noise(noise: Cells) -> Figure:
    figure = new_figure(6.6)
    panels = figure.subplots(2, 2).ravel()
    first, second = CHOSEN
    for axes, letter, profile, label in (
        (panels[0], "A", first, "VAF [%]"),
        (panels[1], "B", first, "SEM of k_tri [1/m]"),
        (panels[2], "C", first, "IPDE [-]"),
        (panels[3], "D", second, "IPDE [-]"),
    ):
        dress(axes, label, _FACTOR if letter in "CD" else "")
        heading(axes, f"{letter}: {profile}")
        groups: dict[float, list[float]] = {}
        for cell in select(noise, profile=profile):
            value = {"A": cell.vaf, "B": cell.sem.get("k_tri")}.get(letter, cell.ipde)
            if value is not None and cell.factor is not None:
                groups.setdefault(cell.factor, []).append(value)
        factors = sorted(groups)
        axes.boxplot(
            [groups[factor] for factor in factors], positions=factors, widths=0.014, whis=(0, 100),
            manage_ticks=False, patch_artist=True,
            boxprops={"facecolor": "#c9d6e8", "edgecolor": BLUE}, medianprops={"color": RED},
            whiskerprops={"color": MUTED}, capprops={"color": MUTED},
        )  # fmt: skip
        axes.ticklabel_format(axis="y", useOffset=False)
    return figure


def _errors(grid: Cells) -> Figure:
    figure = new_figure(4.2)
    axes = figure.subplots()
    dress(axes, "VAF [%]", "largest error of a parameter [% of its true value]")
    for model, marker, colour in zip(MODELS, "o^", (BLUE, RED), strict=True):
        some = select(grid, model=model)
        axes.plot(
            [100 * cell.worst[1] for cell in some], [cell.vaf for cell in some], marker,
            color=colour, markerfacecolor="none", markersize=3.6, markeredgewidth=0.7, label=model,
        )  # fmt: skip
    axes.axhline(GOOD_VAF, color=MUTED, linewidth=0.9)
    axes.axvline(100 * GOOD_ESTIMATE, color=MUTED, linewidth=0.9)
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.ticklabel_format(axis="y", useOffset=False)
    shared_legend(figure, [axes], 2)
    return figure


def _explicit(grid: Cells, explicit: Mapping[int, Cells]) -> Figure:
    figure = new_figure(4.2)
    axes = figure.subplots()
    dress(axes, "1 − VAF [%]", _AMPLITUDE)
    implicit = tuple(
        cell
        for cell in select(grid, model="muscle-tendon", task="part-passive")
        if cell.factor in (None, CHOSEN_FACTOR)
    )
    series = [(f"explicit Euler, {rate} Hz", cells) for rate, cells in explicit.items()]
    series.append(("implicit, 125 Hz", implicit))
    styles = (("s", OCHRE), ("^", RED), ("o", BLUE))
    for number, ((label, some), (marker, colour)) in enumerate(zip(series, styles, strict=True)):
        at = [cell.amplitude + 0.008 * (number - 1) for cell in some]
        axes.plot(
            at, [100.0 - cell.vaf for cell in some], marker, color=colour, markersize=5,
            markerfacecolor=colour if number == 2 else "none", label=label,
        )  # fmt: skip
    axes.axhline(100.0 - GOOD_VAF, color=MUTED, linewidth=0.9)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xticks(AMPLITUDES)
    shared_legend(figure, [axes], 3)
    footnote(figure, f"A marker for each profile; line: VAF {GOOD_VAF} %.")
    return figure


def _curves(axes: Axes, some: Sequence[Cell], at: Sequence[float]) -> None:
    """Normalised SEM of each parameter against a number."""
    curves = normalised(some)
    for number, name in enumerate(_NAMES):
        if name in curves:
            axes.plot(at, curves[name], label=name, **line(number))
    _scale(axes, curves)


def _profile_line(number: int) -> dict[str, object]:
    return line(number) | {"marker": "os^Dv"[number]}


def _scale(axes: Axes, curves: dict[str, FloatArray]) -> None:
    """A line at the mean, and a logarithmic axis where the values differ much."""
    axes.axhline(1.0, color=GREY, linewidth=0.8, zorder=1)
    values = np.concatenate(list(curves.values()))
    values = values[~np.isnan(values)]
    if values.max() > _WIDE * values.min():
        axes.set_yscale("log")
        axes.set_yticks(
            [
                tick
                for tick in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)
                if values.min() < tick <= values.max()
            ]
        )
        axes.yaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_minor_formatter("")
