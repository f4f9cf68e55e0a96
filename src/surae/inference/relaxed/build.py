"""What a posterior says, as one record: curve, context, findings, grade."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.judging.grade import Grade
from surae.inference.relaxed.context import UNKNOWN, Laboratory
from surae.inference.relaxed.curve import Jump, RelaxedCurve, RestingTrial, RestSamples
from surae.inference.relaxed.estimate import Estimate, estimated
from surae.inference.relaxed.noise import variance
from surae.inference.relaxed.regressors import TAUS, Blocks, Columns
from surae.signals import ModelInputs

#: Probability from which on a reading is said.
_LIKELY = 0.5
#: Seconds of rest below which a leg's curve was 13 % too low on average.
_SHORT = 12.0
#: Noise that a relaxed leg does not have [Nm], and as a part of the curve's rise: effort that no
#: electrode shows, or a device that shakes.
_NOISY = 0.5
_NOISY_PART = 0.08
#: Inertia that a foot on a tared plate hardly has [kg·m²]: of 33 virtual legs with one two have it.
_HEAVY = 0.058
#: Standard deviations by which torque goes with EMG at rest, from which on that is said: of 65
#: virtual legs without any tone none has more than 2.6, of seven with one six have 3.0 to 9.4 (of
#: 62 fresh ones one has more).
_TONIC = 3.5
#: Its size is that between these quantiles of it; the calf's torque is positive.
_USUAL = (0.05, 0.95)
_PULLS = {"tone_calf": 1.0, "tone_tibialis": -1.0}
#: Smaller steps [Nm, deg] are taken off and not called the zero's or the foot's: a muscle that may
#: work by 5 % at the edges of rest pulls by as much.
_WORTH = {"step": 0.75, "slip": 0.5}
#: Steps closer together are one [s].
_ONE_STEP = 0.5
#: Parts of the moved range [deg quantiles].
_ENDS = (0.01, 0.99)


@one_blas_thread()
@lru_cache(maxsize=8)
def curve_of(inputs: tuple[ModelInputs, ...], laboratory: Laboratory) -> RelaxedCurve | Message:
    """The relaxed curve of these recordings, or why there is none; the last ones are kept."""
    return relaxed_curve(inputs, laboratory)


def relaxed_curve(
    trials: Sequence[ModelInputs], laboratory: Laboratory = UNKNOWN
) -> RelaxedCurve | Message:
    """The relaxed curve of the leg of these trials, or why there is none.

    Parameters
    ----------
    trials : sequence of ModelInputs
        Of one leg and mounting: passive, active with pauses, holds.
    laboratory : Laboratory, optional
        What is known of zero and plate.

    Returns
    -------
    RelaxedCurve or Message
        The posterior; a sentence where no trial rests for a second.

    Raises
    ------
    InputError
        A trial has no torque.
    """
    for trial in trials:
        if trial.torque is None:
            raise InputError(f"{trial.where}: there is no torque; add its column")
    estimate = estimated(trials, laboratory)
    if estimate is None:
        return Message("relaxed/no-rest")
    return _curve(estimate, trials, laboratory)


def _curve(
    estimate: Estimate, trials: Sequence[ModelInputs], laboratory: Laboratory
) -> RelaxedCurve:
    columns = estimate.columns
    inner = columns.basis.size + len(TAUS)
    shares = np.array([part.share for part in estimate.parts])
    means = np.array([part.mode.z for part in estimate.parts])
    covariances = np.array([part.mode.covariance() for part in estimate.parts])
    context = _context(columns.names, shares, means[:, inner:], covariances[:, inner:, inner:])
    angles = np.degrees(np.concatenate([trial.angle[trial.counts] for trial in trials]))
    moved = tuple(float(q) for q in np.quantile(angles, _ENDS))
    largest = max(estimate.parts, key=lambda part: part.share)
    data = estimate.data
    noise = max(part.mode.sigma for part in estimate.parts if part is largest)
    noise *= float(np.sqrt(variance(data.ar, data.ma)))
    readings = _readings(estimate)
    resting = [trial for trial in estimate.trials if trial.pieces]
    steps = _steps(estimate, [trial.name for trial in resting], context)
    ends = columns.basis.features([columns.basis.low, columns.basis.high])
    rise = abs(float((ends[1] - ends[0]) @ (shares @ means)[: columns.basis.size]))
    seconds = sum(_seconds(trial) for trial in estimate.trials)
    said = [
        *_grave(noise, rise, seconds),
        *_met(estimate, readings, steps, context, laboratory.plate_known),
    ]
    grade = Grade.DOUBTFUL if any(doubt for doubt, _ in said) else Grade.ADEQUATE
    return RelaxedCurve(
        columns.basis.low,
        columns.basis.high,
        read_only(shares),
        read_only(means[:, :inner]),
        read_only(covariances[:, :inner, :inner]),
        (moved[0], moved[1]),
        laboratory.zero_deg,
        laboratory.zero_sd,
        context,
        readings,
        noise,
        tuple(map(_trial, estimate.trials)),
        steps,
        grade,
        tuple(message for _, message in sorted(said, key=lambda each: not each[0])),
        _samples(estimate, (shares @ means)[inner:]),
        estimate.rest.by == "declared",
        tuple((part.hypothesis.plate, part.hypothesis.reflex) for part in estimate.parts),
        dict(estimate.rest.levels),
    )


def _context(
    names: Sequence[str], shares: FloatArray, means: FloatArray, covariances: FloatArray
) -> dict[str, tuple[float, float]]:
    """Means and standard deviations of what is no tissue, of what has a name for readers."""
    made = {}
    for k, name in enumerate(names):
        if name.startswith("past"):
            continue
        mean = float(shares @ means[:, k])
        spread = float(shares @ (covariances[:, k, k] + (means[:, k] - mean) ** 2))
        made[name] = (mean, float(np.sqrt(spread)))
    return made


def _readings(estimate: Estimate) -> dict[str, float]:
    """Posterior probabilities of what foot, sensor and nerve may be."""
    probabilities = {"plate": 0.0, "reflex": 0.0, "apart": 0.0}
    for each, share in estimate.hypotheses:
        for name, yes in (
            ("plate", each.plate),
            ("reflex", each.reflex),
            ("apart", each.apart and len([t for t in estimate.trials if t.pieces]) > 1),
        ):
            probabilities[name] += share * yes
    return probabilities


def _raises(columns: Columns, context: dict[str, tuple[float, float]]) -> bool:
    """Whether what follows stretch late adds torque, as a reflex does; less of it is none.

    Tissue that softens, or relaxes less than expected, takes torque off late.
    """
    torque = sum(
        context[name][0] * columns.context[:, columns.names.index(name)]
        for name in ("reflex", "reflex_long")
    )
    return bool(np.max(torque) > -np.min(torque))


def _steps(
    estimate: Estimate, names: Sequence[str], context: dict[str, tuple[float, float]]
) -> tuple[Jump, ...]:
    """The steps that were found; one within a block, which has two columns, as one."""
    made: list[Jump] = []
    for k, change in sorted(enumerate(estimate.changes), key=lambda each: each[1].time):
        value, sd = context.pop(f"{change.kind}_{k}")
        step = Jump(change.kind, names[change.trial], change.time, value, sd)
        before = made[-1] if made else step
        alike = (before.kind, before.trial) == (step.kind, step.trial)
        if made and alike and step.time - before.time < _ONE_STEP:
            made[-1] = replace(before, value=before.value + value)
        else:
            made.append(step)
    return tuple(made)


def _seconds(trial: Blocks) -> float:
    return sum(last - first for first, last in trial.pieces) / trial.rate_hz


def _trial(trial: Blocks) -> RestingTrial:
    if not trial.pieces:
        return RestingTrial(trial.name, 0.0, None, None)
    angles = np.concatenate([trial.angle[i:j] for i, j in trial.pieces])
    return RestingTrial(trial.name, _seconds(trial), float(angles.min()), float(angles.max()))


def _samples(estimate: Estimate, context: FloatArray) -> RestSamples:
    columns = estimate.columns
    velocity = np.concatenate([t.velocity[i:j] for t in estimate.trials for i, j in t.pieces])
    seconds = next(1.0 / t.rate_hz for t in estimate.trials if t.pieces)
    left = columns.torque - columns.context @ context
    return RestSamples(
        read_only(columns.angle.copy()), read_only(velocity), read_only(left), seconds
    )


def _grave(noise: float, rise: float, seconds: float) -> Iterator[tuple[bool, Message]]:
    """What speaks against the curve itself."""
    if noise > max(_NOISY, _NOISY_PART * rise):
        yield True, Message("relaxed/noisy", noise=noise)
    if seconds < _SHORT:
        yield True, Message("relaxed/short", seconds=seconds)


def _met(
    estimate: Estimate,
    readings: dict[str, float],
    steps: Sequence[Jump],
    context: dict[str, tuple[float, float]],
    known_plate: bool,
) -> Iterator[tuple[bool, Message]]:
    """What was met, and whether it makes the numbers doubtful."""
    for name in estimate.rest.tonic:
        yield False, Message("relaxed/tone", trial=name)
    if estimate.rest.by == "declared":
        yield False, Message("relaxed/declared")
    if readings["plate"] > _LIKELY:
        weight, inertia = (context[name][0] for name in ("weight", "inertia"))
        yield True, Message("relaxed/plate", weight=weight, inertia=1e3 * inertia)
    elif not known_plate and context["inertia"][0] > _HEAVY:
        yield True, Message("relaxed/heavy", inertia=1e3 * context["inertia"][0])
    if readings["reflex"] > _LIKELY:
        more = _raises(estimate.columns, context)
        yield True, Message("relaxed/reflex" if more else "relaxed/less")
    if readings["apart"] > _LIKELY:
        yield False, Message("relaxed/apart")
    for name, sign in _PULLS.items():
        torque, sd = context[name]
        if sign * torque > _TONIC * sd:
            shown = estimate.columns.context[:, estimate.columns.names.index(name)]
            by = abs(torque) * float(np.diff(np.quantile(shown, _USUAL))[0])
            yield False, Message(f"relaxed/{name}", torque=by)
    for step in steps:
        if abs(step.value) < _WORTH[step.kind]:
            continue
        yield (
            False,
            Message(
                f"relaxed/{step.kind}", trial=step.trial, seconds=step.time, size=abs(step.value)
            ),
        )
