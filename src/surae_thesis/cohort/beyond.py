"""Section: beyond the thesis on the same cohort (4.4, 4.5): joint fits, tendons, intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    OCHRE,
    Figure,
    dress,
    heading,
    legend,
    new_figure,
)
from surae_thesis.claims import Claim, NotThereError, Ruling, judge_all
from surae_thesis.cohort import plan
from surae_thesis.cohort.boxes import EXPECTED, Box, BoxPanel, error_figure, vaf_figure
from surae_thesis.cohort.joint import JOINT, Way, ways
from surae_thesis.cohort.members import ACTIVE_PROTOCOL, PASSIVE_PROTOCOL
from surae_thesis.cohort.results import Fits, Point, thesis_fits
from surae_thesis.section import Context, Drawing, Result, Table

#: Our best way, and the ways that the figures compare it with.
BEST, RIGID, ELASTIC = "joint + tendons", "1.0 alone", "2.0 alone"
#: An estimate is right within this part of the truth (4.1), and precise below this standard error.
RIGHT, PRECISE = 0.10, 0.05
#: A fit as good as those of the thesis's simulations (2.7) [%].
IDEAL = 99.85
#: Parameters whose truth all ways share.
SHARED = ("m", "k_tri", "k_tib", "x0_tri", "x0_tib", "tau_rel", "k_rel", "l0_tri", "l0_tib", "f0",
          "beta")  # fmt: skip


@dataclass(frozen=True, slots=True)
class Numbers:
    """The thesis's fits, and every way to fit."""

    fits: Fits
    ways: Mapping[str, Way]


def run(context: Context) -> Result:
    """Fit the cohort our way and compare with the truth, and with the thesis's way."""
    fits = thesis_fits(context)
    numbers = Numbers(fits, ways(context, fits))
    return Result(
        findings=judge_all("beyond", {"": numbers}, __name__),
        insights=(_coverage(numbers),),
        figures=_drawings(numbers.ways),
        tables=(_ways_table(numbers.ways), _parameters_table(numbers.ways)),
        notes=_notes(fits, numbers.ways),
    )


def below_ideal(n: Numbers) -> Ruling:
    """Fits below the ideal VAF with a wrong parameter."""
    wrong, above = [], 0
    for model in ("1.0", "2.0"):
        for protocol in plan.ACTIVE:
            for _, _, fit in n.fits.of(model, protocol):
                if fit["vaf"] is None or fit["vaf"] >= IDEAL:
                    above += 1
                    continue
                errors = [
                    abs(p["value"] / p["true"] - 1.0)
                    for p in fit["parameters"].values()
                    if p["free"] and p["true"] is not None and p["value"] is not None
                ]
                wrong.append(sum(error > RIGHT for error in errors))
    if not wrong:
        raise NotThereError("No fit lies below 99.85 %.")
    share = float(np.mean([count > 0 for count in wrong]))
    return Ruling(
        share >= 0.95,
        f"{100 * share:.0f} % of {len(wrong)} fits; {np.median(wrong):.0f} of {len(SHARED)} "
        f"parameters are (median); {above} fits reach 99.85 %",
    )


def low_sem(n: Numbers) -> Ruling:
    """Wrong estimates among those with a low SEM."""
    precise = [
        estimate.error
        for name in (RIGID, ELASTIC)
        for estimate in n.ways[name].estimates
        if estimate.sem is not None and estimate.sem < PRECISE * abs(estimate.value)
    ]
    if not precise:
        raise NotThereError("No estimate has so low a SEM.")
    share = float(np.mean(np.array(precise) > RIGHT))
    return Ruling(share > 0.10, f"{100 * share:.0f} % of {len(precise)} estimates")


def _coverage(n: Numbers) -> str:
    white, count = n.ways[ELASTIC].covered("white")
    trusted, _ = n.ways[ELASTIC].covered("trusted")
    best, best_count = n.ways[BEST].covered("trusted")
    return (
        "A low SEM is not a right estimate: against the truth of the cohort the 95 % intervals of "
        f"equation (34) hold {100 * white:.0f} % of {count} estimates of model 2.0 alone, ours "
        f"{100 * trusted:.0f} %; of the joint fit with free tendons ours {100 * best:.0f} % of "
        f"{best_count}. What is left is bias of the models."
    )


def several(n: Numbers) -> Ruling:
    """What free tendon parameters add to the VAF, and whether one start suffices."""
    free, fixed = n.ways[BEST], n.ways["joint 2.0"]
    gain = float(np.median(free.vaf) - np.median(fixed.vaf))
    return Ruling(
        gain > 0.0 and free.first_start >= 0.9,
        f"{gain:+.2f} points (median); default start suffices in {100 * free.first_start:.0f} %",
    )


def errors_of_several(n: Numbers, _: Claim) -> str:
    """What they do to the estimates."""
    fixed, free = (
        100 * float(np.median(n.ways[name].errors(SHARED))) for name in ("joint 2.0", BEST)
    )
    strain = 100 * float(np.median(n.ways[BEST].errors(("dlt_tri",))))
    return (
        f"The triceps' ε0 is {strain:.0f} % off (median); the error of the shared parameters goes "
        f"from {fixed:.0f} to {free:.0f} %."
    )


def equally_good(n: Numbers) -> Ruling:
    """Median errors of 1.0 and 2.1."""
    rigid, elastic = (
        float(np.median(n.ways[name].errors(SHARED))) for name in (RIGID, "2.1 alone")
    )
    text = f"{100 * rigid:.0f} % (1.0) and {100 * elastic:.0f} % (2.1)"
    return Ruling(abs(elastic / rigid - 1.0) < 0.25, text)


def errors_of_length(n: Numbers, _: Claim) -> str:
    """Errors of the triceps's optimal length."""
    lengths = [
        f"{100 * float(np.median(n.ways[name].errors(('l0_tri',)))):.0f} % by {name}"
        for name in (RIGID, "2.1 alone", BEST)
    ]
    return (
        "VAF alone cannot see it. l0_tri, which the clinic asks for, is off (medians): "
        f"{', '.join(lengths)}."
    )


_LOOKS: tuple[dict[str, Any], ...] = (
    {"facecolor": "white", "edgecolor": INK},
    {"facecolor": GREY, "edgecolor": INK},
    {"facecolor": OCHRE, "edgecolor": INK, "hatch": "///"},
    {"facecolor": BLUE, "edgecolor": INK},
)


def _drawings(ways: Mapping[str, Way]) -> tuple[Drawing, ...]:
    names = (*SHARED, "dlt_tri", "pt_tri")
    errors = {
        way: {name: 100.0 * ways[way].errors((name,)) for name in names}
        for way in (RIGID, ELASTIC, "joint 1.0", BEST)
    }
    several = list(ways.values())
    return (
        Drawing("beyond-errors", "Parameter errors against the truth",
            "Relative error of every subject's parameters that the generating leg has too, by the "
            "thesis's way (one recording of the multiple holds) and ours (recordings together, "
            "tendon parameters free). Boxes: 25th to 75th percentile; dashed: 10 %.",
            "Box plots of relative parameter errors for four ways to fit.",
            error_figure(errors, _LOOKS)),
        Drawing("beyond-coverage", "Intervals that hold the truth",
            "Share of nominal 95 % intervals that hold the truth: of equation (34), and ours, "
            "which notice that residuals are correlated; estimates at a bound have none.",
            "Bars of the share of intervals that hold the truth, for every way to fit.",
            _coverage_figure(several)),
        Drawing("beyond-held-out", "Held-out torque",
            "VAF of the last repetition, which none of the fits has seen.",
            "Box plots of the VAF of a held-out repetition for every way to fit.",
            vaf_figure([_held_out(several, ACTIVE_PROTOCOL, "Multiple holds"),
                        _held_out(several, PASSIVE_PROTOCOL, "Ramp and hold")], (),
                       "Held-out VAF [%]")),
    )  # fmt: skip


def _coverage_figure(ways: Sequence[Way]) -> Figure:
    """Bars of the share of intervals that hold the truth, two for each way."""
    figure = new_figure(3.4)
    axes = figure.subplots()
    dress(axes, "Intervals that hold the truth [%]")
    axes.axhline(95.0, **EXPECTED)
    for shift, kind, label, look in (
        (-0.2, "white", "equation (34)", _LOOKS[0] | {"hatch": "///"}),
        (0.2, "trusted", "ours", _LOOKS[3]),
    ):
        shares = [100 * way.covered(kind)[0] for way in ways]
        bars = axes.bar(np.arange(len(ways)) + shift, shares, 0.36, label=label, **look)
        axes.bar_label(bars, fmt=lambda share: f"{share:.0f}", fontsize=8, color=INK)
    axes.set_ylim(0.0, 104.0)
    axes.grid(visible=False, axis="x")
    axes.set_xticks(range(len(ways)), [way.name for way in ways], fontsize=8)
    legend(axes, 2)
    heading(axes, "Dashed: 95 %, what they claim")
    return figure


def _held_out(ways: Sequence[Way], protocol: str, title: str) -> BoxPanel:
    boxes = [
        Box(way.name.replace(" ", "\n", 1),
            [Point(subject, 0, value) for subject, value in way.held_out.get(protocol, ())])
        for way in ways
    ]  # fmt: skip
    shown = [point.value for box in boxes for point in box.points] or [50.0]
    return BoxPanel(title, boxes, max(5.0 * float(np.floor(np.percentile(shown, 5) / 5.0)), 0.0))


def _ways_table(ways: Mapping[str, Way]) -> Table:
    rows = []
    for name, way in ways.items():
        errors = way.errors(SHARED)
        white, trusted = way.covered("white"), way.covered("trusted")
        held_out = [
            float(np.median([v for _, v in way.held_out[p]])) if p in way.held_out else None
            for p in (ACTIVE_PROTOCOL, PASSIVE_PROTOCOL)
        ]
        rows.append(
            (name, round(float(np.median(way.vaf)), 2),
             *(None if value is None else round(value, 2) for value in held_out),
             round(100 * float(np.median(errors)), 1),
             round(100 * float(np.mean(errors <= RIGHT)), 1),
             round(100 * white[0], 1) if white[1] else None,
             round(100 * trusted[0], 1) if trusted[1] else None, trusted[1],
             round(100 * way.first_start, 1))
        )  # fmt: skip
    return Table(
        name="beyond-ways",
        title="Ways to fit the cohort, medians over subjects",
        columns=(
            "way", "VAF of the fit [%]", "held-out multiple holds [%]",
            "held-out ramp and hold [%]", "error of shared parameters [%]", "within 10 % [%]",
            "truth in interval (34) [%]", "truth in our interval [%]", "intervals",
            "default start suffices [%]",
        ),
        rows=tuple(rows),
    )  # fmt: skip


def _parameters_table(ways: Mapping[str, Way]) -> Table:
    names = [*SHARED, "dlt_tri", "dlt_tib", "pt_tri"]

    def cell(way: Way, name: str) -> float | None:
        errors = way.errors((name,))
        return round(100 * float(np.median(errors)), 1) if len(errors) else None

    return Table(
        name="beyond-parameters",
        title="Median relative error against the truth [%]; empty: not estimated",
        columns=("parameter", *ways),
        rows=tuple((name, *(cell(way, name) for way in ways.values())) for name in names),
    )


def _notes(fits: Fits, ways: Mapping[str, Way]) -> tuple[str, ...]:
    last = fits.size.repetitions
    held_out = ways[BEST].held_out[ACTIVE_PROTOCOL]
    thesis = dict(ways[RIGID].held_out.get(ACTIVE_PROTOCOL, ()))
    gain = [value - thesis[subject] for subject, value in held_out if subject in thesis]
    taken = "repetition 1" if last == 2 else f"repetitions 1 to {last - 1}"
    gained = f" ({np.median(gain):+.2f} points in the median against 1.0 alone)" if gain else ""
    return (
        f"Joint fits take {taken} of all protocols that a subject completed, "
        f"with shared parameters, and predict repetition {last}{gained}. Freed are, in turn, none, "
        "the triceps' ε0, and ε0 of both muscles with the triceps' toe force. The thesis's way is "
        "one recording, repetition 1 of the multiple holds.",
        "Truth exists for what the fitted model shares with the generating leg. EMG weights are "
        "left out: crosstalk and muscles without electrodes are part of what a weight stands for. "
        f"{len(JOINT)} joint fits for each of {len(fits.members)} subjects.",
    )
