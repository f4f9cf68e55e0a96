"""A fit on one screen: in a console, a notebook, and as `surae fit` shows it."""

import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import replace

from surae.base.formatting import (
    estimate,
    in_a_line,
    percentage,
    short,
    significant,
)
from surae.base.tables import TextTable
from surae.base.words import Message
from surae.inference import AssessedFit, Assessment
from surae.inference.judging.assessed import outdated
from surae.inference.judging.parameter import ParameterEstimate
from surae.measures.compute import judged_measures
from surae.measures.points import points
from surae.measures.table import LEADING
from surae.report.budget import what_would_help
from surae.report.invariants import invariants
from surae.report.laboratory import family_text
from surae.report.parameters import repeatable, shown_parameters
from surae.report.provenance import emphasis_text
from surae.report.recordings import film_lines
from surae.report.wording import adequacy_words

_HEADS = ("parameter", "value", "95 % interval", "unit", "repeats", "verdict", "meaning")
#: Measures that a screen leaves to the table of all.
_DETAILS = ("torque_gain", "working_point")
#: What intervals rest on that are wide for nothing the torque tells, by their note's code.
_RESTS = {
    "note/geometry": "Mostly by arms and paths, which no torque tells (film the muscle, or state a "
    "geometry)",
    "note/arm": "Mostly by the moment arm (state this person’s own)",
}
#: How steps begin that are shown: what the user asked for, not what every fit does.
_REQUESTS = ("Weights: ", "EMG normalised: ")


def fit_table(fit: AssessedFit, width: int = 100) -> TextTable:
    """What it is worth, its parameters, what to do, what came of the search.

    Sentences are folded to `width` columns.
    """
    result = fit.result
    assessment = fit.assessment
    words = adequacy_words(assessment.adequacy, fit.quality)
    listed = estimates_table(shown_parameters(assessment))
    groups = [_notes(assessment), _helps(fit), _closing(fit)]
    return replace(
        listed,
        above=(
            result.problem.spec.title,
            f"{words.mark} {words.sentence}",
            *(f"  – {reason}" for reason in words.reasons),
            *_leading(fit),
            *_invariant_lines(fit),
            *filter(None, [outdated(assessment)]),
        ),
        below=tuple(_folded(filter(None, groups), width)),
    )


def estimates_table(estimates: Iterable[ParameterEstimate]) -> TextTable:
    """Parameters, a row each, rounded to what is known of them."""
    rows = []
    for p in estimates:
        text = estimate(p.value, p.trusted_sem, p.ci95)
        rows.append(
            (
                p.name,
                text.value,
                text.interval,
                p.unit,
                repeatable(p),
                str(p.verdict),
                p.meaning,
            )
        )
    return TextTable(_HEADS, tuple(rows), numbers=("value", "95 % interval"))


def _invariant_lines(fit: AssessedFit) -> Iterator[str]:
    """What torque tells whatever arms and paths are, but for details: of one kind, a line."""
    of_kind: dict[str, list[str]] = {}
    for m in invariants(fit):
        if m.name.startswith(_DETAILS):
            continue
        assert m.value is not None
        name, _, at = m.name.partition("@")
        kind, _, which = name.rpartition("_")
        texts = of_kind.setdefault(kind, [])
        called = f"{f'_{which}' if texts else name}{f'@{at}' if at else ''}"
        texts.append(f"{in_a_line(called, m.value, m.ci95, m.unit)}: {m.verdict}")
    yield from ("; ".join(texts) for texts in of_kind.values())


def _leading(fit: AssessedFit) -> Iterator[str]:
    """Stiffness and torque at the end of the range that was moved, a line each."""
    wanted = tuple(each for each in points() if each.definition.name in LEADING)
    for _, m in judged_measures(fit, wanted):
        if m.value is not None and m.from_deg is not None and m.to_deg is not None:
            ends = dict.fromkeys((m.from_deg, m.to_deg))
            span = " to ".join(f"{short(round(end, 1))}°" for end in ends)
            yield f"{in_a_line(m.name, m.value, m.ci95, m.unit)}, {span}: {m.verdict}"


def _folded(groups: Iterable[list[str]], width: int) -> Iterator[str]:
    """The lines of every group, an empty one between two."""
    for number, group in enumerate(groups):
        yield from [""] * (number > 0)
        for line in group:
            yield from textwrap.wrap(line, width, subsequent_indent="    ")


def _notes(assessment: Assessment) -> list[str]:
    """Why parameters are not identified and what to do, one line for each reason."""
    reasons: dict[str, list[str]] = {}
    rests: dict[str, list[str]] = {}
    advised: dict[str, list[str]] = {}
    for p in assessment.parameters.values():
        if p.verdict in ("weak", "undetermined", "at-bound"):
            why = _RESTS.get(p.note.code) if isinstance(p.note, Message) else None
            if why is not None and isinstance(p.note, Message):
                low, high = (p.note.values[end] for end in ("low", "high"))
                rests.setdefault(why, []).append(f"{p.name} {low} to {high} %")
            elif (parted := _advised(p.note)) is not None:
                advice, known = parted
                advised.setdefault(advice, []).append(f"{p.name} {known}")
            else:
                reasons.setdefault(p.note, []).append(p.name)
    lines = [f"{', '.join(names)}: {note}" for note, names in reasons.items()]
    lines += [f"{', '.join(known)}: {advice}" for advice, known in advised.items()]
    lines += [f"{why}: {', '.join(spans)}" for why, spans in rests.items()]
    return ["Not identified:", *lines] if lines else []


def _advised(note: str) -> tuple[str, str] | None:
    """What to do and what is known, of a note that says both: several may ask for the same."""
    if not isinstance(note, Message):
        return None
    if note.code == "note/advised":
        return str(note.values["advice"]), str(note.values["known"])
    if note.code == "note/narrowed" and (inner := _advised(note.values["known"])) is not None:
        return inner[0], f"{inner[1]} (then about ±{note.values['percent']})"
    return None


def _helps(fit: AssessedFit) -> list[str]:
    """What to measure to know more, and which model the data support, of a fit with model auto."""
    helps = [f"– {line}" for line in what_would_help(fit)]
    family = family_text(fit)
    return [*(["What would help:"] if helps else []), *helps, *filter(None, [family])]


def _closing(fit: AssessedFit) -> list[str]:
    """How well each recording is followed, what was asked for, and how the search ended."""
    result = fit.result
    assessment = fit.assessment
    lines = []
    for each in assessment.recordings:
        lines.append(
            f"{each.name}: VAF {percentage(each.vaf)} %{_weighted(each.vaf_weighted)}, centred R² "
            f"{percentage(each.r2)} %, RMSE {significant(each.rmse, 3)} Nm, {each.n} samples at "
            f"{each.rate_hz:g} Hz"
        )
        lines += film_lines(each.name, each.fascicles)
    if len(assessment.recordings) > 1:
        both = f"VAF {percentage(assessment.vaf)} %{_weighted(assessment.vaf_weighted)}"
        lines.append(f"all together: {both}")
    steps = (step for recording in result.problem.inputs for step in recording.steps)
    lines += [step for step in dict.fromkeys(steps) if step.startswith(_REQUESTS)]
    if result.problem.priors:
        lines.append(f"Priors on {', '.join(result.problem.priors)}.")
    lines += filter(None, [emphasis_text(fit)])
    ipde = "none" if assessment.ipde is None else f"{assessment.ipde:.2f}"
    lines.append(f"IPDE {ipde}" + (f" ({assessment.ipde_note})" if assessment.ipde_note else ""))
    if assessment.covariance.names:
        which = {"robust": "robust standard errors, as ", "thesis": "equation (34), as "}
        how = which.get(assessment.interval, "")
        lines.append(f"intervals: {how}{assessment.interval_note}")
    lines.append(f"{result.status}: {result.message} ({result.seconds:.2f} s)")
    return lines


def _weighted(vaf: float | None) -> str:
    """The VAF with samples counted as in the fit, where that is another."""
    return "" if vaf is None else f" (weighted {percentage(vaf)} %)"
