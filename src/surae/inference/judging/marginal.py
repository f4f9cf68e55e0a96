"""Intervals and verdicts of a fit that knows its laboratory: everything that is not known is in.

The covariance of a posterior is the sum of what each source makes of the estimates, exactly
(`surae.inference.posterior.laplace`), so that shares of the variance add up to 1.

Another trial of the same leg has noise, drift, zero and errors of the EMG anew. What a leg and its
mounting share is wrong alike only as far as both trials ask the same: a wrong arm shifts another
parameter where movement and effort differ. It counts with a part of its variance (`SHARED`) in each
of them. What is added to a length is wrong alike in both.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from surae.base.normal import NORMAL
from surae.base.words import Message
from surae.inference import FitProblem
from surae.inference.coordinates import is_straight
from surae.inference.judging.grade import Adequacy, Grade
from surae.inference.judging.parameter import (
    INADEQUATE,
    Interval,
    ParameterEstimate,
    by_geometry,
    percent,
)
from surae.inference.judging.verdict import IDENTIFIED, Verdict, is_news, verdict_of
from surae.inference.result import PosteriorMode
from surae.inference.uncertainty.combined import Budget, Uncertainty
from surae.model.laboratory import group_of
from surae.model.source import Gaussian
from surae.model.source_table import advice
from surae.signals import steady_emg

#: Share of the variance from which a source is worth a remedy.
_WORTH = 0.25
#: Standard deviations of the prior from which on it pulls at an estimate that it does not fit.
_FAR = 2.9


def marginal(
    mode: PosteriorMode,
    problem: FitProblem,
    known: Uncertainty,
    adequacy: Adequacy,
    table: Mapping[str, ParameterEstimate],
) -> dict[str, ParameterEstimate]:
    """The estimated parameters of the leg with everything that makes them unsure."""
    bounds = [p.name for p in table.values() if p.at_bound and group_of(p.name) is None]
    withheld = Message("note/bounds", names=", ".join(bounds)) if bounds else None
    # Of two statements that contradict each other the intervals know; of another leg they do not.
    if other := [reason for reason in adequacy.against if reason.code == "not-one-leg"]:
        withheld = Message("note/denied", reason=str(other[0]))
    if adequacy.grade is Grade.INADEQUATE:
        withheld = INADEQUATE
    judged = {}
    joint = problem.options.anatomy
    for name in problem.free:
        p = table[name]
        budget = known.budget(known.along(name))
        if p.at_bound or group_of(name) is not None or not budget.sd > 0.0:
            continue
        ci95 = _with_own(name, known, known.interval(name, NORMAL * budget.sd))
        half = (ci95[1] - ci95[0]) / 2.0
        if known.goes_with_geometry(name):  # about the mean of what arms and paths may be
            half = max(ci95[1] - p.value, p.value - ci95[0])
        again = known.interval(name, NORMAL * budget.repeat, centred=False)
        repeatable = (again[1] - again[0]) / 2.0 <= IDENTIFIED * abs(p.value) and not withheld
        narrowed, assumed = _beside_population(p, budget.sd, mode.population.get(name), problem)
        verdict = verdict_of(
            p.value,
            half,
            room=p.upper - p.lower,
            narrowed=narrowed,
            doubted=withheld is not None,
            assumed=bool(assumed),
        )
        note = withheld or _note(verdict, p, half, budget, problem, repeatable=repeatable)
        if verdict is not Verdict.IDENTIFIED and not withheld:
            note = by_geometry(name, known, ci95) or note
        if verdict is Verdict.WEAK and half <= IDENTIFIED * abs(p.value) and not withheld:
            note = Message("note/known", percent=percent(half / abs(p.value)))
            reason = Message(f"note/{assumed or 'no-better'}", joint.worded)
            note = Message("note/but", known=note, but=reason)
        if name == "l0_tib" and not withheld:
            note = _filmed(note, known, problem, table)
        judged[name] = replace(
            p,
            sem=budget.sd,
            sem_robust=None,
            ci95=ci95,
            interval=Interval.MARGINAL,
            verdict=verdict,
            note=note,
            ci95_repeat=again,
            repeatable=repeatable,
            budget=budget.shares,
        )
    return judged


def _with_own(name: str, known: Uncertainty, ends: tuple[float, float]) -> tuple[float, float]:
    """An interval that holds too what is so at the arm and path of the fit.

    These were stated, or chosen by the data, and are among those that may be, however far they are
    from the mean of people's.
    """
    assumed = known.at_assumed
    if not (known.goes_with_geometry(name) and name in assumed.names):
        return ends
    low, high = assumed.interval(name, NORMAL * assumed.sd(assumed.along(name)))
    return min(ends[0], low), max(ends[1], high)


def _beside_population(
    p: ParameterEstimate, sd: float, prior: Gaussian | None, problem: FitProblem
) -> tuple[float, str]:
    """How wide an estimate is beside the population, and what of it is assumed, by its note.

    A length that is hardly narrower is said to be that, whatever its path.
    """
    if prior is None:
        return 0.0, ""
    value = p.value
    scale = 1.0
    if not is_straight(p.name):
        value = np.log(max(p.value, 1e-300))
        scale = p.value
    narrowed = sd / (prior.sd * scale) if prior.sd * scale > 0.0 else np.inf
    if is_news(narrowed):
        if abs(value - prior.mean) > _FAR * prior.sd and p.name not in problem.spec.weights:
            return narrowed, "far"
        if _by_path(p.name, problem):
            return narrowed, "path"
        return narrowed, "slack" if p.name == "x0_tri" else ""
    return narrowed, ""


def _by_path(name: str, problem: FitProblem) -> bool:
    """Whether a length is none of the leg's own: it is read off a path whose zero is not known.

    What makes it look known is the assumed width of the force-length curve, and the path's zero
    takes the error.
    """
    base, _, group = name.partition("_")
    if base not in ("l0", "x0") or f"length_zero_{group}" not in problem.free:
        return False
    films = ("gl", "sol", "gm", "tri") if group == "tri" else ("ta", "tib", "tib2")
    filmed = any(f"film_zero_{at}" in problem.free for at in films)
    return not filmed and not problem.settings.is_own


def _filmed(
    note: Message, known: Uncertainty, problem: FitProblem, table: Mapping[str, ParameterEstimate]
) -> Message:
    """With what the film says of the optimal length, known better than the whole muscle's."""
    names = ("l0_tib", "film_scale_tib", "film_zero_tib")
    if not {*names} <= {*problem.free} or steady_emg(problem.inputs)[0]:
        return note
    l0, scale, zero = (table[name].value for name in names)
    optimum = (1.0 + scale) * l0 + zero
    slope = sum(by * known.along(n) for n, by in zip(names, (1.0 + scale, l0, 1.0), strict=True))
    half = known.half_width(np.asarray(slope))
    return Message("note/filmed", known=note, mm=1e3 * optimum, percent=percent(half / optimum))


def _note(
    verdict: Verdict,
    p: ParameterEstimate,
    half: float,
    budget: Budget,
    problem: FitProblem,
    *,
    repeatable: bool,
) -> Message:
    """What is known, what is missing, and what would help."""
    relative = half / abs(p.value) if p.value else np.inf
    joint = problem.options.anatomy
    if verdict is Verdict.IDENTIFIED:
        return Message("note/known", percent=percent(relative))
    if verdict is Verdict.UNDETERMINED:
        if half >= 0.499999 * (p.upper - p.lower):
            return Message("note/not-informed")
        return Message("note/as-wide" if relative > 1.0 else "note/as-bounds")
    known = Message("note/known-only", percent=percent(relative))
    if repeatable:
        known = Message("note/repeatable", joint.worded, known=known)
    source = max(budget.shares, key=lambda s: budget.shares[s])
    if budget.shares[source] >= _WORTH:
        more = Message(advice(source, problem.settings.knowledge), joint.worded)
        known = Message("note/advised", known=known, advice=more)
        left = budget.without.get(source)
        if left is not None and left < 0.8 * budget.sd:
            narrowed = percent(relative * left / budget.sd)
            known = Message("note/narrowed", known=known, percent=narrowed)
    return known
