"""Subjects and recordings: what they are, how they look, what is wrong with them."""

from collections import Counter
from operator import itemgetter
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response

from surae import api
from surae.units import FloatArray
from surae_workbench.web import answers
from surae_workbench.web.curves import window
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import dated
from surae_workbench.web.remap import present_mapping, proposals
from surae_workbench.web.routes.common import (
    ERRORS,
    Bench,
    Browser,
    Paged,
    PathId,
    Seen,
    offer_deletion,
    refuse_unseen,
    revision,
)
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import Points, RecordingPatch, SubjectPatch, SubjectRequest
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["recordings"])

Instant = Annotated[float | None, Query(allow_inf_nan=False, ge=-1e9, le=1e9)]


@router.get("/damaged")
def get_damaged(bench: Bench) -> dict[str, Any]:
    """What of the project's database cannot be used, and why; all else is as it was."""
    return {"damaged": bench.database.damaged()}


@router.get("/subjects", response_model=answers.Subjects)
def get_subjects(bench: Bench) -> dict[str, Any]:
    """List all subjects."""
    owners = {row["id"]: row["subject"] for row in bench.database.all("recording")}
    recordings = Counter(owners.values())
    fits = Counter(owners.get(fit["recordings"][0]) for fit in bench.database.all("fit"))
    subjects = bench.database.all("subject")
    return {"subjects": [_subject(row, recordings[row["id"]], fits[row["id"]]) for row in subjects]}


@router.post("/subjects", status_code=201, response_model=answers.Subject)
def post_subject(body: SubjectRequest, bench: Bench) -> dict[str, Any]:
    """Add a subject, under a code that no other has."""
    with bench.database.transaction():
        _refuse_code(bench, body.code, None)
        id_ = bench.database.add("subject", body.model_dump())
    bench.events.changed("subjects")
    return _subject(bench.project.need("subject", id_), 0, 0)


@router.patch("/subjects/{id}", response_model=answers.Subject)
def patch_subject(
    id: PathId, body: SubjectPatch, bench: Bench, seen: Seen = None
) -> dict[str, Any]:
    """Change one, unless another browser has since its `revision` was seen."""
    changes = body.model_dump(exclude_unset=True)
    changes = {k: v for k, v in changes.items() if v is not None or k == "body_mass"}
    with bench.database.transaction():
        refuse_unseen(bench.project.need("subject", id), seen)
        if "code" in changes:
            _refuse_code(bench, changes["code"], id)
        subject = bench.project.change("subject", id, **changes)
    bench.events.changed("subjects")
    count = sum(recording["subject"] == id for recording in bench.database.all("recording"))
    return _subject(subject, count, 0)


@router.delete("/subjects/{id}", status_code=204)
def delete_subject(id: PathId, bench: Bench, browser: Browser) -> Response:
    """Delete one without recordings; undo brings it back."""
    subject = bench.project.need("subject", id)
    if any(r["subject"] == id for r in bench.database.all("recording")):
        raise RefusedError(
            409, f"subject {subject['code']} has recordings; move or delete them first"
        )
    bench.delete(browser, "subject", id, f"delete subject {subject['code']}")
    return Response(status_code=204)


def _refuse_name(bench: Workbench, name: str | None, own: str) -> None:
    if any(
        recording["name"] == name and recording["id"] != own
        for recording in bench.database.all("recording")
    ):
        raise RefusedError(409, f"there is a recording {name!r} already; give another name")


def _refuse_code(bench: Workbench, code: str, own: str | None) -> None:
    if any(
        subject["code"] == code and subject["id"] != own
        for subject in bench.database.all("subject")
    ):
        raise RefusedError(409, f"there is a subject {code!r} already; give another code")


def _subject(subject: Entry, recordings: int, fits: int) -> dict[str, Any]:
    return dated(subject, recordings=recordings, fits=fits, revision=revision(subject))


@router.get("/recordings", response_model=answers.Recordings)
def get_recordings(bench: Bench, page: Paged) -> dict[str, Any]:
    """List recordings, the oldest first unless sorted otherwise, and how many there are."""
    fits = Counter(id_ for fit in bench.database.all("fit") for id_ in set(fit["recordings"]))
    codes = {subject["id"]: subject["code"] for subject in bench.database.all("subject")}
    keys = ("name", "side", "trial", "condition", "duration_s", "created")
    values = {key: itemgetter(key) for key in keys} | {
        "subject": lambda row: codes.get(row["subject"]),
        "fits": lambda row: fits[row["id"]],
    }
    rows = bench.database.all("recording")
    return page.of("recordings", rows, values, lambda row: _recording(row, fits[row["id"]]))


@router.get("/recordings/{id}", response_model=answers.Recording)
def get_recording(id: PathId, bench: Bench) -> dict[str, Any]:
    """Describe one recording."""
    return shown_recording(bench, bench.project.need("recording", id))


@router.patch("/recordings/{id}", response_model=answers.Recording)
def patch_recording(
    id: PathId, body: RecordingPatch, bench: Bench, seen: Seen = None
) -> dict[str, Any]:
    """Change its labels, unless another browser has meanwhile; what was measured stays."""
    changes = body.model_dump(exclude_unset=True)
    if changes.get("subject") is not None:
        bench.project.need("subject", changes["subject"])
    for key in ("trial", "condition"):
        if key in changes:
            changes[key] = changes[key] or ""
    if changes.get("name", "") is None:
        del changes["name"]
    with bench.database.transaction():
        refuse_unseen(bench.project.need("recording", id), seen)
        _refuse_name(bench, changes.get("name"), id)
        recording = bench.project.change("recording", id, **changes)
    bench.events.changed("recordings")
    return shown_recording(bench, recording)


offer_deletion(router, "/recordings/{id}", "recording")


def shown_recording(bench: Workbench, recording: Entry) -> dict[str, Any]:
    """A recording as the API shows it."""
    return _recording(
        recording, sum(recording["id"] in fit["recordings"] for fit in bench.database.all("fit"))
    )


def _recording(recording: Entry, fits: int) -> dict[str, Any]:
    version = recording.get("version", 0)
    return dated(recording, fits=fits, version=version, revision=revision(recording))


@router.get("/recordings/{id}/quality", response_model=answers.Findings)
def get_quality(id: PathId, bench: Bench) -> dict[str, Any]:
    """What is questionable about it, where in time, and what to do."""
    recording = bench.project.need("recording", id)
    if recording.get("findings") is None:
        path = str(bench.project.recording_path(recording))
        findings = bench.workers.ask("imports:quality", path=path)
        recording = bench.project.change("recording", id, findings=findings)
    channels = present_mapping(recording)["channels"]
    return {"findings": proposals(recording["findings"], channels)}


@router.get("/recordings/{id}/window", response_model=answers.Window)
def get_window(
    id: PathId,
    bench: Bench,
    signals: Annotated[str | None, Query(max_length=300)] = None,
    start: Instant = None,
    end: Instant = None,
    points: Annotated[Points, Query()] = 2000,
    view: Literal["raw", "prepared"] = "raw",
) -> dict[str, Any]:
    """A part of its signals, by few enough points that a plot is smooth."""
    if start is not None and end is not None and start > end:
        raise RefusedError(400, f"start {start:g} s lies after end {end:g} s; exchange them")
    channels = _raw(bench, id) if view == "raw" else _prepared(bench, id)
    names = list(channels) if signals is None else [n for n in signals.split(",") if n]
    for name in names:
        if name not in channels:
            raise RefusedError(400, f"no signal {name[:40]!r}; there are: {', '.join(channels)}")
    times = [time for time, *_ in channels.values()]
    span = {
        "start": min(float(t[0]) for t in times) if start is None else start,
        "end": max(float(t[-1]) for t in times) if end is None else end,
    }
    shown = []
    for name in dict.fromkeys(names):
        time, values, unit = channels[name]
        n, t, v = window(time, values, start, end, points)
        shown.append(
            {"role": name, "unit": unit, "n": n, "reduced": len(t) < n, "t": t.tolist(),
             "v": v.tolist()}
        )  # fmt: skip
    return {**span, "signals": shown}


#: Times [s], values and unit of signals by name.
_Signals = dict[str, tuple[FloatArray, FloatArray, str]]


def _raw(bench: Workbench, id_: str) -> _Signals:
    channels = bench.recording(id_).channels
    return {role: (kept.time, kept.values, kept.unit) for role, kept in channels.items()}


def _prepared(bench: Workbench, id_: str) -> _Signals:
    inputs = bench.prepared(id_, api.FitSettings())
    signals = {"angle": (inputs.angle, "rad")}
    if inputs.torque is not None:
        signals["torque"] = (inputs.torque, "Nm")
    for column, role in enumerate(role for role in api.ROLES if role.startswith("emg_")):
        if role.removeprefix("emg_") not in inputs.missing_emg:
            signals[role] = (inputs.emg[:, column], inputs.emg_unit)
    signals |= {
        "velocity": (inputs.velocity, "rad/s"),
        "acceleration": (inputs.acceleration, "rad/s2"),
    }
    return {role: (inputs.time, values, unit) for role, (values, unit) in signals.items()}
