"""The protocol designer."""

import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from surae import api
from surae.web.designer import for_export, preview, side_by_side, trajectory_of
from surae.web.project import when
from surae.web.routes.common import ERRORS, Bench, Browser, PathId, Responses, attachment
from surae.web.rows import Thing
from surae.web.schemas import (
    ProtocolDesign,
    ProtocolFile,
    ProtocolGiven,
    ProtocolPreview,
    ProtocolSettings,
)

router = APIRouter(prefix="/api/protocols", responses=ERRORS, tags=["protocols"])

_CSV: Responses = {200: {"content": {"text/csv": {}}}}


@router.get("/choices")
def get_choices() -> dict[str, Any]:
    """The profiles, tasks and devices."""
    return {
        "profiles": [
            {
                "name": r.name,
                "duration_s": r.seconds,
                "description": r.description,
                "designed": True,
            }
            for r in api.ready_protocols().values()
        ]
        + [
            {"name": choice.name, "duration_s": choice.duration, "description": choice.description}
            for choice in api.PROFILES.values()
        ],
        "tasks": [
            {"name": choice.name, "description": choice.description}
            for choice in api.TASKS.values()
        ],
        "devices": [asdict(choice) for choice in api.DEVICES.values()],
        "populations": ["healthy", "patient"],
        "models": list(api.SIMULATED_MODELS),
    }


@router.post("/preview")
def post_preview(given: ProtocolPreview) -> dict[str, Any]:
    """The motion, its limits, what it covers, and what it will tell of virtual legs."""
    return preview(given.settings, given.model, given.population, given.noise)


@router.post("/side-by-side")
def post_side_by_side(given: ProtocolPreview, bench: Bench) -> dict[str, Any]:
    """What every protocol, of the thesis and designed, will tell of the same legs."""
    kept = {
        thing["name"]: ProtocolSettings(**thing["settings"])
        for thing in bench.database.all("protocol")
    }
    rows = side_by_side(given.settings, given.model, given.population, given.noise, kept)
    return {"protocols": rows}


@router.post("/design", status_code=202)
def post_design(given: ProtocolDesign, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Search a protocol of each duration; the answer is the job, which keeps them."""
    device = None if given.settings.device is None else api.named_device(given.settings.device)
    api.allowed_range(device, given.settings.range)
    lengths = ", ".join(f"{seconds:g}" for seconds in given.durations)
    task = given.model_dump(mode="json")
    job = bench.jobs.submit("design", f"design of {lengths} s", browser, task, None)
    return bench.jobs.shown(job, browser)


@router.post("/csv", response_class=Response, responses=_CSV)
def post_csv(given: ProtocolFile) -> Response:
    """The protocol as the file for a device, within its limits or for a reason."""
    return _file(given.settings, given.settings.profile, given.reason)


@router.get("")
def get_protocols(bench: Bench) -> dict[str, Any]:
    """List the protocols that are kept."""
    return {"protocols": [_shown(thing) for thing in bench.database.all("protocol")]}


@router.post("", status_code=201)
def post_protocol(given: ProtocolGiven, bench: Bench) -> dict[str, Any]:
    """Keep a protocol."""
    trajectory_of(given.settings)
    id_ = bench.database.add("protocol", given.model_dump(mode="json"))
    bench.changed("protocols")
    return _shown(bench.project.need("protocol", id_))


@router.delete("/{id}", status_code=204)
def delete_protocol(id: PathId, bench: Bench, browser: Browser) -> Response:
    """Delete it; undo brings it back."""
    thing = bench.project.need("protocol", id)
    bench.delete(browser, "protocol", id, f"delete protocol {thing['name']}"[:120])
    return Response(status_code=204)


@router.get("/{id}/protocol.csv", response_class=Response, responses=_CSV)
def get_csv(
    id: PathId, bench: Bench, reason: Annotated[str, Query(max_length=300)] = ""
) -> Response:
    """It as the file for a device, as `surae protocol` writes it, in limits or for a reason."""
    thing = bench.project.need("protocol", id)
    return _file(ProtocolSettings(**thing["settings"]), thing["name"], reason)


def _file(settings: ProtocolSettings, name: str, reason: str) -> Response:
    trajectory = for_export(settings, reason)
    note = f"without limits: {' '.join(reason.split())}" if reason.strip() else ""
    with tempfile.TemporaryDirectory(prefix="surae-protocol-") as folder:
        path = Path(folder) / "protocol.csv"
        api.write_protocol_csv(trajectory, path, note=note)
        data = path.read_bytes()
    return Response(data, media_type="text/csv", headers=attachment(name, ".csv"))


def _shown(thing: Thing) -> dict[str, Any]:
    return {
        "id": thing["id"],
        "name": thing["name"],
        "settings": thing["settings"],
        "created": when(thing["created"]),
    }
