"""What every route uses: the workbench, the session, ids, and the errors that are documented."""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Request, Response
from fastapi import Path as InPath

from surae.files import natural_order, sha256
from surae_workbench.web import answers
from surae_workbench.web.draft import changed, empty_draft
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import DraftChange, Error, NameRequest
from surae_workbench.web.security import NO_SESSION
from surae_workbench.web.sessions import BrowserSession
from surae_workbench.web.workbench import Workbench

#: What a route may answer, for the description of the API.
Responses = dict[int | str, dict[str, Any]]
_TYPES = {"html": "text/html", "pdf": "application/pdf"}
#: A report, or a table, as a file.
REPORT: Responses = {200: {"content": {kind: {} for kind in _TYPES.values()}}}
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


@dataclass(frozen=True)
class Page:
    """The part of a list that is asked for."""

    start: Annotated[int, Query(ge=0, le=10**9)] = 0
    count: Annotated[int, Query(ge=1, le=1000)] = 100
    find: Annotated[str, Query(max_length=200)] = ""  #: Words that a text of it holds.
    sort: Annotated[str, Query(max_length=20)] = ""  #: By which of its values.
    down: bool = False
    also: Annotated[str, Query(max_length=20_000)] = ""  #: Ids of those that are wanted anyway.

    def of(
        self,
        kind: str,
        rows: Sequence[Entry],
        values: Mapping[str, Callable[[Entry], Any]],
        show: Callable[[Entry], dict[str, Any]],
    ) -> dict[str, Any]:
        """That part of a list, how many were found in all, and those that were wanted anyway.

        `values` are what entries are found and sorted by; `show` is called for what is shown alone.
        """
        wanted, words = set(self.also.split(",")), self.find.casefold().split()
        found = list(rows)
        if words:
            found = [
                row for row in found if _holds((value(row) for value in values.values()), words)
            ]
        if self.sort:
            if self.sort not in values:
                raise RefusedError(400, f"sort: give one of {', '.join(values)}")
            keyed = [(values[self.sort](row), row) for row in found]
            there = [(_order(value), row) for value, row in keyed if value is not None]
            there.sort(key=itemgetter(0), reverse=self.down)
            found = [row for _, row in (*there, *(pair for pair in keyed if pair[0] is None))]
        return {
            kind: [show(row) for row in found[self.start : self.start + self.count]],
            "also": [show(row) for row in rows if row["id"] in wanted],
            "total": len(found),
        }


def _holds(values: Iterable[object], words: Sequence[str]) -> bool:
    """Whether every word is in the texts among some values."""
    text = " ".join(value.casefold() for value in values if isinstance(value, str))
    return all(word in text for word in words)


def _order(value: Any) -> Any:
    return natural_order(value.casefold()) if isinstance(value, str) else value


#: What a page has seen of an entry that it changes, as `revision` gives it.
Seen = Annotated[str | None, Header(alias="If-Match", max_length=80)]
#: What people write on entries.
_LABELS = ("code", "group", "notes", "body_mass", "name", "subject", "side", "trial", "condition")


def revision(row: Entry) -> str:
    """Names what people wrote on an entry, so that nobody overwrites what he has not seen."""
    labels = {key: row[key] for key in _LABELS if key in row}
    return sha256(json.dumps(labels, sort_keys=True).encode())[:16]


def refuse_unseen(row: Entry, seen: str | None) -> None:
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
Paged = Annotated[Page, Depends()]
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
    """Have entries of a kind deleted by their address; undo brings them back."""

    def delete(id: PathId, bench: Bench, browser: Browser) -> Response:
        """Delete it; undo brings it back."""
        name = bench.project.need(kind, id)["name"]
        bench.delete(browser, kind, id, f"delete {kind} {name}"[:120])
        return Response(status_code=204)

    router.delete(path, status_code=204, name=f"delete_{kind}")(delete)


def offer_renaming(
    router: APIRouter,
    path: str,
    kind: str,
    answer: type[answers.Answer],
    shown: Callable[[Workbench, Entry], dict[str, Any]],
) -> None:
    """Have things of a kind renamed by their address."""

    def rename(id: PathId, body: NameRequest, bench: Bench) -> dict[str, Any]:
        """Give it another name."""
        row = bench.project.change(kind, id, name=body.name)
        bench.events.changed(f"{kind}s")
        return shown(bench, row)

    router.patch(path, response_model=answer, name=f"rename_{kind}")(rename)


def report_file(bench: Workbench, row: Entry, kind: str, task: str, **settings: str) -> Response:
    """A report that a worker writes, of what never changes: one file to keep."""

    def write(path: Path) -> None:
        bench.workers.ask(task, output=str(path), **settings)

    key = (row["id"], kind + settings.get("language", ""))
    data = bench.reports.get(key, lambda: made_file(f"report.{kind}", write))
    return Response(data, media_type=_TYPES[kind], headers=attachment(row["name"], f".{kind}"))


def chosen_draft(
    bench: Workbench, browser: BrowserSession, body: DraftChange | None
) -> dict[str, Any]:
    """The settings that came with a request, else those of the session."""
    if body is None:
        return bench.sessions.draft(browser)
    return changed(empty_draft(), body.plain())
