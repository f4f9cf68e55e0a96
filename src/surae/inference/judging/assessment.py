"""From a fit to what it is worth: goodness, intervals, correlations and verdicts."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from surae._version import __version__
from surae.base.file_form import filed
from surae.base.formatting import chance
from surae.base.frozen import Comparable
from surae.base.normal import NORMAL
from surae.base.threads import one_blas_thread
from surae.base.words import Message
from surae.inference import FitResult, PosteriorMode
from surae.inference.judging.adequacy import Adequacy, Grade, judge_adequacy
from surae.inference.judging.fascicles import FascicleQuality, fascicles_of
from surae.inference.judging.goodness import (
    LEVEL,
    Whiteness,
    centred_r2,
    counted,
    rmse,
    vaf,
    weighted_vaf,
)
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


@filed(sparse=("fascicles",), rmse="rmse_Nm", bias="bias_Nm")
@dataclass(frozen=True, slots=True, eq=False)
class RecordingQuality(Comparable):
    """How well one recording is followed where its samples count: VAF, R² [%], RMSE, bias [Nm].

    `vaf_weighted` counts the samples as the fit did; None where all that count count alike. `r2` is
    centred: of the torque's changes.
    """

    name: str
    path: str | None
    sha256: str | None
    n: int
    rate_hz: float
    vaf: float
    rmse: float
    bias: float
    vaf_weighted: float | None
    r2: float
    fascicles: tuple[FascicleQuality, ...] = ()


@filed(
    "robust",
    "uncertainty",
    "differs",
    rmse="rmse_Nm",
    covariance="correlation",
    version="judged_by",
)
@dataclass(frozen=True, slots=True, eq=False)
class Assessment(Comparable):
    """What a fit is worth."""

    #: `vaf`, `rmse`: of all recordings together [%, Nm]; NaN where the model gave no finite torque.
    vaf: float
    rmse: float
    #: VAF with the samples counted as the fit did, 1 − Σwe²/ΣwT² [%]; None where all that count
    #: count alike.
    vaf_weighted: float | None
    parameters: Mapping[str, ParameterEstimate]  #: All parameters of the model, in its order.
    covariance: Covariance  #: Of the estimates that have one, equation (33): for white residuals.
    #: Of the same estimates, for residuals that are correlated over time.
    robust: RobustCovariance | None
    #: Autocorrelation of each recording's residual, and the test of it.
    whiteness: tuple[Whiteness, ...]
    interval: Interval  #: Which of the two the intervals and verdicts rest on.
    interval_note: str  #: Why, in a plain sentence: a `Message`, unless it was read from a file.
    #: Equation (35); None, with `ipde_note` saying why, when fewer than two have a variance.
    ipde: float | None
    #: Which parameters it leaves out, or why there is none; empty when it has them all.
    ipde_note: str
    recordings: tuple[RecordingQuality, ...]  #: One for each recording.
    adequacy: Adequacy  #: Whether the fit is good enough for any of this to mean something.
    uncertainty: Uncertainty  #: Of all free parameters together, of which all intervals are made.
    #: What `model="auto"` found of the laboratory; empty for a named model.
    nuisances: Mapping[str, ParameterEstimate] = field(default_factory=dict)
    version: str = __version__  #: The version of surae that gave the verdicts.
    #: Where this version judges otherwise than the file that the verdicts are read from.
    differs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class AssessedFit:
    """A fit and what it is worth."""

    result: FitResult  #: What was found: values, residuals, how it was found.
    assessment: Assessment  #: What it is worth: intervals, correlations, verdicts.
    quality: tuple[Quality, ...] = ()  #: What was found in each recording before it was fitted.


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
            told = _by_covariance(name, result, estimated, known, (lower, upper), adequacy, against)
            ci95, again, repeatable, budget, verdict, note = told
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
    own = NORMAL * geometry.sd(name) * value
    alone = math.sqrt(max(half**2 - own**2, 0.0))
    low, high = geometry.about(name, _possible(value, alone, lower))
    assert low is not None
    assert high is not None
    return (low, high), max(high - value, value - low, alone), alone


def _possible(value: float, half: float, lower: float) -> tuple[float, float]:
    """An interval of so much to either side; what cannot be below zero is not said to be."""
    low = value - half
    return low if lower < 0.0 or value < 0.0 else max(low, 0.0), value + half


def outdated(assessment: Assessment) -> str:
    """How this version would judge a fit that was read, in a sentence; empty where as it did."""
    if not assessment.differs:
        return ""
    text = "; ".join(assessment.differs)
    return (
        f"Judged by surae {assessment.version}. By this version, {__version__}, {text}; surae "
        "reassess renews what the file says."
    )


def variance_inflation(assessment: Assessment) -> dict[str, float]:
    """Factors on the variance of the noise that an assessment asks for, for its `interval_note`.

    1 where its residuals pass for white noise. Where intervals are robust it is (sem_robust/sem)²
    of each parameter that was estimated; one without a standard error, as at a bound, has the
    median of the others.
    """
    free = [p for p in assessment.parameters.values() if p.free]
    known = {}
    if assessment.interval is Interval.ROBUST:
        known = {p.name: (p.sem_robust / p.sem) ** 2 for p in free if p.sem and p.sem_robust}
    common = float(np.median(list(known.values()))) if known else 1.0
    return {p.name: known.get(p.name, common) for p in free}


def described(factors: Mapping[str, float], reason: str) -> str:
    """What was done to the noise and why, as a line: ``variance of the noise ×4: …``."""
    least, most = (f"{end(factors.values()):.3g}" for end in (min, max))
    text = f"×{least}" if least == most else f"×{least} … ×{most}, by parameter"
    return f"variance of the noise {text}" + (f": {reason}" if reason else "")
