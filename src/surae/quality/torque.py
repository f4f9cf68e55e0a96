"""The torque sensor: limit, sign, offset."""

import math
from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from surae.base.units import FloatArray
from surae.protocol import DEVICES
from surae.quality.baseline import baseline
from surae.quality.finding import Finding, Unjudged, make_finding
from surae.quality.numeric import (
    IndexArray,
    correlation,
    digit_of,
    equal_runs,
    held_for,
    quantile,
    span_of,
)
from surae.quality.torque_model import passive_columns
from surae.quality.trial import CheckedTrial

#: Samples in a row exactly at the largest torque that make a plateau, and how many there are in
#: all: a measured or simulated torque repeats no number.
PLATEAU_RUN = 3
PLATEAU = 6
#: What is at its largest for more than this part of a trial rests there.
_RESTS = 0.5
#: A plateau behind a noisy sensor: this part of the limit above and below it...
_BAND = 0.005
#: ...holds so many times the samples of the band next below. The top of a smooth peak has 2.4.
_EXCESS = 3.0
#: Passive torque whose correlation with the stretch of the triceps is below minus this.
_AGAINST = -0.6
#: m·g·la of foot and footplate is 1.8 to 4.4 Nm (1.2 to 3 kg at 0.15 m)...
GRAVITY = (1.8, 4.4)
#: ...and what the two exponentials cannot follow (relaxation, knee) adds up to 3 Nm either way in
#: virtual trials.
UNCERTAIN = 3.5
#: A deviation must be so many times what the fit leaves of the torque.
FOLLOWED = 2.0
#: No ankle makes more [Nm]: sprinters reach 250 to 300.
IMPOSSIBLE = 320.0
#: What EMG and angle leave of the torque [Nm], and as a multiple of what they usually leave, for it
#: to be an artefact; clean virtual trials reach one or the other, not both. Seen for less than this
#: part of the time.
UNEXPLAINED = 24.0
UNEXPLAINED_TIMES = 6.5
UNEXPLAINED_SHARE = 0.05


def limit(trial: CheckedTrial) -> Iterator[Finding]:
    """A torque that stops at a limit: the device's, or its sensor's."""
    channel = trial.recording.channels.get("torque")
    if channel is None:
        raise Unjudged("There is no torque.")
    stated = trial.recording.device.get("max_torque")
    known = DEVICES["achilles"].max_torque or math.inf
    most = float(stated) if isinstance(stated, int | float) and stated > 0 else known
    for side in (channel.values, -channel.values):
        where = _stopped(side, most, stated=isinstance(stated, int | float))
        if where is None:
            continue
        top = float(side.max())
        device = abs(top - most) <= 4.0 * _BAND * most
        yield make_finding(
            "torque-limit/known" if device else "torque-limit",
            "torque",
            span_of(channel.time, where),
            top,
            top=top,
            most=most,
            n=len(where),
        )
        return


def _stopped(side: FloatArray, most: float, *, stated: bool) -> IndexArray | None:
    """Samples at which a torque is held by a limit, in one direction; None if it is not."""
    top = float(side.max())
    kept = held_for(side)
    first, length = equal_runs(side)
    level = side[first] >= top * (1.0 - 1e-9)
    enough = (
        length[level].max(initial=0) >= PLATEAU_RUN * kept and length[level].sum() >= PLATEAU * kept
    )
    # Equal samples say nothing where a recorder's digits, or rest, make them equal.
    rests = length[level].sum() > _RESTS * len(side)
    if top > 1.0 and enough and not digit_of(side) and not rests:
        return np.flatnonzero(side >= top * (1.0 - 1e-9))
    within = np.abs(side - most) <= _BAND * most
    below = np.abs(side - (1.0 - 2.0 * _BAND) * most) <= _BAND * most
    held = int(within.sum()) >= max(PLATEAU, _EXCESS * int(below.sum()))
    beyond = top > (1.0 + 2.0 * _BAND) * most
    if (held and not beyond) or (stated and top >= (1.0 - 2.0 * _BAND) * most):
        return np.flatnonzero(side >= (1.0 - 2.0 * _BAND) * most)
    return None


def artefact(trial: CheckedTrial) -> Iterator[Finding]:
    """Torque that no ankle makes, and short departures from what EMG and angle explain."""
    channel = trial.recording.channels.get("torque")
    if channel is None:
        raise Unjudged("There is no torque.")
    size = np.abs(channel.values)
    top = float(size.max())
    if top > IMPOSSIBLE:
        yield _artefact(trial, "most", channel.time[size > IMPOSSIBLE], top)
        return
    if trial.model is None:
        raise Unjudged("The trial is too short to know its torque.")
    left = np.abs(trial.model.unexplained)
    wrong = left > max(UNEXPLAINED, UNEXPLAINED_TIMES * quantile(left, 0.68))
    if wrong.any() and float(wrong.mean()) <= UNEXPLAINED_SHARE:
        percent = 100 * float(wrong.mean())
        yield _artefact(trial, "apart", trial.model.time[wrong], float(left.max()), percent)


def _artefact(
    trial: CheckedTrial, which: str, at: FloatArray, top: float, percent: float = 0.0
) -> Finding:
    span = span_of(at)
    apart = span[1] - span[0] < 0.5 * float(np.ptp(trial.time))
    return make_finding(
        f"torque-artefact/{which}",
        "torque",
        span,
        top,
        joint=trial.joint,
        top=top,
        percent=percent,
        advice=f"torque-artefact/{'apart' if apart else 'spread'}",
    )


def sign(trial: CheckedTrial) -> Iterator[Finding]:
    """A torque that acts against the muscles that make it."""
    if trial.torque is None or trial.model is None:
        raise Unjudged("There is no torque, or too little of it.")
    model = trial.model
    wrong = ""
    unit = "1"
    if model.part and model.known:
        # The stronger group decides: the weaker may only show the other's crosstalk.
        group = max(model.part, key=lambda name: abs(model.part[name]))
        strength = model.part[group]
        unit = "Nm"
        if strength * (1.0 if group == "triceps" else -1.0) < 0.0:
            wrong = group
    elif float(np.ptp(trial.angle)) > 0.2:
        strength = correlation(passive_columns(trial.angle)[0], trial.torque)
        if strength < _AGAINST:
            wrong = "passive"
    else:
        raise Unjudged("Neither EMG nor angle say what the torque should be.")
    if wrong:
        yield make_finding(
            f"torque-sign/{wrong}",
            "torque",
            trial.span,
            strength,
            unit=unit,
            joint=trial.joint,
            pull=strength,
        )


def offset(trial: CheckedTrial) -> Iterator[Finding]:
    """A torque whose constant part is not that of gravity."""
    if trial.torque is None:
        raise Unjudged("There is no torque.")
    if trial.recording.fixed.get("m") == 0.0:
        raise Unjudged("m is fixed at 0: gravity has been taken out already.")
    turned = False
    with suppress(Unjudged):
        turned = any(sign(trial))
    torque = -trial.torque if turned else trial.torque
    rest = baseline(trial.rate_hz, trial.angle, torque, trial.fast)
    if rest is None:
        raise Unjudged("Too little rest, or too little of the range, to tell.")
    level = rest.level
    low = GRAVITY[0] - UNCERTAIN
    high = GRAVITY[1] + UNCERTAIN
    beyond = max(low - level, level - high)
    if beyond <= 0.0:
        return
    if beyond + UNCERTAIN < FOLLOWED * rest.spread:
        raise Unjudged("EMG and angle explain too little of the torque to tell.")
    yield make_finding("torque-offset", "torque", trial.span, level, joint=trial.joint, level=level)
