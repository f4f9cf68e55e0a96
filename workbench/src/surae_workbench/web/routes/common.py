"""What every route uses: the workbench, the session, ids, and the errors that are documented."""

import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response
from fastapi import Path as InPath

from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import Error
from surae_workbench.web.security import NO_SESSION
from surae_workbench.web.sessions import BrowserSession
from surae_workbench.web.workbench import Workbench

#: What a route may answer, for the description of the API.
Responses = dict[int | str, dict[str, Any]]
TYPES = {"html": "text/html", "pdf": "application/pdf"}
#: A report, or a table, as a file.
REPORT: Responses = {200: {"content": {kind: {} for kind in TYPES.values()}}}
CSV: Responses = {200: {"content": {"text/csv": {}}}}
#: The errors that any route may answer with.
ERRORS: Responses = {
    status: {"model": Error} for status in (400, 403, 404, 408, 409, 413, 422, 503)
}


def workbench(request: Request) -> Workbench:
    """The server's state."""
    state: Workbench = request.app.state.workbench
    return state


def session(request: Request) -> BrowserSession:
    """The browser's session, which `surae_workbench.web.security` has found."""
    state: BrowserSession | None = getattr(request.state, "session", None)
    if state is None:
        raise RefusedError(403, NO_SESSION)
    return state


Bench = Annotated[Workbench, Depends(workbench)]
Browser = Annotated[BrowserSession, Depends(session)]
PathId = Annotated[str, InPath(pattern=r"^[0-9a-f]{16}$")]


def attachment(name: str, suffix: str) -> dict[str, str]:
    """Headers of a download; only plain words of the name are kept."""
    slug = "-".join(re.findall(r"[A-Za-z0-9_]+", name[:200]))[:80].strip("-")
    return {"content-disposition": f'attachment; filename="{slug or "surae"}{suffix}"'}


def made_file(name: str, write: Callable[[Path], object]) -> bytes:
    """What is written to a file of that name, which is nowhere afterwards."""
    with TemporaryDirectory(prefix="surae-") as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def csv_file(name: str, write: Callable[[Path], object]) -> Response:
    """A table as a file."""
    data = made_file("table.csv", write)
    return Response(data, media_type="text/csv", headers=attachment(name, ".csv"))


def offer_deletion(router: APIRouter, path: str, kind: str) -> None:
    """Have entries of a kind deleted by their address; undo brings them back."""

    def delete(id: PathId, bench: Bench, browser: Browser) -> Response:
        """Delete it; undo brings it back."""
        bench.delete(browser, kind, id)
        return Response(status_code=204)

    router.delete(path, status_code=204, name=f"delete_{kind}")(delete)


def report_file(bench: Workbench, row: Entry, kind: str, task: str, **settings: str) -> Response:
    """A report that a worker writes, again where any of its settings is another: one file."""

    def write(path: Path) -> None:
        bench.workers.ask(task, output=str(path), **settings)

    key = (row["id"], f"{kind} {sorted(settings.items())}")
    data = bench.reports.get(key, lambda: made_file(f"report.{kind}", write))
    return Response(data, media_type=TYPES[kind], headers=attachment(row["name"], f".{kind}"))
