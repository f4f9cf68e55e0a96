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
#: How well a leg's own lengths are known where its arms are told twice [m]; assumed.
_LENGTH = 0.0025
#: How well size tells a moment arm [%]: adults' differ by 9.5 % (Wolfram et al. 2018), of which the
#: foot's length explains half (Waugh et al. 2011), and published legs of one height by 8 to 14 %.
#: What paths travel is as unknown as of any leg. Arms are assumed of men of so many cm, whose feet
#: are a part of that (Drillis and Contini 1966).
SCALED_SD = 8.0
_TRAVEL = 30.0
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
_STATURE_SD = 5.0
_GROWN = 18.0
#: Mass of a foot over the body's (Winter 2009), of a foot plate [kg], and how far off both are.
_FOOT_MASS = 0.0145
_PLATE_MASS = 1.0
_MASS_SPREAD = 0.30
#: What a plate that was tared elsewhere leaves: inertia [kg·m²] and weight [Nm], a tenth of what an
#: untared one has; assumed.
_TARED = (0.003, 0.5)
#: What no tare of the plate tells: the foot's own weight, 1 Nm where it is level, at sin θ where a
#: seat is reclined by some 30° [Nm]; assumed.
_SEAT = 0.5
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
    def left(self) -> tuple[float, float]:
        """What taking it away leaves, standard deviations: inertia [kg·m²] and weight [Nm]."""
        inertia = self.values[0]
        weight = math.hypot(*self.values[1:3])
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
        own = self.geometry_sd_percent or SCALED_SD
        return own if self.foot_mm or self.height_cm else math.hypot(own, _STATURE_SD)

    @property
    def mass(self) -> tuple[float, float] | None:
        """Prior of the mass of foot and plate: median [kg], and spread of its logarithm."""
        if self.mass_kg is None:
            return None
        return _FOOT_MASS * self.mass_kg + _PLATE_MASS, _MASS_SPREAD

    @property
    def statements(self) -> dict[str, Pooled]:
        """What was stated of zero [deg], axis and arms [mm], by source of uncertainty."""
        by_hand = {"angle_zero": self.angle_zero_deg, "axis": self.axis_mm}
        made = {source: by.statements for source, by in by_hand.items() if by is not None}
        if self.geometry_sd_percent is not None and not self.size:
            part = self.geometry_sd_percent / 100.0
            made["arms"] = [{group: (arm, part * arm) for group, arm in self.usual.items()}]
        arms = {"tri": self.arm_tri_mm, "tib": self.arm_tib_mm}
        if own := {group: (arm.value, arm.sd) for group, arm in arms.items() if arm is not None}:
            made.setdefault("arms", []).append(own)
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

    @property
    def name(self) -> str:
        """What it is among other settings."""
        return "; ".join(f"{what} {how}" for what, how, _ in self.lines()) or "nothing"

    @property
    def groups(self) -> frozenset[str]:
        """Groups of nuisances of which something is known: these are in every fit."""
        known = {
            "axis": self.axis_mm,
            "plate": self.plate,
            "crosstalk": self.crosstalk,
            "arm": self.size or "arms" in self.statements,
        }
        return frozenset(group for group, stated in known.items() if stated)

    def nuisances(self) -> dict[str, tuple[float, float]]:
        """Priors, mean and standard deviation, by parameter, in SI units."""
        from surae.model.parameters import OPTIONAL

        priors = dict[str, tuple[float, float]]()
        made = self.statements
        if "axis" in made:
            ways = zip(OPTIONAL["axis"], made["axis"].numbers.values(), strict=True)
            priors |= {name: (value / 1e3, sd / 1e3) for name, (value, sd) in ways}
        if self.plate is not None:
            inertia, weight = self.plate.left if self.plate.file else _TARED
            sizes = (inertia, weight, max(weight, _SEAT))
            priors |= {n: (0.0, sd) for n, sd in zip(OPTIONAL["plate"], sizes, strict=True)}
        priors |= {name: (stated.value, stated.sd) for name, stated in self.crosstalk.items()}
        if self.size:
            sds = {"arm_scale": self.size_sd, "path_scale": _TRAVEL}
            scales = [n for n in OPTIONAL["arm"] if n.startswith(tuple(sds))]
            priors |= {name: (math.log(self.size), sds[name[:-4]] / 100.0) for name in scales}
        if "arms" in made:
            usual = self.usual
            arms = made["arms"]
            for group, (arm, sd) in arms.numbers.items():
                scale = math.log(arm / usual[group]), sd / arm
                priors[f"arm_scale_{group}"] = scale
                if self.geometry_sd_percent is not None and not self.size:
                    far = scale[0], _TRAVEL / 100.0  # whose it is is not known either
                    priors[f"path_scale_{group}"] = far if arms.agrees is False else scale
            if self.geometry and arms.agrees:
                priors |= dict.fromkeys(OPTIONAL["length_zero"], (0.0, _LENGTH))
        return priors

    def lines(self) -> tuple[tuple[str, str, str], ...]:
        """What was known, how well, and where it is from, for readers."""
        rows = [made.line for made in self.statements.values()]
        if self.plate is not None:
            rows.append(("empty device", self.plate.words, self.plate.file or "stated"))
        if self.geometry:
            whose = "this person’s" if self.geometry_of == GEOMETRY_OF[1] else "a generic one"
            rows.append(("lengths and moment arms", whose, self.geometry))
        if self.size:
            how = f"{self.size:.3g} times the assumed, ± {self.size_sd:.2g} %"
            by = "height and foot" if self.foot_mm or self.height_cm else "age"
            rows.append(("moment arms", how, by))
        if self.mass is not None:
            text = f"{self.mass[0]:.2g} kg, ± {100 * _MASS_SPREAD:.0f} %"
            rows.append(("mass of foot and plate", text, "body mass"))
        if self.crosstalk:
            largest = max(self.crosstalk.values(), key=lambda stated: stated.value)
            sds = sorted(stated.sd for stated in self.crosstalk.values())
            text = f"at most {100 * largest.value:.0f} % of another muscle’s EMG, ± "
            rows.append(("crosstalk", f"{text}{100 * sds[len(sds) // 2]:.1f} %", self.crosstalk_of))
        return tuple(rows)
