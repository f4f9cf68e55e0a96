"""Whether the trials of a leg agree with the fit that stands for it: what was left out is asked.

A fit may follow all that it was made of and still be wrong of the leg. Three things of a session
can say so, and each is held against the fit's own 95 %: trials that were left out, whose torque it
predicts; relaxed trials, whose torque rises over the angle by what it rises, whatever a model says;
and what a trial's own fit says of the stiffness. An error that stands is no agreement either.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.normal import NORMAL, Student
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import AssessedFit, Grade, Prediction
from surae.inference.judging.adequacy import BEYOND
from surae.inference.judging.reasons import Reason, against
from surae.inference.uncertainty.combined import ZERO
from surae.measures.compared import Quantity, common_end, quantities
from surae.measures.points import MeasurePoint, evaluate
from surae.measures.table import DEFINITIONS
from surae.signals import ModelInputs, same_signals
from surae.trials import Trial

#: Ranges over which a relaxed torque is held against a fit's, and what each must span at least.
_WIDE = np.radians(10.0)
_SPAN = np.radians(5.0)
#: Held angles that show a slope and how sure it is.
_HOLDS = 3
#: Part of the leg's largest stiffness below which a difference is none: what is known within 10 %
#: counts as known.
_LITTLE = 0.1
#: What a trial's own fit is compared in.
_COMPARED = "end_stiffness"


@dataclass(frozen=True, slots=True)
class AskedTrial:
    """A trial that is held against the fit of its leg."""

    trial: Trial
    parts: tuple[ModelInputs, ...]  #: Its signals.
    #: How the fit predicts each part; empty where the fit is of it.
    predictions: tuple[Prediction, ...] = ()

    @property
    def name(self) -> str:
        """The trial's."""
        return self.trial.name


def disagreements(
    fit: AssessedFit,
    trials: Sequence[AskedTrial],
    alone: Mapping[str, AssessedFit],
    errors: Mapping[str, str],
) -> tuple[Reason, ...]:
    """What the trials of a leg say against the fit that stands for it.

    Parameters
    ----------
    fit : AssessedFit
        Of several trials together, or of the only one.
    trials : sequence of AskedTrial
        All that it was made of, and all that it predicts.
    alone : mapping of str to AssessedFit
        Fits of single trials, by trial.
    errors : mapping of str to str
        What is wrong with trials that were left out for it, by trial.

    Returns
    -------
    tuple of Reason
        Those of the stiffness first; empty where the trials agree.
    """
    if fit.assessment.adequacy.grade is Grade.INADEQUATE:
        return ()
    relaxed = [t for t in trials if t.trial.moves and t.trial.effort == "passive"]
    slopes = [reason for trial in relaxed if (reason := _other_slope(fit, trial))]
    slopes += _other_holds(fit, [t for t in trials if t.trial.hold and t.trial.effort == "passive"])
    single = [
        reason
        for name, by_itself in alone.items()
        if by_itself is not fit and (reason := _other_stiffness(fit, name, by_itself))
    ]
    left_out = list(_missed(trials))
    wrong = [against("error-stands", trial=name, what=what) for name, what in errors.items()]
    return (*slopes, *single, *left_out, *wrong)


def _missed(trials: Sequence[AskedTrial]) -> Iterator[Reason]:
    """Trials that were left out, and are predicted worse than the fit promises.

    Of many trials one is farther out than one alone would be (Bonferroni).
    """
    left_out = [trial for trial in trials if trial.predictions]
    far = BEYOND / NORMAL * _sure(len(left_out))
    for trial in left_out:
        worst = max(trial.predictions, key=lambda p: max(_errors(p)))
        missed, off = _errors(worst)
        assert worst.doubt is not None
        _, e = worst.errors
        bias = float(e.mean())
        if trial.trial.moves and missed > far:
            promised = worst.doubt.of_changes
            error = missed * promised
            yield against("misses-trial", trial=trial.name, error=error, promised=promised)
        elif off > far:
            sd = worst.doubt.of_mean
            yield against("mean-of-trial", trial=trial.name, bias=bias, allowed=far * sd)


def _errors(p: Prediction) -> tuple[float, float]:
    """Error of a torque's changes, and of its mean, in what the fit promises of them."""
    assert p.doubt is not None
    _, e = p.errors
    return float(np.std(e)) / p.doubt.of_changes, abs(float(e.mean())) / p.doubt.of_mean


def _sure(comparisons: int) -> float:
    """Standard deviations that 95 % of so many normal numbers are all within."""
    from scipy.special import ndtri

    return float(ndtri(1.0 - 0.025 / max(comparisons, 1)))


def _other_slope(fit: AssessedFit, trial: AskedTrial) -> Reason | None:
    """Where a relaxed torque rises over the angle as the fit's stiffness does not allow.

    Both slopes are of the same samples, so that weight, relaxation and hysteresis are in both; what
    they differ by is held against the 95 % interval of the fit's relaxed stiffness there.
    """
    far: list[tuple[float, Reason]] = []
    for part, modelled in _followed(fit, trial):
        for angle, measured, torque in _ranges(part, modelled):
            middle = float(np.degrees(0.5 * (angle.min() + angle.max())))
            half = _half_width(fit, middle)
            if half is None:
                continue
            rise, se = _slope(angle, measured)
            expected, _ = _slope(angle, torque)
            off, _ = _slope(angle, measured - torque)
            allowed = float(np.hypot(half, NORMAL * se))
            if abs(off) > allowed:
                reason = against(
                    "other-slope",
                    trial=trial.name,
                    low=float(np.degrees(angle.min())),
                    high=float(np.degrees(angle.max())),
                    measured=rise,
                    expected=expected,
                    allowed=allowed,
                )
                far.append((abs(off) / allowed, reason))
    return max(far, key=lambda each: each[0])[1] if far else None


def _other_holds(fit: AssessedFit, holds: Sequence[AskedTrial]) -> list[Reason]:
    """Where a line through relaxed held angles rises as the fit's stiffness does not allow."""
    means = [
        (
            float(np.mean(np.concatenate([p.angle[p.counts] for p in asked.parts]))),
            *(float(np.mean(np.concatenate(each))) for each in zip(*errors, strict=True)),
        )
        for asked in holds
        if (errors := [p.errors for p in asked.predictions])
    ]
    if len(means) < _HOLDS or np.ptp(angle := np.array([each[0] for each in means])) < _SPAN:
        return []
    torque, missed = np.array(means)[:, 1:].T
    half = _half_width(fit, float(np.degrees(angle.mean())))
    if half is None:
        return []
    line = _through(angle, missed)
    rise = _through(angle, torque)
    ends = max(abs(line.value - end) for end in line.ci95)
    allowed = float(np.hypot(half, ends))
    if abs(line.value) <= allowed:
        return []
    return [
        against(
            "other-holds",
            count=float(len(means)),
            low=float(np.degrees(angle.min())),
            high=float(np.degrees(angle.max())),
            measured=rise.value,
            expected=rise.value - line.value,
            allowed=allowed,
        )
    ]


def _through(angle: FloatArray, torque: FloatArray) -> Student:
    """Slope of a line through held angles [Nm/deg], with Student's t of what it misses."""
    away = np.degrees(angle - angle.mean())
    square = float(away @ away)
    slope = float(away @ torque) / square
    left = torque - torque.mean() - slope * away
    free = len(angle) - 2
    return Student(slope, float(np.sqrt(left @ left / free / square)), free)


def _followed(fit: AssessedFit, trial: AskedTrial) -> Iterator[tuple[ModelInputs, FloatArray]]:
    """Each part of a trial with the torque that the fit has of it [Nm], shape (n,)."""
    pairs = list(zip(fit.result.problem.inputs, fit.result.residuals, strict=True))
    for number, part in enumerate(trial.parts):
        assert part.torque is not None
        if trial.predictions:
            yield part, trial.predictions[number].torque
            continue
        for recording, left in pairs:
            if same_signals(recording, part):
                yield part, part.torque - left


def _ranges(
    part: ModelInputs, modelled: FloatArray
) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
    """Angle [rad], measured and modelled torque [Nm] of ranges of 10° from dorsiflexion down."""
    assert part.torque is not None
    angle, torque, by_model = (each[part.counts] for each in (part.angle, part.torque, modelled))
    low, top = np.percentile(angle, [1.0, 99.0])
    while top - low >= _SPAN:
        bottom = max(low, top - _WIDE)
        there = (angle >= bottom) & (angle <= top)
        if there.sum() > 2 and np.ptp(angle[there]) >= 0.8 * _SPAN:
            yield angle[there], torque[there], by_model[there]
        top -= _WIDE


def _slope(angle: FloatArray, torque: FloatArray) -> tuple[float, float]:
    """Slope by least squares and its standard error [Nm/deg]; neighbouring errors are alike."""
    away = np.degrees(angle - angle.mean())
    square = float(away @ away)
    slope = float(away @ torque) / square
    left = torque - torque.mean() - slope * away
    sse = float(left @ left)
    lag1 = float(np.clip((left[1:] @ left[:-1]) / sse, 0.0, 0.999)) if sse > 0.0 else 0.0
    free = max(len(left) * (1.0 - lag1) / (1.0 + lag1) - 2.0, 1.0)
    return slope, float(np.sqrt(sse / free / square))


def _half_width(fit: AssessedFit, angle: float) -> float | None:
    """Half of the 95 % interval of the relaxed stiffness at an angle [deg]; None where none is.

    The angle is the device's, which all trials have, so that its zero matters to none.
    """
    (stiffness,) = (each for each in DEFINITIONS if each.name == "passive_stiffness")
    known = fit.assessment.uncertainty
    (there,) = evaluate(fit.result, known, [MeasurePoint(stiffness, angle)])
    lost = np.isin(known.names, known.lost)
    if there.value is None or there.missing or there.gradient[lost].any():
        return None
    on_device = np.where(np.array(known.names) == ZERO, 0.0, there.gradient)
    return max(known.half_width(on_device), _LITTLE * abs(there.value))


def _other_stiffness(fit: AssessedFit, name: str, alone: AssessedFit) -> Reason | None:
    """Where a trial's own fit has another stiffness than all together, over the range of both."""
    if alone.assessment.adequacy.grade is Grade.INADEQUATE:
        return None
    end = common_end(each.result for each in (fit, alone))
    both = [quantities(each, (), end, (_COMPARED,)).by_name.get(_COMPARED) for each in (fit, alone)]
    together, by_itself = (None if q is None else _interval(q) for q in both)
    if together is None or by_itself is None:
        return None
    (value, half), (single, own_half) = together, by_itself
    allowed = max(float(np.hypot(half, own_half)), _LITTLE * abs(value))
    if own_half > abs(single) or abs(single - value) <= allowed:
        return None
    return against(
        "other-stiffness",
        trial=name,
        single=single,
        low=single - own_half,
        high=single + own_half,
        together=value,
        allowed=allowed,
    )


def _interval(q: Quantity) -> tuple[float, float] | None:
    """Value and half of the 95 % interval."""
    if q.value is None or not np.isfinite(q.total):
        return None
    return q.value, NORMAL * q.total


def said_of(reason: Reason) -> Message:
    """What to do about a trial that disagrees."""
    return Message(f"do/{reason.code}", **reason.values)
