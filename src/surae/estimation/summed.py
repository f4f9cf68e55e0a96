"""The answer of a search through the family: model, values, and what leaves them unsure."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.estimation.each import Each
from surae.estimation.evidence import factor_of
from surae.estimation.flatness import flatness
from surae.estimation.member import UNSUPPORTED, Member, under_noise
from surae.estimation.mode import Mode, Target, straight
from surae.estimation.noisy_emg import noisy_emg, without_emg_bias
from surae.estimation.result import Candidate, Family, FitResult, Start, is_at_bound
from surae.estimation.shifts import left_out, shaken, sized, unheard
from surae.frozen import FrozenDict, read_only
from surae.model.laboratory import group_of
from surae.signals import ModelInputs
from surae.units import FloatArray
from surae.versions import versions

#: Alternatives whose −2 ln p is greater than the best's by more are rejected.
REJECTED = 12.0
#: A value so near a bound, in standard deviations and as a part of the bounds' distance, lies at
#: it: the bound holds it there, or nothing does, and what curves around it tells no interval.
_BESIDE, _BESIDE_PART = 0.1, 0.01


@dataclass(frozen=True, slots=True)
class WhiteModes:
    """The modes that a search met under white noise."""

    modes: tuple[Mode, ...]  #: The best first.
    names: tuple[str, ...]  #: What they are of.

    def spread(self, target: Target) -> FloatArray:
        """How far other valleys are that the data do not reject, as they are searched, (r, q)."""
        best, others = self.modes[0], self.modes[1:]
        far = np.zeros((len(others), len(target.names) + target.zeros * target.own_zeros))
        for row, other in zip(far, others, strict=True):
            likely = np.exp(-(other.cost - best.cost) / (REJECTED / 3.0))
            for j, name in enumerate(target.names):
                if name in self.names:
                    at = self.names.index(name)
                    row[j] = np.sqrt(likely) * (other.z[at] - best.z[at])
        return sized(far, np.abs(far).max(axis=0, initial=0.0))

    def starts(self, target: Target, values: Mapping[str, float], sse: float) -> tuple[Start, ...]:
        """The solution, then the other valleys that were met, as far as they are of its model."""
        free = target.problem.free
        own = {name: values[name] for name in free}
        begin = dict(zip(free, target.problem.start.tolist(), strict=True))
        starts = [Start(begin, own, sse, "converged", 1)]
        best = self.modes[0].cost
        for other in self.modes[1:]:
            met = dict(zip(self.names, other.z.tolist(), strict=False))
            reached = {
                n: own[n] if n not in met else met[n] if straight([n])[0] else float(np.exp(met[n]))
                for n in free
            }
            worse = sse * (1.0 + max(other.cost - best, 0.0) / target.problem.n)
            starts.append(Start(begin, reached, worse, "converged", 1))
        return tuple(starts)

    @property
    def agreeing(self) -> int:
        """How many came to the best."""
        return max(1, sum(mode.cost - self.modes[0].cost < 1.0 for mode in self.modes))


def summed(
    compliant: Member,
    rigid: Member,
    met: WhiteModes,
    inputs: tuple[ModelInputs, ...],
    begin: float,
) -> FitResult:
    """The fit of the better supported member, and how far the rest is from it.

    `inputs` are the recordings as they were given; the search began at `begin`, by
    `time.perf_counter`.
    """
    members = sorted((compliant, rigid), key=lambda member: member.evidence)
    chosen, rival = members
    if chosen is rigid:  # its residual is the noise then
        target, mode = under_noise(chosen.target, chosen.mode)
        chosen = replace(chosen, target=target, mode=mode, quadratic=target.quadratic(mode))
    flat = flatness(chosen.target, chosen.mode, chosen.covariance())
    if flat.mode is not chosen.mode:
        quadratic = chosen.target.quadratic(flat.mode)
        chosen = replace(chosen, mode=flat.mode, quadratic=quadratic)
    at_bounds = _to_bounds(chosen, chosen.mode.z)
    if not np.array_equal(at_bounds, chosen.mode.z):
        mode = Mode(at_bounds, float(np.sum(chosen.target.rows(at_bounds)[-1] ** 2)))
        chosen = replace(chosen, mode=mode, quadratic=chosen.target.quadratic(mode))
    odds = float(np.exp(-0.5 * min(rival.evidence - members[0].evidence, 1e3)))
    weight = 1.0 / (1.0 + odds)
    target, mode = chosen.target, chosen.mode
    problem = target.problem
    noisy = noisy_emg(target, mode, chosen.quadratic)
    z, left = without_emg_bias(target, mode, chosen.quadratic, noisy)
    z = _to_bounds(chosen, z)
    each = Each(target, mode, z - mode.z, noisy) if len(inputs) > 1 else None
    mode, around = Mode(z, mode.cost), chosen.quadratic
    change = _natural(target, mode)
    whole = chosen.covariance()
    covariance = change @ whole @ change.T
    # noise of the EMG is told of apart, so what it makes of the residual is taken out here
    less = noisy.part * whole @ chosen.quadratic.information @ whole
    models = [chosen.between_subsets(), flat.shifts]
    if target is compliant.target:
        models.append(met.spread(target))
    if odds > UNSUPPORTED:
        models.append(rival.away_from(chosen, odds * weight))
    shifts = {
        "model": np.vstack(models),
        "left_out": left_out(
            target, mode, around, noisy, [(target, mode, around)] if each is None else each.owns
        ),
        **shaken(target, mode, around, noisy),
        "emg_bias": left[None],
        "unheard": unheard(target, mode, around),
    }
    if each is not None:
        shifts["trials"] = each.shifts(mode, around)
    problem = replace(problem, inputs=inputs)
    residuals = tuple(read_only(-e) for e in target.of_inputs(inputs).residuals(mode.z))
    roots = [1.0 if recording.weight is None else recording.weight for recording in inputs]
    sse = sum(float(np.sum(w * e**2)) for w, e in zip(roots, residuals, strict=True))
    values = dict(zip(problem.spec.names, target.values(mode.z).tolist(), strict=True))
    bound = [
        name
        for name, low, high in zip(problem.free, problem.lower, problem.upper, strict=True)
        if group_of(name) is None and is_at_bound(values[name], low, high)
    ]
    candidates = (
        chosen.candidate(weight),
        rival.candidate(1.0 - weight),
        *(
            Candidate(problem.spec.name, s.groups, s.evidence, s.weight, {})
            for s in chosen.alternatives[1:6]
            if s.weight > UNSUPPORTED
        ),
    )
    family = Family(
        candidates=candidates,
        beliefs=FrozenDict(target.beliefs),
        noise=target.noise,
        zeros=tuple(mode.z[len(target.names) :].tolist()),
        covariance=read_only(change @ (whole - less) @ change.T),
        spread=FrozenDict({source: read_only(by @ change.T) for source, by in shifts.items()}),
        recordings=() if each is None else each.told(),
    )
    finite = bool(np.isfinite(sse) and np.isfinite(covariance).all())
    status = "failed" if not finite else "at-bounds" if bound else "converged"
    dof = max(problem.n - len(problem.free), 1)
    R = np.full((len(problem.free),) * 2, np.nan)
    if finite:
        scale = 1.0 / np.sqrt(np.diag(covariance))
        root = np.linalg.inv(factor_of(covariance * scale * scale[:, None])) * scale
        R = np.sqrt(max(sse, 1e-300) / dof) * np.linalg.qr(root)[1]
    return FitResult(
        problem=problem,
        status=status,
        message=_message(chosen, weight, bound, finite),
        values=values,
        residuals=residuals,
        sse=sse,
        R=read_only(R),
        starts=met.starts(target, values, sse),
        agreeing=met.agreeing,
        seed=problem.settings.seed,
        seconds=time.perf_counter() - begin,
        versions=versions(),
        family=family,
    )


def _to_bounds(member: Member, z: FloatArray) -> FloatArray:
    """A point of a member with what rests beside a bound moved to it."""
    target, moved = member.target, z.copy()
    deviations = np.sqrt(np.diag(member.covariance()))
    for j, name in enumerate(target.names):
        low, high = float(target.lower[j]), float(target.upper[j])
        near = min(_BESIDE * float(deviations[j]), _BESIDE_PART * (high - low))
        if group_of(name) is None:
            moved[j] = low if z[j] - low <= near else high if high - z[j] <= near else z[j]
    return moved


def _natural(target: Target, mode: Mode) -> FloatArray:
    """The problem's free parameters, in their units, by what is searched, shape (p, q)."""
    names, free = target.names, target.problem.free
    change = np.zeros((len(free), len(mode.z)))
    scale = target.scale(mode.z)
    for i, name in enumerate(free):
        if name in names:
            change[i, names.index(name)] = scale[names.index(name)]
        else:  # the mean of the recordings' zeros
            change[i, len(names) :] = 1.0 / target.zeros
    return change


def _message(chosen: Member, weight: float, bound: Sequence[str], finite: bool) -> str:
    if not finite:
        return "no minimum reached: the model has no finite numbers; give another start or bounds"
    spec = chosen.target.problem.spec
    groups = chosen.candidate(weight).groups
    text = f"the {spec.title} was chosen"
    text += f" with {', '.join(groups)}" if groups else " without any imperfection"
    if weight < 0.99:
        text += f" (probability {100 * weight:.0f} %)"
    return text + (f"; at a bound: {', '.join(bound)}" if bound else "")
