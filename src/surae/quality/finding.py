"""What a check of a recording says, as plain data."""

from dataclasses import dataclass
from typing import Any, Literal

from surae.recording import MUSCLES, Channel
from surae.records import to_plain
from surae.tables import Tabular, TextTable

Severity = Literal["info", "warning", "error"]

#: From the least to the most severe.
SEVERITIES: tuple[Severity, ...] = ("info", "warning", "error")


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing to know about a recording before its fit is believed.

    Attributes
    ----------
    code : str
        What it is, e.g. ``"emg-flat"``; one of those that `surae.quality.registry.CHECKS` lists.
    severity : {"info", "warning", "error"}
        Worth knowing; makes estimates doubtful; makes them wrong.
    channel : str or None
        Role of the channel it is about, ``"time"``, or None where it is about the whole trial.
    start_s, end_s : float
        Span of time that it is about [s].
    value : float or None
        The number that it was judged by, in `unit`; None where there is none.
    unit : str
        Empty where there is no value, ``"1"`` for a ratio.
    message, advice : str
        One sentence each: what was found, and what to do.
    """

    code: str
    severity: Severity
    channel: str | None
    start_s: float
    end_s: float
    value: float | None
    unit: str
    message: str
    advice: str


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
        plain: dict[str, Any] = to_plain(self)
        return plain


def weight_of(muscle: str) -> str:
    """The parameter that weighs a muscle's EMG."""
    return f"g{MUSCLES.index(muscle) + 1}"


def quantity(value: float, channel: Channel) -> str:
    """A value of a channel with its unit; a normalised one has none."""
    return f"{value:.3g}" if channel.unit == "1" else f"{value:.3g} {channel.unit}"
