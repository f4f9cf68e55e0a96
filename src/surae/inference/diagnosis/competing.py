"""Signs, electrodes, time, gain and zero that may be wrong, in one comparison: the best is named.

A turned angle, exchanged electrodes, EMG that is late, a torque that drifts or whose zero is off
all make a model explain less. Each is tried with the same quick fit. What explains most is what is
said, with the next best beside it, and it is an error where the evidence for it, by as many samples
as the residual is worth, leaves no doubt. What a unit of the EMG does no fit can tell: weights take
any.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from surae.base.words import Message
from surae.inference.diagnosis.explanations import (
    EVIDENCE,
    EXPLAINS,
    SIGNS,
    Explanation,
    compared,
    evidence,
    joined,
    possible,
    swapped,
    tried,
)
from surae.inference.diagnosis.quick import QuickFit, percent, quick_fit
from surae.quality import Finding
from surae.quality.finding import make_finding, worded_finding
from surae.quality.lag import LEADS, lead_of_onsets
from surae.quality.numeric import span_of
from surae.quality.trial import Signals
from surae.recording import MUSCLES, Recording

#: R² from which on no other signs are tried.
_GOOD = 0.995
#: R² of a fit whose lag or zero is worth a word.
GOOD_ENOUGH = 0.9
#: By how much muscles and tendons follow their EMG at most and at least, beyond the filter of
#: activation [s]: 30 ± 30 ms of delay, what a tendon takes, and less behind a slow low-pass. Of 20
#: virtual legs whose torque follows late by 40 ms, or not, a quick fit puts all at 17 to 85 ms.
_FOLLOWS = (0.12, 0.0)
#: Steps in which the EMG is shifted beyond that, and how far at most [s]; at the farthest there is
#: no best lag.
_SHIFT = 0.06
_FARTHEST = 0.6
#: What a fit with the EMG shifted must leave less, so many times, than with what muscles do.
_OUT_OF_STEP = 1.1
#: And the part of the torque's changes that it must explain beyond: in five measured trials of a
#: dynamometer 60 to 120 ms explain up to 0.002, in three virtual legs 150 ms 0.007 to 0.011.
_VISIBLE = 0.005
#: Drift of a torque that is claimed [Nm], and the part of what a fit leaves that it then explains.
#: Of 48 virtual legs of another generator and 21 measured trials none has both; of 48 drifts by
#: 8 Nm, 46 do (the legs on which it was set).
_DRIFT = (3.8, 40.0)
_DRIFT_SHARE = 0.21
#: The same of what EMG shows for the same torque: a change by a third is 0.43. Right legs have less
#: than 0.26 of a group, and 0.42 of all together where force is no multiple of EMG (family b).
_GAIN = (0.28, 1.6)
_GAIN_SHARE = {"emg_ta": 0.3, "emg_triceps": 0.3, "emg": 0.46}
#: A zero that is worth a word [Nm], in a fit that leaves so much less by it.
_ZERO = 8.0
_ZERO_GAIN = 1.3


@dataclass(frozen=True, slots=True)
class Lag:
    """EMG shifted to where it explains the torque best."""

    seconds: float  #: By how much it is late; negative where it is earlier than muscles make it.
    how: Explanation
    beside: Explanation  #: The latest, or earliest, that muscles make it.
    agrees: bool | None  #: Whether onsets say so too; None where they say nothing.


@dataclass(frozen=True, slots=True)
class Rivals:
    """What was tried of a recording."""

    as_it_is: Explanation
    signs: tuple[Explanation, ...]  #: Turned signs and exchanged electrodes, each alone.
    lag: Lag | None  #: None where no lag is better than what muscles make.
    slow: tuple[Explanation, ...]  #: A drift of the torque and of electrodes, to first order.

    @property
    def turned(self) -> list[Explanation]:
        """Those of which just one sign is turned."""
        return [each for each in self.signs if len(each.right.sign) == 1]

    @property
    def others(self) -> list[Explanation]:
        """All but the recording as it is."""
        return [*self.signs, *([] if self.lag is None else [self.lag.how]), *self.slow]


def rivals(recording: Recording, signals: Signals, first: QuickFit) -> Rivals:
    """Try what a recording may be, beside what the first fit makes of it as it is."""
    as_it_is = Explanation("", departures=0, fit=first)
    tries: list[Explanation] = []
    if first.r2 < _GOOD:
        others = [*SIGNS]
        if "ta" in signals.fast:
            others += [swapped("ta", muscle) for muscle in MUSCLES[1:] if muscle in signals.fast]
        tries = [tried(recording, signals, each) for each in others]
    slow = [
        Explanation(
            Message("read/drift", size=size) if name == "torque" else Message("read/gain"),
            fit=replace(first, r2=1.0 - (1.0 - share) * (1.0 - first.r2)),
        )
        for name, (size, share) in first.slow.items()
    ]
    return Rivals(as_it_is, tuple(tries), _lag(recording, signals, as_it_is), tuple(slow))


def signs(recording: Recording, signals: Signals, tries: Rivals) -> tuple[list[Finding], Recording]:
    """What is turned or swapped, nothing where it is right, and the recording with that right."""
    as_it_is = tries.as_it_is
    first = as_it_is.fit
    good = possible([as_it_is, *tries.others])
    assert first is not None
    relaxed = "emg" not in first.slow  # tissue alone also pulls so with both signs turned
    if not good or as_it_is in good or (relaxed and first.r2 >= EXPLAINS):
        return [], recording
    best = good[0]
    if best not in tries.signs or evidence(best, as_it_is) < EVIDENCE:
        return [], recording
    span = span_of(signals.time)
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
        numbers = compared(best, as_it_is, [each for each in tries.others if each is not best])
        text = Message("found/signs", what=best.words, numbers=numbers)
        advice = best.right.lines(recording)
        recording = best.right(recording)
    texts = zip(codes.items(), (text, Message("found/torque-sign/too")), strict=False)
    return [
        worded_finding(code, role, span, best.r2, message, advice)
        for (role, code), message in texts
    ], recording


def best_of(signals: Signals, tries: Rivals, *, late: bool, slow: bool) -> Iterator[Finding]:
    """Of EMG out of step, a torque that drifts and EMG that fades, what explains most.

    `late` and `slow` say whether a lag and a drift are looked for.
    """
    lag = tries.lag if late else None
    changes = tuple(_slow(signals, tries.as_it_is.fit)) if slow else ()
    drifts = max((each.r2 for each in tries.slow), default=0.0) if changes else -1.0
    if lag is None or drifts > lag.how.r2:
        yield from changes
        return
    others = [each for each in tries.others if each is not lag.how]
    certain = bool(lag.agrees) and evidence(lag.how, lag.beside) >= EVIDENCE
    yield make_finding(
        f"emg-torque-lag/{'follows' if lag.seconds < 0.0 else 'fitted'}",
        None,
        span_of(signals.time),
        lag.seconds,
        severity="error" if certain else "warning",
        ms=1e3 * abs(lag.seconds),
        numbers=compared(lag.how, tries.as_it_is, others),
    )


def zero(recording: Recording, signals: Signals, tries: Rivals) -> Iterator[Finding]:
    """A torque whose zero is off by more than a foot can weigh, where nothing else is as good.

    Every fit here has a zero; what competes with it is tried anew without one.
    """
    fit = tries.as_it_is.fit
    assert fit is not None
    if recording.fixed.get("m") == 0.0 or abs(fit.zero) < _ZERO or fit.r2 < GOOD_ENOUGH:
        return
    without = quick_fit(recording, signals, zero=False, near=fit)
    if without is None or without.unexplained < _ZERO_GAIN * fit.unexplained:
        return
    others = [tried(recording, signals, how, zero=False) for how in tries.signs or SIGNS]
    if tries.lag is not None:
        later = dict.fromkeys(MUSCLES, tries.lag.seconds)
        late = quick_fit(recording, signals, later=later, zero=False, near=fit)
        others.append(replace(tries.lag.how, fit=late))
    if max(each.r2 for each in others) >= fit.r2:
        return
    numbers = compared(tries.as_it_is, Explanation("", fit=without), others)
    span = span_of(signals.time)
    yield make_finding(
        "torque-offset/fitted", "torque", span, fit.zero, level=fit.zero, numbers=numbers
    )


def _lag(recording: Recording, signals: Signals, as_it_is: Explanation) -> Lag | None:
    """EMG that is late for the torque, or earlier than muscles make it; None where it is neither.

    It must lead, or follow, the torque's changes as well where these say anything.
    """
    first = as_it_is.fit
    assert first is not None
    if not signals.fast:
        return None

    def shifted(lag: float, near: QuickFit) -> QuickFit:
        later = dict.fromkeys(MUSCLES, lag)
        return quick_fit(recording, signals, later=later, near=near) or first

    early, late = _FOLLOWS
    for way, edge in ((1.0, -late), (-1.0, -early)):
        beside = shifted(edge, first) if edge else first
        lag = edge
        best = beside
        step = way * _SHIFT
        while (
            abs(lag) < _FARTHEST
            and (next_ := shifted(lag + step, best)).unexplained < best.unexplained
        ):
            lag = lag + step
            best = next_
        clearly = (
            best.unexplained * _OUT_OF_STEP < beside.unexplained and best.r2 - first.r2 >= _VISIBLE
        )
        if not clearly or best.r2 < GOOD_ENOUGH or abs(lag) > _FARTHEST - 0.5 * _SHIFT:
            continue
        lead = lead_of_onsets(signals)
        agrees = None if lead is None else lead < LEADS[0] if lag > 0.0 else lead > LEADS[1]
        if agrees is not False:
            words = Message("read/late" if lag > 0.0 else "read/early", ms=1e3 * abs(lag))
            how, near = Explanation(words, fit=best), Explanation("", fit=beside)
            return Lag(lag, how, near, agrees)
    return None


def _slow(signals: Signals, fit: QuickFit | None) -> Iterator[Finding]:
    """A torque that drifts, and EMG of which the same shows ever more or less torque."""
    if fit is None or fit.r2 < EXPLAINS:
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
