"""Sessions: the trials of one leg, sorted, fitted each and together, predicted by each other."""

from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse

from surae.web.fits import check_draft
from surae.web.http_errors import RefusedError
from surae.web.legs import session_detail, session_summary, sorted_as, submit_session
from surae.web.routes.common import ERRORS, Bench, Browser, PathId, attachment, chosen_draft
from surae.web.schemas import NameGiven, SessionGiven, TrialsGiven

router = APIRouter(prefix="/api/sessions", responses=ERRORS, tags=["sessions"])

_TYPES = {".html": "text/html", ".pdf": "application/pdf"}


@router.post("/trials")
def post_trials(given: TrialsGiven, bench: Bench) -> dict[str, Any]:
    """What each trial is and is used for, as its signals and the others tell."""
    return {"trials": sorted_as(bench, given.recordings, given.efforts)}


@router.post("", status_code=202)
def post_session(given: SessionGiven, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Ask for the fits of a session; the answer is their job."""
    draft = chosen_draft(bench, browser, given.draft)
    moving = [
        each["recording"]
        for each in sorted_as(bench, given.recordings, given.efforts)
        if each["fitted"]
    ]
    if not moving:
        raise RefusedError(400, "none of these trials moves: nothing can be fitted")
    check_draft(bench, {**draft, "recordings": moving[:1], "mvc": [], "normalise": None})
    job = submit_session(bench, browser, draft, given.recordings, given.efforts, given.name)
    return bench.jobs.shown(job, browser)


@router.get("")
def get_sessions(bench: Bench) -> dict[str, Any]:
    """Sessions, the newest first."""
    every = reversed(bench.database.all("session"))
    return {"sessions": [session_summary(bench, each) for each in every]}


@router.get("/{id}")
def get_session(id: PathId, bench: Bench) -> dict[str, Any]:
    """What the report of one says, and its fits."""
    return session_detail(bench, bench.project.need("session", id))


@router.patch("/{id}")
def patch_session(id: PathId, given: NameGiven, bench: Bench) -> dict[str, Any]:
    """Give it another name."""
    changed = bench.project.change("session", id, name=given.name)
    bench.changed("sessions")
    return session_summary(bench, changed)


@router.delete("/{id}", status_code=204)
def delete_session(id: PathId, bench: Bench, browser: Browser) -> Response:
    """Delete it, and none of its fits; undo brings it back."""
    row = bench.project.need("session", id)
    bench.delete(browser, "session", id, f"delete {row['name']}"[:120])
    return Response(status_code=204)


@router.get("/{id}/report.html", response_class=FileResponse)
def get_page(id: PathId, bench: Bench) -> FileResponse:
    """Its report: one file to keep."""
    return _report(bench, id, ".html")


@router.get("/{id}/report.pdf", response_class=FileResponse)
def get_paper(id: PathId, bench: Bench) -> FileResponse:
    """Its report for paper."""
    return _report(bench, id, ".pdf")


def _report(bench: Bench, id_: str, suffix: str) -> FileResponse:
    row = bench.project.need("session", id_)
    path = bench.project.path("sessions", id_, suffix)
    if not path.is_file():
        raise RefusedError(404, "this file of the session is missing; fit the session again")
    headers = attachment(row["name"], suffix)
    return FileResponse(path, media_type=_TYPES[suffix], headers=headers)
