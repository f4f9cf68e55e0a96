"""The figures of the cohort: one function for each kind, with the captions."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from surae.report.figures import correlation_figure, torque_figure, traces_of
from surae.units import FloatArray
from surae_thesis.cohort import plan, work
from surae_thesis.cohort.boxes import Box, Panel, snsem_figure, vaf_figure
from surae_thesis.cohort.claims import ACTIVE, PASSIVE, thesis_mean
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    FAST_PROTOCOL,
    PASSIVE_PROTOCOL,
    CohortSubject,
)
from surae_thesis.cohort.panels import prediction_panels, spectra_figure, spectrum
from surae_thesis.cohort.results import Fits, onto_passive, validation
from surae_thesis.cohort.trials import RECORDED_HZ, cohort_inputs, cohort_recording
from surae_thesis.section import Drawing

_SHORT = {PASSIVE_PROTOCOL: "ramp and hold", ACTIVE_PROTOCOL: "multiple\nholds",
          FAST_PROTOCOL: "multi-sine\nwith holds"}  # fmt: skip
_BOXES = (
    "Boxes: 25th to 75th percentile, whiskers to 1.5 times their distance, every recording a dot. "
    "Triangles: the thesis's means."
)


def noted(fits: Fits) -> list[str]:
    """Subjects whose knee moves or whose ankle is misaligned."""
    return [member.id for member in fits.members if member.remarks]


def example(fits: Fits) -> tuple[int, CohortSubject]:
    """Number and data of the subject of the example figures: the first of whom nothing was noted.

    Of those who completed all three protocols, if there is one.
    """
    members = list(enumerate(fits.members))
    return next(
        (one for one in members if len(one[1].completed) == 3 and not one[1].remarks),
        next((one for one in members if len(one[1].completed) == 3), members[0]),
    )


def vaf_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 17, 23, 29, 30, 32 and 35."""
    for name, model in (("figure-17", "1.0"), ("figure-23", "2.0")):
        panels = [
            Panel("Passive", [_fit_box(fits, model, PASSIVE_PROTOCOL, "ramp and\nhold")], 90.0),
            Panel(
                "Active",
                [_fit_box(fits, model, p, _SHORT[p]) for p in plan.ACTIVE], 75.0,
            ),
        ]  # fmt: skip
        yield Drawing(
            name=name,
            title=f"{name.title().replace('-', ' ')}: VAF of model {model}",
            caption=f"VAF of fits of model {model} to one recording each. {_BOXES}",
            alt=f"Box plots of the VAF of model {model} on three protocols.",
            figure=vaf_figure(panels, noted(fits)),
        )
    yield Drawing(
        name="figure-29",
        title="Figure 29: VAF of repetitions that were predicted",
        caption="Parameters from repetition 1 predict the other repetitions of the same protocol. "
        + _BOXES,
        alt="Box plots of the VAF of predicted repetitions for models 1.0 and 2.0.",
        figure=vaf_figure(
            [
                Panel(
                    f"Model {model}",
                    [
                        Box(_SHORT[p], validation(fits, model, p),
                            thesis_mean("validation", model, p))
                        for p in plan.ACTIVE
                    ],
                    50.0,
                )
                for model in ("1.0", "2.0")
            ],
            noted(fits), "Validation VAF [%]",
        ),
    )  # fmt: skip
    yield Drawing(
        name="figure-30",
        title="Figure 30: the ramp and hold, predicted from the multiple holds",
        caption="Parameters from the active multiple holds, repetition 1, predict the passive ramp "
        "and hold. " + _BOXES,
        alt="Box plots of the VAF of the predicted ramp and hold for models 1.0 and 2.0.",
        figure=vaf_figure(
            [
                Panel(
                    "Ramp and hold",
                    [
                        Box(f"model {m}", onto_passive(fits, m),
                            thesis_mean("onto", m, PASSIVE_PROTOCOL))
                        for m in ("1.0", "2.0")
                    ],
                    65.0,
                )
            ],
            noted(fits), "Validation VAF [%]",
        ),
    )  # fmt: skip
    if not {"2.1", "2.2"} <= set(fits.size.models):
        return
    names = {"2.1": "strain\nfactor [2.1]", "2.2": "toe\nforce [2.2]"}
    for name, kind, low, what in (
        ("figure-32", "fit", 75.0, "VAF of fits with a free tendon parameter"),
        ("figure-35", "validation", 50.0, "VAF of repetitions predicted with it"),
    ):
        boxes = [
            Box(
                text,
                fits.vaf(m, ACTIVE_PROTOCOL)
                if kind == "fit"
                else validation(fits, m, ACTIVE_PROTOCOL),
                thesis_mean(kind, m, ACTIVE_PROTOCOL),
            )
            for m, text in names.items()
        ]
        yield Drawing(
            name=name,
            title=f"{name.title().replace('-', ' ')}: {what}",
            caption=f"Multiple holds, models 2.1 and 2.2: {what}. {_BOXES}",
            alt=f"Box plots: {what}, for models 2.1 and 2.2.",
            figure=vaf_figure([Panel("Multiple holds", boxes, low)], noted(fits)),
        )


def _fit_box(fits: Fits, model: str, protocol: str, label: str) -> Box:
    return Box(label, fits.vaf(model, protocol), thesis_mean("fit", model, protocol))


def explicit_drawing(fits: Fits, explicit: Fits) -> Drawing:
    """Model 2.0 by both integrators."""
    first = {p: [one for one in fits.vaf("2.0", p) if one.repetition == 1] for p in _SHORT}
    panels = [
        Panel(title, [Box(_SHORT[p], found[p], thesis_mean("fit", "2.0", p)) for p in _SHORT], 70.0)
        for title, found in (
            ("Implicit (ours)", first),
            ("Explicit Euler, 1000 Hz (thesis)", {p: explicit.vaf("2.0", p) for p in _SHORT}),
        )
    ]
    return Drawing(
        name="figure-23-integrator",
        title="Model 2.0, the same recordings by two integrators",
        caption="VAF of fits of model 2.0 to repetition 1: implicit integration of the tendon, and "
        f"the thesis's explicit one at the thesis's rate. {_BOXES}",
        alt="Box plots of the VAF of model 2.0 for two integrators on three protocols.",
        figure=vaf_figure(panels, noted(fits)),
    )


def snsem_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 21, 22, 26, 27, 33 and 34."""
    for number, model, protocol in (
        (21, "1.0", ACTIVE_PROTOCOL), (22, "1.0", FAST_PROTOCOL),
        (26, "2.0", ACTIVE_PROTOCOL), (27, "2.0", FAST_PROTOCOL),
        (33, "2.1", ACTIVE_PROTOCOL), (34, "2.2", ACTIVE_PROTOCOL),
    ):  # fmt: skip
        if model not in fits.size.models:
            continue
        found = fits.snsem(model, protocol)
        fitted = sum(1 for _ in fits.of(model, protocol))
        what = _SHORT[protocol].replace("\n", " ")
        yield Drawing(
            name=f"figure-{number}",
            title=f"Figure {number}: snSEM of model {model}, {what}",
            caption=f"Standard error, equation (34), of every recording of the {what} over the "
            f"mean of {fits.size.baseline} simulated subjects at the same rate. Logarithmic, "
            "unlike the thesis's axis.",
            alt=f"Box plots of the snSEM of the parameters of model {model}, {what}.",
            figure=snsem_figure(found, {n: fitted - len(several) for n, several in found.items()}),
        )


def trace_drawings(fits: Fits) -> Iterator[Drawing]:
    """Figures 18 to 20, 24, 25 and 28: one subject's fits; 31: a prediction."""
    number, who = example(fits)
    for figure, model, protocol in (
        (18, "1.0", PASSIVE_PROTOCOL), (19, "1.0", ACTIVE_PROTOCOL), (20, "1.0", FAST_PROTOCOL),
        (24, "2.0", PASSIVE_PROTOCOL), (25, "2.0", ACTIVE_PROTOCOL),
    ):  # fmt: skip
        if protocol not in who.completed:
            continue
        settings = plan.fit_settings(fits.size, number, [(protocol, 1)], model)
        fit = work.fitted(**settings)
        what = f"model {model}, {_SHORT[protocol].replace(chr(10), ' ')}"
        yield Drawing(
            name=f"figure-{figure}",
            title=f"Figure {figure}: torque of {what}",
            caption=f"Subject {who.id}, repetition 1, {what}: EMG, angle, torque and its parts. "
            f"VAF {fit.vaf:.2f} %.",
            alt=f"EMG, angle, measured and modelled torque and its parts; {what}.",
            figure=torque_figure(traces_of(fit.result)[0]),
        )
        if figure == 19:
            passive = cohort_inputs(who, PASSIVE_PROTOCOL, 1, rate_hz=fits.size.rate_hz)
            prediction = fit.predict(passive)
            yield Drawing(
                name="figure-31",
                title="Figure 31: a ramp and hold, predicted from the multiple holds",
                caption=f"Subject {who.id}, model 1.0: parameters from the active multiple holds, "
                f"torque of the passive ramp and hold. VAF {prediction.vaf:.1f} %.",
                alt="Angle, and measured and predicted torque, of a ramp and hold.",
                figure=prediction_panels(
                    prediction.time, passive.angle, prediction.measured, prediction.torque
                ),
            )
        if figure == 25:
            covariance = fit.covariance
            yield Drawing(
                name="figure-28",
                title="Figure 28: correlations of the estimates of model 2.0",
                caption=f"Subject {who.id}, multiple holds, the fit of Figure 25. Outlined: "
                "passive against active parameters. Parameters at a bound have no covariance.",
                alt="Heat map of the correlations of the estimates of model 2.0.",
                figure=correlation_figure(
                    covariance.names, covariance.correlation, PASSIVE, ACTIVE
                ),
            )


def spectra_drawing(fits: Fits) -> tuple[Drawing, list[float]]:
    """Figure 40, and the mean absolute difference of each pair of repetitions [dB]."""
    _, who = example(fits)
    torques = [
        np.asarray(cohort_recording(who, ACTIVE_PROTOCOL, repetition).channels["torque"].values)
        for repetition in range(1, fits.size.repetitions + 1)
    ]
    drawing = Drawing(
        name="figure-40",
        title="Figure 40: power spectra of one subject's repetitions",
        caption=f"Subject {who.id}, torque of the multiple holds as recorded, Welch's method.",
        alt="Power spectral density of the torque of the repetitions of one subject.",
        figure=spectra_figure(torques, RECORDED_HZ),
    )
    return drawing, _apart(torques)


def _apart(torques: Sequence[FloatArray]) -> list[float]:
    spectra = [spectrum(one, RECORDED_HZ) for one in torques]
    frequency = spectra[0][0]
    band = (frequency >= 0.25) & (frequency <= 5.0)
    return [float(np.mean(np.abs(a[1][band] - b[1][band]))) for a, b in combinations(spectra, 2)]
