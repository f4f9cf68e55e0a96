"""The posteriors of `model="auto"`: of the same recordings at a rate, with some departures in.

What is known of the leg, of the laboratory and of the EMG is put together once; each stage of a
search asks for the posterior that it needs.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from surae.base.names import GEOMETRY_OF
from surae.inference.coordinates import is_straight
from surae.inference.least_squares.fit import fit_problem
from surae.inference.least_squares.starts import Follow
from surae.inference.metres import filmed_paths
from surae.inference.noise import NoiseModel
from surae.inference.population_priors import WIDENED, wide_priors
from surae.inference.posterior.expected_drives import expected_drives
from surae.inference.posterior.film import names_of_film
from surae.inference.posterior.latent import Latents
from surae.inference.posterior.linearised import REST
from surae.inference.posterior.log_posterior import LogPosterior
from surae.inference.problem import MASSES, FitProblem
from surae.inference.result import TENDONS, FitResult
from surae.model import get_model, with_optional
from surae.model.laboratory import COMPLIANT, DEPARTURES, NONE, RIGID, group_of, laboratory
from surae.model.source import Gaussian
from surae.model.source_table import ARM_SIZE, GEAR
from surae.model.symmetry import ARM, GROUPS, PATH, assumed_gear, bend_of_work, length_at_rest
from surae.signals import ModelInputs, emg_levels, emg_sizes, quiet_levels, steady_emg
from surae.signals.prepare import sharpened
from surae.signals.resample import thinned, thinning_factor

#: Rates [Hz] of the first stage and of all others, and the samples that a recording keeps at least.
FIRST_HZ = 32.0
RATE_HZ = 64.0
_SAMPLES = 400
#: How far EMG at rest may be from what is expected, in standard deviations.
_REST = 6.0
#: How far lengths on paths that travel as the tendon does may be, in standard deviations.
_FAR = 2.5
#: Bounds that are wider than those of a named model's search.
_WIDER = {"m": MASSES, "dlt_tri": (1e-5, 0.3), "dlt_tib": (1e-5, 0.3)}


class Family:
    """The posteriors of a problem, which is of the family's compliant model."""

    def __init__(self, problem: FitProblem, follow: Follow | None = None) -> None:
        self._follow = follow
        self.inputs = problem.inputs  #: As they were given.
        problem = replace(problem, inputs=problem.inputs_heard)
        self.original = replace(problem, inputs=tuple(sharpened(r) for r in problem.inputs))
        settings = problem.settings
        anatomy = problem.options.anatomy
        held = {*settings.fixed, *(n for trial in problem.inputs for n in trial.fixed)}
        held |= {problem.spec.weights[channel] for channel in anatomy.silent}
        self._silent = frozenset(m for trial in problem.inputs for m in trial.missing_emg)
        filmed = {n for r in problem.inputs for f in r.films for n in names_of_film(f.channel)}
        self._beliefs = {
            name: belief
            for name, belief in laboratory(
                settings.beliefs,
                quiet_levels(problem.inputs),
                measured=settings.geometry_of == "person",
                mounted=not problem.of_inverse_dynamics,
                joint=anatomy,
            ).items()
            if name not in held
            and not _needless(name, self._silent, filmed)
            and not (name == "emg_lag" and all(r.own_envelopes for r in problem.inputs))
        }
        self._beliefs |= _of_paths(self._beliefs, problem)
        #: Paths that films tell: these are in every fit of them.
        self._told = filmed_paths(problem.inputs)
        self._options = problem.options
        if self._options.emg_ref is None:
            self._options = replace(self._options, emg_ref=emg_levels(self.inputs))
        self._emg_sizes = emg_sizes(problem.inputs)
        self._weights = _weights(problem)
        self.is_perfect = settings.nuisances == NONE  #: Whether nothing of a laboratory is unsure.
        self.is_still = self.is_perfect  #: Whether nothing is to differ from moment to moment.
        self.known = settings.known  #: Groups that are in without being asked for.
        self._thinned: dict[float, tuple[ModelInputs, ...]] = {}
        #: What each posterior counted so far, and no more of it: its rows are large.
        self._calls: list[list[int]] = []
        if problem.has_unheard:  # what such muscles do would pass for noise of the others' EMG
            self._forget_noise()

    def hold_still(self) -> None:
        """Go on with parameters alone: nothing differs from moment to moment."""
        self.is_still = True
        self._forget_noise()

    def _forget_noise(self) -> None:
        """Go on as if nothing were known of the noise of envelopes."""
        inputs = tuple(replace(trial, rectified=()) for trial in self.original.inputs)
        self.original = replace(self.original, inputs=inputs)
        self._thinned = {}

    @property
    def evaluations(self) -> int:
        """Simulations with derivatives so far, of all recordings together."""
        return sum(simulated for simulated, _ in self._calls) // len(self.inputs)

    @property
    def capped(self) -> int:
        """Descents so far that ended at a cap."""
        return sum(capped for _, capped in self._calls)

    def possible(self, groups: Sequence[str]) -> tuple[str, ...]:
        """Those of the groups of which something is not ruled out."""
        there = {group_of(name) for name in self._beliefs}
        return tuple(group for group in groups if group in there)

    def at_rate(self, rate_hz: float) -> tuple[ModelInputs, ...]:
        """The recordings at a rate."""
        if rate_hz not in self._thinned:
            self._thinned[rate_hz] = tuple(
                thinned(r, thinning_factor(r, rate_hz, _SAMPLES)) for r in self.original.inputs
            )
        return self._thinned[rate_hz]

    def inputs_with_steps(self) -> tuple[ModelInputs, ...]:
        """The recordings as they were given, with the account of what was fitted of them."""
        pairs = zip(self.inputs, self.at_rate(RATE_HZ), self.original.inputs, strict=True)
        return tuple(
            replace(whole, steps=(*whole.steps, *fitted.steps[len(same.steps) :]))
            for whole, fitted, same in pairs
        )

    def rigid(self, inputs: Sequence[ModelInputs], *, starts: int = 1, **changes: Any) -> FitResult:
        """The fit of the simplest member, from its own start and others."""
        original = self.original
        spec = get_model(RIGID)
        free = [n for n in spec.names if n in original.free]
        rigid = original.of_model(spec, free, original.by_name(original.start), original.limits)
        simpler = replace(rigid, inputs=tuple(inputs), **changes)
        return fit_problem(simpler, starts=starts, seed=original.settings.seed)

    def posterior(
        self,
        groups: Sequence[str],
        rate_hz: float,
        noise: Sequence[NoiseModel],
        sizes: Mapping[str, float],
        *,
        rest: float = REST,
        of: LogPosterior | None = None,
    ) -> LogPosterior:
        """The posterior of the recordings at a rate with these departures.

        Recordings and latents are those `of` another at this rate.
        """
        if of is not None:
            inputs = of.problem.inputs
            latents = of.latents
        else:
            inputs = tuple(expected_drives(recording) for recording in self.at_rate(rate_hz))
            latents = tuple(
                Latents.of(r, self._silent, whole.n / whole.rate_hz, perfect=self.is_perfect)
                for r, whole in zip(inputs, self.original.inputs, strict=True)
            )
        original = self.original
        beliefs = {
            name: belief
            for name, belief in self._beliefs.items()
            if (group := group_of(name)) not in DEPARTURES
            or group in {*groups, *self.known}
            or name in self._told
        }
        spec = get_model(COMPLIANT)
        more = [n for n in (*beliefs, *original.spec.optional) if n not in spec.names]
        spec = with_optional(spec, more)
        limits = original.limits
        # priors hold them, and not the bounds of a search
        limits |= {n: pair for n, pair in _WIDER.items() if n not in original.settings.bounds}
        for name, belief in beliefs.items():
            # amplifiers differ a thousandfold, and a child's arms are half an adult's
            group = group_of(name)
            far = group == "length" and self._options.travel == "virtual-work"
            if group == "rest" or (group == "arm" and belief.mean) or far:
                reach = (_FAR if far else _REST) * belief.sd
                limits[name] = (belief.mean - reach, belief.mean + reach)
        free = [n for n in spec.names if n in original.free or n in beliefs]
        problem = original.of_model(
            spec,
            free,
            original.by_name(original.start),
            limits,
            options=self._options,
            inputs=inputs,
        )
        priors = self._leg(problem) | {
            n: b if is_straight(n) else b.on_logarithm() for n, b in beliefs.items()
        }
        made = LogPosterior(
            problem, priors, noise, latents, sizes, beliefs=beliefs, rate_hz=rate_hz, rest=rest
        )
        made.follow = self._follow
        self._calls.append(made.observed.calls)
        return made

    def like(self, of: LogPosterior, groups: Sequence[str]) -> LogPosterior:
        """The posterior with other departures, of what has been learnt with those of another."""
        made = self.posterior(groups, of.rate_hz, of.noise, of.sizes, of=of)
        return made.having(fast=of.fast)

    def _leg(self, problem: FitProblem) -> dict[str, Gaussian]:
        """What is known of the leg's own parameters, as they are searched."""
        wide = wide_priors(problem.options, problem.inputs[0].emg_unit, self._emg_sizes)
        # widened, a Gaussian would believe as much in a rigid one
        for name in {*TENDONS} - {*problem.options.anatomy.parameters}:
            wide[name] = (wide[name][0], wide[name][1] / WIDENED)
        wide |= {name: (weight, 1.0) for name, weight in self._weights.items()}
        knowledge = problem.settings.knowledge
        if knowledge is not None and knowledge.mass is not None:
            wide["m"] = knowledge.mass
        wide |= {n: (p.median, p.spread) for n, p in problem.priors.items()}
        return {
            name: Gaussian(median, spread * median)
            if is_straight(name)
            else Gaussian(float(np.log(median)), spread)
            for name, (median, spread) in wide.items()
            if name in problem.free
        }


def _of_paths(beliefs: Mapping[str, Gaussian], problem: FitProblem) -> dict[str, Gaussian]:
    """Priors that the assumed paths give, of what was not stated.

    A path bends about as it does where it does work. Where it travels as the tendon does, lengths
    are known only as well as the share that fascicles have of it, unless they are the person's.
    """
    given = problem.settings.beliefs
    stated = {} if isinstance(given, str) else given
    options = problem.options
    priors = dict[str, Gaussian]()
    for group in GROUPS:
        bend = f"path_bend_{group}"
        if bend in beliefs and not {bend, "bend"} & stated.keys():
            priors[bend] = replace(beliefs[bend], mean=bend_of_work(options, group))
        length = f"length_zero_{group}"
        stated_path = (
            problem.settings.geometry_of == GEOMETRY_OF[1] or {length, "length"} & stated.keys()
        )
        if length in beliefs and options.travel == "virtual-work" and not stated_path:
            sd = GEAR.sd * abs(length_at_rest(options, group))
            priors[length] = replace(beliefs[length], sd=max(sd, beliefs[length].sd))
    return priors | _of_films(beliefs, problem)


def _of_films(beliefs: Mapping[str, Gaussian], problem: FitProblem) -> dict[str, Gaussian]:
    """What is known beforehand of paths that films tell: people's gear and arm, if not their own.

    ln path = ln gear + ln arm; where paths are stated, or the person's, that stays.
    """
    given = problem.settings.beliefs
    stated = {} if isinstance(given, str) else given
    by_film = problem.settings.geometry_of == GEOMETRY_OF[1] or {PATH, "arm"} & stated.keys()
    priors = dict[str, Gaussian]()
    for name in sorted(filmed_paths(problem.inputs) & beliefs.keys() - stated.keys()):
        group = name.removeprefix(f"{PATH}_")
        gear = assumed_gear(problem.options, group)
        if by_film or not np.isfinite(gear):
            continue
        arm = beliefs.get(f"{ARM}_{group}", beliefs[name])
        mean = GEAR.mean - float(np.log(gear)) + arm.mean
        priors[name] = replace(beliefs[name], mean=mean, sd=float(np.hypot(GEAR.sd, ARM_SIZE)))
    return priors


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
