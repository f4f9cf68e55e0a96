"""What torque tells of the muscles whatever arms and paths are: first in tables and reports."""

from collections.abc import Sequence

from surae.base.formatting import NO_NUMBER, of_interval
from surae.base.units import on_page
from surae.inference import AssessedFit
from surae.measures import Measure
from surae.measures.compute import judged_measures
from surae.measures.points import points
from surae.measures.table import INVARIANT
from surae.report import block
from surae.report.leg_cards import is_told, on_page_of

_NAMES = frozenset(definition.name for definition in INVARIANT)
_NOTE = (
    "No torque tells a muscle’s moment arm, nor how far the muscle travels, so that stiffness "
    "coefficients, lengths and EMG weights below are known only as well as these are. What is here "
    "does not hang on them: the recordings alone say how well it is known."
)


def is_invariant(measure: Measure) -> bool:
    """Whether a measure hangs on no arm and no path."""
    return measure.name.partition("@")[0] in _NAMES


def invariants(fit: AssessedFit) -> tuple[Measure, ...]:
    """Those of a fit that have a value, in the order of the table."""
    wanted = tuple(point for point in points() if point.definition.name in _NAMES)
    return tuple(m for _, m in judged_measures(fit, wanted) if m.value is not None)


def invariants_section(measures: Sequence[Measure]) -> block.Section:
    """A row for each that has a value; where its interval says nothing, that stands alone."""
    rows = []
    for m in measures:
        if m.value is None:
            continue
        text = of_interval(*on_page_of(m))
        rows.append(
            (
                block.Cell(m.name, kind="code", meaning=m.meaning),
                text.value if is_told(m) else NO_NUMBER,
                text.interval,
                on_page(m.unit)[0],
                block.verdict(m.verdict, why=m.note),
            )
        )
    heads = block.columns(
        "Measure", "Value", "95 % interval", "Unit", "Verdict", numbers=(1, 2), wide=(4,)
    )
    table = block.Grid("What torque tells, whatever arms and paths are", heads, block.rows(rows))
    title = "What torque tells of the muscles"
    return block.Section(title, (block.Text(_NOTE, "note"), table), "invariants", "page")
