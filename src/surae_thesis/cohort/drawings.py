"""The figures of the cohort: one function for each kind, with the captions."""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    OCHRE,
    RED,
    Figure,
    correlation_figure,
    torque_figure,
    traces_of,
)
from surae.units import FloatArray
from surae_thesis.cohort import plan, work
from surae_thesis.cohort.boxes import Box, BoxPanel, snsem_figure, vaf_figure
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    FAST_PROTOCOL,
    PASSIVE_PROTOCOL,
    CohortSubject,
)
from surae_thesis.cohort.results import Fits, Point
from surae_thesis.cohort.rules import ACTIVE, PASSIVE, PROTOCOLS, thesis_means
from surae_thesis.cohort.trials import RECORDED_HZ, cohort_inputs, cohort_recording
from surae_thesis.plots import Panel, PlotLine, draw
from surae_thesis.section import Drawing

#: Models and protocols of the figures, by their numbers: parts of the torque, standard errors.
_TRACES = {
    18: ("1.0", PASSIVE_PROTOCOL), 19: ("1.0", ACTIVE_PROTOCOL), 20: ("1.0", FAST_PROTOCOL),
    24: ("2.0", PASSIVE_PROTOCOL), 25: ("2.0", ACTIVE_PROTOCOL),
}  # fmt: skip
_SNSEM = {
    21: ("1.0", ACTIVE_PROTOCOL), 22: ("1.0", FAST_PROTOCOL), 26: ("2.0", ACTIVE_PROTOCOL),
    27: ("2.0", FAST_PROTOCOL), 33: ("2.1", ACTIVE_PROTOCOL), 34: ("2.2", ACTIVE_PROTOCOL),
}  # fmt: skip
_BOXES = (
    "Boxes: 25th to 75th percentile, whiskers to 1.5 times their distance, every recording a dot. "
    "Triangles: the thesis's means."
)
#: Repetitions, told apart by dashes as well as by colour.
_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": INK}, {"color": RED, "linestyle": (0, (5, 1.5))},
    {"color": BLUE, "linestyle": (0, (1.2, 1.0)), "linewidth": 1.3}, {"color": OCHRE},
)  # fmt: skip
#: Length of the segments whose spectra are averaged [s].
_SEGMENT = 8.0


def noted(fits: Fits) -> list[str]:
    """Subjects whose knee moves or whose ankle is misaligned."""
    return [member.id for member in fits.members if member.remarks]


def example(fits: Fits) -> tuple[int, CohortSubject]:
    """Number and data of the subject of the example figures: the first of whom nothing was noted.

    Of those who completed all three protocols, if there is one.
    """
    return min(
        enumerate(fits.members), key=lambda who: (-len(who[1].completed), bool(who[1].remarks))
    )


def vaf_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 17, 23, 29, 30, 32 and 35."""

    def boxes(
        kind: str, points: Callable[..., list[Point]], *cases: tuple[str, str, str]
    ) -> list[Box]:
        return [Box(label, points(m, p), thesis_means().get((kind, m, p))) for m, p, label in cases]

    def cases(model: str, *protocols: str) -> list[tuple[str, str, str]]:
        return [(model, p, PROTOCOLS[p].replace(" ", "\n", 1)) for p in protocols]

    def onto(model: str, protocol: str) -> list[Point]:
        del protocol
        return fits.onto_passive(model)

    tendons = [("2.1", ACTIVE_PROTOCOL, "strain\nfactor [2.1]"),
               ("2.2", ACTIVE_PROTOCOL, "toe\nforce [2.2]")]  # fmt: skip
    rows: list[tuple[int, str, str, list[BoxPanel]]] = [
        *(
            (number, f"VAF of model {model}", f"VAF of fits of model {model} to one recording each",
             [BoxPanel("Passive", boxes("fit", fits.vaf, *cases(model, PASSIVE_PROTOCOL)), 90.0),
              BoxPanel("Active", boxes("fit", fits.vaf, *cases(model, *plan.ACTIVE)), 75.0)])
            for number, model in ((17, "1.0"), (23, "2.0"))
        ),
        (29, "VAF of repetitions that were predicted",
         "Parameters from repetition 1 predict the other repetitions of the same protocol",
         [BoxPanel(f"Model {m}",
                   boxes("validation", fits.predicted, *cases(m, *plan.ACTIVE)), 50.0)
          for m in ("1.0", "2.0")]),
        (30, "the ramp and hold, predicted from the multiple holds",
         "Parameters from the active multiple holds, repetition 1, predict the passive ramp and "
         "hold",
         [BoxPanel("Ramp and hold",
                   boxes("onto", onto, *((m, PASSIVE_PROTOCOL, f"model {m}")
                                         for m in ("1.0", "2.0"))), 65.0)]),
        (32, "VAF of fits with a free tendon parameter",
         "VAF of fits with a free tendon parameter, models 2.1 and 2.2",
         [BoxPanel("Multiple holds", boxes("fit", fits.vaf, *tendons), 75.0)]),
        (35, "VAF of repetitions predicted with it",
         "VAF of repetitions predicted with a free tendon parameter, models 2.1 and 2.2",
         [BoxPanel("Multiple holds", boxes("validation", fits.predicted, *tendons), 50.0)]),
    ]  # fmt: skip
    for number, title, caption, panels in rows:
        ylabel = "VAF [%]" if number in (17, 23, 32) else "Validation VAF [%]"
        yield Drawing(
            f"figure-{number}", f"Figure {number}: {title}", f"{caption}. {_BOXES}",
            f"Box plots. {caption}.", vaf_figure(panels, noted(fits), ylabel),
        )  # fmt: skip


def explicit_drawing(fits: Fits, explicit: Fits) -> Drawing:
    """Model 2.0 by both integrators."""
    panels = [
        BoxPanel(
            title,
            [
                Box(name.replace(" ", "\n", 1),
                    [point for point in several.vaf("2.0", p) if point.repetition == 1],
                    thesis_means().get(("fit", "2.0", p)))
                for p, name in PROTOCOLS.items()
            ],
            70.0,
        )
        for title, several in (
            ("Implicit (ours)", fits), ("Explicit Euler, 1000 Hz (thesis)", explicit),
        )
    ]  # fmt: skip
    return Drawing(
        "figure-23-integrator", "Model 2.0, the same recordings by two integrators",
        "VAF of fits of model 2.0 to repetition 1: implicit integration of the tendon, and the "
        f"thesis's explicit one at the thesis's rate. {_BOXES}",
        "Box plots of the VAF of model 2.0 for two integrators on three protocols.",
        vaf_figure(panels, noted(fits)),
    )  # fmt: skip


def snsem_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 21, 22, 26, 27, 33 and 34."""
    for number, (model, protocol) in _SNSEM.items():
        ratios = fits.snsem(model, protocol)
        fitted = sum(1 for _ in fits.of(model, protocol))
        caption = f"snSEM of model {model}, {PROTOCOLS[protocol]}"
        yield Drawing(
            f"figure-{number}", f"Figure {number}: {caption}",
            "Standard error, equation (34), of every recording over the mean of "
            f"{fits.size.baseline} simulated subjects at the same rate. Logarithmic, unlike the "
            "thesis's axis.", f"Box plots of the {caption}.",
            snsem_figure(ratios, {n: fitted - len(several) for n, several in ratios.items()}),
        )  # fmt: skip


def trace_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 18 to 20, 24, 25 and 28: one subject's fits; 31: a prediction."""
    number, who = example(fits)
    for figure, (model, protocol) in _TRACES.items():
        if protocol not in who.completed:
            continue
        fit = work.fitted(**plan.fit_settings(fits.size, number, [(protocol, 1)], model))
        fitted = f"model {model}, {PROTOCOLS[protocol]}"
        yield Drawing(
            f"figure-{figure}", f"Figure {figure}: torque of {fitted}",
            f"Subject {who.id}, repetition 1, {fitted}: EMG, angle, torque and its parts. VAF "
            f"{fit.vaf:.2f} %.",
            f"EMG, angle, measured and modelled torque and its parts; {fitted}.",
            torque_figure(traces_of(fit.result)[0]),
        )  # fmt: skip
        if figure == 19:
            passive = cohort_inputs(who, PASSIVE_PROTOCOL, 1, rate_hz=fits.size.rate_hz)
            prediction = fit.predict(passive)
            measured = PlotLine(prediction.time, prediction.measured, "measured",
                            {"color": GREY, "linewidth": 3.0})  # fmt: skip
            predicted = PlotLine(prediction.time, prediction.torque, "predicted", {"color": BLUE})
            panels = [
                Panel("Angle [rad]", [PlotLine(prediction.time, passive.angle)], "",
                      "Ankle angle, dorsiflexion positive"),
                Panel("Torque [Nm]", [measured, predicted], "Time [s]", "Torque, triceps positive",
                      legend=2),
            ]  # fmt: skip
            yield Drawing(
                "figure-31", "Figure 31: a ramp and hold, predicted from the multiple holds",
                f"Subject {who.id}, model 1.0: parameters from the active multiple holds, torque "
                f"of the passive ramp and hold. VAF {prediction.vaf:.1f} %.",
                "Angle, and measured and predicted torque, of a ramp and hold.",
                draw(panels, 4.6, sharex=True, height_ratios=(1.0, 1.6)),
            )  # fmt: skip
        if figure == 25:
            names, matrix = fit.covariance.names, fit.covariance.correlation
            yield Drawing(
                "figure-28", "Figure 28: correlations of the estimates of model 2.0",
                f"Subject {who.id}, multiple holds, the fit of Figure 25. Outlined: passive "
                "against active parameters. Parameters at a bound have no covariance.",
                "Heat map of the correlations of the estimates of model 2.0.",
                correlation_figure(names, matrix, PASSIVE, ACTIVE),
            )  # fmt: skip


def spectra_drawing(fits: Fits) -> tuple[Drawing, list[float]]:
    """Figure 40, and the mean absolute difference of each pair of repetitions [dB]."""
    _, who = example(fits)
    spectra = [
        spectrum(
            np.asarray(cohort_recording(who, ACTIVE_PROTOCOL, r).channels["torque"].values),
            RECORDED_HZ,
        )
        for r in range(1, fits.size.repetitions + 1)
    ]
    drawing = Drawing(
        "figure-40", "Figure 40: power spectra of one subject's repetitions",
        f"Subject {who.id}, torque of the multiple holds as recorded, Welch's method.",
        "Power spectral density of the torque of the repetitions of one subject.",
        spectra_figure(spectra),
    )  # fmt: skip
    frequency = spectra[0][0]
    band = (frequency >= 0.25) & (frequency <= 5.0)
    return drawing, [
        float(np.mean(np.abs(a[1][band] - b[1][band]))) for a, b in combinations(spectra, 2)
    ]


def spectrum(signal: FloatArray, rate_hz: float) -> tuple[FloatArray, FloatArray]:
    """Frequency [Hz] and power density (Welch, Hann windows of 8 s) of a signal, in dB."""
    from scipy.signal import welch

    n = min(int(_SEGMENT * rate_hz), len(signal))
    frequency, power = welch(signal - signal.mean(), rate_hz, nperseg=n)
    return frequency, 10.0 * np.log10(np.maximum(power, 1e-300))


def spectra_figure(spectra: Sequence[tuple[FloatArray, FloatArray]]) -> Figure:
    """Power densities of the torque of repetitions, in two panels: wide and near zero."""
    panels = []
    for highest, title in ((60.0, "Torque"), (8.0, "Its lowest frequencies")):
        lines = []
        for number, ((frequency, power), look) in enumerate(zip(spectra, _LOOKS, strict=False), 1):
            shown = (frequency <= highest) & (frequency > 0.0)
            lines.append(PlotLine(frequency[shown], power[shown], f"repetition {number}", look))
        panels.append(
            Panel("Power density [dB re 1 Nm²/Hz]", lines, "Frequency [Hz]", title,
                  {"xlim": (0.0, highest)})
        )  # fmt: skip
    return draw(panels, 3.6, columns=2, shared=3, width_ratios=(1.3, 1.0))
