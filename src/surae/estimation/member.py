"""A model of the family at its mode: its evidence, and what its subsets leave unsure."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.estimation.evidence import Quadratic, Subset
from surae.estimation.mode import Mode, Target
from surae.estimation.noise import NoiseModel, drawn_by, level_above, level_above_half
from surae.estimation.noisy_emg import noisy_emg
from surae.estimation.result import Candidate
from surae.estimation.shifts import along, sized
from surae.frozen import FrozenDict
from surae.model.laboratory import GROUPS, Belief, group_of
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Sum of squares, as a part of what least squares leave, from which a mode under correlated noise
#: has let the torque go; and the frequencies [Hz] whose noise counts then.
_LET_GO, _SLOW = 1.3, 2.0
#: By how much the distance of a mode under correlated noise from least squares may exceed what
#: noise makes it on average, which is taken for no less than that of so many free values.
_EXPLAINED, _LEAST = 3.0, 3.0
#: Part of the residual's slow power that noise of the EMG makes from which no frequency is trusted
#: more, and the draws that tell: 0.01 to 0.1 with envelopes, 0.3 to 0.9 with raw EMG.
_BY_EMG, _DRAWS = 0.5, 8


def under_noise(target: Target, mode: Mode) -> tuple[Target, Mode]:
    """The target under the noise that its residual has, and its mode.

    A noise model trusts most the frequencies with the least residual. Where the preparation's
    low-pass emptied them the noise is taken for level: the filter took the noise out of the torque,
    and the model's own errors not. Where others hold no signal, as above the cut-off of somebody
    else's filter, or where the model does not hold, its mode moves away from that of least squares
    by more than noise can move it (Hausman 1978). Then no frequency is trusted more than those that
    half of the residual lies below; and where that moves too far as well, samples count alike, for
    as little as the residual's slow part says. They do so too where noise of the EMG makes most of
    the residual: that is no noise of the torque, it is strong where the muscle is, and in the
    model's own columns.
    """
    white = target.with_noise(target.own_noise(mode.z, white=True))
    plain = white.descend(mode.z, evaluations=20, tolerance=0.03)
    noise = target.own_noise(plain.z)
    by_emg = noisy_emg(white, plain, white.quadratic(plain), draws=_DRAWS).part
    tried = (
        tuple(map(level_where_filtered, noise, target.problem.inputs)),
        tuple(level_above_half(model) for model in noise),
    )
    for believed in tried if by_emg <= _BY_EMG else ():
        correlated = target.with_noise(believed)
        there = correlated.descend(plain.z, evaluations=15, tolerance=0.01)
        if _as_near_as_noise(white, plain, correlated, noise, there):
            return correlated, there
    inflated = target.with_noise(counted_alike(target, noise))
    return inflated, inflated.descend(plain.z, evaluations=15, tolerance=0.01)


def level_where_filtered(noise: NoiseModel, recording: ModelInputs) -> NoiseModel:
    """The noise without what the preparation's low-pass took from it.

    At half of the cut-off the torque, sharpened, has lost 1 % of its power.
    """
    if recording.lowpass is None:
        return noise
    return level_above(noise, 0.5 * recording.lowpass[0] / recording.rate_hz)


def counted_alike(target: Target, noise: Sequence[NoiseModel]) -> tuple[NoiseModel, ...]:
    """White noise for which samples count for as little as the slow part of a noise says."""
    return tuple(
        replace(
            model,
            coefficients=np.zeros(0),
            variance=max(model.below(_SLOW / recording.rate_hz), model.variance),
        )
        for model, recording in zip(noise, target.problem.inputs, strict=True)
    )


def _as_near_as_noise(
    white: Target, plain: Mode, correlated: Target, noise: Sequence[NoiseModel], there: Mode
) -> bool:
    """Whether a mode under correlated noise is as far from least squares as noise explains.

    The distance is that of the modelled torques, Σ (ΔT/σ)², along the tangent; what noise of this
    correlation makes of it is the trace of the information times what least squares are less
    certain, both where least squares are.
    """
    if correlated.sum_of_squares(there.z) > _LET_GO * white.sum_of_squares(plain.z):
        return False
    q = len(plain.z)
    information, meat = np.zeros((q, q)), np.zeros((q, q))
    for block, own, its in zip(white.data_rows(plain.z), white.noise, noise, strict=True):
        rows = block[:-1]
        information += rows @ rows.T
        coloured = drawn_by(rows, its) / np.sqrt(own.variance)
        meat += coloured @ coloured.T
    prior = np.diag(white.weight**2)
    inverse = np.linalg.inv(information + prior)
    least_squares = inverse @ (meat + prior) @ inverse
    weighted = correlated.quadratic(plain).solved({})[2]
    away = there.z - plain.z
    distance = float(away @ information @ away)
    expected = float(np.trace(information @ (least_squares - weighted)))
    return distance <= _EXPLAINED * max(expected, _LEAST)


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

    def between_subsets(self) -> FloatArray:
        """Shifts that other subsets of nuisances add, as they are searched, shape (r, q)."""
        chosen = self.alternatives[0]
        others = [s for s in self.alternatives if s.weight >= UNSUPPORTED]
        apart = np.stack([np.sqrt(s.weight) * (s.mode - chosen.mode) for s in others])
        wider = sum(s.weight * s.variance for s in others) - chosen.variance
        far = np.sum(apart**2, axis=0)
        more = np.maximum(far + wider, 0.0)
        # The subsets are of the target with all nuisances; the leg's parameters are in both.
        here, there = self._leg_at(self.target.names), self._leg_at(self.names_of_all)
        shared = [name for name in here if name in there]
        mine, its = ([at[name] for name in shared] for at in (here, there))
        moved, rest = (np.zeros((len(apart), len(self.mode.z))), np.zeros(len(self.mode.z)))
        moved[:, mine] = sized(apart, np.sqrt(np.minimum(more, far)))[:, its]
        rest[mine] = np.sqrt(np.maximum(more - far, 0.0))[its]
        return np.vstack([moved, along(rest, self.covariance())])

    def away_from(self, other: "Member", weight: float) -> FloatArray:
        """How far this one's parameters of the leg are from another's, times √weight.

        As the other's are searched, in the first order, shape (1, q).
        """
        here, there = self._leg_at(self.target.names), self._leg_at(other.target.names)
        far = np.zeros((1, len(other.mode.z)))
        mine, its = self.target.values(self.mode.z), other.target.values(other.mode.z)
        names, own = self.target.problem.spec.names, other.target.problem.spec.names
        scale = other.target.scale(other.mode.z)
        for name, j in there.items():
            if name in here:
                apart = mine[names.index(name)] - its[own.index(name)]
                far[0, j] = np.sqrt(weight) * apart / scale[j]
        return far

    @staticmethod
    def _leg_at(names: tuple[str, ...]) -> dict[str, int]:
        """Where the leg's own parameters are among the searched ones."""
        return {name: j for j, name in enumerate(names) if group_of(name) is None}

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
