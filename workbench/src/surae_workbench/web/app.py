"""The application: routes, errors, security, in the order in which a request meets them."""

import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
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
from surae.base.database import UnavailableError
from surae.base.errors import InputError, SuraeError
from surae.processes import FULL, NO_ROOM, one_line, where
from surae_workbench.web import STATIC
from surae_workbench.web.fits import keep_designs, keep_fit, keep_profile
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.jobs import Finish
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
#: What errors of HTTP itself are called.
_TEXTS = {
    400: "the body is no JSON that can be read",
    404: "there is no such page",
    405: "this address does not take that method",
}
#: Makes the answer of a request with a status, a line of text, and headers.
Answer = Callable[..., Response]


def _kept(bench: Workbench) -> dict[str, Finish]:
    """What is done with the result of each kind of job; a study keeps itself."""
    return {
        "fit": partial(keep_fit, bench),
        "profile": partial(keep_profile, bench),
        "session": partial(sessions.keep_session, bench),
        "design": partial(keep_designs, bench),
        "study": lambda job, end: str(job["about"]),  # noqa: ARG005
    }


def create_app(bench: Workbench, policy: Policy) -> ASGIApp:
    """The workbench as an ASGI application.

    The server's state is started and closed with the application; `policy` says who may ask.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        del app
        current_default_thread_limiter().total_tokens = THREADS
        bench.jobs.start(_kept(bench))
        try:
            yield
        finally:
            bench.close()

    def answer(request: Request, status: int, text: str, headers: Any = None) -> Response:
        """An error: JSON to programs, a page to people."""
        text = bench.project.hidden(text)
        if request.url.path.startswith(("/api/", "/static/")) or request.method != "GET":
            return JSONResponse({"error": text}, status, headers)
        session = getattr(request.state, "session", None)
        return pages.page(request, "error", session, code=status, status=status, error=text)

    app = bare_app(
        answer,
        title="surae workbench",
        description=(
            "GET /api/session gives a cookie and a token; every request that changes something "
            "carries the token in the header X-CSRF-Token. Errors are one line."
        ),
        openapi_url="/api/openapi.json",
        lifespan=lifespan,
    )
    app.state.workbench = bench
    app.state.policy = policy
    for module in (
        draft,
        uploads,
        recordings,
        descriptions,
        fits,
        sessions,
        jobs,
        cohort,
        protocols,
        studies,
        pages,
    ):
        app.include_router(module.router)
    return Security(app, policy, bench.sessions)


class _Static(StaticFiles):
    """Files that a browser asks again whether it has the newest of."""

    def file_response(self, *arguments: Any, **keywords: Any) -> Response:
        response = super().file_response(*arguments, **keywords)
        response.headers["cache-control"] = "no-cache"
        return response


def bare_app(answer: Answer, openapi_url: str | None = None, **more: Any) -> FastAPI:
    """An application that has nothing but static files, and answers every error in one line."""
    app = FastAPI(
        version=__version__,
        openapi_url=openapi_url,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        # Else variables of the environment could have requests and errors sent elsewhere.
        telemetry={
            "tracing": False,
            "metrics": False,
            "logs": False,
            "operation_spans": False,
            "auto_configure": False,
        },
        **more,
    )
    app.mount("/static", _Static(packages=STATIC), name="static")

    async def surae_error(request: Request, error: Exception) -> Response:
        status = 503 if isinstance(error, UnavailableError) else 422
        if isinstance(error, InputError):
            status = error.status if isinstance(error, RefusedError) else 400
        return answer(request, status, one_line(error))

    async def gone(request: Request, error: Exception) -> Response:  # noqa: ARG001
        """Whoever asked does not wait for the answer; what was half done is undone."""
        return Response(status_code=400)

    async def invalid(request: Request, error: Exception) -> Response:
        """What is malformed, where; of the request itself nothing is repeated."""
        problems = []
        for problem in error.errors()[:3] if isinstance(error, RequestValidationError) else []:
            place = ".".join(str(part) for part in problem["loc"][:6] if part != "body")
            problems.append(f"{place[:120]}: {problem['msg']}" if place else str(problem["msg"]))
        text = one_line("; ".join(problems)) or "the request is malformed"
        if request.url.path.startswith("/api/") or request.method != "GET":
            return answer(request, 422, text.encode("ascii", "replace").decode())
        return answer(request, 404, _TEXTS[404])

    async def http_error(request: Request, error: Exception) -> Response:
        if isinstance(error.__cause__, RefusedError):  # the body was too large as it came
            return await surae_error(request, error.__cause__)
        assert isinstance(error, HTTPException)
        text = _TEXTS.get(error.status_code, one_line(error))
        return answer(request, error.status_code, text, error.headers)

    async def unexpected(request: Request, error: Exception) -> Response:
        """The disk is full, which is nobody's mistake; else one of ours."""
        if isinstance(error, OSError) and error.errno in FULL:
            return answer(request, 503, NO_ROOM)
        route = getattr(request.scope.get("route"), "path", "no route")
        _log.error("internal error in %s: %s", route, where(error))
        return answer(request, 500, "internal error; the server's log tells more")

    app.add_exception_handler(SuraeError, surae_error)
    app.add_exception_handler(RequestValidationError, invalid)
    app.add_exception_handler(HTTPException, http_error)
    app.add_exception_handler(ClientDisconnect, gone)
    app.add_exception_handler(OSError, unexpected)
    app.add_exception_handler(Exception, unexpected)
    return app
