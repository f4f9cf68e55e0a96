"""EMG channels, or parts of them, that show nothing: constant, lost, or of a muscle that works."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from surae.quality.electrodes import ONE_STRENGTH, RELAXED, SILENT
from surae.quality.finding import Finding, make_finding
from surae.quality.numeric import equal_runs, quantile, span_of
from surae.quality.trial import CheckedTrial
from surae.recording import Channel
from surae.recording.recording import weight_of

#: A channel that keeps one value for longer than this [s] has lost its signal.
DROPOUT = 0.5
#: Raw EMG that keeps one value for so long [s], so many times, has lost pieces; each ends in a jump
#: of more than so many of the recorder's digits, where a muscle at rest changes by one.
_GAP = 0.02
_GAPS = 3
_DIGITS = 3.0
#: Torque in the direction of a muscle [Nm] that neither angle nor the other muscles' EMG explain,
#: root mean square and in the strongest 2 % of the time: then its electrode, which shows noise
#: alone, is dead. Angle alone leaves less than 2 in measured and virtual relaxed trials.
UNHEARD = (4.0, 8.0)
#: Heads of the triceps that work above this part of the largest of the leg's trials, for so long
#: [s], while one whose electrode works elsewhere shows noise alone.
_GO_ON = 0.3
_GO_ON_S = 3.0


def flat(trial: CheckedTrial) -> Iterator[Finding]:
    """Channels, or parts of them, that are constant or hear nothing of a muscle that works."""
    known = trial.electrodes
    tops = {muscle: quantile(envelope, 0.98) for muscle, envelope in trial.slow.items()}
    effort = any(not known.rests(muscle, top) for muscle, top in tops.items())
    for muscle, channel in trial.emg.items():
        if muscle not in tops:
            # An electrode that is constant in all trials is as one that is missing.
            lost = muscle in known.levels
            level = float(channel.values[0]) + 0.0
            yield _flat(trial, channel, "constant", lost=lost, level=level)
            continue
        silent = tops[muscle] < SILENT * known.strongest
        steady = tops[muscle] < ONE_STRENGTH * quantile(trial.slow[muscle], 0.05)
        dead = (silent or steady) and _is_unheard(trial, muscle)
        # Noise of one strength that is as weak as a relaxed muscle's may be one.
        loud = silent or (steady and tops[muscle] > RELAXED * known.strongest)
        doubtful = effort and loud and not known.works(muscle)
        doubtful = doubtful or ((silent or steady) and _rests_beside(trial, muscle))
        if dead or doubtful:
            share = 100 * tops[muscle] / known.strongest
            which = "silent" if silent else "noise"
            yield _flat(trial, channel, which, lost=dead, percent=share)
        else:
            yield from _dropouts(trial, channel)


def _is_unheard(trial: CheckedTrial, muscle: str) -> bool:
    """Whether the torque shows a muscle at work of which its electrode shows nothing."""
    if trial.model is None:
        return False
    left = trial.model.unexplained * (-1.0 if muscle == "ta" else 1.0)
    usual, strong = UNHEARD
    return float(np.std(left)) > usual and quantile(left, 0.98) > strong


def _rests_beside(trial: CheckedTrial, muscle: str) -> bool:
    """Whether other heads of the triceps work for long: one of them may rest, or be unheard."""
    known = trial.electrodes
    heads = [m for m in trial.triceps if m != muscle and known.works(m)]
    if muscle == "ta" or not heads or not known.works(muscle):
        return False
    at_work = [trial.slow[m] > _GO_ON * known.levels[m].top for m in heads]
    return float(np.any(at_work, axis=0).sum()) > _GO_ON_S * trial.rate_hz


def _dropouts(trial: CheckedTrial, channel: Channel) -> Iterator[Finding]:
    values = channel.values
    first, length = equal_runs(values)
    long = length > DROPOUT * channel.rate_hz
    if trial.emg_kind == "envelope":
        # An envelope without noise rests at its smallest value, again and again.
        low = float(values.min())
        high = float(values.max())
        at_rest = values[first] <= low + 0.02 * (high - low)
        held = length[long & at_rest]
        if len(held) > 1 or held.sum() > 0.8 * length[at_rest].sum():
            long &= ~at_rest
        # A plateau at the top is clipped, which is another finding.
        long &= values[first] < high
    else:
        yield from _gaps(trial, channel)
    for begin, count in zip(first[long], length[long], strict=True):
        yield _flat(
            trial,
            channel,
            "part",
            int(begin),
            int(begin + count - 1),
            level=values[begin],
            seconds=count / channel.rate_hz,
        )


def _gaps(trial: CheckedTrial, channel: Channel) -> Iterator[Finding]:
    """Short pieces of raw EMG that were lost: zeros, or the last value held."""
    values = channel.values
    rate = channel.rate_hz
    first, length = (each[:-1] for each in equal_runs(values))
    steps = np.abs(np.diff(values))  # the last of a run's samples is followed by its jump
    lost = (length >= _GAP * rate) & (length <= DROPOUT * rate)
    lost &= steps[first + length - 1] > _DIGITS * np.min(steps, where=steps > 0.0, initial=np.inf)
    lost &= (values[first] > values.min()) & (values[first] < values.max())  # that is clipped
    if (n := int(lost.sum())) >= _GAPS:
        first = first[lost]
        length = length[lost]
        yield _flat(
            trial,
            channel,
            "lost",
            int(first[0]),
            int(first[-1] + length[-1] - 1),
            n=n,
            seconds=float(length.sum()) / rate,
        )


def _flat(
    trial: CheckedTrial,
    channel: Channel,
    which: str,
    first: int = 0,
    last: int = -1,
    *,
    lost: bool = False,
    **values: Any,
) -> Finding:
    """A channel, or a part of it, that shows nothing; `lost` where its muscle works."""
    start = float(channel.time[first])
    end = float(channel.time[last])
    whole = (start, end) == span_of(channel.time)
    muscle = channel.role.removeprefix("emg_")
    return make_finding(
        f"emg-flat/{which}",
        channel.role,
        (start, end),
        values.get("seconds", end - start),
        severity="error" if lost else "warning",
        advice="emg-flat/whole" if whole else "",
        muscle=trial.names[muscle],
        weight=weight_of(muscle),
        **values,
    )
