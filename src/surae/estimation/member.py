"""A model of the family at its mode: its evidence, and what its subsets leave unsure."""

from dataclasses import dataclass, replace

import numpy as np

from surae.estimation.evidence import Quadratic, Subset
from surae.estimation.mode import Mode, Target
from surae.estimation.result import Candidate
from surae.frozen import FrozenDict
from surae.model.laboratory import GROUPS, Belief, group_of
from surae.units import FloatArray

#: Weight below which a subset or model of the family is not looked at.
UNSUPPORTED = 0.01
#: Odds beforehand of what few data tell from what it trades with.
ODDS = {"toe": 0.1}
TENDONS = {"dlt_tri": Belief(np.log(0.025), 1.0), "dlt_tib": Belief(np.log(0.010), 1.0)}


@dataclass(frozen=True, slots=True)
class Member:
    """A model of the family at its mode."""

    target: Target
    mode: Mode
    alternatives: tuple[Subset, ...]
    names_of_all: tuple[str, ...]
    quadratic: Quadratic

    @property
    def evidence(self) -> float:
        """−2 ln Z, tendons having the prior that legs have."""
        q = self.quadratic
        mean, weight = q.mean.copy(), q.weight.copy()
        for name, belief in TENDONS.items():
            if name in self.target.names:
                j = self.target.names.index(name)
                mean[j], weight[j] = belief.mean, 1.0 / belief.sd
        present = {group_of(name) for name in self.target.beliefs}
        against = -2.0 * sum(float(np.log(o)) for g, o in ODDS.items() if g in present)
        return replace(q, mean=mean, weight=weight).solved({})[0] + against

    def covariance(self) -> FloatArray:
        """Covariance of the searched coordinates, shape (q, q)."""
        return self.quadratic.solved({})[2]

    def between_subsets(self) -> dict[str, float]:
        """Standard deviation that other subsets of nuisances add, by parameter."""
        chosen = self.alternatives[0]
        moment = np.zeros(len(chosen.mode))
        for subset in self.alternatives:
            if subset.weight >= UNSUPPORTED:
                moment += subset.weight * (subset.variance + (subset.mode - chosen.mode) ** 2)
        more = np.sqrt(np.maximum(moment - chosen.variance, 0.0))
        # The subsets are of the target with all nuisances: its names come in the same order.
        names = [n for n in self.names_of_all if group_of(n) is None]
        scale = dict(zip(self.target.names, self.target.scale(self.mode.z).tolist(), strict=True))
        return {
            name: float(more[self.names_of_all.index(name)]) * scale[name]
            for name in names
            if name in scale
        }

    def away_from(self, other: "Member", weight: float) -> dict[str, float]:
        """How far this one's parameters of the leg are from another's, times √weight."""
        mine, its = self._leg(), other._leg()
        return {n: float(np.sqrt(weight) * abs(mine[n] - its[n])) for n in its if n in mine}

    def _leg(self) -> dict[str, float]:
        values = self.target.values(self.mode.z)
        names = self.target.problem.spec.names
        return {n: float(values[names.index(n)]) for n in self.target.names if not group_of(n)}

    def candidate(self, weight: float) -> Candidate:
        """What is told of it."""
        spec = self.target.problem.spec
        values = self.target.values(self.mode.z).tolist()
        present = {group_of(name) for name in self.target.beliefs}
        return Candidate(
            spec.name,
            tuple(group for group in GROUPS if group in present),
            self.evidence,
            weight,
            FrozenDict(zip(spec.names, values, strict=True)),
        )
