"""Every check by name, and the one that runs them all."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from surae.base.plugins import plugins
from surae.model.joint import ANKLE, Joint
from surae.quality import (
    activity,
    emg,
    emg_flat,
    film,
    lag,
    mains,
    position,
    reflex,
    timing,
    torque,
)
from surae.quality.commanded import Commanded
from surae.quality.electrodes import Electrodes
from surae.quality.finding import SEVERITIES, Finding, Quality, Skipped, Unjudged
from surae.quality.trial import CheckedTrial, Signals, trial_of
from surae.recording import MUSCLES, Recording

#: Checks with limits of the ankle, or by a quick fit that has its arms.
_ANKLES = (
    "angle-sign",
    "angle-still",
    "angle-units",
    "emg-unit",
    "film-unit",
    "reflex-suspected",
    "time-unit",
    "torque-artefact",
    "torque-offset",
    "torque-unit",
)
#: Samples that signals need for anything but their time to be judged.
_FEWEST = 32
#: Rate below which nothing but the time is looked at [Hz].
_SLOWEST = 5.0


@dataclass(frozen=True, slots=True)
class Check:
    """A check: the codes of what it finds (see `KINDS`; a plugin has its own), and its function."""

    codes: tuple[str, ...]
    run: Callable[[CheckedTrial], Iterator[Finding]]


#: Of the signals; those of the time axis need no signal that can be read, and quick fits make the
#: rest (`surae.inference.diagnosis`).
CHECKS: tuple[Check, ...] = (
    Check(("emg-kind",), emg.kind),
    Check(("emg-missing",), emg.missing),
    Check(("as-read",), timing.as_read),
    Check(("emg-flat",), emg_flat.flat),
    Check(("emg-doubled",), emg.doubled),
    Check(("emg-clipped",), emg.clipped),
    Check(("emg-aliased",), emg.aliased),
    Check(("emg-offset",), emg.offset),
    Check(("emg-artefact",), emg.artefact),
    Check(("mains-hum",), mains.hum),
    Check(("electrode-off",), mains.off),
    Check(("electrode-off",), activity.silenced),
    Check(("electrode-lag",), lag.electrode_lag),
    Check(("emg-torque-lag",), lag.torque_lag),
    Check(("torque-limit",), torque.limit),
    Check(("torque-artefact",), torque.artefact),
    Check(("torque-sign",), torque.sign),
    Check(("torque-offset",), torque.offset),
    Check(("angle-units",), position.units),
    Check(("rom-not-covered",), position.range_of_motion),
    Check(("stretch-series",), position.stretches),
    Check(("position-steps",), position.steps),
    Check(("overshoot",), position.overshoot),
    Check(("passive-not-passive",), activity.passive_part),
    Check(("active-not-active",), activity.active_part),
    Check(("co-contraction",), activity.co_contraction),
    Check(("reflex-suspected",), reflex.suspected),
    Check(("film-unit",), film.unit),
    Check(("film-lost",), film.lost),
    Check(("film-repeated",), film.repeated),
    Check(("film-jump",), film.jumps),
    Check(("film-clock", "film-drift"), film.against_the_robot),
)

#: Of single samples: what they find stays in any part of a recording, and needs no model of it.
OF_SAMPLES: tuple[Check, ...] = (
    Check(("emg-flat",), emg_flat.flat),
    Check(("emg-doubled",), emg.doubled),
    Check(("emg-clipped",), emg.clipped),
    Check(("emg-artefact",), emg.artefact),
    Check(("electrode-off",), mains.off),
    Check(("electrode-off",), activity.silenced),
    Check(("torque-limit",), torque.limit),
    Check(("torque-artefact",), torque.artefact),
    Check(("film-lost",), film.lost),
    Check(("film-repeated",), film.repeated),
    Check(("film-jump",), film.jumps),
)


def check_recording(
    recording: Recording,
    commanded: Commanded | None = None,
    signals: Signals | None = None,
    joint: Joint = ANKLE,
    electrodes: Electrodes | None = None,
) -> Quality:
    """All findings of a recording of a joint, the most severe first, then by time.

    It is as it was measured: checks see faults that preparation would hide. `commanded` is the
    motion that the device was to follow, and the requested effort; `signals` are the recording's
    own, where they have been made already; `electrodes` are what all trials of the leg show of
    theirs, else the trial is judged against itself. Of another joint than the ankle it has none by
    the ankle's limits, and none of channels that stand for no muscle.
    """
    findings = [*timing.time_axes(recording), *timing.too_short(recording)]
    skipped: list[Skipped] = []
    reason = unfit(recording)
    if reason is None:
        trial = trial_of(recording, commanded, signals, joint, electrodes)
        for check in (*CHECKS, *plugins("checks", Check).values()):
            try:
                findings += check.run(trial)
            except Unjudged as reason:
                skipped += [Skipped(code, str(reason)) for code in check.codes]
    else:
        skipped += [Skipped(code, reason) for check in CHECKS for code in check.codes]
    if joint != ANKLE:
        silent = {f"emg_{MUSCLES[channel]}" for channel in joint.silent}
        findings = [f for f in findings if f.code not in _ANKLES and f.channel not in silent]
        skipped = [skip for skip in skipped if skip.check not in _ANKLES]
        skipped += [Skipped(code, "Its limits are not known of this joint.") for code in _ANKLES]
    return Quality(recording.name, ordered(findings), tuple(skipped))


def check_samples(piece: Recording, electrodes: Electrodes) -> list[Finding]:
    """What is wrong with single samples in a piece of a long recording.

    `electrodes` are what the whole recording shows of its electrodes.
    """
    if unfit(piece) is not None:
        return []
    trial = trial_of(piece, electrodes=electrodes, modelled=False)
    findings: list[Finding] = []
    for check in OF_SAMPLES:
        with suppress(Unjudged):
            findings += check.run(trial)
    return findings


def ordered(findings: list[Finding]) -> tuple[Finding, ...]:
    """The most severe first, then by time."""
    return tuple(sorted(findings, key=lambda f: (-SEVERITIES.index(f.severity), f.start_s, f.code)))


def unfit(recording: Recording) -> str | None:
    """Why the signals cannot be compared; None where they can."""
    channels = recording.signals
    if "angle" not in channels:
        return "There is no angle."
    slowest = min(c.rate_hz for c in channels.values())
    if slowest < _SLOWEST:
        return f"A channel has {slowest:.2g} samples a second: too few to look at."
    start, end = recording.shared
    shared = min(
        int(np.count_nonzero((c.time >= start) & (c.time <= end))) for c in channels.values()
    )
    if end <= start or shared < _FEWEST:
        return "The channels share too few samples."
    return None
