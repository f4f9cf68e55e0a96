"""The quality gate: what is wrong with a recording, before its fit is believed."""

from surae.quality.commanded import Commanded
from surae.quality.finding import CODES, KINDS, SEVERITIES, Finding, FindingKind, Quality, Skipped
from surae.quality.reading import commanded_file, recording_of, recording_or_findings
from surae.quality.registry import CHECKS, Check, check_recording, check_samples
from surae.quality.used import used

__all__ = [
    "CHECKS",
    "CODES",
    "KINDS",
    "SEVERITIES",
    "Check",
    "Commanded",
    "Finding",
    "FindingKind",
    "Quality",
    "Skipped",
    "check_recording",
    "check_samples",
    "commanded_file",
    "recording_of",
    "recording_or_findings",
    "used",
]
