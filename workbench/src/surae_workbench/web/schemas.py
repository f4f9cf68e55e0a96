"""What requests may hold, checked before anything is done with it."""

from collections.abc import Mapping
from dataclasses import is_dataclass
from datetime import date
from functools import reduce
from operator import or_
from types import GenericAlias, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_origin

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    create_model,
    field_validator,
)

from surae import api
from surae.base import names
from surae.base.records import to_plain
from surae.base.requests import DesignSettings, ExpectSettings
from surae.base.setting import Setting, default_of, kind_of, settings_of

#: No control characters, nor those that break lines or turn the direction of writing.
_PRINTED = r"^[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]"
#: An entry's id.
Id = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{16}$", min_length=16, max_length=16)]
#: One line of text.
Line = Annotated[
    str, StringConstraints(max_length=200, strip_whitespace=True, pattern=_PRINTED + "*$")
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
BodyMass = Annotated[float, Field(ge=5, le=400)]
Group = Literal["", "healthy", "patient"]
Notes = Annotated[str, StringConstraints(max_length=4000, pattern=r"^[^\x00]*$")]
Side = Literal["left", "right"]
#: A day as ``YYYY-MM-DD``.
Day = Annotated[
    str,
    StringConstraints(pattern=r"^\d{4}-\d{2}-\d{2}$"),
    AfterValidator(lambda text: date.fromisoformat(text).isoformat()),
]
Choice = Annotated[str, StringConstraints(max_length=40)]
if TYPE_CHECKING:  # known where it runs: plugins add to them
    Model = str
    Fitted = str
else:
    Model = Literal[names.MODELS.here()]
    Fitted = Literal[names.FITTED.here()]
Population = Literal[names.POPULATIONS]  # type: ignore[valid-type]
Effort = Literal["passive", "active", "maximal", "empty device", "one muscle at a time"]
Role = Literal[api.ROLES]  # type: ignore[valid-type]


Numbers = Annotated[dict[Name, Number], Field(max_length=60)]


class Strict(BaseModel):
    """No key that is not known, no number that is none, nothing taken for what it is not."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Error(BaseModel):
    """Why a request was refused, in one line."""

    error: str


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

    windows: Annotated[
        list[tuple[Seconds | None, Seconds | None, Count]], Field(max_length=500)
    ] = []
    peaks: Count = 0.0
    activity: Literal[names.ACTIVITIES] = "torque"  # type: ignore[valid-type]


#: Numbers over the angle.
Row = Annotated[list[Number], Field(max_length=2000)]


class Geometry(Strict):
    """The text of a geometry's file, or its table, see `surae.model.GeometryTable`."""

    name: Named
    text: Annotated[str, StringConstraints(max_length=1_000_000)] | None = None
    angle: Row | None = None
    length: tuple[Row, Row] | None = None
    arm: tuple[Row, Row] | None = None
    tolerance: Part | None = None
    slack: bool | None = None
    source: Notes | None = None
    second: Row | None = None

    def plain(self) -> dict[str, Any]:
        """The table; a text is read."""
        if self.text is not None:
            table: dict[str, Any] = to_plain(api.geometry_of_text(self.name, self.text))
            return table
        return self.model_dump(mode="json", exclude_none=True)


def limited(annotation: Any, record: Setting) -> Any:
    """The type of a setting with its limits, as a request holds it."""
    kind: Any = get_origin(annotation) or annotation
    parts: list[Any] = [limited(p, record) for p in get_args(annotation) if p is not Ellipsis]
    if kind in (int, float):
        least = {"ge": -1e12 if record.least is None else record.least}
        limits: dict[str, Any] = least if record.above is None else {"gt": record.above}
        most = record.most or (1e12 if kind is float else 2**53)
        kind = Annotated[kind, Field(**limits, le=most)]
    elif kind is str:
        kind = Literal[record.known] if record.choices else Line
    elif kind is UnionType:
        kind = reduce(or_, parts)
    elif kind is Mapping:
        kind = Annotated[GenericAlias(dict, (Name, parts[1])), Field(max_length=60)]
    elif kind is tuple and len(parts) == 1:
        kind = Annotated[GenericAlias(list, (Name,)), Field(max_length=60)]
    elif kind is tuple:
        kind = GenericAlias(tuple, tuple(parts))
    elif kind is api.GeometryTable:
        kind = Geometry
    elif is_dataclass(kind):
        kind = request_of(kind)
    return bool | int | Number if kind is Any else kind


def request_of(kind: Any, *without: str, defaults: bool = False, **others: Any) -> Any:
    """A request with the settings of a class as its keys, none of which must be given.

    What is left out is None, or with `defaults` the setting's own.
    """
    keys: dict[str, Any] = {}
    for each, record in settings_of(kind):
        if each.name not in without:
            of_key = others.get(each.name) or limited(each.type, record)
            usual = default_of(each)
            if usual == () and kind_of(each) == "names":
                usual = []  # what it is in JSON
            keys[each.name] = (of_key, usual) if defaults else (of_key | None, None)
    return create_model(kind.__name__, __base__=Strict, __doc__=f"See `{kind.__name__}`.", **keys)


class DraftChange(
    request_of(api.FitSettings, weights=WeightingTable),  # type: ignore[misc]
    *map(request_of, api.FIT_RECORDS[1:-1]),  # type: ignore[misc]
):
    """Keys of a draft, which are those of `surae.FitSettings` and what it is asked of.

    Those left out stay as they are. `parameters` are rows of the table: each stands for what all
    keys say of a parameter, and None for its defaults.
    """

    recordings: Annotated[list[Id], Field(max_length=50)] | None = None
    mvc: Annotated[list[Id], Field(max_length=50)] | None = None
    exclusions: Annotated[dict[Id, Spans | None], Field(max_length=50)] | None = None
    sliders: Annotated[dict[Name, Number | None], Field(max_length=60)] | None = None
    parameters: Annotated[dict[Name, ParameterRow | None], Field(max_length=60)] | None = None

    @field_validator("options", mode="before")
    @classmethod
    def _of_an_ankle(cls, options: Any) -> Any:
        if isinstance(options, dict) and options.get("joint") not in (
            None,
            *names.CHOICES["joint"],
        ):
            raise ValueError("the workbench fits ankles; fit another joint by `surae fit --joint`")
        return options

    def plain(self) -> dict[str, Any]:
        """The keys that were given, without what was left out within them."""
        data: dict[str, Any] = self.model_dump(mode="json", exclude_unset=True)
        empty = {key for key, value in data.items() if value is None and key not in _NULLABLE}
        plain = {key: value for key, value in data.items() if key not in empty}
        if "options" in plain:
            plain["options"] = {k: v for k, v in plain["options"].items() if v is not None}
            if isinstance(geometry := plain["options"].get("geometry"), dict):
                plain["options"]["geometry"] = Geometry(**geometry).plain()
        if plain.get("weights") is not None:  # what is left out of it stands for its default
            plain["weights"] = WeightingTable(**plain["weights"]).model_dump(mode="json")
        return plain


#: Settings that None is a value of.
_NULLABLE = {
    each.name
    for kind in api.FIT_RECORDS
    for each, _ in settings_of(kind)
    if default_of(each) is None
}


class DraftPatch(Strict):
    """A change of the draft."""

    change: DraftChange
    label: Named = "change"
    merge: bool = False


ColumnName = Annotated[str, StringConstraints(min_length=1, max_length=500, pattern=r"^[^\x00]+$")]


class TimeTable(Strict):
    """The column of times of all channels, and its unit."""

    column: ColumnName
    unit: Annotated[str, StringConstraints(max_length=20, pattern=r"^[^\x00-\x1f]*$")] | None = None


class ChannelEntry(Strict):
    """The origin of a channel, and what is done to it."""

    upload: Id
    column: Annotated[str, StringConstraints(min_length=1, max_length=500, pattern=r"^[^\x00]+$")]
    unit: Annotated[str, StringConstraints(max_length=20, pattern=r"^[^\x00-\x1f]*$")] | None = None
    sign: Literal[1, -1] = 1
    scale: Number = 1.0
    offset: Number = 0.0
    #: `time`, `start_s`, `rate_hz`: the clock of a film in another file.
    time: ColumnName | TimeTable | None = None
    start_s: Number | None = None
    rate_hz: Annotated[float, Field(gt=0, lt=1e6)] | None = None
    clock_ppm: Annotated[float, Field(ge=-1e5, le=1e5)] = 0.0  #: How fast its clock is.
    bridge_s: Annotated[float, Field(ge=0, le=1)] = 0.0  #: Longest gap that a line fills.


class TrialTable(Strict):
    """Which of several trials in a file is read."""

    column: ColumnName | None = None
    sheet: ColumnName | None = None
    group: ColumnName | None = None
    value: ColumnName | Number | None = None
    index: Annotated[int, Field(ge=1, le=10_000)] | None = None


class MappingTable(Strict):
    """Which column of which upload is which signal."""

    name: Named
    emg: Literal["raw", "envelope"] | None = None
    side: Side | None = None
    channels: Annotated[dict[Role, ChannelEntry], Field(min_length=1, max_length=len(api.ROLES))]
    fixed: Numbers = {}
    prepare: Annotated[dict[Name, bool | Number | Line], Field(max_length=20)] = {}
    open: Annotated[list[Role], Field(max_length=len(api.ROLES))] = []  #: Not settled.
    time: TimeTable | None = None
    trial: TrialTable | None = None


class ImportRequest(Strict):
    """A recording to import."""

    mapping: MappingTable
    subject: Id | None = None
    trial: Line | None = None
    condition: Line | None = None
    visit: Day | None = None


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


class RecordingPatch(Strict):
    """What changes of a recording's labels."""

    name: Named | None = None
    subject: Id | None = None
    side: Side | None = None
    trial: Line | None = None
    condition: Line | None = None
    visit: Day | None = None


class LiveRequest(Strict):
    """What to simulate: the draft's model, or another that a fit has come to."""

    recording: Id | None = None
    model: Model | None = None
    values: Numbers = {}
    points: Points = 1000


class FitRequest(Strict):
    """A fit to make, as the session's draft asks."""

    name: Named | None = None


#: What a visit may be asked for beforehand, in the order in which the page offers it.
Question = Literal[
    "curve_size",
    "end_stiffness",
    "slow_stiffness",
    "end_torque",
    "torque_rise",
    "range_at_torque",
    "maximal_torque_tri",
    "maximal_torque_tib",
]


class TrialsRequest(Strict):
    """Trials of one leg, and the efforts that their signals do not tell."""

    recordings: Annotated[list[Id], Field(min_length=1, max_length=64)]
    efforts: Annotated[dict[Id, Effort], Field(max_length=64)] = {}


class SessionRequest(TrialsRequest):
    """A session to fit: each trial, and all together; as the session's draft asks.

    The question is what this visit shall answer beside an earlier one, a measure's name: it counts
    in full, as it was asked before anybody saw the visit.
    """

    name: Named | None = None
    question: Question | None = None


class LegPatch(Strict):
    """What changes of a leg and its visit, all its trials with it; and what it is compared with."""

    name: Named | None = None
    subject: Id | None = None
    side: Side | None = None
    visit: Day | None = None
    before: Id | None = None


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
    """A protocol that was designed, and the limits of its movement: `surae.api.Plan`."""

    name: Annotated[str, StringConstraints(max_length=120)]
    seconds: Annotated[float, Field(gt=0, le=600)]
    origin: Annotated[float, Field(ge=0, le=1)]
    blend: Annotated[float, Field(gt=0, le=600)]
    ramps: Annotated[list[tuple[Seconds, Part, Above]], Field(max_length=1000)]
    shakes: Annotated[list[tuple[Seconds, Above, Above, Above, Above]], Field(max_length=1000)]
    bursts: Annotated[list[tuple[Seconds, Above, Part, Literal[0, 1]]], Field(max_length=1000)]
    model: Fitted = "muscle"
    population: Population | None = None


class ProtocolSettings(request_of(api.Protocol, defaults=True)):  # type: ignore[misc]
    """Settings of a protocol, see `surae.protocol.Protocol`; or, with a plan, a designed one."""

    profile: Choice
    device: Choice | None = None
    plan: ProtocolPlan | None = None
    limits: tuple[Number, Number, Above, Above] | None = None

    @property
    def motion(self) -> dict[str, Any]:
        """The settings of the motion."""
        return {each.name: getattr(self, each.name) for each, _ in settings_of(api.Protocol)}


class ProtocolDesign(request_of(DesignSettings, "duration", defaults=True)):  # type: ignore[misc]
    """A protocol to design, see `surae.design`: one for each duration."""

    device: Choice | None = None
    durations: Annotated[
        list[Annotated[float, Field(ge=5, le=180)]], Field(min_length=1, max_length=6)
    ]
    evaluations: Annotated[int, Field(ge=1, le=50_000)] = 4000


class ProtocolPreview(request_of(ExpectSettings, "legs", defaults=True)):  # type: ignore[misc]
    """A protocol, and whose legs it is for."""

    settings: ProtocolSettings
    predict: bool = True  #: Whether to say what it would tell, which takes longer than to draw it.


class ProtocolRequest(Strict):
    """A protocol to keep."""

    name: Named
    settings: ProtocolSettings


class ProtocolFile(Strict):
    """A protocol to export, and why, where it has no device or exceeds a limit of it."""

    settings: ProtocolSettings
    name: Line = ""
    reason: Annotated[str, StringConstraints(max_length=300)] = ""


class StudyRequest(Strict):
    """A study to make."""

    toml: Annotated[str, StringConstraints(min_length=1, max_length=100_000, pattern=r"^[^\x00]*$")]
    start: bool = True
