"""The numbers of perturbed recordings: what each is, and what its interval is worth."""

from dataclasses import dataclass

import numpy as np

from surae.base.words import N_, Message
from surae.inference.judging.verdict import OF_REFLEX, PART, Verdict, verdict_of
from surae.nerve.judged import Number

#: Why no number of a reflex is identified, however narrow its interval.
ONE_LAW = Message(
    N_("of a reflex to velocity, to velocity and length or to force; another law may give another")
)

#: Unit and meaning of every measure.
MEASURES = {
    "intrinsic_stiffness": ("Nm/rad", "stiffness of the joint's tissue at low frequency"),
    "intrinsic_viscosity": ("Nm·s/rad", "viscosity of the joint's tissue at low frequency"),
    "inertia": ("kg·m²", "inertia of the foot and of what moves with it beyond the sensor"),
    "reflex_gain": ("Nm·s/rad", "reflex's steady torque for a velocity of stretch"),
    "reflex_delay": ("ms", "time from stretch to the reflex's torque"),
    "reflex_share": ("%", "share of the torque's variance above 0.5 Hz that the reflex makes"),
    "reflex_frequency": ("Hz", "natural frequency of the reflex's torque"),
    "reflex_damping": ("1", "damping ratio of the reflex's torque"),
    "reflex_threshold": ("deg/s", "velocity from which the reflex answers"),
}


@dataclass(frozen=True, slots=True)
class NerveMeasure:
    """One number and what it is worth."""

    value: float | None  #: None where there is none, and `note` says why.
    unit: str  #: Of the value.
    ci95: tuple[float, float]  #: 95 % interval, the structure's uncertainty included.
    verdict: Verdict  #: identified, weak or undetermined.
    note: str = ""  #: What to know of it.


def number_of(
    name: str, number: Number | None, note: str = "", ends: tuple[float, float] = (0.0, np.inf)
) -> NerveMeasure:
    """A measure of an estimate; of none the ends that it may lie between.

    None of them is below zero in a leg, so that no interval of one that is not reaches there; the
    verdict is by what its interval was before.
    """
    unit, _ = MEASURES[name]
    if number is None:
        return NerveMeasure(None, unit, ends, Verdict.UNDETERMINED, note)
    half = 0.5 * (number.high - number.low)
    verdict = verdict_of(number.value, half, OF_REFLEX if name.startswith("reflex_") else PART)
    if verdict is Verdict.WEAK and verdict_of(number.value, half) is Verdict.IDENTIFIED:
        note = note or ONE_LAW
    low = max(number.low, min(number.value, 0.0))
    return NerveMeasure(number.value, unit, (low, number.high), verdict, note)
