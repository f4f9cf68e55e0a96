"""`model="auto"`: the family of models searched from simple to rich, and what the data support.

The family has rigid and compliant tendons, each with every subset of the laboratory's nuisances.

1. Thinned data, all nuisances in, noise taken for much greater than it is and the population for
   known: a surface with one valley. The noise is lowered to what it is and the population let go
   (continuation). From a fast and from a slow relaxation, for those are two valleys.
2. All data. Crosstalk that is too great takes a muscle's activation below zero, where it has no
   gradient: the search begins again from less crosstalk, and keeps the best.
3. The noise's own correlation, an autoregressive model of the residual; the mode under it.
4. The evidence of each subset of nuisances; the best one is solved anew.
5. The other kind of tendons, from the values found, under the same noise.

Alternatives that the data do not reject, other valleys, other subsets and the other kind of
tendons, widen the intervals by how far they are (`surae.estimation.summed`).
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.estimation.evidence import Subset, subsets
from surae.estimation.fit import fit_problem
from surae.estimation.interrupt import postponed_interrupt
from surae.estimation.least_squares import Outcome
from surae.estimation.member import ODDS, Member, under_noise
from surae.estimation.mode import Mode, Target, straight, thinned_problem, white_noise
from surae.estimation.noise import NoiseModel
from surae.estimation.population import population_priors
from surae.estimation.problem import FitProblem
from surae.estimation.result import FitResult
from surae.estimation.summed import REJECTED, WhiteModes, summed
from surae.model import adapted, get_model, with_optional
from surae.model.laboratory import COMPLIANT, RIGID, Belief, group_of, laboratory
from surae.progress import SearchProgress
from surae.recording import MUSCLES
from surae.signals import emg_levels, quiet_levels
from surae.signals.prepare import sharpened
from surae.threads import one_blas_thread
from surae.units import FloatArray

#: Data of the first search: rate [Hz] and samples of each recording.
_THIN_RATE, _THIN_SAMPLES = 32.0, 400
#: Relaxation times [s] and factor that are tried.
_RELAXATIONS, _RELAXED = (0.4, 4.0), 0.3
#: Points of a search that differ by less, as they are searched, lead to one valley.
_SAME = 0.1
#: Noise of the continuation, as parts of the torque's changes.
_TEMPERS = (0.1, 0.03)
#: By how much the population's spread is widened while it helps the search.
_WIDENED = 1.5
#: Crosstalk from which the search begins again, as parts of what it found.
_LESS_CROSSTALK = (0.3, 0.0)
#: A model whose −2 ln p is greater by more after some steps is not followed to its end.
_HOPELESS = 300.0
_POPULATION = "healthy"
#: Groups that no sensor is free of: they are in whatever the evidence; those that are tried alone;
#: and those whose valleys are many, for they bend the curves that other parameters place.
_ALWAYS, _BENDS = ("zero", "delay", "rest"), ("toe", "shape")
_CORE = (*_ALWAYS, "crosstalk")


def fit_family(problem: FitProblem, *, progress: SearchProgress | None = None) -> FitResult:
    """Fit the family to a problem and choose.

    The problem is of the family's compliant model; which nuisances are in, its settings say.
    `progress` is told of stages that are done, how many there are, and the sum of squares. Ctrl-C
    keeps the rigid model, without `family`.
    """
    begin = time.perf_counter()
    search = _Search(problem, progress)
    with one_blas_thread(), postponed_interrupt():
        try:
            return search.result(begin)
        except KeyboardInterrupt:
            return search.stopped(begin)


class _Search:
    """One search through the family."""

    def __init__(self, problem: FitProblem, progress: SearchProgress | None) -> None:
        inputs = tuple(sharpened(recording) for recording in problem.inputs)
        self._asked, self._progress = replace(problem, inputs=inputs), progress
        self._inputs = problem.inputs
        beliefs = laboratory(problem.settings.nuisances, quiet_levels(problem.inputs))
        held = {*problem.settings.fixed, *(n for trial in problem.inputs for n in trial.fixed)}
        missing = {m for trial in problem.inputs for m in trial.missing_emg}
        silent = missing | {
            muscle
            for muscle, weight in zip(MUSCLES, problem.spec.weights, strict=True)
            if weight in held and not problem.base[problem.spec.names.index(weight)]
        }
        self._beliefs = {
            name: belief
            for name, belief in beliefs.items()
            if name not in held and not _needless(name, silent)
        }
        self._options = problem.options
        if "emg_shape" in self._beliefs and self._options.emg_ref is None:
            self._options = replace(self._options, emg_ref=emg_levels(problem.inputs))
        self._extra = {
            name: _as_searched(name, prior.median, prior.spread)
            for name, prior in problem.priors.items()
        }
        self._modes: list[Mode] = []
        self._met: tuple[str, ...] = ()

    def result(self, begin: float) -> FitResult:
        """Search, choose, and sum up."""
        full = self._problem(COMPLIANT, tuple(self._beliefs))
        target, mode = self._valleys(full, self._first(full))
        self._told(2, mode)
        target, mode = under_noise(target, mode)
        compliant = self._member(target, mode)
        target, mode = under_noise(compliant.target, compliant.mode)
        self._told(3, mode)
        compliant = replace(compliant, target=target, mode=mode, quadratic=target.quadratic(mode))
        rigid = self._rigid(compliant)
        better = self._again(compliant, rigid)
        if better is not compliant:
            compliant, rigid = better, self._rigid(better)
        self._told(4, mode)
        return summed(
            compliant, rigid, WhiteModes(tuple(self._modes), self._met), self._inputs, begin
        )

    def stopped(self, begin: float) -> FitResult:
        """What is kept where the user stopped: the rigid model, nothing weighed."""
        plain = fit_problem(
            replace(self._problem(RIGID, ()), priors={}, inputs=self._inputs), starts=1
        )
        without = ", without priors," if self._asked.priors else ""
        return replace(
            plain,
            message=f"stopped by the user: the rigid model alone{without} is kept; fit again to "
            "weigh the family",
            starts=(replace(plain.starts[0], outcome=str(Outcome.INTERRUPTED)),),
            seconds=time.perf_counter() - begin,
        )

    def _told(self, stage: int, mode: Mode) -> None:
        if self._progress is not None:
            self._progress(stage, 4, mode.cost)

    def _problem(self, model: str, nuisances: Sequence[str]) -> FitProblem:
        """The problem of a model of the family with these nuisances free."""
        asked = self._asked
        spec = get_model(model)
        wanted = [n for n in (*nuisances, *asked.spec.optional) if n not in spec.names]
        spec = with_optional(spec, wanted)
        nuisances = [n for n in nuisances if n in spec.names]
        table = adapted(spec.parameters, self._options, asked.inputs[0].emg_unit)
        limits = {name: (p.lower, p.upper) for name, p in table.items()}
        limits |= dict(
            zip(asked.free, zip(asked.lower.tolist(), asked.upper.tolist(), strict=True),
                strict=True)
        )  # fmt: skip
        values = dict(zip(asked.spec.names, asked.base.tolist(), strict=True))
        values |= {n: w for n, w in _weights(asked).items() if n not in asked.settings.start}
        free = tuple(n for n in spec.names if n in asked.free or n in nuisances)
        return replace(
            asked,
            spec=spec,
            options=self._options,
            free=free,
            base=np.array([values.get(name, p.start) for name, p in table.items()]),
            lower=np.array([limits[name][0] for name in free]),
            upper=np.array([limits[name][1] for name in free]),
        )

    def _target(self, problem: FitProblem, noise: Sequence[NoiseModel]) -> Target:
        beliefs = {n: b for n, b in self._beliefs.items() if n in problem.free}
        return Target(problem, beliefs, noise, self._extra)

    def _first(self, full: FitProblem) -> list[Mode]:
        """Minima of thinned data, from both relaxations, the best first."""
        thin = thinned_problem(full, _THIN_RATE, _THIN_SAMPLES)
        helped = {**_population(thin), **self._extra}
        beliefs = {n: b for n, b in self._beliefs.items() if n in thin.free}
        begin = self._begin(thin, helped)
        ends: list[Mode] = []
        warm: list[FloatArray] = []
        for relaxation in _RELAXATIONS:
            target = Target(thin, beliefs, white_noise(thin, _TEMPERS[0]), helped)
            leg = [j for j, name in enumerate(target.names) if group_of(name) is None]
            values = {**begin, "tau_rel": relaxation, "k_rel": _RELAXED, **thin.settings.start}
            z = target.start(values)
            for part in _TEMPERS:
                target = target.with_noise(white_noise(thin, part))
                z = target.descend(z, evaluations=8, tolerance=0.1).z
            if any(np.abs((z - other)[leg]).max() < _SAME for other in warm):
                continue  # both relaxations have come to one valley
            warm.append(z)
            target = self._target(thin, white_noise(thin, _TEMPERS[-1]))
            for evaluations in (15, 15, 20):
                target = target.with_noise(target.noise_at(z, white=True))
                z = target.descend(z, evaluations=evaluations, tolerance=0.1).z
            ends.append(Mode(z, sum(float(e @ e) for e in target.residuals(z))))
        return sorted(ends, key=lambda mode: mode.cost)

    def _begin(self, problem: FitProblem, helped: Mapping[str, Belief]) -> dict[str, float]:
        """Where a search begins: the population, weights that fit the torque's size, nuisances."""
        values = dict(zip(problem.spec.names, problem.base.tolist(), strict=True))
        for name, belief in helped.items():
            if name in problem.free:
                straight_ = straight([name])[0]
                values[name] = belief.mean if straight_ else float(np.exp(belief.mean))
        for name, belief in self._beliefs.items():
            if name in problem.free:
                values[name] = belief.off if group_of(name) == "shape" else belief.mean
        return values

    def _valleys(self, full: FitProblem, ends: Sequence[Mode]) -> tuple[Target, Mode]:
        """The best mode of all data under white noise; the others that were met are kept."""
        target = self._target(full, white_noise(full, _TEMPERS[-1]))
        z = ends[0].z
        for _ in range(2):
            target = target.with_noise(target.noise_at(z, white=True))
            z = target.descend(z, evaluations=10, tolerance=0.1).z
        modes = [target.descend(z, evaluations=10, tolerance=0.03)]
        points = [
            end.z for end in ends[1:] if end.cost < ends[0].cost * (1.0 + REJECTED / full.n)
            and np.abs(end.z - ends[0].z).max() > 0.05
        ]  # fmt: skip
        heard = [j for j, name in enumerate(target.names) if group_of(name) == "crosstalk"]
        for part in _LESS_CROSSTALK if heard else ():
            point = min(modes, key=lambda mode: mode.cost).z.copy()
            point[heard] *= part
            points.append(point)
        for point in points:
            modes.append(target.descend(point, evaluations=15, tolerance=0.03))
        modes.sort(key=lambda mode: mode.cost)
        self._modes, self._met = modes, target.names
        return target, modes[0]

    def _groups(self, target: Target) -> dict[str, list[int]]:
        """Positions of each group's parameters among the searched ones."""
        groups: dict[str, list[int]] = {}
        for j, name in enumerate(target.names):
            group = group_of(name)
            if group is not None and name in target.beliefs:
                groups.setdefault(group, []).append(j)
        if target.own_zeros:
            first = len(target.names)
            groups["zero"] = list(range(first, first + target.zeros))
        return groups

    def _member(self, target: Target, mode: Mode) -> Member:
        """The best supported subset of nuisances, solved anew.

        The quadratic at the mode of all nuisances may be that of another valley: the subset that
        it prefers, that without what only bends curves, and the core are solved and compared.
        """
        scored, names = self._subsets(target, mode), target.names
        members: dict[tuple[str, ...], Member] = {}
        best = scored[0].groups
        for groups in (best, tuple(g for g in best if g not in _BENDS),
                       tuple(g for g in best if g in _CORE)):  # fmt: skip
            key = tuple(sorted(groups))
            if key not in members:
                own, there = self._reduced(target, mode, groups)
                subsets_ = sorted(scored, key=lambda s: tuple(sorted(s.groups)) != key)
                members[key] = Member(own, there, tuple(subsets_), names, own.quadratic(there))
        return min(members.values(), key=lambda member: member.evidence)

    def _subsets(self, target: Target, mode: Mode) -> tuple[Subset, ...]:
        groups = self._groups(target)
        off: dict[int, float] = {}
        for group, positions in groups.items():
            value = next(b.off for n, b in target.beliefs.items() if group_of(n) == group)
            off |= dict.fromkeys(positions, value)
        always = tuple(group for group in _ALWAYS if group in groups)
        return subsets(target.quadratic(mode), groups, off, always, ODDS)

    def _reduced(self, target: Target, mode: Mode, groups: Sequence[str]) -> tuple[Target, Mode]:
        """The target with these groups of nuisances alone, and its mode."""
        present = [n for n in target.beliefs if group_of(n) in groups]
        if len(present) == len(target.beliefs):
            return target, mode
        problem = self._problem(target.problem.spec.name, present)
        values = dict(zip(target.problem.spec.names, target.values(mode.z).tolist(), strict=True))
        for name, belief in target.beliefs.items():
            if name not in present:
                values[name] = belief.off
        reduced = self._target(problem, target.noise)
        return reduced, reduced.descend(reduced.start(values), evaluations=25, tolerance=0.03)

    def _rigid(self, compliant: Member) -> Member:
        """The rigid model with what the compliant one's data ask for, under the same noise."""
        start = compliant.target.values(compliant.mode.z)
        values = dict(zip(compliant.target.problem.spec.names, start.tolist(), strict=True))
        target = self._target(self._problem(RIGID, tuple(self._beliefs)), compliant.target.noise)
        mode = target.descend(target.start(values), evaluations=15, tolerance=0.03)
        mode = min(mode, self._plain(target), key=lambda end: end.cost)
        if mode.cost > compliant.mode.cost + _HOPELESS:
            subsets_ = (Subset(tuple(self._groups(target)), 1.0, 0.0, mode.z, 0.0 * mode.z),)
            return Member(target, mode, subsets_, target.names, target.quadratic(mode))
        return self._member(target, target.descend(mode.z, evaluations=45, tolerance=0.03))

    def _plain(self, target: Target) -> Mode:
        """The mode from least squares of the rigid model without any nuisance."""
        bare = self._problem(RIGID, ())
        plain = fit_problem(replace(bare, priors={}), starts=2, seed=bare.settings.seed)
        values = {**{name: b.off for name, b in target.beliefs.items()}, **plain.values}
        return target.descend(target.start(values), evaluations=25, tolerance=0.03)

    def _again(self, compliant: Member, rigid: Member) -> Member:
        """The compliant member from where the rigid one is better, if that helps."""
        if rigid.mode.cost >= compliant.mode.cost:
            return compliant
        values = rigid.target.values(rigid.mode.z)
        start = dict(zip(rigid.target.problem.spec.names, values.tolist(), strict=True))
        full = self._target(self._problem(COMPLIANT, tuple(self._beliefs)), compliant.target.noise)
        start = {n: b.off for n, b in self._beliefs.items()} | start
        mode = full.descend(full.start(start), evaluations=30, tolerance=0.03)
        member = self._member(full, mode)
        target, mode = under_noise(member.target, member.mode)
        member = replace(member, target=target, mode=mode, quadratic=target.quadratic(mode))
        less = target.sum_of_squares(mode.z)
        return member if less < compliant.target.sum_of_squares(compliant.mode.z) else compliant


def _needless(name: str, silent: set[str]) -> bool:
    """Whether a nuisance touches nothing, since a muscle is silent or has no EMG."""
    if name.startswith("xt_"):
        return bool(set(name.split("_")[1:]) & silent)
    return (
        name.startswith(("emg_drift_", "emg_rest_")) and name.rsplit("_", maxsplit=1)[-1] in silent
    )


def _as_searched(name: str, median: float, spread: float) -> Belief:
    """A prior on a logarithm, as the parameter is searched."""
    if straight([name])[0]:
        return Belief(median, spread * median)
    return Belief(float(np.log(median)), spread)


def _population(problem: FitProblem) -> dict[str, Belief]:
    """What a search believes of a leg at first, weights by the torque's and the EMG's size."""
    known = population_priors(_POPULATION, problem.options)
    beliefs = {
        name: _as_searched(name, median, _WIDENED * spread)
        for name, (median, spread) in known.items()
        if name in problem.free and group_of(name) is None
    }
    for name, weight in _weights(problem).items():
        beliefs[name] = Belief(float(np.log(weight)), 1.0)
    return beliefs


def _weights(problem: FitProblem) -> dict[str, float]:
    """EMG weights that make of this EMG a torque of this size: amplifiers differ a thousandfold."""
    weights = {}
    torque = np.concatenate([t.torque for t in problem.inputs if t.torque is not None])
    emg = np.concatenate([trial.emg for trial in problem.inputs])
    low, high = np.percentile(torque - np.median(torque), [1.0, 99.0])
    for channel, name in enumerate(problem.spec.weights):
        level = float(np.percentile(emg[:, channel], 99.0))
        if name in problem.free and level > 0.0:
            pull = max(-low, 1.0) / 0.04 if channel == 0 else max(high, 1.0) / 0.05 / 3.0
            weights[name] = pull / level
    return weights
