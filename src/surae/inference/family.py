"""`model="auto"`: the mode of one posterior, and which departures the data ask for.

1. Thinned data without departures, noise taken for much greater than it is: a surface with one
   valley. The noise is lowered to what the residual says (continuation). From a fast and from a
   slow relaxation, for those are two valleys.
2. All departures, their sizes and that of the latents learnt from the data.
3. The evidence of every set of departures, from one Laplace approximation; the best is solved anew.
4. Where the residual under effort is much greater than at rest, the size of the drive's error is
   sought by evidence, before the departures are chosen, if every muscle has an electrode.
5. What makes the mode unsure, source by source (`surae.inference.laplace`).
"""

import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.base.progress import SearchProgress
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.coordinates import is_straight
from surae.inference.evidence import Subset, subsets, with_likely
from surae.inference.film import names_of_film
from surae.inference.fit import fit_problem
from surae.inference.interrupt import postponed_interrupt
from surae.inference.latent import SOURCES, Latents
from surae.inference.learning import (
    effort_ratio,
    explained,
    followed,
    learnt_films,
    learnt_noise,
    learnt_sizes,
)
from surae.inference.least_squares import Outcome
from surae.inference.noise import NoiseModel
from surae.inference.observed import REST, Observed, measured
from surae.inference.population import WIDENED, wide_priors
from surae.inference.posterior import LogPosterior, Point
from surae.inference.problem import MASSES, FitProblem
from surae.inference.residuals import simulators
from surae.inference.result import TENDONS, FitResult, PosteriorMode, Stage, Start
from surae.inference.summed import summed
from surae.model import get_model, with_optional
from surae.model.laboratory import (
    COMPLIANT,
    DEPARTURES,
    LAWS,
    NONE,
    RARE,
    RIGID,
    group_of,
    laboratory,
)
from surae.model.sources import Gaussian
from surae.signals import ModelInputs, emg_levels, quiet_levels, steady_emg
from surae.signals.prepare import sharpened
from surae.signals.rectified import expected_drives
from surae.signals.resample import thinned, thinning_factor

#: Rates [Hz] of the search's stages, and the samples that each recording keeps at least.
_RATES, _SAMPLES = (32.0, 64.0), 400
#: Active state over which it reaches zero at each rate until departures are chosen [N].
_ROUNDED = (30.0, 3.0)
#: Relaxation times [s] and factor from which a search begins.
_RELAXATIONS, _RELAXED = (0.4, 4.0), 0.3
#: Noise that a search begins with, as a part of the torque's changes.
_TEMPER = 0.1
#: Standard deviations of the latents before anything is learnt, those above which parameters have
#: to explain the torque, and those of none.
_BEGIN = {"gain": 0.03, "drift": 0.1, "misfit": 0.01}
_MOST = {"gain": 0.15, "drift": 1.0, "misfit": 0.06}
_NEARLY_NONE = {"gain": 1e-3, "drift": 1e-2, "misfit": 1e-3}
#: Rounds in which noise and sizes are learnt at most, and the part of each standard deviation below
#: which the mode rests.
_ROUNDS, _AT_REST = 5, 0.1
#: Standard deviations, noise taken for much greater than it is, within which two starts are in one
#: valley.
_ALIKE = 1.0
#: By how much more −2 ln p, noise taken for so much, a start is left behind; damping far away.
_BEHIND, _AFAR = 10.0, 0.1
#: What is to be gained in −2 ln p where a search ends: the square of 0.03 standard deviations.
_ENDS = 1e-3
#: Rounds of a search's end at most, and the part of a standard deviation, of the noise and of the
#: sizes by which nothing moves any more where it rests.
_LAST, _RESTS = 8, 0.02
#: Slow residual under effort over that at rest from which errors of the drive are sought, and their
#: standard deviations that are tried.
_LOUDER, _ERRORS = 1.6, (0.06, 0.11, 0.15, 0.21)
#: Part of the torque's changes that parameters alone have to follow before: of a model that follows
#: less, what is left is not the EMG's.
_FOLLOWED = 0.8
#: By how much less of the torque's variance parameters may follow than before a stage of the
#: search, or than those of the simplest member do.
_LESS = 0.005
#: Odds beforehand that a leg or laboratory has a departure.
_ODDS = 0.3
#: Probability from which the joint's spring, of which the ankle's stiffness is made, is in, and a
#: plate beside it, whose weight goes with the angle as the spring does.
_LIKELY = 0.1
#: What a rare departure has to gain in −2 ln Z from one point, very strong evidence (Kass and
#: Raftery, JASA 90 (1995) 773), and the standard deviations by which it has to be there.
_ASKED, _MOVED = 10.0, 3.0
#: Departures beside it, but for these two, from which a rare one is left out: of virtual legs that
#: depart in all ways at once half of what was then called known was false.
_SEVERAL, _PLAIN = 2, ("reflex", "spring")
#: How far EMG at rest may be from what is expected, in standard deviations.
_REST = 6.0
#: Bounds that are wider than those of a named model's search.
_WIDER = {"m": MASSES, "dlt_tri": (1e-5, 0.3), "dlt_tib": (1e-5, 0.3)}


def fit_family(problem: FitProblem, *, progress: SearchProgress | None = None) -> FitResult:
    """Find the mode of a leg's posterior and all that makes it unsure.

    The problem is of the family's compliant model; which nuisances may be in, its settings say.
    `progress` is called with stages that are done, how many there are, and −2 ln p. Ctrl-C keeps
    the rigid model by least squares.
    """
    begin = time.perf_counter()
    search = _Search(problem, progress)
    with one_blas_thread(), postponed_interrupt():
        try:
            result = search.result()
        except KeyboardInterrupt:
            result = search.stopped()
    return replace(result, seconds=time.perf_counter() - begin)


def resumed(result: FitResult) -> tuple[LogPosterior, Point]:
    """The posterior that a fit of `fit_family` chose, and its mode."""
    family = result.found
    assert isinstance(family, PosteriorMode)
    with one_blas_thread():
        search = _Search(result.problem, None)
        if family.sizes["gain"] == _NEARLY_NONE["gain"]:
            search._hold()
        post = search._posterior(family.candidates[0].groups, _RATES[1], family.noise, family.sizes)
        if len(family.films) != sum(len(own.films) for own in post.latents):
            raise InputError("this fit kept no noise of its films: fit again")
        noise = iter(family.films)
        latents = tuple(
            replace(own, films=tuple([replace(film, noise=next(noise)) for film in own.films]))
            for own in post.latents
        )
        fast = None if search._perfect else family.sizes.get("drive")
        post = post.having(latents=latents, fast=fast)
        z = post.start(result.values)
        for j, name in enumerate(post.own):
            if name in family.each:  # older fits share the EMG at rest
                post.each(z)[:, j] = family.each[name]
        return post, post.descend(z, evaluations=20, tolerance=1e-3)


_Stage = tuple[LogPosterior, Point]  #: Where the search has come to.


class _Search:
    """One search."""

    def __init__(self, problem: FitProblem, progress: SearchProgress | None) -> None:
        self._progress, self._inputs = progress, problem.inputs
        problem = replace(problem, inputs=problem.heard)
        self._original = replace(problem, inputs=tuple(sharpened(r) for r in problem.inputs))
        held = {*problem.settings.fixed, *(n for trial in problem.inputs for n in trial.fixed)}
        self._silent = frozenset(m for trial in problem.inputs for m in trial.missing_emg)
        held |= {problem.spec.weights[channel] for channel in problem.options.anatomy.silent}
        filmed = {n for r in problem.inputs for f in r.films for n in names_of_film(f.channel)}
        self._beliefs = {
            name: belief
            for name, belief in laboratory(
                problem.settings.beliefs,
                quiet_levels(problem.inputs),
                measured=problem.settings.geometry_of == "person",
                mounted=not problem.of_inverse_dynamics,
                joint=problem.options.anatomy,
            ).items()
            if name not in held
            and not _needless(name, self._silent, filmed)
            and not (name == "emg_lag" and all(r.own_envelopes for r in problem.inputs))
        }
        self._options = problem.options
        if self._options.emg_ref is None:
            self._options = replace(self._options, emg_ref=emg_levels(problem.inputs))
        self._weights = _weights(problem)
        self._perfect = problem.settings.nuisances == NONE
        self._known = problem.settings.known  #: Groups that are in without being asked for.
        self._moved = 0.0  #: How far the last round of the search went, in standard deviations.
        self._thinned: dict[float, tuple[ModelInputs, ...]] = {}
        if problem.has_unheard:  # what such muscles do would pass for noise of the others' EMG
            self._forget_noise()
        self._still = self._perfect  #: Whether nothing is to differ from moment to moment.
        self._met: list[tuple[float, Start]] = []  #: −2 ln p of each start's end, and the start.
        self._observed: list[Observed] = []  #: What has been simulated so far.
        self._stages: list[Stage] = []

    def result(self) -> FitResult:
        """Search, choose, and sum up."""
        values, noise = self._first()
        self._stage("starts", 1, min(cost for cost, _ in self._met))
        simplest, most = self._simplest()
        chosen = self._choose(values, noise)
        self._stage("departures", 2, chosen[1].cost)
        share = followed(*chosen[:2], self._inputs)
        if share < most - _LESS:
            # latents have taken what parameters can follow: without them, and from where these do
            self._hold()
            again = self._choose(simplest, noise)
            self._stage("again", 2, again[1].cost)
            if (other := followed(*again[:2], self._inputs)) > share:
                chosen, share = again, other
        rests = self._moved < _RESTS
        outcome = str(Outcome.CONVERGED if rests else Outcome.ITERATIONS)
        result = summed(*chosen, self._inputs, self._original, self._met, self._stages, outcome)
        if not rests:
            more = Message("ended/moving", message=result.message, moved=self._moved)
            result = replace(result, message=more)
        if share >= most - _LESS or result.status == "failed":
            return result
        message = Message("ended/lost", share=100 * share, most=100 * most, model=RIGID)
        return replace(result, status="failed", message=message)

    def _hold(self) -> None:
        """Search on with parameters alone: nothing differs from moment to moment."""
        self._still = True
        self._forget_noise()

    def _forget_noise(self) -> None:
        """Search on as if nothing were known of the noise of envelopes."""
        inputs = tuple(replace(trial, rectified=()) for trial in self._original.inputs)
        self._original, self._thinned = replace(self._original, inputs=inputs), {}

    def _simplest(self) -> tuple[Mapping[str, float], float]:
        """Values of the simplest member, and the part of the torque's variance they follow."""
        plain = self._rigid(self._given(_RATES[1]))
        whole = replace(plain.problem, inputs=self._inputs)
        values = whole.spec.vector(plain.values, whole.options)
        both = zip(simulators(whole), self._inputs, strict=True)
        return plain.values, explained(
            self._inputs, [s.torque(values) - measured(r) for s, r in both]
        )

    def _rigid(self, inputs: Sequence[ModelInputs], **changes: Any) -> FitResult:
        """The fit of the simplest member, from its own start."""
        original, spec = self._original, get_model(RIGID)
        free = [n for n in spec.names if n in original.free]
        rigid = original.of_model(spec, free, original.by_name(original.start), original.limits)
        return fit_problem(replace(rigid, inputs=tuple(inputs), **changes), starts=1)

    def stopped(self) -> FitResult:
        """What is kept where the user stopped: the rigid model, nothing weighed."""
        plain = self._rigid(self._inputs, priors=FrozenDict())
        code = "ended/rigid-without" if self._original.priors else "ended/rigid"
        return replace(
            plain,
            message=Message(code),
            found=replace(plain.found, outcome=str(Outcome.INTERRUPTED)),
        )

    @property
    def _evaluations(self) -> int:
        """Simulations with derivatives so far, of all recordings together."""
        simulated = sum(observed.simulated for observed in self._observed)
        return simulated // len(self._inputs)

    def _stage(self, name: str, number: int, cost: float) -> None:
        before = sum(stage.evaluations for stage in self._stages)
        capped = sum(observed.calls[1] for observed in self._observed)
        capped -= sum(stage.capped for stage in self._stages)
        self._stages.append(Stage(name, self._evaluations - before, float(cost), capped))
        if self._progress is not None:
            self._progress(number, 2, min(cost for cost, _ in self._met))

    def _posterior(
        self, groups: Sequence[str], rate_hz: float, noise: Sequence[NoiseModel],
        sizes: Mapping[str, float], like: LogPosterior | None = None, rest: float = REST,
    ) -> LogPosterior:  # fmt: skip
        """The posterior of the data at a rate with these departures."""
        original = self._original
        if like is not None and like.rate_hz == rate_hz:
            inputs, latents = like.problem.inputs, like.latents
        else:
            each = original.inputs
            inputs = tuple(expected_drives(recording) for recording in self._given(rate_hz))
            latents = tuple(
                Latents.of(r, self._silent, whole.n / whole.rate_hz, perfect=self._perfect)
                for r, whole in zip(inputs, each, strict=True)
            )
        beliefs = {
            name: belief
            for name, belief in self._beliefs.items()
            if (group := group_of(name)) not in DEPARTURES or group in {*groups, *self._known}
        }
        spec = get_model(COMPLIANT)
        more = [n for n in (*beliefs, *original.spec.optional) if n not in spec.names]
        spec = with_optional(spec, more)
        limits = original.limits
        # priors hold them, and not the bounds of a search
        limits |= {n: pair for n, pair in _WIDER.items() if n not in original.settings.bounds}
        for name, belief in beliefs.items():
            if group_of(name) == "rest":  # amplifiers differ a thousandfold
                limits[name] = (belief.mean - _REST * belief.sd, belief.mean + _REST * belief.sd)
        free = [n for n in spec.names if n in original.free or n in beliefs]
        problem = original.of_model(
            spec, free, original.by_name(original.start), limits,
            options=self._options, inputs=inputs,
        )  # fmt: skip
        priors = self._leg(problem) | {n: _searched(n, b) for n, b in beliefs.items()}
        made = LogPosterior(
            problem, priors, noise, latents, sizes, beliefs=beliefs, rate_hz=rate_hz,
            rest=rest,
        )  # fmt: skip
        self._observed.append(made.observed)
        return made

    def _given(self, rate_hz: float) -> tuple[ModelInputs, ...]:
        """The recordings at the rate of a stage."""
        if rate_hz not in self._thinned:
            self._thinned[rate_hz] = tuple(
                thinned(r, thinning_factor(r, rate_hz, _SAMPLES)) for r in self._original.inputs
            )
        return self._thinned[rate_hz]

    def _followed(self, stage: _Stage) -> float:
        """Part of the torque's variance that a stage's parameters follow, of EMG as it is."""
        return followed(*stage, self._given(stage[0].rate_hz))

    def _is_worse(self, stage: _Stage, before: _Stage) -> bool:
        """Whether latents have taken of the torque what parameters alone followed before."""
        return self._followed(stage) < self._followed(before) - _LESS

    def _leg(self, problem: FitProblem) -> dict[str, Gaussian]:
        """What is known of the leg's own parameters, as they are searched."""
        wide = wide_priors(problem.options, problem.inputs[0].emg_unit)
        # widened, a Gaussian would believe as much in a rigid one
        for name in {*TENDONS} - {*problem.options.anatomy.parameters}:
            wide[name] = (wide[name][0], wide[name][1] / WIDENED)
        wide |= {name: (weight, 1.0) for name, weight in self._weights.items()}
        wide |= {n: (p.median, p.spread) for n, p in problem.priors.items()}
        return {
            name: Gaussian(median, spread * median)
            if is_straight(name)
            else Gaussian(float(np.log(median)), spread)
            for name, (median, spread) in wide.items()
            if name in problem.free
        }

    def _first(self) -> tuple[dict[str, float], tuple[NoiseModel, ...]]:
        """Values without departures from thinned data, and the noise they leave."""
        white = _white(self._original, _TEMPER)
        post = self._posterior((), _RATES[0], white, _NEARLY_NONE, rest=_ROUNDED[0])
        runs: list[tuple[FloatArray, Point, int]] = []
        for relaxation in _RELAXATIONS:
            given = {"tau_rel": relaxation, "k_rel": _RELAXED, **self._original.settings.start}
            near = post.by_name(runs[0][1].z) if runs else {}
            begin, before = post.start(near | given), self._evaluations
            end = post.descend(begin, evaluations=15, tolerance=3.0, damping=_AFAR)
            runs.append((begin, end, self._evaluations - before))
        best = min((end for _, end, _ in runs), key=lambda end: end.cost)
        reach, before = _ALIKE * np.sqrt(np.diag(post.covariance(best))), self._evaluations
        lowest = own = self._quieter(post, best)
        for begin, end, spent in runs:
            own, behind = lowest, end.cost - best.cost
            if np.any(np.abs(end.z - best.z) > reach):  # of another valley
                # at less noise what is far behind is farther behind
                doubtful = behind < _BEHIND
                own = self._quieter(post, end) if doubtful else (lowest[0] + behind, post, end)
            total, before = spent + self._evaluations - before, self._evaluations
            self._met.append((own[0], _started(own[1], begin, own[2], total)))
            lowest = min(lowest, own, key=lambda each: each[0])
        return lowest[1].by_name(lowest[2].z), lowest[1].noise

    def _quieter(self, post: LogPosterior, point: Point) -> tuple[float, LogPosterior, Point]:
        """The noise lowered to what the residual says, in turn with the mode; −2 ln p."""
        post = post.having(sizes=_BEGIN)
        post = post.having(noise=learnt_noise(post, post.again(point), white=True))
        point = post.descend(point.z, point.c, evaluations=20, tolerance=1.0)
        each = zip(post.problem.inputs, post.noise, strict=True)
        widths = sum(recording.n * np.log(noise.variance) for recording, noise in each)
        return float(point.cost + widths), post, point

    def _learnt(
        self, post: LogPosterior, point: Point, rounds: int, *, white: bool = False,
        evaluations: int = 10, tolerance: float = 0.1,
    ) -> tuple[LogPosterior, Point]:  # fmt: skip
        """Noise and sizes of the latents in turn with the mode, until it rests."""
        for _ in range(rounds):
            sizes = _NEARLY_NONE
            if not self._still:
                learnt = learnt_sizes(post, point, _BEGIN)
                sizes = {s: min(learnt[s], _MOST[s]) for s in SOURCES}
            noise, latents = learnt_noise(post, point, white=white), learnt_films(post, point)
            post = post.having(noise=noise, sizes=sizes, latents=latents)
            moved = post.descend(
                point.z, point.c, point.w, evaluations=evaluations, tolerance=tolerance,
                damping=point.damping,
            )  # fmt: skip
            sd = np.sqrt(np.diag(post.covariance(moved)))
            if np.all(np.abs(moved.z - point.z) < _AT_REST * sd):
                return post, moved
            point = moved
        return post, point

    def _choose(
        self, values: Mapping[str, float], noise: Sequence[NoiseModel]
    ) -> tuple[LogPosterior, Point, tuple[Subset, ...], tuple[str, ...]]:
        """The posterior with what the data ask for, its mode, all sets, what their modes are of."""
        possible = tuple(
            group
            for group in DEPARTURES
            if group not in (*self._known, *RARE)
            and any(group_of(n) == group for n in self._beliefs)
        )
        sizes = _NEARLY_NONE if self._still else _BEGIN
        post = self._posterior(possible, _RATES[0], noise, sizes, rest=_ROUNDED[0])
        point = post.descend(post.start(values), evaluations=20, tolerance=1.0)
        post, point = self._learnt(post, point, 2, white=True, evaluations=12, tolerance=0.3)
        full = self._posterior(possible, _RATES[1], post.noise, post.sizes, rest=_ROUNDED[1])
        point = full.descend(full.like(post, point.z), point.c, evaluations=10, tolerance=0.3)
        if full.rectified and not self._still:  # what that noise does is no error of the model
            full = full.having(fast=0.0, sizes=_BEGIN)
            point = full.descend(point.z, evaluations=25, tolerance=0.3)
        full, point = self._learnt(full, point, _ROUNDS)
        if rare := self._rare(full, point, possible):
            more = self._posterior((*possible, *rare), _RATES[1], full.noise, full.sizes, full)
            more, z = more.having(fast=full.fast), more.like(full, point.z)
            there = more.descend(z, point.c, point.w, evaluations=25, tolerance=0.3)
            more, there = self._learnt(more, there, _ROUNDS)
            beside = {*self._scored(more, there, (*possible, *rare))[0].groups} - {*rare, *_PLAIN}
            if len(beside) < _SEVERAL:
                full, point, possible = more, there, (*possible, *rare)
        # which departures there are would hide behind it; what muscles do that no electrode hears
        # is loud under effort as well, and no error of another's EMG
        louder = not self._original.has_unheard and effort_ratio(full, point) > _LOUDER
        if louder and not self._still and self._followed((full, point)) > _FOLLOWED:
            full, point = self._with_drive_errors(full, point, _ERRORS)
        scored = self._scored(full, point, possible)
        scored = with_likely(scored, "spring", "plate", _LIKELY)
        own = self._posterior(scored[0].groups, _RATES[1], full.noise, full.sizes, full)
        own = own.having(fast=full.fast)
        mode = scored[0].mode
        best = own.descend(
            own.like(full, mode), *point.latents_at(mode), evaluations=15, tolerance=0.1
        )
        own, best = self._learnt(own, best, 2 if own.fast else _ROUNDS)
        if own.fast is None and not self._perfect:
            own, best = self._with_drive_errors(own, best, ())
        own, best = self._rested(own, best)
        return own, best, scored, full.names

    def _scored(
        self, post: LogPosterior, point: Point, groups: Sequence[str]
    ) -> tuple[Subset, ...]:
        """All sets of these groups, of one quadratic."""
        positions: dict[str, list[int]] = {group: [] for group in groups}
        off: dict[int, float] = {}
        for j, name in enumerate(post.names):
            if name in self._beliefs and (group := group_of(name)) in positions:
                positions[group].append(j)
                off[j] = self._beliefs[name].off
        return subsets(post.laplace(point), positions, off, odds=dict.fromkeys(groups, _ODDS))

    def _rare(self, full: LogPosterior, point: Point, groups: tuple[str, ...]) -> tuple[str, ...]:
        """Rare departures that the data ask for, each alone beside these, from one point."""
        there = tuple(g for g in RARE if any(group_of(n) == g for n in self._beliefs))
        more = self._posterior((*groups, *there), _RATES[1], full.noise, full.sizes, full)
        more, z = more.having(fast=full.fast), more.like(full, point.z)
        of = [group_of(name) for name in more.names]
        for j, name in enumerate(more.names):
            z[j] = self._beliefs[name].off if of[j] in there else z[j]
        sets = {s.groups: s for s in self._scored(more, more.again(replace(point, z=z)), there)}
        gained = {}
        for group in there:
            own, at = sets[group,], [j for j, each in enumerate(of) if each == group]
            if np.any(own.mode[at] - z[at] > _MOVED * np.sqrt(own.variance[at])):
                gained[group] = sets[()].evidence - own.evidence
        asked = sorted((g for g in gained if gained[g] > _ASKED), key=lambda g: -gained[g])
        laws = [group for group in asked if group in LAWS]
        return tuple(group for group in asked if group not in laws[1:])

    def _rested(self, own: LogPosterior, best: Point) -> _Stage:
        """The fixed point of noise, sizes and mode."""
        for _ in range(_LAST):
            before, at, sd = own, best, np.sqrt(np.diag(own.covariance(best)))
            own, best = self._learnt(own, best, 1, evaluations=20, tolerance=_ENDS)
            sizes = [own.sizes[s] / before.sizes[s] for s in SOURCES]
            both = zip(own.noise, before.noise, strict=True)
            sizes += [np.sqrt(new.variance / old.variance) for new, old in both]
            self._moved = float(max(*(np.abs(best.z - at.z) / sd), *np.abs(np.log(sizes))))
            if best.rested and self._moved < _RESTS:
                break
        else:
            self._moved = max(self._moved, _RESTS)
        return own, best

    def _with_drive_errors(
        self, own: LogPosterior, point: Point, sizes: Sequence[float]
    ) -> tuple[LogPosterior, Point]:
        """The errors of the drives, at the muscles' frequencies as great as the data ask for."""
        post, there = own, point
        if own.fast is None:
            post = own.having(fast=0.0)
            there = post.descend(point.z, point.c, evaluations=12, tolerance=0.1)
        if not sizes:
            found = self._learnt(post, there, 1, evaluations=8)
            return (own, point) if self._is_worse(found, (own, point)) else found
        # the evidence of each is with white noise that it leaves itself
        quiet = post.having(noise=learnt_noise(post, there, white=True, anew=True))
        at = quiet.descend(there.z, there.c, there.w, evaluations=8, tolerance=0.1)
        quiet = quiet.having(noise=learnt_noise(quiet, at, white=True, anew=True))
        tried = {0.0: (quiet.evidence(quiet.again(at)), post, there)}

        def better(size: float) -> bool:
            """Whether this size is the best so far."""
            # slow latents begin anew, for they have followed what is fast
            post = own.having(fast=size, sizes=_BEGIN)
            there = post.descend(point.z, evaluations=25, tolerance=0.1)
            post, there = self._learnt(post, there, 2, evaluations=8)
            tried[size] = (post.evidence(there), post, there)
            return min(tried, key=lambda s: tried[s][0]) == size

        low, middle, high, highest = sizes
        if better(middle):
            better(highest if better(high) else low)
        found = min(tried.values(), key=lambda each: each[0])[1:]
        return (own, point) if self._is_worse(found, (own, point)) else found


def _started(post: LogPosterior, begin: FloatArray, point: Point, evaluations: int) -> Start:
    """What is told of a start: where it began and ended, and by how many evaluations."""
    first, last = (
        {n: by[n] for n in post.problem.free} for by in map(post.by_name, (begin, point.z))
    )
    sse = sum(
        float(np.sum(post.observed.residual(point.z, *no, i) ** 2))
        for i, no in enumerate(zip(post.still(), post.expected(), strict=True))
    )
    outcome = Outcome.CONVERGED if point.rested else Outcome.ITERATIONS
    return Start(first, last, sse, str(outcome), evaluations)


def _white(problem: FitProblem, part: float) -> tuple[NoiseModel, ...]:
    """White noise of a part of each recording's torque changes, for the beginning of a search."""
    models = []
    for recording in problem.inputs:
        deviation = part * float(np.std(recording.torque)) if recording.torque is not None else 1.0
        models.append(NoiseModel.white(max(deviation, 1e-9) ** 2, float(recording.n)))
    return tuple(models)


def _searched(name: str, belief: Gaussian) -> Gaussian:
    """A nuisance's prior as it is searched: of what is on a logarithm, with its mean and sd."""
    if is_straight(name):
        return belief
    spread = float(np.sqrt(np.log1p((belief.sd / belief.mean) ** 2)))
    return Gaussian(float(np.log(belief.mean)) - 0.5 * spread**2, spread)


def _needless(name: str, silent: frozenset[str], filmed: Collection[str]) -> bool:
    """Whether a nuisance touches nothing: a muscle is silent, has no EMG, or was not filmed."""
    if name.startswith("film_"):
        return name not in filmed
    if name.startswith("xt_"):
        return bool(set(name.split("_")[1:]) & silent)
    return name.startswith("emg_rest_") and name.rsplit("_", maxsplit=1)[-1] in silent


def _weights(problem: FitProblem) -> dict[str, float]:
    """EMG weights that make of this EMG a torque of this size: amplifiers differ a thousandfold.

    Not of steady EMG, which may have made none of the torque.
    """
    weights = {}
    torque = np.concatenate([t.torque for t in problem.inputs if t.torque is not None])
    emg = np.concatenate([trial.emg for trial in problem.inputs])
    low, high = np.percentile(torque - np.median(torque), [1.0, 99.0])
    steady = steady_emg(problem.inputs)
    for channel, name in enumerate(problem.spec.weights):
        level = float(np.percentile(emg[:, channel], 99.0))
        if name in problem.free and level > 0.0 and not steady[channel]:
            pull = max(-low, 1.0) / 0.04 if channel == 0 else max(high, 1.0) / 0.05 / 3.0
            weights[name] = pull / level
    return weights
