"""What every route uses: the workbench, the session, ids, and the errors that are documented."""

from typing import Annotated, Any

from fastapi import Depends, Path, Request

from surae.web.refusals import RefusedError
from surae.web.schemas import Error
from surae.web.sessions import Session
from surae.web.workbench import Workbench

#: What a route may answer, for the description of the API.
Responses = dict[int | str, dict[str, Any]]
#: The errors that any route may answer with.
ERRORS: Responses = {status: {"model": Error} for status in (400, 403, 404, 409, 413, 422, 503)}


def workbench(request: Request) -> Workbench:
    """The server's state."""
    found: Workbench = request.app.state.workbench
    return found


def session(request: Request) -> Session:
    """The browser's session, which `surae.web.security` has found."""
    found: Session | None = getattr(request.state, "session", None)
    if found is None:
        raise RefusedError(403, "no session: GET /api/session first, and send its cookie")
    return found


Bench = Annotated[Workbench, Depends(workbench)]
Browser = Annotated[Session, Depends(session)]
PathId = Annotated[str, Path(pattern=r"^[0-9a-f]{16}$")]


def attachment(name: str, suffix: str) -> dict[str, str]:
    """Headers of a download; only plain letters of the name are kept."""
    kept = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "-" for c in name)
    return {"content-disposition": f'attachment; filename="{kept[:80] or "surae"}{suffix}"'}
