"""Fit several models to the same data, predict what was left out, and say what it means."""

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from surae.assessment.assess import assess
from surae.assessment.comparison.conclusion import RULE, cautions, changes, conclude
from surae.assessment.comparison.finding import Comparison, ModelScore, TendonEvidence
from surae.assessment.comparison.held_out import (
    BLOCKS,
    GUARD_PART,
    GUARD_S,
    Fold,
    HeldOut,
    folds,
    held_out,
    measured,
    prediction_error,
    without,
)
from surae.assessment.residual import autocorrelation
from surae.errors import InputError
from surae.estimation import FitProblem, FitResult, FitSettings, make_problem, solve
from surae.estimation.interrupt import postponed_interrupt
from surae.estimation.least_squares import Outcome
from surae.model import ModelSpec, get_model
from surae.progress import NamedProgress
from surae.signals import ModelInputs
from surae.units import FloatArray
from surae.versions import versions


def aicc(mean_square: float, samples: float, parameters: int) -> float | None:
    """Akaike's information criterion of a least-squares fit, corrected for small samples.

    n·ln σ² + 2K + 2K(K + 1)/(n − K − 1), with σ² = `mean_square` the maximum-likelihood variance
    of the residual and K = `parameters` + 1, as the variance is estimated too (Hurvich & Tsai
    1989; Burnham & Anderson 2002). Only differences between models of the same data mean anything.

    `mean_square` is in Nm²; `samples` counts independent ones, not necessarily a whole number. None
    where n is too small for K, or the residual has no variance to take a logarithm of.
    """
    k = parameters + 1
    if samples <= k + 1 or not 0 < mean_square < math.inf:
        return None
    return samples * math.log(mean_square) + 2 * k + 2 * k * (k + 1) / (samples - k - 1)


def effective_samples(residuals: Iterable[FloatArray]) -> float:
    """Independent samples that autocorrelated residuals are worth, n/(1 + 2Σρ) of each recording.

    The sum ends by Geyer's initial positive sequence (1992): pairs ρ(2k) + ρ(2k + 1) are added
    while they are positive; what follows is taken for noise. Anticorrelated residuals, which would
    be worth more than n, count as n.
    """
    return sum(len(e) / _correlation_time(e) for e in residuals)


def _correlation_time(residual: FloatArray) -> float:
    """1 + 2Σρ over the initial positive sequence, at least 1 [samples]."""
    rho = autocorrelation(residual, len(residual) - 1)
    even = len(rho) // 2 * 2
    pairs = rho[0:even:2] + rho[1:even:2]
    ends = (pairs <= 0).nonzero()[0]
    positive = pairs[: ends[0]] if len(ends) else pairs
    return max(1.0, 2.0 * float(positive.sum()) - 1.0)


#: Models compared unless told otherwise.
COMPARED = ("muscle", "muscle-tendon", "muscle-tendon-strain", "muscle-tendon-toe")
#: Starts of each fit to all data; the fits of the folds start from its solution.
FEW_STARTS = 3


@dataclass(slots=True)
class _Work:
    """What is known of one model so far."""

    problem: FitProblem
    result: FitResult | None = None
    missed: list[float] = field(default_factory=list)

    @property
    def name(self) -> str:
        return self.problem.spec.name


def compare_models(
    inputs: Sequence[ModelInputs],
    models: Sequence[str] = COMPARED,
    settings: FitSettings | None = None,
    progress: NamedProgress | None = None,
) -> Comparison:
    """Compare models of rigid and of compliant tendons on the same data.

    Every model is fitted to all data, then without each fold: a recording where there are several,
    else a quarter of the only one (`surae.assessment.comparison.held_out`).

    Parameters
    ----------
    inputs : sequence of ModelInputs
        The recordings, as `FitSettings.inputs` gives them.
    models : sequence of str
        At least one without tendons and one with.
    settings : FitSettings, optional
        What every model is asked, as far as it has the parameters.
    progress : callable, optional
        As of `surae.compare`, and so are the errors.

    Returns
    -------
    Comparison
        Ctrl-C keeps the fits that are complete: `missing` names the others, and there is no
        finding. When not even the first fit is complete, KeyboardInterrupt is raised.
    """
    begin = time.perf_counter()
    settings = settings or FitSettings(starts=FEW_STARTS)
    works = [_Work(make_problem(inputs, each)) for each in _asked(models, settings)]
    parts = folds(inputs)
    missing = _fit_all(works, parts, progress)
    done = [work for work in works if work.result is not None]
    results = [work.result for work in works if work.result is not None]
    squares, n = _mean_squares(results), works[0].problem.n
    n_effective = _effective(results, squares)
    scores = _scores(done, parts, squares, n, n_effective)
    finding: TendonEvidence | None = None
    text = f"No conclusion: stopped before the end; missing: {', '.join(missing)}."
    if not missing:
        finding, text = conclude(scores)
    return Comparison(
        finding=finding,
        conclusion=text,
        rule=RULE,
        cautions=cautions(scores, settings.loss),
        models=scores,
        changes=changes(
            scores,
            {result.problem.spec.name: assess(result) for result in results},
        ),
        missing=missing,
        recordings=tuple(recording.where for recording in inputs),
        n=n,
        n_effective=n_effective,
        scheme=_scheme(inputs),
        folds=tuple(part.name for part in parts),
        settings=settings,
        seconds=time.perf_counter() - begin,
        versions=versions(),
    )


def is_rigid(spec: ModelSpec) -> bool:
    """Whether a model is without tendons."""
    return not any(p.group == "tendon" for p in spec.parameters)


def _asked(models: Sequence[str], settings: FitSettings) -> list[FitSettings]:
    """What each model is asked, after all that can be wrong with the choice."""
    asked = [settings.for_model(name) for name in models]
    for name in models:
        if list(models).count(name) > 1:
            raise InputError(f"model {name!r} is given twice; give it once")
    if {is_rigid(get_model(name)) for name in models} != {True, False}:
        raise InputError(
            "a comparison needs a model without tendons and one with: give muscle and at least one "
            f"of {', '.join(COMPARED[1:])}"
        )
    for name in settings.parameters.difference(*(each.parameters for each in asked)):
        known = ", ".join(dict.fromkeys(n for model in models for n in get_model(model).names))
        raise InputError(f"none of the models has a parameter {name!r}; they have: {known}")
    return asked


def _fit_all(
    works: Sequence[_Work], parts: Sequence[Fold], progress: NamedProgress | None
) -> tuple[str, ...]:
    """Do every fit, those to all data first. Returns what a Ctrl-C left undone."""
    tasks: list[tuple[_Work, Fold | None]] = [(work, None) for work in works]
    tasks += [(work, part) for work in works for part in parts]
    names = [w.name if p is None else f"{w.name} without {p.name}" for w, p in tasks]
    done = 0
    with postponed_interrupt():
        try:
            for work, part in tasks:
                if progress is not None:
                    progress(names[done], done, len(tasks))
                _fit(work, part)
                done += 1
        except KeyboardInterrupt:
            if not done:
                raise
    return tuple(names[done:])


def _fit(work: _Work, part: Fold | None) -> None:
    """One fit; raises KeyboardInterrupt where it was stopped before its minimum."""
    if part is None or work.result is None:
        work.result = _whole(work.problem, work.problem.settings.starts)
    else:
        result = _whole(without(work.problem, part, work.result), 1)
        work.missed.append(_sum_of_squares(prediction_error(result, part)))


def _whole(problem: FitProblem, starts: int) -> FitResult:
    """The fit of a problem from so many starts; an interrupted one is none."""
    result = solve(problem, starts=starts)
    unfinished = len(result.starts) < starts and result.status != "failed"
    if unfinished or result.starts[-1].outcome == Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return result


def _sum_of_squares(values: FloatArray) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        total = float(values @ values)
    return total if math.isfinite(total) else math.inf


def _mean_squares(results: Sequence[FitResult]) -> list[float]:
    """Mean squared residual of every fit, as the criterion takes it.

    Where outliers count less, those of the model with the least noise do so for all models:
    weights of its own would let every model forgive itself what it cannot follow.
    """
    robust = [(r.outliers.scale, i) for i, r in enumerate(results) if r.outliers is not None]
    if not robust:
        return [result.sse / result.problem.n for result in results]
    shared = results[min(robust)[1]].problem
    with np.errstate(over="ignore", invalid="ignore"):
        return [
            sum(
                float(np.sum((1.0 if recording.weight is None else recording.weight) * e**2))
                for recording, e in zip(shared.inputs, result.residuals, strict=True)
            )
            / shared.n
            for result in results
        ]


def _effective(results: Sequence[FitResult], squares: Sequence[float]) -> float | None:
    """Effective samples, the same for all models, from the residual of the best."""
    scored = [
        (score, i)
        for i, (result, square) in enumerate(zip(results, squares, strict=True))
        if (score := _criterion(result, square, result.problem.n)) is not None
    ]
    if not scored:
        return None
    best = results[min(scored)[1]]
    pairs = zip(best.problem.inputs, best.residuals, strict=True)
    return effective_samples([e[recording.counts] for recording, e in pairs])


def _scores(
    done: Sequence[_Work],
    parts: Sequence[Fold],
    squares: Sequence[float],
    n: int,
    n_effective: float | None,
) -> tuple[ModelScore, ...]:
    results = [work.result for work in done if work.result is not None]
    pairs = list(zip(results, squares, strict=True))
    plain = [_criterion(result, square, n) for result, square in pairs]
    corrected = [_criterion(result, square, n_effective) for result, square in pairs]
    predicted = _predicted(done, parts, corrected)
    scores = []
    for work, result, p, c in zip(done, results, plain, corrected, strict=True):
        spec, worth = work.problem.spec, assess(result)
        held = predicted.get(work.name)
        note = "" if held else "a prediction overflows, or a part has no torque"
        scores.append(
            ModelScore(
                model=spec.name,
                title=spec.title,
                rigid=is_rigid(spec),
                status=result.status,
                message=result.message,
                at_bound=result.at_bound,
                n_free=len(work.problem.free),
                vaf=_finite(worth.vaf),
                rmse=_finite(worth.rmse),
                aicc=c,
                aicc_plain=p,
                delta=_above_best(c, corrected),
                delta_plain=_above_best(p, plain),
                held_out=held,
                held_out_note=note if len(work.missed) == len(parts) else "stopped by the user",
                values=dict(result.values),
                adequacy=worth.adequacy,
            )
        )
    return tuple(scores)


def _criterion(result: FitResult, square: float, samples: float | None) -> float | None:
    if samples is None or result.status == "failed":
        return None
    return aicc(square, samples, len(result.problem.free))


def _predicted(
    done: Sequence[_Work], parts: Sequence[Fold], criteria: Sequence[float | None]
) -> dict[str, HeldOut]:
    """Held-out score of each model that has every fold, against the best rigid one that has."""
    whole = [
        (math.inf if c is None else c, work)
        for work, c in zip(done, criteria, strict=True)
        if len(work.missed) == len(parts)
    ]
    rigid = [(c, i) for i, (c, work) in enumerate(whole) if is_rigid(work.problem.spec)]
    if not rigid:
        return {}
    reference = whole[min(rigid)[1]][1].missed
    total = [_sum_of_squares(measured(part)) for part in parts]
    scores = {work.name: held_out(work.missed, reference, total) for _, work in whole}
    return {name: score for name, score in scores.items() if score is not None}


def _above_best(value: float | None, values: Sequence[float | None]) -> float | None:
    known = [v for v in values if v is not None]
    return None if value is None else value - min(known)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _scheme(inputs: Sequence[ModelInputs]) -> str:
    if len(inputs) > 1:
        return "Each recording is left out in turn and predicted by a fit of the others."
    return (
        f"Each of {BLOCKS} contiguous blocks is left out in turn and predicted by a fit of the "
        f"others; {GUARD_S:g} s on either side of it, at most {100 * GUARD_PART:g} % of its "
        "length, do not count in the fit."
    )
