"""What a check of a recording says, as plain data."""

from dataclasses import dataclass
from typing import Any, Literal

from surae.base.records import to_plain
from surae.base.tables import Tabular, TextTable
from surae.base.words import Message, english
from surae.model.joint import ANKLE, Joint
from surae.recording import Channel

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
    message: str  #: What was found, one sentence: a `Message`, unless it was read from a file.
    advice: str  #: What to do, one sentence, likewise.


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


def quantity(value: float, channel: Channel) -> str:
    """A value of a channel with its unit; a normalised one has none."""
    return f"{value:.3g}" if channel.unit == "1" else f"{value:.3g} {channel.unit}"


@dataclass(frozen=True, slots=True)
class FindingKind:
    """A kind of finding; a check may give severity, unit and advice that fit the recording."""

    code: str  #: Its name.
    severity: Severity = "warning"
    unit: str = "1"  #: Of the number that it is judged by.

    @property
    def looks_for(self) -> Message:
        """What is wrong, in a few words."""
        return Message(f"kind/{self.code}")

    @property
    def advice(self) -> Message:
        """What to do, a sentence."""
        return Message(f"advice/{self.code}")


_KINDS = (
    FindingKind("emg-kind", "error"),
    FindingKind("as-read", "info", ""),
    FindingKind("emg-missing", unit=""),
    FindingKind("emg-flat", unit="s"),
    FindingKind("emg-clipped"),
    FindingKind("emg-aliased"),
    FindingKind("emg-offset", unit="V"),
    FindingKind("emg-artefact", unit="V"),
    FindingKind("mains-hum", unit="V"),
    FindingKind("electrode-off", "error"),
    FindingKind("electrode-lag", unit="s"),
    FindingKind("emg-torque-lag", "error", "s"),
    FindingKind("torque-limit", "error", "Nm"),
    FindingKind("torque-artefact", unit="Nm"),
    FindingKind("torque-sign", "error"),
    FindingKind("torque-offset", unit="Nm"),
    FindingKind("angle-units", "error", "rad"),
    FindingKind("rom-not-covered", unit="rad"),
    FindingKind("stretch-series", "info", "deg/s"),
    FindingKind("position-steps", "error", "rad"),
    FindingKind("overshoot", unit="rad"),
    FindingKind("passive-not-passive"),
    FindingKind("active-not-active"),
    FindingKind("co-contraction"),
    FindingKind("reflex-suspected", unit="s"),
    FindingKind("time-gap", "error", "s"),
    FindingKind("time-jitter", unit="s"),
    FindingKind("not-used", "info", "s"),
    FindingKind("samples-missing", "error"),
    FindingKind("trial-too-short", unit="s"),
    FindingKind("angle-sign", "error"),
    FindingKind("electrodes-swapped", "error"),
    FindingKind("torque-drift", unit="Nm"),
    FindingKind("emg-gain"),
    FindingKind("angle-still", "error", "rad"),
    FindingKind("torque-unit", "error", "Nm"),
    FindingKind("emg-unit", "error", "V"),
    FindingKind("film-unit", "error", "m"),
    FindingKind("film-lost"),
    FindingKind("film-repeated"),
    FindingKind("film-jump", unit="m"),
    FindingKind("film-clock", "error", "s"),
    FindingKind("film-drift", unit="m"),
    FindingKind("time-unit", "error", "s"),
)
#: All of them by code.
KINDS = {kind.code: kind for kind in _KINDS}
#: Every code that a finding can have.
CODES = tuple(KINDS)


def make_finding(
    which: str, channel: str | None, span: tuple[float, float], value: float | None, *,
    severity: Severity | None = None, unit: str | None = None, advice: str = "",
    says: Message | None = None, joint: Joint = ANKLE, **values: Any,
) -> Finding:  # fmt: skip
    """A finding; what is not given is as of its kind.

    The sentences of `which`, and of `advice` where that is another one or a message, are filled in
    with the `values`; a message that `says` what was found takes the place of the first.
    """
    code = which.partition("/")[0]
    kind = KINDS[code]
    if not isinstance(advice, Message):
        own = f"advice/{advice or which}"
        known = own if own in english() else f"advice/{code}"
        advice = Message(known, joint.worded, **values)
    return Finding(
        code, severity or kind.severity, channel, float(span[0]), float(span[1]), value,
        kind.unit if unit is None else unit,
        says or Message(f"found/{which}", joint.worded, **values), advice,
    )  # fmt: skip
