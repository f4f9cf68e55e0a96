"""The pages: a frame each, which scripts fill from the API."""

from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request, Response

from surae._version import __version__
from surae.files import template
from surae.web.glossary import symbols, terms
from surae.web.routes.common import Bench, Browser, PathId
from surae.web.sessions import BrowserSession

router = APIRouter(include_in_schema=False)

STATIC = Path(__file__).resolve().parents[1] / "static"


def page(
    request: Request, name: str, browser: BrowserSession | None, code: int = 200, **more: Any
) -> Response:
    """A page of a template."""
    text = template(f"{name}.html.j2", "surae.web").render(
        csrf="" if browser is None else browser.csrf,
        version=__version__,
        page=name,
        project=request.app.state.workbench.project.name,
        **more,
    )
    return Response(text, status_code=code, media_type="text/html")


@router.get("/")
def project_page(request: Request, browser: Browser) -> Response:
    """The project."""
    return page(request, "project", browser)


@router.get("/import")
def import_page(request: Request, browser: Browser) -> Response:
    """Import."""
    return page(request, "import", browser)


@router.get("/recordings/{id}")
def recording_page(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
    """One recording."""
    bench.project.need("recording", id)
    return page(request, "recording", browser, id=id)


@router.get("/fit")
def fit_page(request: Request, browser: Browser) -> Response:
    """The draft, its sliders and its fit."""
    return page(request, "fit", browser)


@router.get("/fits/{id}")
def result_page(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
    """One fit."""
    bench.project.need("fit", id)
    return page(request, "result", browser, id=id)


@router.get("/session")
def leg_page(request: Request, browser: Browser) -> Response:
    """Sessions, and a new one."""
    return page(request, "session", browser)


@router.get("/sessions/{id}")
def session_page(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
    """One session."""
    bench.project.need("session", id)
    return page(request, "session_result", browser, id=id)


@router.get("/compare")
def compare_page(request: Request, browser: Browser) -> Response:
    """Fits side by side."""
    return page(request, "compare", browser)


@router.get("/cohort")
def cohort_page(request: Request, browser: Browser) -> Response:
    """The cohort."""
    return page(request, "cohort", browser)


@router.get("/protocol")
def protocol_page(request: Request, browser: Browser) -> Response:
    """The protocol designer."""
    return page(request, "protocol", browser)


@router.get("/studies")
def studies_page(request: Request, browser: Browser) -> Response:
    """Studies."""
    return page(request, "studies", browser)


@router.get("/glossary")
def glossary_page(request: Request, browser: Browser) -> Response:
    """What terms and symbols mean."""
    return page(request, "glossary", browser, terms=terms(), symbols=symbols())


@router.get("/studies/{id}")
def study_page(id: PathId, request: Request, bench: Bench, browser: Browser) -> Response:
    """One study."""
    bench.project.need("study", id)
    return page(request, "study", browser, id=id)
