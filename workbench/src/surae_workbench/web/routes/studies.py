"""Studies: thousands of fits of virtual trials, started, watched, exported."""

from contextlib import suppress
from typing import Any

from fastapi import APIRouter, Response

from surae import api
from surae.base.errors import SuraeError
from surae_workbench.web.answers import Job, Study
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import dated
from surae_workbench.web.routes.common import (
    CSV,
    ERRORS,
    Bench,
    Browser,
    PathId,
    csv_file,
    offer_deletion,
)
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import StudyRequest
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api/studies", responses=ERRORS, tags=["studies"])

#: A study of more fits belongs on a cluster, with `surae study run`.
_MOST_FITS = 100_000


@router.get("")
def get_studies(bench: Bench) -> dict[str, list[Study]]:
    """List all studies, the newest first, and how far they are."""
    return {"studies": [_shown(bench, row) for row in reversed(bench.database.all("study"))]}


@router.post("", status_code=201)
def post_study(body: StudyRequest, bench: Bench, browser: Browser) -> Study:
    """Make one of a STUDY.toml, and start it."""
    study = api.parse_study(body.toml)
    if study.size > _MOST_FITS:
        raise RefusedError(
            400, f"{study.size:,} fits; at most {_MOST_FITS:,} here, use `surae study run` for more"
        )
    data = {"name": study.name[:200], "toml": body.toml, "rows": study.size}
    id_ = bench.database.add("study", data)
    if body.start:
        start_study(id_, bench, browser)
    bench.events.changed("studies")
    return _shown(bench, bench.project.need("study", id_))


@router.post("/{id}/start", status_code=202)
def start_study(id: PathId, bench: Bench, browser: Browser) -> Job:
    """Start it, or go on with it; the answer is its job."""
    row = bench.project.need("study", id)
    if bench.jobs.of(id):
        raise RefusedError(409, "this study is at work already")
    task = {"study": id, "toml": row["toml"]}
    return bench.jobs.submit("study", f"study {row['name']}", browser, task, id)


offer_deletion(router, "/{id}", "study")


@router.get("/{id}/table.csv", response_class=Response, responses=CSV)
def get_csv(id: PathId, bench: Bench) -> Response:
    """The rows that are there, as `surae study export` writes them."""
    row = bench.project.need("study", id)
    path = bench.project.file("study", id)
    if not path.exists():
        raise RefusedError(409, "nothing is computed yet; start the study first")
    with api.Store(path) as store:
        return csv_file(row["name"], lambda path: api.export_study(store, path))


def _shown(bench: Workbench, row: Entry) -> Study:
    jobs = bench.jobs.of(row["id"])
    path = bench.project.file("study", row["id"])
    far: dict[str, Any] = {"done": 0, "fits": None, "reasons": {}}
    with suppress(SuraeError):  # it is just being planned
        if path.exists():
            with api.Store(path) as store:
                status = store.status()
            far = {"done": status.done, "fits": status.calls, "reasons": dict(status.reasons)}
    if jobs:
        state = str(jobs[0]["state"])
    elif far["fits"] is None:
        state = "new"
    else:
        state = "done" if far["done"] >= far["fits"] else "stopped"
    return Study(**dated(row, **far), state=state, job=jobs[0]["id"] if jobs else None)
