"""What a measure is: one function of a leg, with a name, a unit and where it is asked."""

from collections.abc import Callable
from dataclasses import dataclass, field

from surae.measures.leg import Leg

#: A measure of a leg at a point, e.g. an angle in degrees; 0 where it is asked at none.
Compute = Callable[[Leg, float], float]


@dataclass(frozen=True, slots=True)
class Definition:
    """One measure.

    Attributes
    ----------
    name : str
        Without the point, which follows an ``@``.
    unit : str
        Of its value.
    compute : callable
        The function; its docstring has meaning, formula and source.
    at : str
        Unit of the point it is asked at: ``"deg"`` for an angle; empty where there is none.
    points : tuple of float
        Where it is asked unless told otherwise; angles are the user's.
    is_angle : bool
        Whether its value is an angle, of which 10 % mean nothing.
    of_recordings : bool
        Whether it is made of the recordings and not of the leg alone.
    alone : str
        Why two sessions cannot be compared by it; empty where they can.
    """

    name: str
    unit: str
    compute: Compute = field(compare=False)
    at: str = ""
    points: tuple[float, ...] = (0.0,)
    is_angle: bool = False
    of_recordings: bool = False
    alone: str = ""

    @property
    def meaning(self) -> str:
        """What it is, in one sentence."""
        return _paragraphs(self.compute)[0]

    @property
    def formula(self) -> str:
        """How it is computed, and after whom."""
        return " ".join(_paragraphs(self.compute)[1:])

    def named(self, point: float) -> str:
        """The name with the point it is asked at."""
        return f"{self.name}@{point:g}{self.at}" if self.at else self.name


def _paragraphs(function: Compute) -> list[str]:
    text = (function.__doc__ or "").strip()
    return [" ".join(part.split()) for part in text.split("\n\n")]
