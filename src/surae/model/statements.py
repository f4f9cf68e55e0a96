"""What a laboratory states of leg and device: numbers, once or twice, and what they make together.

Two independent statements that agree earn their spread; two that do not contradict each other.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from surae.base.file_form import filed
from surae.base.setting import Request, Setting, setting

#: By source: what it is called, its unit, and by how much one statement may be off beyond what it
#: repeats, one standard deviation. Zero: a goniometer's standard error at the ankle is 1.8 to 2.8°
#: (Konor et al. 2012). Axis: that of the malleoli and the functional one differ by 7 % of the foot
#: (Salami et al. 2020), torques by 5 to 9 % (Arampatzis et al. 2007). Arms: methods that repeat
#: within 2.5 % (Obst et al. 2018) differ by 3.8 mm (Hashizume et al. 2016), or by 45 % (J Biomech
#: 2021, 116:110204).
_OF = {
    "angle_zero": ("zero of the angle", "°", 2.3),
    "axis": ("axis of the ankle before and above the device’s", " mm", 9.0),
    "arms": ("moment arms", " mm", 4.0),
}
#: By how much wider two statements are, of five readings each: Student's t over the normal's.
_TWICE = 2.306 / 1.960
#: Probability of right statements to be as far apart, below which they contradict each other.
RARE = 0.01

_OFTEN = {
    None: "stated once: taken to be as unsure as methods and readers differ",
    True: "stated twice",
    False: "stated twice, in contradiction",
}
#: What somebody says of some numbers: each with its standard deviation.
Stated = Mapping[str, tuple[float, float]]


def _number(meaning: str, **limits: Any) -> Any:
    return field(metadata={"setting": Setting(meaning=meaning, **limits)})


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class StatedNumber(Request):
    """A number that a laboratory measured, and its standard deviation."""

    value: float = _number("What was measured.", least=-30.0, most=30.0)
    sd: float = _number("How far it may be off, one standard deviation.", least=1e-3, most=30.0)


@filed(strict=True, sparse=("again",))
@dataclass(frozen=True, slots=True)
class StatedZero(StatedNumber):
    """The same, perhaps by another reader or method too, who did not know the first."""

    again: float | None = setting(None, "What the other one says.", least=-30.0, most=30.0)

    @property
    def statements(self) -> list[Stated]:
        """What each says."""
        return [{"": (v, self.sd)} for v in (self.value, self.again) if v is not None]


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class StatedArm(StatedNumber):
    """A moment arm with the foot perpendicular to the shank, by the tendon's excursion."""

    value: float = _number("Excursion over the angle turned [mm/rad].", least=12.0, most=70.0)


@filed(strict=True, sparse=("again",))
@dataclass(frozen=True, slots=True)
class StatedAxis(Request):
    """Where the ankle's axis lies from the device's, forward, or forward and up [mm]."""

    value: float | tuple[float, float]
    sd: float = _number("Of each way, one standard deviation.", least=1e-3, most=30.0)
    again: float | tuple[float, float] | None = None  #: As of `StatedZero`.

    def __post_init__(self) -> None:
        """Check each number."""
        for value, sd in (number for one in self.statements for number in one.values()):
            StatedNumber(value, sd)

    @property
    def statements(self) -> list[Stated]:
        """What each says of both ways."""
        both = (
            v if isinstance(v, tuple) else (v, 0.0)
            for v in (self.value, self.again)
            if v is not None
        )
        return [{"forward": (forward, self.sd), "up": (up, self.sd)} for forward, up in both]


@dataclass(frozen=True, slots=True)
class Pooled:
    """What one or two independent statements make together."""

    source: str  #: Of uncertainty.
    statements: Sequence[Stated]
    numbers: Stated  #: What is known after them.
    #: Probability of two right statements to be as far apart, or farther; None of one.
    probability: float | None

    @classmethod
    def of(cls, source: str, first: Stated, second: Stated | None = None) -> "Pooled":
        """What is known after one statement of some numbers, x ± s each, or two.

            once   x ± √(s² + b²)                                        reproducibility
            twice  Σxᵢ/sᵢ² / Σ1/sᵢ² ± t·max(1, √(χ²/k)) / √(Σ1/sᵢ²),  χ² = Σ(x₂ − x₁)²/(s₁² + s₂²)

        over the k numbers that both tell, k = 1 or 2: Birge's ratio and Student's t. Where χ² is
        rarer than `RARE`, b is added as to one statement.

        ISO 5725-2:2019 (s_R² = s_r² + s_L²); R. T. Birge (1932), Physical Review 40:207-227; JCGM
        100:2008, F.1.2.3 and G.3.
        """
        pooled = dict[str, tuple[float, float]]()
        probability = None
        said = [first, second or {}]
        both = [name for name in said[0] if name in said[1]]
        pairs = [(said[0][name], said[1][name]) for name in both]
        square = sum((y - x) ** 2 / (s**2 + r**2) for (x, s), (y, r) in pairs)
        if both:
            half = 0.5 * square
            probability = math.exp(-half) if len(both) == 2 else math.erfc(math.sqrt(half))
        wider = _TWICE * math.sqrt(max(1.0, square / max(len(both), 1)))
        for name in {**said[0], **said[1]}:
            numbers = [one[name] for one in said if name in one]
            weight = sum(s**-2 for _, s in numbers)
            sd = (wider if name in both else 1.0) / math.sqrt(weight)
            if name not in both or (probability or 0.0) < RARE:
                sd = math.hypot(sd, _OF[source][2])
            pooled[name] = sum(x / s**2 for x, s in numbers) / weight, sd
        return cls(source, said if said[1] else said[:1], pooled, probability)

    @property
    def agrees(self) -> bool | None:
        """Whether two statements tell about the same; None of one."""
        return None if self.probability is None else self.probability >= RARE

    @property
    def texts(self) -> tuple[str, ...]:
        """What each says, for readers."""
        unit = _OF[self.source][1]
        return tuple(
            " and ".join(f"{value:.3g} ± {sd:.2g}{unit}" for value, sd in one.values())
            for one in self.statements
        )

    @property
    def line(self) -> tuple[str, str, str]:
        """What it is, how well it is known, and how often it was stated, for readers."""
        return _OF[self.source][0], "; ".join(self.texts), _OFTEN[self.agrees]
