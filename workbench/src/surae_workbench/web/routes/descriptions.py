"""Recordings described anew after their import, one or a session's at once; undo takes it back."""

from typing import Any

from fastapi import APIRouter

from surae.base.errors import InputError
from surae.base.files import sha256_of
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.places import recording_suffix
from surae_workbench.web.remap import (
    FIELDS,
    first_mapping,
    like,
    present_mapping,
    proposals,
)
from surae_workbench.web.routes.common import ERRORS, Bench, Browser, PathId
from surae_workbench.web.routes.recordings import shown_recording
from surae_workbench.web.rows import Entry
from surae_workbench.web.schemas import DescriptionRequest
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["recordings"])


@router.get("/recordings/{id}/description")
def get_description(id: PathId, bench: Bench) -> dict[str, Any]:
    """How it is described now, the columns to choose from, and what else is of the same kind."""
    row = bench.project.need("recording", id)
    path = str(bench.project.kept("recording", id))
    first = first_mapping(row)
    columns = bench.workers.ask("remap:imported_columns", path=path, first=first)
    named = ", ".join(file["name"] for file in row["files"])
    return {
        "mapping": present_mapping(row),
        "files": [
            {
                "id": upload,
                "name": named,
                "columns": [column for column in columns if column["upload"] == upload],
            }
            for upload in dict.fromkeys(column["upload"] for column in columns)
        ],
        "alike": [
            {"id": other["id"], "name": other["name"]}
            for other in bench.database.all("recording")
            if other["id"] != id and _columns(other) == _columns(row)
        ],
    }


@router.post("/descriptions/preview")
def preview_description(body: DescriptionRequest, bench: Bench) -> dict[str, Any]:
    """What a description makes of the first recording: its ranges, and what the check finds."""
    row = bench.project.need("recording", body.recordings[0])
    wanted = body.mapping.model_dump(mode="json")
    result = _made(bench, row, wanted, None)
    shown = {**row, "mapping": wanted, "version": row.get("version", 0) + 1}
    return {**result, "findings": proposals(result["findings"], shown)}


@router.post("/descriptions")
def post_description(body: DescriptionRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Describe recordings anew, all or none; one step that can be undone."""
    rows = [bench.project.need("recording", id_) for id_ in dict.fromkeys(body.recordings)]
    wanted_first = body.mapping.model_dump(mode="json")
    described: dict[str, dict[str, Any]] = {}
    before = {row["id"]: {key: row.get(key) for key in FIELDS} for row in rows}
    paths = []
    try:
        for row in rows:
            first = row is rows[0]
            wanted = (
                wanted_first if first else like(wanted_first, present_mapping(row), row["name"])
            )
            number = bench.sessions.next_version(row["id"])
            path = bench.project.path("recordings", row["id"], recording_suffix(number))
            paths.append(path)
            result = _made(bench, row, wanted, str(path))
            made = {"version": number, "version_sha256": sha256_of(path), "mapping": wanted}
            described[row["id"]] = {key: (result | made)[key] for key in FIELDS}
        others = f" and {len(rows) - 1} more" if len(rows) > 1 else ""
        firsts = {row["id"]: first_mapping(row) for row in rows}
        bench.sessions.describe(
            browser, before, described, firsts, f"describe {rows[0]['name']}{others}"[:120]
        )
    except BaseException:
        for path in paths:
            path.unlink(missing_ok=True)
        raise
    bench.events.changed("recordings")
    return {
        "recordings": [
            shown_recording(bench, bench.project.need("recording", row["id"])) for row in rows
        ]
    }


def _made(
    bench: Workbench, row: Entry, wanted: dict[str, Any], output: str | None
) -> dict[str, Any]:
    """What a description makes of what was imported, kept where `output` says so."""
    path = str(bench.project.kept("recording", row["id"]))
    try:
        result: dict[str, Any] = bench.workers.ask(
            "remap:redescribed", path=path, first=first_mapping(row), wanted=wanted, output=output
        )
    except InputError as error:
        raise RefusedError(400, f"{row['name']}: {error}") from None
    return result


def _columns(row: Entry) -> set[str]:
    return {channel["column"] for channel in first_mapping(row)["channels"].values()}
