"""What stretches and perturbations of a session say, as the leg's page takes it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from surae.base.errors import InputError
from surae.base.records import OrInfinite
from surae.nerve.answer import Impedance, joined
from surae.nerve.impedance import perturbed
from surae.nerve.stretch_records import StretchAnswer, Stretches
from surae.nerve.stretches import OPPOSED, answers
from surae.recording import Recording


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
    #: Part of the torque [%] of a perturbed recording's second half that its first predicts: the
    #: least of all recordings; None without such.
    held_out: float | None = None


def of_session(small: Sequence[Recording], slow_and_fast: Sequence[Recording]) -> Nerve:
    """Of perturbed and of stretched recordings of one leg; what cannot be used is said."""
    problems = list[str]()
    perturbations = []
    stretches = None
    for recording in small:
        try:
            perturbations.append(perturbed(recording))
        except InputError as error:
            problems.append(str(error))
    try:
        stretches = answers(slow_and_fast) if slow_and_fast else None
    except InputError as error:
        problems.append(str(error))
    return nerve_of(joined(perturbations) if perturbations else None, stretches, problems)


def stretch_torque(stretch: StretchAnswer) -> StretchTorque:
    """A stretch as the leg's page takes it."""
    s = stretch
    return StretchTorque(
        s.direction,
        s.speed_deg_s,
        s.peak_torque_Nm,
        s.elastic_Nm,
        s.viscous_Nm,
        s.neural_Nm,
        s.neural_ci95,
        bool(s.emg_onset_deg),
    )


def nerve_of(
    impedance: Impedance | None, stretches: Stretches | None, problems: Sequence[str] = ()
) -> Nerve:
    """The same of answers that are there already."""
    seen = tuple[StretchTorque, ...]()
    threshold = None
    if stretches is not None:
        seen = tuple(stretch_torque(stretch) for stretch in stretches.stretches)
        sure = [
            (t.ci95[1] - t.ci95[0], IntervalEstimate(t.angle_deg, t.ci95))
            for muscle, t in stretches.threshold.items()
            if muscle in OPPOSED[1] and t.ci95 is not None and t.verdict != "undetermined"
        ]
        threshold = min(sure, key=lambda each: each[0])[1] if sure else None
    if impedance is None:
        return Nerve(seen, threshold, problems=tuple(problems))
    share, stiffness = (
        IntervalEstimate(m.value, m.ci95)
        for m in (impedance.measures[n] for n in ("reflex_share", "intrinsic_stiffness"))
    )
    reflex = impedance.reflex
    held_out = min(recording.vaf_held_out for recording in impedance.recordings)
    return Nerve(
        seen,
        threshold,
        reflex.verdict,
        reflex.direction,
        share,
        stiffness,
        tuple(problems),
        held_out,
    )
