"""What makes each parameter unsure, in shares of its variance, and what would make it known."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.assessment.adequacy import Grade
from surae.assessment.parameter import percent
from surae.assessment.uncertainty.budget import budgets
from surae.estimation import FitResult
from surae.model.sources import SOURCES, Fill
from surae.protocol.planning.filming import covariance_if_filmed
from surae.report.document import (
    Block,
    ListBlock,
    PictureBlock,
    SectionBlock,
    TableBlock,
    TableCell,
    TableRow,
    TextBlock,
    columns,
    rows_of,
)

#: Share of a variance from which a source is shown, and from which it is worth a remedy.
_SHOWN, _WORTH = 0.005, 0.25
#: A remedy is told of where the interval shrinks to less than this part.
_SHRINKS = 0.8
#: Muscles that may be filmed, and what sentences call them.
_MUSCLES = {"tib": "tibialis", "gm": "gastrocnemius"}
#: Parameters that are named with one remedy.
_NAMED = 4


@dataclass(frozen=True, slots=True)
class BudgetRow:
    """One parameter: how well it is known, and its shares of the variance in the sources' order."""

    name: str
    known: str
    shares: tuple[float, ...]
    texts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class BudgetSection:
    """The uncertainty budget."""

    text: str  #: What the shares are, or why there are none.
    #: `keys`, `sources`, `looks`: the sources that are shown: names in FIT.json, words, and a
    #: background in CSS.
    keys: tuple[str, ...]
    sources: tuple[str, ...]
    looks: tuple[str, ...]
    #: Estimated parameters with an interval; empty where nothing but noise is looked at.
    rows: tuple[BudgetRow, ...]
    helps: tuple[str, ...]  #: What to measure, and how much better which parameter would be known.
    alt: str  #: The chart in words.


def budget_section(result: FitResult, assessment: Assessment) -> BudgetSection:
    """Put the budgets of all parameters in one table."""
    known = {p.name: p for p in assessment.parameters.values() if p.budget and p.ci95}
    if result.family is None or not known:
        return BudgetSection(
            "The intervals of this fit contain the noise of the torque and nothing else: what the "
            "laboratory cannot rule out, and other models, are not in them. A fit with model auto "
            "says what they add.",
            (), (), (), (), what_to_measure(assessment), "",
        )  # fmt: skip
    met = {source for p in known.values() for source in p.budget if p.budget[source] >= _SHOWN}
    keys = [source for source in SOURCES if source in met]
    rows = []
    for name, p in known.items():
        shares = tuple(p.budget.get(key, 0.0) for key in keys)
        known_to = f"±{percent(_relative(p))}"
        if p.verdict is Verdict.UNDETERMINED:
            known_to = "undetermined"
        rows.append(BudgetRow(name, known_to, shares, tuple(map(_written, shares))))
    first = [keys[row.shares.index(max(row.shares))] for row in rows]
    main = max(dict.fromkeys(first), key=first.count)
    return BudgetSection(
        text=(
            "Where the uncertainty of each parameter comes from: shares of the variance behind its "
            "95 % interval. The shares of what is estimated along overlap and are scaled to add up."
        ),
        keys=tuple(keys),
        sources=tuple(SOURCES[key].label for key in keys),
        looks=tuple(css(SOURCES[key].look) for key in keys),
        rows=tuple(rows),
        helps=(*what_would_help(result, assessment), *what_to_measure(assessment)),
        alt=(
            f"Stacked bars of the shares of the variance of {len(rows)} parameters; the largest "
            f"share of {first.count(main)} of them is {SOURCES[main].label}."
        ),
    )


#: Hatches as lines: their directions [°] in CSS.
_LINES = {"/": (135,), "\\": (45,), "x": (45, 135), "-": (0,), "|": (90,), "+": (0, 90)}


def css(look: Fill) -> str:
    """A source's look as a CSS background, of the workbench's palette."""
    lines = [
        f"repeating-linear-gradient({angle}deg, var(--ink) 0 1px, transparent 1px 5px)"
        for angle in _LINES.get(look.hatch, ())
    ]
    if look.hatch == ".":
        lines = ["radial-gradient(var(--ink) 1px, transparent 1.2px) 0 0 / 5px 5px"]
    return ", ".join((*lines, f"linear-gradient(var(--{look.colour}) 0 0)"))


#: The anchor of what to measure next.
NEXT = "next"


def budget_blocks(budget: BudgetSection) -> SectionBlock:
    """The budget as it is shown: what would help, the chart, and its numbers."""
    blocks: list[Block] = [TextBlock(budget.text)]
    if budget.helps:
        blocks.append(ListBlock("What would help:", budget.helps, NEXT))
    if budget.rows:
        caption = (
            "Shares of the variance; at the right, how well the parameter is known (half of the "
            "95 % interval)."
        )
        blocks.append(PictureBlock("budget", budget.alt, caption, "map"))
        every = range(2, 2 + len(budget.sources))
        heads = columns("Parameter", "Known to", *budget.sources, numbers=every, wide=every,
                        looks={1: "number value"})  # fmt: skip
        rows: Iterator[TableRow] = (
            (TableCell(row.name, kind="code"), row.known, *row.texts) for row in budget.rows
        )
        title = "Shares of the variance of every parameter by source"
        blocks.append(TableBlock(title, heads, rows_of(rows), "budget"))
    return SectionBlock("What makes each parameter unsure", tuple(blocks), "budget", "page")


def what_would_help(result: FitResult, assessment: Assessment) -> tuple[str, ...]:
    """What to measure so that parameters that are not identified would be known better.

    A sentence for each source that is a quarter of a parameter's variance and whose knowledge
    would narrow its interval by a fifth; none of a fit that is inadequate, for its intervals mean
    nothing, and none of a named model, which knows of noise alone.
    """
    if result.family is None or assessment.adequacy.grade is Grade.INADEQUATE:
        return ()
    gains: dict[str, list[tuple[float, str]]] = {}
    for name, budget in budgets(result.family, result.problem.free).items():
        p = assessment.parameters.get(name)
        if p is None or p.ci95 is None or p.verdict not in (Verdict.WEAK, Verdict.UNDETERMINED):
            continue
        before = _relative(p)
        for source, without in budget.without.items():
            part = without / budget.sd
            if budget.shares.get(source, 0.0) < _WORTH:
                continue
            if part < _SHRINKS and part * before <= 1.0:
                after = f"{name} would be known to ±{percent(part * before)}"
                text = f"{after} instead of ±{percent(before)}"
                gains.setdefault(source, []).append((part, text))
    by_remedy = {SOURCES[source].advice: narrowed for source, narrowed in gains.items()}
    by_remedy |= _films(result, assessment)
    ranked = sorted(by_remedy.items(), key=lambda gain: -sum(1.0 - part for part, _ in gain[1]))
    return tuple(_sentence(remedy, sorted(narrowed)) for remedy, narrowed in ranked)


def _films(result: FitResult, assessment: Assessment) -> dict[str, list[tuple[float, str]]]:
    """What a film of each muscle that has none would narrow."""
    gains: dict[str, list[tuple[float, str]]] = {}
    for muscle, words in _MUSCLES.items():
        filmed = covariance_if_filmed(result, muscle)
        if filmed is None or result.family is None:
            continue
        for j, name in enumerate(result.problem.free):
            p = assessment.parameters.get(name)
            if p is None or p.ci95 is None or p.verdict not in (Verdict.WEAK, Verdict.UNDETERMINED):
                continue
            part = float(np.sqrt(filmed[j, j] / result.family.covariance[j, j]))
            before = _relative(p)
            if part < _SHRINKS and part * before <= 1.0:
                text = f"{name} would be known to ±{percent(part * before)}"
                text = f"{text} instead of ±{percent(before)}"
                gains.setdefault(f"film the {words}", []).append((part, text))
    return gains


def what_to_measure(assessment: Assessment) -> tuple[str, ...]:
    """How to find the trial that adds most to what is weak; nothing where that would not help."""
    weak = [
        p.name for p in assessment.parameters.values()
        if p.free and p.verdict in (Verdict.WEAK, Verdict.UNDETERMINED)
    ]  # fmt: skip
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
    *others, last = texts
    joined = f"{', '.join(others)} and {last}" if others else last
    return f"{remedy[0].upper()}{remedy[1:]}, and {joined}.".replace("'", "’")


def _relative(p: ParameterEstimate) -> float:
    """Half-width of the 95 % interval as a part of the value."""
    low, high = p.ci95 or (0.0, 0.0)
    return (high - low) / 2.0 / abs(p.value) if p.value else float("inf")


def _written(share: float) -> str:
    if share < _SHOWN:
        return "–"
    return f"{100 * share:.0f} %" if share >= 0.01 else "< 1 %"
