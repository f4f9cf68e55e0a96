"""Fits: asked for, understood, tried on other recordings, reported."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse

from surae import api
from surae_workbench.web.answers import Fit, Job
from surae_workbench.web.draft import shown, upgraded
from surae_workbench.web.fits import check_draft, fit_summary, model_title, versions_of
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.routes.common import (
    ERRORS,
    REPORT,
    Bench,
    Browser,
    PathId,
    attachment,
    offer_deletion,
    report_file,
)
from surae_workbench.web.schemas import FitRequest, NameRequest, ProfileRequest, ValidateRequest

router = APIRouter(prefix="/api", responses=ERRORS, tags=["fits"])


@router.post("/fits", status_code=202)
def post_fit(body: FitRequest, bench: Bench, browser: Browser) -> Job:
    """Ask for a fit; wrong settings are refused now, not in the job, which is the answer."""
    draft = bench.sessions.draft(browser)
    recordings = bench.draft_recordings(draft)
    check_draft(bench, draft)
    ids = [recording["id"] for recording in recordings]
    versions = versions_of(bench, draft)
    task = {"name": body.name, "draft": draft, "recordings": ids, "versions": versions}
    names = ", ".join(recording["name"] for recording in recordings)
    label = body.name or f"{model_title(draft['model'])} · {names}"
    return bench.jobs.submit("fit", label, browser, task, ids[0])


@router.get("/fits")
def get_fits(
    bench: Bench, recording: Annotated[str | None, Query(max_length=16)] = None
) -> dict[str, list[Fit]]:
    """Fits, the newest first."""
    rows = reversed(bench.database.all("fit"))
    wanted = (row for row in rows if recording is None or recording in row["recordings"])
    return {"fits": [fit_summary(bench, row) for row in wanted]}


@router.get("/fits/{id}")
def get_fit(id: PathId, bench: Bench) -> dict[str, Any]:
    """What its page needs beside the report."""
    fit = bench.project.need("fit", id)
    units = {name: p.unit for name, p in api.PARAMETERS.items()}
    return {
        "summary": fit_summary(bench, fit),
        "parameters": {
            name: {
                "value": p["value"],
                "free": p["verdict"] != "fixed",
                "unit": units.get(name, ""),
            }
            for name, p in fit["parameters"].items()
        },
        "settings": shown(upgraded(fit["settings"])),
        "profiles": fit.get("profiles", {}),
    }


@router.patch("/fits/{id}")
def rename_fit(id: PathId, body: NameRequest, bench: Bench) -> Fit:
    """Give it another name."""
    row = bench.project.change("fit", id, name=body.name)
    bench.events.changed("fits")
    return fit_summary(bench, row)


offer_deletion(router, "/fits/{id}", "fit")


@router.get("/fits/{id}/fit.json", response_class=FileResponse)
def get_fit_json(id: PathId, bench: Bench) -> FileResponse:
    """FIT.json, as `surae fit --output` writes it."""
    row = bench.project.need("fit", id)
    path = bench.project.kept("fit", id)
    if not path.is_file():
        raise RefusedError(404, "the file of this fit is missing; fit again")
    headers = attachment(row["name"], ".json")
    return FileResponse(path, media_type="application/json", headers=headers)


@router.post("/fits/{id}/profile", status_code=202)
def post_profile(id: PathId, body: ProfileRequest, bench: Bench, browser: Browser) -> Job:
    """Ask for profiles of its parameters; the answer is their job."""
    fit = bench.project.need("fit", id)
    free = [name for name, p in fit["parameters"].items() if p["verdict"] != "fixed"]
    for name in body.parameters or ():
        if name not in free:
            raise RefusedError(400, f"{name} is not free in this fit; these are: {', '.join(free)}")
    task = {"fit": id, "parameters": body.parameters, "recordings": fit["recordings"]}
    return bench.jobs.submit("profile", f"profiles · {fit['name']}", browser, task, id)


@router.post("/fits/{id}/validate")
def post_validate(id: PathId, body: ValidateRequest, bench: Bench) -> dict[str, str]:
    """How its parameters predict other recordings, as the report shows it."""
    fit = str(bench.project.kept("fit", id))
    rows = [bench.project.need("recording", each) for each in dict.fromkeys(body.recordings)]
    others = {row["name"]: str(bench.project.recording_path(row)) for row in rows}
    return {"html": bench.workers.ask("tasks:predictions", fit=fit, recordings=others)}


@router.get("/fits/{id}/report.{kind}", response_class=Response, responses=REPORT)
def get_report(id: PathId, kind: Literal["html", "pdf"], bench: Bench) -> Response:
    """A fit's report: one file to keep."""
    fit = str(bench.project.kept("fit", id))
    return report_file(bench, bench.project.need("fit", id), kind, "tasks:report", fit=fit)
