"""Which parameters the data separate, and what to do about the rest, as text."""

from surae.assessment import Assessment, Verdict
from surae.assessment.assess import described, variance_inflation
from surae.assessment.identifiability.directions import COLLINEAR, Direction
from surae.assessment.identifiability.identified import Identified, identifiability
from surae.assessment.parameter import IDENTIFIED
from surae.estimation import FitResult
from surae.formatting import NO_NUMBER, significant
from surae.normal import NORMAL
from surae.report.document import (
    AnyCell,
    SectionBlock,
    TableBlock,
    TableCell,
    TextBlock,
    columns,
    rows_of,
    verdict,
)

#: Directions and collinear sets that are shown at most.
_DIRECTIONS, _SETS = 6, 6
#: Relative standard error from which a direction makes its parameters weak: about 1.96 of them are
#: the half-width of an interval.
_WEAK = IDENTIFIED / NORMAL
_NOTE = (
    "Combinations are eigenvectors of the information matrix, each parameter measured in its own "
    "value; the change is one standard error along them. Influence δ: root mean square change of "
    "the torque, as a part of the torque’s own, if the parameter changed by its own value and "
    "followed a straight line. SEM alone: relative standard error if all other parameters were "
    "known. Widened: by how much the others, estimated too, widen it. All take the residual for "
    "white noise. Collinearity index: Brun, Reichert and Künsch (2001)."
)


def identifiability_section(result: FitResult, assessment: Assessment) -> SectionBlock:
    """Weak combinations, and what each parameter needs; verdicts are the assessment's."""
    title, inflation = "Which parameters this torque separates", variance_inflation(assessment)
    identified = identifiability(result, variance_inflation=inflation.common)
    if not identified.parameters:
        why = TextBlock("The model gives no finite torque here.")
        return SectionBlock(title, (why,), "identifiability", "page")
    weak = [
        direction
        for direction in identified.directions
        if direction.uncertainty is None or direction.uncertainty > _WEAK
    ]
    shown = weak[:_DIRECTIONS] or list(identified.directions[:1])
    sets = [
        f"{', '.join(names)} ({significant(gamma, 3) if gamma < float('inf') else '∞'})"
        for names, gamma in identified.collinear[:_SETS]
    ]
    if len(identified.collinear) > _SETS:
        sets.append(f"and {len(identified.collinear) - _SETS} more")
    condition = "infinite" if identified.condition is None else significant(identified.condition, 2)
    gamma = "infinite" if identified.gamma is None else significant(identified.gamma, 3)
    own = [p for p in identified.parameters.values() if p.name in assessment.parameters]
    text = (
        f"Condition number of the scaled information matrix: {condition}. Collinearity index "
        f"of all parameters that are not at a bound: {gamma}; sets from {COLLINEAR:g} on are "
        "nearly collinear."
    )
    text += _noise(inflation.common, inflation.reason)
    text += f" Smallest such sets: {'; '.join(sets)}." if sets else ""
    directions = TableBlock(
        "Combinations of parameters that are known least",
        columns("Together", "Known to ±", "A change that this torque cannot show", numbers=(1,),
                wide=(0, 2)),
        rows_of(map(_direction, shown)),
        "directions",
        titled=True,
    )  # fmt: skip
    sensitivity = TableBlock(
        "Influence of every estimated parameter, and what to do about those that are not "
        "identified",
        columns("Parameter", "Influence δ", "SEM alone", "Widened ×", "Verdict", "What to do",
                numbers=(1, 2, 3), wide=(5,), looks={5: "why"}),
        rows_of(_row(p, assessment) for p in sorted(own, key=lambda p: p.rank)),
        "sensitivity",
        titled=True,
    )  # fmt: skip
    return SectionBlock(
        title,
        (TextBlock(text), directions, sensitivity, TextBlock(_NOTE, "note")),
        "identifiability",
        "page",
    )


def _noise(factor: float, reason: str) -> str:
    """Why the standard errors of this section are wider than those of white noise."""
    if factor == 1.0:
        return ""
    return f" Standard errors here: {described({'all': factor}, reason)}."


def _direction(direction: Direction) -> tuple[str, str, str]:
    """A weak combination: in words, its relative standard error, and what that means for each."""
    if direction.uncertainty is None:
        return direction.words, NO_NUMBER, NO_NUMBER
    changes = (
        f"{name} {'+' if part >= 0 else '−'}{_percent(abs(direction.uncertainty * part))}"
        for name, part in direction.changes.items()
    )
    return direction.words, _percent(direction.uncertainty), ", ".join(changes)


def _row(parameter: Identified, assessment: Assessment) -> tuple[AnyCell, ...]:
    """One parameter: influence, standard error if the others were known, and what widens it."""
    judged = assessment.parameters[parameter.name].verdict
    collinearity = parameter.collinearity
    return (
        TableCell(parameter.name, kind="code"),
        significant(parameter.sensitivity, 2),
        NO_NUMBER if parameter.alone is None else _percent(parameter.alone),
        NO_NUMBER if collinearity is None else significant(collinearity, 2),
        verdict(judged),
        "" if judged is Verdict.IDENTIFIED else parameter.advice,
    )


def _percent(part: float) -> str:
    return f"{significant(100 * part, 2)}\u00a0%"
