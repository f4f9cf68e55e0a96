"""Jobs: how they stand, what happens to them, and stopping them."""

from collections.abc import AsyncIterator
from typing import Any

from fastapi import APIRouter
from fastapi.responses import StreamingResponse

from surae_workbench.web import answers
from surae_workbench.web.database import ACTIVE
from surae_workbench.web.jobs import Jobs
from surae_workbench.web.routes.common import ERRORS, Bench, Browser, PathId, Responses

router = APIRouter(prefix="/api", responses=ERRORS, tags=["jobs"])

_STREAM: Responses = {200: {"content": {"text/event-stream": {}}}}


@router.get("/jobs", response_model=answers.Jobs)
def get_jobs(bench: Bench, browser: Browser, active: bool = False) -> dict[str, Any]:
    """Jobs, the newest first."""
    jobs = bench.database.active() if active else bench.database.all("job")
    shown = jobs[::-1]
    return {"jobs": [bench.jobs.shown(job, browser, traces=False) for job in shown[:500]]}


@router.get("/jobs/{id}", response_model=answers.Job)
def get_job(id: PathId, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Tell how one job stands."""
    return bench.jobs.shown(bench.project.need("job", id), browser)


@router.post("/jobs/{id}/cancel", response_model=answers.Job)
def cancel_job(id: PathId, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Stop it; a fit keeps the best so far."""
    return bench.jobs.shown(bench.jobs.cancel(id), browser)


@router.get("/jobs/{id}/events", response_class=StreamingResponse, responses=_STREAM)
async def job_events(id: PathId, bench: Bench, browser: Browser) -> StreamingResponse:
    """What happens to it, as server-sent events; how it stands comes first."""
    from starlette.concurrency import run_in_threadpool

    await run_in_threadpool(bench.project.need, "job", id)
    bench.events.refuse_more(browser.key)

    def first() -> list[tuple[str, Any]]:
        job = bench.jobs.shown(bench.project.need("job", id), browser)
        messages: list[tuple[str, Any]] = [("state", job)]
        if job["progress"] is not None:
            messages.append(("progress", job["progress"]))
        if job["state"] not in ACTIVE:
            messages.append(("end", job))
        return messages

    return _events(
        bench.events.stream(
            browser.key, (f"job:{id}",), first, "end", lambda data: Jobs.seen_by(browser, data)
        )
    )


@router.get("/events", response_class=StreamingResponse, responses=_STREAM)
async def all_events(bench: Bench, browser: Browser) -> StreamingResponse:
    """What happens in the project, as server-sent events."""

    def first() -> list[tuple[str, Any]]:
        jobs = (bench.jobs.shown(job, browser, traces=False) for job in bench.database.active())
        queue = [("queue", {"waiting": bench.workers.waiting})] if bench.workers.waiting else []
        return [*queue, *(("job", job) for job in jobs)]

    bench.events.refuse_more(browser.key)
    topics = ("project", f"session:{browser.key}")
    return _events(
        bench.events.stream(
            browser.key, topics, first, view=lambda data: Jobs.seen_by(browser, data)
        )
    )


def _events(stream: AsyncIterator[str]) -> StreamingResponse:
    headers = {"x-accel-buffering": "no", "cache-control": "no-store"}
    return StreamingResponse(stream, media_type="text/event-stream", headers=headers)
