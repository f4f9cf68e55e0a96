"""The answer of `surae.stretches`: every stretch, thresholds, and what repeats differ by."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import log_ndtr, stdtrit

from surae.base.frozen import FrozenDict
from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.inference.judging.verdict import THRESHOLD, Verdict, verdict_of
from surae.nerve.parts import FAST, LATE, NOT_YET, Parts, TissueTorque
from surae.nerve.ramps import RampSpan, Stretched, low, onset, stretched
from surae.nerve.reflex_claim import DIRECTIONS
from surae.nerve.stretch_records import COMPARED, StretchAnswer, Stretches, StretchThreshold
from surae.recording import Recording

#: Muscles that a movement in each direction stretches.
OPPOSED = {1: ("gl", "sol", "gm"), -1: ("ta",)}
#: Repeats whose speeds differ by less are repeats of one stretch [part].
ALIKE = 0.15
#: Rise of torque at rest, as a multiple of the largest at other rests and as a part of the
#: stretch's torque, from which one without EMG is probably neural.
RISES = 2.0
LEAST_PART = 0.05
#: Onsets of a threshold. None is identified (`verdict.THRESHOLD`): of fresh legs 76 of 88 narrow
#: ones held (counts.md), since a line over velocity is assumed.
LEAST_ONSETS = 4
#: Stretches with EMG that goes on for too long after the stop, from which all may have such.
WILLING = 2
#: Least spread of velocities at onset [rad/s], and error of one onset's angle in all of them [deg].
SPREAD = 0.3
ONSET_ERROR = 0.5
#: Times [s] by which a muscle is called up before its EMG is seen: none, as is published, and the
#: latency of the calf's reflex (Sinkjaer 1996: 40 ms at most).
LATENCIES = (0.0, 0.02, 0.04)


def answers(recordings: Sequence[Recording]) -> Stretches:
    """Everything that the stretches of a leg say."""
    every = [stretched(recording) for recording in recordings]
    largest = {
        m: max(float(np.quantile(of.emg[m], 0.9995)) for of in every if m in of.emg)
        for m in {m for of in every for m in of.emg}
    }
    ramps = [(i, ramp) for i, of in enumerate(every) for ramp in of.ramps]
    onsets = [
        {m: onset(every[i], r, m, largest[m]) for m in OPPOSED[r.direction] if m in every[i].emg}
        for i, r in ramps
    ]
    speeds = [_speed(every[i], ramp) for i, ramp in ramps]
    quiet = [
        np.ones(len(of.time), bool) if of.unusable is None else ~np.asarray(of.unusable, bool)
        for of in every
    ]
    seen = [bool(onset_of) for onset_of in onsets]
    slow = []
    for (i, ramp), onset_of, speed in zip(ramps, onsets, speeds, strict=True):
        rate = every[i].rate
        alike = zip(speeds, ramps, strict=True)
        slowest = min(s for s, (_, r) in alike if r.direction == ramp.direction)
        slow.append(speed <= FAST * slowest)
        if not onset_of and not slow[-1] and ramp.direction > 0:
            begin = min(ramp.begin + round(NOT_YET * rate), ramp.stop)
            quiet[i][begin : ramp.stop + round(LATE * rate)] = False
    group = _of_one_speed([ramp.direction for _, ramp in ramps], speeds)
    labels = [np.zeros(len(of.time), int) for of in every]
    for (i, ramp), number in zip(ramps, group, strict=True):
        labels[i][ramp.begin if labels[i].any() else 0 :] = number + 1
    tissue = TissueTorque(every, quiet, labels)
    parts = [tissue.parts(i, ramp) for i, ramp in ramps]
    late = [emg and p.sustained > 1.96 * p.error for emg, p in zip(seen, parts, strict=True)]
    willing = sum(late) >= WILLING
    usual = max(max(p.rest, p.rise if s else 0.0) for p, s in zip(parts, slow, strict=True))
    stretches = tuple(
        _stretch(
            every[i],
            ramp,
            onset_of,
            speed,
            number,
            emg,
            number.rise > RISES * usual,
            will or willing,
        )
        for (i, ramp), onset_of, speed, number, emg, will in zip(
            ramps, onsets, speeds, parts, seen, late, strict=True
        )
    )
    if willing:
        note = Message(N_("EMG goes on after the stop: onsets may be by will"))
        by_will = StretchThreshold(None, None, Verdict.UNDETERMINED, note)
        thresholds = dict.fromkeys(sorted(largest), by_will)
    else:
        thresholds = {m: _threshold(m, every, ramps, onsets, group) for m in sorted(largest)}
    notes = tuple(f"{of.name}: {note}" for of in every for note in of.notes)
    return Stretches(stretches, FrozenDict(thresholds), FrozenDict(_changes(stretches)), notes)


def _of_one_speed(directions: Sequence[Any], speeds: Sequence[float]) -> list[int]:
    """Numbers of groups of stretches that are repeats of one, by direction and speed."""
    numbers = [0] * len(speeds)
    first = -1
    last = -1
    for k in sorted(range(len(speeds)), key=lambda k: (directions[k], speeds[k])):
        same = first >= 0 and directions[k] == directions[first]
        if not same or speeds[k] >= (1.0 + ALIKE) * speeds[first]:
            first = k
            last = last + 1
        numbers[k] = last
    return numbers


def _speed(of: Stretched, ramp: RampSpan) -> float:
    """Speed of the middle of a stretch [rad/s]."""
    third = (ramp.stop - ramp.begin) // 4
    return float(abs(np.median(of.velocity[ramp.begin + third : ramp.stop - third + 1])))


def _stretch(
    of: Stretched,
    ramp: RampSpan,
    onset_of: Mapping[str, int | None],
    speed: float,
    parts: Parts,
    emg: bool,
    rises: bool,
    by_will: bool,
) -> StretchAnswer:
    rate = of.rate
    torque = ramp.direction * low(of.torque, rate, 40.0)
    before = float(np.mean(torque[max(ramp.begin - round(0.1 * rate), 0) : ramp.begin + 1]))
    after = torque[ramp.begin : ramp.stop + round(0.1 * rate)]
    whole = float(after.max()) - before
    first = [at for at in onset_of.values() if at is not None]
    neural: float | None = max(parts.neural, 0.0)
    half = 1.96 * parts.error
    if emg and not first:
        neural = 0.0
        note = N_("no EMG answers")
        ci: tuple[float, float] | None = (0.0, max(half, parts.neural))
    elif emg and by_will and parts.neural - parts.early > half:
        neural = None
        note = N_("late: may be by will")
        ci = (max(parts.early - half, 0.0), parts.neural + half)
    elif emg:
        note = N_("with EMG")
        ci = (max(parts.neural - half, 0.0), parts.neural + half)
    elif rises and parts.rise > LEAST_PART * whole:
        note = N_("probably neural: torque rises when the foot has stopped, no EMG")
        neural = max(parts.neural, parts.rise)
        ci = (0.5 * parts.rise, max(whole, neural + half))
    else:
        neural = None
        note = N_("cannot tell without EMG")
        ci = (0.0, whole)
    degrees = np.rad2deg(of.angle)
    catch = None
    if neural and ci and ci[0] > 0.0:
        power = low(torque * ramp.direction * of.velocity, rate, 20.0)
        peak = ramp.begin + int(np.argmax(power[ramp.begin : ramp.stop + 1]))
        drop = -np.gradient(power[peak : ramp.stop + 2])
        catch = float(degrees[peak + int(np.argmax(drop))]) if len(drop) > 2 else None
    return StretchAnswer(
        of.name,
        float(of.time[ramp.begin]),
        DIRECTIONS[ramp.direction],  # type: ignore[arg-type]
        float(np.rad2deg(speed)),
        float(degrees[ramp.begin]),
        float(degrees[ramp.stop]),
        whole,
        parts.elastic,
        parts.viscous,
        parts.inertial,
        neural,
        ci,
        note,
        FrozenDict({m: None if at is None else float(degrees[at]) for m, at in onset_of.items()}),
        catch,
    )


def _threshold(
    muscle: str,
    every: Sequence[Stretched],
    ramps: Sequence[tuple[int, RampSpan]],
    onsets: Sequence[Mapping[str, int | None]],
    group: Sequence[int],
) -> StretchThreshold:
    """Angle of onset over velocity, at no velocity; without an onset it lies beyond the end.

    To leave stretches out that are not answered would draw the line down: slow ones are answered
    where the threshold happens to lie low. They are censored (Tobin 1958). The muscle was called
    up before its EMG is seen, by its nerve's latency and by what a detector takes: a line through
    what the foot did then has its say in the interval. So has what lines differ by from which
    one speed is left out (a jackknife over speeds): it shows where no line is true.
    """
    seen: list[tuple[Stretched, int]] = []
    ended = []
    of_seen = []
    of_ended = []
    for (i, ramp), onset_of, number in zip(ramps, onsets, group, strict=True):
        of = every[i]
        at = onset_of.get(muscle)
        if at is not None:
            seen.append((of, at))
            of_seen.append(number)
        elif muscle in onset_of:
            ended.append((ramp.direction * _speed(of, ramp), of.angle[ramp.stop]))
            of_ended.append(number)
    ends = np.array(ended).reshape(-1, 2)
    sign = -1 if muscle == "ta" else 1
    n = len(seen)
    lines = []
    for late in LATENCIES:
        then = [(of, max(at - round(late * of.rate), 0)) for of, at in seen]
        points = np.array([(of.velocity[at], of.angle[at]) for of, at in then])
        if n < LEAST_ONSETS or np.ptp(points[:, 0]) < SPREAD:
            note = Message(N_("onsets: {n}, at too few speeds; repeat fast stretches"), n=str(n))
            return StretchThreshold(None, None, Verdict.UNDETERMINED, note)
        lines.append(_line(points, ends, sign))
        if late == LATENCIES[0]:
            apart = _apart(points, ends, sign, np.array(of_seen), np.array(of_ended, int))
    angle = lines[0][0]
    halves = [float(np.hypot(half, apart)) for _, half in lines]
    low = min(a - h for (a, _), h in zip(lines, halves, strict=True))
    high = max(a + h for (a, _), h in zip(lines, halves, strict=True))
    verdict = verdict_of(angle, 0.5 * (high - low), THRESHOLD)
    note = Message(
        N_("onsets: {n}; stretches without: {m}; a line over velocity is assumed"),
        n=str(n),
        m=str(len(ended)),
    )
    return StretchThreshold(angle, (low, high), verdict, note)


def _apart(
    seen: FloatArray, ended: FloatArray, sign: int, of_seen: np.ndarray, of_ended: np.ndarray
) -> float:
    """Half of an interval of the angle at no velocity [deg], by a jackknife over speeds."""
    without = []
    for stretch in np.unique(of_seen):
        points = seen[of_seen != stretch]
        if len(points) >= LEAST_ONSETS and np.ptp(points[:, 0]) >= SPREAD:
            without.append(_line(points, ended[of_ended != stretch], sign)[0])
    n = len(without)
    if n < 2:
        return 0.0
    return float(stdtrit(n - 1, 0.975) * np.sqrt((n - 1.0) * np.var(without)))


def _line(seen: FloatArray, ended: FloatArray, sign: int) -> tuple[float, float]:
    """Angle at no velocity [deg], and half of its interval, of (velocity, angle) [rad/s, rad]."""
    (v, angle) = np.rad2deg(seen).T
    end = np.rad2deg(ended).T
    n = len(seen)

    def loss(q: FloatArray) -> float:
        sd = np.exp(q[2])
        left = (angle - q[0] - 0.01 * q[1] * v) / sd
        beyond = sign * (end[1] - q[0] - 0.01 * q[1] * end[0]) / sd
        return float(0.5 * left @ left + n * q[2] - np.sum(log_ndtr(-beyond)))

    line = np.polynomial.polynomial.polyfit(v, angle, 1)
    first = np.array([line[0], 100.0 * line[1], np.log(max(np.std(angle), 0.5))])
    solution = minimize(loss, first, method="BFGS")
    sd = float(np.hypot(np.sqrt(solution.hess_inv[0, 0]), ONSET_ERROR))
    return float(solution.x[0]), float(stdtrit(max(n - 2, 1), 0.975)) * sd


def _changes(stretches: Sequence[StretchAnswer]) -> dict[str, float | None]:
    """1.96·√2 times the standard deviation of repeats, pooled over speeds of each direction."""
    number = _of_one_speed([s.direction for s in stretches], [s.speed_deg_s for s in stretches])
    groups = [[s for s, n in zip(stretches, number, strict=True) if n == g] for g in set(number)]
    changes: dict[str, float | None] = {}
    for name in COMPARED:
        squares = 0.0
        freedom = 0
        for group in groups:
            values = np.array([v for s in group if (v := getattr(s, name)) is not None])
            if len(values) > 1:
                squares += float(np.sum((values - values.mean()) ** 2))
                freedom += len(values) - 1
        changes[name] = float(1.96 * np.sqrt(2.0 * squares / freedom)) if freedom else None
    return changes
