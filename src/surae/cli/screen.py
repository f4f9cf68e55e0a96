"""What a command shows on stdout: tables, and lines that never break over a closed pipe."""

import os
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from surae import api
from surae.base.files import shown
from surae.base.tables import TextTable
from surae.base.words import JUDGEMENTS

if TYPE_CHECKING:  # rich comes with the first table
    from rich.console import Console

#: What commands of other distributions are made of.
__all__ = ["show_line", "show_table"]

#: Style of a word that judges.
_STYLES = {"good": "green", "weak": "yellow", "bad": "red", "quiet": "dim"}
#: Width where stdout is no terminal and COLUMNS is not set.
_WIDTH = 132
#: Width from which meanings of parameters have room.
_WIDE = 130
#: Least width of a folded sentence, and a width that no table has.
_SENTENCE = 24
_ANY = 10_000


def show_fit(fit: "api.Fit") -> None:
    """What a fit is worth, its parameters with intervals and verdicts, and what to do."""
    width = _console().width
    table = api.fit_table(fit, width)
    if width < _WIDE:
        kept = [k for k, head in enumerate(table.heads) if head != "meaning"]
        heads, *rows = (tuple(row[k] for k in kept) for row in (table.heads, *table.rows))
        table = replace(table, heads=heads, rows=tuple(rows))
    show_answer(table)


def show_predictions(predictions: "Sequence[api.Prediction]", paths: Sequence[str]) -> None:
    """How well recordings are predicted, each under the path it was given by."""
    named = list(zip(map(shown, paths), predictions, strict=True))
    rows = [
        (name, api.percentage(p.vaf), api.significant(p.rmse, 3), api.significant(p.bias, 3))
        for name, p in named
    ]
    heads = ("recording", "VAF [%]", "RMSE [Nm]", "bias [Nm]")
    show_table(heads, rows, heads[1:])
    for name, p in named:
        _show_promise(name, p)
    for name, prediction in named:
        if (judged := prediction.adequacy) is not None:
            why = "; ".join(judged.reasons) or "it errs no more than the fit promises"
            show_line(f"{name}: {judged.grade}: {why}")
        for line in api.film_lines(name, [film.quality for film in prediction.fascicles]):
            show_line(line)


def _show_promise(name: str, p: "api.Prediction") -> None:
    """How wide a predicted torque's interval is, what it covers, and what knows no model."""
    if p.doubt is not None and p.covers is not None:
        half = api.significant(float(p.doubt.half_width.mean()), 2)
        show_line(
            f"{name}: 95 % interval of the torque ± {half} Nm on average; it holds "
            f"{api.percentage(p.covers)} % of the samples"
        )
    for text in (api.of_movement([p]), api.beside(p)):
        if text:
            show_line(f"{name}: {text}")


def show_answer(table: TextTable) -> None:
    """A table of an answer with the lines above and below it."""
    for line in table.above:
        show_line(line)
    show_table(table.heads, table.rows, table.numbers)
    for line in table.below:
        show_line(line)


def show_table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], numbers: Collection[str] = ()
) -> None:
    """A table of texts; columns headed by one of `numbers` are aligned to the right.

    Sentences are folded to the width. Names, numbers and verdicts are whole at any width, so that
    they can be read and copied: a terminal that is narrower folds the lines itself.
    """
    from rich import box
    from rich.cells import cell_len
    from rich.measure import Measurement
    from rich.table import Table
    from rich.text import Text

    if not rows:
        return
    out = _console()
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for heading, *cells in zip(headings, *rows, strict=True):
        longest = max(map(cell_len, (heading, *cells)))
        head = Text(heading)
        if heading in numbers:
            table.add_column(head, justify="right", no_wrap=True, min_width=longest)
        else:  # a path has no space to be folded at
            table.add_column(head, overflow="fold", min_width=min(longest, _SENTENCE))
    for row in rows:  # texts as they are: "Moment [Nm]" is no markup
        table.add_row(
            *(
                Text(cell, _STYLES[JUDGEMENTS[cell].role] if cell in JUDGEMENTS else "")
                for cell in row
            )
        )
    roomy = out.options.update(max_width=_ANY)
    out.width = max(out.width, Measurement.get(out, roomy, table).minimum)
    with out.capture() as captured:
        out.print(table)
    lines = (line.rstrip() for line in captured.get().splitlines())
    show_line("\n".join(["", *lines, ""]))


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


def _console() -> "Console":
    """Make a console of the terminal's width, or COLUMNS, or enough for a table in a file."""
    from rich.console import Console

    if sys.stdout.isatty():
        return Console()
    columns = os.environ.get("COLUMNS", "")
    return Console(width=int(columns) if columns.isdecimal() and int(columns) else _WIDTH)
