"""The fit at a mode of the posterior: values, and what makes them unsure, source by source."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.base.frozen import FrozenDict, read_only
from surae.base.units import FloatArray
from surae.base.versions import versions
from surae.base.words import Message
from surae.inference.evidence import Subset, inverse_of
from surae.inference.least_squares.minimise import Outcome
from surae.inference.least_squares.residuals import jacobian_root
from surae.inference.posterior import laplace
from surae.inference.posterior.conflict import (
    FAR_ZERO,
    SAID,
    ZERO_NAME,
    Conflict,
    conflicts,
    with_zero,
)
from surae.inference.posterior.departures import Chosen
from surae.inference.posterior.family import Family
from surae.inference.posterior.log_posterior import LogPosterior, Point
from surae.inference.posterior.mounting import mountings
from surae.inference.problem import FitProblem
from surae.inference.relaxed.cut import doubts_of
from surae.inference.result import (
    LARGEST,
    TENDONS,
    Candidate,
    FitResult,
    Mounting,
    OfRecording,
    PosteriorMode,
    Stage,
    Start,
    at_bounds,
)
from surae.model.laboratory import COMPLIANT, group_of, laboratory
from surae.model.source import Gaussian
from surae.model.source_table import NUISANCES

#: Parameters of tissue, whose exponentials are the best there are where rest tells another curve.
_TISSUE = ("k_tri", "k_tib", "x0_tri", "x0_tib", "k_rel", "tau_rel", "joint_stiffness")
#: Ends of starts agree whose −2 ln p differ by less.
_ALIKE = 2.0


def summed(
    chosen: Chosen,
    family: Family,
    met: Sequence[tuple[float, Start]],
    stages: Sequence[Stage],
    outcome: str,
) -> FitResult:
    """The fit at a mode, and what makes it unsure."""
    post = chosen.posterior
    point = chosen.mode
    original = family.original
    inputs = family.inputs_with_steps()
    V = post.covariance(point)
    against, turned, mounted = _against(post, point, original)
    contradicted = {g: c.probability for g, c in against.items() if c.probability < SAID}
    zero = against.pop(ZERO_NAME, None)
    problem = replace(post.problem, inputs=inputs)
    problem = post.metres.limits(problem, post.values(point.z))
    change = _natural(post, point)
    shifts = _shifts(chosen, family, V, against)
    spread = {source: read_only(by @ change.T) for source, by in shifts.items() if len(by)}
    covariance = sum((by.T @ by for by in spread.values()), np.zeros((len(problem.free),) * 2))
    values = post.by_name(point.z)
    residuals = tuple(
        read_only(-post.observed.plain_residual(point.z, recording, number))
        for number, recording in enumerate(inputs)
    )
    sse = sum(float(np.sum(r.weights * e**2)) for r, e in zip(inputs, residuals, strict=True))
    finite = bool(np.isfinite(sse) and np.isfinite(covariance).all())
    bound = [n for n in at_bounds(problem, values, TENDONS) if group_of(n) is None]
    best = min(cost for cost, _ in met)
    return FitResult(
        problem=problem,
        status="failed" if not finite else "at-bounds" if bound else "converged",
        message=_message(chosen.sets, bound, finite),
        values=values,
        residuals=residuals,
        sse=sse,
        R=read_only(jacobian_root(problem, values)),
        seed=original.settings.seed,
        seconds=0.0,
        versions=versions(),
        solution=PosteriorMode(
            starts=tuple(start for _, start in met),
            agreeing=sum(cost - best < _ALIKE for cost, _ in met),
            stages=tuple(stages),
            outcome=outcome if finite else str(Outcome.NOT_FINITE),
            candidates=_candidates(chosen.sets, values),
            beliefs=FrozenDict(post.in_metres(post.beliefs, point.z)),
            noise=post.noise,
            films=tuple(film.noise for each in post.latents for film in each.films),
            each=FrozenDict(
                zip(post.per_recording, map(tuple, post.each(point.z).T.tolist()), strict=True)
            ),
            spread=FrozenDict(spread),
            sizes=FrozenDict(post.sizes | ({} if post.fast is None else {"drive": post.fast})),
            population=FrozenDict(
                post.in_metres({n: post.priors[n] for n in post.names if not group_of(n)}, point.z)
            ),
            recordings=_each(post, point, change) if len(inputs) > 1 else (),
            contradicted=FrozenDict(contradicted),
            gained=_gained(post, point),
            zero_wider=max(zero.ratio, 1.0) if zero else 1.0,
            softening=tuple(laplace.softened(post, point, V)),
            mountings=mounted,
            turned=FrozenDict(zip(problem.free, (change @ turned).tolist(), strict=True)),
        ),
    )


def _shifts(
    chosen: Chosen, family: Family, V: FloatArray, against: Mapping[str, Conflict]
) -> dict[str, FloatArray]:
    """Shifts of what is searched by each source of uncertainty, rows of (k, q).

    `V` is the covariance at the mode, `against` what contradicts what was stated.
    """
    post = chosen.posterior
    blocks = chosen.mode.blocks
    original = family.original
    shifts = laplace.shifts_by_source(post, blocks, V)
    departures = laplace.between_subsets(chosen.sets, chosen.names, post, V)
    beta = post.by_name(chosen.mode.z).get("beta", 1.0)
    shifts["model"] = np.concatenate([departures, laplace.dynamics(post, V, beta, unheard=False)])
    if original.has_unheard:
        shifts["unheard"] = laplace.dynamics(post, V, beta, unheard=True)
    shifts["heads"] = laplace.between_heads(post, post.by_name(chosen.mode.z))
    shifts["trials"] = laplace.between_trials(blocks, V)
    if lost := max(recording.emg_lost for recording in family.inputs):
        heard = [float(name in original.spec.weights) for name in post.of]
        shifts["emg_band"] = lost * np.array([heard])
    if (tissue := original.options.tissue) is not None:
        each = (*doubts_of(replace(original, inputs=family.inputs)), tissue)
        moved = [np.stack([t.of(r) for t in each], axis=1) for r in post.problem.inputs]
        rows = laplace.by_torque(post, chosen.mode, V, moved)
        # what a leg's curve has beside exponentials is theirs to the best of any
        rows[-1, [name not in _TISSUE for name in post.of]] = 0.0
        shifts["relaxed_curve"] = rows
    for group, conflict in against.items():
        source = NUISANCES[group].name
        before = shifts.get(source, np.zeros((0, len(V))))
        shifts[source] = np.concatenate([before, conflict.widened(V)])
    return shifts


def _candidates(sets: Sequence[Subset], values: Mapping[str, float]) -> tuple[Candidate, ...]:
    """The chosen departures with their values, and others that are not unsupported."""
    supported = [sets[0], *(s for s in sets[1:6] if s.weight > laplace.UNSUPPORTED)]
    first, *others = (Candidate(COMPLIANT, s.groups, s.evidence, s.weight, {}) for s in supported)
    return replace(first, values=FrozenDict(values)), *others


def _against(
    post: LogPosterior, point: Point, original: FitProblem
) -> tuple[dict[str, Conflict], FloatArray, tuple[Mounting, ...]]:
    """How far what was stated is from what the torque says; −H⁻¹·∂²(−ln p)/∂z∂θ₀ by the zero θ₀.

    And how the foot of each recording is turned.
    """
    settings = original.settings
    groups = original.settings.known
    turned = np.zeros(len(point.z))
    mounted: tuple[Mounting, ...] = ()
    wide = laboratory(joint=original.options.anatomy)
    if settings.zero_sd and ZERO_NAME not in post.names:
        zero = settings.fixed.get(ZERO_NAME, 0.0)
        sd = float(np.radians(settings.zero_sd))
        post, point = with_zero(post, point, Gaussian(zero, sd))
        wide[ZERO_NAME] = Gaussian(zero, FAR_ZERO)
        if settings.stated_zero is not None or settings.is_own:  # own lengths hang on it
            groups |= {ZERO_NAME}
        V = post.covariance(point)
        at = post.of.index(ZERO_NAME)
        turned = np.delete(V[:, at], at) / V[at, at]
        mounted = mountings(post, point)
    elif ZERO_NAME in post.of:
        mounted = mountings(post, point)
    against = conflicts(post.laplace(point), post.of, post.beliefs, wide, groups)
    return against, turned, mounted


def _each(post: LogPosterior, point: Point, change: FloatArray) -> tuple[OfRecording, ...]:
    """What each recording says by itself, from its quadratic at the common mode."""
    recordings = []
    prior = post.weight**2
    leg = {n: j for j, n in enumerate(post.problem.free) if group_of(n) is None}
    for b in point.blocks:
        V = inverse_of(b.H + np.diag(prior))
        z = point.z - V @ (b.g + prior * (point.z - post.mean))
        sd = np.sqrt(np.diag(change @ V @ change.T))
        values = post.by_name(np.clip(z, post.lower, post.upper))
        sems = {n: float(sd[j]) for n, j in leg.items()}
        recordings.append(OfRecording(FrozenDict({n: values[n] for n in leg}), FrozenDict(sems)))
    return tuple(recordings)


def _gained(post: LogPosterior, point: Point) -> tuple[float, ...]:
    """Largest active states by the point's gains, over those of the EMG as it is."""
    largest = []
    for each in (point.c, post.still()):
        states = [post.observed.effort(point.z, effort_of, i) for i, effort_of in enumerate(each)]
        largest.append(np.percentile(np.hstack(states), LARGEST, axis=1))
    gained, plain = largest
    return tuple(np.divide(gained, plain, out=np.ones(2), where=plain > 0.0).tolist())


def _natural(post: LogPosterior, point: Point) -> FloatArray:
    """The problem's free parameters, in their units, by what is searched, shape (p, q)."""
    free = post.problem.free
    change = np.zeros((len(free), len(point.z)))
    count = len(post.names)
    change[[free.index(name) for name in post.names], :count] = post.searched(
        np.eye(count), point.z
    ).T
    for j in range(len(post.names), len(point.z)):  # their mean
        change[free.index(post.of[j]), j] = 1.0 / len(post.problem.inputs)
    return change


def _message(sets: Sequence[Subset], bound: Sequence[str], finite: bool) -> Message:
    if not finite:
        return Message("ended/no-numbers")
    chosen = sets[0]
    likeliest = max(sets, key=lambda one: one.weight)
    which = "departures" if chosen.groups else "no-departure"
    text = Message(f"ended/{which}", groups=", ".join(chosen.groups))
    if chosen is not likeliest:
        text = Message("ended/which", message=text)
    elif chosen.weight < 0.99:
        text = Message("ended/probability", message=text, percent=100 * chosen.weight)
    return Message("ended/at-bound", message=text, names=", ".join(bound)) if bound else text
