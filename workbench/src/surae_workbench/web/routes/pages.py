"""The pages: a frame each, which scripts fill from the API."""

import json
from contextlib import suppress
from typing import Any

from fastapi import APIRouter, Request, Response
from jinja2 import UndefinedError
from markupsafe import Markup

from surae import api
from surae._version import __version__
from surae.base.errors import InputError
from surae.base.files import template
from surae_workbench.web.language import language_of, spoken
from surae_workbench.web.routes.common import Bench, Browser, PathId
from surae_workbench.web.sessions import BrowserSession

router = APIRouter(include_in_schema=False)


def page(
    request: Request, name: str, browser: BrowserSession | None, code: int = 200, **more: Any
) -> Response:
    """A page of a template."""
    text = template(f"{name}.html.j2", "surae_workbench.web").render(
        csrf="" if browser is None else browser.csrf,
        version=__version__,
        page=name,
        project=request.app.state.workbench.project.name,
        **spoken(request),
        **more,
    )
    return Response(text, status_code=code, media_type="text/html")


def _offer(path: str, name: str, kind: str) -> None:
    """Have a path show a template: by itself, or for an entry of a kind that has to be there."""

    def frame(request: Request, browser: Browser) -> Response:
        return page(request, name, browser)

    def frame_of(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
        bench.project.need(kind, id)
        return page(request, name, browser, id=id)

    router.add_api_route(path, frame_of if kind else frame, name=name)


#: Path, template, and the kind of entry that it is about, if it is about one.
for _page in (
    ("/", "project", ""),
    ("/import", "import", ""),
    ("/recordings/{id}", "recording", "recording"),
    ("/nerve/{id}", "nerve", "recording"),
    ("/fit", "fit", ""),
    ("/analyse", "analyse", ""),
    ("/live", "live", ""),
    ("/cohort", "cohort", ""),
    ("/plan", "plan", ""),
    ("/studies", "studies", ""),
):
    _offer(*_page)


@router.get("/sessions/{id}", name="leg")
def session_page(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
    """A leg: what its report shows."""
    kept = bench.project.kept("session", id)
    shown = ""
    with suppress(OSError, ValueError, KeyError, TypeError, UndefinedError):  # missing, or damaged
        blocks = json.loads(kept.read_text(encoding="utf-8"))
        translated = blocks.pop("translated", {})
        shown = api.part_of(**translated.get(language_of(request), blocks))
    return page(request, "leg", browser, id=id, report=Markup(shown))


@router.get("/fits/{id}", name="result")
def fit_page(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
    """A fit: its report, and what else can be tried."""
    name = bench.project.need("fit", id)["name"]
    problem = ""
    shown = ""

    def make() -> bytes:
        part: str = bench.workers.ask("tasks:fit_part", fit=str(bench.project.kept("fit", id)))
        return part.encode()

    try:
        shown = bench.reports.get((id, "part"), make).decode()  # a fit never changes
    except InputError as error:
        problem = bench.project.hidden(str(error))
    return page(
        request, "result", browser, id=id, called=name, problem=problem, report=Markup(shown)
    )


@router.get("/report.css")
def report_style() -> Response:
    """The style of reports that stand within a page."""
    return Response(api.style(), media_type="text/css")
