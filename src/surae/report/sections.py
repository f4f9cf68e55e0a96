"""Sections of a report: correlations, geometry, predictions, and what the data separate."""

from collections.abc import Sequence
from statistics import median

from surae.base.formatting import NO_NUMBER, percentage, significant
from surae.base.normal import NORMAL
from surae.inference import AssessedFit, Assessment, FitResult, Prediction, Verdict, pooled
from surae.inference.identifiability.identified import Direction, Identified, identifiability
from surae.inference.judging.assessed import described, variance_inflation
from surae.inference.judging.verdict import IDENTIFIED
from surae.model.joint import ANKLE, Joint
from surae.report import block
from surae.report.beside import follows, of_movement


def correlation_section(assessment: Assessment) -> block.Section:
    """The correlations of the estimates: the map, and the IPDE."""
    k = len(assessment.covariance.names)
    ipde = NO_NUMBER
    if assessment.ipde is not None:
        most = significant((k * (k - 1) / 2) ** 0.5, 3)
        ipde = f"{significant(assessment.ipde, 3)} (0 if independent, at most {most})"
    note = f" – {assessment.ipde_note}" if assessment.ipde_note else ""
    text = (
        f"Inter-parameter dependency, IPDE, equation (35): {ipde}{note}. What a strongly "
        "correlated pair does together is known better than what each does alone."
    )
    picture = block.Picture(
        "correlation",
        f"Heat map of the correlations of {k} estimated parameters.",
        "Normalised covariance. The darker, the stronger.",
        "map",
        width=62,
    )
    title = "Correlation of the estimates"
    return block.Section(title, (block.Text(text), picture), "correlation", "page")


def geometry_section(result: FitResult) -> tuple[block.Section, ...]:
    """The geometry that a fit was given, beside the thesis's; nothing for those that have names."""
    table = result.problem.options.geometry
    if isinstance(table, str):
        return ()
    whose = "this person’s" if result.problem.settings.geometry_of == "person" else "a generic one"
    origin = f" ({table.source})" if table.source else ""
    text = f"Lengths and moment arms are those of {table.name}{origin}, {whose}."
    picture = block.Picture(
        "geometry",
        "Moment arm and length of both muscle groups over the angle",
        "Moment arm and change of length over the angle: those given"
        + ", and those of the thesis." * (result.problem.options.anatomy == ANKLE),
    )
    return (block.Section("Geometry", (block.Text(text), picture), "geometry"),)


#: VAF [%] that a prediction may lie below that of the fit before it is worth a word.
_FALL = 5.0


def predictions_section(
    assessment: Assessment, predictions: Sequence[Prediction], joint: Joint = ANKLE
) -> tuple[block.Section, ...]:
    """How other recordings are predicted: a row and a figure each; nothing where there are none."""
    if not predictions:
        return ()
    together = pooled(predictions)
    rows = [
        (p.name, p.vaf, p.baselines.template, p.baselines.ridge, p.rmse, p.bias)
        for p in predictions
    ]
    if len(predictions) > 1:
        rows.append(("all together", together.vaf, None, None, together.rmse, together.bias))
    text = (
        f"With the parameters of this fit, {percentage(together.vaf)} % of the mean square of "
        f"torque that the fit has not seen is accounted for; of its own torque it was "
        f"{percentage(assessment.vaf)} %."
    )
    if assessment.vaf - together.vaf > _FALL:
        text += (
            " The parameters carry over only in part: they describe the recordings they were "
            f"fitted to better than the {joint.body}."
        )
    for said in (of_movement(predictions), follows(predictions)):
        text += f" {said}" if said else ""
    table = block.Grid(
        "How well other recordings are predicted",
        block.columns(
            "Recording",
            "VAF [%]",
            "Mean of the others [%]",
            "Regression [%]",
            "RMSE [Nm]",
            "Bias [Nm]",
            numbers=(1, 2, 3, 4, 5),
            wide=(0,),
        ),
        block.rows(
            (
                name,
                *(NO_NUMBER if share is None else percentage(share) for share in shares),
                significant(rmse, 3),
                significant(bias, 3),
            )
            for name, *shares, rmse, bias in rows
        ),
    )
    picture = block.Picture(
        "predictions",
        "Measured and predicted torque of each recording against time.",
        "Torque measured (wide, pale) and predicted with the parameters of this fit (thin, dark).",
        width=85,
    )
    blocks: tuple[block.Block, ...] = (block.Text(text), table, picture)
    return (block.Section("Predicting other recordings", blocks, "predictions", "page"),)


#: Directions that are shown at most.
_DIRECTIONS = 6
#: Relative standard error from which a direction makes its parameters weak: about 1.96 of them are
#: the half-width of an interval.
_WEAK = IDENTIFIED / NORMAL
_NOTE = (
    "Combinations are eigenvectors of the information matrix, each parameter measured in its own "
    "value; the change is one standard error along them. Influence δ: root mean square change of "
    "the torque, as a part of the torque’s own, if the parameter changed by its own value and "
    "followed a straight line. SEM alone: relative standard error if all other parameters were "
    "known. Widened: by how much the others, estimated too, widen it. All take the residual for "
    "white noise."
)


def identifiability_section(fit: AssessedFit) -> block.Section:
    """Weak combinations, and what each parameter needs; verdicts are the assessment's."""
    title = "Which parameters this torque separates"
    inflation = median(variance_inflation(fit.assessment).values())
    identified = identifiability(fit.result, variance_inflation=inflation)
    if not identified.parameters:
        why = block.Text("The model gives no finite torque here.")
        return block.Section(title, (why,), "identifiability", "page")
    weak = [
        direction
        for direction in identified.directions
        if direction.uncertainty is None or direction.uncertainty > _WEAK
    ]
    shown = weak[:_DIRECTIONS] or list(identified.directions[:1])
    condition = "infinite" if identified.condition is None else significant(identified.condition, 2)
    of_fit = [p for p in identified.parameters.values() if p.name in fit.assessment.parameters]
    text = f"Condition number of the scaled information matrix: {condition}."
    if inflation != 1.0:
        noise = described({"all": inflation}, fit.assessment.interval_note)
        text += f" Standard errors here: {noise}."
    directions = block.Grid(
        "Combinations of parameters that are known least",
        block.columns(
            "Together",
            "Known to ±",
            "A change that this torque cannot show",
            numbers=(1,),
            wide=(0, 2),
        ),
        block.rows(map(_direction, shown)),
        "directions",
        titled=True,
    )
    sensitivity = block.Grid(
        "Influence of every estimated parameter, and what to do about those that are not "
        "identified",
        block.columns(
            "Parameter",
            "Influence δ",
            "SEM alone",
            "Widened ×",
            "Verdict",
            "What to do",
            numbers=(1, 2, 3),
            wide=(5,),
            looks={5: "why"},
        ),
        block.rows(_row(p, fit.assessment) for p in sorted(of_fit, key=lambda p: -p.sensitivity)),
        "sensitivity",
        titled=True,
    )
    return block.Section(
        title,
        (block.Text(text), directions, sensitivity, block.Text(_NOTE, "note")),
        "identifiability",
        "page",
    )


def _direction(direction: Direction) -> tuple[str, str, str]:
    """A weak combination: in words, its relative standard error, and what that means for each."""
    if direction.uncertainty is None:
        return direction.words, NO_NUMBER, NO_NUMBER
    changes = (
        f"{name} {'+' if part >= 0 else '−'}{_percent(abs(direction.uncertainty * part))}"
        for name, part in direction.changes.items()
    )
    return direction.words, _percent(direction.uncertainty), ", ".join(changes)


def _row(parameter: Identified, assessment: Assessment) -> tuple[block.AnyCell, ...]:
    """One parameter: influence, standard error if the others were known, and what widens it."""
    judged = assessment.parameters[parameter.name].verdict
    collinearity = parameter.collinearity
    return (
        block.Cell(parameter.name, kind="code"),
        significant(parameter.sensitivity, 2),
        NO_NUMBER if parameter.alone is None else _percent(parameter.alone),
        NO_NUMBER if collinearity is None else significant(collinearity, 2),
        block.verdict(judged),
        "" if judged is Verdict.IDENTIFIED else parameter.advice,
    )


def _percent(part: float) -> str:
    return f"{significant(100 * part, 2)}\u00a0%"
