"""What a command shows on stdout: tables, and lines that never break over a closed pipe."""

import os
import sys
import textwrap
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from surae import api
from surae.files import shown
from surae.tables import TextTable
from surae.words import JUDGEMENTS

if TYPE_CHECKING:  # rich comes with the first table
    from rich.console import Console, OverflowMethod, RenderableType
    from rich.table import Table
    from rich.text import Text

#: What a table says: its headings, and the texts of its rows.
Columns = tuple[tuple[str, ...], list[tuple[str, ...]]]
#: Style of a word that judges.
_STYLES = {"good": "green", "weak": "yellow", "bad": "red", "quiet": "dim"}
#: Width where stdout is no terminal and COLUMNS is not set.
_WIDTH = 132
#: Widths from which the interval stays on one line, and from which meanings have room.
_NARROW, _WIDE = 72, 130
#: Least width of a folded sentence, and a width that no table has.
_SENTENCE, _ANY = 24, 10_000


def show_fit(fit: "api.Fit") -> None:
    """What a fit is worth, its parameters with intervals and verdicts, and what to do."""
    from rich.text import Text

    out = _console()
    wide, narrow = out.width >= _WIDE, out.width < _NARROW
    table = api.fit_table(fit.result, fit.assessment, out.width)
    columns = [k for k, head in enumerate(table.heads) if wide or head != "meaning"]
    heads = [table.heads[k] for k in columns]
    rows = [
        [_verdict(row[k]) if table.heads[k] == "verdict" else row[k] for k in columns]
        for row in table.rows
    ]
    title, judged, *reasons = table.above
    role = JUDGEMENTS[str(fit.adequacy.grade)].role
    _print(out, Text(title), Text(judged, _STYLES[role]), *map(Text, reasons))
    left, folded = {*heads} - {*table.numbers}, {"95 % interval"} if narrow else ()
    _show_table(out, heads, rows, left, folded)
    _show_trials(fit, out)
    for line in table.below:
        show_line(line)


def _show_trials(fit: "api.Fit", out: "Console") -> None:
    """What each recording of a joint fit says by itself, and how much they differ."""
    for section in api.trials_section(fit.result, fit.assessment):
        for block in section.blocks:
            if isinstance(block, api.TableBlock):
                heads = [column.head for column in block.columns]
                rows = [
                    [cell if isinstance(cell, str) else cell.text for cell in row]
                    for _, group in block.groups
                    for row in group
                ]
                _show_table(out, heads, rows, heads[:2], heads)
            elif isinstance(block, api.TextBlock):
                show_line("\n".join([*textwrap.wrap(block.text, out.width), ""]))


def show_predictions(predictions: "Sequence[api.Prediction]", paths: Sequence[str]) -> None:
    """How well recordings are predicted, each under the path it was given by."""
    named = list(zip(map(shown, paths), predictions, strict=True))
    rows = [
        (name, api.percentage(p.vaf), api.significant(p.rmse, 3), api.significant(p.bias, 3))
        for name, p in named
    ]
    heads = ("recording", "VAF [%]", "RMSE [Nm]", "bias [Nm]")
    _show_table(_console(), heads, rows, {"recording"}, {"recording"})
    for name, prediction in named:
        if (judged := prediction.adequacy) is not None:
            why = "; ".join(judged.reasons) or "it errs no more than the fit promises"
            show_line(f"{name}: {judged.grade}: {why}")
        show_films(name, [film.quality for film in prediction.fascicles])


def show_films(name: str, films: "Sequence[api.FascicleQuality]") -> None:
    """How well each film of a recording is followed."""
    for line in api.film_lines(name, films):
        show_line(line)


def show_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table of numbers between what they are of, on the left, and their unit, on the right."""
    _show_table(_console(), headings, rows, {headings[0], headings[-1]})


def show_answer(table: TextTable) -> None:
    """A table of an answer with the lines above and below it."""
    for line in table.above:
        show_line(line)
    show_verdicts(table.heads, table.rows, table.numbers)
    for line in table.below:
        show_line(line)


def show_verdicts(
    headings: Sequence[str], rows: Sequence[Sequence[str]], numbers: Sequence[str] = ()
) -> None:
    """A table of texts, the last one a verdict; those headed by one of `numbers` to the right.

    Sentences are folded to the width. Names, numbers and verdicts are whole at any width, so that
    they can be read and copied: a terminal that is narrower folds the lines itself.
    """
    from rich.cells import cell_len
    from rich.measure import Measurement
    from rich.text import Text

    out, table = _console(), _table()
    for column, heading in enumerate(headings):
        cells = [row[column] for row in rows]
        if heading in numbers or column == len(headings) - 1 or not any(" " in c for c in cells):
            least = max(map(cell_len, (heading, *cells)))
            table.add_column(
                heading, justify=_side(heading not in numbers), no_wrap=True, min_width=least
            )
        else:
            table.add_column(heading, overflow="fold", min_width=_SENTENCE)
    for row in rows:
        table.add_row(*map(Text, row[:-1]), _verdict(row[-1]))
    roomy = out.options.update(max_width=_ANY)
    out.width = max(out.width, Measurement.get(out, roomy, table).minimum)
    _print(out, "", table, "")


def ends_text(ends: Sequence[float | None] | None) -> str:
    """An interval, either end of which may be open; a dash where there is none."""
    if ends is None:
        return api.NO_NUMBER
    return " … ".join("open" if end is None else api.significant(end, 4) for end in ends)


def show_line(text: str) -> None:
    """One line, folded on a terminal. When the reader has gone, the work goes on unseen."""
    try:
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def show_files(paths: Mapping[str, str | None]) -> None:
    """A line for each requested file: what it is, and where."""
    for what, path in paths.items():
        if path is not None:
            show_line(f"{what}: {shown(path)}")


def _verdict(text: str) -> "Text":
    from rich.text import Text

    return Text(text, _STYLES[JUDGEMENTS[text].role] if text in JUDGEMENTS else "")


def _side(left: bool) -> Literal["left", "right"]:
    return "left" if left else "right"


def _table() -> "Table":
    from rich import box
    from rich.table import Table

    return Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)


def _show_table(
    out: "Console",
    headings: Sequence[str],
    rows: "Sequence[Sequence[str | Text]]",
    left: Collection[str],
    folded: Collection[str] = (),
) -> None:
    """A table whose columns are aligned to the right, or the `left`; `folded` ones wrap."""
    from rich.text import Text

    table = _table()
    for heading in headings:
        fold, side = heading in folded, _side(heading in left)
        overflow: OverflowMethod = "fold" if fold else "ellipsis"
        table.add_column(heading, justify=side, no_wrap=not fold, overflow=overflow)
    for row in rows:  # texts as they are: "Moment [Nm]" is no markup
        table.add_row(*(Text(cell) if isinstance(cell, str) else cell for cell in row))
    _print(out, "", table, "")


def _console() -> "Console":
    """Make a console of the terminal's width, or COLUMNS, or enough for a table in a file."""
    from rich.console import Console

    if sys.stdout.isatty():
        return Console()
    columns = os.environ.get("COLUMNS", "")
    return Console(width=int(columns) if columns.isdecimal() and int(columns) else _WIDTH)


def _print(out: "Console", *parts: "RenderableType") -> None:
    with out.capture() as captured:
        for part in parts:
            out.print(part)
    show_line("\n".join(line.rstrip() for line in captured.get().splitlines()))
