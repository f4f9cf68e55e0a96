"""Muscle parameters that other programs have found, as plain records."""

import re
from dataclasses import dataclass, replace

#: Parameters by their names here: unit, and whether a length that grows with the body.
PARAMETERS = {
    "optimal_fiber_length": "m",
    "tendon_slack_length": "m",
    "max_isometric_force": "N",
    "pennation_angle": "rad",
    "max_contraction_velocity": "l0/s",
    "tendon_strain": "1",
    "tendon_stiffness": "1",
    "activation_time": "s",
    "electromechanical_delay": "s",
    "activation_nonlinearity": "1",
    "emg_scale": "1",
    "c1": "1",
    "c2": "1",
    "shape_factor": "1",
    "strength_coefficient": "1",
}
#: What models call muscles of the leg, by the names that humans.toml has; without a side.
_STEMS = {
    "soleus": r"sol(?:eus)?",
    "gastrocnemius medialis": r"gas_?med(?:ialis)?|med_?gas|gastroc(?:nemius)?_?m\w*|gm",
    "gastrocnemius lateralis": r"gas_?lat(?:eralis)?|lat_?gas|gastroc(?:nemius)?_?l\w*|gl",
    "gastrocnemius": r"gas|gastroc|gastrocnemius",
    "tibialis anterior": r"tib_?ant(?:erior)?|tibialis_?ant(?:erior)?|ta",
    "tibialis posterior": r"tib_?post(?:erior)?|tp",
    "peroneus longus": r"per_?long?(?:us)?",
    "peroneus brevis": r"per_?brev(?:is)?",
    "flexor hallucis longus": r"fhl|flex_?hal(?:l)?",
    "flexor digitorum longus": r"fdl|flex_?dig",
    "extensor hallucis longus": r"ehl|ext_?hal(?:l)?",
    "extensor digitorum longus": r"edl|ext_?dig",
    "rectus femoris": r"rec_?fem|rf",
    "vastus lateralis": r"vas_?lat|vl",
    "vastus intermedius": r"vas_?int|vi",
    "vastus medialis": r"vas_?med|vm",
    "semitendinosus": r"semi_?ten|st",
    "semimembranosus": r"semi_?mem|sm",
    "biceps femoris long head": r"bflh|bic_?fem_?lh|bifemlh",
    "biceps femoris short head": r"bfsh|bic_?fem_?sh|bifemsh",
    "gracilis": r"gra(?:c|cilis)?",
    "sartorius": r"sar(?:t|torius)?",
}


@dataclass(frozen=True, slots=True)
class ForeignValue:
    """A parameter of a muscle as another program has it."""

    muscle: str  #: As the program calls it.
    parameter: str  #: One of `PARAMETERS`.
    value: float
    generic: float | None = None  #: What it began from; None where that is not known.
    #: `low`, `high`: limits of the search; None where they are not known.
    low: float | None = None
    high: float | None = None
    free: bool | None = None  #: Whether it was searched for; None where that is not known.

    @property
    def unit(self) -> str:
        """Its unit."""
        return PARAMETERS[self.parameter]

    @property
    def anatomy(self) -> str:
        """Which muscle of a human it is; empty where its name does not tell."""
        bare = re.sub(r"^[rl]_|_[rl]$", "", self.muscle.casefold())
        return next((n for n, stem in _STEMS.items() if re.fullmatch(stem, bare)), "")


@dataclass(frozen=True, slots=True)
class ForeignResult:
    """What one program found of the muscles of one person."""

    program: str  #: "OpenSim", "NMSM", "CEINMS" or "MuscleRedundancySolver".
    path: str  #: The file.
    values: tuple[ForeignValue, ...]
    model: str = ""  #: The OpenSim model that it is of, where it is found; else empty.
    mass: float | None = None  #: Of the person [kg], by the model's bodies.
    notes: tuple[str, ...] = ()  #: What was read from where.

    def with_generic(self, generic: "ForeignResult") -> "ForeignResult":
        """The result with the values of another as what it began from."""
        known = {(v.muscle, v.parameter): v.value for v in generic.values}
        values = tuple(
            replace(v, generic=known.get((v.muscle, v.parameter), v.generic)) for v in self.values
        )
        return replace(self, values=values)
