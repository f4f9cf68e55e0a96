"""What requests are answered with: the entries of a project, as every list and page shows them.

Routes keep to these forms: a missing field is an error, and what stands in no form is never sent.
"""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from surae_workbench.web import rows


class Answer(BaseModel):
    """An entry of the project."""

    model_config = ConfigDict(strict=False, extra="ignore")

    id: str
    created: str | None  #: In UTC.


class Subject(rows.Subject, Answer):
    """Whose leg it is, with how many recordings and fits."""

    recordings: int
    fits: int


class Trial(Answer):
    """A recording in lists."""

    name: str
    subject: str | None
    side: str | None
    visit: str | None = None
    trial: str
    condition: str
    duration_s: float
    fits: int


class Recording(Trial):
    """A recording, and what it was made of."""

    emg: str | None
    channels: list[rows.Channel]
    files: list[rows.File]
    mapping: dict[str, Any] | None
    fixed: dict[str, float]
    version: int


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


class Leg(Answer):
    """A visit of a leg."""

    name: str
    subject: str | None
    side: str | None
    visit: str  #: Its day.
    before: str | None = None  #: The visit it is compared with.
    question: str | None = None  #: What it was asked for before it was analysed.
    recordings: list[str]
    trials: int
    grade: str | None
    fit: str | None  #: The one that stands for it.


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
    progress: dict[str, Any] | None
    mine: bool
