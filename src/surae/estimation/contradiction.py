"""Whether the data contradict a model that was named: the family's imperfections, one step away.

A fit of a named model knows nothing of a torque zero, a delay, crosstalk, or of tendons. Its
residual does: at its solution the posterior of the same leg with these, under their priors, is a
quadratic. Its evidence says whether the data ask for them, and its mode where the parameters would
go (a score test with a one-step estimate). Samples count for as little as the residual's slow part
says, since what a model leaves out is slow. What filters did to a fast movement is no part of a leg
either, and is let free in both.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.estimation.evidence import Quadratic
from surae.estimation.member import TENDONS, counted_alike
from surae.estimation.mode import Target, whitened
from surae.estimation.result import FitResult
from surae.frozen import FrozenDict
from surae.model import adapted, get_model, with_optional
from surae.model.laboratory import COMPLIANT, RIGID, Belief, group_of, laboratory
from surae.signals import ModelInputs
from surae.signals.prepare import sharpened, smoothed
from surae.units import FloatArray

#: Groups of nuisances that a named model is held against.
_HELD_AGAINST = ("zero", "delay", "crosstalk")
#: Gain of −2 ln Z from which an alternative is supported: odds of 150 to 1 ("very strong", Kass and
#: Raftery 1995). Legs of the model itself have −60 to −7, richer ones 3 to 290 (decision 16).
_SUPPORTED = 10.0
#: How much of what filtering once more does, and of what it does less than that when done again,
#: has been done already.
_BLUR = (Belief(1.0, 1.0), Belief(1.0, 1.0))


@dataclass(frozen=True, slots=True)
class Contradiction:
    """What a named model leaves out although the data ask for it."""

    #: What the better model has and the named one has not, all or some of it: groups of nuisances,
    #: ``"tendons"``.
    missing: tuple[str, ...]
    gain: float  #: By how much its −2 ln Z is less.
    shift: Mapping[str, float]  #: How far it moves each estimate, in the parameter's unit.


def contradiction(result: FitResult) -> Contradiction | None:
    """What contradicts a fit of a named model; None where nothing does, or nothing can be said.

    A fit of a family has been held against the rest of it already.
    """
    problem = result.problem
    name = COMPLIANT if problem.spec.name == RIGID else problem.spec.name
    known = {n for trial in problem.inputs for n in trial.fixed} | problem.settings.mentioned
    beliefs = {
        n: belief
        for n, belief in laboratory().items()
        if group_of(n) in _HELD_AGAINST and n not in problem.free and n not in known
    }
    if result.family is not None or result.status == "failed" or problem.settings.loss is not None:
        return None
    try:
        spec = with_optional(get_model(name), [*beliefs, *problem.spec.optional])
    except ValueError:
        return None
    table = adapted(spec.parameters, problem.options, problem.inputs[0].emg_unit)
    base = {n: result.values.get(n, belief.off) for n, belief in beliefs.items()}
    base |= {n: value for n, value in result.values.items() if n in spec.names}
    free = tuple(
        n for n in spec.names if n in problem.free or n in beliefs or n not in result.values
    )
    bounds = dict(zip(problem.free, zip(problem.lower, problem.upper, strict=True), strict=True))
    limits = [bounds.get(n, (table[n].lower, table[n].upper)) for n in free]
    tendons = {n: b for n, b in TENDONS.items() if n in spec.names and n not in known}
    for name in tendons.keys() - result.values.keys():  # none so far: as stiff as the model goes
        stiff = limits[free.index(name)][0]
        base[name] = stiff
        tendons[name] = Belief(float(np.log(stiff)), float(np.exp(tendons[name].mean)) / stiff)
    named = replace(problem, inputs=tuple(sharpened(trial) for trial in problem.inputs))
    richer = replace(
        named,
        spec=spec,
        free=free,
        base=np.array([base.get(n, table[n].start) for n in table]),
        lower=np.array([low for low, _ in limits]),
        upper=np.array([high for _, high in limits]),
    )
    with np.errstate(all="ignore"):  # a damaged file may hold anything; it is found out below
        own = Target(named, {}, ())
        there = own.start(result.values)
        noise = counted_alike(own, own.noise_at(there))
        target = Target(richer, beliefs, noise, tendons)
        z, left = target.start(base), own.residuals(there)
        off = {
            j: float(z[j])
            for j, n in enumerate(target.names)
            if n in beliefs or n not in result.values
        }
        off |= dict.fromkeys(range(len(target.names), len(z)), 0.0)
        gain, better = _gain(_quadratic(target, z, left), off)
    if not (gain > _SUPPORTED and np.isfinite(better).all()):
        return None
    own_names = len(target.names)
    away = np.abs(better[:own_names] - z[:own_names]) * target.scale(z)
    shift = {n: float(d) for n, d in zip(target.names, away, strict=True) if n in problem.free}
    missing = [g for g in _HELD_AGAINST if any(group_of(n) == g for n in beliefs)]
    if name != problem.spec.name:
        missing.append("tendons")
    return Contradiction(tuple(missing), gain, FrozenDict(shift))


def _quadratic(target: Target, z: FloatArray, left: Sequence[FloatArray]) -> Quadratic:
    """What data say around the named model: its own residual, and what the richer one can do.

    The richer model's residual is another there: its stiffest tendons are none that are rigid. The
    last coordinates are how much of what filters did is in the residual.
    """
    more = len(_BLUR)
    information = np.zeros((len(z) + more, len(z) + more))
    gradient, cost = np.zeros(len(z) + more), 0.0
    values = target.values(z)
    blocks = zip(
        target.problem.inputs, target.data_rows(z, raw=True), left, target.noise, strict=True
    )
    for recording, rows, e, noise in blocks:
        torque = rows[-1] + (0.0 if recording.torque is None else recording.torque)
        again = smoothed(recording)
        blurred = _blurred(target, values, recording, torque)
        twice = _blurred(target, values, again, _torque(target, values, again))
        block = np.stack([*rows[:-1], -blurred, twice - blurred, e])
        if recording.weight is not None:
            block *= np.sqrt(recording.weight)
        block = whitened(block, noise)
        information += block[:-1] @ block[:-1].T
        gradient += block[:-1] @ block[-1]
        cost += float(block[-1] @ block[-1])
    return Quadratic(
        information,
        gradient,
        cost,
        z=np.append(z, np.zeros(more)),
        mean=np.append(target.mean, [belief.mean for belief in _BLUR]),
        weight=np.append(target.weight_at(z), [1.0 / belief.sd for belief in _BLUR]),
    )


def _torque(target: Target, values: FloatArray, recording: ModelInputs) -> FloatArray:
    """The model's torque [Nm] of a recording."""
    return target.problem.spec.simulator(recording, target.problem.options).torque(values)


def _blurred(
    target: Target, values: FloatArray, recording: ModelInputs, torque: FloatArray
) -> FloatArray:
    """What filtering changes of the torque that it does not change of the model's [Nm].

    A fast movement's torque is not the one at what filters leave of the movement, though that was
    sharpened. Filtering once more shows by how much; filtering twice more, how that grows.

    `torque` is the model's of the recording as it is.
    """
    again = sharpened(smoothed(replace(recording, torque=torque)))
    wanted = torque if again.torque is None else again.torque
    error: FloatArray = _torque(target, values, again) - wanted
    return error if np.isfinite(error).all() else np.zeros(recording.n)


def _gain(quadratic: Quadratic, off: Mapping[int, float]) -> tuple[float, FloatArray]:
    """By how much −2 ln Z is less with what is off let free, and the mode then; 0: not at all."""
    try:
        alone, better = quadratic.solved(off), quadratic.solved({})
    except np.linalg.LinAlgError:
        return 0.0, quadratic.z
    return alone[0] - better[0], better[1]
