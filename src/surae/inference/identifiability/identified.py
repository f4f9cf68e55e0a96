"""Which parameters the data tell, which trade off, and what would tell them apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.formatting import listed
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import FitResult
from surae.inference.identifiability.advice import trade_off
from surae.inference.uncertainty.combined import information_root
from surae.model.joint import Joint
from surae.model.registry import PARAMETERS

#: Widening by the others from which a parameter trades off with them: that of two parameters with a
#: correlation of 0.7. Partners at most.
_WIDENED = 1.4
_PARTNERS = 3
#: Least size of a parameter, as a part of its bounds' distance, for what is relative to it.
_LEAST = 0.01
#: Squared length below which what is left of a column of length 1 is rounding.
_ROUNDING = 1e-10
#: A parameter takes part in a direction when its relative change is this part of the largest, or
#: when its effect on the torque is this part of the largest and its change not a trifle.
_CHANGED = 0.3
_EFFECT = 0.25
_TRIFLE = 0.03
#: Parameters that are named at most.
_MOST = 5
#: Part of its largest contribution up to which a direction's torque counts as cancelled.
_CANCELLED = 0.5
#: Singular value, as a part of the largest, below which there is only rounding.
_SINGULAR = 1e-10


@dataclass(frozen=True, slots=True)
class Direction:
    """A combination of parameters, an eigenvector of the scaled information matrix."""

    #: Information along it; parameters are measured in their own values, torque in standard
    #: deviations of the noise.
    eigenvalue: float
    #: 1/√eigenvalue: relative standard error along it; None where there is no information.
    uncertainty: float | None
    #: Its parameters, the most changed first, and their relative change along it, of length 1 over
    #: all parameters.
    changes: Mapping[str, float]
    words: str  #: The same as a sentence.
    #: What it adds to the variance of each parameter, over σ², shape (k,).
    variances: FloatArray


@dataclass(frozen=True, slots=True)
class Identified:
    """How well one estimated parameter is determined, and by what it is not."""

    name: str  #: The parameter.
    #: δ_msqr of Brun et al. (2001): root mean square change of the torque for a change of the
    #: parameter by its own value, as a part of the torque's own root mean square.
    sensitivity: float
    #: Relative standard error if all others were known; None without influence.
    alone: float | None
    #: By how much the estimation of the others widens it; None where they give the same torque.
    collinearity: float | None
    #: Parameters it trades off with, strongest first: those of the direction that adds most to its
    #: variance (Belsley, Kuh and Welsch, Regression Diagnostics, 1980).
    partners: tuple[str, ...]
    advice: Message  #: What to do to know it, or to know it better, in one sentence.

    @property
    def uncertainty(self) -> float | None:
        """Relative standard error."""
        if self.alone is None or self.collinearity is None:
            return None
        return self.alone * self.collinearity


@dataclass(frozen=True, slots=True)
class Identifiability:
    """What the sensitivities at the estimate say of every parameter."""

    names: tuple[str, ...]  #: Estimated parameters that do not lie at a bound.
    directions: tuple[Direction, ...]  #: All of them, the weakest first.
    condition: float | None  #: Of the scaled information matrix; None where it is singular.
    parameters: Mapping[str, Identified]  #: Every estimated parameter.


def identifiability(result: FitResult, *, variance_inflation: float = 1.0) -> Identifiability:
    """Examine the Jacobian at the estimate.

    Parameters at a bound are taken as known; priors count as data. All is empty where the model
    gave no finite torque.
    """
    problem = result.problem
    inside = [j for j, name in enumerate(problem.free) if name not in result.at_bound]
    names = tuple(problem.free[j] for j in inside)
    if not (np.isfinite(result.sse) and np.isfinite(result.R).all()):
        return Identifiability((), (), None, {})
    sigma = float(np.sqrt(variance_inflation * result.sse / (problem.n - len(inside))))
    values = np.array([result.values[name] for name in problem.free])
    sizes = np.maximum(np.abs(values), _LEAST * (problem.upper - problem.lower))
    scaled = information_root(result) * sizes
    effects = np.linalg.norm(scaled, axis=0)
    felt = np.linalg.norm(result.R * sizes, axis=0)
    weakest = directions(names, scaled[:, inside], effects[inside], sigma) if inside else ()
    condition = None
    if weakest and weakest[0].uncertainty is not None:
        condition = weakest[-1].eigenvalue / weakest[0].eigenvalue
    torque = _torque_rms(result) * problem.n**0.5
    parameters = {}
    for j, name in enumerate(problem.free):
        effect = float(effects[j])
        widened = None
        partners: tuple[str, ...] = ()
        if name in names and effect > 0:
            left = unexplained(scaled, j, [i for i in inside if i != j])
            widened = effect / left**0.5 if left > 0 else None
            partners = _partners(name, names, weakest, widened)
        parameters[name] = Identified(
            name,
            sensitivity=float(felt[j]) / torque if torque else 0.0,
            alone=sigma / effect if effect > 0 else None,
            collinearity=widened,
            partners=partners,
            advice=_advice(
                name,
                partners,
                problem.options.anatomy,
                silent=effect == 0,
                at_bound=name not in names,
            ),
        )
    return Identifiability(names, weakest, condition, parameters)


def _torque_rms(result: FitResult) -> float:
    """Root mean square of the measured torque, weighted as the fit is [Nm]."""
    total = 0.0
    for recording in result.problem.inputs:
        if recording.torque is not None:
            total += float(np.sum(recording.weights * recording.torque**2))
    return float(np.sqrt(total / result.problem.n))


def _partners(
    name: str, names: tuple[str, ...], along: Sequence[Direction], widened: float | None
) -> tuple[str, ...]:
    """Parameters that one trades off with, whose estimation widens its standard error so much."""
    if widened is not None and widened < _WIDENED:
        return ()
    j = names.index(name)
    most = max(along, key=lambda direction: direction.variances[j])
    return tuple(other for other in most.changes if other != name)[:_PARTNERS]


def _advice(
    name: str, partners: tuple[str, ...], joint: Joint, *, silent: bool, at_bound: bool
) -> Message:
    """What to do to know a parameter better, in one sentence."""
    parameter = PARAMETERS.get(name)
    known = trade_off(name, partners)
    more = Message(parameter.advice if parameter else "another movement or effort", joint.worded)
    code = "trades" if partners else "little"
    if silent or at_bound:
        code = "silent" if silent else "at-bound"
    elif known is not None:
        code = "trades-as"
        more = Message(known.advice.code, joint.worded)
    return Message(f"identify/{code}", name=name, names=", ".join(partners), advice=more)


def unexplained(R: FloatArray, j: int, others: Sequence[int]) -> float:
    """Squared length of what no combination of other columns gives of column `j`, 0 for rounding.

    σ² over it is the variance of parameter j when the others are estimated too.
    """
    column = R[:, j]
    rest = R[:, list(others)]
    norms = np.linalg.norm(rest, axis=0)
    rest = rest / np.where(norms > 0, norms, 1.0)
    left = column - rest @ np.linalg.lstsq(rest, column, rcond=None)[0]
    length = float(left @ left)
    return length if length > _ROUNDING * float(column @ column) else 0.0


def directions(
    names: tuple[str, ...], R: FloatArray, length: FloatArray, sigma: float
) -> tuple[Direction, ...]:
    """Eigenvectors of the scaled information matrix RᵀR/σ², the weakest first.

    R, shape (k, k), is the triangular factor of the sensitivities to each parameter in its own
    value [Nm], `length` those of its columns, `sigma` the noise's standard deviation [Nm].
    """
    _, s, Vt = np.linalg.svd(R)
    rows = []
    for value, v in zip(s[::-1], Vt[::-1], strict=True):
        effect = np.abs(v) * length
        singular = value <= _SINGULAR * s[0]
        opposed = bool(value <= _CANCELLED * float(effect.max()))
        parts = _parts(np.abs(v), effect)
        signed = v if v[parts[0]] >= 0 else -v
        changes = {names[i]: float(signed[i]) for i in parts}
        rows.append(
            Direction(
                eigenvalue=0.0 if singular else float(value / sigma) ** 2 if sigma else np.inf,
                uncertainty=None if singular else sigma / float(value),
                changes=changes,
                words=_words(changes, opposed, singular),
                variances=(v / max(value, _SINGULAR * s[0], 1e-300)) ** 2,
            )
        )
    return tuple(rows)


def _parts(change: FloatArray, effect: FloatArray) -> list[int]:
    """Parameters that make up a direction, those of the largest relative change first."""
    felt = (effect >= _EFFECT * effect.max()) & (change >= _TRIFLE * change.max()) & (effect > 0)
    part = felt | (change >= _CHANGED * change.max())
    return [i for i in np.argsort(-change, kind="stable").tolist() if part[i]][:_MOST]


def _words(changes: Mapping[str, float], opposed: bool, singular: bool) -> str:
    """A direction as a sentence."""
    moved = [f"{name} {'up' if change >= 0 else 'down'}" for name, change in changes.items()]
    names = moved[0] if len(moved) == 1 else f"{moved[0]} with {listed(moved[1:])}"
    if singular:
        return f"{names}: the same torque"
    return f"{names}: {'nearly the same torque' if opposed else 'changes the torque'}"
