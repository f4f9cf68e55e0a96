"""EMG channels one by one: missing, doubled, clipped, too slow, offset, artefacts."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from surae.quality.electrodes import ONE_STRENGTH, RMS
from surae.quality.finding import Finding, make_finding, quantity
from surae.quality.numeric import correlation, quantile, runs, smooth, span_of
from surae.quality.trial import CheckedTrial
from surae.recording import MUSCLES
from surae.recording.emg_kind import emg_contradictions
from surae.recording.recording import weight_of
from surae.signals import Preparation
from surae.signals.prepare import RATE_FACTOR

#: A limit holds samples at this part and more of the largest of the leg's trials: what a recorder's
#: digits repeat in a relaxed trial is far below.
CLIPPED_LEVEL = 0.5
#: An artefact whose sample is below this part of what efforts reach, or a hum or an offset that is
#: a small part of them, does no harm in a relaxed trial.
HARMLESS = 0.25
#: Samples exactly at the largest value that make a plateau. A smooth peak has two at most.
CLIPPED_SAMPLES = 5
#: A plateau holds more samples than the next hundredth of the range below it; where nothing is
#: clipped, the numbers fall outwards.
CLIPPED_EXCESS = 1.0
#: Correlation from which on two channels hold one signal: of 114 virtual legs raw EMG has at most
#: 0.6 (crosstalk), envelopes 0.9978; a copy, scaled or turned, has 1.
ONE_SIGNAL = {"raw": 0.95, "envelope": 1.0 - 1e-6}
#: Power of EMG in the last eighth below half the sampling rate over that below it, from 40 Hz on:
#: small where EMG was filtered before it was sampled, about one where it was not.
FOLDED = 0.65
_NYQUIST_PART = 0.875
_EMG_HZ = 40.0
#: Length of the pieces of which the spectrum is taken [s], and the fewest that tell it.
_PIECE_S = 0.25
_PIECES = 16
#: Power in the strongest quarter of the pieces over that in the quietest, from which on there is an
#: effort: twice the level. The noise of an amplifier at rest has no effort to tell of.
_EFFORT = 4.0
#: Offset of raw EMG as a part of its standard deviation; the mean of clean EMG is below 0.01.
OFFSET = 0.15
#: Level of an envelope at rest as a part of its highest; clean ones, crosstalk included, stay
#: below 0.05 and noise of 5 % adds 0.02.
FLOOR = 0.10
#: From here on it matters to a fit: muscles that seem active when they are not.
BAD_FLOOR = 0.2
#: A spike is a sample beyond this many times the level that the EMG exceeds for `_OFTEN` seconds in
#: all, which artefacts do not. Gaussian EMG in a few bursts reaches 8 times, an envelope 2.6 times.
SPIKE = {"raw": 10.5, "envelope": 3.5}
_OFTEN = 0.75
#: What lasts longer [s] is an effort.
BURST_SECONDS = 0.8
#: Slow content (below about 15 Hz) of raw EMG as a part of that level. Clean EMG has none below
#: 20 Hz and leaks 0.3 of it; a moving cable or skin makes more than the EMG itself.
SLOW_SPIKE = 0.9
_SLOW_WINDOW = 0.04


def kind(trial: CheckedTrial) -> Iterator[Finding]:
    """EMG that is not what it is declared to be, which a fit would refuse or filter wrongly."""
    declared = trial.recording.emg
    for role, sentence in emg_contradictions(trial.recording).items():
        if role.removeprefix("emg_") in trial.slow:
            channel = trial.recording.channels[role]
            statement, _, advice = sentence.partition("): ")
            if declared == "raw":
                advice += "; a fit refuses it else, unless all signals are prepared (--prepared)"
            yield make_finding(
                "emg-kind",
                role,
                trial.span,
                float(channel.values.min()),
                advice="emg-kind/looks",
                # An envelope is right where all signals are prepared, as --prepared says.
                severity="error" if declared == "envelope" else "warning",
                unit=channel.unit,
                statement=f"{statement})",
                advised=f"{advice[:1].upper()}{advice[1:]}",
            )
            return


def missing(trial: CheckedTrial) -> Iterator[Finding]:
    """Muscles without an EMG channel."""
    for muscle in MUSCLES:
        role = f"emg_{muscle}"
        weight = weight_of(muscle)
        if role in trial.recording.channels:
            continue
        is_fixed = weight in trial.recording.fixed
        yield make_finding(
            "emg-missing/fixed" if is_fixed else "emg-missing",
            role,
            trial.span,
            None,
            advice="" if is_fixed else "emg-missing/named",
            severity="info" if is_fixed else "warning",
            muscle=trial.names[muscle],
            weight=weight,
        )


def doubled(trial: CheckedTrial) -> Iterator[Finding]:
    """A muscle whose EMG is another's: one column, input or hum twice.

    Where both rest in this trial and work in others, what they share is the recorder's noise.
    """
    known = trial.electrodes
    resting = {
        muscle
        for muscle in trial.varying
        if known.trials > 1
        and known.works(muscle)
        and known.rests(muscle, quantile(trial.slow[muscle], 0.98))
    }
    for (muscle, one), (other, two) in combinations(trial.varying.items(), 2):
        if {muscle, other} <= resting:
            continue
        same = len(one.values) == len(two.values)
        r = abs(correlation(one.values, two.values)) if same else 0.0
        if r > ONE_SIGNAL[trial.emg_kind]:
            yield make_finding(
                "emg-doubled",
                two.role,
                span_of(two.time),
                r,
                muscle=trial.names[other],
                other=trial.names[muscle],
            )


def clipped(trial: CheckedTrial) -> Iterator[Finding]:
    """Channels that end at a plateau, as behind an amplifier at its limit."""
    for muscle, channel in trial.emg.items():
        raw = trial.emg_kind == "raw"
        known = trial.electrodes.levels.get(muscle)
        values = channel.values - (float(np.median(channel.values)) if raw else 0.0)
        # An offset may hide a side; an envelope rests at its smallest value.
        for side in (values, -values) if raw else (values,):
            top = float(side.max())
            span = float(np.ptp(side))
            where = np.flatnonzero(side >= top - 1e-9 * span)
            count = len(where)
            share = len(where) / len(values)
            beside = int((side >= top - 0.01 * span).sum()) - count
            if top <= 0.0 or count < max(CLIPPED_SAMPLES, CLIPPED_EXCESS * beside) or share > 0.5:
                continue
            if known is not None and float(np.abs(values).max()) < CLIPPED_LEVEL * known.peak:
                continue
            level = float(channel.values[where[0]])
            yield make_finding(
                "emg-clipped",
                channel.role,
                span_of(channel.time, where),
                share,
                severity="warning" if share < 1e-3 else "error",
                n=count,
                muscle=trial.names[muscle],
                level=quantity(level, channel),
            )
            break


def aliased(trial: CheckedTrial) -> Iterator[Finding]:
    """Raw EMG too slow for its filter, or whose power does not fall towards half its rate."""
    if trial.emg_kind != "raw":
        return
    least = RATE_FACTOR * (Preparation().updated(trial.recording.prepare).emg_highpass_hz or 0.0)
    for muscle, channel in trial.varying.items():
        if channel.rate_hz < least and channel.values.min() < 0.0:
            yield make_finding(
                "emg-aliased/slow",
                channel.role,
                span_of(channel.time),
                channel.rate_hz,
                severity="error",
                muscle=trial.names[muscle],
                hz=channel.rate_hz,
                least=least,
            )
            continue
        size = round(_PIECE_S * channel.rate_hz)
        pieces = channel.values[: len(channel.values) // size * size].reshape(-1, size)
        if len(pieces) < _PIECES or channel.rate_hz < 3.0 * _EMG_HZ:
            continue
        power = np.abs(np.fft.rfft((pieces - pieces.mean(axis=1)[:, None]) * np.hanning(size))) ** 2
        total = power.sum(axis=1)
        strong = np.argsort(total)
        quarter = len(pieces) // 4
        if total[strong[-quarter:]].mean() < _EFFORT * total[strong[:quarter]].mean():
            continue
        # of efforts alone: an amplifier's own noise is as loud at all frequencies
        of_effort = power[strong[-quarter:]].mean(axis=0) - power[strong[:quarter]].mean(axis=0)
        at = np.fft.rfftfreq(size) * channel.rate_hz
        near = at > _NYQUIST_PART * 0.5 * channel.rate_hz
        ratio = float(
            of_effort[near].mean() / max(of_effort[(at > _EMG_HZ) & ~near].mean(), 1e-300)
        )
        if ratio > FOLDED:
            yield make_finding(
                "emg-aliased",
                channel.role,
                span_of(channel.time),
                ratio,
                muscle=trial.names[muscle],
                hz=0.5 * channel.rate_hz,
            )


def offset(trial: CheckedTrial) -> Iterator[Finding]:
    """Raw EMG that is not centred on zero, and envelopes that do not come down to it."""
    for muscle, channel in trial.varying.items():
        if trial.emg_kind == "raw":
            level = float(np.median(channel.values))
            strength = max(float(np.std(channel.values)), RMS * trial.electrodes.levels[muscle].top)
            ratio = abs(level) / strength
            limit = OFFSET
        else:
            level = quantile(trial.slow[muscle], 0.02)
            top = max(quantile(trial.slow[muscle], 0.98), trial.electrodes.levels[muscle].top)
            # Where no burst stands out there is no level of rest to speak of.
            ratio = level / top if top > ONE_STRENGTH * level else 0.0
            limit = FLOOR
        if ratio > limit:
            yield make_finding(
                f"emg-offset/{trial.emg_kind}",
                channel.role,
                span_of(channel.time),
                level,
                severity="warning" if trial.emg_kind == "raw" or ratio > BAD_FLOOR else "info",
                unit=channel.unit,
                muscle=trial.names[muscle],
                level=quantity(level, channel),
                percent=100 * ratio,
            )


def artefact(trial: CheckedTrial) -> Iterator[Finding]:
    """Spikes no muscle makes, and slow swings in raw EMG."""
    for muscle, channel in trial.varying.items():
        values = channel.values - float(np.median(channel.values))
        size = np.abs(values)
        apart = round(0.2 * channel.rate_hz)
        seconds = float(channel.time[-1] - channel.time[0])
        usual = quantile(size, max(0.95, 1.0 - _OFTEN / seconds))
        wrong = size > SPIKE[trial.emg_kind] * usual
        for first, last in runs(smooth(wrong.astype(np.float64), apart) > 0.0):
            if last - first > BURST_SECONDS * channel.rate_hz:
                wrong[first:last] = False  # an effort, where efforts are rare
        if trial.emg_kind == "raw":
            width = round(_SLOW_WINDOW * channel.rate_hz)
            swing = np.abs(smooth(smooth(values, width), width))
            wrong |= swing > SLOW_SPIKE * usual
        wrong &= size > HARMLESS * trial.electrodes.levels[muscle].top
        if not wrong.any():
            continue
        # Touching pieces are one artefact.
        spans = list(runs(smooth(wrong.astype(np.float64), apart) > 0.0))
        where = np.flatnonzero(wrong)
        worst = int(np.argmax(np.where(wrong, size, 0.0)))
        yield make_finding(
            "emg-artefact",
            channel.role,
            span_of(channel.time, where),
            float(size[worst]),
            unit=channel.unit,
            muscle=trial.names[muscle],
            n=len(spans),
            size=quantity(float(size[worst]), channel),
            at=channel.time[worst],
            advice="emg-artefact/spread" if where[-1] - where[0] > 0.5 * len(size) else "",
        )
