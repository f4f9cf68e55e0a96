"""Studies: thousands of fits of virtual trials, started, watched, opened."""

from itertools import islice
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from surae import api
from surae.errors import SuraeError
from surae_workbench.web import answers
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import dated
from surae_workbench.web.routes.common import (
    CSV,
    ERRORS,
    Bench,
    Browser,
    PathId,
    attachment,
    made_file,
    offer_deletion,
)
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import StudyRequest
from surae_workbench.web.sessions import BrowserSession
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api/studies", responses=ERRORS, tags=["studies"])

#: A study of more fits belongs on a cluster, with `surae study run`.
_MOST_FITS = 100_000


@router.get("", response_model=answers.Studies)
def get_studies(bench: Bench) -> dict[str, Any]:
    """List all studies."""
    return {"studies": [_shown(bench, row) for row in bench.database.all("study")]}


@router.post("", status_code=201, response_model=answers.Study)
def post_study(body: StudyRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Make one of a STUDY.toml, and start it."""
    study = api.parse_study(body.toml)
    if study.size > _MOST_FITS:
        raise RefusedError(
            400, f"{study.size:,} fits; at most {_MOST_FITS:,} here, use `surae study run` for more"
        )
    data = {"name": study.name[:200], "toml": body.toml, "rows": study.size}
    id_ = bench.database.add("study", data)
    if body.start:
        _start(bench, browser, bench.project.need("study", id_), study)
    bench.events.changed("studies")
    return _shown(bench, bench.project.need("study", id_))


@router.get("/{id}", response_model=answers.Study)
def get_study(id: PathId, bench: Bench) -> dict[str, Any]:
    """How far it is."""
    return _shown(bench, bench.project.need("study", id))


@router.post("/{id}/start", status_code=202, response_model=answers.Job)
def start_study(id: PathId, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Start it, or go on with it; the answer is its job."""
    row = bench.project.need("study", id)
    return _start(bench, browser, row, api.parse_study(row["toml"]))


offer_deletion(router, "/{id}", "study")


@router.get("/{id}/table", response_model=answers.StudyTable)
def get_table(
    id: PathId, bench: Bench, limit: Annotated[int, Query(ge=1, le=5000)] = 500
) -> dict[str, Any]:
    """The rows that are there."""
    row = bench.project.need("study", id)
    names = api.study_columns(api.parse_study(row["toml"]))
    path = bench.project.path("studies", id, ".db")
    if not path.exists():
        return {"columns": names, "rows": [], "total": 0}
    with api.Store(path) as store:
        rows = [[row[name] for name in names] for row in islice(api.study_table(store), limit)]
        total = store.status().done
    return {"columns": names, "rows": rows, "total": max(total, len(rows))}


@router.get("/{id}/table.csv", response_class=Response, responses=CSV)
def get_csv(id: PathId, bench: Bench) -> Response:
    """The table, as `surae study export` writes it."""
    row = bench.project.need("study", id)
    with _store(bench, id) as store:
        data = made_file("table.csv", lambda path: api.export_study(store, path))
    return Response(data, media_type="text/csv", headers=attachment(row["name"], ".csv"))


def _store(bench: Workbench, id_: str) -> api.Store:
    path = bench.project.path("studies", id_, ".db")
    if not path.exists():
        raise RefusedError(409, "nothing is computed yet; start the study first")
    return api.Store(path)


def _start(
    bench: Workbench, browser: BrowserSession, row: Entry, study: api.Study
) -> dict[str, Any]:
    if bench.jobs.of(row["id"]):
        raise RefusedError(409, "this study is at work already")
    task = {"study": row["id"], "toml": row["toml"]}
    return bench.jobs.submit("study", f"study {study.name}"[:200], browser, task, row["id"])


def _shown(bench: Workbench, row: Entry) -> dict[str, Any]:
    jobs = bench.jobs.of(row["id"])
    path = bench.project.path("studies", row["id"], ".db")
    done, fits, reasons = 0, None, dict[str, int]()
    if path.exists():
        try:
            with api.Store(path) as store:
                status = store.status()
            done, fits, reasons = status.done, status.calls, dict(status.reasons)
        except SuraeError:  # it is just being planned
            done = 0
    if jobs:
        state = str(jobs[0]["state"])
    elif fits is None:
        state = "new"
    else:
        state = "done" if done >= fits else "stopped"
    factors = {k: list(v) for k, v in api.parse_study(row["toml"]).factors.items()}
    return dated(
        row, fits=fits, done=done, state=state, job=jobs[0]["id"] if jobs else None,
        reasons=reasons, factors=factors,
    )  # fmt: skip
