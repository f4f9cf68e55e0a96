"""The clinical page: a question, one sentence of answer, and what it rests on, on one A4.

It bears no name of a patient or a file. It is written in English, Dutch, German or French, from the
sentences of clinical.toml, and claims no more than the measures and changes it is made of.
"""

import tomllib
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime
from functools import cache
from importlib.resources import files
from typing import TypeAlias

from surae._version import __version__
from surae.assessment import Adequacy, Assessment, Grade, Verdict
from surae.assessment.parameter import percent
from surae.errors import InputError
from surae.estimation import FitResult
from surae.files import PathLike
from surae.formatting import NO_NUMBER, ends, of_interval, significant
from surae.measures.change import Change, ChangeVerdict, Difference
from surae.measures.compute import measures
from surae.measures.curve import TorqueCurve, torque_curve
from surae.measures.measure import Measure, Measures
from surae.measures.norms import Placed, placed, read_norms
from surae.model.joint import ANKLE, Joint
from surae.model.sources import SOURCES
from surae.names import LANGUAGES
from surae.report.document import (
    AdequacyWords,
    Document,
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
from surae.report.figures import Figure
from surae.report.figures.clinical import curve_figure, shares_figure
from surae.report.output import Report
from surae.words import JUDGEMENTS


class Words:
    """The sentences of one language, about a joint."""

    def __init__(self, language: str, joint: Joint = ANKLE) -> None:
        if language not in LANGUAGES:
            known = ", ".join(LANGUAGES)
            raise InputError(f"no page in language {language!r}; use one of: {known}")
        if language != "en" and language not in joint.words:
            raise InputError(
                f"joint {joint.name!r} has no words in {language!r}; give [words.{language}]"
            )
        self.language, self.joint = language, joint

    def __call__(self, key: str, **given: str) -> str:
        """A sentence, filled in."""
        text = self.joint.worded(sentences()[key][self.language], self.language)
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


#: The angle of the answer by default [deg].
_AT = 10.0
#: Measures of the page, in this order, where they are given at the answer's angle.
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


def fit_page(
    result: FitResult, assessment: Assessment, *, created: datetime, language: str = "en",
    angle: float = _AT, norms: PathLike | None = None,
) -> Report:  # fmt: skip
    """The page of one fit.

    `language` is that of all sentences but the technical reasons; torque and stiffness are given at
    `angle` [deg]; `norms` are a laboratory's own, in place of those of cited papers.
    """
    joint = result.problem.options.anatomy
    words = Words(language, joint)
    of_fit = measures(result, assessment, [angle])
    beside = placed(of_fit, read_norms(norms, joint))
    shown = [m for name in _SHOWN for m in of_fit.values() if m.name.partition("@")[0] == name]
    heads = (words("value"), words("interval"), words("judgement"))
    rows = [_measured(m, of_fit.adequacy, words) for m in shown if m.value is not None]
    sections = (
        *_figure_sections([("", torque_curve(result, assessment), of_fit)], beside, words),
        _table(heads, rows, words),
        *_list("norms", (_beside(p, words) for p in beside), words),
        *_list("next", _next(assessment, words) or _nothing(of_fit, shown, words), words),
    )
    made = _made(words, created, len(result.problem.inputs))
    return _page("", _answer(of_fit, angle, words), of_fit.adequacy, sections, made, words)


def change_page(
    change: Change,
    sides: Sequence[tuple[FitResult, Assessment]],
    *,
    created: datetime,
    language: str = "en",
    angle: float = _AT,
) -> Report:
    """The page of two sessions or legs; parameters as of `fit_page`, `sides` the fits of both."""
    words = Words(language, sides[0][0].problem.options.anatomy)
    of_sides = [measures(*side, [angle]) for side in sides]
    curves = [torque_curve(*side) for side in sides]
    names = tuple(words(n) for n in (("first", "second") if change.legs else ("before", "after")))
    worst = max((side.adequacy for side in of_sides), key=lambda a: list(Grade).index(a.grade))
    looked_at = sum(
        d.p is not None for d in (*change.measures.values(), *change.parameters.values())
    )
    heads = (*names, words("difference"), words("interval"), words("judgement"))
    rows = [_differing(d, words, legs=change.legs) for d in _rows_of(change, angle)]
    note = "" if change.is_withheld else words("many", count=str(looked_at))
    sections = (
        *_figure_sections(list(zip(names, curves, of_sides, strict=True)), (), words),
        _table(heads, rows, words, note),
        *_list("next", _next(sides[1][1], words), words),
    )
    made = _made(words, created, sum(len(side[0].problem.inputs) for side in sides))
    what = "_legs" if change.legs else "_change"
    return _page(what, _answer_of_change(change, angle, words), worst, sections, made, words)


#: A section, and the figure in it.
_Section: TypeAlias = tuple[SectionBlock, Figure | None]


def _page(
    what: str,
    answer: str,
    adequacy: Adequacy,
    sections: Sequence[_Section],
    made: str,
    words: Words,
) -> Report:
    """The question `what`, its answer, what the fit is worth, and what that rests on."""
    grade = str(adequacy.grade)
    title = words(f"title{what}")
    document = Document(
        kicker="",
        heading=title,
        under=f"{words('name')}: {'_' * 24}",
        title=title,
        blocks=(
            TextBlock(words(f"question{what}"), "question"),
            TextBlock(answer, "answer"),
            AdequacyWords(grade, "", words(grade), adequacy.reasons),
            *(section for section, _ in sections),
        ),
        footer=made,
        language=words.language,
        look="sheet",
    )
    names = ("curve", "shares")
    figures = [figure for _, figure in sections if figure is not None]
    return Report(document, list(zip(names, figures, strict=False)))


def _table(
    heads: Sequence[str], rows: Sequence[TableRow], words: Words, note: str = ""
) -> _Section:
    table = TableBlock(words("figures"), columns("", *heads, wide=(0,)), rows_of(rows))
    return SectionBlock(words("figures"), (table, *paragraphs(filter(None, [note]), "note"))), None


def _list(key: str, texts: Iterable[str], words: Words) -> Iterator[_Section]:
    if points := tuple(texts):
        yield SectionBlock(words(key), (ListBlock("", points),)), None


def _figure_sections(
    sessions: Sequence[tuple[str, TorqueCurve, Measures]], beside: Sequence[Placed], words: Words
) -> Iterator[_Section]:
    """Torque against angle, and where it is known what the torque is made of."""
    picture = PictureBlock("curve", words("curve"), width=85)
    note = TextBlock(words("curve_note"), "note")
    drawn = _curve([(name, curve) for name, curve, _ in sessions], beside, words)
    yield SectionBlock(words("curve"), (picture, note)), drawn
    shares = [
        (name, [(words(part), of_session[part].value or 0.0) for part in _SHARES])
        for name, _, of_session in sessions
        if all(of_session[part].value is not None for part in _SHARES)
    ]
    if shares:
        picture = PictureBlock("shares", words("shares"), look="low", width=85)
        yield SectionBlock(words("shares"), (picture,)), shares_figure(shares)


def numbers_section(of_fit: Measures, angle: float) -> SectionBlock:
    """The measures that are known, torque and stiffness at an angle [deg], in words."""
    words, at = Words("en"), f"@{angle:g}deg"
    known = [
        _measured(m, of_fit.adequacy, words)
        for name in _SHOWN
        for m in of_fit.values()
        if m.name.partition("@")[0] == name
        and (m.name.endswith(at) or not m.name.endswith("deg"))
        and m.value is not None
        and m.ci95 is not None
        and m.verdict is not Verdict.UNDETERMINED
    ]
    heads = (words("value"), words("interval"), words("judgement"))
    (table,) = _table(heads, known, words)[0].blocks
    return SectionBlock("Measures", (table,), "measures")


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


def _measured(m: Measure, adequacy: Adequacy, words: Words) -> TableRow:
    value, low, high = _texts(m, words)
    unit = _unit(m.unit)
    interval = NO_NUMBER if low == NO_NUMBER else f"{low} … {high}"
    strong = m.verdict is Verdict.IDENTIFIED and adequacy.grade is not Grade.INADEQUATE
    verdict = TableCell(words.judgement(m.verdict), kind="strong" if strong else "")
    return (words.measure(m.name), f"{value}{unit}", interval, verdict)


def _differing(d: Difference, words: Words, *, legs: bool) -> TableRow:
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
    judgement = TableCell(verdict, kind="strong" if strong else "")
    return (words.measure(d.name), *both, *change, judgement)


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


def _curve(
    curves: Sequence[tuple[str, TorqueCurve]],
    beside: Sequence[Placed],
    words: Words,
    width: float = 7.2,
) -> Figure:
    labels = {key: words(key) for key in ("angle", "torque", "relaxed", "slow", "calf", "tibialis")}
    slow = [(p, words.own(p.norm.group)) for p in beside
            if p.norm.measure.startswith("slow_torque@")]  # fmt: skip
    return curve_figure(curves, slow, labels, width=width)
