"""What the rows of project.db hold, kind by kind: a project may be a stranger's, or damaged.

A row that is not as it should be is shown as damaged; all others are as they were.
"""

import hashlib
import json
import math
import re
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from surae import api
from surae.base.errors import InputError
from surae_workbench.web.schemas import ProtocolSettings

#: An entry: its content with its `id` and `created`.
Entry = dict[str, Any]

ID = re.compile(r"[0-9a-f]{16}")
#: Longest content of a row [characters].
_LONGEST = 16 * 2**20
#: Until the year 9999 [s].
_LAST = 253_402_300_799

#: What a row's own checksum is called in it.
SEAL = "row_sha256"

#: What stands behind the name of an entry whose row has none.
NOT_SEALED = " (not sealed: made by an older version)"
#: What such a row is not believed of, by its kind.
_UNKNOWN: dict[str, Entry] = {
    "recording": {"findings": None, "first": None},
    "fit": {"grade": None, "r2": None, "vaf": None, "ipde": None, "profiles": {}},
    "session": {"content": {"adequacy": None}},
}
_NO_ESTIMATE = {"value": None, "sem": None, "low": None, "high": None, "verdict": "undetermined"}

_Id = Annotated[str, Field(pattern=r"^[0-9a-f]{16}$")]
_Time = Annotated[float, Field(ge=0, le=_LAST)]


class _Row(BaseModel):
    """Nothing is taken for what it is not; what a newer surae adds is left as it is."""

    model_config = ConfigDict(strict=True, extra="allow", allow_inf_nan=False)


class Subject(_Row):
    """Whose leg it is, by a code."""

    code: str
    group: str
    notes: str
    body_mass: float | None  #: [kg].


class Channel(_Row):
    """A signal of a recording."""

    role: str
    unit: str
    n: int
    rate_hz: float
    source: str


class File(_Row):
    """A file that a recording was made of."""

    name: str
    sha256: str


class _Recording(_Row):
    name: str
    subject: _Id | None
    side: str | None
    trial: str
    condition: str
    visit: str | None = None
    duration_s: float
    emg: str | None
    fixed: dict[str, float]
    channels: list[Channel]
    files: list[File]
    mapping: dict[str, Any] | None
    findings: list[dict[str, Any]] | None = None
    first: dict[str, Any] | None = None
    version: int = 0
    version_sha256: str | None = None
    latest: int = 0


class _Estimate(_Row):
    value: float | None
    sem: float | None
    low: float | None
    high: float | None
    verdict: str


class _Fit(_Row):
    name: str
    model: str
    status: str
    vaf: float | None
    r2: float | None = None
    grade: str | None = None
    ipde: float | None
    recordings: Annotated[list[_Id], Field(min_length=1)]
    names: list[str]
    parameters: dict[str, _Estimate]
    measures: dict[str, _Estimate] = {}
    settings: dict[str, Any]
    profiles: dict[str, dict[str, Any]] = {}
    versions: dict[str, int] = {}


#: What is shown of every leg first, and its unit.
MEASURES = {
    "end_stiffness": "Nm/deg",
    "end_torque": "Nm",
    "torque_rise": "Nm",
    "passive_stiffness@10deg": "Nm/deg",
    "passive_torque@10deg": "Nm",
    "neutral_angle": "deg",
}


class _Adequacy(_Row):
    grade: str


class _SessionContent(_Row):
    adequacy: _Adequacy | None = None


class _Session(_Row):
    name: str
    recordings: Annotated[list[_Id], Field(min_length=1)]
    fits: dict[str, _Id]
    content: _SessionContent
    settings: dict[str, Any]
    before: _Id | None = None
    question: str | None = None


class _Study(_Row):
    name: str
    toml: str
    rows: int


class _Protocol(_Row):
    name: str
    settings: dict[str, Any]


class _Upload(_Row):
    name: str
    bytes: int
    sha256: str
    session: str


class _Job(_Row):
    kind: Literal["fit", "profile", "session", "study", "design"]
    label: str
    state: Literal["queued", "running", "done", "failed", "cancelled", "interrupted"]
    session: str
    task: dict[str, Any]
    about: str | None
    message: str
    result: str | None
    started: _Time | None
    ended: _Time | None


#: The form of each kind; others, of a newer surae, are not looked at.
KINDS: dict[str, type[_Row]] = {
    "subject": Subject,
    "recording": _Recording,
    "fit": _Fit,
    "session": _Session,
    "study": _Study,
    "protocol": _Protocol,
    "upload": _Upload,
    "job": _Job,
}


def sealed(project: str, kind: str, id_: str, created: float, content: Entry) -> str:
    """The content of a row as JSON, with the checksum of all that it says and where it belongs."""
    as_read = json.loads(json.dumps(content, allow_nan=False))  # keys that are numbers are texts
    seal = _seal(project, kind, id_, created, as_read)
    return json.dumps({**as_read, SEAL: seal}, allow_nan=False)


def is_sealed(text: str) -> bool:
    """Whether a row has a checksum: those of older versions have none."""
    return f'"{SEAL}": "' in text


def _seal(project: str, kind: str, id_: str, created: float, content: Entry) -> str:
    whole = json.dumps([project, kind, id_, float(created), content], sort_keys=True)
    return hashlib.sha256(whole.encode("utf-8", "surrogatepass")).hexdigest()


def entry(kind: str, id_: object, created: object, text: object, project: str) -> Entry:
    """A row as an entry of a project, which is known by its id.

    A ValueError says what is wrong with it, in a few words.
    """
    if not isinstance(id_, str) or not ID.fullmatch(id_):
        raise ValueError("its id is none of ours")
    if not isinstance(created, float | int) or not 0 <= created <= _LAST:
        raise ValueError("its time is impossible")
    content = plain(text)
    if not isinstance(content, dict):
        raise ValueError("it holds no table")
    seal = content.pop(SEAL, None)
    if seal is not None and seal != _seal(project, kind, id_, created, content):
        raise ValueError("what it says is not what was kept here: edited, or another row's")
    form = KINDS.get(kind)
    if form is not None:
        try:
            form.model_validate(content)
            if kind == "protocol":
                settings = content["settings"]
                for old in settings.keys() & {"range", "range_of_motion"}:  # an older surae's
                    settings["angle_range"] = settings.pop(old)
                content["settings"] = ProtocolSettings(**settings).model_dump(mode="json")
        except ValidationError as error:
            first = error.errors()[0]
            place = ".".join(str(part)[:40] for part in first["loc"][:4])
            raise ValueError(f"{place}: {first['msg']}".removeprefix(": ")) from None
    if kind == "study":
        try:
            api.parse_study(content["toml"])
        except InputError as error:
            raise ValueError(str(error)) from None
    if seal is None:
        content = _without_verdicts(kind, content)
    return {**content, "id": id_, "created": created}


def _without_verdicts(kind: str, content: Entry) -> Entry:
    """A row of an older version, or whose checksum was taken off: its verdicts are not believed.

    What is judged is judged anew where its file is opened, whose checksums hold; its name says why
    lists show none.
    """
    unknown = _UNKNOWN.get(kind)
    if unknown is None:
        return content
    bare = {**content, **{key: value for key, value in unknown.items() if key in content}}
    for key in ("parameters", "measures"):
        if isinstance(estimates := bare.get(key), dict):
            bare[key] = dict.fromkeys(estimates, _NO_ESTIMATE)
    if isinstance(name := bare.get("name"), str) and not name.endswith(NOT_SEALED):
        bare["name"] = name + NOT_SEALED
    return bare


def plain(text: object) -> Any:
    """What a text of JSON holds.

    It raises ValueError for no JSON, and for numbers that are none.
    """
    if not isinstance(text, str):
        raise ValueError("it is no text")
    if len(text) > _LONGEST:
        raise ValueError(f"it is longer than {_LONGEST / 2**20:g} MiB")
    try:
        return _DECODER.decode(text)
    except (ValueError, RecursionError):
        raise ValueError("it is no JSON that can be read") from None


def _finite(text: str) -> float:
    """A number that JSON can say again."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number


_DECODER = json.JSONDecoder(parse_constant=_finite, parse_float=_finite)
