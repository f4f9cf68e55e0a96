"""What compliant tendons change in the parameters of the muscles."""

import math
from collections.abc import Mapping, Sequence

from surae.assessment.assess import Assessment
from surae.assessment.comparison.finding import ModelScore, ParameterChange, best_of


def changes(
    scores: Sequence[ModelScore], worth: Mapping[str, Assessment]
) -> tuple[ParameterChange, ...]:
    """Parameters that leave their 95 % intervals when the tendons are no longer rigid.

    `worth` is of the fits to all data, by model. The largest relative change comes first; a
    parameter without interval in either fit is left out.
    """
    rigid = best_of(scores, rigid=True)
    if rigid is None:
        return ()
    changed = [
        change
        for score in scores
        if not score.rigid and score.aicc is not None
        for change in _changed(score.model, worth[rigid.model], worth[score.model])
    ]
    return tuple(sorted(changed, key=lambda c: -math.inf if c.percent is None else -abs(c.percent)))


def _changed(model: str, rigid: Assessment, compliant: Assessment) -> list[ParameterChange]:
    changed = []
    for name, before in rigid.parameters.items():
        after = compliant.parameters.get(name)
        if after is None or not (before.free and after.free):
            continue
        widths = [(p.ci95[1] - p.ci95[0]) / 2 for p in (before, after) if p.ci95 is not None]
        half = max(widths, default=math.inf)
        change = after.value - before.value
        if abs(change) > half:
            percent = 100 * change / before.value if before.value else None
            changed.append(
                ParameterChange(model, name, after.unit, before.value, after.value, percent, half)
            )
    return changed
