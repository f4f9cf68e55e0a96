"""A session's report: the leg's page first, then its trials, measures and fits."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.formatting import NO_NUMBER, estimate, of_interval, percentage, signed, significant
from surae.measures import Measure, Measures
from surae.model.joint import ANKLE
from surae.quality import Finding, Quality
from surae.report.budget import budget_of, budget_section
from surae.report.clinical import numbers_section
from surae.report.document import (
    Block,
    Document,
    PictureBlock,
    SectionBlock,
    SignalsBlock,
    TableBlock,
    TableCell,
    TableRow,
    TextBlock,
    columns,
    paragraphs,
    rows_of,
    verdict,
)
from surae.report.figures import Figure
from surae.report.figures.budget import budget_figure
from surae.report.figures.film import film_figure
from surae.report.figures.joint import relabelled
from surae.report.figures.session import trials_figure
from surae.report.figures.style import WIDTH
from surae.report.figures.torques import fit_figure
from surae.report.joint import reworded
from surae.report.leg import AssessedFit, is_known, leg_answers
from surae.report.parameters import parameters_section, shown_parameters
from surae.report.recordings import film_block
from surae.report.traces import traces_of
from surae.trials import Crossed, Trial, common_errors

_USES = {
    "fit": "fitted",
    "hold": "angle and torque of a hold",
    "reference": "reference of EMG",
    "none": "not used",
}


@dataclass(frozen=True, slots=True)
class TrialRow:
    """One trial in words."""

    name: str
    what: str
    why: str
    use: str
    findings: str
    worst: str
    alone: TableCell
    together: TableCell
    problem: str


@dataclass(frozen=True, slots=True)
class SessionReport:
    """A session's report: its document, and its figures by name."""

    document: Document
    figures: Mapping[str, Figure]


def session_report(
    name: str,
    about: Mapping[str, str | None],
    trials: Sequence[Trial],
    fits: Mapping[str, AssessedFit],
    joint: AssessedFit | None,
    *,
    joined: Sequence[str],
    failed: Mapping[str, str],
    quality: Mapping[str, Quality],
    predictions: Mapping[str, Mapping[str, Crossed]],
    joint_predictions: Mapping[str, Crossed],
    created: datetime,
    interrupted: bool = False,
    before: AssessedFit | None = None,
) -> SessionReport:
    """The leg's page: four answers, then details, then research.

    Parameters
    ----------
    name : str
        Of the session.
    about : mapping of str to (str or None)
        Side, date, condition, notes.
    trials : sequence of Trial
        All of them.
    fits, joint
        Each trial's fit, and that of all together.
    joined : sequence of str
        Trials of the joint fit.
    failed : mapping of str to str
        Why a trial has no fit or is not in the joint one.
    quality : mapping of str to Quality
        What was found in each trial.
    predictions, joint_predictions
        How each fit, and the joint one, follow each trial.
    created : datetime
        When the report is made.
    interrupted : bool
        Whether the user stopped before the end.
    before : (FitResult, Assessment), optional
        The fit of an earlier visit.

    Returns
    -------
    SessionReport
        For a page, for paper, or for a part of another page.
    """
    alone = {trial: assessment for trial, (_, assessment) in fits.items()}
    shown = joint or (next(iter(fits.values())) if len(fits) == 1 else None)
    contradicted = contradictions(alone, None if joint is None else joint[1])
    answers = leg_answers(trials, fits, shown, contradicted=tuple(contradicted), before=before)
    figures: dict[str, Figure] = dict(answers.figures)
    warnings = []
    if interrupted:
        warnings.append("This run was stopped: only fits that were complete are used. The same "
                        "command continues it.")  # fmt: skip
    if joint is None and len(fits) > 1 and failed.get("joint"):
        warnings.append(f"No fit of all trials together: {failed['joint']}.")
    warnings += common_errors(quality[trial] for trial in fits if trial in quality)
    details = [_trials_section(trials, alone, failed, quality, joint_predictions)]
    research: list[SectionBlock] = []
    if shown is not None:
        figures["torques"] = fit_figure(
            shown[0], [f"R² {percentage(each.r2)} %" for each in shown[1].recordings]
        )
        details.append(_torques_section())
        if answers.measures is not None:
            details.append(numbers_section(answers.measures, answers.at))
            research.append(_measures_section(answers.measures))
        for number, trial in enumerate(traces_of(shown[0])):
            for place, film in enumerate(trial.films):
                drawn = f"film-{number}-{place}"
                figures[drawn] = film_figure(trial, film)
                details.append(film_block(drawn, film))
        budget = budget_of(*shown)
        if budget.rows:
            figures["budget"] = budget_figure(budget)
        research += [parameters_section(*shown, next_anchor=""), budget_section(budget)]
    details.append(_findings_section(quality))
    if rows := _parameters(alone, None if joint is None else joint[1], contradicted):
        figures["trials"] = session_figure(alone, None if joint is None else joint[1], width=WIDTH)
        research.append(_by_trial_section(rows, tuple(alone), contradicted, has_joint=bool(joint)))
    if predictions:
        research.append(_crossed_section(predictions, joint_predictions, trials))
    if joined:
        research.append(_signals_section(joined))
    side = f"{about['side']} leg" if about.get("side") else ""
    subtitle = [side, *(text for key, text in about.items() if text and key != "side")]
    document = Document(
        kicker=", ".join(filter(None, subtitle)),
        heading=name,
        under=f"{_summary(trials, fits, joined)} Report of {created:%Y-%m-%d %H:%M}.",
        title=name,
        blocks=(
            *paragraphs(warnings, "warning"),
            SectionBlock("", answers.blocks, look="leg"),
            SectionBlock("Details", tuple(details), "details", "more"),
            SectionBlock("Research", tuple(research), "research", "more"),
        ),
        footer="Made by surae for research.",
    )
    anatomy = ANKLE if shown is None else shown[0].problem.options.anatomy
    own = dict(relabelled(anatomy, figures.items()))
    return SessionReport(reworded(anatomy, document), own)


def _trials_section(
    trials: Sequence[Trial],
    alone: Mapping[str, Assessment],
    failed: Mapping[str, str],
    quality: Mapping[str, Quality],
    joint: Mapping[str, Crossed],
) -> SectionBlock:
    every = [trial_row(t, alone.get(t.name), joint.get(t.name), failed, quality) for t in trials]
    rows: Iterator[TableRow] = (
        (
            row.name,
            TableCell(row.what, meaning=row.problem or row.why),
            row.use,
            TableCell(badge=(f"severity {row.worst}", row.worst)
                 if row.worst in ("error", "warning") else None, meaning=row.findings),
            row.alone,
            row.together,
        )
        for row in every
    )  # fmt: skip
    heads = columns("Trial", "What it is", "Used for", "Check", "Alone, R² [%]",
                    "All together, R² [%]", numbers=(4, 5), wide=(1, 3),
                    looks={0: "column", 1: "what"})  # fmt: skip
    note = (
        "R² is of the torque’s changes; a hold has none. A shaded cell is a trial that was in the "
        "fit: following it proves nothing."
    )
    table = TableBlock("What each trial is, and how it is followed", heads, rows_of(rows))
    holds = [t for t in trials if t.hold is not None]
    blocks: list[Block] = [table, TextBlock(note, "note")]
    if holds:
        heads = columns("Held", "Effort", "Angle [°]", "Torque [Nm]", "Predicted [Nm]",
                        numbers=(2, 3, 4))  # fmt: skip
        points = rows_of(_hold(t, joint.get(t.name)) for t in holds)
        blocks.append(TableBlock("Torque of trials that hold still", heads, points))
    return SectionBlock("Trials", tuple(blocks), "trials")


def _torques_section() -> SectionBlock:
    picture = PictureBlock(
        "torques",
        "Measured torque of each trial, and the model’s.",
        "Measured torque (wide, pale) and the model’s (thin, dark), with its R².",
        "here",
    )
    return SectionBlock("Torque", (picture,), "torques")


def _signals_section(joined: Sequence[str]) -> SectionBlock:
    blocks = tuple(
        SignalsBlock(number, f"Signals of {name}, and the model’s torque", summary=name)
        for number, name in enumerate(joined)
    )
    return SectionBlock("Signals", blocks, "signals", "explorer")


def _measures_section(of_fit: Measures) -> SectionBlock:
    """Every measure that is known, and how many are not."""
    every = list(of_fit.values())
    rows: Iterator[TableRow] = (
        (
            TableCell(m.name, kind="code", meaning=m.meaning),
            *_measured(m),
            "" if m.unit == "-" else m.unit,
            verdict(m.verdict),
        )
        for m in every
        if is_known(m)
    )
    heads = columns("Measure", "Value", "95 % interval", "Unit", "", numbers=(1, 2), wide=(0,))
    unknown = sum(not is_known(m) for m in every)
    note = f"{unknown} other measures are not known from these trials; surae measures lists why."
    table = TableBlock("Measures that are known", heads, rows_of(rows))
    return SectionBlock("All measures", (table, TextBlock(note, "note")), "all-measures")


def _measured(m: Measure) -> tuple[str, str]:
    assert m.value is not None
    assert m.ci95 is not None
    text = of_interval(m.value, m.ci95)
    return text.value, text.interval


def _by_trial_section(
    parameters: Sequence[tuple[TableCell, str, TableCell, tuple[TableCell, ...], str]],
    fitted: Sequence[str],
    contradicted: Mapping[str, list[str]],
    *,
    has_joint: bool,
) -> SectionBlock:
    rows: Iterator[TableRow] = (
        (name, unit, *([joint] if has_joint else []), *own, spread)
        for name, unit, joint, own, spread in parameters
    )
    names = (*(["All together"] if has_joint else []), *fitted)
    heads = columns("Parameter", "Unit", *names, "Spread", numbers=(len(names) + 2,),
                    looks={1: "unit"} | {k + 2: "number column" for k in range(len(names))},
                    )  # fmt: skip
    note = (
        "Value and 95 % interval; bold is identified, and no trial contradicts it. Spread: "
        "standard deviation between the trials that inform a value, as a part of their mean. "
        "Agreement between trials does not exclude a shared bias."
    )
    table = TableBlock("Every parameter in every fit", heads, rows_of(rows), "small", repeated=2)
    picture = PictureBlock(
        "trials",
        "Each parameter by trial with its 95 % interval; the band is that of all together.",
        "Each parameter by trial, with its 95 % interval: dark where it is identified, open where "
        "there is no interval. Blue: all together. Intervals end at the bounds of the search.",
    )
    warnings = paragraphs(
        (
            f"{parameter}: {', '.join(apart)} and all together contradict each other; their 95 % "
            "intervals do not touch. Neither value can be trusted."
            for parameter, apart in contradicted.items()
        ),
        "warning",
    )
    blocks: tuple[Block, ...] = (*warnings, TextBlock(note, "note"), table, picture)
    return SectionBlock("Parameters by trial", blocks, "by-trial", "page")


def _crossed_section(
    predictions: Mapping[str, Mapping[str, Crossed]],
    joint: Mapping[str, Crossed],
    trials: Sequence[Trial],
) -> SectionBlock:
    note = (
        "R² [%] with which the parameters of a row’s trial predict the torque of a column’s; below "
        "it the mean of measured minus predicted torque. The zero of the sensor is that of the "
        "row’s trial, so a drifted zero shows as bias. Adequate: as well as the fit promises; "
        "doubtful, inadequate: less, or far less."
    )
    moving = [trial.name for trial in trials if trial.moves and not trial.problem]
    heads = columns("Parameters of", *moving, looks={0: "column"} | {
        k + 1: "number column" for k in range(len(moving))})  # fmt: skip
    rows = rows_of((name, *cells) for name, cells in _crossings(predictions, joint, trials))
    table = TableBlock("Cross-prediction", heads, rows, "small", repeated=1)
    return SectionBlock("Each predicted by the others", (TextBlock(note, "note"), table), "crossed")


def _findings_section(quality: Mapping[str, Quality]) -> SectionBlock:
    """Each finding once, with the trials that have it."""
    found: dict[tuple[str, str], list[tuple[str, Finding]]] = {}
    for trial, checked in quality.items():
        for finding in checked.findings:
            if finding.severity != "info":
                found.setdefault((finding.severity, finding.code), []).append((trial, finding))
    every = sorted(found.items(), key=lambda item: item[0])  # errors come before warnings
    rows: list[TableRow] = []
    for (severity, code), those in every:
        names = list(dict.fromkeys(trial for trial, _ in those))
        where = names[0] if len(names) == 1 else f"{len(names)} trials: {', '.join(names)}"
        messages = dict.fromkeys(finding.message for _, finding in those)
        first, *others = messages
        more = f" (and {len(others)} alike)" if others else ""
        mark = TableCell(code, kind="code", badge=(f"severity {severity}", severity), under=where)
        rows.append((mark, TableCell(f"{first}{more}", why=those[0][1].advice)))
    if not rows:
        return SectionBlock("Checks", (TextBlock("Nothing was found."),), "checks")
    table = TableBlock("What was found in the recordings", columns("", "", wide=(1,)),
                       rows_of(rows), "findings")  # fmt: skip
    return SectionBlock("Checks", (table,), "checks")


def _summary(
    trials: Sequence[Trial], fits: Mapping[str, AssessedFit], joined: Sequence[str]
) -> str:
    """What there was and what was done with it."""
    uses = [(f"{len(fits)} fitted" + (f" ({len(joined)} together)" if joined else ""), 1)]
    uses += [
        (f"{count} {words}", count)
        for words, count in (
            ("held still", sum(t.use == "hold" for t in trials)),
            ("of maximal effort", sum(t.effort == "maximal" for t in trials)),
            ("not used", sum(bool(t.problem) for t in trials)),
        )
    ]
    return f"{len(trials)} trials: {', '.join(text for text, count in uses if count)}."


def trial_row(
    trial: Trial,
    alone: Assessment | None,
    joint: Crossed | None,
    failed: Mapping[str, str],
    quality: Mapping[str, Quality],
) -> TrialRow:
    """A trial in words; what is not known is left open."""
    checked = quality.get(trial.name)
    grade = "" if alone is None else str(alone.adequacy.grade)
    return TrialRow(
        name=trial.name,
        what=f"{trial.effort}, {'moves' if trial.moves else 'holds still'}"
        if trial.why
        else NO_NUMBER,
        why=trial.why,
        use=_USES[trial.use],
        findings=NO_NUMBER if checked is None else checked.summary,
        worst="" if checked is None else checked.worst or "",
        alone=TableCell(NO_NUMBER)
        if alone is None
        else TableCell(percentage(alone.adequacy.r2), grade, grade),
        together=_cell(joint),
        problem=trial.problem or failed.get(trial.name, ""),
    )


def _cell(crossed: Crossed | None) -> TableCell:
    """How a trial is followed: R², or where its torque hardly changes nothing but the bias."""
    if crossed is None or crossed.rmse is None:
        return TableCell(NO_NUMBER, "" if crossed is None else crossed.reason)
    bias = NO_NUMBER if crossed.bias is None else signed(crossed.bias, 1)
    text = NO_NUMBER if crossed.r2 is None else percentage(crossed.r2)
    under = ", ".join(filter(None, (crossed.grade, f"bias {bias} Nm")))
    return TableCell(text, under, "own" if crossed.fitted else crossed.grade)


def _crossings(
    predictions: Mapping[str, Mapping[str, Crossed]],
    joint: Mapping[str, Crossed],
    trials: Sequence[Trial],
) -> tuple[tuple[str, tuple[TableCell, ...]], ...]:
    names = [trial.name for trial in trials if trial.moves and not trial.problem]
    rows = [
        (n, tuple(_cell(row.get(predicted)) for predicted in names))
        for n, row in predictions.items()
    ]
    if joint:
        rows.append(("all together", tuple(_cell(joint.get(predicted)) for predicted in names)))
    return tuple(rows)


def _parameters(
    alone: Mapping[str, Assessment],
    joint: Assessment | None,
    contradicted: Mapping[str, list[str]],
) -> list[tuple[TableCell, str, TableCell, tuple[TableCell, ...], str]]:
    """The parameters that any fit estimated; none that is contradicted stands as identified."""
    every = [*([] if joint is None else [joint]), *alone.values()]
    rows = []
    for name, p in _estimated(every).items():
        cell = _disputed if name in contradicted else _estimate
        own = [assessment.parameters.get(name) for assessment in alone.values()]
        rows.append((
            TableCell(name, kind="code", meaning=p.meaning),
            "" if p.unit == "-" else p.unit,
            cell(None if joint is None else joint.parameters.get(name)),
            tuple(map(cell, own)),
            _spread([each for each in own if each is not None]),
        ))  # fmt: skip
    return rows


def _estimated(every: Iterable[Assessment]) -> dict[str, ParameterEstimate]:
    """The parameters that any fit estimated, each as the first one has it."""
    shown: dict[str, ParameterEstimate] = {}
    for assessment in every:
        shown |= {p.name: p for p in shown_parameters(assessment) if p.name not in shown and p.free}
    return shown


def session_figure(
    alone: Mapping[str, Assessment], joint: Assessment | None, *, width: float
) -> Figure:
    """Every parameter by trial, with its interval; that of all together as a band."""
    names = list(_estimated([*([] if joint is None else [joint]), *alone.values()]))
    return trials_figure(names, alone, joint, disputed=contradictions(alone, joint), width=width)


def contradictions(
    alone: Mapping[str, Assessment], joint: Assessment | None
) -> dict[str, list[str]]:
    """Trials whose 95 % interval and that of all together do not even touch, by parameter.

    An interval cannot say by itself that it is too narrow; another trial of the leg can.
    """
    contradicted = {}
    for p in () if joint is None else joint.parameters.values():
        if p.ci95 is None or not p.free:
            continue
        low, high = p.ci95
        apart = [
            name
            for name, assessment in alone.items()
            if (own := assessment.parameters.get(p.name)) is not None
            and own.ci95 is not None
            and (own.ci95[0] > high or own.ci95[1] < low)
        ]
        if apart:
            contradicted[p.name] = apart
    return contradicted


#: Of a parameter that trials leave anywhere within its bounds.
NOT_INFORMED = "not informed"


def _estimate(p: ParameterEstimate | None) -> TableCell:
    if p is None:
        return TableCell(NO_NUMBER)
    if p.ci95 is not None and not p.is_informed:
        return TableCell(NO_NUMBER, NOT_INFORMED, str(p.verdict))
    text = estimate(p.value, p.trusted_sem, p.ci95)
    under = text.interval if p.ci95 is not None else str(p.verdict)
    return TableCell(text.value, under, str(p.verdict))


def _disputed(p: ParameterEstimate | None) -> TableCell:
    cell = _estimate(p)
    return replace(cell, kind="disputed" if cell.kind == Verdict.IDENTIFIED else cell.kind)


def _spread(estimates: Sequence[ParameterEstimate]) -> str:
    """Standard deviation of the trials that say anything of it, as a part of their mean."""
    values = [p.value for p in estimates if p.is_informed]
    if not values and any(p.free and not p.at_bound for p in estimates):
        return NOT_INFORMED
    if len(values) < 2 or not np.mean(values):
        return NO_NUMBER
    part = float(np.std(values, ddof=1)) / abs(float(np.mean(values)))
    return f"{significant(100 * part, 2)} % of {len(values)}"


def _hold(trial: Trial, crossed: Crossed | None) -> tuple[str, str, str, str, str]:
    hold = trial.hold
    assert hold is not None
    bias = None if crossed is None else crossed.bias
    return (
        trial.name,
        trial.effort,
        signed(float(np.degrees(hold.angle)), 1),
        f"{signed(hold.torque, 1)} ± {signed(hold.sd, 1)}",
        NO_NUMBER if bias is None else signed(hold.torque - bias, 1),
    )
