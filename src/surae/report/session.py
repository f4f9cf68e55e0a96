"""The report of a session: what each trial is, each fit beside all together, who predicts whom."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np
from matplotlib.figure import Figure

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.estimation import FitResult
from surae.quality import Quality
from surae.report.figures.session import holds_figure, trials_figure
from surae.report.figures.style import WIDTH
from surae.report.figures.torques import fit_figure
from surae.report.formatting import NO_NUMBER, estimate, percentage, signed, significant
from surae.report.parameters import shown_parameters
from surae.report.wording import AdequacyWords, adequacy_words
from surae.trials import Crossed, Trial, common_errors
from surae.units import FloatArray

Fitted = tuple[FitResult, Assessment]
_USES = {
    "fit": "fitted",
    "hold": "angle and torque of a hold",
    "reference": "reference of EMG",
    "none": "not used",
}


@dataclass(frozen=True, slots=True)
class Cell:
    """A number in a table, what goes with it, and how it is shown."""

    text: str
    under: str = ""
    kind: str = ""


@dataclass(frozen=True, slots=True)
class TrialRow:
    """One trial in words."""

    name: str
    what: str
    why: str
    use: str
    findings: str
    worst: str
    alone: Cell
    together: Cell
    problem: str


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """A parameter in all fits: together, then each trial; and how far the trials spread."""

    name: str
    meaning: str
    unit: str
    joint: Cell
    trials: tuple[Cell, ...]
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
    parameters: tuple[ParameterRow, ...]
    crossed: tuple[tuple[str, tuple[Cell, ...]], ...]
    crossed_names: tuple[str, ...]
    holds: tuple[tuple[str, str, str, str, str], ...]
    findings: tuple[tuple[str, tuple[tuple[str, str, str, str], ...]], ...]


def session_content(
    name: str,
    about: Mapping[str, str | None],
    trials: Sequence[Trial],
    fits: Mapping[str, Fitted],
    joint: Fitted | None,
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


def session_drawings(
    trials: Sequence[Trial],
    fits: Mapping[str, Fitted],
    joint: Fitted | None,
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
    held = [t for t in trials if t.hold is not None]
    if held:
        figures["holds"] = holds_figure(held, joint_predictions, _passive(trials, fits))
    return figures


def _summary(
    trials: Sequence[Trial], fits: Mapping[str, Fitted], joined: Sequence[str]
) -> tuple[str, ...]:
    """What there was and what was done with it, in sentences."""
    held = [t for t in trials if t.use == "hold"]
    passive = sum(t.effort == "passive" for t in held)
    unread = sum(bool(t.problem) for t in trials)
    lines = [
        f"{len(trials)} trials were given. {len(fits)} of them moved and were fitted each"
        + (f", {len(joined)} of these together." if joined else ".")
    ]
    if held:
        lines.append(
            f"{len(held)} hold still ({passive} passive): a hold says nothing of stiffness, "
            "lengths and relaxation and is not fitted; its torque at one angle is compared with "
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
        alone=Cell(NO_NUMBER)
        if alone is None
        else Cell(percentage(alone.adequacy.r2), grade, grade),
        together=_cell(joint),
        problem=trial.problem or failed.get(trial.name, ""),
    )


def _cell(crossed: Crossed | None) -> Cell:
    """How a trial is followed: R², or where its torque hardly changes nothing but the bias."""
    if crossed is None or crossed.rmse is None:
        return Cell(NO_NUMBER, "" if crossed is None else crossed.reason)
    bias = NO_NUMBER if crossed.bias is None else signed(crossed.bias, 1)
    text = NO_NUMBER if crossed.r2 is None else percentage(crossed.r2)
    under = ", ".join(filter(None, (crossed.grade, f"bias {bias} Nm")))
    return Cell(text, under, "own" if crossed.fitted else crossed.grade)


def _crossings(
    predictions: Mapping[str, Mapping[str, Crossed]],
    joint: Mapping[str, Crossed],
    trials: Sequence[Trial],
) -> tuple[tuple[str, tuple[Cell, ...]], ...]:
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
) -> tuple[ParameterRow, ...]:
    """The parameters that any fit estimated; none that is contradicted stands as identified."""
    every = [*([] if joint is None else [joint]), *alone.values()]
    rows = []
    for name, p in _estimated(every).items():
        cell = _disputed if name in contradicted else _estimate
        own = [assessment.parameters.get(name) for assessment in alone.values()]
        rows.append(
            ParameterRow(
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


def _estimate(p: ParameterEstimate | None) -> Cell:
    if p is None:
        return Cell(NO_NUMBER)
    text = estimate(p.value, p.trusted_sem, p.ci95)
    under = text.interval if p.ci95 is not None else str(p.verdict)
    return Cell(text.value, under, str(p.verdict))


def _disputed(p: ParameterEstimate | None) -> Cell:
    cell = _estimate(p)
    return replace(cell, kind="disputed" if cell.kind == Verdict.IDENTIFIED else cell.kind)


def _spread(estimates: Sequence[ParameterEstimate]) -> str:
    """Standard deviation of the trials that have an interval, as a part of their mean."""
    values = [p.value for p in estimates if p.ci95 is not None and p.verdict is not Verdict.FIXED]
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
    trials: Sequence[Trial], fits: Mapping[str, Fitted]
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
