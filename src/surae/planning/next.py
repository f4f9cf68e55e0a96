"""What to measure next: what a fit knows counts, and the ready trial that adds most is named."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import PathLike
from surae.base.frozen import Comparable, FrozenDict
from surae.base.packed import finite
from surae.base.records import Plain
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import AssessedFit, Assessment
from surae.inference.judging.grade import Grade
from surae.inference.judging.parameter import percent
from surae.inference.judging.verdict import IDENTIFIED, Verdict
from surae.inference.uncertainty.covariance import half_width
from surae.planning.information import estimated, information, shared
from surae.planning.legs import Legs
from surae.planning.ready import Ready, ready_protocols
from surae.protocol import Device, Trajectory, write_protocol

#: Rate of the trials that are judged [Hz].
_RATE_HZ = 256.0
#: More repetitions than these are not asked of anybody.
MOST = 20
#: A trial that lowers no wanted interval by this part adds nothing.
_ADDS = 0.1
#: An interval half as wide as this many times the value says as little as none.
_UNKNOWN = 10.0
#: Identification is promised where the interval is expected to be this part of what it needs.
_SURELY = 0.85


@filed("trajectory")
@dataclass(frozen=True, slots=True, eq=False)
class NextTrial(Comparable, Plain):
    """The trial that adds most to what a fit knows."""

    protocol: str | None  #: Name of the ready protocol; None where none would help.
    sentences: tuple[str, ...]  #: The answer in words, the first sentence first.
    #: Half of each wanted parameter's 95 % interval as a part of its value, now and after one such
    #: trial; None where there is none.
    gains: Mapping[str, tuple[float | None, float | None]]
    #: How many such trials until it is identified; None for more than `MOST`.
    repetitions: Mapping[str, int | None]
    trajectory: Trajectory | None  #: The trial.

    def __repr__(self) -> str:
        return "\n".join(self.sentences)

    def write(self, path: PathLike, *, without_limits: str | None = None) -> None:
        """Write the trial for a device, as `Design.write` does.

        Parameters
        ----------
        path : path
            Where to.
        without_limits : str, optional
            Why no device's limits have to hold.

        Raises
        ------
        InputError
            There is no trial, or the file cannot be written.
        """
        if self.trajectory is None:
            raise InputError("there is no trial to write: " + self.sentences[0])
        write_protocol(self.trajectory, path, without_limits=without_limits)


def known_from(fit: AssessedFit, legs: Legs) -> FloatArray:
    """Information that a fit has, on ``legs.free``, and priors of another trial's own nuisances.

    Intervals that are believed for correlated residuals are believed here too. Nuisances that
    trials share are in with their priors, once. The legs are those of the fit (`fit_legs`).
    """
    free = legs.free
    each_trial = legs.each_trial
    alone = each_trial | {n for n in free if n not in fit.result.problem.free}  # another film
    known = np.diag([legs.priors[n].sd ** -2.0 if n in alone else 0.0 for n in free])
    uncertainty = fit.assessment.uncertainty.at_assumed  # no trial tells arms and paths
    shares = {*free} - {*each_trial, *uncertainty.lost}
    names = [
        n
        for n in uncertainty.names
        if n in shares and uncertainty.budget(uncertainty.along(n)).sd > 0.0
    ]
    if names:
        at = [free.index(name) for name in names]
        block = uncertainty.covariance(*names)
        scale = np.sqrt(np.diag(block))
        inverse = np.linalg.pinv(block / np.outer(scale, scale), hermitian=True)
        known[np.ix_(at, at)] += inverse / np.outer(scale, scale)
    return np.asarray(known)


def measure_next_of(
    fit: AssessedFit,
    legs: Legs,
    *,
    noise: float,
    device: Device | None,
    angle_range: tuple[float, float],
    longest: float,
    wanted: Sequence[str] | None = None,
) -> NextTrial:
    """The ready trial that adds most to a fit.

    The legs are the fitted leg's, `noise` [Nm] is that of one sample at 256 Hz. No trial longer
    than `longest` [s] is proposed; `wanted` are parameters to know better, by default all that are
    not identified.
    """
    assessment = fit.assessment
    if unknown := [name for name in wanted or () if name not in legs.leg_parameters]:
        raise InputError(
            f"{unknown[0]} is not estimated by this fit; it has: {', '.join(legs.leg_parameters)}"
        )
    if assessment.adequacy.grade is Grade.INADEQUATE:
        return _nothing("inadequate", reason=assessment.adequacy.reasons[0])
    weak = tuple(wanted or (n for n in legs.leg_parameters if not _is_known(assessment, n)))
    if not weak:
        return _nothing("identified")
    known = known_from(fit, legs)
    best: tuple[float, Ready, Trajectory, FloatArray] | None = None
    names = tuple(n for n in legs.free if n not in legs.each_trial)
    with one_blas_thread():
        before, stays = _remaining(assessment, legs, known)

        def after(adds: FloatArray) -> dict[str, float]:
            halves = _half_widths(names, known, legs, adds)
            return {n: min(np.hypot(halves[n], stays[n]), before[n]) for n in weak}

        for ready in ready_protocols().values():
            if ready.seconds > longest:
                continue
            try:
                trajectory = ready.trajectory(device, angle_range, _RATE_HZ, legs)
            except InputError:
                continue
            adds = np.nanmean(shared(information(trajectory, legs, noise), legs).matrices, axis=0)
            once = after(adds)
            gain = float(np.sum([np.log(_capped(before[n]) / _capped(once[n])) for n in weak]))
            gain /= ready.seconds**0.5
            if best is None or gain > best[0]:
                best = gain, ready, trajectory, adds
        if best is None:
            return _nothing("fits-none", seconds=longest)
        _, ready, trajectory, adds = best
        halves = [after(k * adds) for k in range(1, MOST + 1)]
    # no trial tells arms and paths
    rests = {n for n in weak if assessment.uncertainty.goes_with_geometry(n)}
    many: dict[str, int | None] = {
        n: None
        if n in rests
        else next((k for k, h in enumerate(halves, 1) if h[n] <= _SURELY * IDENTIFIED), None)
        for n in weak
    }
    gained = {n: _capped(halves[0][n]) / _capped(before[n]) for n in weak}
    better = sorted((n for n in weak if gained[n] < 1.0 - _ADDS), key=lambda n: gained[n])
    if not better:
        return _nothing("adds-none", names=", ".join(weak))
    changes = None
    for n in better[2::-1]:
        change = Message("next/change", name=n, now=_text(before[n]), then=_text(halves[0][n]))
        changes = change if changes is None else Message("{one}, {more}", one=change, more=changes)
    sentences = [
        Message(
            "next/trial",
            name=ready.name,
            seconds=ready.seconds,
            changes=changes,
            description=Message(ready.description),
        )
    ]
    reached = {n: k for n, k in many.items() if k is not None}
    for times in sorted(set(reached.values())):
        which = ", ".join(n for n, k in reached.items() if k == times)
        code = "next/once" if times == 1 else "next/times"
        sentences.append(Message(code, n=times, names=which, percent=percent(IDENTIFIED)))
    if weak_still := [n for n in weak if n not in reached]:
        sentences.append(Message("next/weak", names=", ".join(weak_still), n=MOST))
    gains = FrozenDict({n: (finite(before[n]), finite(halves[0][n])) for n in weak})
    return NextTrial(ready.name, tuple(sentences), gains, FrozenDict(many), trajectory)


def fit_precision(fit: AssessedFit, legs: Legs) -> dict[str, Any]:
    """What a fit tells an expectation: information, half widths, and what of these stays."""
    known = known_from(fit, legs)
    now, stays = _remaining(fit.assessment, legs, known)
    return {"known": known, "now": now, "stays": stays}


def _is_known(assessment: Assessment, name: str) -> bool:
    """Whether all is known of a parameter that a trial could tell: no arm, no path."""
    p = assessment.parameters[name]
    known = assessment.uncertainty
    if p.verdict is Verdict.IDENTIFIED or not (known.goes_with_geometry(name) and p.repeatable):
        return p.verdict is Verdict.IDENTIFIED
    uncertainty = known.at_assumed
    return uncertainty.half_width(uncertainty.along(name)) <= IDENTIFIED * abs(p.value)


def _remaining(
    assessment: Assessment, legs: Legs, known: FloatArray
) -> tuple[dict[str, float], dict[str, float]]:
    """Half of each interval that a fit has, as a part of the value, and what of it stays.

    What is not noise no further trial of the same model lowers.
    """
    names = tuple(n for n in legs.free if n not in legs.each_trial)
    before = _half_widths(names, known, legs)
    stays = dict.fromkeys(before, 0.0)
    uncertainty = assessment.uncertainty
    for name in legs.leg_parameters:
        value = abs(assessment.parameters[name].value)
        alone = before[name]
        if name not in uncertainty.lost and value and np.isfinite(alone):
            half = uncertainty.half_width(uncertainty.along(name)) / value
            stays[name] = max(half**2 - alone**2, 0.0) ** 0.5
    return {n: float(np.hypot(before[n], stays[n])) for n in before}, stays


def _half_widths(
    names: Sequence[str], known: FloatArray, legs: Legs, adds: FloatArray | None = None
) -> dict[str, float]:
    """Half of each 95 % interval as a part of the value; infinite where it trades off."""
    at = [legs.free.index(name) for name in names]
    estimate = estimated(names, known[np.ix_(at, at)] + (0.0 if adds is None else adds))
    parts = dict.fromkeys(names, np.inf)
    if estimate is not None:
        for name, variance in zip(estimate.names, np.diag(estimate.matrix), strict=True):
            value = abs(float(legs.values[0, legs.spec.names.index(name)]))
            if value > 0.0:
                parts[name] = half_width(1.0, 1e9) * float(variance) ** 0.5 / value
    return parts


def _capped(part: float) -> float:
    return min(part, _UNKNOWN)


def _text(part: float) -> Message:
    known = np.isfinite(part)
    return Message("±{percent}", percent=percent(part)) if known else Message("unknown")


def _nothing(code: str, **values: Any) -> NextTrial:
    sentence = Message(f"next/{code}", **values)
    return NextTrial(None, (sentence,), FrozenDict(), FrozenDict(), None)
