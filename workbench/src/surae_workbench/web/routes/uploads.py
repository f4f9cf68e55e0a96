"""Files come in: uploaded to the session, looked into, mapped, imported as recordings."""

import hashlib
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from surae import api
from surae.base.units import FACTORS, kind
from surae_workbench.web.answers import Recording, Upload
from surae_workbench.web.database import new_id
from surae_workbench.web.http_errors import RefusedError, not_found
from surae_workbench.web.imports import file_name
from surae_workbench.web.project import dated, unique_name
from surae_workbench.web.remap import proposals
from surae_workbench.web.routes.common import ERRORS, Bench, Browser, PathId
from surae_workbench.web.routes.recordings import shown_recording
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import Id, ImportRequest
from surae_workbench.web.sessions import BrowserSession
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["import"])

#: Files that a session may have uploaded at a time.
MOST_UPLOADS = 64
#: The code of the subject that is not real, and all else about it.
_VIRTUAL = "virtual"
_VIRTUAL_SUBJECT = {
    "code": _VIRTUAL,
    "group": "healthy",
    "notes": "simulated, not measured",
    "body_mass": None,
}


@router.post(
    "/uploads",
    status_code=201,
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/octet-stream": {"schema": {"type": "string", "format": "binary"}}
            },
        }
    },
)
async def post_upload(
    request: Request,
    bench: Bench,
    browser: Browser,
    name: Annotated[str, Query(min_length=1, max_length=300)],
) -> Upload:
    """Take one file, streamed to disk as it comes."""
    await run_in_threadpool(_refuse_more, bench, browser)
    id_ = new_id()
    count = 0
    digest = hashlib.sha256()
    folder = await run_in_threadpool(bench.project.uploads, browser.key)
    path = folder / id_
    try:
        with path.open("xb") as file:
            async for chunk in request.stream():
                count += len(chunk)
                digest.update(chunk)
                await run_in_threadpool(file.write, chunk)
        if not count:
            raise RefusedError(400, "the file is empty; choose another")
        data = {"name": file_name(name), "bytes": count, "sha256": digest.hexdigest()}
        await run_in_threadpool(_keep, bench, browser, {**data, "session": browser.key}, id_)
    except BaseException:
        path.unlink(missing_ok=True)
        raise
    return Upload(**dated(bench.project.need("upload", id_)))


def _refuse_more(bench: Workbench, browser: BrowserSession) -> None:
    if len(_uploads(bench, browser)) >= MOST_UPLOADS:
        raise RefusedError(409, f"{MOST_UPLOADS} files are uploaded already; delete some first")


def _keep(bench: Workbench, browser: BrowserSession, data: Entry, id_: str) -> None:
    """Note a file, unless others came in at the same time and there are now too many."""
    with bench.database.transaction():
        _refuse_more(bench, browser)
        bench.database.add("upload", data, id_)


@router.get("/uploads")
def get_uploads(bench: Bench, browser: Browser) -> dict[str, list[Upload]]:
    """List the files of the browser's session."""
    return {"uploads": [Upload(**dated(upload)) for upload in _uploads(bench, browser)]}


@router.delete("/uploads/{id}", status_code=204)
def delete_upload(id: PathId, bench: Bench, browser: Browser) -> Response:
    """Put one into the trash."""
    _upload(bench, browser, id)
    bench.project.discard("upload", id)
    return Response(status_code=204)


@router.get("/uploads/{id}/inspect")
def inspect_upload(
    id: PathId,
    bench: Bench,
    browser: Browser,
    also: Annotated[list[Id], Query(max_length=MOST_UPLOADS)] = [],  # noqa: B006
) -> dict[str, Any]:
    """What is in a file, and in others that belong to it, and a guess of what each column is."""
    upload, *others = (_upload(bench, browser, each) for each in (id, *also))
    files = _files(bench, browser, [upload, *others])
    result = bench.workers.ask("imports:inspected", files=files)
    if not result["columns"]:  # a mapping: what it names may be among all uploads
        rest = [u for u in _uploads(bench, browser) if u["id"] != upload["id"]]
        files = _files(bench, browser, [upload, *rest])
        result = bench.workers.ask("imports:inspected", files=files)
    return {"id": upload["id"], "name": upload["name"], **result}


@router.get("/units")
def get_units() -> dict[str, Any]:
    """The roles that a channel can have, and the units of each."""
    return {
        "roles": list(api.ROLES),
        "units": {role: list(FACTORS[kind(role)]) for role in api.ROLES},
    }


@router.post("/imports/preview")
def preview_import(body: ImportRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """What a mapping makes of the files."""
    result = _imported(body, bench, browser, None)
    mapping = body.mapping.model_dump(mode="json")
    findings = proposals(result["findings"], mapping["channels"])
    return {**result, "findings": findings, "twin": _twin(bench, result["files"], mapping)}


@router.post("/imports", status_code=201)
def post_import(body: ImportRequest, bench: Bench, browser: Browser) -> Recording:
    """Keep what a mapping makes of the files as a recording."""
    if body.subject is not None:
        bench.project.need("subject", body.subject)
    id_ = new_id()
    result = _imported(body, bench, browser, str(bench.project.file("recording", id_)))
    return _added(
        bench,
        id_,
        result,
        body.subject,
        body.trial or "",
        body.condition or "",
        body.mapping.model_dump(mode="json"),
        body.visit,
    )


@router.post("/demo", status_code=201)
def post_demo(bench: Bench) -> Recording:
    """Make a recording of the virtual subject, of whom there is one more trial each time."""
    id_ = new_id()
    known = _virtual(bench)
    trial = 1 + sum(
        known is not None and recording["subject"] == known
        for recording in bench.database.all("recording")
    )
    path = str(bench.project.file("recording", id_))
    result = bench.workers.ask("tasks:demo", trial=trial, output=path)
    with bench.database.transaction():
        subject = _virtual(bench) or bench.database.add("subject", _VIRTUAL_SUBJECT)
    bench.events.changed("subjects")
    return _added(bench, id_, result, subject, f"T{trial}", "", None)


def _twin(
    bench: Workbench, files: list[Mapping[str, str]], mapping: Mapping[str, Any]
) -> dict[str, str] | None:
    """The recording that was made of the same columns of the same files before."""
    sums = {file["sha256"] for file in files}
    columns = {channel["column"] for channel in mapping["channels"].values()}
    for recording in bench.database.all("recording"):
        known = (recording.get("first") or recording["mapping"] or {"channels": {}})["channels"]
        if {file["sha256"] for file in recording["files"]} == sums and {
            channel["column"] for channel in known.values()
        } & columns:
            return {"id": recording["id"], "name": recording["name"]}
    return None


def _virtual(bench: Workbench) -> str | None:
    """The subject that is not real, where it has been made."""
    ids = [
        subject["id"] for subject in bench.database.all("subject") if subject["code"] == _VIRTUAL
    ]
    return ids[0] if ids else None


def _added(
    bench: Workbench,
    id_: str,
    result: Mapping[str, Any],
    subject: str | None,
    trial: str,
    condition: str,
    mapping: Mapping[str, Any] | None,
    visit: str | None = None,
) -> Recording:
    """Add a recording, whose file is there, to the project."""
    data = {
        **result,
        "name": unique_name(bench.database.all("recording"), result["name"], 120),
        "subject": subject,
        "trial": trial,
        "condition": condition,
        "visit": visit,
        "mapping": mapping,
    }
    bench.project.add("recording", data, id_)
    bench.events.changed("recordings")
    return shown_recording(bench, bench.project.need("recording", id_))


def _imported(
    body: ImportRequest, bench: Workbench, browser: BrowserSession, output: str | None
) -> dict[str, Any]:
    mapping = body.mapping.model_dump(mode="json")
    wanted = dict.fromkeys(upload["upload"] for upload in mapping["channels"].values())
    uploads = [_upload(bench, browser, id_) for id_ in wanted]
    files = _files(bench, browser, uploads)
    result: dict[str, Any] = bench.workers.ask(
        "imports:imported", files=files, mapping=mapping, output=output
    )
    return result


def _uploads(bench: Workbench, browser: BrowserSession) -> list[Entry]:
    return [upload for upload in bench.database.all("upload") if upload["session"] == browser.key]


def _upload(bench: Workbench, browser: BrowserSession, id_: str) -> Entry:
    upload = bench.database.get("upload", id_)
    if upload is None or upload["session"] != browser.key:
        raise not_found("upload")
    return upload


def _files(bench: Workbench, browser: BrowserSession, uploads: list[Entry]) -> list[dict[str, str]]:
    folder = bench.project.uploads(browser.key)
    return [
        {"id": upload["id"], "path": str(folder / upload["id"]), "name": upload["name"]}
        for upload in uploads
    ]
