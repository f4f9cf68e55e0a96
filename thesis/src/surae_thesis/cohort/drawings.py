"""The figures of the cohort: one function for each kind, with the captions."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import surae
from surae.base.units import FloatArray
from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    OCHRE,
    RED,
    Figure,
)
from surae.report.figures.research import correlation_figure
from surae.report.figures.torque import torque_figure
from surae.report.traces import traces_of
from surae_thesis.claims import rows
from surae_thesis.cohort.boxes import Box, snsem_figure, vaf_figure
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    FAST_PROTOCOL,
    PASSIVE_PROTOCOL,
)
from surae_thesis.cohort.results import Fits, Ways
from surae_thesis.cohort.rules import (
    PROTOCOLS,
    example,
    points_of,
    spectra_of,
    thesis_means,
)
from surae_thesis.cohort.work import MODELS, inputs_of
from surae_thesis.plots import Panel, PlotLine, draw
from surae_thesis.section import Drawing

#: Models and protocols of the figures, by their numbers: parts of the torque, standard errors.
_TRACES = {
    18: ("1.0", PASSIVE_PROTOCOL),
    19: ("1.0", ACTIVE_PROTOCOL),
    20: ("1.0", FAST_PROTOCOL),
    24: ("2.0", PASSIVE_PROTOCOL),
    25: ("2.0", ACTIVE_PROTOCOL),
}
_SNSEM = {
    21: ("1.0", ACTIVE_PROTOCOL),
    22: ("1.0", FAST_PROTOCOL),
    26: ("2.0", ACTIVE_PROTOCOL),
    27: ("2.0", FAST_PROTOCOL),
    33: ("2.1", ACTIVE_PROTOCOL),
    34: ("2.2", ACTIVE_PROTOCOL),
}
#: Titles, captions and lower ends of the figures of VAF, by their numbers.
_VAF = {
    "17": ("VAF of model 1.0", "Fits of model 1.0 to one recording each", 80.0),
    "23": ("VAF of model 2.0", "Fits of model 2.0 to one recording each", 75.0),
    "29": (
        "VAF of repetitions that were predicted",
        "Parameters from repetition 1 predict the others of the same protocol",
        50.0,
    ),
    "30": (
        "the ramp and hold, predicted from the multiple holds",
        "Parameters from the active multiple holds, repetition 1, predict the passive ramp and "
        "hold",
        65.0,
    ),
    "32": ("VAF of fits with a free tendon parameter", "Models 2.1 and 2.2", 75.0),
    "35": (
        "VAF of repetitions predicted with it",
        "Models 2.1 and 2.2: repetition 1 predicts the others",
        50.0,
    ),
}
_BOXES = (
    "Boxes: 25th to 75th percentile, whiskers to 1.5 times their distance, every recording a dot. "
    "Triangles: the thesis's means."
)
#: Repetitions, told apart by dashes as well as by colour.
_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": INK},
    {"color": RED, "linestyle": (0, (5, 1.5))},
    {"color": BLUE, "linestyle": (0, (1.2, 1.0)), "linewidth": 1.3},
    {"color": OCHRE},
)


def noted(fits: Fits) -> list[str]:
    """Subjects whose knee moves or whose ankle is misaligned."""
    return [member.id for member in fits.members if member.remarks]


def vaf_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 17, 23, 29, 30, 32 and 35: the levels of the claims, by the figure that they name."""
    figures: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows("subjects"):
        if row["ours"] == "vaf_level":
            figures.setdefault(row["source"].split()[-1], []).append(row["given"])
    for number, (title, caption, lowest) in _VAF.items():
        boxes = [
            Box(
                f"{PROTOCOLS[g['protocol']]}\n[{g['model']}]".replace(" ", "\n", 1),
                points_of(fits, g["kind"], g["model"], g["protocol"]),
                g["mean"],
            )
            for g in figures[number]
        ]
        yield Drawing(
            f"figure-{number}",
            f"Figure {number}: {title}",
            f"{caption}. {_BOXES}",
            f"Box plots. {caption}.",
            vaf_figure(boxes, lowest, noted(fits)),
        )


def integrator_drawing(ways: Ways) -> Drawing:
    """Model 2.0 on the multiple holds by both integrators."""
    first = {which: vaf for which, vaf in ways.cohort.vaf("2.0").items() if which[1] == 1}
    boxes = [
        Box("implicit", first, thesis_means()["fit", "2.0", ACTIVE_PROTOCOL]),
        Box("explicit,\nusual differences", ways.explicit.vaf("2.0")),
        Box("explicit,\nwide differences", ways.wide),
    ]
    return Drawing(
        "figure-23-integrator",
        "Model 2.0, the same recordings by two integrators",
        "VAF of fits of model 2.0 to repetition 1 of the multiple holds: implicit integration of "
        f"the tendon, and the thesis's explicit one with an optimiser of its kind. {_BOXES}",
        "Box plots of the VAF of model 2.0 for two integrators.",
        vaf_figure(boxes, 40.0, noted(ways.cohort)),
    )


def snsem_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 21, 22, 26, 27, 33 and 34."""
    for number, (model, protocol) in _SNSEM.items():
        ratios = fits.snsem(model, protocol)
        fitted = sum(1 for _ in fits.of(model, protocol))
        caption = f"snSEM of model {model}, {PROTOCOLS[protocol]}"
        yield Drawing(
            f"figure-{number}",
            f"Figure {number}: {caption}",
            "Standard error, equation (34), of every recording over the mean of simulated subjects "
            "at the same rate. Logarithmic, unlike the thesis's axis.",
            f"Box plots of the {caption}.",
            snsem_figure(ratios, {n: fitted - len(several) for n, several in ratios.items()}),
        )


def trace_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 18 to 20, 24, 25 and 28: one subject's fits; 31: a prediction."""
    _, who = example(fits.members)
    for figure, (model, protocol) in _TRACES.items():
        if protocol not in who.completed:
            continue
        inputs = inputs_of(who, protocol, 1)
        fit = surae.fit(inputs, MODELS[model], starts=2, quality=())
        fitted = f"model {model}, {PROTOCOLS[protocol]}"
        yield Drawing(
            f"figure-{figure}",
            f"Figure {figure}: torque of {fitted}",
            f"Subject {who.id}, repetition 1, {fitted}: EMG, angle, torque and its parts. VAF "
            f"{fit.vaf:.2f} %.",
            f"EMG, angle, measured and modelled torque and its parts; {fitted}.",
            torque_figure(traces_of(fit.result)[0]),
        )
        if figure == 19:
            passive = inputs_of(who, PASSIVE_PROTOCOL, 1)
            prediction = fit.predict(passive)
            measured = PlotLine(
                prediction.time, prediction.measured, "measured", {"color": GREY, "linewidth": 3.0}
            )
            predicted = PlotLine(prediction.time, prediction.torque, "predicted", {"color": BLUE})
            panels = [
                Panel(
                    "Angle [rad]",
                    [PlotLine(prediction.time, passive.angle)],
                    "",
                    "Ankle angle, dorsiflexion positive",
                ),
                Panel(
                    "Torque [Nm]",
                    [measured, predicted],
                    "Time [s]",
                    "Torque, triceps positive",
                    legend=2,
                ),
            ]
            yield Drawing(
                "figure-31",
                "Figure 31: a ramp and hold, predicted from the multiple holds",
                f"Subject {who.id}, model 1.0: parameters from the active multiple holds, torque "
                f"of the passive ramp and hold. VAF {prediction.vaf:.1f} %.",
                "Angle, and measured and predicted torque, of a ramp and hold.",
                draw(panels, 4.6, sharex=True, height_ratios=(1.0, 1.6)),
            )
        if figure == 25:
            names = fit.covariance.names
            matrix = fit.covariance.correlation
            yield Drawing(
                "figure-28",
                "Figure 28: correlations of the estimates of model 2.0",
                f"Subject {who.id}, multiple holds, the fit of Figure 25. Parameters at a "
                "bound have no covariance.",
                "Heat map of the correlations of the estimates of model 2.0.",
                correlation_figure(names, matrix),
            )


def spectra_drawing(fits: Fits) -> Drawing:
    """Figure 40."""
    _, who = example(fits.members)
    return Drawing(
        "figure-40",
        "Figure 40: power spectra of one subject's repetitions",
        f"Subject {who.id}, torque of the multiple holds as recorded, Welch's method.",
        "Power spectral density of the torque of the repetitions of one subject.",
        spectra_figure(spectra_of(who)),
    )


def spectra_figure(spectra: Sequence[tuple[FloatArray, FloatArray]]) -> Figure:
    """Power densities of the torque of repetitions, in two panels: wide and near zero."""
    panels = []
    for highest, title in ((60.0, "Torque"), (8.0, "Its lowest frequencies")):
        lines = []
        for number, ((frequency, power), look) in enumerate(zip(spectra, _LOOKS, strict=False), 1):
            shown = (frequency <= highest) & (frequency > 0.0)
            lines.append(PlotLine(frequency[shown], power[shown], f"repetition {number}", look))
        panels.append(
            Panel(
                "Power density [dB re 1 Nm²/Hz]",
                lines,
                "Frequency [Hz]",
                title,
                {"xlim": (0.0, highest)},
            )
        )
    return draw(panels, 3.6, columns=2, shared=3, width_ratios=(1.3, 1.0))
