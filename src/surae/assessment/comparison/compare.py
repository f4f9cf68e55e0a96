"""Fit several models to the same data, predict what was left out, and say what it means."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from surae.assessment.assess import assess
from surae.assessment.comparison.changes import changes
from surae.assessment.comparison.conclusion import RULE, cautions, conclude
from surae.assessment.comparison.finding import Comparison, Finding, ModelScore
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
from surae.assessment.comparison.information import aicc, effective_samples
from surae.errors import InputError
from surae.estimation import FitProblem, FitResult, fit_problem, make_problem
from surae.estimation.interrupt import postponed_interrupt
from surae.estimation.least_squares import Outcome
from surae.model import ModelOptions, ModelSpec, get_model, with_optional
from surae.signals import ModelInputs
from surae.units import FloatArray
from surae.versions import versions

#: Models compared unless told otherwise.
COMPARED = ("muscle", "muscle-tendon", "muscle-tendon-strain", "muscle-tendon-toe")
#: Starts of each fit to all data; the fits of the folds start from its solution.
FEW_STARTS = 3
#: Called before every fit with what it is, how many are done, and how many there are.
Told = Callable[[str, int, int], None]


@dataclass(slots=True)
class _Work:
    """What is known of one model so far."""

    problem: FitProblem
    found: FitResult | None = None
    missed: list[float] = field(default_factory=list)

    @property
    def name(self) -> str:
        return self.problem.spec.name


def compare_models(
    inputs: Sequence[ModelInputs],
    models: Sequence[str] = COMPARED,
    *,
    fixed: Mapping[str, float] | None = None,
    options: ModelOptions | None = None,
    starts: int = FEW_STARTS,
    seed: int = 0,
    progress: Told | None = None,
) -> Comparison:
    """Compare models of rigid and of compliant tendons on the same data.

    Every model is fitted to all data, then without each fold: a recording where there are several,
    else a quarter of the only one (`surae.assessment.comparison.held_out`).

    Parameters
    ----------
    inputs : sequence of ModelInputs
        The recordings.
    options : ModelOptions, optional
        The models' switches.
    models, fixed, starts, seed, progress
        As of `surae.compare`, and so are the errors.

    Returns
    -------
    Comparison
        Ctrl-C keeps the fits that are complete: `missing` names the others, and there is no
        finding. When not even the first fit is complete, KeyboardInterrupt is raised.
    """
    begin = time.perf_counter()
    fixed, options = dict(fixed or {}), options or ModelOptions()
    works = [
        _Work(
            make_problem(
                inputs,
                spec.name,
                fixed={name: value for name, value in fixed.items() if name in spec.names},
                options=options,
            )
        )
        for spec in _checked(models, fixed)
    ]
    parts = folds(inputs)
    missing = _fit_all(works, parts, starts, seed, progress)
    done = [work for work in works if work.found is not None]
    n = works[0].problem.n
    n_effective = _effective(done)
    scores = _scores(done, parts, n, n_effective)
    finding: Finding | None = None
    text = f"No conclusion: stopped before the end; missing: {', '.join(missing)}."
    if not missing:
        finding, text = conclude(scores)
    return Comparison(
        finding=finding,
        conclusion=text,
        rule=RULE,
        cautions=cautions(scores),
        models=scores,
        changes=changes(
            scores,
            {work.name: assess(work.found) for work in done if work.found is not None},
        ),
        missing=missing,
        recordings=tuple(one.where for one in inputs),
        n=n,
        n_effective=n_effective,
        scheme=_scheme(inputs),
        folds=tuple(part.name for part in parts),
        options=options.as_dict(),
        fixed=fixed,
        starts=starts,
        seed=seed,
        seconds=time.perf_counter() - begin,
        versions=versions(),
    )


def is_rigid(spec: ModelSpec) -> bool:
    """Whether a model is without tendons."""
    return not any(p.group == "tendon" for p in spec.parameters)


def _checked(models: Sequence[str], fixed: Mapping[str, float]) -> list[ModelSpec]:
    """The models in their order, after all that can be wrong with the choice."""
    specs = [with_optional(get_model(name), fixed) for name in models]
    for name in models:
        if list(models).count(name) > 1:
            raise InputError(f"model {name!r} is given twice; give it once")
    if {is_rigid(spec) for spec in specs} != {True, False}:
        raise InputError(
            "a comparison needs a model without tendons and one with: give muscle and at least one "
            f"of {', '.join(COMPARED[1:])}"
        )
    for name in fixed:
        if not any(name in spec.names for spec in specs):
            known = ", ".join(dict.fromkeys(n for spec in specs for n in spec.names))
            raise InputError(f"none of the models has a parameter {name!r}; they have: {known}")
    return specs


def _fit_all(
    works: Sequence[_Work], parts: Sequence[Fold], starts: int, seed: int, progress: Told | None
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
                _fit(work, part, starts, seed)
                done += 1
        except KeyboardInterrupt:
            if not done:
                raise
    return tuple(names[done:])


def _fit(work: _Work, part: Fold | None, starts: int, seed: int) -> None:
    """One fit; raises KeyboardInterrupt where it was stopped before its minimum."""
    if part is None or work.found is None:
        found = fit_problem(work.problem, starts=starts, seed=seed)
        _refuse_interrupted(found, starts)
        work.found = found
    else:
        found = fit_problem(without(work.problem, part, work.found), starts=1)
        _refuse_interrupted(found, 1)
        work.missed.append(_sum_of_squares(prediction_error(found, part)))


def _refuse_interrupted(found: FitResult, starts: int) -> None:
    if len(found.starts) < starts or found.starts[-1].outcome == Outcome.INTERRUPTED:
        raise KeyboardInterrupt


def _sum_of_squares(values: FloatArray) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        total = float(values @ values)
    return total if math.isfinite(total) else math.inf


def _mean_square(found: FitResult) -> float:
    return found.sse / found.problem.n


def _effective(done: Sequence[_Work]) -> float | None:
    """Effective samples, the same for all models, from the residual of the best."""
    best: tuple[float, FitResult] | None = None
    for work in done:
        if work.found is None or work.found.status == "failed":
            continue
        score = aicc(_mean_square(work.found), work.problem.n, len(work.problem.free))
        if score is not None and (best is None or score < best[0]):
            best = (score, work.found)
    if best is None:
        return None
    pairs = zip(best[1].problem.inputs, best[1].residuals, strict=True)
    return effective_samples([e if one.weight is None else e[one.weight > 0] for one, e in pairs])


def _scores(
    done: Sequence[_Work], parts: Sequence[Fold], n: int, n_effective: float | None
) -> tuple[ModelScore, ...]:
    found = [work.found for work in done if work.found is not None]
    plain = [_criterion(one, n) for one in found]
    corrected = [_criterion(one, n_effective) for one in found]
    predicted = _predicted(done, parts, corrected)
    scores = []
    for work, one, p, c in zip(done, found, plain, corrected, strict=True):
        spec, worth = work.problem.spec, assess(one)
        held = predicted.get(work.name)
        note = "" if held else "a prediction overflows, or a part has no torque"
        scores.append(
            ModelScore(
                model=spec.name,
                title=spec.title,
                rigid=is_rigid(spec),
                status=one.status,
                message=one.message,
                at_bound=one.at_bound,
                n_free=len(work.problem.free),
                vaf=_finite(worth.vaf),
                rmse=_finite(worth.rmse),
                aicc=c,
                aicc_plain=p,
                delta=_above_best(c, corrected),
                delta_plain=_above_best(p, plain),
                held_out=held,
                held_out_note=note if len(work.missed) == len(parts) else "stopped by the user",
                values=dict(one.values),
            )
        )
    return tuple(scores)


def _criterion(found: FitResult, samples: float | None) -> float | None:
    if samples is None or found.status == "failed":
        return None
    return aicc(_mean_square(found), samples, len(found.problem.free))


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
    known = [one for one in values if one is not None]
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
