"""The page of a second opinion on other programs' muscle parameters."""

from collections.abc import Iterator, Sequence
from datetime import datetime
from typing import TypeAlias

from surae.base.words import N_
from surae.exchange.against_recording import AgainstRecording
from surae.exchange.foreign_result import ForeignResult, ForeignValue
from surae.exchange.opinion import JudgedValue, counted, disputed_said, parts, recording_said
from surae.report import block
from surae.report.language import Words, words_in
from surae.report.output import Report

#: A result, its values, and what a recording says of them.
Judged: TypeAlias = tuple[ForeignResult, Sequence[JudgedValue], AgainstRecording | None]
#: What a recording says of a length.
_TOLD = {
    "contradicted": N_("speaks against it"),
    "disputed": N_("speaks against it or another"),
    "confirmed": N_("tells it"),
    "untold": N_("does not tell it"),
}
#: What is said of a value, in a word or two, the gravest first.
KINDS = {
    "contradicted": N_("against the recording"),
    "outside-human": N_("no human’s"),
    "at-limit": N_("at bound"),
    "at-shared-end": N_("at a common end"),
    "at-start": N_("never moved"),
    "generic": N_("generic"),
    "generic-scaled": N_("generic, scaled"),
    "plain-part": N_("plain part of generic"),
}
#: Names of parameters.
_NAMES = {
    "optimal_fiber_length": N_("Optimal fibre length"),
    "tendon_slack_length": N_("Slack length of the tendon"),
    "max_isometric_force": N_("Largest force"),
    "pennation_angle": N_("Pennation"),
    "max_contraction_velocity": N_("Largest speed of shortening"),
    "tendon_strain": N_("Strain of the tendon at the largest force"),
    "tendon_stiffness": N_("Stiffness of the tendon"),
    "activation_time": N_("Time constant of activation"),
    "electromechanical_delay": N_("Electromechanical delay"),
    "activation_nonlinearity": N_("Curvature of activation"),
    "emg_scale": N_("Scale of the EMG"),
    "c1": N_("Filter coefficient C1"),
    "c2": N_("Filter coefficient C2"),
    "shape_factor": N_("Shape factor"),
    "strength_coefficient": N_("Strength coefficient"),
}
#: Units as they are shown, and their size.
_SHOWN = {"m": ("mm", 1e3), "rad": ("°", 57.29577951308232), "s": ("ms", 1e3), "1": ("", 1.0)}


def opinion_report(
    results: Sequence[Judged],
    *,
    created: datetime,
    language: str = "en",
) -> Report:
    """The page of what is said of some results, in a language."""
    _ = words_in(language)
    sections = [block.Section(_("In short"), tuple(_short(results, _)), "short")]
    for place, (result, values, by_recording) in enumerate(results, start=1):
        sections.append(_of_result(result, values, f"result{place}", _))
        if by_recording is not None:
            sections.append(_of_recording(by_recording, f"recording{place}", _))
    sections.append(block.Section(_("How to read it"), tuple(_reading(_)), "reading"))
    title = _("A second opinion on muscle parameters")
    document = block.Document(
        kicker="",
        heading=title,
        under=_("Report of {date}.", date=f"{created:%Y-%m-%d %H:%M}"),
        title=title,
        blocks=tuple(sections),
        footer=_("Made by surae for research."),
        language=language,
    )
    return Report(document, [])


def _short(results: Sequence[Judged], _: Words) -> Iterator[block.Block]:
    """How many values of each result are doubtful."""
    for result, values, by_recording in results:
        met = sum(1 for value in values if value.remarks)
        text = _(
            "{file} ({program}): of {count} values {met} are doubtful or not of this leg.",
            file=result.path,
            program=result.program,
            count=str(len(values)),
            met=str(met),
        )
        yield block.Text(text, "say")
        if by_recording is not None:
            yield block.Text(_(recording_said(by_recording)), "say")
            if (disputed := disputed_said(by_recording)) is not None:
                yield block.Text(_(disputed), "say")
    heads = block.columns(_("Result"), *(_(word) for word in KINDS.values()))
    rows = []
    for result, values, _told in results:
        counts = counted(values)
        rows.append((result.path, *(str(counts.get(kind, 0)) for kind in KINDS)))
    yield block.Grid(_("Counts"), heads, block.rows(rows))


def _of_result(
    result: ForeignResult, values: Sequence[JudgedValue], anchor: str, _: Words
) -> block.Section:
    """The values of a result that something is said of."""
    heads = block.columns(
        _("Muscle"),
        _("Parameter"),
        _("Value"),
        _("Unit"),
        _("Of generic"),
        _("Judgement"),
        _("What is said"),
        numbers=(2, 4),
        wide=(6,),
    )
    rows = [_row(value, _) for value in values if value.remarks]
    notes = [block.Text(_(note), "note") for note in result.notes]
    if not rows:
        nothing = _("Nothing speaks against these values. That is no proof that they are right.")
        return block.Section(result.path, (block.Text(nothing), *notes), anchor)
    table = block.Grid(result.path, heads, block.rows(rows))
    return block.Section(result.path, (table, *notes), anchor)


def _of_recording(against: AgainstRecording, anchor: str, _: Words) -> block.Section:
    """What a recording says of each length."""
    heads = block.columns(
        _("Muscle"),
        _("Parameter"),
        _("Value [mm]"),
        _("R² lost by a tenth [%]"),
        _("Best alone [mm]"),
        _("R² gained there [%]"),
        _("The recording"),
        numbers=(2, 3, 4, 5),
    )
    rows = []
    verdicts = against.verdicts()
    for each in against.told:
        numbers = (1e3 * each.value, each.drop, 1e3 * each.better, each.gain)
        shown = (_.number(f"{number:.3g}".replace("-", "−")) for number in numbers)
        word = _(_TOLD[verdicts[each.muscle, each.parameter]])
        rows.append((each.muscle, _(_NAMES[each.parameter]), *shown, word))
    title = _("What the recording says")
    about = _(
        "How strong each muscle is for its EMG, the lag of its activation, foot and plate and the "
        "torque’s zero are chosen as well as they can be; then one length is changed and all else "
        "stays. Less than nothing lost means that another length is followed better."
    )
    table = block.Grid(title, heads, block.rows(rows))
    return block.Section(title, (table, block.Text(about, "note")), anchor)


def _row(value: JudgedValue, _: Words) -> tuple[str, ...]:
    of = value.of
    part = parts(of)
    number, unit = _number(of, _)
    return (
        of.muscle,
        _(_NAMES[of.parameter]),
        number,
        unit,
        "" if part is None else _.number(f"{part:.4g}"),
        ", ".join(_(KINDS[kind]) for kind in value.kinds),
        " ".join(_(remark.sentence) for remark in value.remarks),
    )


def _number(of: ForeignValue, _: Words) -> tuple[str, str]:
    """A value as it is shown, and its unit."""
    unit, size = _SHOWN.get(of.unit, (of.unit, 1.0))
    if of.generic == 1.0 and of.parameter.endswith("_length"):
        unit, size = "", 1.0  # a part of a length
    return _.number(f"{size * of.value:.5g}".replace("-", "−")), unit


def _reading(_: Words) -> Iterator[block.Block]:
    """What the judgements mean, and what this is not."""
    yield block.Text(
        _(
            "At bound: the search was stopped there, so the value is that of whoever set the "
            "limit. Generic or never moved: the value is of the model before anybody was measured. "
            "At a common end: several muscles have the same lowest or highest value, as at a limit "
            "that the file does not state. No human’s: beyond what 21 dissected legs and older "
            "sources show of adults."
        )
    )
    yield block.Text(
        _(
            "What is not listed has passed these looks and is not shown to be right: a fit may "
            "follow its data with other values as well."
        ),
        "note",
    )
