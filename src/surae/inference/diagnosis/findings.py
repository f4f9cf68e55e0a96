"""Findings of the checks and of quick fits together: a sign, a zero or a lag is tried by a fit."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from surae.base.words import Message
from surae.inference.diagnosis.angle import wrong_angle
from surae.inference.diagnosis.explanations import (
    EXPLAINS,
    Explanation,
    compared,
    joined,
    possible,
    swapped,
    tried,
    turned,
)
from surae.inference.diagnosis.quick import QuickFit, percent, quick_fit
from surae.inference.diagnosis.units import wrong_units
from surae.quality import Commanded, Finding, Quality, check_recording
from surae.quality.electrodes import Electrodes
from surae.quality.finding import make_finding
from surae.quality.numeric import quantiles, span_of
from surae.quality.position import perturbing
from surae.quality.registry import ordered, unfit
from surae.quality.torque import GRAVITY
from surae.quality.trial import Signals, signals_of
from surae.quality.used import used
from surae.recording import MUSCLES, Recording

#: R² from which on nothing else is tried.
_GOOD = 0.995
#: Part of what a fit leaves that shifting the EMG must take away before a lag is claimed.
_SHIFT_GAIN = 0.03
#: By how much muscles and tendons follow their EMG at most and at least, beyond the filter of
#: activation [s]: 30 ± 30 ms of delay, what a tendon takes, and less behind a slow low-pass. Of 20
#: virtual legs whose torque follows late by 40 ms, or not, a quick fit puts all at 17 to 85 ms.
_FOLLOWS = (0.12, 0.0)
#: Steps in which the EMG is shifted beyond that, and how far at most [s].
_SHIFT = 0.06
_FARTHEST = 0.6
#: What a fit with the EMG shifted must leave less, so many times, than with what muscles do.
_OUT_OF_STEP = 1.1
#: And the part of the torque's changes that it must explain beyond: in five measured trials of a
#: dynamometer 60 to 120 ms explain up to 0.002, in three virtual legs 150 ms 0.007 to 0.011.
_VISIBLE = 0.005
#: An angle that keeps within this [rad] for all but a hundredth of the time is held still.
STILL = 0.03
#: A zero that is worth a word [Nm], in a fit that explains so much and leaves so much less by it.
_ZERO = 8.0
_GOOD_ENOUGH = 0.9
_ZERO_GAIN = 1.3
#: Drift of a torque that is claimed [Nm], and the part of what a fit leaves that it then explains.
#: Of 48 virtual legs of another generator and 21 measured trials none has both; of 48 drifts by
#: 8 Nm, 46 do (the legs on which it was set).
_DRIFT = (3.8, 40.0)
_DRIFT_SHARE = 0.21
#: The same of what EMG shows for the same torque: a change by a third is 0.43. Right legs have less
#: than 0.26 of a group, and 0.42 of all together where force is no multiple of EMG (family b).
_GAIN = (0.28, 1.6)
_GAIN_SHARE = {"emg_ta": 0.3, "emg_triceps": 0.3, "emg": 0.46}
#: Part of a zero seen in the torque's constant part that a fit must find too.
_AGREED = 0.25


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
    of the leg show of theirs; without them the trial is judged against itself.
    """
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
    told = signals.torque is not None and not perturbing(signals.angle, signals.rate_hz)
    if not told or (fit := quick_fit(right, signals)) is None:
        return _together(quality, findings)
    wrong, with_signs = _signs(right, signals, fit)
    if wrong:
        if with_signs is not right:
            quality = check_recording(with_signs, commanded, electrodes=electrodes)
        return _together(quality, [*findings, *wrong], but=("torque-sign",))
    if ("emg-flat", "error") not in {(f.code, f.severity) for f in quality.findings}:
        findings += _slow(signals, fit)  # a group without one of its muscles seems to change
    late = [f for f in quality.findings if f.code == "electrode-lag"]
    false = [lag for lag in late if not _explains(lag, right, signals, fit)]
    false += [f for f in quality.findings if f.code == "emg-torque-lag"]
    if not late and fit.r2 >= _GOOD_ENOUGH:
        findings += _out_of_step(right, signals, fit)
    if fit.r2 >= EXPLAINS:  # and no other signs explain clearly more
        false += [f for f in quality.findings if f.code == "torque-sign"]
    constant = next((f for f in quality.findings if f.code == "torque-offset"), None)
    if constant is None:
        findings += _zero(right, signals, fit)
    elif fit.r2 >= _GOOD_ENOUGH:
        # A fit's zero goes the way, and a part of it, that the torque's constant part says.
        beyond = (constant.value or 0.0) - sum(GRAVITY) / 2
        if not fit.zero * beyond >= _AGREED * beyond**2:
            false.append(constant)
    true = tuple(finding for finding in quality.findings if finding not in false)
    return _together(replace(quality, findings=true), findings)


def _together(quality: Quality, findings: list[Finding], but: tuple[str, ...] = ()) -> Quality:
    """The findings of the checks, but for those of some codes, and others."""
    own = {*but, *(finding.code for finding in findings)}
    kept = [finding for finding in quality.findings if finding.code not in own]
    skipped = tuple(reason for reason in quality.skipped if reason.check not in own)
    return replace(quality, findings=ordered([*findings, *kept]), skipped=skipped)


def _signs(
    recording: Recording, signals: Signals, first: QuickFit
) -> tuple[list[Finding], Recording]:
    """What is turned or swapped, nothing where it is right, and the recording with that right."""
    if first.r2 >= _GOOD:
        return [], recording
    as_it_is = Explanation("", departures=0, fit=first)
    others = [turned(-1.0, 1.0), turned(1.0, -1.0), turned(-1.0, -1.0)]
    if "ta" in signals.fast:
        others += [swapped("ta", muscle) for muscle in MUSCLES[1:] if muscle in signals.fast]
    tries = [tried(recording, signals, each) for each in others]
    good = possible([as_it_is, *tries])
    relaxed = "emg" not in first.slow  # tissue alone also pulls so with both signs turned
    if not good or as_it_is in good or (relaxed and first.r2 >= EXPLAINS):
        return [], recording
    span = span_of(signals.time)
    best = good[0]
    codes = {role: f"{role}-sign" for role in best.right.sign} or {"emg_ta": "electrodes-swapped"}
    if len(good) > 1:
        text = Message(
            "found/signs/several",
            what=joined(*(each.words for each in good), by="or"),
            before=percent(first.r2),
            after=percent(best.r2),
        )
        advice = Message("advice/signs")
    else:
        numbers = compared(best, as_it_is, [each for each in tries if each is not best])
        text = Message("found/signs", what=best.words, numbers=numbers)
        advice = best.right.lines(recording)
        recording = best.right(recording)
    texts = zip(codes.items(), (text, Message("found/torque-sign/too")), strict=False)
    return [
        make_finding(code, role, span, best.r2, says=message, advice=advice)
        for (role, code), message in texts
    ], recording


def _slow(signals: Signals, fit: QuickFit) -> Iterator[Finding]:
    """A torque that drifts, and EMG of which the same shows ever more or less torque."""
    if fit.r2 < EXPLAINS:
        return
    span = span_of(signals.time)
    size, share = fit.slow.get("torque", (0.0, 0.0))
    if share >= _DRIFT_SHARE and _DRIFT[0] <= abs(size) <= _DRIFT[1]:
        yield make_finding("torque-drift", "torque", span, size, size=size, percent=100 * share)
        return
    grown = {name: fit.slow[name] for name in _GAIN_SHARE if name in fit.slow}
    group = max(grown, key=lambda name: grown[name][1] / _GAIN_SHARE[name], default="")
    size, share = grown.get(group, (0.0, 0.0))
    if share >= _GAIN_SHARE.get(group, 2.0) and _GAIN[0] <= abs(size) <= _GAIN[1]:
        which = {"emg": "all", "emg_triceps": "triceps", "emg_ta": "ta"}[group]
        after = (1.0 - size / 2.0) / (1.0 + size / 2.0)
        yield make_finding(
            f"emg-gain/{which}",
            None if group != "emg_ta" else group,
            span,
            after,
            percent=100 * after,
            part=100 * share,
        )


def _out_of_step(recording: Recording, signals: Signals, fit: QuickFit) -> Iterator[Finding]:
    """EMG that is late for the torque, or earlier than muscles make it."""

    def shifted(lag: float, near: QuickFit) -> QuickFit:
        later = dict.fromkeys(MUSCLES, lag)
        return quick_fit(recording, signals, later=later, near=near) or fit

    early, late = _FOLLOWS
    for way, edge in ((1.0, -late), (-1.0, -early)):
        beside = shifted(edge, fit) if edge else fit
        lag = edge
        best = beside
        step = way * _SHIFT
        while abs(lag) < _FARTHEST and (next_ := shifted(lag + step, best)).left < best.left:
            lag = lag + step
            best = next_
        if best.left * _OUT_OF_STEP < beside.left and best.r2 - fit.r2 >= _VISIBLE:
            yield make_finding(
                f"emg-torque-lag/{'follows' if way < 0.0 else 'fitted'}",
                None,
                span_of(signals.time),
                lag,
                ms=1e3 * abs(lag),
                before=percent(fit.r2),
                after=percent(best.r2),
            )
            return


def _zero(recording: Recording, signals: Signals, fit: QuickFit) -> Iterator[Finding]:
    """A torque whose zero is off by more than a foot can weigh."""
    if recording.fixed.get("m") == 0.0 or abs(fit.zero) < _ZERO or fit.r2 < _GOOD_ENOUGH:
        return
    without = quick_fit(recording, signals, zero=False, near=fit)
    if without is not None and without.left >= _ZERO_GAIN * fit.left:
        yield make_finding(
            "torque-offset/fitted",
            "torque",
            span_of(signals.time),
            fit.zero,
            level=fit.zero,
            before=percent(without.r2),
            after=percent(fit.r2),
        )


def _explains(lag: Finding, recording: Recording, signals: Signals, first: QuickFit) -> bool:
    """Whether a fit is better without a lag."""
    if lag.value is None:
        return True
    muscles = MUSCLES if lag.channel is None else (lag.channel[4:],)
    in_time = quick_fit(recording, signals, later=dict.fromkeys(muscles, lag.value))
    return in_time is not None and in_time.left <= (1.0 - _SHIFT_GAIN) * first.left
