"""Whether the data contradict a model that was named: the family's imperfections, one step away.

A fit of a named model knows nothing of a torque zero, a delay, crosstalk, or of tendons. Its
residual does: at its solution the posterior of the same leg with these, under their priors, is a
quadratic. Its evidence says whether the data ask for them, and its mode where the parameters would
go (a score test with a one-step estimate). Samples count for as little as the residual's slow part
says, since what a model leaves out is slow.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.estimation.correlated import counted_alike
from surae.estimation.member import TENDONS
from surae.estimation.mode import Mode, Target
from surae.estimation.result import FitResult
from surae.frozen import FrozenDict
from surae.model import adapted, get_model, with_optional
from surae.model.laboratory import COMPLIANT, RIGID, group_of, laboratory
from surae.signals.prepare import sharpened

#: Groups of nuisances that a named model is held against; and tendons so stiff that they are none.
_HELD_AGAINST = ("zero", "delay", "crosstalk")
_STIFF = {"dlt_tri": 0.004, "dlt_tib": 0.002}
#: Gain of −2 ln Z from which an alternative is supported: of a fit that is doubtful anyhow, odds of
#: 150 to 1 ("very strong", Kass and Raftery 1995); of one that is not, twice the gain, since noise
#: of the EMG alone brought up to 16 on legs of the model itself.
_SUPPORTED, _SUPPORTED_ADEQUATE = 10.0, 20.0


@dataclass(frozen=True, slots=True)
class Contradiction:
    """What a named model leaves out although the data ask for it.

    Attributes
    ----------
    missing : tuple of str
        What the better model has: groups of nuisances, ``"tendons"``.
    gain : float
        By how much its −2 ln Z is less.
    shift : mapping of str to float
        How far it moves each estimate, in the parameter's unit.
    """

    missing: tuple[str, ...]
    gain: float
    shift: Mapping[str, float]


def contradiction(result: FitResult, *, doubtful: bool) -> Contradiction | None:
    """What contradicts a fit of a named model; None where nothing does, or nothing can be said.

    Parameters
    ----------
    result : FitResult
        Of a named model; one of a family has been held against the rest of it.
    doubtful : bool
        Whether the fit is doubtful for other reasons.
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
    base |= {n: _STIFF[n] for n in _STIFF if n in spec.names and n not in result.values}
    base |= {n: value for n, value in result.values.items() if n in spec.names}
    free = tuple(
        n for n in spec.names if n in problem.free or n in beliefs or n not in result.values
    )
    bounds = dict(zip(problem.free, zip(problem.lower, problem.upper, strict=True), strict=True))
    limits = [bounds.get(n, (table[n].lower, table[n].upper)) for n in free]
    asked = replace(
        problem,
        spec=spec,
        inputs=tuple(sharpened(trial) for trial in problem.inputs),
        free=free,
        base=np.array([base.get(n, table[n].start) for n in table]),
        lower=np.array([low for low, _ in limits]),
        upper=np.array([high for _, high in limits]),
    )
    with np.errstate(all="ignore"):  # a damaged file may hold anything; it is found out below
        target = Target(asked, beliefs, (), {n: b for n, b in TENDONS.items() if n not in known})
        z = target.start(base)
        target = target.with_noise(counted_alike(target, target.noise_at(z)))
        quadratic = target.quadratic(Mode(z, 0.0))
    off = {
        j: float(z[j]) for j, n in enumerate(target.names) if n in beliefs or n not in result.values
    }
    off |= dict.fromkeys(range(len(target.names), len(z)), 0.0)
    with np.errstate(all="ignore"):
        try:
            alone, better = quadratic.solved(off), quadratic.solved({})
        except np.linalg.LinAlgError:
            return None
    gain = alone[0] - better[0]
    enough = _SUPPORTED if doubtful else _SUPPORTED_ADEQUATE
    if not (gain > enough and np.isfinite(better[1]).all()):
        return None
    away = np.abs(better[1] - z)[: len(target.names)] * target.scale(z)
    shift = {n: float(d) for n, d in zip(target.names, away, strict=True) if n in problem.free}
    missing = [g for g in _HELD_AGAINST if any(group_of(n) == g for n in beliefs)]
    if name != problem.spec.name:
        missing.append("tendons")
    return Contradiction(tuple(missing), gain, FrozenDict(shift))
