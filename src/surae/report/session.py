"""The report of a session: what each trial is, each fit beside all together, who predicts whom."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.estimation import FitResult
from surae.formatting import NO_NUMBER, estimate, percentage, signed, significant
from surae.quality import Quality
from surae.report.clinical import ClinicalPage, blocks_of
from surae.report.document import (
    AdequacyWords,
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
)
from surae.report.figures import Figure
from surae.report.figures.session import holds_figure, trials_figure
from surae.report.figures.style import WIDTH
from surae.report.figures.torques import fit_figure
from surae.report.parameters import shown_parameters
from surae.report.wording import adequacy_words
from surae.trials import Crossed, Trial, common_errors
from surae.units import FloatArray

AssessedFit = tuple[FitResult, Assessment]
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
class SessionParameter:
    """A parameter in all fits: together, then each trial; and how far the trials spread."""

    name: str
    meaning: str
    unit: str
    joint: TableCell
    trials: tuple[TableCell, ...]
    spread: str


@dataclass(frozen=True, slots=True)
class SessionContent:
    """Everything that the page says, as text; see `session_content`."""

    name: str
    about: str
    created: str
    summary: tuple[str, ...]
    interrupted: bool
    adequacy: AdequacyWords | None
    common: tuple[str, ...]
    contradictions: tuple[str, ...]
    no_joint: str
    joined: tuple[str, ...]
    trials: tuple[TrialRow, ...]
    fitted: tuple[str, ...]
    parameters: tuple[SessionParameter, ...]
    crossed: tuple[tuple[str, tuple[TableCell, ...]], ...]
    crossed_names: tuple[str, ...]
    holds: tuple[tuple[str, str, str, str, str], ...]
    findings: tuple[tuple[str, tuple[tuple[str, str, str, str], ...]], ...]


def session_content(
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
) -> SessionContent:
    """What the report of a session says.

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
    """
    alone = {trial: assessment for trial, (_, assessment) in fits.items()}
    together = None if joint is None else joint[1]
    contradicted = contradictions(alone, together)
    return SessionContent(
        name=name,
        about=", ".join(text for text in about.values() if text),
        created=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        summary=_summary(trials, fits, joined),
        interrupted=interrupted,
        adequacy=None if together is None else adequacy_words(together.adequacy),
        common=common_errors(quality[trial] for trial in fits if trial in quality),
        contradictions=tuple(
            f"{parameter} of {', '.join(apart)} and of all together contradict each other: their "
            "95 % intervals do not touch. Take neither as known."
            for parameter, apart in contradicted.items()
        ),
        no_joint=failed.get("joint", ""),
        joined=tuple(joined),
        trials=tuple(
            trial_row(t, alone.get(t.name), joint_predictions.get(t.name), failed, quality)
            for t in trials
        ),
        fitted=tuple(alone),
        parameters=_parameters(alone, together, contradicted),
        crossed=_crossings(predictions, joint_predictions, trials),
        crossed_names=tuple(t.name for t in trials if t.moves and not t.problem),
        holds=tuple(_hold(t, joint_predictions.get(t.name)) for t in trials if t.hold),
        findings=tuple(_findings(t.name, quality) for t in trials if t.name in quality),
    )


def session_document(content: SessionContent, page: ClinicalPage | None) -> Document:
    """The report of a session; `page` is what its joint fit says in the clinic's units."""
    about = f"{content.about}. " if content.about else ""
    sections = (
        SectionBlock("Summary", tuple(_opening(content)), "summary"),
        _trials_section(content),
        _torques_section(content),
        _parameters_section(content),
        _crossed_section(content),
        _holds_section(content),
        _clinical_section(page),
        _findings_section(content),
    )  # fmt: skip
    shown = {
        "torques": content.adequacy is not None,
        "parameters": bool(content.parameters),
        "crossed": bool(content.crossed),
        "holds": bool(content.holds),
        "clinical": page is not None or bool(content.contradictions),
    }
    return Document(
        kicker="Ankle muscle parameters: a session",
        heading=content.name,
        under=f"{about}Report of {content.created}.",
        title=f"Session: {content.name}",
        blocks=tuple(section for section in sections if shown.get(section.anchor, True)),
        footer=(
            "Every fit is beside this page as FIT.json: fits/TRIAL.json, joint.json; the numbers "
            "as table.csv. surae fit and surae validate take them further."
        ),
    )


def _opening(content: SessionContent) -> Iterator[Block]:
    """What the fit of all together is worth, what is wrong in common, and what was done."""
    if content.interrupted:
        yield TextBlock(
            "The user stopped this run: what follows is of the fits that were complete. The same "
            "command goes on where it stopped.",
            "warning",
        )
    if content.adequacy is not None:
        together = f"All together ({len(content.joined)} trials): {content.adequacy.sentence}"
        yield replace(content.adequacy, sentence=together)
    elif content.no_joint:
        yield TextBlock(f"No fit of all together: {content.no_joint}.", "warning")
    yield from paragraphs((*content.common, *content.contradictions), "warning")
    yield from paragraphs(content.summary)


def _trials_section(content: SessionContent) -> SectionBlock:
    rows = (
        (
            row.name,
            TableCell(row.what, meaning=row.why, why=row.problem),
            row.use,
            TableCell(badge=(f"severity {row.worst}", row.worst)
                 if row.worst in ("error", "warning") else None, meaning=row.findings),
            row.alone,
            row.together,
        )
        for row in content.trials
    )  # fmt: skip
    heads = columns("Trial", "What it is", "Used for", "Check", "Alone, R² [%]",
                    "All together, R² [%]", numbers=(4, 5), wide=(1, 3),
                    looks={0: "column", 1: "what"})  # fmt: skip
    note = (
        "R² is of the torque’s changes; a hold has none. A shaded cell is a trial that was in the "
        "fit: following it proves nothing."
    )
    table = TableBlock("What each trial is, and how it is followed", heads, rows_of(rows))
    return SectionBlock("Trials", (table, TextBlock(note, "note")), "trials")


def _torques_section(content: SessionContent) -> SectionBlock:
    picture = PictureBlock(
        "torques",
        "Measured torque of each trial, and as the fit of all together has it.",
        "Measured torque (wide, pale) and that of the fit of all together (thin, dark), with its "
        "R².",
    )
    signals = (
        SignalsBlock(
            number,
            f"Signals of {name}, and its torque as the fit of all together has it",
            summary=f"{name}: its signals, to zoom into",
        )
        for number, name in enumerate(content.joined)
    )
    return SectionBlock("Torque: all together", (picture, *signals), "torques")


def _parameters_section(content: SessionContent) -> SectionBlock:
    joint = content.adequacy is not None
    rows: Iterator[TableRow] = (
        (
            TableCell(row.name, kind="code", meaning=row.meaning),
            row.unit,
            *([row.joint] if joint else []),
            *row.trials,
            row.spread,
        )
        for row in content.parameters
    )
    names = (*(["All together"] if joint else []), *content.fitted)
    heads = columns("Parameter", "Unit", *names, "Spread", numbers=(len(names) + 2,),
                    looks={1: "unit"} | {k + 2: "number column" for k in range(len(names))},
                    )  # fmt: skip
    note = (
        "Value, and below it the 95 % interval, which holds what is not known of the laboratory "
        "and of the model; bold is identified and contradicted by no trial. Spread: standard "
        "deviation between the trials that say anything of it, as a part of their mean. What all "
        "trials of a leg share, such as crosstalk, is not in a spread: agreement between trials "
        "does not exclude a shared bias."
    )
    table = TableBlock("Every parameter in every fit", heads, rows_of(rows), "small", repeated=2)
    picture = PictureBlock(
        "trials",
        "Each parameter by trial with its 95 % interval; the band is that of all together.",
        "Each parameter by trial, with its 95 % interval: dark where it is identified, open where "
        "there is no interval. Blue: all together. Intervals end at the bounds of the search.",
    )
    blocks = (TextBlock(note, "note"), table, picture)
    return SectionBlock("Parameters by trial", blocks, "parameters", "page")


def _crossed_section(content: SessionContent) -> SectionBlock:
    note = (
        "R² [%] with which the parameters of a row’s trial predict the torque of a column’s; below "
        "it the mean of measured minus predicted torque. The zero of the sensor is that of the "
        "row’s trial, so a drifted zero shows as bias. Adequate: as well as the fit promises; "
        "doubtful, inadequate: less, or far less."
    )
    heads = columns("Parameters of", *content.crossed_names, looks={0: "column"} | {
        k + 1: "number column" for k in range(len(content.crossed_names))})  # fmt: skip
    rows = rows_of((name, *cells) for name, cells in content.crossed)
    table = TableBlock("Cross-prediction", heads, rows, "small", repeated=1)
    return SectionBlock("Each predicted by the others", (TextBlock(note, "note"), table), "crossed")


def _holds_section(content: SessionContent) -> SectionBlock:
    note = (
        "Nothing moves in them, so none of them tells a parameter; passive ones show the torque of "
        "relaxed tissue, gravity and the sensor’s zero together at one angle."
    )
    heads = columns("Trial", "Effort", "Angle [°]", "Torque [Nm]",
                    "Predicted by all together [Nm]", numbers=(2, 3, 4))  # fmt: skip
    table = TableBlock("Torque of trials that hold still", heads, rows_of(content.holds))
    alt = (
        "Mean torque of the holds against their angle, with what the fit of all together predicts."
    )
    blocks = (TextBlock(note, "note"), table, PictureBlock("holds", alt, width=80))
    return SectionBlock("Trials that hold still", blocks, "holds")


def _clinical_section(page: ClinicalPage | None) -> SectionBlock:
    if page is None:
        text = (
            "The trials contradict each other, so they do not tell together how stiff or strong "
            "this leg is. surae measures fits/TRIAL.json tells it of one trial."
        )
        warning = (TextBlock(text, "warning"),)
        return SectionBlock("In the clinic’s units", warning, "clinical")
    answer = (TextBlock(page.question, "question"), TextBlock(page.answer, "answer"))
    title = "In the clinic’s units: all together"
    return SectionBlock(title, (*answer, *blocks_of(page)), "clinical", "page clinical")


def _findings_section(content: SessionContent) -> SectionBlock:
    blocks = tuple(
        SectionBlock(name, (TableBlock(f"Findings in {name}", columns("", "", wide=(1,)), rows_of(
            (TableCell(code, kind="code", badge=(f"severity {severity}", severity)),
             TableCell(message, why=advice))
            for severity, code, message, advice in rows
        ), "findings"),))
        for name, rows in content.findings
        if rows
    )  # fmt: skip
    nothing = (TextBlock("Nothing that speaks against them."),)
    return SectionBlock("What was found in the recordings", blocks or nothing, "checks")


def session_drawings(
    trials: Sequence[Trial],
    fits: Mapping[str, AssessedFit],
    joint: AssessedFit | None,
    joint_predictions: Mapping[str, Crossed],
) -> dict[str, Figure]:
    """The figures of the report by name; arguments as of `session_content`."""
    figures: dict[str, Figure] = {}
    if joint is not None:
        notes = [f"R² {percentage(each.r2)} %" for each in joint[1].recordings]
        figures["torques"] = fit_figure(joint[0], notes)
    alone = {trial: assessment for trial, (_, assessment) in fits.items()}
    if alone and _estimated([*([] if joint is None else [joint[1]]), *alone.values()]):
        figures["trials"] = session_figure(alone, None if joint is None else joint[1], width=WIDTH)
    holds = [t for t in trials if t.hold is not None]
    if holds:
        figures["holds"] = holds_figure(holds, joint_predictions, _passive(trials, fits))
    return figures


def _summary(
    trials: Sequence[Trial], fits: Mapping[str, AssessedFit], joined: Sequence[str]
) -> tuple[str, ...]:
    """What there was and what was done with it, in sentences."""
    holds = [t for t in trials if t.use == "hold"]
    passive = sum(t.effort == "passive" for t in holds)
    unread = sum(bool(t.problem) for t in trials)
    lines = [
        f"{len(trials)} trials were given. {len(fits)} of them moved and were fitted each"
        + (f", {len(joined)} of these together." if joined else ".")
    ]
    if holds:
        lines.append(
            f"{len(holds)} hold still ({passive} passive): one hold can’t show stiffness, "
            "lengths or relaxation and is not fitted; its torque at one angle is compared with "
            "what the fits predict."
        )
    if references := [t.name for t in trials if t.effort == "maximal"]:
        lines.append(
            f"Of maximal effort: {', '.join(references)}. Their EMG is the session's reference "
            "where one is asked for (normalise)."
        )
    if unread:
        lines.append(f"{unread} could not be used; the table says why.")
    return tuple(lines)


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
) -> tuple[SessionParameter, ...]:
    """The parameters that any fit estimated; none that is contradicted stands as identified."""
    every = [*([] if joint is None else [joint]), *alone.values()]
    rows = []
    for name, p in _estimated(every).items():
        cell = _disputed if name in contradicted else _estimate
        own = [assessment.parameters.get(name) for assessment in alone.values()]
        rows.append(
            SessionParameter(
                name=name,
                meaning=p.meaning,
                unit="" if p.unit == "-" else p.unit,
                joint=cell(None if joint is None else joint.parameters.get(name)),
                trials=tuple(map(cell, own)),
                spread=_spread([each for each in own if each is not None]),
            )
        )
    return tuple(rows)


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


def _passive(
    trials: Sequence[Trial], fits: Mapping[str, AssessedFit]
) -> list[tuple[FloatArray, FloatArray]]:
    """Angle and torque of passive trials that move."""
    names = [trial.name for trial in trials if trial.effort == "passive" and trial.name in fits]
    inputs = [fits[name][0].problem.inputs[0] for name in names]
    return [(each.angle, each.torque) for each in inputs if each.torque is not None]


def _findings(
    name: str, quality: Mapping[str, Quality]
) -> tuple[str, tuple[tuple[str, str, str, str], ...]]:
    rows = tuple(
        (finding.severity, finding.code, finding.message, finding.advice)
        for finding in quality[name].findings
        if finding.severity != "info"
    )
    return name, rows
