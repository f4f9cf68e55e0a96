"""Fits: asked for, understood, tried on other recordings, reported."""

import json
from operator import itemgetter
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse

from surae import api
from surae_workbench.web.curves import plain
from surae_workbench.web.fits import (
    fit_detail,
    fit_summary,
    fit_traces,
    model_title,
    submit_fit,
)
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.routes.common import (
    ERRORS,
    Bench,
    Browser,
    Paged,
    PathId,
    Responses,
    attachment,
    chosen_draft,
    made_file,
    offer_deletion,
)
from surae_workbench.web.routes.recordings import Instant
from surae_workbench.web.schemas import (
    FitRequest,
    NameRequest,
    Points,
    ProfileRequest,
    ValidateRequest,
)
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["fits"])

_NONE = "'none'"

#: Points of a predicted curve.
_SHOWN = 2000
_HTML: Responses = {200: {"content": {"text/html": {}}}}
_PDF: Responses = {200: {"content": {"application/pdf": {}}}}


@router.post("/fits", status_code=202)
def post_fit(body: FitRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Ask for a fit; the answer is its job."""
    job = submit_fit(bench, browser, chosen_draft(bench, browser, body.draft), body.name)
    return bench.jobs.shown(job, browser)


@router.get("/fits")
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
    values = {key: itemgetter(key) for key in ("name", "status", "vaf", "created")} | {
        "title": lambda row: model_title(row["model"]),
        "subject": lambda row: codes.get(owners.get(row["recordings"][0])),
    }
    return page.of("fits", rows, values, lambda row: fit_summary(bench, row))


@router.get("/fits/{id}")
def get_fit(id: PathId, bench: Bench) -> dict[str, Any]:
    """All about one but its curves."""
    return fit_detail(bench, bench.project.need("fit", id))


@router.patch("/fits/{id}")
def patch_fit(id: PathId, body: NameRequest, bench: Bench) -> dict[str, Any]:
    """Give it another name."""
    changed = bench.project.change("fit", id, name=body.name)
    bench.events.changed("fits")
    return fit_summary(bench, changed)


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


@router.get("/fits/{id}/traces")
def get_traces(
    id: PathId,
    bench: Bench,
    recording: Annotated[int, Query(ge=0, le=1000)] = 0,
    start: Instant = None,
    end: Instant = None,
    points: Annotated[Points, Query()] = 2000,
) -> dict[str, Any]:
    """A fit's curves at common instants: measured, modelled, residual, parts."""
    return fit_traces(bench.fit(id), recording, start, end, points)


@router.get("/fits/{id}/next")
def get_next(id: PathId, bench: Bench) -> dict[str, Any]:
    """The ready trial that adds most to what is weak, in words and numbers."""
    return api.measure_next(bench.fit(id)).to_json()


@router.post("/fits/{id}/profile", status_code=202)
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
    job = bench.jobs.submit("profile", label, browser, task, id)
    return bench.jobs.shown(job, browser)


@router.post("/fits/{id}/validate")
def post_validate(id: PathId, body: ValidateRequest, bench: Bench) -> dict[str, Any]:
    """Predict other recordings with its parameters."""
    fitted, predictions = bench.fit(id), []
    for recording in dict.fromkeys(body.recordings):
        name = bench.project.need("recording", recording)["name"]
        inputs = bench.prepared(recording, fitted.settings)
        (prediction,) = api.validate(fitted, [inputs])
        assert inputs.torque is not None  # else it could not be validated
        shown = api.extremes([inputs.torque, prediction.torque], _SHOWN)
        predictions.append(
            {
                "recording": recording,
                "name": name,
                "vaf": prediction.vaf,
                "rmse_Nm": prediction.rmse,
                "bias_Nm": prediction.bias,
                "t": plain(inputs.time[shown]),
                "measured": plain(inputs.torque[shown]),
                "predicted": plain(prediction.torque[shown]),
            }
        )
    return {"predictions": predictions}


@router.get("/fits/{id}/report.html", response_class=Response, responses=_HTML)
def get_report(id: PathId, bench: Bench, inline: bool = False) -> Response:
    """A fit's report: one file to keep, or, inline, to be shown within a page."""
    name, data = _report(bench, id, "html")
    if not inline:
        return Response(data, media_type="text/html", headers=attachment(name, ".html"))
    return Response(data, media_type="text/html", headers=_framed(data.decode()))


Language = Literal["en", "nl", "de", "fr"]


@router.get("/fits/{id}/clinical")
def get_short(id: PathId, bench: Bench, language: Language = "en") -> Response:
    """What a fit's page for clinicians says: sentences, a table, and its figures as SVG."""
    bench.project.need("fit", id)
    fit = bench.project.path("fits", id, ".json")

    def make() -> bytes:
        page = bench.workers.ask("tasks:short", fit=str(fit), language=language)
        return json.dumps(page).encode()

    page = bench.reports.get((id, f"short-{language}"), make)  # a fit never changes
    return Response(page, media_type="application/json")


@router.get("/fits/{id}/clinical.html", response_class=Response, responses=_HTML)
def get_clinical(id: PathId, bench: Bench, language: Language = "en") -> Response:
    """A fit's page for clinicians: one file to keep."""
    name, data = _report(bench, id, "html", language)
    return Response(data, media_type="text/html", headers=attachment(name, ".html"))


@router.get("/fits/{id}/report.pdf", response_class=Response, responses=_PDF)
def get_pdf(id: PathId, bench: Bench) -> Response:
    """A fit's report for paper."""
    name, data = _report(bench, id, "pdf")
    return Response(data, media_type="application/pdf", headers=attachment(name, ".pdf"))


def _report(
    bench: Workbench, id_: str, kind: str, language: str | None = None
) -> tuple[str, bytes]:
    name, fit = bench.project.need("fit", id_)["name"], bench.project.path("fits", id_, ".json")

    def make() -> bytes:
        return made_file(
            f"report.{kind}",
            lambda path: bench.workers.ask(
                "tasks:report", fit=str(fit), output=str(path), language=language
            ),
        )

    return name, bench.reports.get((id_, kind + (language or "")), make)  # a fit never changes


def _framed(page: str) -> dict[str, str]:
    """Headers of a report within a page: its own styles and scripts by their hashes, walled in."""
    import base64
    import hashlib
    import re

    def allowed(tag: str) -> str:
        parts = re.findall(f"<{tag}>(.*?)</{tag}>", page, re.DOTALL)
        digests = (hashlib.sha256(part.encode()).digest() for part in parts)
        return " ".join(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)

    policy = (
        f"default-src 'none'; img-src data:; style-src {allowed('style') or _NONE}; "
        f"script-src {allowed('script') or _NONE}; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'self'; sandbox allow-scripts"
    )
    return {"content-security-policy": policy, "x-frame-options": "SAMEORIGIN"}
