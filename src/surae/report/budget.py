"""What makes each parameter unsure, in shares of its variance, and what would make it known."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.base.formatting import listed
from surae.inference import AssessedFit, Assessment, LeastSquares, ParameterEstimate, Verdict
from surae.inference.judging.grade import Grade
from surae.inference.judging.parameter import percent
from surae.model.source_table import SOURCES, advice
from surae.planning.information import covariance_if_filmed
from surae.report import block

#: Share of a variance from which a source is shown, and from which it is worth a remedy.
_SHOWN = 0.005
_WORTH = 0.25
#: A remedy is worth a sentence where the interval shrinks to less than this part.
_SHRINKS = 0.8
#: Muscles that may be filmed, and how sentences ask for it.
_MUSCLES = {
    "tib": "film the tibialis",
    "tib2": "film a second place of the tibialis",
    "gm": "film the gastrocnemius",
}
#: Parameters that are named with one remedy.
_NAMED = 4


@dataclass(frozen=True, slots=True)
class BudgetTable:
    """Shares of the variance of every estimated parameter that has an interval."""

    sources: tuple[str, ...]  #: Names in FIT.json of those that are shown.
    labels: tuple[str, ...]  #: What they are called.
    #: By parameter: how well it is known, and its shares in the order of `sources`. Empty where
    #: nothing but noise is looked at.
    rows: Mapping[str, tuple[str, tuple[float, ...]]]
    helps: tuple[str, ...]  #: What to measure, and how much better which parameter would be known.


def budget_of(fit: AssessedFit) -> BudgetTable:
    """The budgets of all parameters in one table."""
    known = {p.name: p for p in fit.assessment.parameters.values() if p.budget and p.ci95}
    helps = what_to_measure(fit.assessment)
    if isinstance(fit.result.solution, LeastSquares) or not known:
        return BudgetTable((), (), {}, helps)
    met = {source for p in known.values() for source in p.budget if p.budget[source] >= _SHOWN}
    sources = tuple(source for source in SOURCES if source in met)
    rows = {
        name: (
            "undetermined" if p.verdict is Verdict.UNDETERMINED else f"±{percent(_relative(p))}",
            tuple(p.budget.get(source, 0.0) for source in sources),
        )
        for name, p in known.items()
    }
    worded = fit.result.problem.options.anatomy.worded
    labels = tuple(worded(SOURCES[source].label) for source in sources)
    return BudgetTable(sources, labels, rows, (*what_would_help(fit), *helps))


#: The anchor of what to measure next.
NEXT = "next"


def budget_section(budget: BudgetTable) -> block.Section:
    """What would help, the chart, and its numbers."""
    text = (
        "Where the uncertainty of each parameter comes from: shares of the variance behind its "
        "95 % interval. Shares of errors that are estimated together overlap; they are scaled to "
        "add up to 100 %."
        if budget.rows
        else "The intervals of this fit contain the noise of the torque and nothing else: errors "
        "of the laboratory, and other models, are not in them. A fit with model auto shows what "
        "they add."
    )
    blocks: list[block.Block] = [block.Text(text)]
    if budget.helps:
        blocks.append(block.Points("What would help:", budget.helps, NEXT))
    if budget.rows:
        labels = budget.labels
        first = [labels[shares.index(max(shares))] for _, shares in budget.rows.values()]
        main = max(dict.fromkeys(first), key=first.count)
        alt = (
            f"Stacked bars of the shares of the variance of {len(first)} parameters; the largest "
            f"share of {first.count(main)} of them is {main}."
        )
        caption = (
            "Shares of the variance; at the right, how well the parameter is known (half of the "
            "95 % interval)."
        )
        blocks.append(block.Picture("budget", alt, caption, "map"))
    return block.Section("What makes each parameter unsure", tuple(blocks), "budget", "page")


def what_would_help(fit: AssessedFit) -> tuple[str, ...]:
    """What to measure so that parameters that are not identified would be known better.

    A sentence for each source that is a quarter of a parameter's variance and whose knowledge
    would narrow its interval by a fifth; none of a fit that is inadequate, for its intervals mean
    nothing, and none of a named model, which knows of noise alone.
    """
    result = fit.result
    assessment = fit.assessment
    named = isinstance(result.solution, LeastSquares)
    if named or assessment.adequacy.grade is Grade.INADEQUATE:
        return ()
    gains: dict[str, dict[str, tuple[float, str]]] = {}

    def note(remedy: str, name: str, part: float) -> None:
        """A parameter that is not identified, and whose interval would shrink to a part."""
        p = assessment.parameters.get(name)
        if p is None or p.ci95 is None or p.verdict not in (Verdict.WEAK, Verdict.UNDETERMINED):
            return
        before = _relative(p)
        if part < _SHRINKS and part * before <= 1.0:
            text = f"{name} would be known to ±{percent(part * before)}"
            text += f" instead of ±{percent(before)}"
            gains.setdefault(remedy, {})[name] = part, text

    known = assessment.uncertainty
    worded = result.problem.options.anatomy.worded
    stated = result.problem.settings.knowledge
    for name in result.problem.free:
        budget = known.budget(known.along(name))
        for source, without in budget.without.items():
            if budget.shares.get(source, 0.0) >= _WORTH:
                note(worded(advice(source, stated)), name, without / budget.sd)
    for muscle, words in _MUSCLES.items():
        if muscle == "tib2" and "film_scale_tib" not in result.problem.free:
            continue
        filmed = covariance_if_filmed(result, known, muscle)
        if filmed is not None:
            parts = np.sqrt(np.diag(filmed) / np.diag(known.covariance(*result.problem.free)))
            for name, part in zip(result.problem.free, parts.tolist(), strict=True):
                note(worded(words), name, part)
    narrowed = {remedy: sorted(by_name.values()) for remedy, by_name in gains.items()}
    ranked = sorted(narrowed, key=lambda remedy: -sum(1.0 - part for part, _ in narrowed[remedy]))
    return tuple(_sentence(remedy, narrowed[remedy]) for remedy in ranked)


def what_to_measure(assessment: Assessment) -> tuple[str, ...]:
    """How to find the trial that adds most to what is weak; nothing where that would not help."""
    weak = [
        p.name
        for p in assessment.parameters.values()
        if p.free and p.verdict in (Verdict.WEAK, Verdict.UNDETERMINED)
    ]
    if not weak or assessment.adequacy.grade is Grade.INADEQUATE:
        return ()
    return (
        f"The trial that adds most to {', '.join(weak)} is found by surae design --after FIT.json "
        "--output next.csv, or among the ready ones by surae.measure_next(fit).",
    )


def _sentence(remedy: str, narrowed: list[tuple[float, str]]) -> str:
    texts = [text for _, text in narrowed[:_NAMED]]
    if len(narrowed) > _NAMED:
        texts.append(f"{len(narrowed) - _NAMED} more would be known better")
    return f"{remedy[0].upper()}{remedy[1:]}, and {listed(texts)}.".replace("'", "’")


def _relative(p: ParameterEstimate) -> float:
    """Half-width of the 95 % interval as a part of the value."""
    low, high = p.ci95 or (0.0, 0.0)
    return (high - low) / 2.0 / abs(p.value) if p.value else float("inf")
