"""Which parameters the data tell, which trade off, and what would tell them apart."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from surae.assessment.identifiability.advice import trade_off
from surae.assessment.identifiability.directions import (
    SINGULAR,
    Direction,
    collinear_sets,
    directions,
    index,
    listed,
    unexplained,
    unit_columns,
)
from surae.assessment.parameter import IDENTIFIED
from surae.assessment.uncertainty.covariance import half_width
from surae.estimation import FitResult
from surae.frozen import read_only
from surae.model.registry import PARAMETERS
from surae.units import FloatArray

#: Correlation from which a parameter is a partner, and partners at most.
_PARTNER, _PARTNERS = 0.7, 3
#: Widening from which several together count as partners, and how close they come to all others.
_TOGETHER, _MOSTLY = 3.0, 2.0
#: Share of a singular direction, squared, from which a parameter takes part in it.
_SHARE = 1e-4
#: Least size of a parameter, as a part of its bounds' distance, for what is relative to it.
_LEAST = 0.01


class Cause(StrEnum):
    """Why a parameter is known, or is not."""

    CLEAR = "clear"
    INSENSITIVE = "insensitive"
    TRADE_OFF = "trade-off"
    SILENT = "silent"
    BOUND = "at-bound"


@dataclass(frozen=True, slots=True)
class Identified:
    """How well one estimated parameter is determined, and by what it is not."""

    name: str  #: The parameter.
    #: δ_msqr of Brun et al. (2001): root mean square change of the torque for a change of the
    #: parameter by its own value, as a part of the torque's own root mean square.
    sensitivity: float
    rank: int  #: 1 for the greatest sensitivity.
    #: Relative standard error if all others were known; None without influence.
    alone: float | None
    #: By how much the estimation of the others widens it; None where they give the same torque.
    collinearity: float | None
    uncertainty: float | None  #: Relative standard error, the product of the two.
    partners: tuple[str, ...]  #: Parameters it trades off with, strongest first.
    cause: Cause  #: Why it is, or is not, known to within the limit of an identified parameter.
    advice: str  #: What to do to know it, or to know it better, in one sentence.


@dataclass(frozen=True, slots=True)
class Identifiability:
    """What the sensitivities at the estimate say of every parameter."""

    names: tuple[str, ...]  #: Estimated parameters that do not lie at a bound.
    directions: tuple[Direction, ...]  #: All of them, the weakest first.
    condition: float | None  #: Of the scaled information matrix; None where it is singular.
    #: Collinearity index of all parameters together; None where it is infinite.
    gamma: float | None
    #: Smallest sets that are collinear, with their index (infinite for the same torque).
    collinear: tuple[tuple[tuple[str, ...], float], ...]
    parameters: Mapping[str, Identified]  #: Every estimated parameter.
    #: Triangular factor of the sensitivities, columns of length 1, in the order of `names`, shape
    #: (k, k).
    columns: FloatArray

    def collinearity(self, *names: str) -> float:
        """γ_K of some of the parameters; infinite where they give the same torque."""
        return index(self.columns[:, [self.names.index(name) for name in names]])


def identifiability(result: FitResult, *, variance_inflation: float = 1.0) -> Identifiability:
    """Examine the Jacobian at the estimate.

    Parameters at a bound are taken as known; priors count as data. `variance_inflation` is by how
    much the variance of the noise counts more than that of white noise would. All is empty where
    the model gave no finite torque.
    """
    problem = result.problem
    inside = [j for j, name in enumerate(problem.free) if name not in result.at_bound]
    names = tuple(problem.free[j] for j in inside)
    if not (np.isfinite(result.sse) and np.isfinite(result.R).all()):
        return Identifiability((), (), None, None, (), {}, read_only(np.empty((0, 0))))
    dof = problem.n - len(inside)
    sigma = float(np.sqrt(variance_inflation * result.sse / dof))
    sizes = np.maximum(
        np.abs([result.values[name] for name in problem.free]),
        _LEAST * (problem.upper - problem.lower),
    )
    scaled = result.R * sizes
    effects = np.linalg.norm(scaled, axis=0)
    R, length = scaled[:, inside], effects[inside]
    weakest = directions(names, R, length, sigma) if inside else ()
    unit = unit_columns(R)
    gamma = index(unit) if inside else np.inf
    least, most = (weakest[0], weakest[-1]) if inside else (None, None)
    condition = None
    if least is not None and most is not None and least.uncertainty is not None:
        condition = most.eigenvalue / least.eigenvalue
    links = _links(unit)
    order = np.argsort(-effects, kind="stable").tolist()
    torque = _torque_rms(result)
    parameters = {}
    for j, name in enumerate(problem.free):
        column = inside.index(j) if j in inside else None
        parameters[name] = _identified(
            name,
            sensitivity=float(effects[j]) / (torque * problem.n**0.5) if torque else 0.0,
            rank=order.index(j) + 1,
            alone=sigma / float(effects[j]) if effects[j] > 0 else None,
            left=None if column is None else _left(R, column),
            partners={} if column is None else _partners(names, unit, links[column], column),
            t=half_width(1.0, dof),
        )
    return Identifiability(
        names=names,
        directions=weakest,
        condition=condition,
        gamma=gamma if np.isfinite(gamma) else None,
        collinear=collinear_sets(names, R),
        parameters=parameters,
        columns=read_only(unit),
    )


def _torque_rms(result: FitResult) -> float:
    """Root mean square of the measured torque, weighted as the fit is [Nm]."""
    total = 0.0
    for recording in result.problem.inputs:
        if recording.torque is not None:
            weight = 1.0 if recording.weight is None else recording.weight
            total += float(np.sum(weight * recording.torque**2))
    return float(np.sqrt(total / result.problem.n))


def _left(R: FloatArray, j: int) -> float | None:
    """Length that is left of a column beside the others, as a part of its own; None if silent."""
    own = float(R[:, j] @ R[:, j])
    if own == 0:
        return None
    rest = [i for i in range(R.shape[1]) if i != j]
    return float(np.sqrt(unexplained(R, j, rest) / own))


def _links(unit: FloatArray) -> FloatArray:
    """Correlation of the estimates, those of singular directions tied by ±1."""
    if not unit.size:
        return unit
    _, s, Vt = np.linalg.svd(unit)
    floor = np.maximum(s, SINGULAR * s[0])
    root = Vt.T / floor
    covariance = root @ root.T
    spread = np.sqrt(np.diag(covariance))
    links = np.asarray(covariance / np.outer(spread, spread))
    links[np.abs(links) < _SHARE] = 0.0
    return links


def _partners(
    names: tuple[str, ...], unit: FloatArray, links: FloatArray, j: int
) -> dict[str, float | None]:
    """Parameters that one trades off with: those it correlates with, or those that make it up.

    Where no single one does, they are taken one by one, each time the one that leaves the least of
    the column, until most of what all others take together is taken.
    """
    rest = [i for i in range(len(names)) if i != j]
    strong = sorted((i for i in rest if abs(links[i]) >= _PARTNER), key=lambda i: -abs(links[i]))
    if strong:
        return {names[i]: float(links[i]) for i in strong[:_PARTNERS]}
    least = unexplained(unit, j, rest)
    if not 0 < least <= _TOGETHER**-2:
        return {}
    taken: list[int] = []
    while len(taken) < _PARTNERS:
        rest = [i for i in rest if i not in taken]
        taken.append(min(rest, key=lambda i: unexplained(unit, j, [*taken, i])))
        if unexplained(unit, j, taken) <= _MOSTLY * least:
            break
    return {names[i]: None for i in taken}


def _identified(
    name: str,
    *,
    sensitivity: float,
    rank: int,
    alone: float | None,
    left: float | None,
    partners: dict[str, float | None],
    t: float,
) -> Identified:
    collinearity = 1 / left if left else None
    uncertainty = alone * collinearity if alone is not None and collinearity is not None else None
    if alone is None:
        cause = Cause.SILENT
    elif left is None:
        cause = Cause.BOUND
    elif uncertainty is not None and t * uncertainty <= IDENTIFIED:
        cause = Cause.CLEAR
    else:
        cause = Cause.INSENSITIVE if t * alone > IDENTIFIED else Cause.TRADE_OFF
    return Identified(
        name, sensitivity, rank, alone, collinearity, uncertainty, tuple(partners), cause,
        _advice(name, cause, partners),
    )  # fmt: skip


def _advice(name: str, cause: Cause, partners: Mapping[str, float | None]) -> str:
    """What to do to know a parameter better, in one sentence."""
    parameter = PARAMETERS.get(name)
    more = parameter.advice if parameter else "another movement or effort, or fix it"
    fewer = more.removesuffix(", or fix it")
    others = [
        partner if r is None else f"{partner} ({r:+.2f})".replace("-", "−")
        for partner, r in partners.items()
    ]
    known = trade_off(name, tuple(partners))
    match cause:
        case Cause.SILENT:
            sentence = f"The torque does not depend on {name} here: fix it, or {fewer}."
        case Cause.BOUND:
            sentence = (
                f"See whether the bound of {name} is right, or fix it; to learn more: {more}."
            )
        case _ if known is not None:
            sentence = (
                f"{name} trades off with {listed(others)}, as {known.because}: {known.advice}."
            )
        case _ if others:
            sentence = f"{name} trades off with {listed(others)}: fix one of them, or {fewer}."
        case _:
            sentence = f"{name} has little influence on this torque: {more}."
    return sentence
