"""The pages of tissue and reflex: perturbed recordings in one table, each with its figures."""

from datetime import datetime
from math import nan

from surae.base.formatting import NO_NUMBER, percentage, significant
from surae.report import block
from surae.report.figures import Figure
from surae.report.language import words_in
from surae.report.output import Report
from surae_nerve.answer import Impedance, measure_rows
from surae_nerve.card import stretches_figure
from surae_nerve.figures import effort_figure, frequency_figure, impulse_figure
from surae_nerve.impedance import Perturbed
from surae_nerve.session import told_of
from surae_nerve.stretches import Stretches

#: What the page says of itself.
_ABOUT = (
    "The foot was moved by a few degrees at random. Torque is taken for that of two paths side by "
    "side: tissue, which answers at once, and a reflex, which answers the velocity of stretch in "
    "one direction, later. Intervals contain noise that is not white, drift, and what structures "
    "say that describe the torque about as well. No word of this is a diagnosis."
)

#: What the page of stretches says of itself.
_STRETCHES = (
    "Elastic is the rise of tissue’s torque, relaxed; viscous and inertial the largest of tissue’s "
    "and of foot and device; neural the largest beyond them after 30 ms. Beside a reflex the "
    "viscous torque may be off by as much as itself, the elastic one by a quarter. Without EMG "
    "only torque that rises when the foot has stopped is taken for neural: tissue’s falls. EMG "
    "begins where it exceeds its rest by three standard deviations for 25 ms (Hodges and Bui "
    "1996); the threshold is the angle of onset over its velocity, at none (Levin and Feldman "
    "1994). No word of this is a diagnosis."
)


def impedance_report(impedance: Impedance, *, created: datetime) -> Report:
    """The report of perturbed recordings."""
    figures: list[tuple[str, Figure]] = []
    several = len(impedance.recordings) > 1
    sections = []
    if several:
        sections.append(_section("All recordings, means", measure_rows(impedance.measures)))
        figures.append(("effort", effort_figure(impedance.recordings)))
        sections.append(block.Section("Stiffness over effort and angle", (block.Picture(
            "effort", "Stiffness over mean torque and over mean angle",
            "Stiffness of each recording with its 95 % interval. A torque’s zero that is not known "
            "shifts the axis.", "here",
        ),)))  # fmt: skip
    for number, recording in enumerate(impedance.recordings, 1):
        sections.append(_recording(recording, number, figures))
    told = {row[0]: row for row in measure_rows(impedance.measures)}
    key = tuple(
        (label, value if value == NO_NUMBER else f"{value} {unit}", verdict)
        for label, (_, value, _, unit, verdict, _) in (
            ("stiffness of tissue", told["intrinsic_stiffness"]),
            ("reflex’s share", told["reflex_share"]),
        )
    )
    document = block.Document(
        kicker="How much is nerve?",
        heading="Tissue and reflex, from perturbations",
        under=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        title="Tissue and reflex",
        blocks=(
            block.KeyFigures(
                (("reflex", impedance.reflex.verdict, impedance.reflex.direction or ""), *key)
            ),
            block.Text(f"{impedance.reflex.reason}.", lead=f"Reflex: {impedance.reflex.verdict}:"),
            block.Text(_ABOUT, "note"),
            *sections,
        ),
        footer="Made by surae for research.",
    )
    return Report(document, figures)


def stretches_report(found: Stretches, *, created: datetime) -> Report:
    """The report of slow and fast stretches."""
    table, figures, pictures = found.as_table(), list[tuple[str, Figure]](), list[block.Block]()
    for way in dict.fromkeys(s.direction for s in found.stretches):
        own = [told_of(s) for s in found.stretches if s.direction == way]
        figures.append((way, stretches_figure(own, words_in("en"))))
        caption = f"Elastic and neural torque in stretches to {way}; bars are 95 % intervals."
        pictures.append(block.Picture(way, f"Torque over speed, {way}", caption, "here", 62))
    # which recording is told where there are several
    first = 1 if len({s.recording for s in found.stretches}) == 1 else 0
    heads, rows = table.heads[first:], [row[first:] for row in table.rows]
    numbers = tuple(k for k, head in enumerate(heads) if head in table.numbers)
    columns = block.columns(*heads, numbers=numbers, wide=(len(heads) - 1,))
    grid = block.Grid("Stretches", columns, block.rows(rows), look="small")
    document = block.Document(
        kicker="How much is nerve?",
        heading="Slow and fast stretches",
        under=created.strftime("%Y-%m-%d %H:%M %Z").strip(),
        title="Slow and fast stretches",
        blocks=(
            *(block.Text(f"{line}.") for line in table.below),
            *pictures,
            block.Section("Every stretch", (grid,)),
            block.Text(_STRETCHES, "note"),
        ),
        footer="Made by surae for research.",
    )
    return Report(document, figures)


def _section(title: str, rows: list[tuple[str, ...]], *more: block.Block) -> block.Section:
    heads = ("Measure", "Value", "95 % interval", "Unit", "Verdict", "Note")
    cells = [
        (name, value, ci, unit, block.verdict(verdict), note)
        for name, value, ci, unit, verdict, note in rows
    ]
    table = block.Grid(title, block.columns(*heads, numbers=(1, 2), wide=(5,)), block.rows(cells))
    return block.Section(title, (table, *more))


def _recording(r: Perturbed, number: int, figures: list[tuple[str, Figure]]) -> block.Section:
    """A recording's table, figures and what else to know."""
    name = r.path.replace("\\", "/").rsplit("/", 1)[-1]
    figures += [
        (f"frequency-{number}", frequency_figure(r)),
        (f"impulse-{number}", impulse_figure(r)),
    ]
    steady = "changes" if r.stationarity.verdict == "changes" else "is steady"
    held, alone, other = map(
        percentage, (r.vaf_held_out, r.vaf_held_out_intrinsic, r.vaf_held_out_other)
    )
    parts = ", ".join(significant(value, 3) for _, value, _ in r.stationarity.parts)
    halves = " and ".join(
        "{} ({} to {})".format(*(significant(x, 3) for x in half)) for half in r.stationarity.halves
    )
    structures = []
    for label, (value, low, high) in r.structures.items():
        ends = (low, high) if low < high else (nan, nan)  # some tell a value alone
        structures.append((label, *(significant(x, 3) for x in (value, *ends))))
    return _section(
        name, measure_rows(r.measures),
        block.Text(f"{r.reflex.reason}.", lead=f"Reflex: {r.reflex.verdict}:"),
        block.Text(
            f"Responses of both paths, of the first half, predict {held} % of the second half’s "
            f"torque; tissue alone {alone} %, a reflex the other way round {other} %. Stiffness of "
            f"the halves: {halves} Nm/rad; of every 10 s: {parts}: it {steady}."
        ),
        *(block.Text(note, "note") for note in r.notes),
        block.Grid(
            "Stiffness by structure",
            block.columns("Structure", "Nm/rad", "from", "to", numbers=(1, 2, 3)),
            block.rows(structures), titled=True,
        ),
        block.Picture(f"frequency-{number}", "Coherence, gain and phase of torque over angle",
                      "Torque over angle: measured, and as the equations have it.", "here"),
        block.Picture(f"impulse-{number}", "Impulse responses of tissue and reflex",
                      "Answers to an impulse: of tissue to the angle, of the reflex to velocity.",
                      "here"),
    )  # fmt: skip
