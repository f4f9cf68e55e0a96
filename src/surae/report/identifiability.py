"""What the data tell apart, and what to do about the rest, as text."""

from dataclasses import dataclass

from surae.assessment import Assessment, Verdict
from surae.assessment.identifiability.collinearity import COLLINEAR
from surae.assessment.identifiability.directions import Direction
from surae.assessment.identifiability.identified import Identified, identifiability
from surae.assessment.inflation import described, variance_inflation
from surae.assessment.verdict import IDENTIFIED
from surae.estimation import FitResult
from surae.report.digits import NONE, significant

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
    """What the sensitivities say.

    Attributes
    ----------
    text : str
        Condition number and collinearity index in a sentence; why there is nothing else to say.
    directions : tuple of DirectionRow
        The weakest combinations.
    sets : tuple of str
        Collinear sets with their index.
    rows : tuple of SensitivityRow
        Estimated parameters, the most influential first.
    """

    text: str
    directions: tuple[DirectionRow, ...]
    sets: tuple[str, ...]
    rows: tuple[SensitivityRow, ...]


def identifiability_section(result: FitResult, assessment: Assessment) -> IdentifiabilitySection:
    """Describe weak combinations and what each parameter needs; verdicts are the assessment's."""
    inflation = variance_inflation(assessment)
    found = identifiability(result, variance_inflation=inflation.common)
    if not found.parameters:
        return IdentifiabilitySection("The model gives no finite torque here.", (), (), ())
    weak = [one for one in found.directions if one.uncertainty is None or one.uncertainty > _WEAK]
    shown = weak[:_DIRECTIONS] or list(found.directions[:1])
    sets = [
        f"{', '.join(names)} ({significant(gamma, 3) if gamma < float('inf') else '∞'})"
        for names, gamma in found.collinear[:_SETS]
    ]
    if len(found.collinear) > _SETS:
        sets.append(f"and {len(found.collinear) - _SETS} more")
    condition = "infinite" if found.condition is None else significant(found.condition, 2)
    gamma = "infinite" if found.gamma is None else significant(found.gamma, 3)
    ranked = sorted(found.parameters.values(), key=lambda one: one.rank)
    return IdentifiabilitySection(
        text=(
            f"Condition number of the scaled information matrix: {condition}. Collinearity index "
            f"of all parameters that are not at a bound: {gamma}; sets from {COLLINEAR:g} on are "
            "hardly told apart."
        )
        + _noise(inflation.common, inflation.reason),
        directions=tuple(_direction(one) for one in shown),
        sets=tuple(sets),
        rows=tuple(_row(one, assessment) for one in ranked),
    )


def _noise(factor: float, reason: str) -> str:
    """Why the standard errors of this section are wider than those of white noise."""
    if factor == 1.0:
        return ""
    return f" Standard errors here: {described({'all': factor}, reason)}."


def _direction(one: Direction) -> DirectionRow:
    scale = 1.0 if one.uncertainty is None else one.uncertainty
    changes = [f"{name} {_signed(scale * part)}" for name, part in one.changes.items()]
    return DirectionRow(
        words=one.words,
        uncertainty=NONE if one.uncertainty is None else _percent(one.uncertainty),
        changes=NONE if one.uncertainty is None else ", ".join(changes),
    )


def _row(one: Identified, assessment: Assessment) -> SensitivityRow:
    verdict = assessment.parameters[one.name].verdict
    return SensitivityRow(
        name=one.name,
        sensitivity=significant(one.sensitivity, 2),
        alone=NONE if one.alone is None else _percent(one.alone),
        collinearity=NONE if one.collinearity is None else significant(one.collinearity, 2),
        verdict=str(verdict),
        verdict_text=str(verdict).replace("-", " "),
        advice="" if verdict is Verdict.IDENTIFIED else one.advice,
    )


def _percent(part: float) -> str:
    return f"{significant(100 * part, 2)}\u00a0%"


def _signed(part: float) -> str:
    return f"{'+' if part >= 0 else '−'}{significant(abs(100 * part), 2)}\u00a0%"
