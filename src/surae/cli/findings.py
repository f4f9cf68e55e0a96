"""Findings of the quality gate on the screen."""

import textwrap

from surae.api import Finding, Quality
from surae.cli.screen import show_line

#: Widest text [columns].
_MOST = 100
#: Of what stands before the text of a finding.
_INDENT = 9


def show_quality(quality: Quality, name: str) -> None:
    """Every finding in two or three lines: severity and span, what was found, what to do."""
    show_line(f"{name}: {quality.summary}")
    for finding in quality.findings:
        show_line("")
        show_line(_head(finding))
        for text in (finding.message, f"→ {finding.advice}"):
            show_line(_wrapped(text))
    if quality.skipped:
        show_line("")
        show_line("Not checked:")
        for skip in quality.skipped:
            show_line(_wrapped(f"{skip.check}: {skip.reason}"))
    show_line("")


def show_short(quality: Quality) -> None:
    """One line for a recording with findings that matter, and one for each of these."""
    if quality.clean:
        return
    show_line(f"{quality.recording}: {quality.summary}; see `surae check`")
    for finding in quality.findings:
        if finding.severity != "info":
            show_line(_wrapped(f"{finding.severity} {finding.code}: {finding.message}", 4))


def _head(finding: Finding) -> str:
    channel = f"  {finding.channel}" if finding.channel else ""
    span = f"{finding.start_s:.2f}–{finding.end_s:.2f} s"
    return f"{finding.severity:<{_INDENT - 2}}  {finding.code:<20}{span}{channel}"


def _wrapped(text: str, indent: int = _INDENT) -> str:
    space = " " * indent
    return textwrap.fill(text, _MOST, initial_indent=space, subsequent_indent=space)
