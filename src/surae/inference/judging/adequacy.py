"""Whether a fit is good enough for its numbers to mean something: one gate, with reasons.

A parameter of a model that does not follow the torque is known precisely and means nothing, and so
is one of a leg that did not move. From where on something matters was chosen on virtual legs of the
family.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from statistics import NormalDist

import numpy as np

from surae.base.file_form import filed
from surae.base.records import OrNaN
from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.judging.fascicles import fascicles_of
from surae.inference.judging.goodness import centred_r2, counted
from surae.inference.judging.predicted import TorqueDoubt
from surae.inference.judging.random_effects import farthest_apart
from surae.inference.judging.reasons import Reason, Scope, against
from surae.inference.posterior.conflict import SAID
from surae.model.joint import Joint
from surae.model.laboratory import group_of
from surae.model.source import Gaussian
from surae.model.source_table import LABELS
from surae.model.statements import RARE
from surae.quality.finding import NOT_AS_STATED, Quality
from surae.recording import MUSCLES
from surae.signals import ModelInputs, steady_emg

#: Centred R² [%] below which a model does not describe the torque, and from which on it does well.
_NOT_FOLLOWED = 80.0
_FOLLOWED = 95.0
#: Movement [rad] between the 1st and 99th percentile: below the first an ankle holds still.
_STILL = np.radians(4.0)
_LITTLE = np.radians(10.0)
#: Part of the torque's variance [%] that a structured residual may have, and from which on it is
#: too much; and from which part of the residual on it is called structured.
_LEFT_OUT = 0.5
_TOO_MUCH = 5.0
_STRUCTURED = 0.3
#: What only movement tells: relaxation, and the foot's mass beside a sensor's zero.
_OF_MOVEMENT = ("m", "tau_rel", "k_rel")
#: Part of the free parameters that may lie at a bound before nothing else is believed either.
_MOST_BOUND = 0.5
#: Standard deviations of its prior from which on a nuisance is odd.
_ODD = 2.9
#: Probability of a right statement so far from the torque, below which it is taken for wrong.
_WRONG = 1e-4
#: A recording that is followed so much worse than all together [% of R²] contradicts the others.
_CONTRADICTS = 5.0
#: What a hold may leave of its torque, in what recordings leave; of two virtual sets 1.2 and 1.7.
_LEAVES = 2.0
#: Errors of a prediction, in those that the fit promises, from which on it does not keep its word.
BEYOND = 2.0
#: Standard deviation [mm] from which on a filmed fascicle departs by more than trackers drift.
_OFF_FILM = 2.5
#: Least softening that matters, and its standard deviations from which it is no chance: set on
#: four virtual legs that soften; of the other families of a fresh seed none came to both.
_SOFTENS = 0.06
_SURE = 2.5
#: Size of what no model has of the muscles' force, as a part of it, from which on it speaks against
#: the numbers: of 142 fits of virtual legs 136 have at most 0.019, six at least 0.035.
_UNEXPRESSED = 0.03
#: Findings of which the torque at rest knows nothing.
_OF_EMG = ("electrodes-swapped", "emg-unit")
#: Reasons that are errors of recordings.
OF_RECORDINGS = ("not-as-stated", "error-stands")
#: Findings that a fit meets otherwise: it is of the parts between gaps, and judges what moves.
_MET_OTHERWISE = ("time-gap", "angle-still")
#: Below this cut-off [Hz] EMG is taken for what the muscle makes of it.
_ACTIVATION_HZ = 2.0


class Grade(StrEnum):
    """Judgement of a whole fit."""

    ADEQUATE = "adequate"
    DOUBTFUL = "doubtful"
    INADEQUATE = "inadequate"


@filed(against="codes", reasons="reasons")
@dataclass(frozen=True, slots=True)
class Adequacy:
    """Whether a fit is good enough for its numbers to mean something."""

    grade: Grade  #: ``inadequate`` withholds every claim; ``doubtful`` asks for caution.
    against: tuple[Reason, ...]  #: The gravest first; empty for an adequate fit.
    #: Centred R² over all recordings, 100·(1 − Σe²/Σ(T − T̄)²) [%]; NaN without a finite torque.
    r2: OrNaN

    def doubt_of(self, rests_on: Collection[Scope]) -> Reason | None:
        """Find what speaks against a value.

        Parameters
        ----------
        rests_on : collection of Scope
            What of the fit the value rests on (`scopes_of`); empty where that is not known.

        Returns
        -------
        Reason or None
            The gravest doubt that touches it.
        """
        return next((reason for reason in self.against if reason.touches(rests_on)), None)

    @property
    def reasons(self) -> tuple[str, ...]:
        """What speaks against it, in sentences, the gravest first."""
        return tuple(map(str, self.against))


def judge_adequacy(result: FitResult, quality: Sequence[Quality] = ()) -> Adequacy:
    """Judge a whole fit, of recordings with what was found in them."""
    inputs = result.problem.inputs
    residuals = result.residuals
    r2 = centred_r2(list(map(counted, inputs, residuals)))
    if result.status == "failed" or not np.isfinite(r2):
        return _graded([against("failed", grave=True)], r2)
    reasons = [
        *of_recordings(quality),
        *_goodness(r2),
        *_movement(inputs, result.problem.options.anatomy),
        *_effort(result),
        *_structure(inputs, residuals, r2),
        *_bounds(result),
        *(odd := list(_laboratory(result))),
        *_stated(result),
        *_agreement(result, r2),
        *_films(result),
        *_unlike(result, odd),
    ]
    return _graded(reasons, r2)


def of_recordings(quality: Sequence[Quality]) -> tuple[Reason, ...]:
    """What errors of its recordings say against whatever is made of them."""
    return (*_not_as_stated(quality), *_errors(quality))


def _graded(reasons: Iterable[Reason], r2: float) -> Adequacy:
    """The judgement that reasons lead to, the gravest first."""
    ordered = tuple(sorted(reasons, key=lambda reason: not reason.is_grave))
    grade = Grade.ADEQUATE
    if ordered:
        grade = Grade.INADEQUATE if ordered[0].is_grave else Grade.DOUBTFUL
    return Adequacy(grade, ordered, r2)


def _goodness(r2: float) -> Iterator[Reason]:
    """The torque's changes count, not its offset, which any gravity or zero explains."""
    if r2 < _NOT_FOLLOWED:
        yield against("not-followed", grave=True, r2=r2)
    elif r2 < _FOLLOWED:
        yield against("followed-roughly", r2=r2)


def _not_as_stated(quality: Sequence[Quality]) -> Iterator[Reason]:
    """Grave but for signs and electrodes: of these a quick fit accuses a relaxed leg of forty."""
    for trial in quality:
        for code in sorted(
            NOT_AS_STATED & {f.code for f in trial.findings if f.severity == "error"}
        ):
            scope = Scope.MUSCLES if code in _OF_EMG else Scope.ALL
            yield against(
                "not-as-stated",
                grave="-unit" in code,
                scope=scope,
                trial=trial.recording,
                code=code,
            )


def _errors(quality: Sequence[Quality]) -> Iterator[Reason]:
    """Any other error that stands, of each recording the first."""
    for trial in quality:
        found = [
            f
            for f in trial.findings
            if f.severity == "error" and f.code not in (*NOT_AS_STATED, *_MET_OTHERWISE)
        ]
        if found:
            of_emg = all((f.channel or "").startswith("emg") for f in found)
            scope = Scope.MUSCLES if of_emg else Scope.ALL
            yield against("error-stands", scope=scope, trial=trial.recording, what=found[0].message)


def _range(inputs: Sequence[ModelInputs]) -> float:
    """Movement of all recordings together [rad]: several holds at different angles have one."""
    angle = np.concatenate([recording.angle[recording.counts] for recording in inputs])
    return float(np.ptp(np.percentile(angle, [1.0, 99.0])))


def _movement(inputs: Sequence[ModelInputs], joint: Joint) -> Iterator[Reason]:
    """An ankle that holds still shows neither stiffness nor an optimal length."""
    moved = _range(inputs)
    degrees = float(np.degrees(moved))
    if moved < _STILL:
        yield against("still", joint.worded, grave=True, moved=degrees)
    elif moved < _LITTLE:
        yield against("moves-little", joint.worded, moved=degrees)


def _effort(result: FitResult) -> Iterator[Reason]:
    """Weights that are free need an EMG that changes."""
    problem = result.problem
    steady = zip(MUSCLES, problem.spec.weights, steady_emg(problem.inputs), strict=True)
    silent = [
        muscle.upper() for muscle, weight, is_so in steady if is_so and weight in problem.free
    ]
    if silent:
        yield against("emg-steady", scope=Scope.MUSCLES, muscles=", ".join(silent))


def _structure(
    inputs: Sequence[ModelInputs], residuals: Sequence[FloatArray], r2: float
) -> Iterator[Reason]:
    """What angle, velocity and activation explain of the residual belongs to the leg."""
    share = structure(inputs, residuals)
    left_out = share * (100.0 - r2)
    if share >= _STRUCTURED and left_out >= _LEFT_OUT:
        grave = left_out > _TOO_MUCH
        yield against("left-out", grave=grave, share=100.0 * share, left_out=left_out)


def _bounds(result: FitResult) -> Iterator[Reason]:
    """An estimate at its bound is where the search ended, not what the data say."""
    leg = [name for name in result.problem.free if group_of(name) is None]
    if all(_range([recording]) < _STILL for recording in result.problem.inputs):
        leg = [name for name in leg if name not in _OF_MOVEMENT]  # which holds do not tell
    if own := [name for name in leg if name in result.at_bound]:
        grave = len(own) > _MOST_BOUND * len(leg)
        yield against("at-bound", grave=grave, names=", ".join(own))


def _laboratory(result: FitResult) -> Iterator[Reason]:
    """A laboratory that is odder than laboratories are stands for what the model leaves out."""
    posterior = result.posterior
    if posterior is None:
        return
    own = posterior.each
    joint = result.problem.options.anatomy
    meanings = {p.name: joint.worded(p.meaning) for p in result.problem.spec.parameters}
    stated = result.problem.settings.known
    odd = [
        f"{meanings[name]} ({name})"
        for name, belief in posterior.beliefs.items()
        if group_of(name) not in stated and _is_odd(own.get(name, (result.values[name],)), belief)
    ]
    if odd:
        yield against("implausible", names=", ".join(odd))


def _is_odd(values: Sequence[float], belief: Gaussian) -> bool:
    """Whether one of some values is farther from what was believed than the farthest mostly is.

    Of many trials one is farther out than one alone would be (Šidák 1967).
    """
    usual = NormalDist().cdf(_ODD) - NormalDist().cdf(-_ODD)
    most = NormalDist().inv_cdf(0.5 + 0.5 * usual ** (1.0 / len(values)))
    return max(abs(value - belief.mean) for value in values) >= most * belief.sd


def _stated(result: FitResult) -> Iterator[Reason]:
    """What was known beforehand, where the torque or its own steps say otherwise."""
    known = result.problem.settings.knowledge
    for doubt in () if known is None else known.doubts:
        yield against("said", text=doubt)
    for source, made in ({} if known is None else known.statements).items():
        if made.agrees is False:
            label = result.problem.options.anatomy.worded(LABELS[source])
            texts = made.texts
            yield against("disagree", label=label, first=texts[0], second=texts[1])
    contradicted = {} if result.posterior is None else result.posterior.contradicted
    for group, probability in sorted(contradicted.items()):
        label = result.problem.options.anatomy.worded(LABELS[group])
        if probability < RARE:
            scope = Scope.MUSCLES if group == "crosstalk" else Scope.ALL
            yield against("contradicted", grave=probability < _WRONG, scope=scope, label=label)


def _agreement(result: FitResult, r2: float) -> Iterator[Reason]:
    """Several recordings of a leg should follow one set of parameters alike.

    A hold's torque may hardly change: it is held against what the others leave too; in one that is
    strong the same share of the torque is more of it.
    """
    inputs = result.problem.inputs
    residuals = result.residuals
    pairs = list(map(counted, inputs, residuals))
    alone = () if result.posterior is None else result.posterior.recordings
    name, rare = farthest_apart(alone) if alone else ("", 1.0)
    if rare < SAID:
        yield against("not-one-leg", name=name)
    usual = float(np.median([np.sqrt(np.mean(e**2)) for _, e in pairs]))
    for recording, pair in zip(inputs, pairs, strict=True):
        own = centred_r2([pair])
        name = recording.name
        grave = own < _NOT_FOLLOWED
        error = float(np.sqrt(np.mean(pair[1] ** 2)))
        if _range([recording]) < _STILL and len(inputs) > 1:
            if error > _LEAVES * usual and own < r2 - _CONTRADICTS:
                yield against(
                    "hold-not-followed", grave=grave, trial=name, error=error, usual=usual
                )
        elif own < r2 - _CONTRADICTS:
            yield against("trial-not-followed", grave=grave, trial=name, r2=own)


def _films(result: FitResult) -> Iterator[Reason]:
    """Trackers drift by 1 to 2 mm: what departs by more is not how the muscle moves."""
    for film in fascicles_of(result):
        away = 1e3 * float(np.std(film.measured - film.modelled))
        if away > _OFF_FILM:
            code = "film-differs" if film.stretch.any() else "film-rigid"
            yield against(code, channel=film.channel, trial=film.recording, away=away)


def _unlike(result: FitResult, odd: Sequence[Reason]) -> Iterator[Reason]:
    """What is told is to hold for the leg as it stays; an odd laboratory hides what muscles do."""
    posterior = result.posterior
    if posterior is None:
        return
    for trial, (size, sd) in zip(result.problem.inputs, posterior.softening, strict=False):
        if size > max(_SOFTENS, _SURE * sd):
            yield against("softened", trial=trial.name, stiffer=100.0 * size)
    if not odd and (left := posterior.sizes.get("misfit", 0.0)) > _UNEXPRESSED:
        yield against("no-model", part=100.0 * left)


def judge_prediction(
    doubt: TorqueDoubt, recording: ModelInputs, joint: Joint, measured: FloatArray, e: FloatArray
) -> Adequacy:
    """Judge how a fit predicts a recording that it has not seen, against what it promises.

    The mean is judged apart from the changes, of which `r2` is: a sensor's zero is another in each
    recording. `e` is the measured torque minus what is predicted, where samples count [Nm].
    """
    bias = float(e.mean())
    changes = e - bias
    r2 = centred_r2([(measured, changes)])
    if not np.isfinite(r2):
        return _graded([against("unchanging", grave=True)], r2)
    reasons = list(_goodness(r2))
    if _range([recording]) < _STILL:
        reasons = [against("held-still", joint.worded)]
    error = float(np.sqrt(np.mean(changes**2)))
    if not error <= BEYOND * doubt.of_changes:
        reasons.append(against("errs", error=error, promised=doubt.of_changes))
    if not abs(bias) <= BEYOND * doubt.of_mean:
        reasons.append(against("mean-off", bias=bias, promised=BEYOND * doubt.of_mean))
    return _graded(reasons, r2)


def doubted(
    adequacy: Adequacy,
    reasons: Sequence[Reason],
    codes: Collection[str],
    recordings: Sequence[str] = (),
) -> Adequacy:
    """The judgement with what other trials of the leg say against it, as the only such `codes`.

    An error that stands in one of the fit's `recordings` is not of another trial, and is said once.
    """

    def is_own(reason: Reason) -> bool:
        return reason.code in OF_RECORDINGS and reason.values.get("trial") in recordings

    before = [each for each in adequacy.against if each.code not in codes or is_own(each)]
    known = {(each.code, each.values["trial"]) for each in before if is_own(each)}
    more = [
        each
        for each in reasons
        if not is_own(each) or (each.code, each.values["trial"]) not in known
    ]
    return _graded([*before, *more], adequacy.r2)


def structure(inputs: Sequence[ModelInputs], residuals: Sequence[FloatArray]) -> float:
    """Part of the residual's variance that angle, velocity and activation explain, 0 … 1.

    A linear regression in each recording on the angle to its third power, on velocity and its size
    and sign, and on each muscle's activation and its product with the angle; lessened by what as
    many regressors explain of noise that is as correlated as the residual [Nm].
    """
    explained = total = 0.0
    for recording, residual in zip(inputs, residuals, strict=True):
        mask = recording.counts
        e = residual[mask] - residual[mask].mean()
        sse = float(e @ e)
        if not np.isfinite(sse) or sse <= 0.0:
            continue
        features = _features(recording)[mask]
        features -= features.mean(axis=0)
        norms = np.linalg.norm(features, axis=0)
        features = features[:, norms > 0] / norms[norms > 0]
        u, s, _ = np.linalg.svd(features, full_matrices=False)
        basis = u[:, s > 1e-6 * s[0]] if len(s) else u
        lag1 = float(np.clip((e[1:] @ e[:-1]) / sse, 0.0, 0.999))
        independent = len(e) * (1.0 - lag1) / (1.0 + lag1)
        k = basis.shape[1]
        if independent > k + 2:
            share = float(np.sum((basis.T @ e) ** 2)) / sse
            share = 1.0 - (1.0 - share) * (independent - 1.0) / (independent - k - 1.0)
            explained += max(share, 0.0) * sse
        total += sse
    return explained / total if total > 0.0 else 0.0


def _features(recording: ModelInputs) -> FloatArray:
    """What a residual should not follow, shape (n, k)."""
    from scipy.signal import butter, sosfiltfilt

    angle = recording.angle - recording.angle.mean()
    speed = recording.velocity
    top = max(float(np.abs(speed).max()), 1e-12)
    columns = [angle, angle**2, angle**3, speed, np.abs(speed), np.tanh(10.0 * speed / top)]
    active = recording.emg
    if recording.rate_hz > 2.5 * _ACTIVATION_HZ and recording.n > 20:
        sos = butter(2, _ACTIVATION_HZ, fs=recording.rate_hz, output="sos")
        active = sosfiltfilt(sos, active, axis=0)
    for channel in active.T:
        columns += [channel, channel * angle]
    return np.stack(columns, axis=1)
