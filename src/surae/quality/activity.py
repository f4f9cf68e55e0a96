"""What the muscles do: at rest where they should be, active where they should be."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from surae.base.units import FloatArray
from surae.quality.electrodes import ONE_STRENGTH, RELAXED, SLOW
from surae.quality.finding import Finding, Severity, Unjudged, make_finding
from surae.quality.mains import line
from surae.quality.numeric import quantile, quantiles, runs, smooth, span_of
from surae.quality.reflex import Reflex, reflex
from surae.quality.trial import CheckedTrial
from surae.recording import MUSCLES

#: Activity as a multiple of its own level of rest that a relaxed muscle stays below.
ABOVE_REST = 4.0
#: Seconds of activity that make a passive part active.
ACTIVE_SECONDS = 0.25
#: Share of the requested bursts that may stay out.
MISSED = 0.3
#: Stillness after the first effort that is no pause: so long [s], and this share of what is left.
STILL_SECONDS = 5.0
STILL_SHARE = 0.3
#: What angle alone leaves of the torque [Nm] of a leg at rest: less than 2 in measured and virtual
#: passive trials.
PASSIVE_LEFT = 4.0
#: A muscle works above this part of its largest activity, other heads of the triceps go on above
#: that. A head that worked with them for this part of so many seconds, and then shows noise alone
#: for so many in which they work, has lost its electrode: of 960 virtual trials none comes to both.
_WORKS = 0.1
_GO_ON = 0.3
_WITH_THEM = 0.8
_BEFORE = 1.0
_AFTER = 3.0
#: Torque in the direction of a silent muscle [Nm] that EMG does not explain, and so many times that
#: before: no electrode that holds comes to both in them; one of the tibialis that is lost has 5 to
#: 20 Nm, and mostly 2 to 8 times as much.
_LEFT = 4.0
_MORE = 2.0
#: Both sides count as active above this part of their largest activity...
TOGETHER = 0.25
#: ...and so for more than this share of the time in which either is.
CO_CONTRACTION = 0.5


def passive_part(trial: CheckedTrial) -> Iterator[Finding]:
    """Activity in the time that was to be passive."""
    if trial.effort is None:
        raise Unjudged("No effort task is given or recognised: no time is known passive.")
    # Until the first requested effort, less the time a level is averaged over.
    requested = np.flatnonzero(trial.effort.max(axis=1) > 0.0)
    end = int(requested[0]) if requested.size else len(trial.time)
    quiet = np.arange(len(trial.time)) < end - round(0.3 * trial.rate_hz)
    if float(quiet.sum()) < 2.0 * trial.rate_hz:
        raise Unjudged("The task has no passive part.")
    stretched: Reflex | None = None
    for muscle, envelope in trial.slow.items():
        channel = trial.emg[muscle]
        top = trial.electrodes.levels[muscle].top
        rest = quantile(envelope[quiet], 0.1)
        active = quiet & (envelope > max(RELAXED * top, ABOVE_REST * rest))
        if muscle != "ta" and active.any():
            stretched = stretched or reflex(trial)
            if stretched is not None:
                active &= ~stretched.explained
        # The filter that the level was averaged with is not activity.
        seconds = float(active.sum()) / trial.rate_hz
        if seconds < ACTIVE_SECONDS or not trial.electrodes.works(muscle):
            continue
        where = np.flatnonzero(active)
        level = float(envelope[active].max())
        yield make_finding(
            "passive-not-passive",
            channel.role,
            span_of(trial.time, where),
            level / top,
            muscle=trial.names[muscle],
            seconds=seconds,
            percent=100 * level / top,
        )


def active_part(trial: CheckedTrial) -> Iterator[Finding]:
    """Muscles that are not active in the time that was to be active."""
    if not trial.slow:
        raise Unjudged("There is no EMG.")
    requested = None if trial.commanded is None else trial.commanded.effort
    if requested is not None and float(np.max(requested)) == 0.0:
        raise Unjudged("No effort was requested.")
    idle = {}
    for muscle, envelope in trial.slow.items():
        idle[muscle] = trial.electrodes.rests(muscle, quantile(envelope, 0.98))
    if all(idle.values()):
        left = 0.0 if trial.model is None else float(np.std(trial.model.unexplained))
        if left > PASSIVE_LEFT and trial.torque is not None:
            top = float(np.abs(trial.torque).max())
            yield _never(trial, "torque", None, tuple(idle), "error", top=top, left=left)
        else:
            yield _never(trial, "all", None, tuple(idle))
        return
    sides = {"triceps": trial.triceps, "ta": tuple(m for m in idle if m == "ta")}
    still = {name: side for name, side in sides.items() if side and all(map(idle.get, side))}
    for name, muscles in still.items():
        yield _never(trial, name, f"emg_{muscles[0]}", muscles)
    if not still:
        yield from [*_bursts(trial)] or _stopped(trial)


def _never(
    trial: CheckedTrial,
    which: str,
    role: str | None,
    muscles: tuple[str, ...],
    severity: Severity = "warning",
    **values: Any,
) -> Finding:
    most = max(quantile(trial.slow[m], 0.98) for m in muscles)
    return make_finding(
        f"active-not-active/{which}",
        role,
        trial.span,
        most,
        severity=severity,
        unit=trial.emg[muscles[0]].unit,
        joint=trial.joint,
        **values,
    )


def _bursts(trial: CheckedTrial) -> Iterator[Finding]:
    """Requested bursts that are missing."""
    if trial.effort is None:
        return
    missed: list[tuple[int, int]] = []
    total = 0
    for muscles in (trial.triceps, tuple(m for m in trial.slow if m == "ta")):
        if not muscles:
            continue
        requested = trial.effort[:, [MUSCLES.index(m) for m in muscles]].mean(axis=1)
        done = np.mean([_relative(trial.slow[m]) for m in muscles], axis=0)
        for first, last in runs(requested > 0.15):
            total += 1
            # Subjects follow what they see with a delay.
            later = slice(first, min(last + round(0.3 * trial.rate_hz), len(done)))
            if float(done[later].max()) < 0.25 * float(requested[first:last].max()):
                missed.append((first, last))
    if total == 0 or len(missed) <= MISSED * total:
        return
    begins, ends = zip(*missed, strict=True)
    yield make_finding(
        "active-not-active/bursts",
        None,
        (trial.time[min(begins)], trial.time[max(ends) - 1]),
        len(missed) / total,
        n=len(missed),
        all=total,
    )


def _stopped(trial: CheckedTrial) -> Iterator[Finding]:
    """A long time without any effort, once efforts have begun."""
    active = np.max([_relative(e) for e in trial.slow.values()], axis=0) > 0.1
    begun = int(np.argmax(active))
    still = runs(~active[begun:]) if active.any() else ()
    first, last = max(still, key=lambda stretch: stretch[1] - stretch[0], default=(0, 0))
    seconds = (last - first) / trial.rate_hz
    if seconds < STILL_SECONDS or last - first < STILL_SHARE * (len(active) - begun):
        return
    yield make_finding(
        "active-not-active/stopped",
        None,
        (trial.time[begun + first], trial.time[begun + last - 1]),
        seconds,
        unit="s",
        seconds=seconds,
    )


def silenced(trial: CheckedTrial) -> Iterator[Finding]:
    """Channels that fall silent for good, while heads beside them or the torque go on."""
    relative = {muscle: _relative(envelope) for muscle, envelope in trial.slow.items()}
    for muscle, level in relative.items():
        works = level > _WORKS
        channel = trial.emg[muscle]
        rate = trial.rate_hz
        end = len(level) - int(np.argmax(works[::-1])) + round(SLOW * rate)
        top = quantile(trial.slow[muscle], 0.98)
        if end > len(level) - _AFTER * rate or trial.electrodes.rests(muscle, top):
            continue
        low, high = quantiles(trial.slow[muscle][(end + len(level)) // 2 :], 0.05, 0.98)
        if high > ONE_STRENGTH * low or (trial.emg_kind == "raw" and high == 0.0):
            continue  # it lives, or is flat, which is another finding
        heads = [relative[m] for m in trial.triceps if muscle not in (m, "ta")]
        beside = np.max([np.zeros_like(level), *heads], axis=0) > _GO_ON
        with_them = works[:end][beside[:end]]
        after = beside[end:].sum() / rate
        lost = after >= _AFTER and len(with_them) >= _BEFORE * rate
        lost = lost and with_them.mean() >= _WITH_THEM
        if not lost and trial.model is not None:
            left = trial.model.unexplained * (-1.0 if muscle == "ta" else 1.0)
            since = trial.model.time > max(trial.time[end], trial.model.time[0])
            before, now = (quantile(left[at], 0.98) for at in (~since, since))
            lost = now > max(_LEFT, _MORE * before)
        if lost:
            yield make_finding(
                "electrode-off/silent",
                channel.role,
                (trial.time[end], trial.time[-1]),
                high,
                unit=channel.unit,
                muscle=trial.names[muscle],
                start=trial.time[end],
            )


def _relative(envelope: FloatArray) -> FloatArray:
    low, high = quantiles(envelope, 0.05, 0.98)
    return (envelope - low) / max(high - low, 1e-300)


def co_contraction(trial: CheckedTrial) -> Iterator[Finding]:
    """Both sides of the ankle active at the same time, nearly throughout."""
    triceps = trial.group("triceps", fast=True)
    ta = trial.group("ta", fast=True)
    if triceps is None or ta is None:
        raise Unjudged(f"There is no EMG of both sides of the {trial.joint.name}.")
    width = round((0.15 if trial.emg_kind == "raw" else 0.0) * trial.rate_hz)
    levels = [smooth(envelope, width) for envelope in (triceps, ta)]
    tops = [max(quantile(level, 0.98), 1e-300) for level in levels]
    above = [level > TOGETHER * top for level, top in zip(levels, tops, strict=True)]
    either = above[0] | above[1]
    both = above[0] & above[1]
    share = float(both.sum()) / max(float(either.sum()), 1.0)
    if share <= CO_CONTRACTION:
        return
    # The mean of a rectified sine is 2/π of its amplitude.
    hums = [np.mean([line(trial.emg[m])[0] for m in side]) for side in (trial.triceps, ("ta",))]
    if trial.emg_kind == "raw" and np.any(2 / np.pi * np.array(hums) > TOGETHER * np.array(tops)):
        raise Unjudged("Mains hum covers what the muscles do.")
    known = trial.electrodes
    rests = {m: known.rests(m, quantile(e, 0.98)) for m, e in trial.slow.items()}
    if rests["ta"] or all(rests[m] for m in trial.triceps):
        return  # nothing stands out of one side
    where = np.flatnonzero(both)
    yield make_finding(
        "co-contraction",
        "emg_ta",
        span_of(trial.time, where),
        share,
        joint=trial.joint,
        percent=100 * share,
    )
