"""Where each start of a fit ended."""

from dataclasses import dataclass

import numpy as np

from surae.estimation import FitResult
from surae.report.formatting import NO_NUMBER, significant


@dataclass(frozen=True, slots=True)
class StartRow:
    """One start: its number, sum of squares [Nm²], excess over the best, and how it ended."""

    number: int
    sse: str
    excess: str
    agrees: bool
    iterations: int
    outcome: str


def start_rows(result: FitResult) -> tuple[StartRow, ...]:
    """The starts in the order in which they were made."""
    order = sorted(range(len(result.starts)), key=lambda i: _finite(result.starts[i].sse))
    best = result.starts[order[0]].sse
    agreeing = set(order[: result.agreeing])
    return tuple(
        StartRow(
            number=index + 1,
            sse=significant(start.sse, 6),
            excess=_excess(start.sse, best),
            agrees=index in agreeing,
            iterations=start.iterations,
            outcome=start.outcome,
        )
        for index, start in enumerate(result.starts)
    )


def _finite(sse: float) -> float:
    return sse if np.isfinite(sse) else np.inf


def _excess(sse: float, best: float) -> str:
    """Write by which part a sum of squares exceeds the best one."""
    if not np.isfinite(sse) or best <= 0:
        return NO_NUMBER
    part = 100 * (sse / best - 1)
    if part == 0:
        return "best"
    return f"+{significant(part, 2)} %" if part >= 1e-4 else "< 0.0001 %"
