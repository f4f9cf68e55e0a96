"""Figures 11 to 16 of the thesis from our grid, and what explains where they differ."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from surae.report.figures import BLUE, GREY, MUTED, RED, Figure, dress, heading, new_figure
from surae.studies import POPULATIONS
from surae_thesis.plots import Panel, PlotLine, draw, line
from surae_thesis.section import Drawing
from surae_thesis.simulation import cells as c
from surae_thesis.simulation.cells import Cells, GridCell, Study, normalised, select

_SEM = "SEM / its mean [-]"
_FACTOR = "chirp factor [-]"
_AMPLITUDE = "chirp amplitude [rad]"
_NAMES = tuple(POPULATIONS["healthy"])
#: A logarithmic axis shows more from this ratio of largest to smallest.
_WIDE = 8.0
#: IPDE of the thesis at the chosen chirp.
_IPDE = {"muscle": (2.60, 2.80), "muscle-tendon": (3.45,)}
_MARKED = "Markers of fifteen parameters above each profile, with their mean as a line."


def drawings(study: Study) -> tuple[Drawing, ...]:
    """All figures of the section."""
    grid = study.grid
    return (
        Drawing(
            "figure-11",
            "Figure 11: SEM against the chirp’s factor",
            "Multiple holds, chirp of 0.2 rad, part-passive task: SEM of each parameter over its "
            "mean over the factors, muscle model above, muscle-tendon model below.",
            "Fifteen lines for each model, most falling, that of m by far most.",
            draw([_by_factor(grid, model) for model in c.MODELS], 7.6, shared=8, sharex=True),
        ),
        Drawing(
            "figure-12",
            "Figure 12: SEM against the chirp’s amplitude",
            "Multiple holds, chirp factor of 0.5, part-passive task: SEM of each parameter over "
            "its mean over the amplitudes. The thesis leaves out 0.3 rad for the muscle-tendon "
            "model.",
            "Fifteen lines for each model, most falling with the amplitude.",
            draw([_by_amplitude(grid, model) for model in c.MODELS], 7.6, shared=8, sharex=True),
        ),
        _profiles(grid, "muscle", "figure-13", "Figure 13: SEM by profile, muscle model"),
        _profiles(
            grid, "muscle-tendon", "figure-14", "Figure 14: SEM by profile, muscle-tendon model"
        ),
        Drawing(
            "figure-15",
            "Figure 15: IPDE against the chirp’s factor",
            "Chirp of 0.2 rad, part-passive task; the thesis shows multiple holds. Grey: the "
            "thesis’s figures at 0.5.",
            "IPDE of five profiles for each model, falling to a factor of about 0.4, then flat.",
            draw([_ipde(grid, model) for model in c.MODELS], 6.8, shared=5, sharex=True),
        ),
        Drawing(
            "figure-16",
            "Figure 16: what the randomness of the noise does",
            "Five repeats of the noise at each factor, chirp of 0.1 rad, muscle model. A: VAF, B: "
            "SEM of k_tri, both with multiple holds; C: IPDE with multiple holds, D: with "
            "multi-sine-holds. Boxes from the first to the third quartile, line at the median, "
            "whiskers to the outermost value but for outliers (+).",
            "Four panels of box plots against the chirp’s factor.",
            _noise(study.noise),
        ),
    )


def _by_factor(grid: Cells, model: str) -> Panel:
    some = c.along_factor(grid, model)
    return _curves(some, [cell.factor or 0.0 for cell in some], _FACTOR)


def _by_amplitude(grid: Cells, model: str) -> Panel:
    return _curves(c.along_amplitude(grid, model), c.AMPLITUDES, _AMPLITUDE)


def _curves(some: Sequence[GridCell], at: Sequence[float], xlabel: str) -> Panel:
    """Normalised SEM of each parameter against a number."""
    curves = normalised(some)
    lines = [PlotLine(at, curves[n], n, line(k)) for k, n in enumerate(_NAMES) if n in curves]
    return Panel(_SEM, lines, xlabel, f"{some[0].model} model", _scale(curves.values()), (1.0,))


def _scale(curves: Iterable[Any]) -> dict[str, Any]:
    """A logarithmic axis where the values differ much."""
    values = np.concatenate(list(curves))
    low = np.nanmin(values)
    high = np.nanmax(values)
    if high <= _WIDE * low:
        return {}
    ticks = [tick for tick in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10) if low < tick <= high]
    return {"yscale": "log", "yticks": ticks}


def _profiles(grid: Cells, model: str, name: str, title: str) -> Drawing:
    names = [p for p in c.PROFILES if model == "muscle" or p != "multi-sine"]
    curves = normalised(c.along_profile(grid, model, names))
    place = np.arange(float(len(names)))
    shown = [parameter for parameter in _NAMES if parameter in curves]
    lines = [
        PlotLine(
            place + 0.045 * (number - 0.5 * (len(shown) - 1)),
            curves[parameter],
            parameter,
            line(_NAMES.index(parameter)) | {"linestyle": "none"},
        )
        for number, parameter in enumerate(shown)
    ]
    mean = np.nanmean(np.array(list(curves.values())), axis=0)
    dash = {"marker": "_", "markersize": 60, "markeredgewidth": 1.4, "linestyle": "none"}
    lines.append(PlotLine(place, mean, "", dash))
    at = {"xticks": range(len(names)), "xticklabels": names} | _scale(curves.values())
    less = "" if model == "muscle" else " Without the multi-sine, as in the thesis."
    return Drawing(
        name,
        title,
        "Chirp of 0.2 rad and factor 0.5, part-passive task: SEM of each parameter over its mean "
        f"over the profiles, and the mean over the parameters.{less}",
        _MARKED,
        draw(
            [Panel(_SEM, lines, at=at, across=(1.0,))],
            4.6,
            shared=8,
            note="Long dash: mean over the parameters.",
        ),
    )


def _ipde(grid: Cells, model: str) -> Panel:
    thesis = {"marker": "D", "color": GREY, "markersize": 9, "linestyle": "none", "zorder": 1}
    values = _IPDE[model]
    lines = [PlotLine([c.CHOSEN_FACTOR] * len(values), values, "", thesis)]
    for number, profile in enumerate(c.PROFILES):
        some = [cell for cell in c.along_factor(grid, model, profile) if cell.ipde is not None]
        look = line(number) | {"marker": "os^Dv"[number]}
        x = [cell.factor for cell in some]
        y = [cell.ipde for cell in some]
        lines.append(PlotLine(x, y, profile, look))
    return Panel("IPDE [-]", lines, _FACTOR, f"{model} model")


def _noise(noise: Cells) -> Figure:
    figure = new_figure(6.6)
    first, second = c.CHOSEN
    for axes, letter, profile, label in zip(
        figure.subplots(2, 2).ravel(),
        "ABCD",
        (first, first, first, second),
        ("VAF [%]", "SEM of k_tri [1/m]", "IPDE [-]", "IPDE [-]"),
        strict=True,
    ):
        dress(axes, label, _FACTOR if letter in "CD" else "")
        heading(axes, f"{letter}: {profile}")
        groups: dict[float, list[float]] = {}
        for cell in select(noise, profile=profile):
            value = {"A": cell.vaf, "B": cell.sem.get("k_tri")}.get(letter, cell.ipde)
            if value is not None and cell.factor is not None:
                groups.setdefault(cell.factor, []).append(value)
        axes.boxplot(
            list(groups.values()),
            positions=list(groups),
            widths=0.014,
            sym="+",
            manage_ticks=False,
            patch_artist=True,
            boxprops={"facecolor": "#c9d6e8", "edgecolor": BLUE},
            medianprops={"color": RED},
            whiskerprops={"color": MUTED},
            capprops={"color": MUTED},
        )
        axes.ticklabel_format(axis="y", useOffset=False)
    return figure
