"""What a fit with model auto says beyond the leg: the laboratory, the models, the trials."""

import numpy as np

from surae.base.formatting import NO_NUMBER, estimate, probability, significant
from surae.inference import AssessedFit, FitResult, ParameterEstimate
from surae.inference.judging.grade import Grade
from surae.inference.judging.random_effects import trial_spread
from surae.inference.result import Candidate
from surae.model import get_model
from surae.model.knowledge_words import lines_of
from surae.model.laboratory import group_of
from surae.model.source import Gaussian
from surae.model.source_table import LABELS, NUISANCES
from surae.report import block

#: Units as people read them: factor and name.
_UNITS = {"s": (1e3, "ms"), "m": (1e3, "mm"), "rad": (57.29577951308232, "°"), "-": (1.0, "–")}
#: Part of the assumed standard deviation up to which a value comes from the data, or a part of it.
_DATA = 0.5
_PARTLY = 0.8
#: Standard deviations from what was assumed that are worth a word.
_UNUSUAL = 2.0


def known_section(result: FitResult) -> tuple[block.Section, ...]:
    """What was known beforehand; nothing where nothing was stated."""
    known = result.problem.settings.knowledge
    posterior = result.posterior
    worded = result.problem.options.anatomy.worded
    if known is None or not (lines := lines_of(known)):
        return ()
    heads = block.columns("What", "How well", "From", wide=(1,))
    title = "What was known beforehand"
    blocks: tuple[block.Block, ...] = (
        block.Text(
            "Steps of the session and what the laboratory stated. None of it is taken for exact: "
            "its own uncertainty is in every interval, and it is held against the torque."
        ),
        block.Grid(title, heads, block.rows((worded(what), how, of) for what, how, of in lines)),
        *block.paragraphs(known.doubts, "warning"),
        *(
            block.Text(
                f"{worded(LABELS[g])}: the torque fits this badly (one right statement in "
                f"{1.0 / p:.3g} is as far off); intervals are wider for it.",
                "warning",
            )
            for g, p in ({} if posterior is None else posterior.contradicted).items()
            if p
        ),
    )
    return (block.Section(title, blocks, "known", "page"),)


#: What stands with the table of imperfections.
_NUISANCES = (
    "No laboratory can rule these out. Each was given what a careful laboratory knows of it "
    "beforehand, mean ± standard deviation, and estimated along with the leg; what stays unknown "
    "of it is in every interval of this report."
)


def laboratory_section(fit: AssessedFit) -> tuple[block.Section, ...]:
    """Errors of the laboratory; nothing for a named model, which takes it for perfect."""
    solution = fit.result.posterior
    inputs = fit.result.problem.inputs
    if solution is None or not solution.candidates:
        return ()
    blocks: list[block.Block] = []
    if not solution.beliefs:
        blocks.append(
            block.Text(
                "Measurement errors were left out, as requested: the intervals assume a perfect "
                "laboratory."
            )
        )
    else:
        estimates = [p for name, p in fit.assessment.nuisances.items() if name in solution.beliefs]
        present = {group_of(p.name) for p in estimates}
        worded = fit.result.problem.options.anatomy.worded
        groups = [
            worded(f"{s.label}: {s.meaning}") for group, s in NUISANCES.items() if group in present
        ]
        heads = block.columns(
            "Imperfection",
            "Assumed",
            "Estimate",
            "95 % interval",
            "Unit",
            "Source",
            numbers=(1, 3),
            wide=(0, 5),
            looks={2: "number value", 4: "unit"},
        )
        rows = block.rows(_row(p, solution.beliefs[p.name]) for p in estimates)
        title = "Imperfections: what was assumed and what came out"
        blocks += [
            block.Text(worded(_NUISANCES)),
            block.Text(f"{'; '.join(groups)}.", "note"),
            block.Grid(title, heads, rows, "laboratory"),
        ]
        if of_each := solution.each.get("torque_zero"):
            zeros = ", ".join(
                f"{recording.name} {significant(zero, 3)} Nm"
                for recording, zero in zip(inputs, of_each, strict=True)
            )
            blocks.append(block.Text(f"Torque zero of each recording: {zeros}."))
    return (block.Section("The laboratory’s imperfections", tuple(blocks), "laboratory", "page"),)


def _row(p: ParameterEstimate, belief: Gaussian) -> block.Row:
    factor, unit = _UNITS.get(p.unit, (1.0, p.unit))
    if p.unit == "-" and group_of(p.name) in ("crosstalk", "drift"):
        factor = 100.0
        unit = "%"
    ends = None if p.ci95 is None else (factor * p.ci95[0], factor * p.ci95[1])
    text = estimate(factor * p.value, None if p.sem is None else factor * p.sem, ends)
    mean, sd = (significant(factor * number, 2) for number in (belief.mean, belief.sd))
    name = block.Cell(p.name, kind="code", meaning=p.meaning)
    return (name, f"{mean} ± {sd}", text.value, text.interval, unit, _origin(p, belief))


def _origin(p: ParameterEstimate, belief: Gaussian) -> str:
    """Whether a value comes from the data or from what was assumed."""
    if p.at_bound:
        none = p.value == belief.off
        return "no sign of this" if none else "at its limit: check the set-up"
    if p.sem is None:
        return NO_NUMBER
    part = p.sem / belief.sd
    text = (
        "from the data"
        if part <= _DATA
        else "partly from the data"
        if part <= _PARTLY
        else "as assumed: the data add little"
    )
    away = abs(p.value - belief.mean) / belief.sd
    if away > _UNUSUAL:
        text += f"; {away:.1f} standard deviations from what was assumed"
    return text


def family_text(fit: AssessedFit) -> str:
    """Which departures the data ask for; empty for a named model."""
    posterior = fit.result.posterior
    if posterior is None or not posterior.candidates:
        return ""
    if fit.assessment.adequacy.grade is Grade.INADEQUATE:
        return "The fit is inadequate: what the data ask for means nothing."
    chosen = posterior.candidates[0]
    departures = _labels(fit.result, chosen) or "the plain model"
    better = "These data fit better with"
    if chosen.weight < 0.5:
        better = "Several models fit these data about as well, the likeliest with"
    return (
        f"{better} {departures} (probability {probability(chosen.weight)}). The intervals include "
        "what others would give."
    )


def _labels(result: FitResult, candidate: Candidate) -> str:
    """What a candidate has in it."""
    worded = result.problem.options.anatomy.worded
    return ", ".join(worded(NUISANCES[group].label) for group in candidate.groups)


def family_section(fit: AssessedFit) -> tuple[block.Section, ...]:
    """The models that were weighed, and what the evidence says; nothing for a named model."""
    posterior = fit.result.posterior
    if posterior is None or not posterior.candidates:
        return ()
    chosen, *others = posterior.candidates
    models = [chosen, *(other for other in others if other.model != chosen.model)]
    variants = [other for other in others if other.model == chosen.model]
    heads = block.columns("Model", "Imperfections in it", "Probability", numbers=(2,), wide=(1,))
    tables = []
    for caption, candidates in (
        ("Models that were weighed", models),
        ("Other sets of imperfections, in the intervals by their probability", variants),
    ):
        rows = block.rows(
            (
                get_model(each.model).title,
                _labels(fit.result, each) or "none",
                probability(each.weight),
            )
            for each in candidates
        )
        if candidates:
            tables.append(block.Grid(caption, heads, rows, "family", titled=True))
    blocks: tuple[block.Block, ...] = (block.Text(family_text(fit)), *tables)
    return (block.Section("Which model the data support", blocks, "family", "together"),)


#: What stands with the table of trials.
TRIALS = (
    "Estimates of each recording alone, ± standard error; what trials share, such as crosstalk, is "
    "that of the joint fit. The spread is the standard deviation between trials beyond those "
    "errors, and in brackets its upper limit (95 %): few recordings estimate it badly. The "
    "interval of the joint value includes it."
)


def trials_section(fit: AssessedFit) -> tuple[block.Section, ...]:
    """How the trials of a joint fit differ; nothing where that was not looked at."""
    posterior = fit.result.posterior
    recordings = () if posterior is None else posterior.recordings
    inputs = fit.result.problem.inputs
    if not recordings:
        return ()
    apart = trial_spread(recordings)
    rows: list[block.Row] = []
    for name, p in fit.assessment.parameters.items():
        if not p.free or any(name not in alone.values for alone in recordings):
            continue
        each = [estimate(a.values[name], a.sem[name], (0.0, 0.0)) for a in recordings]
        likely, most = (100 * sd / abs(p.value) if p.value else np.inf for sd in apart[name])
        rows.append(
            (
                block.Cell(name, kind="code"),
                "–" if p.unit == "-" else p.unit,
                estimate(p.value, p.trusted_sem, p.ci95).value,
                *(f"{text.value} ± {text.sem}" for text in each),
                f"{significant(likely, 2)} % (< {significant(most, 2)} %)",
            )
        )
    names = [recording.name for recording in inputs]
    heads = block.columns(
        "Parameter", "Unit", "Together", *names, "Spread", numbers=range(2, 4 + len(names))
    )
    title = "Every parameter by recording, and its spread between trials"
    table = block.Grid(
        title, heads, block.rows(rows), "starts", repeated=2 if len(names) > 6 else 0
    )
    return (
        block.Section("From trial to trial", (block.Text(TRIALS), table), "trials", "together"),
    )
