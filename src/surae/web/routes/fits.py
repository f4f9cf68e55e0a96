"""Fits: asked for, understood, tried on other recordings, reported."""

import tempfile
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse

from surae.report.decimate import extremes
from surae.web.fits import (
    fit_detail,
    fit_summary,
    fit_traces,
    submit_fit,
)
from surae.web.http_errors import RefusedError
from surae.web.live import plain
from surae.web.routes.common import (
    ERRORS,
    Bench,
    Browser,
    PathId,
    Responses,
    attachment,
    chosen_draft,
)
from surae.web.routes.recordings import Instant
from surae.web.schemas import (
    FitGiven,
    NameGiven,
    Points,
    ProfileGiven,
    ValidateGiven,
)
from surae.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["fits"])

#: Points of a predicted curve.
_SHOWN = 2000
_HTML: Responses = {200: {"content": {"text/html": {}}}}
_PDF: Responses = {200: {"content": {"application/pdf": {}}}}


@router.post("/fits", status_code=202)
def post_fit(given: FitGiven, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Ask for a fit; the answer is its job."""
    job = submit_fit(bench, browser, chosen_draft(bench, browser, given.draft), given.name)
    return bench.jobs.shown(job, browser)


@router.get("/fits")
def get_fits(
    bench: Bench,
    subject: Annotated[str | None, Query(max_length=16)] = None,
    recording: Annotated[str | None, Query(max_length=16)] = None,
) -> dict[str, Any]:
    """Fits, the newest first."""
    found = [fit_summary(bench, one) for one in reversed(bench.database.all("fit"))]
    return {
        "fits": [
            one
            for one in found
            if (subject is None or one["subject"] == subject)
            and (recording is None or recording in one["recordings"])
        ]
    }


@router.get("/fits/{id}")
def get_fit(id: PathId, bench: Bench) -> dict[str, Any]:
    """All about one but its curves."""
    return fit_detail(bench, bench.project.need("fit", id))


@router.patch("/fits/{id}")
def patch_fit(id: PathId, given: NameGiven, bench: Bench) -> dict[str, Any]:
    """Give it another name."""
    found = bench.project.change("fit", id, name=given.name)
    bench.changed("fits")
    return fit_summary(bench, found)


@router.delete("/fits/{id}", status_code=204)
def delete_fit(id: PathId, bench: Bench, browser: Browser) -> Response:
    """Delete it; undo brings it back."""
    one = bench.project.need("fit", id)
    bench.delete(browser, "fit", id, f"delete fit {one['name']}"[:120])
    return Response(status_code=204)


@router.get("/fits/{id}/fit.json", response_class=FileResponse)
def get_fit_json(id: PathId, bench: Bench) -> FileResponse:
    """FIT.json, as `surae fit --output` writes it."""
    one = bench.project.need("fit", id)
    path = bench.project.path("fits", id, ".json")
    if not path.is_file():
        raise RefusedError(404, "the file of this fit is missing; fit again")
    headers = attachment(one["name"], ".json")
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
    """Its curves at common instants: measured, modelled, residual, parts."""
    return fit_traces(bench.fit(id), recording, start, end, points)


@router.post("/fits/{id}/profile", status_code=202)
def post_profile(id: PathId, given: ProfileGiven, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Ask for profiles of its parameters; the answer is their job."""
    from surae.assessment.likelihood.profile import check_profiled

    fit = bench.project.need("fit", id)
    result = bench.fit(id).result
    for name in given.parameters or result.problem.free:
        check_profiled(result, name)
    task = {"fit": id, "parameters": given.parameters, "recordings": fit["recordings"]}
    label = f"profiles · {fit['name']}"[:200]
    job = bench.jobs.submit("profile", label, browser, task, id)
    return bench.jobs.shown(job, browser)


@router.post("/fits/{id}/validate")
def post_validate(id: PathId, given: ValidateGiven, bench: Bench) -> dict[str, Any]:
    """Predict other recordings with its parameters."""
    from surae import api

    fitted, found = bench.fit(id), []
    for other in dict.fromkeys(given.recordings):
        name = bench.project.need("recording", other)["name"]
        inputs = bench.prepared(other, fitted.settings)
        (one,) = api.validate(fitted, [inputs])
        assert inputs.torque is not None  # else it could not be validated
        shown = extremes([inputs.torque, one.torque], _SHOWN)
        found.append(
            {
                "recording": other,
                "name": name,
                "vaf": one.vaf,
                "rmse_Nm": one.rmse,
                "bias_Nm": one.bias,
                "t": plain(inputs.time[shown]),
                "measured": plain(inputs.torque[shown]),
                "predicted": plain(one.torque[shown]),
            }
        )
    return {"predictions": found}


@router.get("/fits/{id}/report.html", response_class=Response, responses=_HTML)
def get_report(id: PathId, bench: Bench, inline: bool = False) -> Response:
    """Its report: one file to keep, or, inline, to be shown within a page."""
    name, data = _report(bench, id, "html")
    if not inline:
        return Response(data, media_type="text/html", headers=attachment(name, ".html"))
    return Response(data, media_type="text/html", headers=_framed(data.decode()))


@router.get("/fits/{id}/report.pdf", response_class=Response, responses=_PDF)
def get_pdf(id: PathId, bench: Bench) -> Response:
    """Its report for paper."""
    name, data = _report(bench, id, "pdf")
    return Response(data, media_type="application/pdf", headers=attachment(name, ".pdf"))


def _report(bench: Workbench, id_: str, kind: str) -> tuple[str, bytes]:
    name, fit = bench.project.need("fit", id_)["name"], bench.project.path("fits", id_, ".json")

    def make() -> bytes:
        with tempfile.TemporaryDirectory(prefix="surae-report-") as folder:
            output = Path(folder) / f"report.{kind}"
            bench.workers.ask("report", fit=str(fit), output=str(output))
            return output.read_bytes()

    return name, bench.reports.get((id_, kind), make)  # a fit never changes


def _framed(page: str) -> dict[str, str]:
    """Headers of a report within a page: its own style by its hash, and nothing that runs."""
    import base64
    import hashlib
    import re

    styles = re.findall(r"<style>(.*?)</style>", page, re.DOTALL)
    hashes = " ".join(
        f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for s in styles
    )
    policy = (
        f"default-src 'none'; img-src data:; style-src {hashes or chr(39) + 'none' + chr(39)}; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'self'; sandbox"
    )
    return {"content-security-policy": policy, "x-frame-options": "SAMEORIGIN"}
