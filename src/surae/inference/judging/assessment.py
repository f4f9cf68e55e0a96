"""From a fit to what it is worth: goodness, intervals, correlations and verdicts."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surae.base.formatting import chance
from surae.base.normal import NORMAL
from surae.base.threads import one_blas_thread
from surae.base.words import Message
from surae.inference import FitResult, PosteriorMode
from surae.inference.judging.adequacy import judge_adequacy
from surae.inference.judging.assessed import Assessment, RecordingQuality
from surae.inference.judging.fascicles import fascicles_of
from surae.inference.judging.goodness import (
    LEVEL,
    Whiteness,
    centred_r2,
    counted,
    rmse,
    vaf,
    weighted_vaf,
)
from surae.inference.judging.grade import Adequacy, Grade
from surae.inference.judging.marginal import marginal
from surae.inference.judging.parameter import (
    Interval,
    ParameterEstimate,
    by_geometry,
    judge_interval,
    judge_singular,
    percent,
)
from surae.inference.judging.verdict import IDENTIFIED, Verdict
from surae.inference.least_squares.contradiction import Contradiction, contradiction
from surae.inference.uncertainty.combined import (
    Uncertainty,
    combined,
    information_root,
    of_least_squares,
)
from surae.inference.uncertainty.covariance import Covariance, covariance, ipde
from surae.inference.uncertainty.robust import RobustCovariance, robust_covariance
from surae.model.symmetry import tied_to_geometry
from surae.quality.finding import Quality

#: Half-width beyond which arms and paths add nothing, and whose square may be no number.
_BOUNDLESS = 1e100


@one_blas_thread()
def assess(
    result: FitResult, *, alternatives: bool = False, quality: Sequence[Quality] = ()
) -> Assessment:
    """Judge a fit, of recordings in which `quality` was found.

    With `alternatives` a named model is held against what it does not know of: where the data
    contradict it, its intervals reach to where a model of the laboratory would have the parameters.
    """
    problem = result.problem
    R = information_root(result)
    estimated = covariance(R, problem.free, result.sse, problem.n, result.bounded)
    robust, white = robust_covariance(result, estimated)
    interval, why = _believed(result, robust, white)
    pairs = [
        (*counted(trial, residual), trial.weights[trial.counts])
        for trial, residual in zip(problem.inputs, result.residuals, strict=True)
    ]
    filmed = fascicles_of(result)
    recordings = tuple(
        RecordingQuality(
            name=recording.name,
            path=recording.files[0].name if recording.files else None,
            sha256=recording.files[0].sha256 if recording.files else None,
            n=recording.n,
            rate_hz=recording.rate_hz,
            vaf=vaf(torque, residual),
            rmse=rmse(residual),
            bias=float(residual.mean()),
            vaf_weighted=weighted_vaf([(torque, residual, weight)]),
            r2=centred_r2([(torque, residual)]),
            fascicles=tuple(f.quality for f in filmed if f.recording == recording.name),
        )
        for recording, (torque, residual, weight) in zip(problem.inputs, pairs, strict=True)
    )
    solution = result.solution
    laboratory = result.solution.beliefs
    of_leg = np.array([name not in laboratory for name in estimated.names], dtype=bool)
    leg = replace(
        estimated,
        names=tuple(name for name in estimated.names if name not in laboratory),
        matrix=estimated.matrix[np.ix_(of_leg, of_leg)],
        correlation=estimated.correlation[np.ix_(of_leg, of_leg)],
    )
    dependency = ipde(leg.correlation) if len(leg.names) > 1 else None
    left_out = [n for n in problem.free if n not in estimated.names and n not in laboratory]
    note = f"without {', '.join(left_out)}" if left_out else ""
    if dependency is None:
        note = "fewer than two parameters have a variance"
    residuals = np.concatenate([residual for _, residual, _ in pairs])
    adequacy = judge_adequacy(result, quality)
    against = contradiction(result) if alternatives else None
    if isinstance(solution, PosteriorMode):
        known = combined(result, solution.spread)
    else:
        believed = robust if interval is Interval.ROBUST else None
        known = of_least_squares(result, estimated, believed, against)
    table = _parameters(result, estimated, robust, known, interval, adequacy, against)
    if isinstance(solution, PosteriorMode):
        table |= marginal(solution, problem, known, adequacy, table)
    if against is not None:
        missing = ", ".join(against.missing)
        why = Message("interval/contradicted", why=why, missing=missing)
    return Assessment(
        vaf=vaf(np.concatenate([torque for torque, _, _ in pairs]), residuals),
        rmse=rmse(residuals),
        vaf_weighted=weighted_vaf(pairs),
        parameters={n: p for n, p in table.items() if n not in laboratory},
        nuisances={n: p for n, p in table.items() if n in laboratory},
        covariance=leg,
        robust=robust,
        whiteness=white,
        interval=interval,
        interval_note=why,
        ipde=dependency,
        ipde_note=note,
        recordings=recordings,
        adequacy=adequacy,
        uncertainty=known,
    )


def _believed(
    result: FitResult, robust: RobustCovariance | None, white: Sequence[Whiteness]
) -> tuple[Interval, Message]:
    """Which standard errors to believe: the thesis's where all residuals are white; and why."""
    if isinstance(result.solution, PosteriorMode):
        return Interval.MARGINAL, Message("interval/marginal")
    if robust is None:
        return Interval.THESIS, Message("interval/none")
    if result.solution.outliers is not None:
        return Interval.ROBUST, Message("interval/outliers")
    if any(recording.emphasised for recording in result.problem.inputs):
        return Interval.ROBUST, Message("interval/weights")
    least = min(test.p_value for test in white)
    text = chance(least)
    if len(white) > 1:
        text = Message("interval/several", chance=text, n=len(white))
    if least >= LEVEL / len(white):  # the recordings share the level (Bonferroni)
        return Interval.THESIS, Message("interval/white", chance=text)
    return Interval.ROBUST, Message("interval/correlated", chance=text)


def _parameters(
    result: FitResult,
    estimated: Covariance,
    robust: RobustCovariance | None,
    known: Uncertainty,
    interval: Interval,
    adequacy: Adequacy,
    against: Contradiction | None,
) -> dict[str, ParameterEstimate]:
    problem = result.problem
    table = problem.table
    ends = zip(problem.lower.tolist(), problem.upper.tolist(), strict=True)
    bounds = dict(zip(problem.free, ends, strict=True))
    variances = dict(zip(estimated.names, np.diag(estimated.matrix).tolist(), strict=True))
    parameters = {}
    tied = tied_to_geometry(problem.spec)
    for name, p in table.items():
        value = result.values[name]
        lower, upper = bounds.get(name, (p.lower, p.upper))
        sem = sem_robust = ci95 = again = None
        repeatable = False
        budget: dict[str, float] = {}
        if name not in problem.free:
            verdict = Verdict.FIXED
            note = Message("note/fixed")
        elif name in result.at_bound:
            side = "lower" if value - lower < upper - value else "upper"
            verdict = Verdict.AT_BOUND
            note = Message(f"note/at-bound/{side}")
        elif name in variances:
            sem = float(np.sqrt(variances[name]))
            if interval is Interval.MARGINAL:
                sem = known.sd(known.along(name))
            if robust is not None:
                j = robust.names.index(name)
                sem_robust = float(np.sqrt(robust.matrix[j, j]))
            judged = _by_covariance(
                name, result, estimated, known, (lower, upper), adequacy, against
            )
            ci95, again, repeatable, budget, verdict, note = judged
            if name in tied:
                ci95 = None
                verdict = Verdict.UNDETERMINED
                note = Message("note/tied", problem.options.anatomy.worded)
        elif not np.isfinite(estimated.sigma2):
            verdict = Verdict.UNDETERMINED
            note = Message("note/not-finite")
        else:
            verdict = Verdict.UNDETERMINED
            note = judge_singular(name, estimated.directions)
        parameters[name] = ParameterEstimate(
            name,
            p.unit,
            p.meaning,
            p.group,
            value,
            sem,
            sem_robust,
            ci95,
            interval if ci95 else None,
            lower,
            upper,
            name in problem.free,
            name in result.at_bound,
            verdict,
            note,
            again,
            repeatable,
            budget,
        )
    return parameters


def _by_covariance(
    name: str,
    result: FitResult,
    estimated: Covariance,
    known: Uncertainty,
    bounds: tuple[float, float],
    adequacy: Adequacy,
    against: Contradiction | None,
) -> tuple[tuple[float, float], tuple[float, float], bool, dict[str, float], Verdict, Message]:
    """Interval, that of a repeat, whether it repeats, budget, verdict and note of a parameter."""
    problem = result.problem
    withheld = adequacy.grade is Grade.INADEQUATE
    value = result.values[name]
    lower, upper = bounds
    along = known.along(name)
    whole, half = (known.half_width(along, biased=b) for b in (True, False))
    repeat = known.repeat_half_width(along)
    budget = {s: part for s, part in known.budget(along).shares.items() if part}
    repeatable = repeat <= IDENTIFIED * abs(value) and not withheld
    if whole > half:
        part = (half / whole) ** 2  # of a variance that a bias shares, whatever their size
        budget = {s: part * share for s, share in budget.items()} | {"model": 1.0 - part}
        half = whole
    ci95, half, alone = _with_geometry(name, known, half, lower)
    prior = problem.priors.get(name)
    narrowed = half / (NORMAL * prior.median * prior.spread) if prior else 0.0
    verdict, note = judge_interval(
        name,
        value,
        half,
        estimated,
        withheld=withheld,
        room=upper - lower,
        narrowed=narrowed,
        noise=alone,
    )
    if verdict is Verdict.IDENTIFIED and (why := result.solution.one_start):
        verdict = Verdict.WEAK
        note = Message("note/but", known=note, but=Message(why))
    if against is not None and repeatable and verdict is not Verdict.IDENTIFIED:
        note = Message(
            "note/contradicted",
            problem.options.anatomy.worded,
            percent=percent(alone / abs(value)),
            missing=", ".join(against.missing),
        )
    elif verdict is not Verdict.IDENTIFIED and not withheld:
        note = by_geometry(name, known, ci95) or note
    return ci95, _possible(value, repeat, lower), repeatable, budget, verdict, note


def _with_geometry(
    name: str, known: Uncertainty, half: float, lower: float
) -> tuple[tuple[float, float], float, float]:
    """A named model's interval, its half-width from the value, and what of that is no geometry's.

    What arms and paths make of it is about their mean, on a logarithm.
    """
    value = float(known.values[known.names.index(name)])
    geometry = known.geometry
    if geometry is None or not geometry.moves(name) or not value > 0.0 or half > _BOUNDLESS:
        return _possible(value, half, lower), half, half
    of_geometry = NORMAL * geometry.sd(name) * value
    alone = math.sqrt(max(half**2 - of_geometry**2, 0.0))
    low, high = geometry.about(name, _possible(value, alone, lower))
    assert low is not None
    assert high is not None
    return (low, high), max(high - value, value - low, alone), alone


def _possible(value: float, half: float, lower: float) -> tuple[float, float]:
    """An interval of so much to either side; what cannot be below zero is not said to be."""
    low = value - half
    return low if lower < 0.0 or value < 0.0 else max(low, 0.0), value + half
