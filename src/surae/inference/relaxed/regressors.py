"""What the torque of a resting leg is made of, by column: made at a high rate, then averaged."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from surae.base.units import FloatArray
from surae.inference.relaxed.basis import Basis
from surae.inference.relaxed.rest import REST_SHARE, Mask
from surae.signals import ModelInputs

#: Times of relaxation [s]: a spectrum that a few decades need (Fung 1993, chapter 7).
TAUS = (0.2, 1.0, 5.0)
#: Rates [Hz] at which regressors are made, and at which torque is compared: noise between 8 and
#: 64 Hz says nothing about a relaxed leg, and an angle that lags its gear there a wrong thing.
_FINE = 64.0
_COARSE = 8.0
#: Seconds that a piece of rest has at least, and before the next step of a change that is tried.
LEAST_PIECE = 1.0
#: Friction builds up over so many degrees after a reversal: short-range stiffness, bearings.
_DAHL = 1.0
#: A reflex answers after so many seconds, through activation's filter of so many Hz; it is stronger
#: where the calf is long, e-fold over so many degrees.
_LATENCY = 0.04
_ACTIVATION = 2.0
_LONGER = 15.0
#: Part of the slowest blocks in which acceleration is noise; σ over a median of magnitudes.
_SLOWEST = 0.2
_MAD = 1.4826
#: Acceleration that a foot does not feel [rad/s²]: less than 0.05 Nm; a device that holds gives way
#: to the torque, so that the angle follows the torque there.
_NO_INERTIA = 1.0
#: Degrees beyond the resting range up to which the curve is followed within a trial.
_BEYOND = 3.0
#: Times in which what went before a piece of rest dies out [s].
_PAST = (1.0, 5.0)
#: Columns that every leg has, in this order.
SHARED = (
    "weight",
    "tilt",
    "viscosity",
    "friction",
    "inertia",
    "reflex",
    "reflex_long",
    "constant",
    "tone_calf",
    "tone_tibialis",
)


@dataclass(frozen=True, slots=True)
class Blocks:
    """One trial in blocks: averages of what was measured, and where the leg rests."""

    name: str
    rate_hz: float  #: Of the blocks.
    time: FloatArray  #: [s], shape (n,).
    angle: FloatArray  #: [deg].
    torque: FloatArray  #: [Nm].
    velocity: FloatArray  #: [deg/s].
    fine: "Fine"
    pieces: tuple[tuple[int, int], ...]  #: First block of each piece of rest, and that after it.


@dataclass(frozen=True, slots=True)
class Fine:
    """The movement at the higher rate."""

    rate_hz: float
    per_block: int  #: Samples in a block.
    degrees: FloatArray
    velocity: FloatArray  #: [rad/s].
    acceleration: FloatArray  #: [rad/s²].
    shares: FloatArray  #: As of `Rest`, no more than at rest, shape (n, 2).


@dataclass(frozen=True, slots=True)
class Columns:
    """All columns of the model at the blocks of rest; shapes (n, …)."""

    basis: Basis
    elastic: FloatArray  #: Features of E.
    lagging: tuple[FloatArray, ...]  #: The part of each that has not relaxed, by `TAUS`.
    context: FloatArray  #: What is no tissue.
    names: tuple[str, ...]  #: Of the context's columns.
    torque: FloatArray  #: [Nm].
    angle: FloatArray  #: [deg].
    time: FloatArray  #: [s], of its own trial.
    trial: FloatArray  #: Number of the trial.
    cuts: tuple[int, ...]  #: Where pieces begin, and the end.

    @property
    def everything(self) -> FloatArray:
        """Elastic, lagging, context and torque side by side."""
        last = (self.context, self.torque[:, None])
        return np.hstack([self.elastic, *self.lagging, *last])


def averaged(values: FloatArray, count: int) -> FloatArray:
    """Means of so many samples each; what does not fill a block is left out."""
    n = len(values) // count
    blocks: FloatArray = values[: n * count].reshape(n, count, *values.shape[1:]).mean(axis=1)
    return blocks


def blocks_of(trial: ModelInputs, rests: Mask, shares: FloatArray) -> Blocks:
    """A trial in blocks of an eighth of a second; `shares` are as of `Rest`, shape (n, 2)."""
    assert trial.torque is not None
    first = max(round(trial.rate_hz / _FINE), 1)
    rate = trial.rate_hz / first
    velocity = averaged(trial.velocity, first)
    per_block = max(round(rate / _COARSE), 1)
    fine = Fine(
        rate,
        per_block,
        np.degrees(averaged(trial.angle, first)),
        velocity,
        quiet_acceleration(averaged(trial.acceleration, first), velocity, per_block),
        averaged(np.clip(shares, 0.0, REST_SHARE), first),
    )
    whole = first * fine.per_block
    resting = averaged((rests & trial.counts).astype(float), whole) > 0.99
    edges = np.flatnonzero(np.diff(np.concatenate([[0], resting.astype(int), [0]])))
    coarse = trial.rate_hz / whole
    pieces = [(int(i), int(j)) for i, j in edges.reshape(-1, 2) if (j - i) / coarse >= LEAST_PIECE]
    return Blocks(
        trial.name,
        coarse,
        averaged(trial.time, whole),
        averaged(np.degrees(trial.angle), whole),
        averaged(trial.torque, whole),
        averaged(np.degrees(trial.velocity), whole),
        fine,
        tuple(pieces),
    )


def quiet_acceleration(
    acceleration: FloatArray, velocity: FloatArray, per_block: int
) -> FloatArray:
    """Acceleration without what an angle's noise makes of it [rad/s²], a value for each sample.

    A regressor that is noise pulls its own coefficient to zero, and with it the inertia: where the
    ankle holds, the noise is seen, and what is not well above it is shrunk, a³/(a² + (3σ)²), as is
    what no foot would feel.
    """
    n = len(acceleration) // per_block
    if n == 0:
        return acceleration
    mean = averaged(acceleration, per_block)
    speed = np.abs(averaged(velocity, per_block))
    slow = speed <= np.quantile(speed, _SLOWEST)
    level = max(3.0 * _MAD * float(np.median(np.abs(mean[slow]))), _NO_INERTIA)
    shrunk = mean**2 / np.maximum(mean**2 + level**2, 1e-12)
    whole = np.repeat(shrunk, per_block)
    rest = np.full(len(acceleration) - len(whole), shrunk[-1])
    made: FloatArray = acceleration * np.concatenate([whole, rest])
    return made


def columns_of(trials: Sequence[Blocks], basis: Basis) -> Columns:
    """Every column of the model at the resting blocks of the trials that have some."""
    pieces = sum(len(trial.pieces) for trial in trials)
    names = [*SHARED]
    for number in range(len(trials)):
        names += [f"zero_{number}", f"drift_{number}"]
    names += [f"past_{number}_{tau:g}" for number in range(pieces) for tau in _PAST]
    parts: dict[str, list[FloatArray]] = {
        key: [] for key in ("elastic", "context", "torque", "angle", "time", "trial")
    }
    lagging: list[list[FloatArray]] = [[] for _ in TAUS]
    cuts = [0]
    done = 0
    for number, trial in enumerate(trials):
        inside = np.clip(trial.fine.degrees, basis.low - _BEYOND, basis.high + _BEYOND)
        features = basis.features(inside)
        slow = lags(features, trial.fine.rate_hz)
        shared = averaged(_shared(trial.fine, basis), trial.fine.per_block)
        elastic = averaged(features, trial.fine.per_block)
        slow = [averaged(each, trial.fine.per_block) for each in slow]
        for first, last in trial.pieces:
            context = np.zeros((last - first, len(names)))
            context[:, : len(SHARED)] = shared[first:last]
            at = len(SHARED) + 2 * number
            context[:, at] = 1.0
            context[:, at + 1] = (trial.time[first:last] - trial.time[0]) / 60.0
            since = trial.time[first:last] - trial.time[first]
            at = len(SHARED) + 2 * len(trials) + 2 * done
            context[:, at : at + 2] = np.exp(-since[:, None] / np.array(_PAST))
            done += 1
            parts["elastic"].append(elastic[first:last])
            parts["context"].append(context)
            parts["torque"].append(trial.torque[first:last])
            parts["angle"].append(trial.angle[first:last])
            parts["time"].append(trial.time[first:last])
            parts["trial"].append(np.full(last - first, float(number)))
            for into, each in zip(lagging, slow, strict=True):
                into.append(each[first:last])
            cuts.append(cuts[-1] + last - first)
    whole = {key: np.concatenate(each) for key, each in parts.items()}
    return Columns(
        basis,
        whole["elastic"],
        tuple(np.vstack(each) for each in lagging),
        whole["context"],
        tuple(names),
        whole["torque"],
        whole["angle"],
        whole["time"],
        whole["trial"],
        tuple(cuts),
    )


def lags(features: FloatArray, rate_hz: float) -> list[FloatArray]:
    """HP_τ of each column for each of `TAUS`: what of a signal has not relaxed yet.

        HP_τ[x](t) = x(t) − x̄(t),  τ·dx̄/dt = x − x̄,  x̄(0) = x(0)

    Quasi-linear viscoelasticity: Fung (1993), Biomechanics, 7.6.
    """
    made = []
    beyond = features - features[0]
    for tau in TAUS:
        stays = float(np.exp(-1.0 / (rate_hz * tau)))
        made.append(beyond - lfilter([1.0 - stays], [1.0, -stays], beyond, axis=0))
    return made


def _shared(fine: Fine, basis: Basis) -> FloatArray:
    """The columns `SHARED` at the higher rate, shape (n, 10)."""
    angle = np.radians(fine.degrees)
    reflex = _reflex(fine)
    longer = np.exp((np.minimum(fine.degrees, basis.high) - basis.high) / _LONGER)
    return np.column_stack(
        [
            np.cos(angle),
            np.sin(angle),
            fine.velocity,
            friction(fine.degrees, _DAHL),
            fine.acceleration,
            reflex,
            reflex * longer,
            np.ones_like(angle),
            activated(fine.shares, fine.rate_hz),
        ]
    )


def friction(degrees: FloatArray, over: float) -> FloatArray:
    """Friction between −1 and 1 that builds up over some degrees after a reversal.

        dz/dx = (1 − z·sgn ẋ)/d,  by implicit steps

    Dahl (1968), A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1.
    """
    z = 0.0
    made = [z]
    for step in (np.diff(degrees) / over).tolist():
        z = (z + step) / (1.0 + abs(step))
        made.append(z)
    return np.array(made)


def _reflex(fine: Fine) -> FloatArray:
    """What a stretch reflex follows: velocity towards dorsiflexion, late, through activation."""
    late = round(_LATENCY * fine.rate_hz)
    stretch = np.maximum(np.concatenate([np.zeros(late), fine.velocity]), 0.0)[: len(fine.velocity)]
    return activated(stretch, fine.rate_hz)


def activated(signal: FloatArray, rate_hz: float) -> FloatArray:
    """A signal through activation: critically damped, second order, as equation (14), β = 1."""
    stays = float(np.exp(-2.0 * np.pi * _ACTIVATION / rate_hz))
    once = lfilter([1.0 - stays], [1.0, -stays], signal, axis=0)
    return np.asarray(lfilter([1.0 - stays], [1.0, -stays], once, axis=0))
