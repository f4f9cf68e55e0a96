"""What a check of a recording says, as plain data."""

from dataclasses import dataclass
from typing import Any, Literal

from surae.base.records import to_plain
from surae.base.tables import Tabular, TextTable
from surae.base.words import N_
from surae.recording import MUSCLES, Channel

Severity = Literal["info", "warning", "error"]

#: From the least to the most severe.
SEVERITIES: tuple[Severity, ...] = ("info", "warning", "error")


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing to know about a recording before its fit is believed."""

    code: str  #: What it is, such as ``"emg-flat"``; one of `KINDS`.
    severity: Severity  #: Worth knowing; makes estimates doubtful; makes them wrong.
    #: Role of the channel it is about, ``"time"``, or None where it is about the whole trial.
    channel: str | None
    #: `start_s`, `end_s`: span of time that it is about [s].
    start_s: float
    end_s: float
    value: float | None  #: The number that it was judged by, in `unit`; None where there is none.
    unit: str  #: Empty where there is no value, ``"1"`` for a ratio.
    message: str  #: What was found, one sentence.
    advice: str  #: What to do, one sentence.


class Unjudged(Exception):  # noqa: N818  # no error: a check says so
    """What a check needs is not there; why, in one sentence."""


@dataclass(frozen=True, slots=True)
class Skipped:
    """A check that could not be made, and why, in one sentence."""

    check: str
    reason: str


@dataclass(frozen=True, slots=True, repr=False)
class Quality(Tabular):
    """All findings of one recording, the most severe first, and the checks that were left out."""

    recording: str
    findings: tuple[Finding, ...]
    skipped: tuple[Skipped, ...] = ()

    @property
    def worst(self) -> Severity | None:
        """Severity of the worst finding; None without findings."""
        return max((f.severity for f in self.findings), key=SEVERITIES.index, default=None)

    @property
    def clean(self) -> bool:
        """Whether nothing worse than information was found."""
        return self.worst in (None, "info")

    @property
    def summary(self) -> str:
        """How many findings there are of each severity, in words."""
        parts = [
            f"{n} {severity}{'' if n == 1 else 's'}"
            for severity in ("error", "warning")
            if (n := self.count(severity))
        ]
        if self.count("info"):
            parts.append(f"{self.count('info')} for information")
        return ", ".join(parts) or "nothing found"

    def count(self, severity: Severity) -> int:
        """Count the findings of one severity.

        Parameters
        ----------
        severity : {"info", "warning", "error"}
            Which.

        Returns
        -------
        int
            How many there are.
        """
        return sum(finding.severity == severity for finding in self.findings)

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each finding.
        """
        return TextTable(
            ("severity", "code", "channel", "from [s]", "to [s]", "found", "what to do"),
            tuple(
                (f.severity, f.code, f.channel or "", f"{f.start_s:.2f}", f"{f.end_s:.2f}",
                 f.message, f.advice)
                for f in self.findings
            ),
            above=(f"{self.recording}: {self.summary}",),
            below=tuple(f"not checked: {skip.check}: {skip.reason}" for skip in self.skipped),
            numbers=("from [s]", "to [s]"),
        )  # fmt: skip

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as it is written to files."""
        return dict(to_plain(self))


def weight_of(muscle: str) -> str:
    """The parameter that weighs a muscle's EMG."""
    return f"g{MUSCLES.index(muscle) + 1}"


def quantity(value: float, channel: Channel) -> str:
    """A value of a channel with its unit; a normalised one has none."""
    return f"{value:.3g}" if channel.unit == "1" else f"{value:.3g} {channel.unit}"


@dataclass(frozen=True, slots=True)
class FindingKind:
    """A kind of finding; a check may give severity, unit and advice that fit the recording."""

    code: str  #: Its name.
    looks_for: str  #: What is wrong, in a few words.
    advice: str  #: What to do, a sentence.
    severity: Severity = "warning"
    unit: str = "1"  #: Of the number that it is judged by.


_KINDS = (
    FindingKind("emg-kind", N_("raw EMG declared an envelope, or the other way round"),
        N_("Declare what it is: # emg: raw or # emg: envelope."), "error"),
    FindingKind("as-read", N_("gaps that were bridged, times that were rounded, a file cut short"),
        N_("Nothing, if you meant it so; else correct the file or the mapping."), "info", unit=""),
    FindingKind("emg-missing", N_("muscles without EMG"),
        N_("Add the channel, or fix its weight, e.g. with --fixed g1=0."), unit=""),
    FindingKind("emg-flat", N_("EMG that is constant, for a while or throughout"),
        N_("Leave that time out of the fit with --exclude, or record again."), unit="s"),
    FindingKind("emg-clipped", N_("EMG at the amplifier’s limit"),
        N_("Lower the amplifier's gain and record again; efforts beyond that level are "
        "underestimated.")),
    FindingKind("emg-aliased", N_("EMG sampled without a filter before"),
        N_("Sample at 1000 Hz or more, or filter below half the rate before; sizes hold, but hum "
        "and "
        "artefacts can fold to where no filter finds them, and fewer values are identified.")),
    FindingKind("emg-offset", N_("EMG that does not rest at zero"),
        N_("Take the offset away in the mapping; rest the muscle for an envelope."), unit="V"),
    FindingKind("emg-artefact", N_("spikes and swings of cables and skin"),
        N_("Fasten cable and electrode; leave that time out with --exclude, or fit with --loss "
        "huber."),
        unit="V"),
    FindingKind("mains-hum", N_("50 or 60 Hz in the EMG"),
        N_("Improve the reference electrode and keep cables from power lines; the high-pass does "
        "not "
        "remove it."), unit="V"),
    FindingKind("electrode-off", N_("an electrode that comes off during the trial"),
        N_("Fix the electrode, look at its signal while the muscle works, and record again."),
        "error"),
    FindingKind("electrode-lag", N_("one electrode later than the others"),
        N_("Check the delay of that sensor, a wireless one above all, and shift its channel."),
        unit="s"),
    FindingKind("emg-torque-lag", N_("EMG and torque out of step"),
        N_("Check how the devices are synchronised, and shift the time of one file by that much."),
        "error", "s"),
    FindingKind("torque-limit", N_("torque at the device’s limit"),
        N_("Ask for less effort or a slower motion and record again; at its limit the device no "
        "longer follows the profile."), "error", "Nm"),
    FindingKind("torque-artefact", N_("torque that neither EMG nor angle explain"),
        N_("Look at that time; leave it out with --exclude, or fit with --loss huber."), unit="Nm"),
    FindingKind("torque-sign", N_("torque of the wrong sign"),
        N_("Write sign = -1 for the torque (positive when the triceps pulls), or for the angle "
        "(positive in dorsiflexion) if that is turned."), "error"),
    FindingKind("torque-offset", N_("torque that gravity does not explain"),
        N_("Set the sensor to zero with the empty footplate and record again, or give the torque "
        "an "
        "offset in the TOML."), unit="Nm"),
    FindingKind("angle-units", N_("degrees for radians, or another zero"),
        N_("Give the unit in the column's name or in the mapping; 0 is the foot at 90°."),
        "error", "rad"),
    FindingKind("rom-not-covered", N_("a small range of motion"),
        N_("Move through the subject's whole range: stiffness and optimal lengths show at its "
        "ends."),
        unit="rad"),
    FindingKind("stretch-series", N_("slow and fast stretches, which another command takes apart"),
        N_("Use surae stretches: it tells tissue from nerve."), "info", "deg/s"),
    FindingKind("position-steps", N_("steps instead of the profile"),
        N_("Record again with slower motion or less effort; the device followed steps instead of "
        "the "
        "profile."), "error", "rad"),
    FindingKind("overshoot", N_("angles beside the commanded profile"),
        N_("Generate a protocol for this device with surae protocol --device, or lower its speed."),
        unit="rad"),
    FindingKind("passive-not-passive", N_("activity while relaxed"),
        N_("Repeat the passive part with the subject relaxed: passive stiffness would be "
        "overestimated.")),
    FindingKind("active-not-active", N_("efforts that were not made"),
        N_("Repeat the trial, or leave that time out with --exclude.")),
    FindingKind("co-contraction", N_("both sides active throughout"),
        N_("Ask for one direction at a time, and look for crosstalk: together, their weights "
        "cannot "
        "be separated.")),
    FindingKind("reflex-suspected", N_("bursts that follow stretches"),
        N_("Stretch more slowly for passive parameters; with reflexes, activity and stretch are "
        "not "
        "independent."), unit="s"),
    FindingKind("time-gap", N_("samples that are missing"),
        N_("Use a part without a gap, or record again: signals across a gap are not known."),
        "error", "s"),
    FindingKind("time-jitter", N_("time stamps that scatter or go back"),
        N_("Take the time from the sample counter of the device, not from the computer's clock."),
        unit="s"),
    FindingKind("not-used", N_("samples that no fit reads: another channel has ended"),
        N_("Nothing, if that is meant: no check looks at them."), "info", "s"),
    FindingKind("samples-missing", N_("samples that are not numbers"),
        N_("Correct the file, bridge gaps of some ms by bridge_s in a mapping, or cut it to a part "
        "without them; no fit reads it so."), "error"),
    FindingKind("trial-too-short", N_("trials too short for the relaxation"),
        N_("Record longer, with holds, or fix tau_rel and k_rel."), unit="s"),
    FindingKind("angle-sign", N_("an angle that is turned, by what a quick fit then explains"),
        N_("Write sign = -1 for the angle in the TOML."), "error"),
    FindingKind("electrodes-swapped",
        N_("electrodes of two muscles that were exchanged, by the same"),
        N_('Write swap = ["ta", "sol"] in the TOML, with the two that it says.'), "error"),
    FindingKind("torque-drift", N_("a torque whose zero drifts through the trial"),
        N_("Let the sensor warm up, set it to zero and record again; a fit of a part of the trial "
        "(--exclude) is less wrong."), unit="Nm"),
    FindingKind("emg-gain", N_("EMG whose gain changes within the trial"),
        N_("Look at the electrodes and at the amplifier's gain, and record again; a fit of a part "
        "of "
        "the trial (--exclude) is less wrong.")),
    FindingKind("angle-still", N_("a static hold"),
        N_("Record a trial that moves: one hold can’t show stiffness, lengths or relaxation."),
        "error", "rad"),
    FindingKind("torque-unit", N_("mNm, or kNm, for Nm"),
        N_("Write the torque's unit in the TOML."), "error", "Nm"),
    FindingKind("emg-unit", N_("mV or µV for V, in one channel or all"),
        N_('Write unit = "µV" for the EMG in the TOML.'), "error", "V"),
    FindingKind("film-unit", N_("fascicle lengths in mm, cm or m that no muscle of the ankle has"),
        N_("Write the unit of the lengths in the column's name or in the mapping."), "error", "m"),
    FindingKind("film-lost", N_("frames in which the tracker lost the fascicle"),
        N_("Track these frames again; a fit leaves them out.")),
    FindingKind("film-repeated", N_("frames that repeat the one before"),
        N_("Export the film at its own rate: repeated frames add no information.")),
    FindingKind("film-jump", N_("jumps of a fascicle from one frame to the next"),
        N_("Look at these frames and track them again."), unit="m"),
    FindingKind("film-clock", N_("a film that is early or late"),
        N_("Correct start_s of the film in the mapping, and check how it is synchronised."),
        "error",
        "s"),
    FindingKind("film-drift", N_("a fascicle that drifts away while the movement repeats"),
        N_("Correct the tracked fascicle at key frames, once in each cycle of the movement."),
        unit="m"),
    FindingKind("time-unit", N_("ms or µs for s"),
        N_("Give the unit of time in the column's name."), "error", "s"),
)  # fmt: skip
#: All of them by code.
KINDS = {kind.code: kind for kind in _KINDS}
#: Every code that a finding can have.
CODES = tuple(KINDS)


def make_finding(
    code: str, channel: str | None, span: tuple[float, float], value: float | None, message: str, *,
    severity: Severity | None = None, unit: str | None = None, advice: str | None = None,
) -> Finding:  # fmt: skip
    """A finding; what is not given is as of its kind."""
    kind = KINDS[code]
    return Finding(
        code, severity or kind.severity, channel, float(span[0]), float(span[1]), value,
        kind.unit if unit is None else unit, message, advice or kind.advice,
    )  # fmt: skip
