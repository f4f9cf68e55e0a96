"""Jobs: how they stand, what happens to them, and stopping them."""

from fastapi import APIRouter
from fastapi.responses import StreamingResponse

from surae_workbench.web import answers
from surae_workbench.web.events import Message
from surae_workbench.web.routes.common import ERRORS, Bench, Browser, PathId, Responses

router = APIRouter(prefix="/api", responses=ERRORS, tags=["jobs"])

_STREAM: Responses = {200: {"content": {"text/event-stream": {}}}}


@router.get("/jobs")
def get_jobs(bench: Bench, browser: Browser, active: bool = False) -> dict[str, list[answers.Job]]:
    """Jobs, the newest first."""
    jobs = bench.database.active() if active else bench.database.all("job")
    return {"jobs": [bench.jobs.shown(job, browser) for job in jobs[::-1]]}


@router.get("/jobs/{id}")
def get_job(id: PathId, bench: Bench, browser: Browser) -> answers.Job:
    """Tell how one job stands."""
    return bench.jobs.shown(bench.project.need("job", id), browser)


@router.post("/jobs/{id}/cancel")
def cancel_job(id: PathId, bench: Bench, browser: Browser) -> answers.Job:
    """Stop it; a fit keeps the best so far."""
    return bench.jobs.shown(bench.jobs.cancel(id), browser)


@router.get("/jobs/{id}/events", response_class=StreamingResponse, responses=_STREAM)
async def job_events(id: PathId, bench: Bench) -> StreamingResponse:
    """What happens to it, as server-sent events; how it stands comes first."""
    bench.project.need("job", id)

    def first() -> list[Message]:
        return bench.jobs.news(bench.project.need("job", id))

    return bench.events.answer(f"job:{id}", first=first, last="end")


@router.get("/events", response_class=StreamingResponse, responses=_STREAM)
async def all_events(bench: Bench, browser: Browser) -> StreamingResponse:
    """What changes in the project, as server-sent events."""
    return bench.events.answer("project", f"session:{browser.key}")
