"""What the data tell apart, and what to do about the rest, as text."""

from dataclasses import dataclass

from surae.assessment import Assessment, Verdict
from surae.assessment.assess import described, variance_inflation
from surae.assessment.identifiability.directions import COLLINEAR, Direction
from surae.assessment.identifiability.identified import Identified, identifiability
from surae.assessment.parameter import IDENTIFIED
from surae.estimation import FitResult
from surae.report.formatting import NO_NUMBER, significant

#: Directions and collinear sets that are shown at most.
_DIRECTIONS, _SETS = 6, 6
#: Relative standard error from which a direction makes its parameters weak: about 1.96 of them are
#: the half-width of an interval.
_WEAK = IDENTIFIED / 1.96


@dataclass(frozen=True, slots=True)
class DirectionRow:
    """A weak combination: in words, its relative standard error, and what that means for each."""

    words: str
    uncertainty: str
    changes: str


@dataclass(frozen=True, slots=True)
class SensitivityRow:
    """One parameter: influence, standard error if the others were known, and what widens it."""

    name: str
    sensitivity: str
    alone: str
    collinearity: str
    verdict: str
    verdict_text: str
    advice: str


@dataclass(frozen=True, slots=True)
class IdentifiabilitySection:
    """What the sensitivities say."""

    #: Condition number and collinearity index in a sentence; why there is nothing else to say.
    text: str
    directions: tuple[DirectionRow, ...]  #: The weakest combinations.
    sets: tuple[str, ...]  #: Collinear sets with their index.
    rows: tuple[SensitivityRow, ...]  #: Estimated parameters, the most influential first.


def identifiability_section(result: FitResult, assessment: Assessment) -> IdentifiabilitySection:
    """Describe weak combinations and what each parameter needs; verdicts are the assessment's."""
    inflation = variance_inflation(assessment)
    identified = identifiability(result, variance_inflation=inflation.common)
    if not identified.parameters:
        return IdentifiabilitySection("The model gives no finite torque here.", (), (), ())
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
    ranked = sorted(own, key=lambda parameter: parameter.rank)
    return IdentifiabilitySection(
        text=(
            f"Condition number of the scaled information matrix: {condition}. Collinearity index "
            f"of all parameters that are not at a bound: {gamma}; sets from {COLLINEAR:g} on are "
            "hardly told apart."
        )
        + _noise(inflation.common, inflation.reason),
        directions=tuple(_direction(direction) for direction in shown),
        sets=tuple(sets),
        rows=tuple(_row(parameter, assessment) for parameter in ranked),
    )


def _noise(factor: float, reason: str) -> str:
    """Why the standard errors of this section are wider than those of white noise."""
    if factor == 1.0:
        return ""
    return f" Standard errors here: {described({'all': factor}, reason)}."


def _direction(direction: Direction) -> DirectionRow:
    scale = 1.0 if direction.uncertainty is None else direction.uncertainty
    changes = [f"{name} {_signed(scale * part)}" for name, part in direction.changes.items()]
    return DirectionRow(
        words=direction.words,
        uncertainty=NO_NUMBER if direction.uncertainty is None else _percent(direction.uncertainty),
        changes=NO_NUMBER if direction.uncertainty is None else ", ".join(changes),
    )


def _row(parameter: Identified, assessment: Assessment) -> SensitivityRow:
    verdict = assessment.parameters[parameter.name].verdict
    return SensitivityRow(
        name=parameter.name,
        sensitivity=significant(parameter.sensitivity, 2),
        alone=NO_NUMBER if parameter.alone is None else _percent(parameter.alone),
        collinearity=NO_NUMBER
        if parameter.collinearity is None
        else significant(parameter.collinearity, 2),
        verdict=str(verdict),
        verdict_text=str(verdict).replace("-", " "),
        advice="" if verdict is Verdict.IDENTIFIED else parameter.advice,
    )


def _percent(part: float) -> str:
    return f"{significant(100 * part, 2)}\u00a0%"


def _signed(part: float) -> str:
    return f"{'+' if part >= 0 else '−'}{significant(abs(100 * part), 2)}\u00a0%"
