"""A trial's record: the JSON beside its recording, written and read by one schema.

Whatever live says of a trial, it can read again: texts are cleaned and numbers that are none left
out before they come in. Efforts are three: the one asked for, the one that the signals alone show,
and the one that the trial counts as.
"""

import json
import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import AliasChoices, BaseModel, ConfigDict, Field, ValidationError, model_validator

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.files import read_bytes, shown, write_atomic
from surae_workbench.live.xdf import events_in
from surae_workbench.web.rows import plain

#: Layout of a record; raised when an older surae could not read it. Records without one are older.
FORMAT: Literal[1] = 1
#: Marks and alarms that a trial keeps at most, letters of a text, and bytes of a record.
MOST = 2000
_TEXT = 2000
_LARGEST = 64 * 2**20
#: Texts that name files, which must be found again to the letter.
_PATHS = ("file", "recording")

Effort = Literal["passive", "active", "maximal"]


class _Part(BaseModel):
    """Nothing is taken for what it is not; what a newer surae adds is left as it is."""

    model_config = ConfigDict(strict=True, extra="allow", allow_inf_nan=False, frozen=True)


class Mark(_Part):
    """What the operator wrote down."""

    at: float  #: From the trial's begin [s].
    text: str


class Alarm(_Part):
    """What went wrong within the trial, and what to do."""

    at: float | None  #: From where its target began, else from its own begin [s].
    code: str
    role: str | None  #: The channel, None where it is all of a stream.
    text: str
    message: str = ""  #: The same as it stands in the catalogue, and what fills it in.
    given: dict[str, str] = {}


class Judgement(_Part):
    """What is said of a trial after it."""

    findings: list[dict[str, Any]] = []
    seconds: float | None = None  #: Measured [s].
    use: str | None = None  #: As `surae.Session` would use it.
    effort_judged: Effort | Literal["unknown"] | None = None  #: What the signals alone show.
    effort: Effort | None = None  #: What the trial counts as.
    why: str | None = None
    grade: str | None = None
    vaf: float | None = None  #: [%].
    reasons: list[str] = []
    verdict: Literal["keep", "look", "repeat"] | None = None
    advice: str | None = None
    leg: list[str] = []  #: What it says of the leg, in sentences.
    #: Advice, by the languages other than English; older records call it ``told``.
    translated: dict[str, dict[str, Any]] = Field(
        {}, validation_alias=AliasChoices("translated", "told")
    )


class Record(Judgement):
    """All that is known of a trial."""

    format: Literal[1] = FORMAT
    trial: int
    state: Literal["recording", "being judged", "broken off", "judged"]
    began: str | None = None  #: On the wall's clock.
    protocol: str | None = None
    seconds_asked: float | None = None  #: How long the target is [s].
    effort_asked: Effort | None = None
    marks: list[Mark] = []
    alarms: list[Alarm] = []
    file: str | None = Field(None, min_length=1)  #: Of a trial that was recorded otherwise.
    recording: str | None = None
    split: str | None = None  #: Why only a part of it is in its file.
    note: str | None = None
    lost_bytes: int | None = None
    seconds_to_verdict: float | None = None
    begun_s: float | None = None  #: When its target began, from its first sample [s].
    mapping: str | None = None  #: Digest of the mapping that it was last read by; None: by none.

    @property
    def is_unread(self) -> bool:
        """Whether it was judged, and nothing could be read of it."""
        return self.state == "judged" and self.use is None

    @model_validator(mode="after")
    def _whole(self) -> Self:
        """A grade has its number, and what is judged its verdict."""
        if self.grade is not None and self.vaf is None:
            raise ValueError("a grade without its VAF")
        if (self.verdict is None) == (self.state == "judged"):
            raise ValueError("judged without a verdict, or a verdict before it was judged")
        return self

    @classmethod
    def of(cls, **fields: Any) -> Self:
        """A record of whatever is said: texts cleaned, what is no number left out."""
        known = {k: v if k in _PATHS else _plain(v) for k, v in fields.items()}
        if known.get("vaf") is None:
            known["grade"] = None
        return cls.model_validate(known)

    def but(self, **changes: Any) -> Self:
        """The record with some fields changed."""
        return self.of(**{**self.model_dump(), **changes})

    def shown(self) -> dict[str, Any]:
        """For pages: every text is one that can be shown."""
        shown_: dict[str, Any] = _plain(self.model_dump())
        return shown_

    def write(self, path: Path) -> None:
        """Write it, all or nothing."""
        data = self.model_dump(exclude_defaults=True) | {
            "format": FORMAT,
            "marks": [mark.model_dump() for mark in self.marks],
        }
        try:
            text = json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False)
            write_atomic(path, text.encode())
        except UnicodeEncodeError:  # a file whose name is no UTF-8
            write_atomic(path, json.dumps(data, indent=1, allow_nan=False))

    @property
    def confirmed_effort(self) -> str | None:
        """The effort that a session is told: the one asked for, unless the signals deny it."""
        return self.effort_asked if self.effort_asked == self.effort else None


def counted(instructed: str | None, judged: str | None) -> str | None:
    """What a trial counts as: what was asked for, unless the signals show something else.

    Signals alone cannot tell a maximal effort, nor a relaxed leg before any muscle has worked.
    """
    if instructed == "maximal" or judged is None:
        return instructed
    if judged == "unknown":
        return "passive" if instructed == "passive" else None
    return judged


def read_record(path: Path, number: int) -> Record | None:
    """The record of a trial; None where there is none.

    It raises ValueError where it is damaged, and InputError where a newer surae wrote it.
    """
    if not path.exists():
        return None
    try:
        data = plain(read_bytes(path, _LARGEST).decode())
    except InputError as error:
        raise ValueError(str(error)) from None
    if not isinstance(data, dict):
        raise ValueError("it holds no table")
    layout = data.get("format")
    if isinstance(layout, int) and layout > FORMAT:
        raise InputError(
            f"{shown(path)}: a newer surae wrote it (format {layout}, this one reads {FORMAT}); "
            "upgrade surae, or give another --output"
        )
    record = Record.model_validate(_upgraded(data) if layout is None else data)
    if record.trial != number:
        raise ValueError("it is of another trial")
    kept = {k: v for k, v in data.items() if k not in _PATHS}
    json.dumps(kept, ensure_ascii=False).encode()  # half a character is no text
    return record


def repaired(path: Path, number: int, source: Path) -> Record:
    """A record of what is left: what of the JSON is sound, and what the recording itself says.

    The trial is to be judged anew, so what was said of it is not taken.
    """
    base = {"trial": number, "state": "broken off"}
    fields: dict[str, Any] = {}
    with suppress(ValueError, InputError):
        data = plain(read_bytes(path, _LARGEST).decode())
        for name, value in data.items() if isinstance(data, dict) else ():
            if name in Record.model_fields and name not in {*base, *Judgement.model_fields}:
                with suppress(ValidationError, UnicodeEncodeError):
                    Record.model_validate({**base, name: value})
                    fields[name] = value
    said = said_in(source)
    return Record.of(**{**said, **{k: v for k, v in fields.items() if v}, **base})


def said_in(source: Path) -> dict[str, Any]:
    """What was asked for and marked, as a trial's XDF has it among its events; {} without."""
    said: dict[str, Any] = {"marks": [], "alarms": []}
    begun = None
    with suppress(OSError):
        for stamp, event in events_in(source):
            kind = event.get("event")
            if kind == "start" and begun is None:
                begun = stamp
                asked = {"seconds_asked": event.get("seconds"), "effort_asked": event.get("effort")}
                said |= {k: event.get(k) for k in ("protocol", "began")} | asked
            elif kind == "mark" and begun is not None and len(said["marks"]) < MOST:
                said["marks"].append({"at": round(stamp - begun, 3), "text": event.get("text")})
            elif kind == "alarm" and begun is not None and len(said["alarms"]) < MOST:
                said["alarms"].append({k: event[k] for k in Alarm.model_fields if k in event})
    return said if begun is not None else {}


def _upgraded(data: Mapping[str, Any]) -> dict[str, Any]:
    """A record of before there was a format: the effort judged lay over the one asked for."""
    data = dict(data)
    effort = data.pop("effort", None)
    seconds = data.pop("seconds", None)
    if effort not in (None, "passive", "active", "maximal", "unknown"):
        raise ValueError("no effort")
    asked = None if effort == "unknown" else effort
    if "use" in data:
        judged = effort
        protocol = str(data.get("protocol", ""))
        asked = "maximal" if protocol == "maximum" else None
        asked = "passive" if protocol.endswith(" passive") else asked
        data |= {"effort_judged": judged, "effort": counted(asked, judged), "seconds": seconds}
    else:
        data["seconds_asked"] = seconds
    data["effort_asked"] = asked
    return data


def _plain(value: Any) -> Any:
    """Plain data that JSON can say: texts cleaned, None for a number that is none."""
    if isinstance(value, BaseModel):  # a mark or an alarm that is there already
        value = value.model_dump()
    if isinstance(value, str):
        return cleaned(value, _TEXT)
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {cleaned(str(key)): _plain(each) for key, each in value.items()}
    if isinstance(value, Iterable):
        return [_plain(each) for each in value]
    return value if value is None or isinstance(value, int) else cleaned(str(value))
