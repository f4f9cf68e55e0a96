"""What a command shows on stdout: tables, and lines that never break over a closed pipe."""

import os
import sys
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich import box
from rich.cells import cell_len
from rich.console import Console, JustifyMethod
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from surae.api import estimate, percentage, significant
from surae.files import shown

if TYPE_CHECKING:  # a line is shown without the libraries that compute
    from surae.api import Adequacy, Comparison, Fit, Pooled, Prediction

#: Style of a verdict, by its text.
_STYLES = {
    "identified": "green", "weak": "yellow", "undetermined": "magenta", "at-bound": "red",
    "fixed": "dim", "holds": "green", "differs": "red", "cannot be checked": "yellow",
    "changed": "green", "no change shown": "yellow", "not comparable": "dim",
}  # fmt: skip
#: Style of the sentence on a whole fit, by its grade.
_GRADES = {"adequate": "green", "doubtful": "yellow", "inadequate": "bold red"}
#: How steps begin that are shown: what the user asked for, not what every fit does.
_TOLD = ("Weights: ", "Mass m ", "EMG normalised: ")
#: Width where stdout is no terminal and COLUMNS is not set.
_WIDTH = 132
#: Widths from which the interval stays on one line, and from which meanings have room.
_NARROW, _WIDE = 72, 130
#: Least width of a folded sentence, and a width that no table has.
_SENTENCE, _ANY = 24, 10_000


def show_fit(fit: "Fit") -> None:
    """Parameters with intervals and verdicts, what to do, and how well the torque is followed."""
    from surae.api import repeatable, shown_parameters

    out = _console()
    table = _table()
    table.add_column("parameter", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("95 % interval", justify="right", no_wrap=out.width >= _NARROW)
    table.add_column("unit", no_wrap=True)
    table.add_column("repeats" if out.width >= _NARROW else "rep.", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    if fit.snsem:
        table.add_column("snSEM", justify="right", no_wrap=True)
    if out.width >= _WIDE:
        table.add_column("meaning", no_wrap=True)
    for p in shown_parameters(fit.assessment):
        text = estimate(p.value, p.trusted_sem, p.ci95)
        verdict = Text(str(p.verdict), _STYLES[p.verdict])
        meaning = [p.meaning] if out.width >= _WIDE else []
        ratio = fit.snsem.get(p.name)
        against = ["–" if ratio is None else significant(ratio, 3)] if fit.snsem else []
        table.add_row(
            p.name, text.value, text.interval, p.unit, repeatable(p), verdict, *against, *meaning
        )
    show_line(fit.result.problem.spec.title)
    show_adequacy(fit.adequacy)
    _print(out, table)
    for line in (*_notes(fit, out.width), *_unknown(fit, out.width)):
        show_line(line)
    _show_trials(fit, out)
    for quality in fit.assessment.recordings:
        show_line(
            f"{quality.name}: VAF {percentage(quality.vaf)} %{_weighted(quality.vaf_weighted)}, "
            f"centred R² {percentage(quality.r2)} %, "
            f"RMSE {significant(quality.rmse, 3)} Nm, "
            f"{quality.n} samples at {quality.rate_hz:g} Hz"
        )
    if len(fit.assessment.recordings) > 1:
        show_line(f"all together: VAF {percentage(fit.vaf)} %{_weighted(fit.vaf_weighted)}")
    for line in _told(fit):
        show_line(line)
    ipde = "none" if fit.ipde is None else f"{fit.ipde:.2f}"
    note = f" ({fit.assessment.ipde_note})" if fit.assessment.ipde_note else ""
    show_line(f"IPDE {ipde}{note}")
    if fit.covariance.names:
        note = fit.assessment.interval_note
        which = {"robust": "robust standard errors, as ", "thesis": "equation (34), as "}
        show_line(f"intervals: {which.get(fit.assessment.interval, '')}{note}")
    show_line(f"{fit.status}: {fit.message} ({fit.result.seconds:.2f} s)")


def _show_trials(fit: "Fit", out: Console) -> None:
    """What each recording of a joint fit says by itself, and how much they differ."""
    from surae.api import trials_section

    section = trials_section(fit.result, fit.assessment)
    if section is None:
        return
    table = _table()
    for name in ("parameter", "together", *section.recordings, "spread", "unit"):
        outer = name in ("parameter", "unit")
        table.add_column(name, justify="left" if outer else "right", overflow="fold")
    for row in section.rows:
        table.add_row(row.name, row.value, *row.each, row.spread, row.unit or "-")
    _print(out, table)
    show_line("\n".join([*textwrap.wrap(section.text, out.width), ""]))


def show_adequacy(adequacy: "Adequacy") -> None:
    """What the whole fit is good for: a coloured sentence, and its reasons under it."""
    from surae.api import adequacy_words

    out, words = _console(), adequacy_words(adequacy)
    with out.capture() as captured:
        out.print(Text(f"{words.mark} {words.sentence}", _GRADES[words.grade]))
        for reason in words.reasons:
            out.print(Padding(Text(f"– {reason}"), (0, 0, 0, 2)))
    _write("".join(f"{line.rstrip()}\n" for line in captured.get().splitlines()))


def _weighted(vaf: float | None) -> str:
    """The VAF with samples counted as in the fit, where that is another."""
    return "" if vaf is None else f" (weighted {percentage(vaf)} %)"


def _told(fit: "Fit") -> list[str]:
    """What the fit was told beside its recordings: weights, the foot's mass, priors, the loss."""
    from surae.api import MANY_OUTLIERS

    result = fit.result
    steps = (step for recording in result.problem.inputs for step in recording.steps)
    lines = [step for step in dict.fromkeys(steps) if step.startswith(_TOLD)]
    if result.problem.priors:
        lines.append(f"Priors on {', '.join(result.problem.priors)}.")
    if result.outliers is not None:
        lines.append(
            f"Loss {result.outliers.loss}: {significant(100 * result.outliers.share, 2)} % of the "
            f"samples count less than half; noise {significant(result.outliers.scale, 3)} Nm."
        )
        if result.outliers.share > MANY_OUTLIERS:
            lines.append("So many are no stray artefacts: the model leaves something out.")
    return lines


def show_predictions(
    predictions: "Sequence[Prediction]", paths: Sequence[str], together: "Pooled | None" = None
) -> None:
    """How well recordings are predicted, each under the path it was given by, and all together."""
    table = _table()
    table.add_column("recording", overflow="fold")
    for heading in ("VAF [%]", "RMSE [Nm]", "bias [Nm]"):
        table.add_column(heading, justify="right", no_wrap=True)
    for path, prediction in zip(paths, predictions, strict=True):
        table.add_row(Text(shown(path)), *_figures(prediction))
    if together is not None:
        table.add_row("all together", *_figures(together))
    _print(_console(), table)
    for path, prediction in zip(paths, predictions, strict=True):
        if (judged := prediction.adequacy) is not None:
            why = "; ".join(judged.reasons) or "it errs no more than the fit promises"
            show_line(f"{shown(path)}: {judged.grade}: {why}")


def _figures(prediction: "Prediction | Pooled") -> tuple[str, str, str]:
    return (
        percentage(prediction.vaf),
        significant(prediction.rmse, 3),
        significant(prediction.bias, 3),
    )


def show_comparison(comparison: "Comparison") -> None:
    """Figures of every model, what follows, what weakens it, and the parameters it changes."""
    out, table = _console(), _table()
    table.add_column("model", no_wrap=True)
    for heading in ("free", "VAF [%]", "RMSE [Nm]", "ΔAICc", "nominal", "held-out VAF [%]"):
        table.add_column(heading, justify="right", no_wrap=True)
    for score in comparison.models:
        held = score.held_out
        predicted = "–" if held is None else f"{percentage(held.vaf)} ± {held.spread:.2f}"
        table.add_row(
            score.model,
            str(score.n_free),
            "–" if score.vaf is None else percentage(score.vaf),
            "–" if score.rmse is None else significant(score.rmse, 3),
            *("–" if d is None else f"{d:.1f}" for d in (score.delta, score.delta_plain)),
            predicted,
        )
    _print(out, table)
    lines = [comparison.conclusion, *comparison.cautions]
    if comparison.n_effective is not None:
        lines.append(
            f"ΔAICc counts the {comparison.n} samples as {comparison.n_effective:.0f} independent "
            f"ones, as the residual is correlated over time; nominal: as {comparison.n}."
        )
    lines.append(f"Held out: {comparison.scheme}")
    for line in lines:
        _write("\n".join(textwrap.wrap(line, out.width, subsequent_indent="    ")) + "\n")
    _show_changes(comparison, out)


def _show_changes(comparison: "Comparison", out: Console) -> None:
    """The parameters that the best muscle-tendon model changes by more than their intervals."""
    if comparison.compliant is None:
        return
    model = comparison.compliant.model
    table = _table()
    for heading in ("parameter", "rigid", "compliant", "unit", "change", "±"):
        aligned = "left" if heading in ("parameter", "unit") else "right"
        table.add_column(heading, justify=aligned, no_wrap=True)  # type: ignore[arg-type]
    for c in comparison.changes:
        if c.model == model:
            percent = "–" if c.percent is None else f"{c.percent:+.1f} %".replace("-", "−")
            half = f"{abs(100 * c.half_width / c.rigid):.1f} %" if c.rigid else "–"
            values = (significant(c.rigid, 4), significant(c.compliant, 4))
            table.add_row(c.parameter, *values, c.unit, percent, half)
    if table.row_count:
        show_line(f"\nParameters that {model} changes by more than their 95 % intervals:")
        _print(out, table)


def show_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table of numbers between what they are of, on the left, and their unit, on the right."""
    table = _table()
    for place, heading in enumerate(headings):
        outer = place in (0, len(headings) - 1)
        table.add_column(heading, justify="left" if outer else "right", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))  # as they are: "Moment [Nm]" is no markup
    _print(_console(), table)


def show_verdicts(
    headings: Sequence[str], rows: Sequence[Sequence[str]], numbers: Sequence[str] = ()
) -> None:
    """A table of texts, the last one a verdict; those headed by one of `numbers` to the right.

    Sentences are folded to the width. Names, numbers and verdicts are whole at any width, so that
    they can be read and copied: a terminal that is narrower folds the lines itself.
    """
    out, table = _console(), _table()
    for column, heading in enumerate(headings):
        cells = [row[column] for row in rows]
        if heading in numbers or column == len(headings) - 1 or not any(" " in c for c in cells):
            least = max(map(cell_len, (heading, *cells)))
            side: JustifyMethod = "right" if heading in numbers else "left"
            table.add_column(heading, justify=side, no_wrap=True, min_width=least)
        else:
            table.add_column(heading, overflow="fold", min_width=_SENTENCE)
    for row in rows:
        table.add_row(*(Text(cell) for cell in row[:-1]), Text(row[-1], _STYLES.get(row[-1], "")))
    roomy = out.options.update(max_width=_ANY)
    out.width = max(out.width, Measurement.get(out, roomy, table).minimum)
    _print(out, table)


def show_line(text: str) -> None:
    """One line, folded on a terminal. When the reader has gone, the work goes on unseen."""
    _write(text + "\n")


def _notes(fit: "Fit", width: int) -> list[str]:
    """Why parameters are not identified and what to do, one line for each reason."""
    reasons: dict[str, list[str]] = {}
    for p in fit.parameters.values():
        if p.verdict in ("weak", "undetermined", "at-bound"):
            reasons.setdefault(p.note, []).append(p.name)
    lines = []
    for note, names in reasons.items():
        lines += textwrap.wrap(f"{', '.join(names)}: {note}", width, subsequent_indent="    ")
    return ["Not identified:", *lines, ""] if lines else []


def _unknown(fit: "Fit", width: int) -> list[str]:
    """What to measure to know more, and which model the data support, of a fit with model auto."""
    from surae.api import family_section, what_would_help

    helps = [f"– {line}" for line in what_would_help(fit.result, fit.assessment)]
    family = family_section(fit.result, fit.assessment)
    lines = [*(["What would help:"] if helps else []), *helps, *([family.text] if family else [])]
    folded = [part for line in lines for part in textwrap.wrap(line, width, subsequent_indent="  ")]
    return [*folded, ""] if folded else []


def _table() -> Table:
    return Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)


def _console() -> Console:
    """Make a console of the terminal's width, or COLUMNS, or enough for a table in a file."""
    if sys.stdout.isatty():
        return Console()
    columns = os.environ.get("COLUMNS", "")
    return Console(width=int(columns) if columns.isdecimal() and int(columns) else _WIDTH)


def _print(out: Console, table: Table) -> None:
    with out.capture() as captured:
        out.print(table)
    _write("\n" + "".join(f"{line.rstrip()}\n" for line in captured.get().splitlines()) + "\n")


def _write(text: str) -> None:
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
