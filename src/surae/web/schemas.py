"""What requests may hold, checked before anything is done with it."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from surae import api, names

#: No control characters, nor those that break lines or turn the direction of writing.
_PRINTED = r"^[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]"
#: A thing's id.
Id = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{16}$", min_length=16, max_length=16)]
#: One line of text.
Line = Annotated[
    str,
    StringConstraints(max_length=200, strip_whitespace=True, pattern=_PRINTED + "*$"),
]
Named = Annotated[
    str,
    StringConstraints(min_length=1, max_length=200, strip_whitespace=True, pattern=_PRINTED + "+$"),
]
#: The name of a parameter or of an option.
Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,39}$")]
Number = Annotated[float, Field(ge=-1e12, le=1e12)]
Positive = Annotated[float, Field(gt=0, le=1e12)]
Part = Annotated[float, Field(ge=0, le=1)]
Above = Annotated[float, Field(gt=0, le=1e6)]
Seconds = Annotated[float, Field(ge=-1e9, le=1e9)]
Count = Annotated[float, Field(ge=0, le=1e6)]
Points = Annotated[int, Field(ge=10, le=2000)]
Noise = Annotated[float, Field(gt=0, le=100)]
BodyMass = Annotated[float, Field(ge=5, le=400)]
Group = Literal["", "healthy", "patient"]
Notes = Annotated[str, StringConstraints(max_length=4000, pattern=r"^[^\x00]*$")]
Side = Literal["left", "right"]
Choice = Annotated[str, StringConstraints(max_length=40)]
Model = Literal[names.MODELS]  # type: ignore[valid-type]
FittedModel = Literal[names.FITTED]  # type: ignore[valid-type]
Nuisances = Literal[names.NUISANCES]  # type: ignore[valid-type]
Population = Literal[names.POPULATIONS]  # type: ignore[valid-type]
FootShare = Literal[names.FOOT_SHARES]  # type: ignore[valid-type]
Loss = Literal[names.LOSSES]  # type: ignore[valid-type]
Normalisation = Literal[names.NORMALISATIONS]  # type: ignore[valid-type]
Activity = Literal[names.ACTIVITIES]  # type: ignore[valid-type]
Geometry = Literal[names.CHOICES["geometry"]]  # type: ignore[valid-type,name-defined]
TendonStrain = Literal[names.CHOICES["tendon_strain"]]  # type: ignore[valid-type,name-defined]
Integrator = Literal[names.CHOICES["integrator"]]  # type: ignore[valid-type,name-defined]
Role = Literal[api.ROLES]  # type: ignore[valid-type]


Numbers = Annotated[dict[Name, Number], Field(max_length=60)]


class Strict(BaseModel):
    """No key that is not known, no number that is none, nothing taken for what it is not."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Error(BaseModel):
    """Why a request was refused, in one line."""

    error: str


class Options(Strict):
    """Model options, see `surae.model.ModelOptions`."""

    geometry: Geometry | None = None
    tendon_strain: TendonStrain | None = None
    integrator: Integrator | None = None
    theta_foot: Number | None = None
    vmax_factor: Annotated[float, Field(gt=0, le=1e3)] | None = None
    x_ref_tri: Annotated[float, Field(gt=0, le=10)] | None = None
    x_ref_tib: Annotated[float, Field(gt=0, le=10)] | None = None


class PriorEntry(Strict):
    """A parameter's prior."""

    median: Positive
    spread: Annotated[float, Field(gt=0, le=100)]


class ParameterRow(Strict):
    """What differs from a parameter's defaults."""

    free: bool | None = None
    value: Number | None = None
    lower: Number | None = None
    upper: Number | None = None
    prior: PriorEntry | None = None


Span = tuple[Seconds, Seconds]
Spans = Annotated[list[Span], Field(max_length=500)]


class WeightingTable(Strict):
    """What samples count, see `surae.Weighting`."""

    windows: Annotated[list[tuple[Seconds | None, Seconds | None, Count]], Field(max_length=500)]
    peaks: Count = 0.0
    activity: Activity = "torque"


class DraftChange(Strict):
    """Keys of a draft, which are those of `surae.FitSettings` and what it is asked of.

    Those left out stay as they are. `parameters` are rows of the table: each stands for what all
    keys say of a parameter, and None for its defaults.
    """

    recordings: Annotated[list[Id], Field(max_length=50)] | None = None
    mvc: Annotated[list[Id], Field(max_length=50)] | None = None
    exclusions: Annotated[dict[Id, Spans | None], Field(max_length=50)] | None = None
    sliders: Annotated[dict[Name, Number | None], Field(max_length=60)] | None = None
    parameters: Annotated[dict[Name, ParameterRow | None], Field(max_length=60)] | None = None
    model: FittedModel | None = None
    options: Options | None = None
    fixed: Numbers | None = None
    free: Annotated[list[Name], Field(max_length=60)] | None = None
    start: Numbers | None = None
    bounds: Annotated[dict[Name, tuple[Number, Number]], Field(max_length=60)] | None = None
    priors: Annotated[dict[Name, tuple[Positive, Positive]], Field(max_length=60)] | None = None
    population: Population | None = None
    body_mass: BodyMass | None = None
    footplate_mass: Annotated[float, Field(ge=0, le=20)] | None = None
    foot_share: FootShare | None = None
    weights: WeightingTable | None = None
    loss: Loss | None = None
    normalise: Normalisation | None = None
    prepared: bool | None = None
    preparation: Annotated[dict[Name, bool | int | Number], Field(max_length=20)] | None = None
    nuisances: Nuisances | dict[Name, tuple[Number, Number]] | None = None
    starts: Annotated[int, Field(ge=1, le=1000)] | None = None
    seed: Annotated[int, Field(ge=0, le=2**31)] | None = None

    def plain(self) -> dict[str, Any]:
        """The keys that were given, without what was left out within them."""
        data = self.model_dump(mode="json", exclude_unset=True)
        empty = {key for key, value in data.items() if value is None and key not in _NULLABLE}
        plain = {key: value for key, value in data.items() if key not in empty}
        if "options" in plain:
            plain["options"] = {k: v for k, v in plain["options"].items() if v is not None}
        if self.weights is not None:  # one thing: what is left out of it stands for its default
            plain["weights"] = self.weights.model_dump(mode="json")
        return plain


_NULLABLE = ("population", "loss", "body_mass", "weights", "normalise")


class DraftPatch(Strict):
    """A change of the draft."""

    change: DraftChange
    label: Named = "change"
    revision: Annotated[int, Field(ge=0)] | None = None
    merge: bool = False


class ChannelEntry(Strict):
    """The origin of a channel, and what is done to it."""

    upload: Id
    column: Annotated[str, StringConstraints(min_length=1, max_length=500, pattern=r"^[^\x00]+$")]
    unit: Annotated[str, StringConstraints(max_length=20, pattern=r"^[^\x00-\x1f]*$")] | None = None
    sign: Literal[1, -1] = 1
    scale: Number = 1.0
    offset: Number = 0.0


class MappingTable(Strict):
    """Which column of which upload is which signal."""

    name: Named
    emg: Literal["raw", "envelope"] | None = None
    side: Side | None = None
    channels: Annotated[dict[Role, ChannelEntry], Field(min_length=1, max_length=len(api.ROLES))]
    fixed: Numbers = {}
    prepare: Annotated[dict[Name, bool | Number | Line], Field(max_length=20)] = {}


class ImportRequest(Strict):
    """A recording to import."""

    mapping: MappingTable
    subject: Id | None = None
    trial: Line | None = None
    condition: Line | None = None


class DescriptionRequest(Strict):
    """Another description of recordings: of the first as it is, of others in the same way."""

    recordings: Annotated[list[Id], Field(min_length=1, max_length=64)]
    mapping: MappingTable


class SubjectRequest(Strict):
    """A subject: a code, never a name."""

    code: Named
    group: Group = ""
    notes: Notes = ""
    body_mass: BodyMass | None = None


class SubjectPatch(Strict):
    """What changes of a subject."""

    code: Named | None = None
    group: Group | None = None
    notes: Notes | None = None
    body_mass: BodyMass | None = None


class RecordingPatch(Strict):
    """What changes of a recording's labels."""

    name: Named | None = None
    subject: Id | None = None
    side: Side | None = None
    trial: Line | None = None
    condition: Line | None = None


class LiveRequest(Strict):
    """What to simulate."""

    recording: Id | None = None
    values: Numbers = {}
    parts: bool = False
    points: Points = 1000
    start: Seconds | None = None
    end: Seconds | None = None


class FitRequest(Strict):
    """A fit to make: of a draft, or of the session's own."""

    name: Named | None = None
    draft: DraftChange | None = None


class TrialsRequest(Strict):
    """Trials of one leg, and the efforts that their signals do not tell."""

    recordings: Annotated[list[Id], Field(min_length=1, max_length=64)]
    efforts: Annotated[dict[Id, Literal["passive", "active", "maximal"]], Field(max_length=64)] = {}


class SessionRequest(TrialsRequest):
    """A session to fit: each trial, and all together; as the session's draft asks, or one given."""

    name: Named | None = None
    draft: DraftChange | None = None


class ComparisonRequest(Strict):
    """Models to compare on a draft's recordings."""

    draft: DraftChange | None = None
    models: Annotated[list[Model], Field(min_length=2, max_length=5)] | None = None
    fit: Id | None = None


class NameRequest(Strict):
    """A new name."""

    name: Named


class ProfileRequest(Strict):
    """Parameters to profile; all by default."""

    parameters: Annotated[list[Name], Field(min_length=1, max_length=60)] | None = None


class ValidateRequest(Strict):
    """Recordings to predict."""

    recordings: Annotated[list[Id], Field(min_length=1, max_length=50)]


class ProtocolPlan(Strict):
    """A protocol that was designed, and the limits of its movement, see `surae.planning.plan`."""

    name: Annotated[str, StringConstraints(max_length=120)]
    seconds: Annotated[float, Field(gt=0, le=600)]
    origin: Annotated[float, Field(ge=0, le=1)]
    blend: Annotated[float, Field(gt=0, le=600)]
    ramps: Annotated[list[tuple[Seconds, Part, Above]], Field(max_length=1000)]
    shakes: Annotated[list[tuple[Seconds, Above, Above, Above, Above]], Field(max_length=1000)]
    bursts: Annotated[list[tuple[Seconds, Above, Part, Literal[0, 1]]], Field(max_length=1000)]
    model: Model = "muscle"
    population: Population | None = None


class ProtocolSettings(Strict):
    """Settings of a protocol, see `surae.protocol.Protocol`; or, with a plan, a designed one."""

    profile: Choice
    task: Choice = "part-passive"
    chirp_amplitude: Annotated[float, Field(ge=0, le=3)] = 0.0
    chirp_rate: Annotated[float, Field(ge=0, le=100)] = 0.159
    range: tuple[Number, Number] = (-0.9, 0.6)
    duration: Annotated[float, Field(gt=0, le=600)] | None = None
    rate_hz: Annotated[float, Field(gt=0, le=2000)] = 256.0
    device: Choice | None = None
    adapt: bool = True
    plan: ProtocolPlan | None = None
    limits: tuple[Number, Number, Above, Above] | None = None


class ProtocolDesign(Strict):
    """A protocol to design: for whom, within what, and how long; one for each duration."""

    settings: ProtocolSettings
    durations: Annotated[
        list[Annotated[float, Field(ge=5, le=180)]],
        Field(min_length=1, max_length=6),
    ]
    model: Model = "muscle"
    population: Population = "healthy"
    noise: Noise = 0.5
    aim: Annotated[str, StringConstraints(min_length=1, max_length=200)] = "worst"
    effort: Literal["levels", "none"] = "levels"
    evaluations: Annotated[int, Field(ge=1, le=50_000)] = 4000


class ProtocolPreview(Strict):
    """A protocol, and who it is for."""

    settings: ProtocolSettings
    model: Model = "muscle"
    population: Population = "healthy"
    noise: Noise = 0.5


class ProtocolRequest(Strict):
    """A protocol to keep."""

    name: Named
    settings: ProtocolSettings


class ProtocolFile(Strict):
    """A protocol to export, and why, where it has no device or exceeds a limit of it."""

    settings: ProtocolSettings
    reason: Annotated[str, StringConstraints(max_length=300)] = ""


class StudyRequest(Strict):
    """A study to make."""

    toml: Annotated[str, StringConstraints(min_length=1, max_length=100_000, pattern=r"^[^\x00]*$")]
    start: bool = True
