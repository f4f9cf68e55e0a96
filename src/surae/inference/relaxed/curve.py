"""The relaxed curve of one leg: its posterior, and what may be asked of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from surae.base.frozen import Comparable, FrozenDict
from surae.base.records import Listed
from surae.base.units import FloatArray
from surae.inference.judging.grade import Grade
from surae.inference.relaxed.basis import Basis
from surae.inference.relaxed.regressors import TAUS, lags

#: What the equations leave out, one standard deviation as a part of every torque and stiffness:
#: chosen from the coverage on two generators of virtual legs.
LEFT_OUT = 0.05
#: Possible legs that are drawn of each part of the posterior, half of them mirrored; their seed.
_DRAWS = 128
_SEED = 11
#: Speed of a slow stretch [deg/s], from where [deg]; degrees between two of its samples. The same
#: as of `measures.passive.slow_stiffness`.
SLOW_SPEED = 5.0
SLOW_FROM = -30.0
_STEP = 0.2
#: The curve is asked up to so many degrees beyond what rested.
BEYOND = 12.0
#: A relaxed angle was passed where three of four bins of this width around it [deg] hold rest for
#: so many seconds each, all together so many, and the leg rests for so many. Chosen by judgement:
#: how often intervals miss where there is less was not counted apart.
_BIN = 2.5
_BINS = 4
_ENOUGH_BINS = 3
_IN_EACH = 0.1
_TOGETHER = 0.5
_IN_ALL = 3.0
#: A leg moves, and does not hold, from this speed on [deg/s].
_MOVES = 0.3


@dataclass(frozen=True, slots=True)
class RestingTrial:
    """What a trial gave."""

    name: str  #: The trial's.
    seconds: float  #: Of rest in it.
    #: `low`, `high`: angles of its rest, by the device [deg]; None without rest.
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class Jump:
    """A step in mid-trial that was found, and taken off."""

    kind: str  #: ``"step"`` of the torque's zero [Nm], ``"slip"`` of the foot [deg].
    trial: str  #: Name of the trial.
    time: float  #: When [s].
    value: float  #: How large.
    sd: float  #: Its standard deviation.


@dataclass(frozen=True, slots=True, eq=False)
class RestSamples(Comparable):
    """Rest as it was measured, in blocks of an eighth of a second; arrays of shape (n,)."""

    angle: FloatArray  #: By the device [deg].
    velocity: FloatArray  #: [deg/s].
    #: What is left of the torque without foot, plate, sensor and inertia: the tissue's [Nm].
    torque: FloatArray
    seconds: float  #: Of each sample.


@dataclass(frozen=True, slots=True, eq=False)
class PossibleLegs(Comparable):
    """PossibleLegs that rest leaves possible; arrays of shape (n, …)."""

    share: FloatArray  #: Weight of each, which sum to one.
    weights: FloatArray  #: Of the curve's features [Nm].
    gamma: FloatArray  #: Relaxation, by `TAUS`.
    zero: FloatArray  #: Error of the angle's zero [deg].
    scale: FloatArray  #: What the equations leave out, about 1.


@dataclass(frozen=True, slots=True, eq=False)
class RelaxedCurve(Comparable):
    """Torque of one relaxed ankle over its angle, as its rest has it.

    Angles of its methods are the device's [deg], dorsiflexion positive. The posterior is a mixture
    of Gaussians of the curve's weights and ln γ: over the curve's size and bends, and over what
    foot, plate, sensor and nerve may be.
    """

    #: `low`, `high`: ends of what rested, by the device [deg].
    low: float
    high: float
    share: Listed  #: Weight of each part, shape (k,).
    mean: FloatArray  #: Means of weights [Nm] and ln γ, shape (k, p + 3).
    covariance: FloatArray  #: Their covariances, shape (k, p + 3, p + 3).
    moved: tuple[float, float]  #: 1st and 99th percentile of all angles, efforts included [deg].
    #: `zero_deg`, `zero_sd`: the ankle's angle where the device shows 0, and how far that is off.
    zero_deg: float
    zero_sd: float
    #: Torque zero, weight, inertia and the like: mean and standard deviation, by name.
    context: Mapping[str, tuple[float, float]]
    #: Posterior probability that there is one: ``plate``, ``reflex``, ``apart``.
    readings: Mapping[str, float]
    noise: float  #: Standard deviation of the noise, correlated or not [Nm].
    trials: tuple[RestingTrial, ...]
    steps: tuple[Jump, ...]
    grade: Grade  #: Of rest alone.
    findings: tuple[str, ...]  #: What was met, in sentences, the gravest first.
    samples: RestSamples  #: What was measured.
    #: Whether no electrode shows any effort, so that all is rest because it is meant to be.
    is_declared: bool = False
    #: Of each part, whether it reads a plate that nobody stated, and a reflex; empty: not known.
    parts: tuple[tuple[bool, bool], ...] = ()
    #: What each electrode shows of the rest, by muscle, in the unit of the EMG.
    levels: Mapping[str, float] = field(default_factory=FrozenDict)

    def __post_init__(self) -> None:
        """Make mappings read-only."""
        object.__setattr__(self, "context", FrozenDict(self.context))
        object.__setattr__(self, "readings", FrozenDict(self.readings))
        object.__setattr__(self, "levels", FrozenDict(self.levels))

    @property
    def basis(self) -> Basis:
        """The features of its curve."""
        return Basis(self.low, self.high)

    @property
    def seconds(self) -> float:
        """Seconds of rest."""
        return sum(trial.seconds for trial in self.trials)

    @property
    def is_still(self) -> bool:
        """Whether the ankle is held wherever it rests, so that nothing is seen to relax."""
        samples = self.samples
        moves = np.abs(samples.velocity) > _MOVES
        return bool(samples.seconds * np.count_nonzero(moves) < _IN_EACH)

    def passed(self, degrees: float, *, held: bool = False) -> bool:
        """Whether rest moved past an angle well enough; holds count if `held`."""
        samples = self.samples
        edges = degrees + _BIN * (np.arange(_BINS + 1) - 0.5 * _BINS)
        counts = held | (np.abs(samples.velocity) > _MOVES)
        seconds = samples.seconds * np.histogram(samples.angle[counts], edges)[0]
        return bool(
            np.count_nonzero(seconds >= _IN_EACH) >= _ENOUGH_BINS
            and seconds.sum() >= _TOGETHER
            and self.seconds >= _IN_ALL
        )

    def torque(self, degrees: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Relaxed torque at angles [deg]: mean [Nm], shape (n,), and covariance, shape (n, n)."""
        return self._linear(self.basis.features(self._within(degrees)))

    def stiffness(self, degrees: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Relaxed stiffness at angles [deg]: mean [Nm/deg] and covariance, as of `torque`."""
        return self._linear(self.basis.slopes(self._within(degrees)))

    def slow_torque(self, degrees: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Torque in a stretch at 5°/s from −30°: mean [Nm], covariance; only towards dorsiflexion.

        The stretch begins at −30° by the device, all tissue relaxed there.
        """
        angles, elastic, lagging = slow_features(self.low, self.high)
        at = np.atleast_1d(np.asarray(degrees, dtype=float))
        place = np.clip((at - angles[0]) / _STEP, 0, len(angles) - 1.001)
        i = place.astype(int)
        part = (place - i)[:, None]

        def there(rows: FloatArray) -> FloatArray:
            between: FloatArray = (1.0 - part) * rows[i] + part * rows[i + 1]
            return between

        return self._lagging(there(elastic), [there(each) for each in lagging])

    def slow_stiffness(self, degrees: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Slope of the slow torque over 2°: mean [Nm/deg], covariance, as of `slow_torque`."""
        at = np.atleast_1d(np.asarray(degrees, dtype=float))
        both, covariance = self.slow_torque(np.concatenate([at - 1.0, at + 1.0]))
        n = len(at)
        to = np.hstack([-np.eye(n), np.eye(n)]) / 2.0
        return to @ both, to @ covariance @ to.T

    def draws(self) -> PossibleLegs:
        """Possible legs, always the same: the parts' own, weighted, in mirrored pairs."""
        return _drawn(self)

    def curve_draws(self, degrees: npt.ArrayLike, count: int, seed: int = _SEED) -> FloatArray:
        """Relaxed torque [Nm] at angles of so many possible legs, shape (count, n)."""
        legs = self.draws()
        which = np.random.default_rng(seed).choice(len(legs.share), count, p=legs.share)
        rows = self.basis.features(self._within(degrees))
        return np.asarray(legs.scale[which, None] * (legs.weights[which] @ rows.T))

    def _within(self, degrees: npt.ArrayLike) -> FloatArray:
        at = np.atleast_1d(np.asarray(degrees, dtype=float))
        return np.asarray(np.clip(at, self.low - BEYOND, self.high + BEYOND))

    def _linear(self, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        p = self.basis.size
        means = np.array([rows @ mean[:p] for mean in self.mean])
        inner = np.array([rows @ C[:p, :p] @ rows.T for C in self.covariance])
        return self._mixed(means, inner)

    def _lagging(
        self, elastic: FloatArray, lagging: list[FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Mean and covariance of a torque in which tissue lags, by its derivatives."""
        p = self.basis.size
        means = []
        inner = []
        for mean, C in zip(self.mean, self.covariance, strict=True):
            gamma = np.exp(mean[p:])
            rows = elastic + sum(g * each for g, each in zip(gamma, lagging, strict=True))
            along = [g * (each @ mean[:p]) for g, each in zip(gamma, lagging, strict=True)]
            whole = np.hstack([rows, np.stack(along, axis=1)])
            means.append(rows @ mean[:p])
            inner.append(whole @ C @ whole.T)
        return self._mixed(np.array(means), np.array(inner))

    def _mixed(self, means: FloatArray, inner: FloatArray) -> tuple[FloatArray, FloatArray]:
        share = np.asarray(self.share)
        mean = share @ means
        away = means - mean
        spread = np.einsum("k,ki,kj->ij", share, away, away)
        covariance = np.tensordot(share, inner, 1) + spread + LEFT_OUT**2 * np.outer(mean, mean)
        return mean, covariance


@lru_cache(maxsize=16)
def slow_features(low: float, high: float) -> tuple[FloatArray, FloatArray, list[FloatArray]]:
    """Angles [deg] of a slow stretch, the curve's features there, and their lags."""
    basis = Basis(low, high)
    angles = np.arange(SLOW_FROM, max(high + BEYOND, SLOW_FROM + 1.0), _STEP)
    elastic = basis.features(np.clip(angles, low - BEYOND, high + BEYOND))
    return angles, elastic, lags(elastic, SLOW_SPEED / _STEP)


@lru_cache(maxsize=16)
def _drawn(curve: RelaxedCurve) -> PossibleLegs:
    p = curve.basis.size
    random = np.random.default_rng(_SEED)
    m = p + len(TAUS)
    half = random.standard_normal((_DRAWS // 2, m + 2))
    normal = np.vstack([half, -half])
    z = []
    for mean, covariance in zip(curve.mean, curve.covariance, strict=True):
        factor = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance)))
        z.append(mean + normal[:, :m] @ factor.T)
    every = np.vstack(z)
    parts = len(z)
    return PossibleLegs(
        np.repeat(np.asarray(curve.share) / _DRAWS, _DRAWS),
        every[:, :p],
        np.exp(np.clip(every[:, p:], -9.0, 2.0)),
        curve.zero_sd * np.tile(normal[:, m], parts),
        1.0 + LEFT_OUT * np.tile(normal[:, m + 1], parts),
    )
