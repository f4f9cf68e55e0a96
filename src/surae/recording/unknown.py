"""What to say of a text that is not understood: which export it likely is, and its heading."""

import itertools
import re
from collections.abc import Sequence

from surae.recording.headings import DELIMITERS, numeric
from surae.recording.roles import TIMES
from surae.recording.rows import is_clock
from surae.recording.source import HEAD, Source
from surae.recording.table import Table, some

#: Programs by what their exports' first lines hold, and how they export what is read.
_EXPORTS: Sequence[tuple[str, str, str]] = (
    (r"Application:.*Trigno Discover|Trigno Discover", "Delsys Trigno Discover", "Export, CSV"),
    (
        r"^ExcelDateTime=|^ChannelTitle=",
        "LabChart",
        "File, Export, text with channel titles, or MATLAB",
    ),
    (r"BIODEX|Biodex|POS \(ANAT\)", "Biodex", "the research toolkit, ASCII with the row of names"),
    (r"OpenSignals Text File", "OpenSignals", "File, Save, text or EDF"),
    (r"%OpenBCI", "OpenBCI", "its GUI, BDF or CSV"),
    (r"^NO_OF_(FRAMES|SAMPLES|CHANNELS)", "Qualisys", "File, Export, MAT, C3D or TSV with headers"),
    (r"Analog R/C ASCII", "Motion Analysis Cortex", "Export, C3D or ANC"),
    (
        r"msec/sample|samples? per second",
        "AcqKnowledge",
        "File, Save As, text with headers, or MATLAB",
    ),
    (r"^%time,field\.", "rostopic echo -p", "one topic a file, with its names"),
    (r"Noraxon|MR3", "Noraxon MR3", "Export, CSV or MATLAB"),
    (r"BTS|Measure unit:", "BTS", "Export, C3D or EMT"),
    (r"participant_id", "a list of participants (BIDS)", "give the recordings themselves"),
    (r"onset\s+duration", "a list of events (BIDS)", "give the recordings themselves"),
)


def export_of(source: Source) -> str:
    """Which program's export a text likely is by its first lines, and how it exports what is read.

    Empty where nothing says it.
    """
    if _is_binary(source):
        return ""
    first = "\n".join(itertools.islice(source.head(), 60))
    for pattern, what, how in _EXPORTS:
        if re.search(pattern, first, re.MULTILINE):
            return f"likely {what} (how it exports what is read: {how})"
    return ""


def _is_binary(source: Source) -> bool:
    return b"\0" in source.data[:HEAD]


def likely_heading(source: Source) -> str:
    """The row that looks like the names of columns; empty where none does."""
    if _is_binary(source):
        return ""
    most: tuple[int, int, str] = (1, 0, "")
    for number, line in enumerate(itertools.islice(source.head(), 400), start=1):
        for delimiter in DELIMITERS:
            cells = [cell.strip() for cell in line.split(delimiter)]
            words = [c for c in cells if c and not numeric(c.replace(",", ".")) and not is_clock(c)]
            if len(words) == len([c for c in cells if c]) and len(words) > most[0]:
                most = (len(words), number, line.strip())
    shown = most[2] if len(most[2]) <= 80 else most[2][:77] + "..."
    return f"row {most[1]} looks like the names of columns: {shown!r}" if most[1] else ""


def not_understood(source: Source, table: Table) -> str:
    """One sentence on a text in which no times and no signals are known."""
    likely = export_of(source)
    named = [name for name in table.names if name]
    heading = likely_heading(source)
    row = "" if table.header is None else f"row {table.header}: "
    parts = [f"{source.shown}: {row}missing column {' or '.join(list(TIMES)[:2])}"]
    if likely:
        parts.append(likely)
    if heading and (table.header is None or not heading.startswith(f"row {table.header} ")):
        parts.append(heading)
    parts.append(f"columns found: {some(named)}")
    if (clock := table.offered) is not None and clock.unit:
        parts.append(
            f"column {clock.column!r} may be the time in {clock.unit}: {clock.rule}; call it "
            f"time_{clock.unit}, or `surae inspect FILE --output MAP.toml` writes a mapping that "
            "says so"
        )
    parts.append(
        "a recording is a CSV with such columns, or a TOML mapping of other files, which may say "
        'time = "COLUMN", or rate_hz and start_s'
    )
    return "; ".join(parts)
