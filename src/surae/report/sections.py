"""Sections of a report: correlations, starts, simulations, predictions, quality."""

from collections.abc import Sequence

import numpy as np

from surae.assessment import Assessment, Prediction, pooled
from surae.estimation import FitResult
from surae.formatting import NO_NUMBER, percentage, signed, significant
from surae.model.joint import ANKLE
from surae.report.document import (
    Block,
    PictureBlock,
    SectionBlock,
    TableBlock,
    TextBlock,
    columns,
    rows_of,
)

#: Correlation from which a pair of parameters is named.
_STRONG = 0.9
#: Pairs that are named at most.
_PAIRS = 6


def correlation_section(assessment: Assessment) -> SectionBlock:
    """The correlations of the estimates: the map, the strongest pairs and the IPDE."""
    names = assessment.covariance.names
    matrix = assessment.covariance.correlation
    k = len(names)
    ranked = sorted(
        ((float(matrix[i, j]), names[i], names[j]) for i in range(k) for j in range(i + 1, k)),
        key=lambda pair: -abs(pair[0]),
    )
    strong = [pair for pair in ranked if abs(pair[0]) >= _STRONG]
    pairs = [f"{a} – {b}: {signed(r, 3)}" for r, a, b in strong[:_PAIRS]]
    if len(strong) > _PAIRS:
        pairs.append(f"and {len(strong) - _PAIRS} more")
    ipde = NO_NUMBER
    if assessment.ipde is not None:
        ipde = (
            f"{significant(assessment.ipde, 3)} (0 if independent, at most "
            f"{significant((k * (k - 1) / 2) ** 0.5, 3)} for these {k} parameters)"
        )
    text = f"Inter-parameter dependency, IPDE, equation (35): {ipde}"
    text += f" – {assessment.ipde_note}." if assessment.ipde_note else "."
    if pairs:
        text += (
            f" Pairs from {_STRONG:g} up: {'; '.join(pairs)}. What such a pair does together is "
            "known better than what each does alone."
        )
    strongest = (
        f"; strongest {ranked[0][1]} with {ranked[0][2]} ({signed(ranked[0][0], 3)})"
        if ranked
        else ""
    )
    return SectionBlock(
        "Correlation of the estimates",
        (
            TextBlock(text),
            PictureBlock(
                "correlation",
                f"Heat map of the correlations of {k} estimated parameters{strongest}; the block "
                "of passive against active parameters is outlined.",
                "Normalised covariance. The darker, the stronger; a dark corner marks a negative "
                "one. The frame holds passive (rows) against active (columns) parameters.",
                "map",
                width=62,
            ),
        ),
        "correlation",
        "page",
    )


def geometry_section(result: FitResult) -> tuple[SectionBlock, ...]:
    """The geometry that a fit was given, beside the thesis's; nothing for those that have names."""
    table = result.problem.options.geometry
    if isinstance(table, str):
        return ()
    whose = "this person’s" if result.problem.settings.geometry_of == "person" else "a generic one"
    origin = f" ({table.source})" if table.source else ""
    text = f"Lengths and moment arms are those of {table.name}{origin}, {whose}."
    picture = PictureBlock(
        "geometry",
        "Moment arm and length of both muscle groups over the angle",
        "Moment arm and change of length over the angle: those given"
        + ", and those of the thesis." * (result.problem.options.anatomy == ANKLE),
    )
    return (SectionBlock("Geometry", (TextBlock(text), picture), "geometry"),)


def starts_section(result: FitResult) -> SectionBlock:
    """The starts in the order in which they were made: how each ended, and which agree."""
    order = sorted(range(len(result.starts)), key=lambda i: _finite(result.starts[i].sse))
    best = result.starts[order[0]].sse
    agreeing = set(order[: result.agreeing])
    first = (
        "the default start"
        if result.outliers is None
        else "the solution with the weights of the outliers"
    )
    if result.family is not None:
        text = (
            "The search looked from both valleys of the relaxation. Below are the solution and the "
            "other valleys that were met."
        )
    elif len(result.starts) > 1:
        text = (
            f"{result.agreeing} of {len(result.starts)} starts reach the best minimum. The first "
            f"is {first}, the others are random within the bounds."
        )
    else:
        text = f"Only {first} was tried: whether its minimum is the best one was not looked into."
    rows = (
        (
            str(index + 1),
            significant(start.sse, 6),
            _excess(start.sse, best),
            "yes" if index in agreeing else "no",
            str(start.iterations),
            start.outcome,
        )
        for index, start in enumerate(result.starts)
    )
    table = TableBlock(
        "Where each start ended",
        columns("Start", "Sum of squares [Nm²]", "Above the best", "Best minimum", "Evaluations",
                "Outcome", numbers=(1, 2, 4), wide=(5,)),
        rows_of(rows),
        "starts",
    )  # fmt: skip
    return SectionBlock("Starts", (TextBlock(text), table), "starts", "together")


def _finite(sse: float) -> float:
    return sse if np.isfinite(sse) else np.inf


def _excess(sse: float, best: float) -> str:
    """Write by which part a sum of squares exceeds the best one."""
    if not np.isfinite(sse) or best <= 0:
        return NO_NUMBER
    part = 100 * (sse / best - 1)
    if part == 0:
        return "best"
    return f"+{significant(part, 2)} %" if part >= 1e-4 else "< 0.0001 %"


#: VAF [%] that a prediction may lie below that of the fit before it is worth a word.
_FALL = 5.0


def predictions_section(
    assessment: Assessment, predictions: Sequence[Prediction]
) -> tuple[SectionBlock, ...]:
    """How other recordings are predicted: a row and a figure each; nothing where there are none."""
    if not predictions:
        return ()
    together = pooled(predictions)
    rows = [(p.name, p.vaf, p.rmse, p.bias) for p in predictions]
    if len(predictions) > 1:
        rows.append(("all together", together.vaf, together.rmse, together.bias))
    text = (
        f"With the parameters of this fit, {percentage(together.vaf)} % of the mean square of "
        f"torque that the fit has not seen is accounted for; of its own torque it was "
        f"{percentage(assessment.vaf)} %."
    )
    if assessment.vaf - together.vaf > _FALL:
        text += (
            " The parameters carry over only in part: they describe the recordings they were "
            "fitted to better than the leg."
        )
    table = TableBlock(
        "How well other recordings are predicted",
        columns("Recording", "VAF [%]", "RMSE [Nm]", "Bias [Nm]", numbers=(1, 2, 3), wide=(0,)),
        rows_of(
            (name, percentage(vaf), significant(rmse, 3), significant(bias, 3))
            for name, vaf, rmse, bias in rows
        ),
    )
    picture = PictureBlock(
        "predictions",
        "Measured and predicted torque of each recording against time.",
        "Torque measured (wide, pale) and predicted with the parameters of this fit (thin, dark).",
        width=85,
    )
    blocks: tuple[Block, ...] = (TextBlock(text), table, picture)
    return (SectionBlock("Predicting other recordings", blocks, "predictions", "page"),)
