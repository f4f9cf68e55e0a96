"""The uncertainty budget of a fit that knows its laboratory: what makes a parameter unsure.

The covariance of a posterior is the sum of what each source makes of the estimates, exactly
(`surae.estimation.uncertainty`), so that shares of the variance add up to 1.

Another trial of the same leg has noise, drift, zero and errors of the EMG anew. What a leg and its
mounting share is wrong alike only as far as both trials ask the same: a wrong arm shifts another
parameter where movement and effort differ. It counts with a part of its variance (`SHARED`) in each
of them. What is added to a length is wrong alike in both.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.estimation.result import Family
from surae.frozen import FrozenDict
from surae.model.laboratory import group_of
from surae.model.sources import SOURCES
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class Budget:
    """What makes one parameter unsure."""

    sd: float  #: Standard deviation, everything included, in the parameter's unit.
    repeat: float  #: Standard deviation of the difference between two trials of the leg.
    shares: Mapping[str, float]  #: Parts of the variance by source; they add up to 1.
    without: Mapping[str, float]  #: Standard deviation that would be left with the source known.


def budgets(family: Family, free: tuple[str, ...]) -> dict[str, Budget]:
    """The budget of every parameter of the leg that was estimated, `free` being all of them."""
    parts = {source: np.sum(by**2, axis=0) for source, by in family.spread.items()}
    total = sum(parts.values(), np.zeros(len(free)))
    repeat = sum((2.0 * SOURCES[s].anew * part for s, part in parts.items()), np.zeros(len(free)))
    return {
        name: Budget(
            sd=float(np.sqrt(total[j])),
            repeat=float(np.sqrt(repeat[j])),
            shares=FrozenDict({s: float(part[j] / total[j]) for s, part in parts.items()}),
            without=FrozenDict(
                {
                    s: float(np.sqrt(max(total[j] - part[j], 0.0)))
                    for s, part in parts.items()
                    if SOURCES[s].knowable
                }
            ),
        )
        for j, name in enumerate(free)
        if group_of(name) is None and total[j] > 0.0
    }


def drawn_anew(family: Family, *, mounted: bool = False) -> FloatArray:
    """Covariance of the estimates in another trial, or with electrodes and foot mounted anew."""
    return sum(
        (SOURCES[s].anew_when(mounted=mounted) * by.T @ by for s, by in family.spread.items()),
        np.zeros_like(family.covariance),
    )
