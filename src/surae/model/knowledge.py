"""What a laboratory knows of leg and device before a fit, each with how far it may be off.

Nothing is known exactly: what is stated becomes the prior of what a fit estimates, never a
constant, so that it is in every interval by its own uncertainty.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict
from surae.base.names import GEOMETRY_OF
from surae.base.setting import Request, Setting, setting
from surae.base.words import N_
from surae.model.geometry_table import GeometryTable

#: How well the scale of a person's own geometry is known where nobody says [%]: two readers of one
#: image differ by 3 % (Maganaris et al. 1998).
GEOMETRY_SD = 3.0
#: How well size tells a moment arm [%]: adults' differ by 9.5 % (Wolfram et al. 2018), of which the
#: foot's length explains half (Waugh et al. 2011), and published legs of one height by 8 to 14 %.
#: What paths travel is as unknown as of any leg. Arms are assumed of men of so many cm, whose feet
#: are a part of that (Drillis and Contini 1966).
SCALED_SD, _TRAVEL, _HEIGHT, _FOOT = 8.0, 30.0, 175.0, 0.152
#: What a plate that was tared elsewhere leaves: inertia [kg·m²] and weight [Nm], a tenth of what an
#: untared one has; assumed.
_TARED = (0.003, 0.5)
#: What no tare of the plate tells: the foot's own weight, 1 Nm where it is level, at sin θ where a
#: seat is reclined by some 30° [Nm]; assumed.
_SEAT = 0.5
#: What a tare leaves at least, and the part of both that a foot strapped in may move.
_LEAST, _PART = (5e-4, 0.1), 0.03


def _number(meaning: str, **limits: Any) -> Any:
    return field(metadata={"setting": Setting(meaning=meaning, **limits)})


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class StatedNumber(Request):
    """A number that a laboratory measured, and its standard deviation."""

    value: float = _number("What was measured.", least=-30.0, most=30.0)
    sd: float = _number("How far it may be off, one standard deviation.", above=0.0, most=30.0)


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class StatedArm(StatedNumber):
    """A moment arm with the foot perpendicular to the shank, by the tendon's excursion."""

    value: float = _number("Excursion over the angle turned [mm/rad].", least=25.0, most=70.0)


@filed(strict=True)
@dataclass(frozen=True, slots=True)
class StatedAxis(Request):
    """Where the ankle's axis lies from the device's, forward, or forward and up [mm]."""

    value: float | tuple[float, float]
    sd: float = _number("Of each way, one standard deviation.", above=0.0, most=30.0)

    def __post_init__(self) -> None:
        """Check each number."""
        for way in self.ways:
            StatedNumber(way, self.sd)

    @property
    def ways(self) -> tuple[float, float]:
        """Forward and up."""
        return self.value if isinstance(self.value, tuple) else (self.value, 0.0)


@filed(sparse=("file", "values", "sds", "range", "residual"))
@dataclass(frozen=True, slots=True)
class Plate:
    """The empty device; without a file, one that was tared before."""

    file: str = ""  #: Name of its recording.
    #: Inertia [kg·m²], weight at cos θ and sin θ [Nm], damping [Nm·s/rad], dry friction [Nm] and
    #: the sensor's zero [Nm], with their standard deviations.
    values: tuple[float, ...] = ()
    sds: tuple[float, ...] = ()
    range: tuple[float, float] = (0.0, 0.0)  #: Angles that it moved through [rad].
    residual: float = 0.0  #: Standard deviation of what is left of its torque [Nm].

    @property
    def left(self) -> tuple[float, float]:
        """What taking it away leaves, standard deviations: inertia [kg·m²] and weight [Nm]."""
        inertia, weight = self.values[0], math.hypot(*self.values[1:3])
        # how cos θ and the zero share a torque does not matter: both are taken away
        return (
            max(_LEAST[0], self.sds[0], _PART * abs(inertia)),
            max(_LEAST[1], self.sds[2], _PART * weight),
        )

    @property
    def words(self) -> str:
        """What it is, for readers."""
        if not self.file:
            return "taken away before (tared)"
        (i, c, s, d, f, _), (sd_i, _, _, sd_d, sd_f, _) = self.values, self.sds
        return (
            f"inertia {1e3 * i:.1f} ± {1e3 * sd_i:.1f} g·m², "
            f"weight up to {math.hypot(c, s):.2g} Nm, damping {d:.2g} ± {sd_d:.1g} Nm·s/rad, "
            f"friction {f:.2g} ± {sd_f:.1g} Nm; taken away"
        )


@filed(
    "table", strict=True, sparse=(
        "geometry", "geometry_of", "geometry_sd_percent", "height_cm", "foot_mm", "arm_tri_mm",
        "arm_tib_mm", "crosstalk", "crosstalk_of", "doubts",
    ),
)  # fmt: skip
@dataclass(frozen=True, slots=True, kw_only=True)
class Knowledge(Request):
    """What is known beforehand, as a session's steps and its `session.toml` give it."""

    angle_zero_deg: StatedNumber | None = setting(
        None, "Angle of the ankle, from neutral, where the recordings say 0 [deg]."
    )
    axis_mm: StatedAxis | None = setting(
        None, "How far the ankle's axis lies before the device's [mm], or before and above it.",
        label=N_("Ankle’s axis before the device’s [mm]"),
    )  # fmt: skip
    #: The empty device, as it was recorded; None where its plate is not known.
    plate: Plate | None = setting(None, "The empty device: by itself one that was tared before.")
    geometry: str = ""  #: Name of the file of lengths and moment arms.
    geometry_of: str = GEOMETRY_OF[0]
    geometry_sd_percent: float | None = setting(
        None, "Standard deviation of the scale of a person's own lengths and moment arms [%].",
        above=0.0, most=50.0, label=N_("Geometry, scale ± [%]"),
    )  # fmt: skip
    height_cm: float | None = setting(
        None, "Body height [cm]: the assumed moment arms and paths grow with it.", least=130.0,
        most=230.0, label=N_("Body height [cm]"),
    )  # fmt: skip
    foot_mm: float | None = setting(
        None, "Length of the foot [mm], which goes before the height.", least=200.0, most=350.0,
        label=N_("Foot length [mm]"),
    )  # fmt: skip
    arm_tri_mm: StatedArm | None = setting(
        None, "Moment arm of the Achilles tendon, by its excursion [mm].",
        label=N_("Arm of the Achilles tendon [mm]"),
    )  # fmt: skip
    arm_tib_mm: StatedArm | None = setting(
        None, "That of the tibialis's tendon [mm].", label=N_("Arm of the tibialis’s tendon [mm]")
    )
    #: Parts of another muscle's envelope that electrodes hear, by parameter, with their standard
    #: deviations, and the trial of one muscle at a time that shows them.
    crosstalk: Mapping[str, StatedNumber] = field(default_factory=FrozenDict)
    crosstalk_of: str = ""
    doubts: tuple[str, ...] = ()  #: Steps that contradict each other, a sentence each.
    table: GeometryTable | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Refuse what nobody can have measured."""
        Request.__post_init__(self)
        object.__setattr__(self, "crosstalk", FrozenDict(self.crosstalk))
        if self.geometry_of not in GEOMETRY_OF:
            near = nearest(self.geometry_of, GEOMETRY_OF)
            known = ", ".join(GEOMETRY_OF)
            raise InputError(f"geometry_of is {self.geometry_of!r}{near}; use one of: {known}")
        if self.geometry and (self.size or self.arms):
            raise InputError("give a geometry's file, or height, foot and arms; not both")

    def filled(self, other: "Knowledge") -> "Knowledge":
        """The same, with what it does not say from another."""
        unsaid = {f.name: getattr(other, f.name) for f in fields(self)
                  if f.name != "geometry_of" and not getattr(self, f.name)}  # fmt: skip
        whose = other.geometry_of if not self.geometry else self.geometry_of
        return replace(self, **unsaid, geometry_of=whose)

    @property
    def size(self) -> float:
        """The foot's length over that of the assumed leg; 0 where it is not known."""
        return (self.foot_mm or 10.0 * _FOOT * (self.height_cm or 0.0)) / (10.0 * _FOOT * _HEIGHT)

    @property
    def arms(self) -> dict[str, StatedArm]:
        """Moment arms that were measured, by group."""
        arms = {"tri": self.arm_tri_mm, "tib": self.arm_tib_mm}
        return {group: arm for group, arm in arms.items() if arm is not None}

    @property
    def name(self) -> str:
        """What it is among other settings."""
        return "; ".join(f"{what} {how}" for what, how, _ in self.lines()) or "nothing"

    @property
    def groups(self) -> frozenset[str]:
        """Groups of nuisances of which something is known: these are in every fit."""
        known = {"axis": self.axis_mm, "plate": self.plate, "crosstalk": self.crosstalk,
                 "arm": self.geometry_sd_percent or self.size or self.arms}  # fmt: skip
        return frozenset(group for group, stated in known.items() if stated)

    def nuisances(self) -> dict[str, tuple[float, float]]:
        """Priors, mean and standard deviation, by parameter, in SI units."""
        from surae.model.geometry import ARMS  # NumPy, which help does without
        from surae.model.parameters import OPTIONAL

        priors: dict[str, tuple[float, float]] = {}
        if self.axis_mm is not None:
            ways = zip(OPTIONAL["axis"], self.axis_mm.ways, strict=True)
            priors |= {name: (value / 1e3, self.axis_mm.sd / 1e3) for name, value in ways}
        if self.plate is not None:
            inertia, weight = self.plate.left if self.plate.file else _TARED
            sizes = (inertia, weight, max(weight, _SEAT))
            priors |= {n: (0.0, sd) for n, sd in zip(OPTIONAL["plate"], sizes, strict=True)}
        priors |= {name: (stated.value, stated.sd) for name, stated in self.crosstalk.items()}
        if self.geometry_sd_percent is not None or self.size:
            arm = self.geometry_sd_percent or SCALED_SD
            sds = {"arm_scale": arm, "path_scale": _TRAVEL if self.size else arm}
            scales = [n for n in OPTIONAL["arm"] if n.startswith(tuple(sds))]
            mean = math.log(self.size or 1.0)
            priors |= {name: (mean, sds[name[:-4]] / 100.0) for name in scales}
        for group, own in self.arms.items():
            assumed = 1e3 * ARMS[("tri", "tib").index(group)][0]
            priors[f"arm_scale_{group}"] = math.log(own.value / assumed), own.sd / own.value
        return priors

    def lines(self) -> tuple[tuple[str, str, str], ...]:
        """What was known, how well, and where it is from, for readers."""
        rows: list[tuple[str, str, str]] = []
        if (zero := self.angle_zero_deg) is not None:
            rows.append(("zero of the angle", f"{zero.value:g} ± {zero.sd:g}°", "stated"))
        if (axis := self.axis_mm) is not None:
            forward, up = axis.ways
            text = f"{forward:g} mm forward, {up:g} mm up, each ± {axis.sd:g} mm"
            rows.append(("axis of the ankle from the device’s", text, "stated"))
        if self.plate is not None:
            rows.append(("empty device", self.plate.words, self.plate.file or "stated"))
        if self.geometry:
            whose = "this person’s" if self.geometry_of == GEOMETRY_OF[1] else "a generic one"
            sd = self.geometry_sd_percent
            how = "" if sd is None else f", its scale ± {sd:g} %"
            rows.append(("lengths and moment arms", whose + how, self.geometry))
        if self.size:
            how = (
                f"{self.size:.3g} times the assumed, ± {self.geometry_sd_percent or SCALED_SD:g} %"
            )
            rows.append(("moment arms", how, "height and foot"))
        for group, arm in self.arms.items():
            whose = {"tri": "of the Achilles tendon", "tib": "of the tibialis’s tendon"}[group]
            rows.append((f"moment arm {whose}", f"{arm.value:g} ± {arm.sd:g} mm", "stated"))
        if self.crosstalk:
            largest = max(self.crosstalk.values(), key=lambda stated: stated.value)
            sds = sorted(stated.sd for stated in self.crosstalk.values())
            text = f"at most {100 * largest.value:.0f} % of another muscle’s EMG, ± "
            rows.append(("crosstalk", f"{text}{100 * sds[len(sds) // 2]:.1f} %", self.crosstalk_of))
        return tuple(rows)
