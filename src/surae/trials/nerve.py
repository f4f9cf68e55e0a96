"""What a session's stretches and perturbations say of reflexes, by the distribution that tells."""

from collections.abc import Sequence
from dataclasses import dataclass
from types import FunctionType
from typing import Literal

from surae.base.plugins import plugins
from surae.base.records import OrInfinite
from surae.quality.position import relaxed_speeds, slow_and_fast
from surae.quality.trial import signals_of
from surae.recording import Recording
from surae.trials.sorting import Trial


@dataclass(frozen=True, slots=True)
class IntervalEstimate:
    """A number and its 95 % interval."""

    value: float | None  #: None where there is none: the interval then is what it may be.
    ci95: tuple[float, OrInfinite]


@dataclass(frozen=True, slots=True)
class StretchTorque:
    """Largest torque [Nm] of one stretch, and of its parts."""

    direction: Literal["dorsiflexion", "plantarflexion"]  #: Of the movement.
    speed: float  #: [deg/s]
    peak: float
    elastic: float
    viscous: float
    neural: float | None  #: None where it cannot be told from tissue.
    ci95: tuple[float, float] | None  #: Of the neural part.
    heard: bool = True  #: Whether EMG says so, and not time alone.


@dataclass(frozen=True, slots=True)
class Nerve:
    """How much is nerve, of one leg."""

    stretches: tuple[StretchTorque, ...] = ()  #: Of slow and fast stretches, relaxed.
    threshold: IntervalEstimate | None = None  #: Where the calf answers a slow stretch [deg].
    #: `reflex`, `direction`: of perturbations, whether there is one, and to which movement.
    reflex: Literal["present", "none seen", "cannot tell"] | None = None
    direction: Literal["dorsiflexion", "plantarflexion"] | None = None
    share: IntervalEstimate | None = None  #: Reflex's share of the torque's variance [%].
    stiffness: IntervalEstimate | None = None  #: Of tissue, and of muscles as they were [Nm/rad].
    problems: tuple[str, ...] = ()  #: Why some recordings could not be used.


def nerve_of(trials: Sequence[Trial]) -> Nerve | None:
    """What stretches at two speeds and perturbations say; None where nothing tells of reflexes."""
    tell = plugins("sessions", FunctionType).get("nerve")
    perturbed = [t.recording for t in trials if t.use == "nerve" and t.recording is not None]
    moved = list[Recording]()
    speeds = list[float]()
    for trial in trials:
        if trial.use == "fit" and trial.recording is not None:
            own = relaxed_speeds(signals_of(trial.recording))
            speeds += own
            moved += [trial.recording][: len(own)]
    stretched = moved if slow_and_fast(speeds) else []
    if tell is None or not (perturbed or stretched):
        return None
    told: Nerve = tell(perturbed, stretched)
    return told
