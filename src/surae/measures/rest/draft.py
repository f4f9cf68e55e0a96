"""A measure of rest before it is judged."""

from dataclasses import dataclass

from surae.base.units import FloatArray
from surae.base.words import Message


@dataclass(frozen=True, slots=True)
class Draft:
    """A measure of rest before it is judged: its values of possible legs, or why there is none."""

    name: str
    unit: str
    meaning: str
    #: Values with the angle's zero as known, and as unsure as it is; shape (n,).
    device: FloatArray | None = None
    ankle: FloatArray | None = None
    #: Power of `PossibleLegs.scale` in both; 0 where it is in them some other way.
    power: float = 1.0
    missing: Message | None = None
    at_angle: bool = False
    span: tuple[float, float] | None = None
