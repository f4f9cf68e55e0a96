"""What a check of a recording says, as plain data."""

import tomllib
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Any, Literal

from surae.base.records import to_plain
from surae.base.tables import Tabular, TextTable
from surae.base.words import Message, english
from surae.model.joint import ANKLE, Joint
from surae.recording import Channel

Severity = Literal["info", "warning", "error"]

#: From the least to the most severe.
SEVERITIES: tuple[Severity, ...] = ("info", "warning", "error")
#: Errors by which a recording is another than its file says: nothing that is made of it holds.
NOT_AS_STATED = {
    "angle-clock",
    "angle-sign",
    "angle-torque-lag",
    "angle-units",
    "electrodes-swapped",
    "emg-clock",
    "emg-unit",
    "time-unit",
    "torque-clock",
    "torque-sign",
    "torque-unit",
}


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
                (
                    f.severity,
                    f.code,
                    f.channel or "",
                    f"{f.start_s:.2f}",
                    f"{f.end_s:.2f}",
                    f.message,
                    f.advice,
                )
                for f in self.findings
            ),
            above=(f"{self.recording}: {self.summary}",),
            below=tuple(f"not checked: {skip.check}: {skip.reason}" for skip in self.skipped),
            numbers=("from [s]", "to [s]"),
        )

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
    severity: Severity
    unit: str  #: Of the number that it is judged by.

    @property
    def looks_for(self) -> Message:
        """What is wrong, in a few words."""
        return Message(f"kind/{self.code}")

    @property
    def advice(self) -> Message:
        """What to do, a sentence."""
        return Message(f"advice/{self.code}")


_FILE = files("surae.quality").joinpath("finding.toml")
#: All kinds by code.
KINDS = {
    code: FindingKind(code, severity, unit)
    for code, (severity, unit) in tomllib.loads(_FILE.read_text(encoding="utf-8")).items()
}
#: Every code that a finding can have.
CODES = tuple(KINDS)


def make_finding(
    which: str,
    channel: str | None,
    span: tuple[float, float],
    value: float | None,
    *,
    severity: Severity | None = None,
    unit: str | None = None,
    advice: str = "",
    joint: Joint = ANKLE,
    **values: Any,
) -> Finding:
    """A finding; what is not given is as of its kind.

    The sentences of `which`, and of `advice` where that is another one, are filled in with the
    `values`; an `advice` that is a `Message` stands as it is.
    """
    code = which.partition("/")[0]
    says = Message(f"found/{which}", joint.worded, **values)
    if not isinstance(advice, Message):
        asked = f"advice/{advice or which}"
        known = asked if asked in english() else f"advice/{code}"
        advice = Message(known, joint.worded, **values)
    made = worded_finding(code, channel, span, value, says, advice)
    return replace(
        made,
        severity=severity or made.severity,
        unit=made.unit if unit is None else unit,
    )


def worded_finding(
    code: str,
    channel: str | None,
    span: tuple[float, float],
    value: float | None,
    says: Message,
    advice: Message,
) -> Finding:
    """A finding of a code's severity and unit that says and advises something of its own."""
    kind = KINDS[code]
    begin, end = span
    return Finding(
        code, kind.severity, channel, float(begin), float(end), value, kind.unit, says, advice
    )
