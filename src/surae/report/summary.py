"""A fit on one screen: as plain text, and as HTML for a notebook's cell."""

from html import escape

from surae.assessment import Assessment, ParameterEstimate
from surae.estimation import FitResult
from surae.report.formatting import estimate, percentage, significant
from surae.report.parameters import shown_parameters
from surae.report.wording import adequacy_words

_HEADINGS = ("parameter", "value", "95 % interval", "unit", "verdict", "meaning")
#: Colours of a verdict that can be told on white and on black.
_COLOURS = {"identified": "#1f8f4d", "weak": "#a86e00", "undetermined": "#a86e00",
            "at-bound": "#c0392b"}  # fmt: skip
_MARKS = {"adequate": "#1f8f4d", "doubtful": "#a86e00", "inadequate": "#c0392b"}


def fit_text(result: FitResult, assessment: Assessment) -> str:
    """The fit in some thirty lines: what it is worth, its parameters, what came of the search."""
    words = adequacy_words(assessment.adequacy)
    rows = [_HEADINGS, *(_row(p) for p in shown_parameters(assessment) if p.free)]
    widths = [max(len(row[place]) for row in rows) for place in range(len(_HEADINGS))]
    lines = [result.problem.spec.title, f"{words.mark} {words.sentence}"]
    lines += [f"  – {reason}" for reason in words.reasons]
    lines.append("")
    for row in rows:
        cells = (
            cell.rjust(width) if place in (1, 2) else cell.ljust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  ".join(cells).rstrip())
    lines += ["", *_closing(result, assessment)]
    return "\n".join(lines)


def fit_html(result: FitResult, assessment: Assessment) -> str:
    """The same as a table for a notebook, which asks nothing of the outside."""
    words = adequacy_words(assessment.adequacy)
    head = "".join(f"<th style='text-align:left'>{escape(text)}</th>" for text in _HEADINGS)
    body = []
    for p in shown_parameters(assessment):
        if not p.free:
            continue
        cells = _row(p)
        colour = _COLOURS.get(str(p.verdict), "inherit")
        styles = ["", "text-align:right", "text-align:right", "", f"color:{colour}", "opacity:.7"]
        body.append(
            "<tr>"
            + "".join(
                f"<td style='{style or 'text-align:left'}'>{escape(cell)}</td>"
                for cell, style in zip(cells, styles, strict=True)
            )
            + "</tr>"
        )
    reasons = "".join(f"<li>{escape(reason)}</li>" for reason in words.reasons)
    closing = "<br>".join(map(escape, _closing(result, assessment)))
    return (
        f"<div><strong>{escape(result.problem.spec.title)}</strong><br>"
        f"<span style='color:{_MARKS[words.grade]}'>{escape(f'{words.mark} {words.sentence}')}"
        f"</span><ul style='margin:0'>{reasons}</ul>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table>"
        f"<small>{closing}</small></div>"
    )


def _row(p: ParameterEstimate) -> tuple[str, ...]:
    text = estimate(p.value, p.trusted_sem, p.ci95)
    return p.name, text.value, text.interval, p.unit, str(p.verdict), p.meaning


def _closing(result: FitResult, assessment: Assessment) -> list[str]:
    fixed = [p for p in shown_parameters(assessment) if not p.free]
    lines = []
    if fixed:
        lines.append("fixed: " + ", ".join(f"{p.name} = {p.value:.4g}" for p in fixed))
    lines += [
        f"{each.name}: R² {percentage(each.r2)} %, VAF {percentage(each.vaf)} %, "
        f"RMSE {significant(each.rmse, 3)} Nm"
        for each in assessment.recordings
    ]
    lines.append(f"{result.status}: {result.message} ({result.seconds:.1f} s)")
    return lines
