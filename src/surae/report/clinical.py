"""The clinical page: a question, one sentence of answer, and what it rests on, on one A4.

It bears no name of a patient or a file. It is written in English, Dutch, German or French, from the
sentences of clinical.toml, and claims no more than the measures and changes it is made of.
"""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from surae._version import __version__
from surae.assessment import Adequacy, Assessment, Grade, Verdict
from surae.assessment.parameter import percent
from surae.errors import InputError
from surae.estimation import FitResult
from surae.files import PathLike, template
from surae.formatting import NO_NUMBER, ends, of_interval, significant
from surae.measures.change import Change, ChangeVerdict, Difference
from surae.measures.compute import measures
from surae.measures.curve import TorqueCurve, torque_curve
from surae.measures.measure import Measure, Measures
from surae.measures.norms import Placed, placed, read_norms
from surae.model.sources import SOURCES
from surae.names import LANGUAGES
from surae.report.document import (
    ListBlock,
    PictureBlock,
    SectionBlock,
    TableBlock,
    TableCell,
    TableRow,
    TextBlock,
    columns,
    paragraphs,
    rows_of,
)
from surae.words import JUDGEMENTS

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Words:
    """The sentences of one language."""

    def __init__(self, language: str) -> None:
        if language not in LANGUAGES:
            known = ", ".join(LANGUAGES)
            raise InputError(f"no page in language {language!r}; use one of: {known}")
        self.language = language

    def __call__(self, key: str, **given: str) -> str:
        """A sentence, filled in."""
        text = sentences()[key][self.language]
        return text.format(**given) if given else text

    def judgement(self, verdict: str) -> str:
        """What the page says for a verdict."""
        text: str = getattr(JUDGEMENTS[verdict].clinic, self.language)
        return text

    def number(self, text: str) -> str:
        """A number as it is written here."""
        return text if self.language == "en" else text.replace(".", ",")

    def angle(self, degrees: float) -> str:
        """An angle of the ankle with its direction."""
        return self("dorsal" if degrees >= 0.0 else "plantar", degrees=f"{abs(degrees):g}°")

    def own(self, text: str) -> str:
        """A text of a norm, translated where the page knows it."""
        return self(text) if text in sentences() else text

    def measure(self, name: str) -> str:
        """What a measure is called here; its own name where the page has none."""
        base, _, at = name.partition("@")
        if base not in sentences():
            return name
        at = at.replace("deg", "°").replace("s", " s").replace("-", "−")
        return self(base).replace("{at}", at)


@cache
def sentences() -> dict[str, dict[str, str]]:
    """Every sentence by its key and language."""
    text = files("surae.report").joinpath("clinical.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


#: The angle that the answer speaks of unless others were asked [deg].
_AT = 10.0
#: Measures of the page, in this order, where they are told at the answer's angle.
_SHOWN = (
    "passive_torque", "passive_stiffness", "slow_torque", "slow_stiffness", "neutral_angle",
    "relaxed_share", "active_torque_max_tri", "active_torque_max_tib", "optimal_angle_tri",
    "activation_half_time", "delay",
)  # fmt: skip
_SHARES = ("tissue_share", "neural_share", "inertia_share", "gravity_share")
#: Parameters whose uncertainty says what to measure next.
_LEADING = ("k_tri", "x0_tri", "k_tib", "x0_tib", "l0_tri", "f0")
#: Most remedies, and most changes that one sentence names.
_MOST_NEXT, _MOST_NAMED = 3, 2


@dataclass(frozen=True, slots=True)
class ShownRow:
    """One line of the table, as texts."""

    name: str
    cells: tuple[str, ...]
    verdict: str
    is_strong: bool


@dataclass(frozen=True, slots=True)
class ClinicalPage:
    """What the page says, in one language."""

    language: str  #: Of all texts.
    #: `title`, `question`, `answer`: what is asked, and the one sentence that answers it.
    title: str
    question: str
    answer: str
    grade: str  #: Of the fit, or the worse of two.
    adequacy: str  #: The grade in words.
    reasons: tuple[str, ...]  #: Technical, in English.
    heads: tuple[str, ...]  #: Of the table's columns.
    rows: tuple[ShownRow, ...]  #: The numbers.
    norms: tuple[str, ...]  #: How the leg lies among groups, with the source of each.
    next: tuple[str, ...]  #: What to measure next.
    made: str  #: When, and of how many recordings.
    note: str  #: On multiplicity; empty for one session.
    images: Mapping[str, str] = field(default_factory=dict)  #: Figures as data URLs.
    words: Mapping[str, str] = field(default_factory=dict)  #: The other texts of the page.


def fit_page(
    result: FitResult, assessment: Assessment, *, created: datetime, language: str = "en",
    angle: float = _AT, norms: PathLike | None = None,
) -> ClinicalPage:  # fmt: skip
    """The page of one fit.

    `language` is that of all sentences but the technical reasons; torque and stiffness are told at
    `angle` [deg]; `norms` are a laboratory's own, in place of those of cited papers.
    """
    words = Words(language)
    of_fit = measures(result, assessment, [angle])
    beside = placed(of_fit, read_norms(norms))
    shown = [m for name in _SHOWN for m in of_fit.values() if m.name.partition("@")[0] == name]
    return ClinicalPage(
        language=language,
        title=words("title"),
        question=words("question"),
        answer=_answer(of_fit, angle, words),
        grade=str(of_fit.adequacy.grade),
        adequacy=words(str(of_fit.adequacy.grade)),
        reasons=of_fit.adequacy.reasons,
        heads=("", words("value"), words("interval"), words("judgement")),
        rows=tuple(_measured(m, of_fit.adequacy, words) for m in shown if m.value is not None),
        norms=tuple(_beside(p, words) for p in beside),
        next=_next(assessment, words) or _nothing(of_fit, shown, words),
        made=_made(words, created, len(result.problem.inputs)),
        note="",
        images=_figures([("", torque_curve(result, assessment), of_fit)], beside, words),
        words=_labels(words),
    )


def curve_of(
    result: FitResult, assessment: Assessment, *, language: str = "en",
    norms: PathLike | None = None, width: float = 7.2,
) -> "Figure":  # fmt: skip
    """The torque-angle curve of a fit by itself, as the page has it.

    `norms` are a laboratory's own, in place of those of cited papers; `width` is in inches. A fit
    that is not adequate says so below the curve.
    """
    from surae.report.figures import footnote

    words = Words(language)
    beside = placed(measures(result, assessment, [_AT]), read_norms(norms))
    figure = _curve([("", torque_curve(result, assessment))], beside, words, width)
    if assessment.adequacy.grade is not Grade.ADEQUATE:
        footnote(figure, words(str(assessment.adequacy.grade)))
    return figure


def change_page(
    change: Change,
    sides: Sequence[tuple[FitResult, Assessment]],
    *,
    created: datetime,
    language: str = "en",
    angle: float = _AT,
) -> ClinicalPage:
    """The page of two sessions or legs; parameters as of `fit_page`, `sides` the fits of both."""
    words = Words(language)
    of_sides = [measures(*side, [angle]) for side in sides]
    curves = [torque_curve(*side) for side in sides]
    names = tuple(words(n) for n in (("first", "second") if change.legs else ("before", "after")))
    worst = max((side.adequacy for side in of_sides), key=lambda a: list(Grade).index(a.grade))
    count = sum(len(side[0].problem.inputs) for side in sides)
    looked_at = sum(
        d.p is not None for d in (*change.measures.values(), *change.parameters.values())
    )
    return ClinicalPage(
        language=language,
        title=words("title_legs" if change.legs else "title_change"),
        question=words("question_legs" if change.legs else "question_change"),
        answer=_answer_of_change(change, angle, words),
        grade=str(worst.grade),
        adequacy=words(str(worst.grade)),
        reasons=worst.reasons,
        heads=("", *names, words("difference"), words("interval"), words("judgement")),
        rows=tuple(_differing(d, words, legs=change.legs) for d in _rows_of(change, angle)),
        norms=(),
        next=_next(sides[1][1], words),
        made=_made(words, created, count),
        note="" if change.is_withheld else words("many", count=str(looked_at)),
        images=_figures(list(zip(names, curves, of_sides, strict=True)), (), words),
        words=_labels(words),
    )


def clinical_html(page: ClinicalPage) -> str:
    """The page as one HTML file that asks nothing of the outside."""
    return template("clinical.html.j2", "surae.report").render(page=page, blocks=blocks_of(page))


def blocks_of(page: ClinicalPage) -> tuple[SectionBlock, ...]:
    """What the answer rests on: the curve, the shares, the numbers, groups, and what is next."""
    words = page.words
    curve = (
        PictureBlock("curve", words["curve"], look="curve", width=85),
        TextBlock(words["curve_note"], "note"),
    )
    blocks = [SectionBlock(words["curve"], curve)]
    if "shares" in page.images:
        shares = PictureBlock("shares", words["shares"], look="shares", width=85)
        blocks.append(SectionBlock(words["shares"], (shares,)))
    rows: Iterator[TableRow] = (
        (row.name, *row.cells, TableCell(row.verdict, kind="strong" if row.is_strong else ""))
        for row in page.rows
    )
    table = TableBlock(words["figures"], columns(*page.heads, wide=(0,)), rows_of(rows))
    note = paragraphs(filter(None, [page.note]), "note")
    blocks.append(SectionBlock(words["figures"], (table, *note)))
    for title, texts in ((words["norms"], page.norms), (words["next"], page.next)):
        if texts:
            blocks.append(SectionBlock(title, (ListBlock("", texts),)))
    return tuple(blocks)


def _answer(of_fit: Measures, angle: float, words: Words) -> str:
    torque = of_fit[f"passive_torque@{angle:g}deg"]
    stiffness = of_fit[f"passive_stiffness@{angle:g}deg"]
    inadequate = of_fit.adequacy.grade is Grade.INADEQUATE
    if inadequate or torque.ci95 is None or stiffness.ci95 is None:
        return words("answer_none")
    numbers = {"angle": words.angle(angle)}
    for name, m in (("torque", torque), ("stiffness", stiffness)):
        value, low, high = _texts(m, words)
        numbers |= {name: value, f"{name}_low": low, f"{name}_high": high}
    if {torque.verdict, stiffness.verdict} == {Verdict.IDENTIFIED}:
        return words("answer", **numbers)
    if torque.verdict in (Verdict.IDENTIFIED, Verdict.WEAK):
        return words("answer_weak", **numbers)
    return words("answer_none")


def _answer_of_change(change: Change, angle: float, words: Words) -> str:
    rows = {d.name for d in _rows_of(change, angle)}
    changed = sorted(change.changed, key=lambda d: d.name not in rows)  # what the page shows first
    if changed:
        named = ", ".join(_named(d, words) for d in changed[:_MOST_NAMED])
        return words("answer_differ" if change.legs else "answer_changed", names=named)
    if change.is_withheld:
        return words("answer_doubtful")
    every = (*change.measures.values(), *change.parameters.values())
    if all(d.verdict is ChangeVerdict.NOT_COMPARABLE for d in every):
        return words("answer_incomparable")
    d = change.measures.get(f"passive_stiffness@{angle:g}deg")
    same = "alike" if change.legs else "unchanged"
    if d is None or d.smallest is None or not d.before:
        return words(f"answer_{same}_bare")
    smallest = words.number(percent(abs(d.smallest / d.before)))
    return words(f"answer_{same}", smallest=smallest, angle=words.angle(angle))


def _rows_of(change: Change, angle: float) -> list[Difference]:
    """The differences that the page shows: those at its angle, and those at none."""
    rows = []
    for name in _SHOWN:
        for d in change.measures.values():
            base, _, at = d.name.partition("@")
            there = not at.endswith("deg") or at == f"{angle:g}deg"
            if base == name and there and not (d.before is None and d.after is None):
                rows.append(d)
    return rows


def _named(d: Difference, words: Words) -> str:
    name = words.measure(d.name)
    if d.difference is None or not d.before or d.unit == "deg":
        return name
    sign = "+" if d.difference > 0 else "−"
    return f"{name} ({sign}{words.number(percent(abs(d.difference / d.before)))})"


def _texts(m: Measure, words: Words) -> tuple[str, str, str]:
    """Value and both ends of the interval."""
    if m.value is None or m.ci95 is None:
        return (NO_NUMBER if m.value is None else words.number(significant(m.value, 3)),
                NO_NUMBER, NO_NUMBER)  # fmt: skip
    text = of_interval(m.value, m.ci95)
    value, low, high = map(words.number, (text.value, *ends(m.value, m.ci95)))
    return value, low, high


def _measured(m: Measure, adequacy: Adequacy, words: Words) -> ShownRow:
    value, low, high = _texts(m, words)
    unit = _unit(m.unit)
    interval = NO_NUMBER if low == NO_NUMBER else f"{low} … {high}"
    strong = m.verdict is Verdict.IDENTIFIED and adequacy.grade is not Grade.INADEQUATE
    return ShownRow(
        words.measure(m.name), (f"{value}{unit}", interval), words.judgement(m.verdict), strong
    )


def _differing(d: Difference, words: Words, *, legs: bool) -> ShownRow:
    unit = _unit(d.unit)
    both = tuple(
        NO_NUMBER if v is None else f"{words.number(significant(v, 3))}{unit}"
        for v in (d.before, d.after)
    )
    if d.difference is None or d.ci95 is None:
        change = (NO_NUMBER, NO_NUMBER)
    else:
        text = of_interval(d.difference, d.ci95)
        change = (words.number(text.value), words.number(text.interval))
    strong = d.verdict is ChangeVerdict.CHANGED
    judged = d.smallest is not None or d.difference is None
    verdict = NO_NUMBER
    if judged:
        verdict = words("differs") if strong and legs else words.judgement(d.verdict)
    return ShownRow(words.measure(d.name), (*both, *change), verdict, strong)


def _beside(p: Placed, words: Words) -> str:
    return words(
        "norm",
        measure=words.measure(p.norm.measure),
        below=p.text,
        group=words.own(p.norm.group),
        n=str(p.norm.n),
        condition=words.own(p.norm.condition),
        reference=p.norm.reference,
    )


def _next(assessment: Assessment, words: Words) -> tuple[str, ...]:
    """What would help most, by what makes the leading parameters unsure."""
    weights: dict[str, float] = {}
    for name in _LEADING:
        p = assessment.parameters.get(name)
        if p is None or p.verdict is Verdict.IDENTIFIED or not p.free:
            continue
        for source, share in (p.budget or {"noise": 1.0}).items():
            weights[source] = weights.get(source, 0.0) + share
    ranked = sorted(weights, key=lambda s: -weights[s])
    leading = [s for s in ranked if weights[s] >= 0.25 * weights[ranked[0]]]
    remedies = [getattr(SOURCES[source].remedy, words.language) for source in leading]
    return tuple(dict.fromkeys(remedies))[:_MOST_NEXT]


def _nothing(of_fit: Measures, shown: Sequence[Measure], words: Words) -> tuple[str, ...]:
    """Say that nothing is to be measured, where all that the page shows is known."""
    known = all(m.verdict is Verdict.IDENTIFIED for m in shown if m.value is not None)
    return (words("next_none"),) if known and of_fit.adequacy.grade is Grade.ADEQUATE else ()


def _made(words: Words, created: datetime, count: int) -> str:
    return words("made", date=created.strftime("%Y-%m-%d"), count=str(count), version=__version__)


def _unit(unit: str) -> str:
    text = unit.replace("deg", "°").strip("-")
    return text if text in ("", "°") else f" {text}"


def _labels(words: Words) -> dict[str, str]:
    keys = ("curve", "curve_note", "shares", "figures", "next", "norms", "name")
    return {key: words(key) for key in keys}


def _figures(
    sessions: Sequence[tuple[str, TorqueCurve, Measures]], beside: Sequence[Placed], words: Words
) -> dict[str, str]:
    from surae.report.figures import data_url, svg
    from surae.report.figures.clinical import shares_figure

    shares = [
        (name, [(words(part), of_session[part].value or 0.0) for part in _SHARES])
        for name, _, of_session in sessions
        if all(of_session[part].value is not None for part in _SHARES)
    ]
    figures = {"curve": _curve([(name, curve) for name, curve, _ in sessions], beside, words)}
    if shares:
        figures["shares"] = shares_figure(shares)
    return {name: data_url(svg(figure)) for name, figure in figures.items()}


def _curve(
    curves: Sequence[tuple[str, TorqueCurve]],
    beside: Sequence[Placed],
    words: Words,
    width: float = 7.2,
) -> "Figure":
    from surae.report.figures.clinical import curve_figure

    labels = {key: words(key) for key in ("angle", "torque", "relaxed", "slow", "calf", "tibialis")}
    slow = [(p, words.own(p.norm.group)) for p in beside
            if p.norm.measure.startswith("slow_torque@")]  # fmt: skip
    return curve_figure(curves, slow, labels, width=width)
