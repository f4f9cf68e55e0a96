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
#: How steps begin that are shown: what the user asked for, not what every fit does.
_REQUESTS = ("Weights: ", "Mass m ", "EMG normalised: ")
#: Width where stdout is no terminal and COLUMNS is not set.
_WIDTH = 132
#: Widths from which the interval stays on one line, and from which meanings have room.
_NARROW, _WIDE = 72, 130
#: Least width of a folded sentence, and a width that no table has.
_SENTENCE, _ANY = 24, 10_000


def show_fit(fit: "api.Fit") -> None:
    """Parameters with intervals and verdicts, what to do, and how well the torque is followed."""
    out = _console()
    wide, narrow = out.width >= _WIDE, out.width < _NARROW
    heads = ["parameter", "value", "95 % interval", "unit", "rep." if narrow else "repeats",
             "verdict", *["meaning"] * wide]  # fmt: skip
    rows: list[tuple[str | Text, ...]] = []
    for p in api.shown_parameters(fit.assessment):
        text = api.estimate(p.value, p.trusted_sem, p.ci95)
        rows.append((
            p.name, text.value, text.interval, p.unit, api.repeatable(p), _verdict(str(p.verdict)),
            *([p.meaning] if wide else []),
        ))  # fmt: skip
    show_line(fit.result.problem.spec.title)
    show_adequacy(fit.adequacy)
    right = {"value", "95 % interval"}
    _show_table(out, heads, rows, {*heads} - right, {"95 % interval"} if narrow else ())
    worded = fit.result.problem.options.anatomy.worded
    for line in (*_notes(fit, out.width), *_unknown(fit, out.width)):
        show_line(worded(line))
    _show_trials(fit, out)
    for quality in fit.assessment.recordings:
        show_line(
            f"{quality.name}: VAF {api.percentage(quality.vaf)} %"
            f"{_weighted(quality.vaf_weighted)}, centred R² {api.percentage(quality.r2)} %, "
            f"RMSE {api.significant(quality.rmse, 3)} Nm, "
            f"{quality.n} samples at {quality.rate_hz:g} Hz"
        )
        show_films(quality.name, quality.fascicles)
    if len(fit.assessment.recordings) > 1:
        show_line(f"all together: VAF {api.percentage(fit.vaf)} %{_weighted(fit.vaf_weighted)}")
    for line in _requests(fit):
        show_line(line)
    ipde = "none" if fit.ipde is None else f"{fit.ipde:.2f}"
    note = f" ({fit.assessment.ipde_note})" if fit.assessment.ipde_note else ""
    show_line(f"IPDE {ipde}{note}")
    if fit.covariance.names:
        note = fit.assessment.interval_note
        which = {"robust": "robust standard errors, as ", "thesis": "equation (34), as "}
        show_line(f"intervals: {which.get(fit.assessment.interval, '')}{note}")
    show_line(f"{fit.status}: {fit.message} ({fit.result.seconds:.2f} s)")


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


def show_adequacy(adequacy: "api.Adequacy") -> None:
    """What the whole fit is good for: a coloured sentence, and its reasons under it."""
    from rich.padding import Padding
    from rich.text import Text

    words = api.adequacy_words(adequacy)
    reasons = (Padding(Text(f"– {reason}"), (0, 0, 0, 2)) for reason in words.reasons)
    _print(
        _console(),
        Text(f"{words.mark} {words.sentence}", _STYLES[JUDGEMENTS[words.grade].role]),
        *reasons,
    )


def _weighted(vaf: float | None) -> str:
    """The VAF with samples counted as in the fit, where that is another."""
    return "" if vaf is None else f" (weighted {api.percentage(vaf)} %)"


def _requests(fit: "api.Fit") -> list[str]:
    """The settings in words: weights, the foot's mass, priors, the loss."""
    result = fit.result
    steps = (step for recording in result.problem.inputs for step in recording.steps)
    lines = [step for step in dict.fromkeys(steps) if step.startswith(_REQUESTS)]
    if result.problem.priors:
        lines.append(f"Priors on {', '.join(result.problem.priors)}.")
    if text := api.emphasis_text(result, fit.assessment):
        lines.append(text)
    return lines


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
    for film in films:
        facts = ", ".join(f"{label} {text}" for label, text in api.film_facts(film))
        show_line(f"{name}: {film.channel}: {facts}")


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


def _notes(fit: "api.Fit", width: int) -> list[str]:
    """Why parameters are not identified and what to do, one line for each reason."""
    reasons: dict[str, list[str]] = {}
    for p in fit.parameters.values():
        if p.verdict in ("weak", "undetermined", "at-bound"):
            reasons.setdefault(p.note, []).append(p.name)
    lines = []
    for note, names in reasons.items():
        lines += textwrap.wrap(f"{', '.join(names)}: {note}", width, subsequent_indent="    ")
    return ["Not identified:", *lines, ""] if lines else []


def _unknown(fit: "api.Fit", width: int) -> list[str]:
    """What to measure to know more, and which model the data support, of a fit with model auto."""
    helps = [f"– {line}" for line in api.what_would_help(fit.result, fit.assessment)]
    family = api.family_text(fit.result, fit.assessment)
    lines = [*(["What would help:"] if helps else []), *helps, *filter(None, [family])]
    folded = [part for line in lines for part in textwrap.wrap(line, width, subsequent_indent="  ")]
    return [*folded, ""] if folded else []


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
