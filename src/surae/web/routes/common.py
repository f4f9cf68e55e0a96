"""What every route uses: the workbench, the session, ids, and the errors that are documented."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Request, Response
from fastapi import Path as InPath

from surae.files import sha256
from surae.web.draft import changed, empty_draft
from surae.web.http_errors import RefusedError
from surae.web.rows import Thing
from surae.web.schemas import DraftChange, Error
from surae.web.security import NO_SESSION
from surae.web.sessions import BrowserSession
from surae.web.workbench import Workbench

#: What a route may answer, for the description of the API.
Responses = dict[int | str, dict[str, Any]]
#: The errors that any route may answer with.
ERRORS: Responses = {
    status: {"model": Error} for status in (400, 403, 404, 408, 409, 413, 422, 503)
}


def workbench(request: Request) -> Workbench:
    """The server's state."""
    state: Workbench = request.app.state.workbench
    return state


def session(request: Request) -> BrowserSession:
    """The browser's session, which `surae.web.security` has found."""
    state: BrowserSession | None = getattr(request.state, "session", None)
    if state is None:
        raise RefusedError(403, NO_SESSION)
    return state


#: What a page has seen of a thing that it changes, as `revision` gives it.
Seen = Annotated[str | None, Header(alias="If-Match", max_length=80)]
#: What people write on things.
_LABELS = ("code", "group", "notes", "body_mass", "name", "subject", "side", "trial", "condition")


def revision(row: Thing) -> str:
    """Names what people wrote on a thing, so that nobody overwrites what he has not seen."""
    labels = {key: row[key] for key in _LABELS if key in row}
    return sha256(json.dumps(labels, sort_keys=True).encode())[:16]


def refuse_unseen(row: Thing, seen: str | None) -> None:
    """Refuse to overwrite what another browser has changed since `seen`.

    The message says what stands there now.
    """
    if seen is None or seen.strip('"') == revision(row):
        return
    now = ", ".join(f"{k} {row[k]!r}"[:80] for k in _LABELS if row.get(k) not in (None, ""))
    raise RefusedError(
        409, f"somebody else has changed this meanwhile; it is now {now}: look, then change it"
    )


#: "muscle-tendon-" of "muscle-tendon-muscle-tendon-left"; numbers may well come twice.
_TWICE = re.compile(r"(?<![A-Za-z0-9_-])([A-Za-z][A-Za-z0-9_-]*)-\1(?=-|$)")

Bench = Annotated[Workbench, Depends(workbench)]
Browser = Annotated[BrowserSession, Depends(session)]
PathId = Annotated[str, InPath(pattern=r"^[0-9a-f]{16}$")]


def attachment(name: str, suffix: str) -> dict[str, str]:
    """Headers of a download; only plain words of the name are kept, none said twice in a row."""
    slug = "-".join(re.findall(r"[A-Za-z0-9_]+", name[:200]))
    slug = _TWICE.sub(r"\1", slug)[:80].strip("-")
    return {"content-disposition": f'attachment; filename="{slug or "surae"}{suffix}"'}


def made_file(name: str, write: Callable[[Path], object]) -> bytes:
    """What is written to a file of that name, which is nowhere afterwards."""
    with TemporaryDirectory(prefix="surae-") as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def offer_deletion(router: APIRouter, path: str, kind: str) -> None:
    """Have things of a kind deleted by their address; undo brings them back."""

    def delete(id: PathId, bench: Bench, browser: Browser) -> Response:
        """Delete it; undo brings it back."""
        name = bench.project.need(kind, id)["name"]
        bench.delete(browser, kind, id, f"delete {kind} {name}"[:120])
        return Response(status_code=204)

    router.delete(path, status_code=204, name=f"delete_{kind}")(delete)


def chosen_draft(
    bench: Workbench, browser: BrowserSession, body: DraftChange | None
) -> dict[str, Any]:
    """The settings that came with a request, else those of the session."""
    if body is None:
        return bench.sessions.draft(browser)
    return changed(empty_draft(), body.plain())
