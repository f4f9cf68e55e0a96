"""Every check by name, and the one that runs them all."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surae.quality import activity, emg, lag, mains, position, reflex, timing, torque
from surae.quality.commanded import Commanded
from surae.quality.finding import SEVERITIES, Finding, Quality, Skipped
from surae.quality.trial import CheckedTrial, trial_of
from surae.recording import Recording

#: Samples that signals need for anything but their time to be judged.
_FEWEST = 32
#: Rate below which nothing but the time is looked at [Hz].
_SLOWEST = 5.0


@dataclass(frozen=True, slots=True)
class Check:
    """A check: the codes of what it finds, a function, and what it looks for, in a few words."""

    codes: tuple[str, ...]
    run: Callable[[CheckedTrial], tuple[Finding, ...] | Skipped]
    looks_for: str


#: Of the signals.
CHECKS: tuple[Check, ...] = (
    Check(("emg-kind",), emg.kind, "raw EMG declared an envelope, or the other way round"),
    Check(("emg-missing",), emg.missing, "muscles without EMG"),
    Check(("emg-flat",), emg.flat, "EMG that is constant, for a while or throughout"),
    Check(("emg-clipped",), emg.clipped, "EMG at the amplifier's limit"),
    Check(("emg-offset",), emg.offset, "EMG that does not rest at zero"),
    Check(("emg-artefact",), emg.artefact, "spikes and swings of cables and skin"),
    Check(("mains-hum",), mains.hum, "50 or 60 Hz in the EMG"),
    Check(("electrode-off",), mains.off, "an electrode that comes off during the trial"),
    Check(("electrode-lag",), lag.electrode_lag, "one electrode later than the others"),
    Check(("emg-torque-lag",), lag.torque_lag, "EMG and torque out of step"),
    Check(("torque-limit",), torque.limit, "torque at the device's limit"),
    Check(("torque-artefact",), torque.artefact, "torque that neither EMG nor angle explain"),
    Check(("torque-sign",), torque.sign, "torque of the wrong sign"),
    Check(("torque-offset",), torque.offset, "torque that gravity does not explain"),
    Check(("angle-units",), position.units, "degrees for radians, or another zero"),
    Check(("rom-not-covered",), position.range_of_motion, "a small range of motion"),
    Check(("position-steps",), position.steps, "steps instead of the profile"),
    Check(("overshoot",), position.overshoot, "angles beside the commanded profile"),
    Check(("passive-not-passive",), activity.passive_part, "activity while relaxed"),
    Check(("active-not-active",), activity.active_part, "efforts that were not made"),
    Check(("co-contraction",), activity.co_contraction, "both sides active throughout"),
    Check(("reflex-suspected",), reflex.suspected, "bursts that follow stretches"),
)

#: Of the time axis, which need no signal that can be read.
TIME_CODES = ("time-gap", "time-jitter", "samples-missing", "trial-too-short")

#: What quick fits say, see `surae.diagnosis`.
DIAGNOSED_CODES = ("angle-sign", "angle-still", "torque-unit", "emg-unit", "time-unit")

#: Every code that a finding can have.
CODES: tuple[str, ...] = (
    *(code for check in CHECKS for code in check.codes),
    *TIME_CODES,
    *DIAGNOSED_CODES,
)


def check_recording(recording: Recording, commanded: Commanded | None = None) -> Quality:
    """All findings of a recording.

    Parameters
    ----------
    recording : Recording
        As it was measured: checks see faults that preparation would hide.
    commanded : Commanded, optional
        The motion that the device was to follow, and the effort that was asked for.

    Returns
    -------
    Quality
        The most severe findings first, then by time.
    """
    findings = [*timing.time_axes(recording), *timing.too_short(recording)]
    skipped: list[Skipped] = []
    reason = unfit(recording)
    if reason is None:
        trial = trial_of(recording, commanded)
        for check in CHECKS:
            outcome = check.run(trial)
            if isinstance(outcome, Skipped):
                skipped.append(outcome)
            else:
                findings += outcome
    else:
        skipped += [Skipped(code, reason) for check in CHECKS for code in check.codes]
    return Quality(recording.name, ordered(findings), tuple(skipped))


def ordered(findings: list[Finding]) -> tuple[Finding, ...]:
    """The most severe first, then by time."""
    return tuple(sorted(findings, key=lambda f: (-SEVERITIES.index(f.severity), f.start_s, f.code)))


def unfit(recording: Recording) -> str | None:
    """Why the signals cannot be compared; None where they can."""
    channels = recording.channels
    if "angle" not in channels:
        return "There is no angle."
    slowest = min(c.rate_hz for c in channels.values())
    if slowest < _SLOWEST:
        return f"A channel has {slowest:.2g} samples a second: too few to look at."
    start = max(float(c.time[0]) for c in channels.values())
    end = min(float(c.time[-1]) for c in channels.values())
    shared = min(
        int(np.count_nonzero((c.time >= start) & (c.time <= end))) for c in channels.values()
    )
    if end <= start or shared < _FEWEST:
        return "The channels share too few samples."
    return None
