"""What stretches and perturbations of a session say, as the leg's page takes it."""

from collections.abc import Sequence

from surae.base.errors import InputError
from surae.recording import Recording
from surae.trials.nerve import IntervalEstimate, Nerve, StretchTorque
from surae_nerve.answer import Impedance, joined
from surae_nerve.impedance import perturbed
from surae_nerve.stretches import OPPOSED, StretchAnswer, Stretches, answers


def of_session(small: Sequence[Recording], slow_and_fast: Sequence[Recording]) -> Nerve:
    """Of perturbed and of stretched recordings of one leg; what cannot be used is said."""
    problems = list[str]()
    told = []
    stretches = None
    for recording in small:
        try:
            told.append(perturbed(recording))
        except InputError as error:
            problems.append(str(error))
    try:
        stretches = answers(slow_and_fast) if slow_and_fast else None
    except InputError as error:
        problems.append(str(error))
    return nerve_of(joined(told) if told else None, stretches, problems)


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
    return Nerve(
        seen, threshold, reflex.verdict, reflex.direction, share, stiffness, tuple(problems)
    )
