"""What a laboratory knows of leg and device before a fit, each with how far it may be off.

Nothing is known exactly: what is stated becomes the prior of what a fit estimates, never a
constant, so that it is in every interval by its own uncertainty. What is stated once is as unsure
as laboratories and methods differ; two statements that agree earn the spread of each.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict
from surae.base.names import GEOMETRY_OF
from surae.base.setting import Request, setting
from surae.base.words import N_
from surae.model.geometry_table import GeometryTable
from surae.model.statements import Pooled, StatedArm, StatedAxis, StatedNumber, StatedZero

#: How well the scale of a person's own geometry repeats where nobody says [%]: two readers of one
#: image differ by 3 % (Maganaris et al. 1998).
GEOMETRY_SD = 3.0
#: How well size tells a moment arm [%]: adults' differ by 9.5 % (Wolfram et al. 2018), of which the
#: foot's length explains half (Waugh et al. 2011), and published legs of one height by 8 to 14 %.
#: What paths travel is as unknown as of any leg. Arms are assumed of men of so many cm, whose feet
#: are a part of that (Drillis and Contini 1966).
SCALED_SD = 8.0
TRAVEL_SD = 30.0
_HEIGHT = 175.0
_FOOT = 0.152
#: Median body height of children [cm] by age [years], of both sexes (WHO Child Growth Standards
#: 2006, WHO Reference 2007), how far one is from it [%], and the age from which one is grown up.
_GROWTH = (
    (2.0, 87.0),
    (3.0, 95.5),
    (4.0, 103.0),
    (5.0, 109.5),
    (6.0, 115.5),
    (8.0, 127.0),
    (10.0, 138.0),
    (12.0, 150.0),
    (14.0, 161.5),
    (16.0, 167.5),
    (18.0, 170.0),
)
#: How far a child's height is from the median of its age [%], and the age from which it is none.
_STATURE_SD = 5.0
_GROWN = 18.0
#: Mass of a foot over the body's (Winter 2009), of a foot plate [kg], and how far off both are.
_FOOT_MASS = 0.0145
_PLATE_MASS = 1.0
MASS_SPREAD = 0.30
#: What a tare leaves at least, and the part of both that a foot strapped in may move.
_LEAST = (5e-4, 0.1)
_PART = 0.03


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
    def remaining_sd(self) -> tuple[float, float]:
        """What taking it away leaves, standard deviations: inertia [kg·m²] and weight [Nm]."""
        inertia = self.values[0]
        weight = math.hypot(*self.values[1:3])
        # how cos θ and the zero share a torque does not matter: both are taken away
        return (
            max(_LEAST[0], self.sds[0], _PART * abs(inertia)),
            max(_LEAST[1], self.sds[2], _PART * weight),
        )


@filed(
    "table",
    strict=True,
    sparse=(
        "geometry",
        "geometry_of",
        "geometry_sd_percent",
        "geometry_arms_mm",
        "height_cm",
        "foot_mm",
        "age_years",
        "mass_kg",
        "arm_tri_mm",
        "arm_tib_mm",
        "crosstalk",
        "crosstalk_of",
        "doubts",
    ),
)
@dataclass(frozen=True, slots=True, kw_only=True)
class Knowledge(Request):
    """What is known beforehand, as a session's steps and its `session.toml` give it."""

    angle_zero_deg: StatedZero | None = setting(
        None,
        "Angle of the ankle, from neutral, where the recordings say 0 [deg].",
        label=N_("Ankle’s angle where the recordings say 0 [°]"),
    )
    axis_mm: StatedAxis | None = setting(
        None,
        "How far the ankle's axis lies before the device's [mm], or before and above it.",
        label=N_("Ankle’s axis before the device’s [mm]"),
    )
    #: The empty device, as it was recorded; None where its plate is not known.
    plate: Plate | None = setting(None, "The empty device: by itself one that was tared before.")
    geometry: str = ""  #: Name of the file of lengths and moment arms.
    geometry_of: str = GEOMETRY_OF[0]
    geometry_sd_percent: float | None = setting(
        None,
        "Standard deviation of the scale of a person's own lengths and moment arms [%].",
        above=0.0,
        most=50.0,
        label=N_("Geometry, scale ± [%]"),
    )
    #: Arms of that file, triceps and tibialis, with the foot perpendicular to the shank.
    geometry_arms_mm: tuple[float, float] | None = None
    height_cm: float | None = setting(
        None,
        "Body height [cm]: the assumed moment arms and paths grow with it.",
        least=80.0,
        most=230.0,
        label=N_("Body height [cm]"),
    )
    foot_mm: float | None = setting(
        None,
        "Length of the foot [mm], which goes before the height.",
        least=110.0,
        most=350.0,
        label=N_("Foot length [mm]"),
    )
    age_years: float | None = setting(
        None,
        "Age of a child [years], which tells its height where that is not given.",
        least=2.0,
        most=120.0,
        label=N_("Age [years]"),
    )
    mass_kg: float | None = setting(
        None,
        "Mass of the body [kg], which tells that of the foot.",
        least=8.0,
        most=300.0,
        label=N_("Body mass [kg]"),
    )
    arm_tri_mm: StatedArm | None = setting(
        None,
        "Moment arm of the Achilles tendon, by its excursion [mm].",
        label=N_("Arm of the Achilles tendon [mm]"),
    )
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
        if self.geometry and self.size:
            raise InputError("give a geometry's file, or height and foot; not both")
        if self.table is not None:
            object.__setattr__(self, "geometry_arms_mm", self.table.arms_mm)

    def filled(self, other: "Knowledge") -> "Knowledge":
        """The same, with what it does not say from another."""
        unsaid = {
            f.name: getattr(other, f.name)
            for f in fields(self)
            if f.name != "geometry_of" and not getattr(self, f.name)
        }
        whose = other.geometry_of if not self.geometry else self.geometry_of
        return replace(self, **unsaid, geometry_of=whose)

    @property
    def size(self) -> float:
        """The foot's length over that of the assumed leg; 0 where it is not known."""
        height = self.height_cm or self._height_of_age
        return (self.foot_mm or 10.0 * _FOOT * height) / (10.0 * _FOOT * _HEIGHT)

    @property
    def _height_of_age(self) -> float:
        """Median height of a child [cm]; 0 of who is grown up, or of no stated age."""
        if self.age_years is None or self.age_years >= _GROWN:
            return 0.0
        (low, least), (high, most) = next(
            ends for ends in pairwise(_GROWTH) if self.age_years <= ends[1][0]
        )
        return least + (most - least) * (self.age_years - low) / (high - low)

    @property
    def size_sd(self) -> float:
        """How well size tells an arm [%]: by its age a child's less well."""
        sd = self.geometry_sd_percent or SCALED_SD
        return sd if self.foot_mm or self.height_cm else math.hypot(sd, _STATURE_SD)

    @property
    def mass(self) -> tuple[float, float] | None:
        """Prior of the mass of foot and plate: median [kg], and spread of its logarithm."""
        if self.mass_kg is None:
            return None
        return _FOOT_MASS * self.mass_kg + _PLATE_MASS, MASS_SPREAD

    @property
    def statements(self) -> dict[str, Pooled]:
        """What was stated of zero [deg], axis and arms [mm], by source of uncertainty."""
        by_hand = {"angle_zero": self.angle_zero_deg, "axis": self.axis_mm}
        made = {source: by.statements for source, by in by_hand.items() if by is not None}
        if self.geometry_sd_percent is not None and not self.size:
            part = self.geometry_sd_percent / 100.0
            made["arms"] = [{group: (arm, part * arm) for group, arm in self.usual.items()}]
        arms = {"tri": self.arm_tri_mm, "tib": self.arm_tib_mm}
        if stated := {group: (arm.value, arm.sd) for group, arm in arms.items() if arm is not None}:
            made.setdefault("arms", []).append(stated)
        return {source: Pooled.of(source, *each) for source, each in made.items()}

    @property
    def usual(self) -> dict[str, float]:
        """Arms of the geometry in use [mm], by group."""
        from surae.model.geometry import ARMS  # NumPy, which help does without

        arms = self.geometry_arms_mm or (1e3 * ARMS[0][0], 1e3 * ARMS[1][0])
        return dict(zip(("tri", "tib"), arms, strict=True))

    def tilt_deg(self, strap: float) -> float:
        """By how much zeros of foot and plate differ [deg]: ‖up‖ / R, strapped at R [m]."""
        up = self.statements["axis"].numbers["up"] if self.axis_mm else (0.0, 0.0)
        return math.degrees(math.hypot(*up) / (1e3 * strap))

    def agrees(self, source: str) -> bool | None:
        """Whether two statements of a source agree; None where there is no statement."""
        made = self.statements.get("arms" if source == "lengths" else source)
        return None if made is None else bool(made.agrees)
