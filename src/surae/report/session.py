"""A session's report: the leg's page first, then its trials, measures and fits."""

from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime

from surae.base.formatting import percentage
from surae.base.units import on_page
from surae.base.words import JUDGEMENTS
from surae.inference import AssessedFit, Grade
from surae.measures import Measure, Measures
from surae.model.joint import ANKLE
from surae.report import block, trials
from surae.report.budget import budget_of, budget_section
from surae.report.figures import Figure
from surae.report.figures.holds import are_holds, holds_figure, holds_section
from surae.report.figures.research import budget_figure
from surae.report.figures.tendon import film_figure
from surae.report.figures.torque import fit_figure
from surae.report.figures.trials import trials_figure
from surae.report.laboratory import known_section
from surae.report.language import MEASURES, Words, words_in
from surae.report.leg import LegAnswers, leg_answers
from surae.report.leg_cards import is_told, on_page_of, titled
from surae.report.output import Report
from surae.report.parameters import parameters_section
from surae.report.recordings import film_block
from surae.report.traces import traces_of
from surae.report.wording import adequacy_words
from surae.trials import TrialSet, common_errors
from surae.trials.fitted_leg import FittedLeg
from surae.trials.folder import TOO_FEW


def answers_in(document: block.Document) -> tuple[tuple[str, str], ...]:
    """Each question of a leg's page, and its answer in a line."""
    page = next(b for b in document.blocks if isinstance(b, block.Section) and b.look == "leg")
    lines = []
    for card in page.blocks:
        assert isinstance(card, block.Section)
        answer = []
        for said in _every(card.blocks):
            if isinstance(said, block.AdequacyWords):
                answer.append(said.sentence)
            elif isinstance(said, block.Text) and said.look == "say":
                answer.append(f"{said.lead} {said.text}".strip())
        lines.append((card.title, "; ".join(answer)))
    return tuple(lines)


def _every(blocks: Iterable[block.Block]) -> Iterator[block.Block]:
    """Blocks, those that stand beside each other too."""
    for each in blocks:
        yield from _every(each.blocks) if isinstance(each, block.Section) else (each,)


def session_report(
    leg: FittedLeg,
    *,
    created: datetime,
    before: AssessedFit | None = None,
    language: str = "en",
    brief: bool = False,
) -> Report:
    """The leg's page: its answers, then, if not `brief`, details and research, in English alone."""
    shown = leg.main
    _ = words_in(language, ANKLE if shown is None else shown.result.problem.options.anatomy)
    contradicted = trials.contradictions(leg.alone, leg.together)
    answers = leg_answers(
        leg.session.trials,
        leg.fits,
        shown,
        _,
        contradicted=tuple(contradicted),
        before=before,
        nerve=leg.nerve,
        quality=leg.quality,
    )
    figures = dict(answers.figures)
    rest: tuple[block.Section, ...] = ()
    if answers.numbers is not None:
        rest = (_in_words(answers.numbers, answers.at, answers.of, _),)
    if language == "en" and not brief:
        rest += _details(leg, answers, contradicted, figures)
    written = _("Report of {date}.", date=f"{created:%Y-%m-%d %H:%M}")
    footer = _("Made by surae for research.")
    if language != "en":
        footer += " " + _("Trials, checks and fits are in the report in English.")
    document = block.Document(
        kicker=_about(leg.session, _),
        heading=leg.session.name,
        under=f"{_summary(leg, _)} {written}",
        title=leg.session.name,
        blocks=(
            *block.paragraphs(_warnings(leg, _), "warning"),
            block.Section("", answers.cards, look="leg"),
            *rest,
        ),
        footer=footer,
        language=language,
    )
    traces = () if leg.joint is None or language != "en" or brief else traces_of(leg.joint.result)
    return Report(document, figures.items(), traces)


def _details(
    leg: FittedLeg,
    answers: LegAnswers,
    contradicted: Mapping[str, list[str]],
    figures: dict[str, Figure],
) -> tuple[block.Section, ...]:
    """Details and research; their figures are added to `figures`."""
    shown = leg.main
    _ = words_in("en")
    details = [
        trials.trials_section(
            leg.session.trials, leg.alone, leg.failed, leg.quality, leg.joint_predictions
        )
    ]
    research: list[block.Section] = []
    if shown is not None:
        r2 = [f"R² {percentage(each.r2)} %" for each in shown.assessment.recordings]
        figures["torques"] = fit_figure(shown.result, r2)
        picture = block.Picture(
            "torques",
            "Measured torque of each trial, and the model’s.",
            "Measured torque (wide, pale) and the model’s (thin, dark), with its R².",
            "here",
        )
        details.append(block.Section("Torque", (picture,), "torques"))
        if are_holds(traced := traces_of(shown.result)):
            figures["holds"] = holds_figure(traced)
            details.append(holds_section(traced))
        details.append(
            block.Section(
                "The fit", (adequacy_words(shown.assessment.adequacy, shown.quality),), "fit"
            )
        )
        details += known_section(shown.result)
        if answers.measures is not None:
            research.append(_other_measures(answers.measures))
        for number, trial in enumerate(traced):
            for place, film in enumerate(trial.films):
                drawn = f"film-{number}-{place}"
                figures[drawn] = film_figure(trial, film)
                details.append(film_block(drawn, film))
        budget = budget_of(shown)
        if budget.rows:
            figures["budget"] = budget_figure(budget)
        research += [parameters_section(shown, next_anchor=""), budget_section(budget)]
    details.append(trials.findings_section(leg.quality, answers.zero))
    if leg.fits:
        figures["trials"] = trials_figure(leg.alone, leg.together, disputed=contradicted)
        research.append(trials.agreement_section(contradicted))
    if leg.predictions:
        research.append(
            trials.crossed_section(leg.predictions, leg.joint_predictions, leg.session.trials)
        )
    if leg.joint is not None:
        blocks = tuple(
            block.Explorer(number, f"Signals of {i.name}, and the model’s torque", summary=i.name)
            for number, i in enumerate(leg.joint.result.problem.inputs)
        )
        research.append(block.Section("Signals", blocks, "signals", "explorer"))
    return (
        block.Section("Details", tuple(details), "details", "more"),
        block.Section("Research", tuple(research), "research", "more"),
    )


def _has_words(m: Measure) -> bool:
    return m.name.partition("@")[0] in MEASURES


def _in_words(of_fit: Measures, at: float, of: str, _: Words) -> block.Section:
    """The measures that a clinician reads, at an angle [deg] or at none, `of` which trial alone.

    Of a fit that does not follow its torque only what rest tells is a number.
    """
    order = list(MEASURES)
    sound = of_fit.adequacy.grade is not Grade.INADEQUATE
    chosen = [
        m
        for m in of_fit.values()
        if (sound or m.basis == "rest")
        and _has_words(m)
        and is_told(m)
        and (m.name.endswith(f"@{at:g}deg") or "deg" not in m.name)
    ]
    chosen.sort(key=lambda m: order.index(m.name.partition("@")[0]))
    rows = (
        (titled(m, _), *_.estimate(*on_page_of(m)), _(JUDGEMENTS[m.verdict].plain)) for m in chosen
    )
    heads = block.columns("", _("Value"), "95 %", _("Judgement"), numbers=(1, 2), wide=(0,))
    table = block.Grid(_("The numbers"), heads, block.rows(rows))
    if not chosen:
        text = _("The fit is not good enough: first do what “Can I trust it?” says.")
        return block.Section(_("The numbers"), (block.Text(text),), "measures")
    alone = (block.Text(_("in {trial} alone", trial=of)),) if of else ()
    words = _(
        "Identified: the 95 % interval is within 10 % of the value, of an angle within 2°. Weak: "
        "it is wider; the estimate is weak, not the leg."
    )
    return block.Section(_("The numbers"), (*alone, table, block.Text(words, "note")), "measures")


def _other_measures(of_fit: Measures) -> block.Section:
    """Every other measure that is known, and how many are not."""
    every = list(of_fit.values())
    _ = words_in("en")
    rows: Iterator[block.Row] = (
        (
            block.Cell(m.name, kind="code", meaning=m.meaning),
            *_.estimate(*on_page_of(m)),
            on_page(m.unit)[0],
            _(JUDGEMENTS[m.verdict].plain),
        )
        for m in every
        if is_told(m) and not _has_words(m)
    )
    heads = block.columns(
        "Measure", "Value", "95 % interval", "Unit", "", numbers=(1, 2), wide=(0,)
    )
    unknown = sum(not is_told(m) for m in every)
    note = f"{unknown} measures are not known from these trials; surae measures lists why."
    table = block.Grid("Other measures that are known", heads, block.rows(rows))
    return block.Section("Other measures", (table, block.Text(note, "note")), "other-measures")


def _about(session: TrialSet, _: Words) -> str:
    """Which leg, when and how."""
    side = {"left": _("left leg"), "right": _("right leg")}.get(session.side or "", "")
    return ", ".join(filter(None, (side, session.date, session.condition, session.notes)))


def _warnings(leg: FittedLeg, _: Words) -> Iterable[str]:
    """What makes the answers less than they could be."""
    if leg.interrupted:
        yield _(
            "This run was stopped: only fits that were complete are used. The same command "
            "continues it."
        )
    why = leg.failed.get("joint", "")
    if leg.joint is None and len(leg.fits) > 1 and why:
        none = _("There is no fit of all trials together.")
        if why == TOO_FEW:
            yield " ".join((none, _("Trials with an error are not fitted together.")))
        else:
            yield f"{none} {why[:1].upper()}{why[1:]}." if _.language == "en" else none
    checked = (leg.quality[trial] for trial in leg.fits if trial in leg.quality)
    yield from common_errors(checked, None if _.language == "en" else _)


def _summary(leg: FittedLeg, _: Words) -> str:
    """What there was and what was done with it."""
    uses = [_("{n} fitted", n=str(len(leg.fits)))]
    if len(leg.joined) > 1:
        uses[0] += " " + _("({n} together)", n=str(len(leg.joined)))
    for message, count in (
        (_("{n} held still"), sum(t.use == "hold" for t in leg.session.trials)),
        (_("{n} perturbed"), sum(t.use == "nerve" for t in leg.session.trials)),
        (_("{n} of maximal effort"), sum(t.effort == "maximal" for t in leg.session.trials)),
        (_("{n} not used"), sum(bool(t.problem) for t in leg.session.trials)),
    ):
        if count:
            uses.append(message.format(n=count))
    return _.many(
        "{n} trial: {uses}.", "{n} trials: {uses}.", len(leg.session.trials), uses=", ".join(uses)
    )
