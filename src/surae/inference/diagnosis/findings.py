"""Findings of the checks and of quick fits together: a sign, a zero or a lag is tried by a fit."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from surae.base.words import Message
from surae.inference.diagnosis.angle import wrong_angle
from surae.inference.diagnosis.between import (
    cannot_tell,
    drifting_clock,
    lag_finding,
    lagging_stream,
)
from surae.inference.diagnosis.clocks import ClockDrift, clock_finding, estimated_clock
from surae.inference.diagnosis.competing import GOOD_ENOUGH, Rivals, best_of, rivals, signs, zero
from surae.inference.diagnosis.explanations import EVIDENCE, EXPLAINS, evidence
from surae.inference.diagnosis.long import examined_in_windows, is_long
from surae.inference.diagnosis.moving import moved
from surae.inference.diagnosis.quick import QuickFit, quick_fit
from surae.inference.diagnosis.units import wrong_units
from surae.quality import Commanded, Finding, Quality, Skipped, check_recording
from surae.quality.electrodes import Electrodes
from surae.quality.finding import make_finding
from surae.quality.numeric import quantiles, span_of
from surae.quality.position import perturbing
from surae.quality.registry import ordered, unfit
from surae.quality.timing import TOO_SHORT
from surae.quality.torque import GRAVITY
from surae.quality.trial import Signals, signals_of
from surae.quality.used import used
from surae.recording import MUSCLES, Recording

#: Part of what a fit leaves that shifting the EMG must take away before a lag is claimed.
_SHIFT_GAIN = 0.03
#: An angle that keeps within this [rad] for all but a hundredth of the time is held still.
STILL = 0.03
#: Part of a zero seen in the torque's constant part that a fit must find too.
_AGREED = 0.25
#: What only a fit tells.
_BY_FIT = ("angle-sign", "electrodes-swapped", "emg-torque-lag", "torque-drift", "emg-gain")


def examined(
    recording: Recording,
    commanded: Commanded | None = None,
    left_out: Iterable[Sequence[float]] = (),
    electrodes: Electrodes | None = None,
) -> Quality:
    """All findings of a recording: those of the checks, and what is wrong with signs and units.

    What is wrong is put right before the checks look, so that what follows from it is no finding.
    Only what a fit reads is judged. `commanded` is the motion that the device was to follow,
    `left_out` are windows (start and end [s]) that do not count. `electrodes` are what all trials
    of the leg show of theirs; without them the trial is judged against itself. One of hours is
    judged in windows.
    """
    if not is_long(recording):
        return _examined(recording, commanded, left_out, electrodes)
    reads, beside = used(recording, left_out)
    quality = examined_in_windows(
        reads,
        lambda window, known, clocks: _examined(window, commanded, (), known, clocks=clocks),
        electrodes,
    )
    return replace(quality, findings=ordered([*beside, *quality.findings]))


def _examined(
    recording: Recording,
    commanded: Commanded | None,
    left_out: Iterable[Sequence[float]],
    electrodes: Electrodes | None,
    *,
    clocks: bool = True,
) -> Quality:
    """All findings of a trial; of its `clocks` where they are looked at."""
    findings, right = wrong_units(recording, electrodes)
    if electrodes is not None:
        electrodes = electrodes.in_units(recording, right)
    if "angle" in right.channels:
        right, beside = used(right, left_out)
        findings += beside
        if (angle := wrong_angle(right)) is not None:
            findings.append(angle[0])
            right = angle[1]
    if unfit(right) is not None:
        return _together(check_recording(right, commanded, electrodes=electrodes), findings)
    signals = signals_of(right)
    quality = check_recording(right, commanded, signals, electrodes=electrodes)
    low, high = quantiles(signals.angle, 0.005, 0.995)
    if high - low < STILL:
        span = span_of(signals.time)
        degrees = np.rad2deg(high - low)
        findings.append(make_finding("angle-still", "angle", span, high - low, degrees=degrees))
        return _together(quality, findings, but=("angle-units", "rom-not-covered"))
    # inertia makes most of the torque of small random perturbations
    movable = signals.torque is not None and not perturbing(signals.angle, signals.rate_hz)
    if movable and float(np.ptp(signals.time)) < TOO_SHORT:
        reason = f"Shorter than {TOO_SHORT:g} s, it can be fitted in too many ways to tell."
        skipped = (*quality.skipped, *(Skipped(code, reason) for code in _BY_FIT))
        return _together(replace(quality, skipped=skipped), findings)
    fit = quick_fit(right, signals) if movable else None
    if fit is None:
        return _together(quality, findings)
    drift = _drift(right, signals, fit, wanted=clocks)
    if drift is not None:  # all that follows from it is no finding
        findings.append(clock_finding(drift, signals))
        signals = drift.right(signals)
        fit = drift.after
    tries = rivals(right, signals, fit)
    wrong, with_signs = signs(right, signals, tries)
    if wrong:
        if with_signs is not right:
            quality = check_recording(with_signs, commanded, electrodes=electrodes)
        return _together(quality, [*findings, *wrong], but=("torque-sign",))
    return _by_a_fit(quality, right, signals, (fit, tries, drift is None), findings)


def _drift(
    recording: Recording, signals: Signals, fit: QuickFit, *, wanted: bool
) -> ClockDrift | None:
    """The clock that drifts, where it is looked for."""
    return drifting_clock(recording, signals, fit) if wanted else None


def _by_a_fit(
    quality: Quality,
    right: Recording,
    signals: Signals,
    tried: tuple[QuickFit, Rivals, bool],
    findings: list[Finding],
) -> Quality:
    """Findings beside those of the checks, where all signs are right.

    `tried` are the fit, its rivals and whether clocks run at a steady difference.
    """
    fit, tries, steady = tried
    if steady:
        quality, signals, fit, tries, apart = _in_step(quality, right, signals, fit, tries)
        findings = [*findings, *apart]
    said, false = _by_fit(quality, right, signals, fit, tries, steady=steady)
    true = tuple(finding for finding in quality.findings if finding not in false)
    return _together(replace(quality, findings=true), [*findings, *said])


def _in_step(
    quality: Quality, right: Recording, signals: Signals, fit: QuickFit, tries: Rivals
) -> tuple[Quality, Signals, QuickFit, Rivals, list[Finding]]:
    """An angle or torque that is out of step, put right, or why none can be told to be."""
    emg = None if tries.lag is None else tries.lag.how.fit
    lag = lagging_stream(right, signals, fit, emg)
    if lag is not None:
        signals = moved(signals, lag.seconds, 0.0, lag.stream)
        tries = rivals(right, signals, lag.after)
        return quality, signals, lag.after, tries, [lag_finding(lag, signals)]
    if reason := cannot_tell(right, signals, fit):
        unsaid = Skipped("angle-torque-lag", reason)
        quality = replace(quality, skipped=(*quality.skipped, unsaid))
    return quality, signals, fit, tries, []


def _by_fit(
    quality: Quality,
    right: Recording,
    signals: Signals,
    fit: QuickFit,
    tries: Rivals,
    *,
    steady: bool,
) -> tuple[list[Finding], list[Finding]]:
    """What a quick fit shows beyond the checks, and findings of theirs that it shows to be none.

    No lag of all electrodes is looked for where clocks do not run at a `steady` difference.
    """
    late = [f for f in quality.findings if f.code == "electrode-lag"]
    # a group without one of its muscles seems to change
    whole = not any(f.code == "emg-flat" and f.severity == "error" for f in quality.findings)
    findings = [
        _with_interval(each, right, signals, tries)
        for each in best_of(signals, tries, late=not late and steady, slow=whole)
    ]
    false = [lag for lag in late if not _explains(lag, right, signals, fit)]
    false += [f for f in quality.findings if f.code == "emg-torque-lag"]
    against = [f for f in quality.findings if f.code == "torque-sign"]
    false += against
    if fit.r2 < EXPLAINS:  # a claim where a turned sign is better for certain, else a doubt
        certain = any(evidence(each, tries.as_it_is) >= EVIDENCE for each in tries.turned)
        findings += [f if certain else replace(f, severity="warning") for f in against]
    constant = next((f for f in quality.findings if f.code == "torque-offset"), None)
    if constant is not None and fit.r2 >= GOOD_ENOUGH:
        # A fit's zero goes the way, and a part of it, that the torque's constant part says.
        beyond = (constant.value or 0.0) - sum(GRAVITY) / 2
        if not fit.zero * beyond >= _AGREED * beyond**2:
            return findings, [*false, constant]
    return [*findings, *zero(right, signals, tries)], false


def _with_interval(
    finding: Finding, recording: Recording, signals: Signals, tries: Rivals
) -> Finding:
    """A lag of all electrodes with its 95 % interval, where it can be told."""
    if finding.code != "emg-torque-lag" or tries.lag is None or tries.lag.how.fit is None:
        return finding
    there = moved(signals, tries.lag.seconds, 0.0)
    beyond = estimated_clock(recording, there, tries.lag.how.fit, hinted=False)
    if beyond is None:
        return finding
    ends = [1e3 * abs(tries.lag.seconds + edge) for edge in beyond.lag_ci95]
    says = Message("found/lag", says=finding.message, low=min(ends), high=max(ends))
    return replace(finding, message=says)


def _together(quality: Quality, findings: list[Finding], but: tuple[str, ...] = ()) -> Quality:
    """The findings of the checks, but for those of some codes, and others."""
    replaced = {*but, *(finding.code for finding in findings)}
    kept = [finding for finding in quality.findings if finding.code not in replaced]
    skipped = tuple(reason for reason in quality.skipped if reason.check not in replaced)
    return replace(quality, findings=ordered([*findings, *kept]), skipped=skipped)


def _explains(lag: Finding, recording: Recording, signals: Signals, first: QuickFit) -> bool:
    """Whether a fit is better without a lag."""
    if lag.value is None:
        return True
    muscles = MUSCLES if lag.channel is None else (lag.channel[4:],)
    in_time = quick_fit(recording, signals, later=dict.fromkeys(muscles, lag.value))
    return in_time is not None and in_time.unexplained <= (1.0 - _SHIFT_GAIN) * first.unexplained
