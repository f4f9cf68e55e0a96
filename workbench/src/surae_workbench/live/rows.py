"""What a trial's JSON holds: it may be damaged, or a stranger's."""

import json
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from surae.errors import InputError
from surae.files import read_bytes
from surae_workbench.web.rows import plain

#: A trial's findings and reasons take far less [bytes].
_LARGEST = 4 * 2**20


class _Trial(BaseModel):
    """Nothing is taken for what it is not; what a newer surae adds is left as it is."""

    model_config = ConfigDict(strict=True, extra="allow", allow_inf_nan=False)

    trial: int
    state: str
    marks: list[dict[str, Any]]
    effort: Literal["maximal", "passive"] | None = None
    protocol: str | None = None
    file: str | None = Field(None, min_length=1)
    note: str | None = None
    verdict: Literal["keep", "look", "repeat"] | None = None
    why: str | None = None
    advice: str | None = None
    grade: str | None = None
    vaf: float | None = None
    findings: list[dict[str, Any]] = []
    reasons: list[str] = []


def trial_of(path: Path, number: int) -> dict[str, Any] | None:
    """A trial of before, by its number; None where there is no file, or it is damaged."""
    try:
        text = read_bytes(path, _LARGEST).decode()
        trial = plain(text)
        json.dumps(trial, ensure_ascii=False).encode()  # half a character is no text
        known = _Trial.model_validate(trial)
    except (InputError, ValueError):
        return None
    graded = known.grade is None or known.vaf is not None
    return dict(trial) if known.trial == number and graded else None
