"""Subjects and recordings: what they are, how they look, what is wrong with them."""

import re
from collections import Counter
from collections.abc import Sequence
from functools import partial
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response

from surae import api
from surae.base.units import FloatArray
from surae_workbench.web.answers import Recording, Subject, Trial
from surae_workbench.web.curves import window
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.language import language_of
from surae_workbench.web.project import dated
from surae_workbench.web.remap import present_mapping, proposals
from surae_workbench.web.routes.common import (
    ERRORS,
    REPORT,
    TYPES,
    Bench,
    PathId,
    attachment,
    made_file,
    offer_deletion,
)
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import Points, RecordingPatch, SubjectRequest
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["recordings"])

#: Ids of recordings, with commas between them; and what tells of them.
Several = Annotated[str, Query(pattern=r"^[0-9a-f]{16}(,[0-9a-f]{16}){0,19}$")]
By = Literal["perturbations", "stretches"]
Instant = Annotated[float | None, Query(allow_inf_nan=False, ge=-1e9, le=1e9)]


@router.get("/damaged")
def get_damaged(bench: Bench) -> dict[str, Any]:
    """What of the project's database cannot be used, and why; all else is as it was."""
    return {"damaged": bench.database.damaged()}


@router.get("/subjects")
def get_subjects(bench: Bench) -> dict[str, list[Subject]]:
    """List all subjects."""
    return {"subjects": [_subject(bench, row) for row in bench.database.all("subject")]}


@router.post("/subjects", status_code=201)
def post_subject(body: SubjectRequest, bench: Bench) -> Subject:
    """Add a subject, under a code that no other has."""
    with bench.database.transaction():
        _refuse_twice(bench, "subject", "code", body.code, None)
        id_ = bench.database.add("subject", body.model_dump())
    bench.events.changed("subjects")
    return _subject(bench, bench.project.need("subject", id_))


@router.patch("/subjects/{id}")
def patch_subject(id: PathId, body: SubjectRequest, bench: Bench) -> Subject:
    """Change one."""
    with bench.database.transaction():
        _refuse_twice(bench, "subject", "code", body.code, id)
        subject = bench.project.change("subject", id, **body.model_dump())
    bench.events.changed("subjects")
    return _subject(bench, subject)


offer_deletion(router, "/subjects/{id}", "subject")


def _refuse_twice(
    bench: Workbench, kind: str, key: str, value: str | None, except_id: str | None
) -> None:
    """Refuse a name, or a code, that another entry has."""
    if any(row[key] == value and row["id"] != except_id for row in bench.database.all(kind)):
        raise RefusedError(409, f"there is a {kind} {value!r} already; give another {key}")


def _subject(bench: Workbench, subject: Entry) -> Subject:
    recordings = {r["id"] for r in bench.database.all("recording") if r["subject"] == subject["id"]}
    fits = sum(fit["recordings"][0] in recordings for fit in bench.database.all("fit"))
    return Subject(**dated(subject, recordings=len(recordings), fits=fits))


@router.get("/recordings")
def get_recordings(bench: Bench) -> dict[str, list[Trial]]:
    """List recordings: the leg and visit that came last first, its trials in their order."""
    fits = Counter(id_ for fit in bench.database.all("fit") for id_ in set(fit["recordings"]))
    rows = in_order(bench.database.all("recording"))
    return {"recordings": [Trial(**dated(row, fits=fits[row["id"]])) for row in rows]}


def in_order(rows: Sequence[Entry]) -> list[Entry]:
    """Recordings, the newest visit first; its trials as their names count, not as they came in."""
    visits: dict[tuple[Any, ...], list[Entry]] = {}
    for row in reversed(rows):
        visits.setdefault((row["subject"], row["side"], row.get("visit")), []).append(row)
    return [row for each in visits.values() for row in sorted(each, key=_counted)]


def _counted(row: Entry) -> tuple[tuple[bool, int, str], ...]:
    """What a name is sorted by: `trial 2` comes before `trial 10`."""
    parts = re.split(r"([0-9]+)", str(row["name"]).casefold())
    return tuple((p.isdigit(), int(p) if p.isdigit() else 0, p) for p in parts)


@router.get("/recordings/{id}")
def get_recording(id: PathId, bench: Bench) -> Recording:
    """Describe one recording."""
    return shown_recording(bench, bench.project.need("recording", id))


@router.patch("/recordings/{id}")
def patch_recording(id: PathId, body: RecordingPatch, bench: Bench) -> Recording:
    """Change its labels; what was measured stays."""
    changes = body.model_dump(exclude_unset=True)
    if changes.get("subject") is not None:
        bench.project.need("subject", changes["subject"])
    for key in ("trial", "condition"):
        if key in changes:
            changes[key] = changes[key] or ""
    if changes.get("name", "") is None:
        del changes["name"]
    with bench.database.transaction():
        _refuse_twice(bench, "recording", "name", changes.get("name"), id)
        recording = bench.project.change("recording", id, **changes)
    bench.events.changed("recordings")
    return shown_recording(bench, recording)


offer_deletion(router, "/recordings/{id}", "recording")


def shown_recording(bench: Workbench, recording: Entry) -> Recording:
    """A recording as the API shows it."""
    fits = sum(recording["id"] in fit["recordings"] for fit in bench.database.all("fit"))
    return Recording(**{"version": 0, **dated(recording, fits=fits)})


@router.get("/recordings/{id}/quality")
def get_quality(id: PathId, bench: Bench) -> dict[str, Any]:
    """What is questionable about it, where in time, and what to do."""
    recording = bench.project.need("recording", id)
    if recording.get("findings") is None:
        path = str(bench.project.recording_path(recording))
        findings = bench.workers.ask("imports:quality", path=path)
        recording = bench.project.change("recording", id, findings=findings)
    channels = present_mapping(recording)["channels"]
    findings = proposals(recording["findings"], channels)
    if any(id in leg["recordings"] for leg in bench.database.all("session")):
        for (
            finding
        ) in findings:  # the torque has one zero for all trials, which the leg's page says
            if finding["code"] == "torque-offset":
                finding["mend"] = None
    return {"findings": findings}


@router.get("/recordings/{id}/window")
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
    shown = []
    for name in dict.fromkeys(names):
        time, values, unit = channels[name]
        t, v = window(time, values, start, end, points)
        shown.append({"role": name, "unit": unit, "t": t.tolist(), "v": v.tolist()})
    return {"signals": shown}


@router.get("/nerve")
def get_nerve(recordings: Several, by: By, bench: Bench, request: Request) -> dict[str, str]:
    """How much is nerve in recordings of one leg, as the report shows it."""
    chosen = _of_one(bench, recordings)
    language = language_of(request)
    return {"html": bench.workers.ask("tasks:nerve", recordings=chosen, by=by, language=language)}


@router.get("/nerve/report.{kind}", response_class=Response, responses=REPORT)
def get_nerve_report(
    kind: Literal["html", "pdf"], recordings: Several, by: By, bench: Bench, request: Request
) -> Response:
    """The same as one file to keep."""
    chosen = _of_one(bench, recordings)
    language = language_of(request)
    write = partial(bench.workers.ask, "tasks:nerve", recordings=chosen, by=by, language=language)
    data = made_file(f"nerve.{kind}", lambda path: write(output=str(path)))
    return Response(
        data, media_type=TYPES[kind], headers=attachment(f"{by}-{next(iter(chosen))}", f".{kind}")
    )


def _of_one(bench: Workbench, ids: str) -> dict[str, str]:
    """Files of recordings of one leg, by name."""
    rows = [bench.project.need("recording", id_) for id_ in dict.fromkeys(ids.split(","))]
    if len({(row["subject"], row["side"]) for row in rows}) > 1:
        raise RefusedError(400, "these recordings are of several legs; take those of one")
    return {row["name"]: str(bench.project.recording_path(row)) for row in rows}


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
    return {role: (inputs.time, values, unit) for role, (values, unit) in signals.items()}
