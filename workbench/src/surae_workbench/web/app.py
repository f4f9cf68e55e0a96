"""The application: routes, errors, security, in the order in which a request meets them."""

import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from anyio.to_thread import current_default_thread_limiter
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from surae._version import __version__
from surae.database import UnavailableError
from surae.errors import InputError, SuraeError
from surae.processes import FULL, NO_ROOM, one_line, where
from surae_workbench.web import STATIC
from surae_workbench.web.fits import keep_designs, keep_fit, keep_profile, keep_study
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.jobs import Kind
from surae_workbench.web.request_workers import THREADS
from surae_workbench.web.routes import (
    cohort,
    descriptions,
    draft,
    fits,
    jobs,
    pages,
    protocols,
    recordings,
    sessions,
    studies,
    uploads,
)
from surae_workbench.web.security import Policy, Security
from surae_workbench.web.workbench import Workbench

_log = logging.getLogger("surae_workbench.web")


def _job_kinds(bench: Workbench) -> dict[str, Kind]:
    """Each kind of job by its name."""
    return {
        "fit": Kind("fits", lambda job, end: keep_fit(bench, job, end)),
        "profile": Kind("fits", lambda job, end: keep_profile(bench, job, end)),
        "session": Kind("fits", lambda job, end: sessions.keep_session(bench, job, end)),
        "design": Kind("studies", lambda job, end: keep_designs(bench, job, end)),
        "study": Kind("studies", lambda job, end: keep_study(bench, job, end)),
    }


def create_app(bench: Workbench, policy: Policy) -> ASGIApp:
    """The workbench as an ASGI application.

    The server's state is started and closed with the application; `policy` says who may ask.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        del app
        current_default_thread_limiter().total_tokens = THREADS
        bench.jobs.start(_job_kinds(bench))
        try:
            yield
        finally:
            bench.close()

    app = FastAPI(
        title="surae workbench",
        version=__version__,
        description=(
            "GET /api/session gives a cookie and a token; every request that changes something "
            "carries the token in the header X-CSRF-Token. Errors are one line."
        ),
        openapi_url="/api/openapi.json",
        docs_url=None,
        redoc_url=None,
        lifespan=lifespan,
        redirect_slashes=False,
        # Else variables of the environment could have requests and errors sent elsewhere.
        telemetry={
            "tracing": False,
            "metrics": False,
            "logs": False,
            "operation_spans": False,
            "auto_configure": False,
        },
    )
    app.state.workbench, app.state.policy = bench, policy
    for module in (
        draft, uploads, recordings, descriptions, fits, sessions, jobs, cohort,
        protocols, studies, pages,
    ):  # fmt: skip
        app.include_router(module.router)
    app.mount("/static", _Static(packages=STATIC), name="static")
    app.add_exception_handler(SuraeError, _surae_error)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(ClientDisconnect, _gone)
    app.add_exception_handler(OSError, _system_error)
    app.add_exception_handler(Exception, _unexpected)
    return Security(app, policy, bench.sessions)


class _Static(StaticFiles):
    """Files that a browser asks again whether it has the newest of."""

    def file_response(self, *arguments: Any, **keywords: Any) -> Response:
        response = super().file_response(*arguments, **keywords)
        response.headers["cache-control"] = "no-cache"
        return response


def _answer(request: Request, status: int, text: str, headers: Any = None) -> Response:
    """An error: JSON to programs, a page to people."""
    path = request.url.path
    if path.startswith(("/api/", "/static/")) or request.method != "GET":
        return JSONResponse({"error": text}, status, headers)
    session = getattr(request.state, "session", None)
    return pages.page(request, "error", session, code=status, status=status, error=text)


async def _surae_error(request: Request, error: Exception) -> Response:
    status = 503 if isinstance(error, UnavailableError) else 422
    if isinstance(error, InputError):
        status = error.status if isinstance(error, RefusedError) else 400
    return _answer(request, status, request.app.state.workbench.project.hidden(one_line(error)))


async def _gone(request: Request, error: Exception) -> Response:  # noqa: ARG001
    """Whoever asked does not wait for the answer; what was half done is undone."""
    return Response(status_code=400)


async def _system_error(request: Request, error: Exception) -> Response:
    """The disk is full, which is nobody's mistake, or something else is wrong with it."""
    if isinstance(error, OSError) and error.errno in FULL:
        return _answer(request, 503, NO_ROOM)
    return await _unexpected(request, error)


async def _invalid(request: Request, error: Exception) -> Response:
    """What is malformed, where; of the request itself nothing is repeated."""
    problems = []
    for problem in error.errors()[:3] if isinstance(error, RequestValidationError) else []:
        place = ".".join(str(part) for part in problem["loc"][:6] if part != "body")
        problems.append(f"{place[:120]}: {problem['msg']}" if place else str(problem["msg"]))
    text = one_line("; ".join(problems)) or "the request is malformed"
    if request.url.path.startswith("/api/") or request.method != "GET":
        return _answer(request, 422, text.encode("ascii", "replace").decode())
    return _answer(request, 404, "there is no such page")


async def _http_error(request: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 500
    if isinstance(error.__cause__, RefusedError):  # the body was too large as it came
        return await _surae_error(request, error.__cause__)
    text = {
        400: "the body is no JSON that can be read",
        404: "there is no such page",
        405: "this address does not take that method",
    }
    headers = error.headers if isinstance(error, HTTPException) else None
    return _answer(request, status, text.get(status, one_line(error)), headers)


async def _unexpected(request: Request, error: Exception) -> Response:
    """A mistake of ours."""
    route = getattr(request.scope.get("route"), "path", "no route")
    _log.error("internal error in %s: %s", route, where(error))
    return _answer(request, 500, "internal error; the server's log tells more")
