"""What requests are answered with: the entries of a project, as every list and page shows them.

Routes keep to these forms: a missing field is an error, and what stands in no form is never sent.
"""

from types import GenericAlias
from typing import Any, Literal

from pydantic import BaseModel, create_model


class Answer(BaseModel):
    """An entry of the project."""

    id: str
    created: str | None  #: In UTC.


class Subject(Answer):
    """Whose leg it is, by a code."""

    code: str
    group: str
    notes: str
    body_mass: float | None  #: [kg].
    recordings: int
    fits: int
    revision: str


class Channel(BaseModel):
    """A signal of a recording."""

    role: str
    unit: str
    n: int
    rate_hz: float
    source: str


class File(BaseModel):
    """A file that a recording was made of."""

    name: str
    sha256: str


class Recording(Answer):
    """A trial."""

    name: str
    subject: str | None
    side: str | None
    trial: str
    condition: str
    duration_s: float
    emg: str | None
    channels: list[Channel]
    files: list[File]
    mapping: dict[str, Any] | None
    fixed: dict[str, float]
    fits: int
    version: int
    revision: str


class Fit(Answer):
    """A fit in lists."""

    name: str
    title: str  #: The model's.
    status: str
    r2: float | None  #: Part of the torque's changes that is followed [%].
    recordings: list[str]
    names: list[str]
    older: list[str]  #: Its recordings that have been described anew since.
    subject: str | None


class FitPage(BaseModel):
    """What the page of a fit needs beside its report."""

    summary: Fit
    parameters: dict[str, dict[str, Any]]
    settings: dict[str, Any]
    profiles: dict[str, dict[str, Any]]


class Leg(Answer):
    """A visit of a leg."""

    name: str
    subject: str | None
    side: str | None
    trials: int
    grade: str | None
    fit: str | None  #: The one that stands for it.


class LegPage(BaseModel):
    """What the page of a leg needs beside its report."""

    summary: Leg
    visits: list[Leg]
    fits: dict[str, Fit]
    paper: bool  #: Whether a PDF can be made.


class Upload(Answer):
    """A file that was uploaded."""

    name: str
    bytes: int
    sha256: str


class Protocol(Answer):
    """A protocol that was kept."""

    name: str
    settings: dict[str, Any]


class Study(Answer):
    """A study, and how far it is."""

    name: str
    rows: int
    toml: str
    fits: int | None
    done: int
    state: str
    job: str | None
    reasons: dict[str, int]
    factors: dict[str, list[Any]]


class Job(Answer):
    """Work that takes time, and how it stands."""

    kind: str
    label: str
    state: Literal["queued", "running", "done", "failed", "cancelled", "interrupted"]
    message: str
    result: str | None
    fit: str | None
    recordings: list[str]
    position: int | None
    started: str | None
    ended: str | None
    seconds: float | None
    progress: dict[str, Any] | None
    mine: bool


class DraftState(BaseModel):
    """What a browser is working on, and what undo and redo would do."""

    revision: int
    undo: str | None
    redo: str | None
    draft: dict[str, Any]


class ParameterRows(BaseModel):
    """The parameters of a draft's model, and why it cannot be fitted."""

    model: str
    problem: str | None
    parameters: list[dict[str, Any]]


class LiveTorque(BaseModel):
    """Measured torque, and that of the sliders."""

    recording: str
    t: list[float]
    measured: list[float | None] | None
    modelled: list[float | None]
    r2: float | None
    rmse: float | None


class CohortRow(BaseModel):
    """The fit of a visit, or any fit."""

    fit: str
    subject: str
    group: str
    side: str | None
    trial: str
    condition: str
    name: str
    model: str
    model_title: str
    status: str
    grade: str | None
    r2: float | None
    vaf: float | None
    ipde: float | None
    parameters: dict[str, dict[str, Any]]
    created: str | None


class Cohort(BaseModel):
    """Estimates of every leg."""

    columns: list[dict[str, str]]  #: Name, unit and meaning of parameters.
    rows: list[CohortRow]


class Inspection(BaseModel):
    """What is in a file, and a guess of what each column is."""

    id: str
    name: str
    format: str
    columns: list[dict[str, Any]]
    mapping: dict[str, Any]
    notes: list[str]
    ready: bool


class Units(BaseModel):
    """The roles of channels, and the units of each."""

    roles: list[str]
    units: dict[str, list[str]]


class Preview(BaseModel):
    """What a mapping makes of files."""

    name: str
    emg: str | None
    side: str | None
    duration_s: float
    fixed: dict[str, float]
    files: list[File]
    channels: list[dict[str, Any]]
    findings: list[dict[str, Any]]
    twin: dict[str, str] | None = None  #: The recording that was made of the same before.


class Findings(BaseModel):
    """What is questionable about a recording."""

    findings: list[dict[str, Any]]


class Signal(BaseModel):
    """A signal, by few enough points."""

    role: str
    unit: str
    n: int
    reduced: bool
    t: list[float]
    v: list[float | None]


class Window(BaseModel):
    """A part of a recording's signals [s]."""

    start: float
    end: float
    signals: list[Signal]


class SortedTrial(BaseModel):
    """What a trial is, and what it is used for."""

    recording: str
    name: str
    effort: str
    stated: bool
    fitted: bool
    what: str
    why: str
    use: str
    problem: str


class SortedTrials(BaseModel):
    """The trials of a leg."""

    trials: list[SortedTrial]


class StudyTable(BaseModel):
    """The first rows of a study's table."""

    columns: list[str]
    rows: list[list[Any]]
    total: int


class Part(BaseModel):
    """A part of a report."""

    html: str


def _list(name: str, kind: type[Answer], **more: Any) -> Any:
    """A list of entries under its name."""
    fields: dict[str, Any] = {name: (GenericAlias(list, (kind,)), ...)} | more
    return create_model(f"{kind.__name__}List", **fields)


Subjects, Legs = _list("subjects", Subject), _list("sessions", Leg)
Uploads, Jobs = _list("uploads", Upload), _list("jobs", Job)
Protocols, Studies = _list("protocols", Protocol), _list("studies", Study)
#: A part of a long list, those that were wanted anyway, and how many there are.
Recordings = _list("recordings", Recording, also=(list[Recording], ...), total=(int, ...))
Fits = _list("fits", Fit, also=(list[Fit], ...), total=(int, ...))
