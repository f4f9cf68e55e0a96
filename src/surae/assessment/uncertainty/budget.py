"""The uncertainty budget of a fit that knows its laboratory: what makes a parameter unsure.

The covariance V of all that was estimated, nuisances with their priors included, is the parameters'
marginal one. With one group of nuisances known the rest has the conditional covariance, and what a
variance loses by that is the group's part; what is left with all of them known is noise. Other
parts, of the EMG's noise, the integrator, and models that the data do not reject, add to it. The
parts of the nuisances overlap; shares are scaled so that they add up to 1 (as in the GUM's tables).

Another trial of the same leg would be wrong alike in what trials share. With the true crosstalk,
delay and axis fixed, the mode under priors P scatters by V·(V⁻¹ − P)·V from trial to trial; a
torque zero is drawn anew each time.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.estimation.result import Family
from surae.frozen import FrozenDict
from surae.model.laboratory import EACH_TRIAL, group_of
from surae.model.sources import FRESH, SOURCES, source_of
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class Budget:
    """What makes one parameter unsure."""

    sd: float  #: Standard deviation, everything included, in the parameter's unit.
    repeat: float  #: Standard deviation of the difference between two trials of the leg.
    shares: Mapping[str, float]  #: Parts of the variance by source; they add up to 1.
    without: Mapping[str, float]  #: Standard deviation that would be left with the source known.


def budgets(family: Family, free: tuple[str, ...]) -> dict[str, Budget]:
    """The budget of every parameter of the leg that was estimated.

    `free` are the estimated parameters, as its covariance has them.
    """
    V = family.covariance
    groups: dict[str, list[int]] = {}
    for j, name in enumerate(free):
        if (of := source_of(name)) is not None:
            groups.setdefault(of.name, []).append(j)
    everything = sorted({j for positions in groups.values() for j in positions})
    repeat, deviations = _repeat(family, free), family.deviations()
    table = {}
    for j, name in enumerate(free):
        if group_of(name) is not None:
            continue
        marginal = float(V[j, j])
        parts = {"noise": variance_given(V, j, everything)}
        without = {}
        for source, positions in groups.items():
            left = variance_given(V, j, positions)
            parts[source] = max(marginal - left, 0.0)
            without[source] = left
        scale = marginal / sum(parts.values()) if marginal > 0 else 0.0
        parts = {source: scale * part for source, part in parts.items()}
        added = {source: float(by[j]) ** 2 for source, by in deviations.items()}
        total = marginal + sum(added.values())
        if not total > 0.0:
            continue
        parts |= added
        again = sum(added.get(source, 0.0) for source in FRESH)
        table[name] = Budget(
            sd=float(np.sqrt(total)),
            repeat=float(np.sqrt(2.0 * (max(float(repeat[j]), 0.0) + again))),
            shares=FrozenDict({source: part / total for source, part in parts.items()}),
            without=FrozenDict(
                {
                    source: float(np.sqrt(left + sum(added.values())))
                    for source, left in without.items()
                }
                | {
                    s: float(np.sqrt(total - part))
                    for s, part in added.items()
                    if SOURCES[s].knowable
                }
            ),
        )
    return table


def variance_given(V: FloatArray, j: int, known: list[int]) -> float:
    """Variance of a parameter with others known; a parameter does not make itself known."""
    known = [i for i in known if i != j]
    if not known:
        return float(V[j, j])
    cross = V[j, known]
    return float(max(V[j, j] - cross @ np.linalg.pinv(V[np.ix_(known, known)]) @ cross, 0.0))


def _repeat(family: Family, free: tuple[str, ...]) -> FloatArray:
    """Variance of each estimate from trial to trial of one leg, shape (p,)."""
    shared = np.zeros(len(free))
    for j, name in enumerate(free):
        belief = family.beliefs.get(name)
        if belief is not None and group_of(name) not in EACH_TRIAL:
            shared[j] = 1.0 / belief.sd**2
    V = family.covariance
    return np.asarray(np.diag(V) - np.einsum("ij,j,ij->i", V, shared, V))
