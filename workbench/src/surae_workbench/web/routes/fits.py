"""Fits: asked for, understood, tried on other recordings, reported."""

from operator import itemgetter
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse

from surae import api
from surae_workbench.web import answers
from surae_workbench.web.fits import fit_detail, fit_summary, model_title, submit_fit
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.routes.common import (
    ERRORS,
    REPORT,
    Bench,
    Browser,
    Paged,
    PathId,
    attachment,
    chosen_draft,
    offer_deletion,
    offer_renaming,
    report_file,
)
from surae_workbench.web.schemas import FitRequest, ProfileRequest, ValidateRequest

router = APIRouter(prefix="/api", responses=ERRORS, tags=["fits"])


@router.post("/fits", status_code=202, response_model=answers.Job)
def post_fit(body: FitRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Ask for a fit; the answer is its job."""
    return submit_fit(bench, browser, chosen_draft(bench, browser, body.draft), body.name)


@router.get("/fits", response_model=answers.Fits)
def get_fits(
    bench: Bench,
    page: Paged,
    subject: Annotated[str | None, Query(max_length=16)] = None,
    recording: Annotated[str | None, Query(max_length=16)] = None,
) -> dict[str, Any]:
    """Fits, the newest first unless sorted otherwise, and how many there are."""
    owners = {row["id"]: row["subject"] for row in bench.database.all("recording")}
    codes = {row["id"]: row["code"] for row in bench.database.all("subject")}
    rows = [
        row
        for row in reversed(bench.database.all("fit"))
        if subject in (None, owners.get(row["recordings"][0]))
        and (recording is None or recording in row["recordings"])
    ]
    values: dict[str, Any] = {key: itemgetter(key) for key in ("name", "status", "created")} | {
        "r2": lambda row: row.get("r2"),
        "title": lambda row: model_title(row["model"]),
        "subject": lambda row: codes.get(owners.get(row["recordings"][0])),
    }
    return page.of("fits", rows, values, lambda row: fit_summary(bench, row))


@router.get("/fits/{id}", response_model=answers.FitPage)
def get_fit(id: PathId, bench: Bench) -> dict[str, Any]:
    """What its page needs beside the report."""
    return fit_detail(bench, bench.project.need("fit", id))


offer_renaming(router, "/fits/{id}", "fit", answers.Fit, fit_summary)
offer_deletion(router, "/fits/{id}", "fit")


@router.get("/fits/{id}/fit.json", response_class=FileResponse)
def get_fit_json(id: PathId, bench: Bench) -> FileResponse:
    """FIT.json, as `surae fit --output` writes it."""
    row = bench.project.need("fit", id)
    path = bench.project.path("fits", id, ".json")
    if not path.is_file():
        raise RefusedError(404, "the file of this fit is missing; fit again")
    headers = attachment(row["name"], ".json")
    return FileResponse(path, media_type="application/json", headers=headers)


@router.post("/fits/{id}/profile", status_code=202, response_model=answers.Job)
def post_profile(
    id: PathId, body: ProfileRequest, bench: Bench, browser: Browser
) -> dict[str, Any]:
    """Ask for profiles of its parameters; the answer is their job."""
    fit = bench.project.need("fit", id)
    result = bench.fit(id).result
    for name in body.parameters or result.problem.free:
        api.check_profiled(result, name)
    task = {"fit": id, "parameters": body.parameters, "recordings": fit["recordings"]}
    label = f"profiles · {fit['name']}"[:200]
    return bench.jobs.submit("profile", label, browser, task, id)


@router.post("/fits/{id}/validate", response_model=answers.Part)
def post_validate(id: PathId, body: ValidateRequest, bench: Bench) -> dict[str, str]:
    """How its parameters predict other recordings, as the report shows it."""
    bench.project.need("fit", id)
    rows = [bench.project.need("recording", each) for each in dict.fromkeys(body.recordings)]
    others = {row["name"]: str(bench.project.recording_path(row)) for row in rows}
    fit = str(bench.project.path("fits", id, ".json"))
    return {"html": bench.workers.ask("tasks:predictions", fit=fit, recordings=others)}


@router.get("/fits/{id}/report.{kind}", response_class=Response, responses=REPORT)
def get_report(id: PathId, kind: Literal["html", "pdf"], bench: Bench) -> Response:
    """A fit's report: one file to keep."""
    fit = str(bench.project.path("fits", id, ".json"))
    return report_file(bench, bench.project.need("fit", id), kind, "tasks:report", fit=fit)
