"""What one perturbed recording says: records that reports, pages and files read."""

from dataclasses import dataclass
from typing import Literal

from surae.base.frozen import Comparable, FrozenDict
from surae.base.records import FileName
from surae.base.units import FloatArray
from surae.nerve.measures import NerveMeasure

ReflexVerdict = Literal["present", "none seen", "cannot tell"]


@dataclass(frozen=True, slots=True)
class ReflexPath:
    """Whether a reflex is there, which stretch it answers, and why this is said."""

    verdict: ReflexVerdict
    direction: Literal["dorsiflexion", "plantarflexion"] | None  #: None unless present.
    reason: str  #: In a sentence.


@dataclass(frozen=True, slots=True, eq=False)
class Curves(Comparable):
    """What figures of one recording show."""

    f: FloatArray  #: Frequencies [Hz], shape (n,).
    coherence: FloatArray  #: Of angle and torque, linear, shape (n,).
    gain: FloatArray  #: Measured torque over angle [Nm/rad], shape (n,).
    phase: FloatArray  #: [deg], shape (n,).
    model_gain: (
        FloatArray  #: Of the intrinsic part and of what of the reflex is linear, shape (n,).
    )
    model_phase: FloatArray  #: [deg], shape (n,).
    intrinsic_gain: FloatArray  #: Of the intrinsic part alone, shape (n,).
    lag: FloatArray  #: Lags of the reflex's response [s], shape (m,).
    reflex: FloatArray  #: Reflex's impulse response of its equations [Nm/rad], shape (m,).
    free_reflex: FloatArray  #: The same without equations, shape (m,).
    intrinsic_lag: FloatArray  #: Lags of the intrinsic response [s], shape (k,).
    free_intrinsic: FloatArray  #: Intrinsic response without equations [Nm/rad/s], shape (k,).


@dataclass(frozen=True, slots=True)
class Stationarity:
    """Whether the stiffness stays the same during a recording."""

    verdict: Literal["steady", "changes"]
    halves: tuple[tuple[float, float, float], ...]  #: Stiffness of both halves: value, interval.
    parts: tuple[
        tuple[float, float, float], ...
    ]  #: Of every 10 s: time [s], value, standard error.
    trend: float  #: z of a change in proportion to time.


@dataclass(frozen=True, slots=True, eq=False)
class Perturbed(Comparable):
    """One recording and what it says."""

    path: FileName  #: Of its file, or its name.
    seconds: float  #: Time that was used [s].
    mean_torque: float  #: [Nm], positive when the triceps pulls, as far as the zero is known.
    mean_angle: float  #: [deg], dorsiflexion positive.
    #: Torque that impulse responses of both paths explain [%]: of the torque they were fitted to,
    #: and of the second half by the first.
    vaf: float
    vaf_held_out: float
    vaf_held_out_intrinsic: float  #: The same with the intrinsic path alone.
    vaf_held_out_other: float  #: The same with a reflex the other way round.
    reflex: ReflexPath  #: Whether there is one.
    measures: FrozenDict[str, NerveMeasure]  #: By the names of `MEASURES`.
    structures: FrozenDict[str, tuple[float, float, float]]  #: Stiffness of each: value, interval.
    stationarity: Stationarity  #: Of the stiffness.
    notes: tuple[str, ...]  #: What was left out, and what else to know, a sentence each.
    curves: Curves  #: What its figures show.
