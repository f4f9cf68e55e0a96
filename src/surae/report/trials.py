"""The trials of a session as tables: what each is, how fits follow it, what was found in it."""

from collections.abc import Mapping, Sequence

import numpy as np

from surae.base.formatting import NO_NUMBER, percentage, signed
from surae.base.normal import NORMAL
from surae.base.words import N_
from surae.inference import Assessment, ParameterEstimate, Verdict
from surae.quality import SEVERITIES, Finding, Quality
from surae.report import block
from surae.trials import Crossed, Trial

_USES = {
    "fit": N_("fitted"),
    "hold": N_("torque at a held angle"),
    "reference": N_("reference for EMG"),
    "device": N_("taken from the torque of the others"),
    "crosstalk": N_("what electrodes hear of other muscles"),
    "nerve": N_("tissue and reflex"),
    "none": N_("not used"),
}


def trial_words(trial: Trial) -> tuple[str, str]:
    """What a trial is, a dash where that is not known, and what it is used for."""
    moves = N_("moves") if trial.moves else N_("holds still")
    return f"{trial.effort}, {moves}" if trial.why else NO_NUMBER, _USES[trial.use]


def trials_section(
    trials: Sequence[Trial],
    alone: Mapping[str, Assessment],
    failed: Mapping[str, str],
    quality: Mapping[str, Quality],
    joint: Mapping[str, Crossed],
) -> block.Section:
    """What each trial is, how its own fit and that of all together follow it."""
    rows = block.rows(
        _trial(t, alone.get(t.name), joint.get(t.name), failed.get(t.name, ""), quality.get(t.name))
        for t in trials
    )
    heads = block.columns(
        "Trial",
        "What it is",
        "Used for",
        "Check",
        "Alone, R² [%]",
        "All together, R² [%]",
        numbers=(4, 5),
        wide=(1,),
        looks={0: "column", 1: "what"},
    )
    note = (
        "R² says how well changes of the torque are followed; a hold has none. Shaded: used in "
        "the fit, so agreement is no test."
    )
    table = block.Grid("What each trial is, and how it is followed", heads, rows)
    holds = [t for t in trials if t.hold is not None]
    blocks: list[block.Block] = [table, block.Text(note, "note")]
    if holds:
        heads = block.columns(
            "Held", "Effort", "Angle [°]", "Torque [Nm]", "Predicted [Nm]", numbers=(2, 3, 4)
        )
        points = block.rows(_hold(t, joint.get(t.name)) for t in holds)
        blocks.append(block.Grid("Torque of trials that hold still", heads, points))
    return block.Section("Trials", tuple(blocks), "trials")


def _trial(
    trial: Trial,
    alone: Assessment | None,
    joint: Crossed | None,
    failed: str,
    checked: Quality | None,
) -> block.Row:
    (what, use) = trial_words(trial)
    worst = "" if checked is None else checked.worst
    badge = (f"severity {worst}", worst) if worst in ("error", "warning") else None
    r2 = block.Cell(NO_NUMBER)
    if alone is not None:
        grade = str(alone.adequacy.grade)
        r2 = block.Cell(percentage(alone.adequacy.r2), grade, grade)
    return (
        trial.name,
        block.Cell(what, meaning=trial.problem or failed or trial.why),
        use,
        block.Cell(badge=badge, meaning=NO_NUMBER if checked is None else checked.summary),
        r2,
        _cell(joint),
    )


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


def crossed_section(
    predictions: Mapping[str, Mapping[str, Crossed]],
    joint: Mapping[str, Crossed],
    trials: Sequence[Trial],
) -> block.Section:
    """How the fit of each trial predicts the others."""
    note = (
        "R² [%] with which the parameters of a row’s trial predict the torque of a column’s; below "
        "it the mean of measured minus predicted torque. The zero of the sensor is that of the "
        "row’s trial, so a drifted zero shows as bias. Adequate: as well as the fit promises; "
        "doubtful, inadequate: less, or far less. Without a model: the better of the mean of the "
        "row’s trials at the same phase and of a ridge regression on angle, speed and EMG; where "
        "that is as good as the model’s own share of the variance (VAF), that a torque is "
        "predicted is no evidence of the parameters."
    )
    moving = [trial.name for trial in trials if trial.moves and not trial.problem]
    heads = block.columns(
        "Parameters of",
        *moving,
        looks={0: "column"} | {k + 1: "number column" for k in range(len(moving))},
    )
    every = {**predictions, **({"all together": joint} if joint else {})}
    rows = block.rows(
        (name, *(_cell(row.get(predicted)) for predicted in moving)) for name, row in every.items()
    )
    table = block.Grid("Cross-prediction", heads, rows, "small", repeated=1)
    return block.Section(
        "Each predicted by the others", (block.Text(note, "note"), table), "crossed"
    )


def _cell(crossed: Crossed | None) -> block.Cell:
    """How a trial is followed: R², or where its torque hardly changes nothing but the bias."""
    if crossed is None or crossed.rmse is None:
        return block.Cell(NO_NUMBER, "" if crossed is None else crossed.reason)
    bias = NO_NUMBER if crossed.bias is None else signed(crossed.bias, 1)
    text = NO_NUMBER if crossed.r2 is None else percentage(crossed.r2)
    known = [share for share in (crossed.template_vaf, crossed.ridge_vaf) if share is not None]
    without = ""
    if known and crossed.vaf is not None:
        followed, other = percentage(crossed.vaf), percentage(max(known))
        without = f"VAF {followed} %, without a model {other} %"
    under = ", ".join(filter(None, (crossed.grade, f"bias {bias} Nm", without)))
    return block.Cell(text, under, "own" if crossed.fitted else crossed.grade)


def findings_section(quality: Mapping[str, Quality], zero: float = 0.0) -> block.Section:
    """Each finding once, with the recordings that have it; and what could not be checked.

    `zero` is what the torque's is off by in all trials [Nm], as the leg's page subtracts it.
    """
    by_code: dict[tuple[int, str], list[tuple[str, Finding]]] = {}
    for name, checked in quality.items():
        for finding in checked.findings:
            place = SEVERITIES.index(finding.severity)
            by_code.setdefault((-place, finding.code), []).append((name, finding))
    rows: list[block.Row] = []
    for (_, code), those in sorted(by_code.items(), key=lambda item: item[0]):
        names = list(dict.fromkeys(name for name, _ in those))
        first = those[0][1]
        where = f"{len(names)} trials: {', '.join(names)}"
        if len(those) == 1:
            where = f"{names[0]}, {first.start_s:.4g} to {first.end_s:.4g} s"
        others = len({finding.message for _, finding in those}) - 1
        more = f" (and {others} alike)" if others else ""
        badge = (f"severity {first.severity}", first.severity)
        mark = block.Cell(code, kind="code", badge=badge, under=where, meaning=first.channel or "")
        said = f"{first.message}{more}"
        if code == "torque-offset" and len(quality) > 1:  # a session has one
            off = zero or float(np.median([finding.value or 0.0 for _, finding in those]))
            said = f"The torque’s zero is off by about {off:.3g} Nm, taken as one for all trials."
        rows.append((mark, block.Cell(said, why=first.advice)))
    table = block.Grid(
        "What was found in the recordings",
        block.columns("", "", wide=(1,)),
        block.rows(rows),
        "findings",
    )
    blocks: list[block.Block] = [table if rows else block.Text("Nothing was found.")]
    skipped = {
        f"{s.check} ({s.reason.rstrip('.')})": None
        for each in quality.values()
        for s in each.skipped
    }
    if skipped:
        blocks.append(block.Text(f"Not checked: {'; '.join(skipped)}", "note"))
    return block.Section("Checks", tuple(blocks), "checks")


def agreement_section(contradicted: Mapping[str, list[str]]) -> block.Section:
    """Every parameter in every fit, as a figure; what is contradicted is said in words."""
    picture = block.Picture(
        "trials",
        "Each parameter by trial with its 95 % interval; the band is that of all together.",
        "Each parameter by trial, with its 95 % interval: dark where it is identified and no trial "
        "contradicts it, open where there is no interval. Blue: all together. Intervals end at the "
        "bounds of the search; table.csv has the numbers. Agreement between trials does not "
        "exclude a shared bias.",
    )
    warnings = block.paragraphs(
        (
            f"{parameter}: {', '.join(apart)} and all together contradict each other; their 95 % "
            "intervals do not touch. Neither value can be trusted."
            for parameter, apart in contradicted.items()
        ),
        "warning",
    )
    return block.Section("Parameters by trial", (*warnings, picture), "by-trial", "page")


def contradictions(
    alone: Mapping[str, Assessment], joint: Assessment | None
) -> dict[str, list[str]]:
    """Trials whose interval and that of all together do not even touch, by parameter.

    An interval cannot say by itself that it is too narrow; another trial of the leg can. What a fit
    does not tell, such as the gain of a muscle that rested, contradicts nothing, and intervals are
    as wide as so many comparisons need for 95 % of legs to show none by chance (Bonferroni).
    """
    from scipy.special import ndtri

    pairs = [
        (p.name, trial, p.ci95, by_trial.ci95)
        for p in (() if joint is None else joint.parameters.values())
        for trial, assessment in alone.items()
        if (by_trial := assessment.parameters.get(p.name)) is not None
        and _is_sure(p)
        and _is_sure(by_trial)
    ]
    wider = float(ndtri(1.0 - 0.025 / max(len(pairs), 1))) / NORMAL
    contradicted: dict[str, list[str]] = {}
    for name, trial, together, own_ci in pairs:
        assert together is not None
        assert own_ci is not None
        apart = abs(sum(together) - sum(own_ci)) / 2.0
        if apart > wider * (together[1] - together[0] + own_ci[1] - own_ci[0]) / 2.0:
            contradicted.setdefault(name, []).append(trial)
    return contradicted


def _is_sure(p: ParameterEstimate) -> bool:
    """Whether a fit tells a parameter; an interval that a limit of the search cuts does not."""
    known = p.free and not p.at_bound and p.verdict in (Verdict.IDENTIFIED, Verdict.WEAK)
    return known and p.ci95 is not None and p.lower < p.ci95[0] and p.ci95[1] < p.upper
